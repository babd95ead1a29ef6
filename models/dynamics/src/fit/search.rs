//! The search for the modes of greatest likelihood: selection, refinement, lower residuals.

use crate::likelihood::{Likelihood, Maximum, Model, RealMode, pair};
use crate::stabilisation::Pole;
use nalgebra::Complex;
use std::collections::BTreeMap;
use std::f64::consts::{FRAC_1_SQRT_2, TAU};

/// Standard deviations by which the residue of a mode has to differ from zero (assumption: noise alone reaches four among
/// some hundred independent bands, and a real mode of that size moves no limit).
const SIGNIFICANT: f64 = 6.0;
/// Standard deviations by which the residue of a mode in the direction across its motion has to differ from zero, where no
/// response across is measured (assumption: once in three hundred by noise alone).
const SIGNIFICANT_PART: f64 = 3.0;
/// Standard deviations by which a lower residual has to differ from zero (assumption, as above with a handful of trials).
const SIGNIFICANT_RESIDUAL: f64 = 5.0;
/// Distance of neighbouring poles of one column of the stabilisation diagram, in damping ratios times the frequency
/// (assumption: a fifth of half of the half-power band).
const COLUMN: f64 = 0.2;
/// Least number of stable poles in a column (assumption; there are 28 orders).
const STABLE_ORDERS: usize = 5;
/// Damping ratio beyond which a mode bars no candidates that are farther away (assumption).
const BROADEST: f64 = 0.05;
/// Candidates in a row that may fail before the search ends (assumption).
const MOST_FAILURES: usize = 4;
/// Misfit over degrees of freedom from which on a mode may stand for two (assumption: of a hundred lines and more chance alone
/// makes less).
const MISFIT: f64 = 1.3;
/// Least share of the residue in a second direction at one pole from which on two modes are tried there (assumption).
const LEAST_SECOND: f64 = 0.05;
/// Greatest damping ratio of a mode (assumption).
const GREATEST_DAMPING: f64 = 0.3;
/// Frequencies of modes, over the ends of the measured range (assumption): beyond, residuals stand for them.
const REACH: [f64; 2] = [0.7, 1.3];
/// Greatest number of rounds in which the variances follow from the fitted modulus.
const ROUNDS: usize = 40;
/// Relative change of the misfit at which these rounds end.
const SETTLED: f64 = 1e-6;

/// A search for modes.
pub(super) struct Search {
    pub likelihood: Likelihood,
    /// Whether the variances are known rather than proportional.
    pub known_scale: bool,
    /// First and last frequency (Hz).
    pub range: [f64; 2],
}

impl Search {
    /// Frequencies (rad/s) and damping ratios of the columns of the stabilisation diagram, or of the poles nearest to picks.
    pub fn columns(poles: &[Pole], picks: &[f64]) -> Vec<(f64, f64)> {
        if !picks.is_empty() {
            let nearest = |pick: &f64| {
                let distance = |pole: &&Pole| (pole.natural_frequency - pick).abs();
                let near = poles.iter().filter(|pole| distance(pole) < 0.02 * pick);
                near.min_by(|a, b| distance(a).total_cmp(&distance(b))).map_or(0.02, |pole| pole.damping_ratio)
            };
            return picks.iter().map(|pick| (TAU * pick, nearest(pick))).collect();
        }
        let mut stable: Vec<&Pole> = poles.iter().filter(|pole| pole.stable).collect();
        stable.sort_by(|a, b| a.natural_frequency.total_cmp(&b.natural_frequency));
        let together = |a: &&Pole, b: &&Pole| {
            b.natural_frequency - a.natural_frequency
                < COLUMN * a.damping_ratio.min(b.damping_ratio) * a.natural_frequency
        };
        stable.chunk_by(together).filter(|column| column.len() >= STABLE_ORDERS).flat_map(apart).collect()
    }

    /// Every place where a mode may be that no column shows: single stable poles, and resonances beyond the range.
    fn candidates(&self, poles: &[Pole]) -> Vec<(f64, f64)> {
        let stable = poles.iter().filter(|pole| pole.stable);
        let mut found: Vec<(f64, f64)> =
            stable.map(|pole| (TAU * pole.natural_frequency, pole.damping_ratio)).collect();
        for (end, factor) in self.range.iter().zip([0.97, 1.03]) {
            found.extend([0.01, 0.03, 0.1].map(|zeta| (TAU * end * factor, zeta)));
        }
        found
    }

    /// Resonances all over the range, a half-power band or less apart: noise on most lines leaves no column of poles of a mode
    /// that stands out on some.
    fn everywhere(&self) -> Vec<(f64, f64)> {
        let [first, last] = self.range;
        let of_damping = |zeta: f64| {
            let places = std::iter::successors(Some(first), move |frequency| Some(frequency * (1.0 + zeta)));
            places.take_while(move |frequency| *frequency < last).map(move |frequency| (TAU * frequency, zeta))
        };
        [0.01, 0.03, 0.1].into_iter().flat_map(of_damping).collect()
    }

    /// The scale by which covariances grow.
    pub fn scale(&self, maximum: &Maximum) -> f64 {
        let scale = maximum.chi2 / maximum.freedom as f64;
        if self.known_scale { scale.max(1.0) } else { scale }
    }

    /// The model of greatest likelihood near `start`, the variances following it until they settle.
    fn refined(&mut self, start: &Model) -> Option<Maximum> {
        let mut found = self.likelihood.maximum(start)?;
        for _ in 0..ROUNDS {
            let before = found.chi2;
            self.likelihood.reweigh(&found.model);
            found = self.likelihood.maximum(&found.model)?;
            if (found.chi2 / before - 1.0).abs() < SETTLED {
                break;
            }
        }
        Some(found)
    }

    /// The modes of greatest likelihood: those of the columns without what does not stand out of the noise, and then
    /// further candidates one by one, each where it explains most of what is left. `forced` takes just `most` modes.
    pub fn modes(&mut self, columns: &[(f64, f64)], poles: &[Pole], most: usize, forced: bool) -> Option<Maximum> {
        let start = self.likelihood.linear(columns)?;
        let mode_of = |((frequency, damping_ratio), residues): (&(f64, f64), &[f64; 3])| RealMode {
            frequency: *frequency,
            damping_ratio: *damping_ratio,
            shape: self.shape(*residues),
        };
        let modes: Vec<RealMode> = columns.iter().zip(&start.residues).map(mode_of).collect();
        let mut model = Model { modes, upper: start.upper, lower: [0.0; 3] };
        let mut best = if model.modes.is_empty() { None } else { self.pruned(model.clone(), most, forced) };
        model = best.as_ref().map_or(Model { modes: Vec::new(), ..model }, |best| best.model.clone());
        let mut open = self.candidates(poles);
        if model.modes.is_empty() {
            open.extend(self.everywhere());
        }
        let mut failures = 0;
        while model.modes.len() < most && failures < MOST_FAILURES {
            let away = |(w, zeta): &(f64, f64), mode: &RealMode| {
                (w / mode.frequency - 1.0).abs() > 0.5 * zeta.max(mode.damping_ratio).min(BROADEST)
            };
            open.retain(|candidate| model.modes.iter().all(|mode| away(candidate, mode)));
            let left = self.likelihood.left(&model);
            let scores: Vec<(f64, [f64; 3])> = open.iter().map(|candidate| self.score(&left, *candidate)).collect();
            let Some(top) = (0..open.len()).max_by(|a, b| scores[*a].0.total_cmp(&scores[*b].0)) else { break };
            let (frequency, damping_ratio) = open[top];
            let mut trial = model.clone();
            let added = RealMode { frequency, damping_ratio, shape: self.shape(scores[top].1) };
            trial.modes.push(added.clone());
            let before = model.modes.len();
            match self.pruned(trial, most, forced).filter(|found| found.model.modes.len() > before) {
                Some(found) => {
                    model = found.model.clone();
                    best = Some(found);
                    failures = 0;
                }
                None => {
                    open.retain(|candidate| away(candidate, &added));
                    self.likelihood.reweigh(&model);
                    failures += 1;
                }
            }
        }
        match best {
            Some(found) if !forced => Some(self.divided(found, most)),
            best => best,
        }
    }

    /// The modes where what is left is more than noise and one of them stands for two: close modes of which noise has hidden one
    /// column are a broad one, whose band bars further candidates. Both halves have to stand out of the noise. Where the noise is
    /// not known (responses without coherence, computed ones), nothing says that more than noise is left.
    fn divided(&mut self, mut maximum: Maximum, most: usize) -> Maximum {
        while self.known_scale && maximum.model.modes.len() < most && maximum.chi2 >= MISFIT * maximum.freedom as f64 {
            let count = maximum.model.modes.len();
            let halves = |r: usize| {
                let mut trial = maximum.model.clone();
                let mode = trial.modes.remove(r);
                for side in [-0.5, 0.5] {
                    trial.modes.push(RealMode {
                        frequency: mode.frequency * (1.0 + side * mode.damping_ratio),
                        damping_ratio: 0.7 * mode.damping_ratio,
                        shape: mode.shape.map(|part| part * FRAC_1_SQRT_2),
                    });
                }
                trial
            };
            let both = (0..count).filter_map(|r| self.doubled(&maximum.model, r)).collect::<Vec<_>>();
            let trials: Vec<Model> = both.into_iter().chain((0..count).map(halves)).collect();
            let apart = |trial| self.pruned(trial, most, false).filter(|divided| divided.model.modes.len() > count);
            let Some(divided) = trials.into_iter().find_map(apart) else { break };
            maximum = divided;
        }
        self.likelihood.reweigh(&maximum.model);
        maximum
    }

    /// The model with mode `r` as two at the same pole, where responses across are measured and the residues there are those of
    /// two directions: a symmetric spindle has every bending mode twice. Each reference of a tap shows another share of
    /// the two, which their matrix of residues takes apart.
    fn doubled(&self, model: &Model, r: usize) -> Option<Model> {
        if !self.crossed() {
            return None;
        }
        let poles: Vec<(f64, f64)> = model.modes.iter().map(|mode| (mode.frequency, mode.damping_ratio)).collect();
        let [xx, xy, yy] = self.likelihood.linear(&poles)?.residues[r];
        let (mean, half) = (0.5 * (xx + yy), (0.5 * (xx - yy)).hypot(xy));
        // A second direction that adds less than this share could not be told from a complex mode (assumption).
        if mean - half < LEAST_SECOND * (mean + half) {
            return None;
        }
        let (sine, cosine) = (0.5 * (2.0 * xy).atan2(xx - yy)).sin_cos();
        let mut both = model.clone();
        let mode = both.modes.remove(r);
        for (residue, direction, side) in [(mean + half, [cosine, sine], -1.0), (mean - half, [-sine, cosine], 1.0)] {
            both.modes.push(RealMode {
                // Apart by a hundredth of the half-power band, so that the search can tell them.
                frequency: mode.frequency * (1.0 + 0.01 * side * mode.damping_ratio),
                damping_ratio: mode.damping_ratio,
                shape: direction.map(|part| part * residue.sqrt()),
            });
        }
        Some(both)
    }

    /// The model with each mode that moves in both directions as one along x and one along y, where no response across is
    /// measured: nobody knows the sign between them, and a symmetric spindle has two equal modes.
    fn parted(&mut self, maximum: Maximum) -> Option<Maximum> {
        let moves = |mode: &RealMode| mode.shape.iter().all(|part| *part != 0.0);
        if self.crossed() || self.likelihood.directions.len() < 2 || !maximum.model.modes.iter().any(moves) {
            return Some(maximum);
        }
        let mut model = maximum.model;
        let modes = std::mem::take(&mut model.modes);
        for mode in modes {
            if !moves(&mode) {
                model.modes.push(mode);
                continue;
            }
            let [x, y] = mode.shape;
            model.modes.extend([[x, 0.0], [0.0, y]].map(|shape| RealMode { shape, ..mode.clone() }));
        }
        self.refined(&model)
    }

    /// Whether a response across the force is measured.
    fn crossed(&self) -> bool {
        self.likelihood.targets.iter().any(|target| target.response != target.force)
    }

    /// The shape nearest to residues xx, xy, yy.
    fn shape(&self, residues: [f64; 3]) -> [f64; 2] {
        shape(residues, self.crossed())
    }

    /// The model without parts of shapes that do not differ from zero, where no response across is measured: each would have a
    /// direction of a few degrees by noise alone.
    fn aligned(&mut self, maximum: Maximum) -> Option<Maximum> {
        if self.crossed() || self.likelihood.directions.len() < 2 {
            return Some(maximum);
        }
        let (mut model, mut changed) = (maximum.model.clone(), false);
        for (r, mode) in model.modes.iter_mut().enumerate() {
            let weak = |d: usize| {
                let sd = (self.scale(&maximum) * maximum.covariance[(4 * r + 2 + d, 4 * r + 2 + d)]).sqrt();
                // Of the residue, whose standard deviation is 2 |part| sd.
                mode.shape[d].abs() < 2.0 * SIGNIFICANT_PART * sd
            };
            let weak = [0, 1].map(weak);
            for d in [0, 1] {
                if weak[d] && !weak[1 - d] && mode.shape[d] != 0.0 {
                    (mode.shape[d], changed) = (0.0, true);
                }
            }
        }
        if changed { self.refined(&model) } else { Some(maximum) }
    }

    /// How much of the misfit that is left a further mode explains, and its residues xx, xy, yy.
    fn score(&self, left: &[Vec<Complex<f64>>], (wr, zeta): (f64, f64)) -> (f64, [f64; 3]) {
        let (mut gain, mut sums) = (0.0, [[0.0; 2]; 3]);
        for (target, left) in self.likelihood.targets.iter().zip(left) {
            let (mut cross, mut square) = (0.0, 0.0);
            for ((w, left), variance) in self.likelihood.lines.iter().zip(left).zip(&target.variance) {
                let g = Complex::new(wr * wr - w * w, 2.0 * zeta * wr * w).inv();
                cross += (g.re * left.re + g.im * left.im) / variance;
                square += g.norm_sqr() / variance;
            }
            gain += cross * cross / square;
            let sum = &mut sums[pair(target.response, target.force)];
            sum[0] += cross;
            sum[1] += square;
        }
        (gain, sums.map(|[cross, square]| if square > 0.0 { cross / square } else { 0.0 }))
    }

    /// The modes of a model at their greatest likelihood, at most `most`, without those that do not stand out of the noise
    /// unless they are `forced`.
    fn pruned(&mut self, mut model: Model, most: usize, forced: bool) -> Option<Maximum> {
        loop {
            let found = self.refined(&model)?;
            let found = self.aligned(found)?;
            let weakest = (0..found.model.modes.len())
                .map(|r| (r, self.strength(&found, r)))
                .min_by(|a, b| a.1.total_cmp(&b.1))
                .filter(|(_, strength)| found.model.modes.len() > most || !forced && *strength < SIGNIFICANT);
            let Some((weakest, _)) = weakest else { return Some(found) };
            if found.model.modes.len() == 1 {
                return None;
            }
            model = found.model;
            model.modes.remove(weakest);
        }
    }

    /// Residue of mode `r` over its standard deviation; zero where it is no mode: overdamped, or far beyond the range.
    fn strength(&self, maximum: &Maximum, r: usize) -> f64 {
        let mode = &maximum.model.modes[r];
        let frequency = mode.frequency / TAU;
        if mode.damping_ratio > GREATEST_DAMPING
            || frequency < REACH[0] * self.range[0]
            || frequency > REACH[1] * self.range[1]
        {
            return 0.0;
        }
        let per_mode = 2 + self.likelihood.directions.len();
        let parts = self.likelihood.directions.iter().enumerate();
        let gradient: Vec<(usize, f64)> = parts.map(|(k, d)| (per_mode * r + 2 + k, 2.0 * mode.shape[*d])).collect();
        let mut variance = 0.0;
        for (i, a) in &gradient {
            for (j, b) in &gradient {
                variance += a * b * maximum.covariance[(*i, *j)];
            }
        }
        let residue: f64 = mode.shape.iter().map(|part| part * part).sum();
        if residue > 0.0 { residue / (self.scale(maximum) * variance).sqrt() } else { 0.0 }
    }

    /// The last refinement, with lower residuals where they differ from zero.
    pub fn finish(&mut self, plain: Maximum) -> Option<Maximum> {
        let plain = self.parted(plain)?;
        let plain = self.refined(&plain.model)?;
        let deviance = self.likelihood.deviance(&plain, self.known_scale);
        let count = self.likelihood.pairs().len();
        self.likelihood.lower = true;
        let with = self.refined(&plain.model).filter(|with| {
            let size = with.covariance.nrows();
            let scale = self.scale(with).sqrt();
            let parameters = self.likelihood.parameters(&with.model);
            (size - count..size)
                .any(|i| parameters[i].abs() > SIGNIFICANT_RESIDUAL * scale * with.covariance[(i, i)].max(0.0).sqrt())
        });
        // On lines that hold noise alone a greater modulus is a greater variance, in which a residual of any size can hide.
        let explains = |with: &Maximum| {
            self.likelihood.deviance(with, self.known_scale) + SIGNIFICANT_RESIDUAL * SIGNIFICANT_RESIDUAL < deviance
        };
        if let Some(with) = with.filter(explains) {
            return Some(with);
        }
        self.likelihood.lower = false;
        self.refined(&plain.model)
    }
}

/// The modes of poles beside each other: as many as the higher half of the orders has, each the median of its poles.
fn apart(column: &[&Pole]) -> Vec<(f64, f64)> {
    let mut orders: BTreeMap<usize, Vec<&Pole>> = BTreeMap::new();
    for pole in column {
        orders.entry(pole.order).or_default().push(pole);
    }
    let mut counts: Vec<usize> = orders.values().skip(orders.len() / 2).map(Vec::len).collect();
    counts.sort_unstable();
    let count = counts[counts.len() / 2];
    let full: Vec<&Vec<&Pole>> = orders.values().filter(|poles| poles.len() == count).collect();
    let median = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    (0..count)
        .map(|i| {
            let frequency = median(full.iter().map(|poles| poles[i].natural_frequency).collect());
            (TAU * frequency, median(full.iter().map(|poles| poles[i].damping_ratio).collect()))
        })
        .collect()
}

/// The shape whose products are nearest to residues xx, xy, yy: the dominant direction of their matrix. Without a response
/// across (`crossed`) the sign of the direction is not known; both parts are taken as positive.
fn shape([xx, xy, yy]: [f64; 3], crossed: bool) -> [f64; 2] {
    if !crossed {
        let parts = [xx, yy].map(|residue| residue.max(0.0).sqrt());
        // A mode needs a motion, and the search finds its size.
        return if parts == [0.0; 2] { [(-xx).max(0.0).sqrt(), (-yy).max(0.0).sqrt()] } else { parts };
    }
    let angle = 0.5 * (2.0 * xy).atan2(xx - yy);
    let (sine, cosine) = angle.sin_cos();
    let residue = xx * cosine * cosine + 2.0 * xy * sine * cosine + yy * sine * sine;
    let size = residue.abs().sqrt();
    [size * cosine, size * sine]
}
