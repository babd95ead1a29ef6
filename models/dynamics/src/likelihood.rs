//! The likelihood of real modes under Gaussian noise, and its maximum by Levenberg and Marquardt.

use crate::frf::Measurement;
use nalgebra::{Complex, DMatrix, DVector};
use std::f64::consts::TAU;

/// Greatest number of steps of one search.
const MOST_STEPS: usize = 60;
/// Relative change of the misfit at which a search ends.
const CONVERGED: f64 = 1e-10;

/// One mode in the coordinates of the search.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct RealMode {
    /// Undamped natural frequency (rad/s).
    pub frequency: f64,
    pub damping_ratio: f64,
    /// Mass-normalised shape at the point of cut (1/sqrt(kg)), by direction.
    pub shape: [f64; 2],
}

impl RealMode {
    /// `1/(w_r² − w² + 2 i zeta w_r w)`.
    fn response(&self, w: f64) -> Complex<f64> {
        let Self { frequency, damping_ratio, .. } = *self;
        Complex::new(frequency * frequency - w * w, 2.0 * damping_ratio * frequency * w).inv()
    }
}

/// Modes with the residuals of everything out of the range.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Model {
    pub modes: Vec<RealMode>,
    /// Compliance (m/N) of the modes above the range, by pair of directions xx, xy, yy.
    pub upper: [f64; 3],
    /// Inverse of a mass (1/kg) that moves freely below the range, by pair of directions.
    pub lower: [f64; 3],
}

/// Place of a pair of directions among the residuals.
pub(crate) fn pair(p: usize, q: usize) -> usize {
    p + q
}

impl Model {
    /// Receptance (m/N) of direction `p` over force in direction `q` at `w` (rad/s).
    pub fn receptance(&self, p: usize, q: usize, w: f64) -> Complex<f64> {
        let modes: Complex<f64> =
            self.modes.iter().map(|mode| mode.response(w) * (mode.shape[p] * mode.shape[q])).sum();
        modes + self.upper[pair(p, q)] - self.lower[pair(p, q)] / (w * w)
    }
}

/// A measured function as the likelihood sees it.
pub(crate) struct Target {
    pub response: usize,
    pub force: usize,
    pub values: Vec<Complex<f64>>,
    /// Variance of the real and of the imaginary part over the square of the modulus, where the coherence tells it.
    pub relative: Option<Vec<f64>>,
    /// That variance (m²/N²) itself, where it was measured.
    pub absolute: Option<Vec<f64>>,
    /// Least and greatest variance of each part (m²/N²) that the coherence can tell: a few times less and more than that of the
    /// measured moduli around a line. Without the greatest a model hides on lines without coherence, where a greater modulus is
    /// a greater variance: two equal modes along x and y would be one at 45 degrees, whose response across nothing measured
    /// contradicts. Without the least a response that is nothing but noise would bind a model that has none there with no variance at
    /// all: of a machine whose modes move along x and along y the responses across would rule the fit.
    pub bounds: Option<Vec<[f64; 2]>>,
    /// Variance of each part (m²/N²), of the last round.
    pub variance: Vec<f64>,
}

/// Lines on either side over which the measured noise is taken, and how many times more than its mean and less than its median a
/// variance may be: assumptions. A variance of the right model is the noise itself, and the mean of 17 lines is off by a factor of two at most;
/// without the number of averages its size is known to their number alone.
const AROUND: usize = 8;
const WITHIN: [f64; 2] = [4.0, 64.0];

/// Everything measured, and which parameters are free.
pub(crate) struct Likelihood {
    /// Angular frequencies (rad/s).
    pub lines: Vec<f64>,
    pub targets: Vec<Target>,
    /// Directions that are measured.
    pub directions: Vec<usize>,
    /// Whether lower residuals are free.
    pub lower: bool,
}

/// The maximum with its curvature.
pub(crate) struct Maximum {
    pub model: Model,
    /// Sum of squared deviations over their variances.
    pub chi2: f64,
    /// Number of observations less the number of parameters.
    pub freedom: usize,
    /// Covariance of the parameters in the order of [`Likelihood::parameters`]; logarithms of frequency and damping.
    pub covariance: DMatrix<f64>,
}

/// A fit of residues with given poles.
pub(crate) struct Linear {
    /// Residues (1/kg) of every pole by pair of directions.
    pub residues: Vec<[f64; 3]>,
    /// Compliance (m/N) of the modes above the range.
    pub upper: [f64; 3],
}

impl Likelihood {
    /// From a measurement of `averages` averages.
    pub fn new(measured: &Measurement, averages: f64) -> Self {
        let lines: Vec<f64> = measured.frequencies.iter().map(|frequency| TAU * frequency).collect();
        let mut directions: Vec<usize> =
            measured.functions.iter().flat_map(|f| [f.response.index(), f.force.index()]).collect();
        directions.sort_unstable();
        directions.dedup();
        let targets = measured.functions.iter().map(|function| {
            let absolute = function.noise.as_ref().map(|noise| noise.iter().map(|sd| sd * sd).collect());
            let coherence = function.coherence.as_ref().filter(|_| function.noise.is_none());
            let relative = coherence.map(|coherence| {
                let share = |value: &f64| {
                    // A coherence of zero says that the line knows nothing; it must not divide.
                    let value = value.clamp(1e-9, 1.0);
                    (1.0 - value).max(measured.coherence_digit) / (2.0 * averages * value)
                };
                coherence.iter().map(share).collect()
            });
            let bounds = coherence.map(|coherence| bounds(&function.receptance, coherence, averages));
            Target {
                response: function.response.index(),
                force: function.force.index(),
                values: function.receptance.clone(),
                relative,
                absolute,
                bounds,
                variance: Vec::new(),
            }
        });
        let mut likelihood = Self { lines, targets: targets.collect(), directions, lower: false };
        for (target, function) in likelihood.targets.iter_mut().zip(&measured.functions) {
            let moduli: Vec<f64> = target.values.iter().map(|value| value.norm()).collect();
            let order = function.motion.derivatives();
            target.weigh(&likelihood.lines, &moduli, order);
        }
        likelihood
    }

    /// Moves the variances halfway, in their logarithm, to those of the moduli of a fitted model, where the coherence tells
    /// them as a share. At once, the small modulus between two resonances would draw the next model to itself and away again.
    pub fn reweigh(&mut self, model: &Model) {
        let lines = &self.lines;
        for target in &mut self.targets {
            let modulus = |w: &f64| model.receptance(target.response, target.force, *w).norm();
            if target.relative.is_some() {
                let moduli: Vec<f64> = lines.iter().map(modulus).collect();
                let before = std::mem::take(&mut target.variance);
                target.weigh(lines, &moduli, 0);
                target
                    .variance
                    .iter_mut()
                    .zip(before)
                    .for_each(|(variance, before)| *variance = (*variance * before).sqrt());
            }
        }
    }

    /// The parameters of a model: logarithm of frequency, logarithm of damping and shape of every mode, upper residuals of
    /// the measured pairs, lower residuals where they are free.
    pub fn parameters(&self, model: &Model) -> Vec<f64> {
        let modes = model.modes.iter().flat_map(|mode| {
            let shape = self.directions.iter().map(|d| mode.shape[*d]);
            [mode.frequency.ln(), mode.damping_ratio.ln()].into_iter().chain(shape)
        });
        let pairs = self.pairs();
        let upper = pairs.iter().map(|pair| model.upper[*pair]);
        let lower = pairs.iter().filter(|_| self.lower).map(|pair| model.lower[*pair]);
        modes.chain(upper).chain(lower).collect()
    }

    /// Pairs of directions with a function.
    pub fn pairs(&self) -> Vec<usize> {
        let mut pairs: Vec<usize> = self.targets.iter().map(|target| pair(target.response, target.force)).collect();
        pairs.sort_unstable();
        pairs.dedup();
        pairs
    }

    fn model(&self, parameters: &[f64], modes: usize) -> Model {
        let per_mode = 2 + self.directions.len();
        let (of_modes, residuals) = parameters.split_at(per_mode * modes);
        let modes = of_modes.chunks_exact(per_mode).map(|values| {
            let mut shape = [0.0; 2];
            for (direction, value) in self.directions.iter().zip(&values[2..]) {
                shape[*direction] = *value;
            }
            RealMode { frequency: values[0].exp(), damping_ratio: values[1].exp(), shape }
        });
        let (mut upper, mut lower) = ([0.0; 3], [0.0; 3]);
        let pairs = self.pairs();
        for (i, pair) in pairs.iter().enumerate() {
            upper[*pair] = residuals[i];
            if self.lower {
                lower[*pair] = residuals[pairs.len() + i];
            }
        }
        Model { modes: modes.collect(), upper, lower }
    }

    /// What a model leaves of every target.
    pub fn left(&self, model: &Model) -> Vec<Vec<Complex<f64>>> {
        let part_of = |target: &Target| {
            let lines = self.lines.iter().zip(&target.values);
            lines.map(|(w, h)| h - model.receptance(target.response, target.force, *w)).collect()
        };
        self.targets.iter().map(part_of).collect()
    }

    /// Sum of squared deviations over their variances.
    pub fn chi2(&self, model: &Model) -> f64 {
        let sum_of = |target: &Target| -> f64 {
            let lines = self.lines.iter().zip(&target.values).zip(&target.variance);
            lines.map(|((w, h), v)| (h - model.receptance(target.response, target.force, *w)).norm_sqr() / v).sum()
        };
        self.targets.iter().map(sum_of).sum()
    }

    /// Twice the negative logarithm of the likelihood of a maximum under the present variances, but for a constant: what two
    /// models whose variances differ are compared by. Where the scale of the variances is not known, it is that of the
    /// misfit.
    pub fn deviance(&self, maximum: &Maximum, known_scale: bool) -> f64 {
        let logarithms: f64 =
            self.targets.iter().flat_map(|target| &target.variance).map(|variance| 2.0 * variance.ln()).sum();
        let observations = self.targets.iter().map(|target| 2 * target.values.len()).sum::<usize>() as f64;
        let misfit = if known_scale {
            maximum.chi2
        } else {
            observations * (maximum.chi2 / observations).max(f64::MIN_POSITIVE).ln()
        };
        logarithms + misfit
    }

    /// Residues of every pair of directions and upper residuals that fit best with given poles, frequency (rad/s) and damping
    /// ratio; none where two poles are the same.
    pub fn linear(&self, poles: &[(f64, f64)]) -> Option<Linear> {
        let size = poles.len() + 1;
        let mut found = Linear { residues: vec![[0.0; 3]; poles.len()], upper: [0.0; 3] };
        let columns: Vec<Vec<Complex<f64>>> = self
            .lines
            .iter()
            .map(|w| {
                let mode_of = |(frequency, damping_ratio): &(f64, f64)| {
                    RealMode { frequency: *frequency, damping_ratio: *damping_ratio, shape: [0.0; 2] }.response(*w)
                };
                poles.iter().map(mode_of).chain([Complex::from(1.0)]).collect()
            })
            .collect();
        for known in self.pairs() {
            let (mut matrix, mut gradient) = (DMatrix::zeros(size, size), DVector::zeros(size));
            for target in self.targets.iter().filter(|target| pair(target.response, target.force) == known) {
                for ((row, h), variance) in columns.iter().zip(&target.values).zip(&target.variance) {
                    for (i, a) in row.iter().enumerate() {
                        gradient[i] += (a.re * h.re + a.im * h.im) / variance;
                        for (j, b) in row.iter().enumerate() {
                            matrix[(i, j)] += (a.re * b.re + a.im * b.im) / variance;
                        }
                    }
                }
            }
            let solved = solve(&matrix, &gradient, 0.0)?;
            found.residues.iter_mut().enumerate().for_each(|(r, residues)| residues[known] = solved[r]);
            found.upper[known] = solved[poles.len()];
        }
        Some(found)
    }

    /// Normal equations at a model: curvature and gradient of half the misfit.
    fn normal(&self, model: &Model) -> (DMatrix<f64>, DVector<f64>) {
        let per_mode = 2 + self.directions.len();
        let pairs = self.pairs();
        let residuals = per_mode * model.modes.len();
        let size = residuals + pairs.len() * (1 + usize::from(self.lower));
        let (mut matrix, mut gradient) = (DMatrix::zeros(size, size), DVector::zeros(size));
        let mut row: Vec<(usize, Complex<f64>)> = Vec::with_capacity(size);
        for target in &self.targets {
            let (p, q) = (target.response, target.force);
            let place = pairs.iter().position(|known| *known == pair(p, q)).unwrap_or(0);
            for ((w, h), variance) in self.lines.iter().zip(&target.values).zip(&target.variance) {
                row.clear();
                let mut value = Complex::from(model.upper[pair(p, q)] - model.lower[pair(p, q)] / (w * w));
                for (r, mode) in model.modes.iter().enumerate() {
                    let g = mode.response(*w);
                    let both = mode.shape[p] * mode.shape[q];
                    value += g * both;
                    let (wr, zeta) = (mode.frequency, mode.damping_ratio);
                    let damped = Complex::new(0.0, 2.0 * zeta * wr * w);
                    let slope = -g * g * both;
                    row.push((per_mode * r, slope * (damped + 2.0 * wr * wr)));
                    row.push((per_mode * r + 1, slope * damped));
                    for (k, direction) in self.directions.iter().enumerate() {
                        let mut share = 0.0;
                        if *direction == p {
                            share += mode.shape[q];
                        }
                        if *direction == q {
                            share += mode.shape[p];
                        }
                        if share != 0.0 {
                            row.push((per_mode * r + 2 + k, g * share));
                        }
                    }
                }
                row.push((residuals + place, Complex::from(1.0)));
                if self.lower {
                    row.push((residuals + pairs.len() + place, Complex::from(-1.0 / (w * w))));
                }
                let deviation = h - value;
                for (n, (i, a)) in row.iter().enumerate() {
                    gradient[*i] += (a.re * deviation.re + a.im * deviation.im) / variance;
                    for (j, b) in &row[..=n] {
                        matrix[(*i, *j)] += (a.re * b.re + a.im * b.im) / variance;
                    }
                }
            }
        }
        for i in 0..size {
            for j in i + 1..size {
                matrix[(i, j)] = matrix[(j, i)];
            }
        }
        (matrix, gradient)
    }

    /// The model of greatest likelihood near `start`; none where the search ends nowhere.
    pub fn maximum(&self, start: &Model) -> Option<Maximum> {
        let count = start.modes.len();
        let (mut model, mut chi2) = (start.clone(), self.chi2(start));
        let mut damping = 1e-3;
        let mut state = self.normal(&model);
        for _ in 0..MOST_STEPS {
            let (matrix, gradient) = &state;
            let Some(step) = solve(matrix, gradient, damping) else {
                damping *= 10.0;
                continue;
            };
            let mut parameters = self.parameters(&model);
            parameters.iter_mut().zip(&step).for_each(|(value, step)| *value += step);
            let trial = self.model(&parameters, count);
            let reached = self.chi2(&trial);
            if reached < chi2 {
                let gain = (chi2 - reached) / chi2;
                (model, chi2) = (trial, reached);
                state = self.normal(&model);
                damping = (damping * 0.1).max(1e-12);
                if gain < CONVERGED {
                    break;
                }
            } else {
                if damping > 1e8 {
                    break;
                }
                damping *= 10.0;
                // At the maximum rounding alone decides between two steps.
                let here = self.parameters(&model);
                let relative = step.iter().zip(&here).map(|(step, value)| (step / value.abs().max(1e-300)).abs());
                if relative.fold(0.0, f64::max) < 1e-9 {
                    break;
                }
            }
        }
        let freedom = self.targets.iter().map(|target| 2 * target.values.len()).sum::<usize>();
        let parameters = self.parameters(&model);
        let covariance = inverse(&state.0)?;
        let fine = parameters.iter().chain(covariance.iter()).all(|value| value.is_finite());
        fine.then(|| Maximum { model, chi2, freedom: freedom.saturating_sub(parameters.len()).max(1), covariance })
    }
}

impl Target {
    /// Variances as they were measured, or from the moduli of a response; without coherence the noise of the quantity that was measured, the
    /// `order`-th derivative of the displacement, is the same on every line, of a size that the misfit tells.
    fn weigh(&mut self, lines: &[f64], moduli: &[f64], order: i32) {
        let typical = moduli.iter().map(|modulus| modulus * modulus).sum::<f64>() / moduli.len().max(1) as f64;
        self.variance = match (&self.absolute, &self.relative) {
            (Some(absolute), _) => {
                let least = 1e-16 * typical;
                absolute.iter().map(|variance| variance.max(least)).collect()
            }
            (None, Some(relative)) => {
                let least = 1e-12 * typical;
                let variances =
                    moduli.iter().zip(relative).map(|(modulus, share)| (modulus * modulus).max(least) * share);
                match &self.bounds {
                    Some(bounds) => {
                        variances.zip(bounds).map(|(variance, [least, most])| variance.clamp(*least, *most)).collect()
                    }
                    None => variances.collect(),
                }
            }
            (None, None) => {
                let powers: Vec<f64> = lines.iter().map(|w| w.powi(-2 * order)).collect();
                let mean = powers.iter().sum::<f64>() / powers.len().max(1) as f64;
                powers.iter().map(|power| typical * power / mean).collect()
            }
        };
    }
}

/// Least and greatest variances of each part of `values`: a mean square modulus is `|H|² + 2 v` with `v = |H|² (1 − γ²)/(2 n γ²)`, so that
/// each line has a `v = |H|² (1 − γ²)/(2 (n γ² + 1 − γ²))` of its own, of which the mean and the median of neighbours tell the noise
/// around.
fn bounds(values: &[Complex<f64>], coherence: &[f64], averages: f64) -> Vec<[f64; 2]> {
    let of_line = |(value, coherence): (&Complex<f64>, &f64)| {
        let noisy = 1.0 - coherence.clamp(0.0, 1.0);
        value.norm_sqr() * noisy / (2.0 * (averages * (1.0 - noisy) + noisy))
    };
    let lines: Vec<f64> = values.iter().zip(coherence).map(of_line).collect();
    let factor = if averages > 1.0 { WITHIN[0] } else { WITHIN[1] };
    let around = |i: usize| {
        let mut near = lines[i.saturating_sub(AROUND)..(i + AROUND + 1).min(lines.len())].to_vec();
        let mean = near.iter().sum::<f64>() / near.len() as f64;
        near.sort_by(f64::total_cmp);
        // A coherence of exactly one around says nothing of the noise.
        [near[near.len() / 2] / factor, if mean > 0.0 { factor * mean } else { f64::INFINITY }]
    };
    (0..lines.len()).map(around).collect()
}

/// `1/sqrt` of the diagonal, which makes the normal equations independent of units; zero for a parameter that moves nothing,
/// such as the part of a shape across its motion where no response across is measured. It is held.
fn scales(matrix: &DMatrix<f64>) -> DVector<f64> {
    matrix.diagonal().map(|entry| if entry > 0.0 { 1.0 / entry.sqrt() } else { 0.0 })
}

/// The matrix with a diagonal of ones.
fn scaled(matrix: &DMatrix<f64>, scale: &DVector<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(scale.len(), scale.len(), |i, j| if i == j { 1.0 } else { matrix[(i, j)] * scale[i] * scale[j] })
}

/// Step of Marquardt's equations.
fn solve(matrix: &DMatrix<f64>, gradient: &DVector<f64>, damping: f64) -> Option<DVector<f64>> {
    let scale = scales(matrix);
    let mut scaled = scaled(matrix, &scale);
    for i in 0..scale.len() {
        scaled[(i, i)] += damping;
    }
    Some(scaled.cholesky()?.solve(&gradient.component_mul(&scale)).component_mul(&scale))
}

/// Inverse of the curvature.
fn inverse(matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let scale = scales(matrix);
    let inverse = scaled(matrix, &scale).cholesky()?.inverse();
    Some(DMatrix::from_fn(scale.len(), scale.len(), |i, j| inverse[(i, j)] * scale[i] * scale[j]))
}
