//! Whether the calibrated nominal model fits, tested.
//!
//! Every group is predicted from the others. What is left, in units of what the model predicts for it, has to be
//! standard normal: in its level and scale, from group to group, from row to row, in its distribution, and along
//! everything that was recorded; nor may an effect of the catalogue show. All of that is judged at one level against
//! data sets that the model draws itself over the same rows and that are fitted as the records are.

use super::constants::{FEWEST_VALUES, NULL_LEVEL};
use super::fit::offset_residual;
use super::{Basis, Fit, Forward, Measured, Noise, Transform};
use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;
use serde_json::{Value, json};
use std::ops::Range;
use toolroom_fit_test::{Channel, Design, Group, Judged, Statistic, Statistics, interpolated, judge};

/// Drawn data sets, where the answer is not clear without (count). Derivation: probabilities down to 0.001.
const DRAWS: usize = 999;
/// Drawn data sets at first (count), and the probability above which they are enough. Derivation: p > 0.1 of 199 draws
/// is above the level of 0.01 but for less than one case in a million.
const FIRST: (usize, f64) = (199, 0.1);
/// Data sets that are drawn side by side (count).
const SIDE_BY_SIDE: usize = 20;
/// Power at which the least deviation counts as seen (1).
const POWER: f64 = 0.9;

/// The answer of the test.
#[derive(Clone, Debug, PartialEq)]
pub struct Fitness {
    /// Probability of a misfit like this where the model is right.
    pub p: f64,
    /// Level of the test.
    pub level: f64,
    /// Each statistic, least probable first.
    pub parts: Vec<Part>,
    /// What would have been seen.
    pub least_seen: Vec<LeastSeen>,
    /// How much of each channel the model leaves beside noise and scatter.
    pub structure: Vec<Structure>,
}

/// One statistic of the test.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Channel, or `catalogue`.
    pub what: &'static str,
    /// Kind of misfit; `effect` of the catalogue.
    pub test: &'static str,
    /// Covariate or effect that is followed most; may be empty.
    pub follows: String,
    /// Probability by itself.
    pub p: f64,
    /// The statistic.
    pub statistic: f64,
}

/// A deviation that would have been seen.
#[derive(Clone, Debug, PartialEq)]
pub struct LeastSeen {
    /// What deviates.
    pub what: String,
    /// The least size that is seen; infinite where calibration takes up any.
    pub value: f64,
    /// Its unit.
    pub unit: &'static str,
    /// With which probability it is seen.
    pub power: f64,
}

/// What a channel holds beside noise and scatter.
#[derive(Clone, Debug, PartialEq)]
pub struct Structure {
    /// The channel.
    pub channel: &'static str,
    /// Upper 90 % end of its root mean square, in the unit of comparison (relative, or SI).
    pub upper: f64,
    /// Typical value, SI; 1 where the comparison is relative.
    pub level: f64,
    /// Standard deviation of the sensor, in the unit of comparison.
    pub sensor: f64,
}

impl Fitness {
    /// Whether the model fits.
    pub fn passed(&self) -> bool {
        self.p > self.level
    }

    /// Several tests as one: the least probability counts as often as tests were made (Bonferroni).
    pub(super) fn together<'a>(all: impl Iterator<Item = &'a Self>) -> Option<Self> {
        let all: Vec<&Self> = all.collect();
        let [first, others @ ..] = &all[..] else { return None };
        let mut whole = (*first).clone();
        for other in others {
            whole.p = whole.p.min(other.p);
            whole.parts.extend(other.parts.iter().cloned());
            whole.least_seen.extend(other.least_seen.iter().cloned());
            whole.structure.extend(other.structure.iter().cloned());
        }
        whole.parts.sort_by(|a, b| a.p.total_cmp(&b.p));
        whole.p = (whole.p * all.len() as f64).min(1.0);
        Some(whole)
    }

    /// The entry `fit` of the document.
    pub fn json(&self) -> Value {
        let finite = |value: f64| if value.is_finite() { json!(value) } else { Value::Null };
        let part = |part: &Part| {
            json!({ "what": part.what, "test": part.test, "follows": part.follows, "p": part.p,
                    "statistic": finite(part.statistic) })
        };
        let seen = |seen: &LeastSeen| json!({ "what": seen.what, "value": finite(seen.value), "unit": seen.unit, "power": seen.power });
        let structure = |own: &Structure| json!({ "channel": own.channel, "upper": finite(own.upper) });
        json!({
            "p": self.p, "level": self.level, "passed": self.passed(),
            "parts": self.parts.iter().map(part).collect::<Vec<_>>(),
            "least_seen": self.least_seen.iter().map(seen).collect::<Vec<_>>(),
            "structure": self.structure.iter().map(structure).collect::<Vec<_>>(),
        })
    }
}

/// Tests whether the model of `fit`, a fit without effects and with derivatives by all candidates, leaves what
/// `basis` says of noise and scatter, in the channels of which that is known.
pub(super) fn tested(model: &dyn Forward, basis: &Basis, fit: &Fit, folds: &[Vec<usize>], seed: u64) -> Fitness {
    let test = Test::new(model, basis, fit, folds);
    let observed = test.observed();
    let mut draws = test.drawn(0..FIRST.0, seed);
    let values = |draws: &[Draw]| draws.iter().map(|(own, _)| own.clone()).collect::<Vec<_>>();
    let mut judged = judge(&observed.values, &values(&draws));
    if judged.p <= FIRST.1 {
        draws.extend(test.drawn(FIRST.0..DRAWS, seed));
        judged = judge(&observed.values, &values(&draws));
    }
    let level = NULL_LEVEL / basis.method.processes.max(1) as f64;
    let part = |(((what, test, follows), statistic), p): ((&Name, &f64), &f64)| Part {
        what,
        test,
        follows: follows.clone(),
        p: *p,
        statistic: *statistic,
    };
    let all = observed.names.iter().zip(&observed.values).zip(&judged.each).map(part).zip(&judged.standardised);
    let mut parts: Vec<(Part, f64)> = all.filter(|(_, far)| far.is_finite()).map(|(part, far)| (part, *far)).collect();
    parts.sort_by(|a, b| b.1.total_cmp(&a.1));
    let mut parts: Vec<Part> = parts.into_iter().map(|(part, _)| part).collect();
    parts.truncate(PARTS);
    let least_seen = test.least_seen(&judged, &draws, judged.critical(level));
    Fitness { p: judged.p, level, parts, least_seen, structure: test.structure(&observed.scores) }
}

/// Parts that are reported.
const PARTS: usize = 60;

/// What a statistic asks, how, and what is followed most.
type Name = (&'static str, &'static str, String);
/// Statistics of a drawn data set, and its scores where they are kept.
type Draw = (Vec<f64>, Option<DVector<f64>>);

/// Statistics of the records with their names, and the scores.
struct Observed {
    values: Vec<f64>,
    names: Vec<Name>,
    scores: DVector<f64>,
}

/// A linearised model over the fitted groups.
struct Test<'a> {
    model: &'a dyn Forward,
    fit: &'a Fit,
    noise: Noise,
    /// Observations of the fitted groups, in the order of the design.
    places: Vec<usize>,
    design: Design,
    /// Whitened residual.
    residual: DVector<f64>,
    channels: Vec<(usize, Vec<usize>, Channel)>,
    /// Weights of the residual that give the scores of the candidates.
    catalogue: DMatrix<f64>,
    candidates: Vec<usize>,
}

impl<'a> Test<'a> {
    fn new(model: &'a dyn Forward, basis: &Basis, fit: &'a Fit, folds: &[Vec<usize>]) -> Self {
        let frame = model.frame();
        let measured = &frame.measured;
        let linear = &fit.linear;
        // Outliers count in full: they are what is requested.
        let mut noise = basis.noise.clone();
        noise.weight.fill(1.0);
        let fitted: Vec<usize> = measured.fitted_groups().collect();
        let places: Vec<usize> = fitted.iter().flat_map(|group| measured.spans[*group].clone()).collect();
        let white = |columns: &[Vec<f64>]| -> Vec<Vec<f64>> {
            columns.par_iter().map(|column| noise.whiten(measured, column)).collect()
        };
        let (shared, locals) = (white(&linear.nuisance), white(&linear.locals));
        let mut fold_of = vec![0; measured.groups.len()];
        folds.iter().enumerate().for_each(|(fold, groups)| groups.iter().for_each(|group| fold_of[*group] = fold));
        let group = |group: &usize| {
            let span = measured.spans[*group].clone();
            let matrix = |columns: &[Vec<f64>], scale: &dyn Fn(usize) -> f64| {
                DMatrix::from_fn(span.len(), columns.len(), |i, j| columns[j][span.start + i] * scale(j))
            };
            Group {
                shared: matrix(&shared, &|_| 1.0),
                own: matrix(&locals, &|kind| basis.local_scale[kind]),
                fold: fold_of[*group],
            }
        };
        let design = Design::new(fitted.iter().map(group).collect(), folds.len());
        let residual = noise.whiten(measured, &offset_residual(model, linear, &[]));
        let residual = DVector::from_iterator(places.len(), places.iter().map(|place| residual[*place]));
        let channels = (0..measured.channels.len())
            .filter(|channel| model.scatter_is_known(*channel))
            .map(|channel| channel_of(model, measured, &places, &design, channel))
            .filter(|(_, places, _)| places.len() >= FEWEST_VALUES)
            .collect();
        let candidates: Vec<usize> = (0..frame.candidates.len()).filter(|i| !linear.effects[*i].is_empty()).collect();
        let effects: Vec<DVector<f64>> = candidates
            .par_iter()
            .map(|candidate| {
                let white = noise.whiten(measured, &linear.effects[*candidate]);
                DVector::from_iterator(places.len(), places.iter().map(|place| white[*place]))
            })
            .collect();
        let signatures = DMatrix::from_fn(places.len(), effects.len(), |i, j| effects[j][i]);
        let catalogue = design.projected(&signatures);
        Self { model, fit, noise, places, design, residual, channels, catalogue, candidates }
    }

    fn observed(&self) -> Observed {
        let frame = self.model.frame();
        let scores = self.scores(DMatrix::from_columns(std::slice::from_ref(&self.residual)));
        let scores: DVector<f64> = scores.column(0).into_owned();
        let (mut values, mut names) = (Vec::new(), Vec::new());
        for (channel, places, layout) in &self.channels {
            let of_channel: Vec<f64> = places.iter().map(|place| scores[*place]).collect();
            let statistics = Statistics::of(&of_channel, layout);
            for statistic in Statistic::ALL {
                let follows = statistics.strongest.filter(|_| statistic == Statistic::Covariate);
                let follows = follows.map_or_else(String::new, |index| frame.covariates[index].name.clone());
                names.push((frame.measured.channels[*channel].name, statistic.name(), follows));
                values.push(statistics.get(statistic));
            }
        }
        let effects = self.catalogue.tr_mul(&self.residual);
        let strongest = (0..effects.len()).max_by(|a, b| effects[*a].total_cmp(&effects[*b]));
        let id = strongest.map_or("", |index| frame.candidates[self.candidates[index]].id);
        names.push(("catalogue", "effect", id.to_owned()));
        values.push(strongest.map_or(0.0, |index| effects[index]));
        Observed { values, names, scores }
    }

    fn scores(&self, residuals: DMatrix<f64>) -> DMatrix<f64> {
        self.design.scores(&residuals)
    }

    /// Statistics of data sets that the model draws; the scores of the first ones are kept.
    fn drawn(&self, numbers: Range<usize>, seed: u64) -> Vec<Draw> {
        let numbers: Vec<usize> = numbers.collect();
        let chunk = |numbers: &[usize]| -> Vec<Draw> {
            let sets: Vec<DVector<f64>> = numbers.iter().map(|number| self.data_set(*number, seed)).collect();
            let residuals = DMatrix::from_columns(&sets);
            let effects = self.catalogue.tr_mul(&residuals);
            let scores = self.scores(residuals);
            let values_of = |(index, number): (usize, &usize)| {
                let of_draw = scores.column(index).into_owned();
                let mut values = self.statistics(&of_draw);
                values.push(effects.column(index).iter().copied().reduce(f64::max).unwrap_or(0.0));
                (values, (*number < FIRST.0).then_some(of_draw))
            };
            numbers.iter().enumerate().map(values_of).collect()
        };
        numbers.par_chunks(SIDE_BY_SIDE).map(chunk).collect::<Vec<_>>().into_iter().flatten().collect()
    }

    fn statistics(&self, scores: &DVector<f64>) -> Vec<f64> {
        let statistics_of = |(_, places, layout): &(usize, Vec<usize>, Channel)| {
            let of_channel: Vec<f64> = places.iter().map(|place| scores[*place]).collect();
            Statistics::of(&of_channel, layout).values
        };
        self.channels.iter().flat_map(statistics_of).collect()
    }

    /// The whitened residual of data set `number`.
    fn data_set(&self, number: usize, seed: u64) -> DVector<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        random.set_stream(1 + number as u64);
        let [shared, own] = self.design.columns();
        let mut normal = |count: usize| DVector::from_fn(count, |_, _| StandardNormal.sample(&mut random));
        let (calibration, locals) =
            (normal(shared), (0..self.design.rows().count()).map(|_| normal(own)).collect::<Vec<_>>());
        let mut column = self.readings(&mut random);
        self.design.add(&calibration, &locals, &mut column);
        column
    }

    /// Whitened readings of a run with the scatter of the scenario, by sensors with their steps.
    fn readings(&self, random: &mut ChaCha8Rng) -> DVector<f64> {
        let measured = &self.model.frame().measured;
        let mut column = vec![0.0; measured.len()];
        let rows = || self.noise.chains.iter().flat_map(|chain| &chain.rows);
        let lots: Vec<f64> = (0..rows().map(|row| row.lot + 1).max().unwrap_or(0))
            .map(|_| StandardNormal.sample(&mut *random))
            .collect();
        self.noise.chains.iter().for_each(|chain| chain.add_draw(random, &lots, &mut column));
        for (i, observation) in measured.observations.iter().enumerate() {
            let channel = &measured.channels[observation.channel];
            let predicted = observation.value - self.fit.linear.residual[i];
            let z: f64 = StandardNormal.sample(&mut *random);
            let step = channel.sensor.resolution;
            let raw = |value: f64| if channel.transform == Transform::Log { value.exp() } else { value };
            // The deviation counts a step by its rectangular spread; the step itself is drawn below.
            let spread = step / raw(predicted) / 12.0_f64.sqrt();
            let spread = if channel.transform == Transform::Log { spread } else { step / 12.0_f64.sqrt() };
            let deviation = (self.noise.deviation(measured, i).powi(2) - spread.powi(2)).max(0.0).sqrt();
            let mut value = predicted + column[i] + deviation * z;
            if step > 0.0 {
                let read = (raw(value) / step).round() * step;
                value = if channel.transform == Transform::Log { read.max(0.5 * step).ln() } else { read };
            }
            column[i] = value - predicted;
        }
        let white = self.noise.whiten(measured, &column);
        DVector::from_iterator(self.places.len(), self.places.iter().map(|place| white[*place]))
    }

    /// The least drift of each channel over the calendar (without times over the age of the edge), per standard deviation
    /// of it, that would have been seen: statistics of the first draws with three sizes of it.
    fn least_seen(&self, judged: &Judged, draws: &[Draw], critical: f64) -> Vec<LeastSeen> {
        let frame = self.model.frame();
        let place = |name: &str| frame.covariates.iter().position(|covariate| covariate.name == name);
        let Some(along) = place("calendar").or_else(|| place("age of the edge")) else { return Vec::new() };
        let one = |(index, channel): (usize, &(usize, Vec<usize>, Channel))| {
            let about = &frame.measured.channels[channel.0];
            let value = self.least_drift(along, Statistic::ALL.len() * index, channel, judged, draws, critical);
            let what = format!("{} over {}", about.name, frame.covariates[along].name);
            let unit = if about.transform == Transform::Log { "1" } else { about.unit };
            LeastSeen { what, value, unit, power: POWER }
        };
        self.channels.par_iter().enumerate().map(one).collect()
    }

    fn least_drift(
        &self,
        along: usize,
        first: usize,
        (channel, places, layout): &(usize, Vec<usize>, Channel),
        judged: &Judged,
        draws: &[Draw],
        critical: f64,
    ) -> f64 {
        let frame = self.model.frame();
        let values = &frame.covariates[along].values;
        let drift = |each: &super::Observation| if each.channel == *channel { values[each.row] } else { 0.0 };
        let drift: Vec<f64> = frame.measured.observations.iter().map(drift).collect();
        let drift = self.noise.whiten(&frame.measured, &drift);
        let drift = DVector::from_iterator(self.places.len(), self.places.iter().map(|place| drift[*place]));
        let drift = self.scores(DMatrix::from_columns(&[drift]));
        let drift: Vec<f64> = places.iter().map(|place| drift[(*place, 0)]).collect();
        let seen = drift.iter().zip(&layout.covariates[along]).map(|(z, x)| z * x).sum::<f64>().abs();
        if seen < 1e-9 {
            return f64::INFINITY;
        }
        let [middle, high] = judged.scales[first + Statistic::Covariate as usize];
        let wanted = middle + critical * (high - middle) + 1.3;
        let power = |size: f64| {
            let (mut found, mut count) = (0.0, 0.0_f64);
            for scores in draws.iter().filter_map(|(_, scores)| scores.as_ref()) {
                let moved: Vec<f64> =
                    places.iter().zip(&drift).map(|(place, drift)| scores[*place] + size * drift).collect();
                let values = Statistics::of(&moved, layout).values;
                let beyond = |(i, value): (usize, &f64)| {
                    let [middle, high] = judged.scales[first + i];
                    high > middle && (value - middle) / (high - middle) > critical
                };
                found += f64::from(u8::from(values.iter().enumerate().any(beyond)));
                count += 1.0;
            }
            found / count.max(1.0)
        };
        let sizes = [0.7, 1.0, 1.4].map(|factor| factor * wanted / seen);
        interpolated(&sizes.map(|size| (size, power(size))), POWER).unwrap_or(f64::INFINITY)
    }

    /// How much the scores of each channel exceed what noise and scatter make.
    fn structure(&self, scores: &DVector<f64>) -> Vec<Structure> {
        let measured = &self.model.frame().measured;
        let one = |(channel, places, layout): &(usize, Vec<usize>, Channel)| {
            let squares: Vec<f64> = places.iter().map(|place| scores[*place].powi(2)).collect();
            let count = squares.len() as f64;
            let mean = squares.iter().sum::<f64>() / count;
            // Groups, not readings, are independent.
            let by_group: f64 = layout
                .groups
                .iter()
                .map(|group| squares[group.clone()].iter().map(|square| square - mean).sum::<f64>().powi(2))
                .sum();
            let error = (by_group.sqrt() / count).max((2.0 / count).sqrt());
            let about = &measured.channels[*channel];
            let mut sensor: Vec<f64> =
                places.iter().map(|place| measured.observations[self.places[*place]].deviation).collect();
            let sensor = toolroom_statistics::median(&mut sensor);
            let mut level: Vec<f64> =
                places.iter().map(|place| self.fit.linear.raw[self.places[*place]].abs()).collect();
            let (relative, typical) = (about.transform == Transform::Log, toolroom_statistics::median(&mut level));
            // In units of the sheet: a noise that was read off the records is part of what they hold beside it.
            let scale = self.noise.scale[*channel];
            let excess = (mean + super::constants::NINETY * error) * scale * scale - 1.0;
            let level = if relative { 1.0 } else { typical };
            Structure { channel: about.name, upper: sensor * excess.max(0.0).sqrt(), level, sensor }
        };
        self.channels.iter().map(one).collect()
    }
}

/// Scores of a channel: their places in the design, groups and covariates.
fn channel_of(
    model: &dyn Forward,
    measured: &Measured,
    places: &[usize],
    design: &Design,
    channel: usize,
) -> (usize, Vec<usize>, Channel) {
    let (mut locals, mut groups) = (Vec::new(), Vec::new());
    for rows in design.rows() {
        let first = locals.len();
        locals.extend(rows.filter(|row| measured.observations[places[*row]].channel == channel));
        groups.push(first..locals.len());
    }
    let covariate = |covariate: &super::Covariate| -> Vec<f64> {
        locals.iter().map(|row| covariate.values[measured.observations[places[*row]].row]).collect()
    };
    let covariates = model.frame().covariates.iter().map(covariate).collect();
    (channel, locals, Channel::new(groups, covariates))
}
