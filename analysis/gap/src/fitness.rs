//! Whether the calibrated nominal model fits, tested.
//!
//! Every group is predicted from the others. What is left, in units of what the model predicts for it, has to be
//! standard normal: in its level and scale, from group to group, from row to row, in its distribution, and along
//! everything that was recorded; nor may an effect of the catalogue show. All of that is judged at one level against
//! data sets that the model draws itself over the same rows and that are fitted as the records are.

use super::channel_scale::ChannelScale;
use super::constants::{FEWEST_VALUES, NULL_LEVEL};
use super::fit::offset_residual;
use super::gram::{factor, normal_equations, part};
use super::{
    Basis, ChannelId, EffectId, Fit, Fitness, Forward, LeastSeen, Measured, Noise, Part, Structure, Transform,
};
use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;
use std::borrow::Cow;
use std::ops::Range;
use toolroom_fit_test::{Channel, Design, Group, Judged, Statistic, Statistics, Structured, interpolated, judge};
use toolroom_nominal::features::standardised;

/// Drawn data sets, where the answer is not clear without (count). Derivation: probabilities down to 0.001.
const DRAWS: usize = 999;
/// Drawn data sets at first (count), and the probability above which they are enough. Derivation: p > 0.1 of 199 draws
/// is above the level of 0.01 but for less than one case in a million.
const FIRST: (usize, f64) = (199, 0.1);
/// Data sets that are drawn side by side (count).
const SIDE_BY_SIDE: usize = 20;
/// Power at which the least deviation counts as seen (1).
const POWER: f64 = 0.9;

/// Tests whether the model of `fit`, a fit with derivatives by all candidates, leaves what `basis` says of noise and scatter,
/// in the channels of which that is known: where short stops are part of the model, no longer in the cycle time.
pub(super) fn tested(model: &dyn Forward, basis: &Basis, fit: &Fit, folds: &[Vec<usize>], seed: u64) -> Fitness {
    judged(&Test::new(model, basis, fit, folds), basis, seed)
}

/// The same where nobody says beforehand how readings scatter, so that their noise was read off the records: its scale and
/// its distribution are no question then, nor is the mean, which no exchange changes. What is left may follow nothing, though: it has to be exchangeable among the
/// readings of a channel, and is held against data sets in which it is exchanged.
pub(super) fn exchangeable(model: &dyn Forward, basis: &Basis, fit: &Fit, folds: &[Vec<usize>], seed: u64) -> Fitness {
    judged(&Test::exchanging(model, basis, fit, folds), basis, seed)
}

fn judged(test: &Test<'_>, basis: &Basis, seed: u64) -> Fitness {
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

/// Statistics in the order in which they are asked whether any of them sees a drift: one that does saves the others, and
/// the shape of the distribution takes as long as all others together.
const LIKELIEST: [Statistic; Statistic::ALL.len()] =
    [Statistic::Covariate, Statistic::Groups, Statistic::Level, Statistic::Scale, Statistic::Memory, Statistic::Shape];
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
    /// What the fit leaves of each reading of the design, in units of its noise, where it is exchanged.
    innovations: Option<Vec<f64>>,
}

impl<'a> Test<'a> {
    fn new(model: &'a dyn Forward, basis: &Basis, fit: &'a Fit, folds: &[Vec<usize>]) -> Self {
        // Outliers count in full: they are what is requested.
        let mut noise = basis.noise.clone();
        noise.weight.fill(1.0);
        let frame = model.frame();
        let stopped = fit.active.iter().any(|active| frame.candidates[*active].id == EffectId::MICRO_STOPS);
        let told = |channel: usize| stopped && frame.measured.channels[channel].id == ChannelId::CycleTime;
        let known = |channel: usize| model.scatter_is_known(channel) && !told(channel);
        Self::of(model, basis, fit, folds, noise, &known)
    }

    fn exchanging(model: &'a dyn Forward, basis: &Basis, fit: &'a Fit, folds: &[Vec<usize>]) -> Self {
        let test = Self::of(model, basis, fit, folds, basis.noise.clone(), &|_| true);
        let innovations = test.innovations(basis);
        Self { innovations: Some(innovations), ..test }
    }

    fn of(
        model: &'a dyn Forward,
        basis: &Basis,
        fit: &'a Fit,
        folds: &[Vec<usize>],
        noise: Noise,
        takes_part: &dyn Fn(usize) -> bool,
    ) -> Self {
        let frame = model.frame();
        let measured = &frame.measured;
        let linear = &fit.linear;
        let fitted: Vec<usize> = measured.fitted_groups().collect();
        // In sequence, channels of a row beside each other: what is read later tells nothing of what was read before.
        let in_sequence = |group: &usize| {
            let mut places: Vec<usize> = measured.spans[*group].clone().collect();
            places.sort_by_key(|place| (measured.observations[*place].row, measured.observations[*place].channel));
            places
        };
        let sequences: Vec<Vec<usize>> = fitted.iter().map(in_sequence).collect();
        let places = sequences.concat();
        let white = |columns: &[Vec<f64>]| -> Vec<Vec<f64>> {
            columns.par_iter().map(|column| noise.whiten(measured, column)).collect()
        };
        let (shared, locals) = (white(&linear.nuisance), white(&linear.locals));
        let mut fold_of = vec![0; measured.groups.len()];
        folds.iter().enumerate().for_each(|(fold, groups)| groups.iter().for_each(|group| fold_of[*group] = fold));
        let group = |(group, places): (&usize, &Vec<usize>)| {
            let matrix = |columns: &[Vec<f64>], scale: &dyn Fn(usize) -> f64| {
                DMatrix::from_fn(places.len(), columns.len(), |i, j| columns[j][places[i]] * scale(j))
            };
            Group {
                shared: matrix(&shared, &|_| 1.0),
                covariance: matrix(&locals, &|kind| basis.local_scale[kind]),
                fold: fold_of[*group],
            }
        };
        let design = Design::new(fitted.iter().zip(&sequences).map(group).collect(), folds.len());
        let residual = noise.whiten(measured, &offset_residual(model, linear, &[]));
        let residual = DVector::from_iterator(places.len(), places.iter().map(|place| residual[*place]));
        let channels = (0..measured.channels.len())
            .filter(|channel| takes_part(*channel))
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
        let innovations = None;
        Self { model, fit, noise, places, design, residual, channels, catalogue, candidates, innovations }
    }

    /// What the fit leaves of each reading of the design, in units of the noise, made up for the freedom that the fit has
    /// taken.
    fn innovations(&self, basis: &Basis) -> Vec<f64> {
        let measured = &self.model.frame().measured;
        let linear = &self.fit.linear;
        let white = self.noise.whiten(measured, &linear.residual);
        let columns: Vec<&[f64]> = linear.nuisance.iter().map(Vec::as_slice).collect();
        let scale = &basis.local_scale;
        let gram = normal_equations(measured, &self.noise, linear, &columns, &linear.residual, scale, &[]);
        let shared: Vec<usize> = (0..columns.len()).collect();
        let mut precision = part(&gram.total, &shared, &shared);
        shared.iter().for_each(|i| precision[(*i, *i)] += 1.0);
        // The trace of the hat matrix: of what is shared, and of the factors of the groups.
        let by_shared: f64 = factor(precision).inverse_diagonal().iter().map(|variance| 1.0 - variance).sum();
        let own = |(kind, column): (usize, &Vec<f64>)| -> f64 {
            let white = self.noise.whiten(measured, column);
            let square = |group: usize| {
                let square: f64 = measured.spans[group].clone().map(|i| (white[i] * scale[kind]).powi(2)).sum();
                square / (1.0 + square)
            };
            measured.fitted_groups().map(square).sum()
        };
        let by_groups: f64 = linear.locals.iter().enumerate().map(own).sum();
        let count = self.places.len().max(1) as f64;
        // Where hardly any reading is free nothing can be told of them anyway.
        let freedom = (1.0 - (by_shared + by_groups) / count).max(0.2);
        self.places.iter().map(|place| white[*place] / freedom.sqrt()).collect()
    }

    /// The innovations, those of each channel in another order. What does not scatter stays among its like.
    fn exchanged(&self, innovations: &[f64], random: &mut ChaCha8Rng) -> DVector<f64> {
        let exact = &self.model.frame().measured.exact;
        let mut column = DVector::from_column_slice(innovations);
        for (_, places, _) in &self.channels {
            let (exact, scattering): (Vec<usize>, Vec<usize>) =
                places.iter().partition(|place| exact[self.places[**place]]);
            for alike in [exact, scattering] {
                for last in (1..alike.len()).rev() {
                    column.swap_rows(alike[last], alike[random.random_range(0..=last)]);
                }
            }
        }
        column
    }

    /// Whether the test asks for a statistic: not for those of the noise where that was read off the records, nor for the
    /// mean, which no exchange changes.
    fn asks(&self, statistic: Statistic) -> bool {
        self.innovations.is_none() || ![Statistic::Level, Statistic::Scale, Statistic::Shape].contains(&statistic)
    }

    /// The statistics of a channel that the test asks for; the others are at zero.
    fn asked(&self, scores: &[f64], layout: &Channel) -> Statistics {
        Statistics::where_asked(scores, layout, |statistic| self.asks(statistic))
    }

    fn observed(&self) -> Observed {
        let frame = self.model.frame();
        let scores = self.scores(DMatrix::from_columns(std::slice::from_ref(&self.residual)));
        let scores: DVector<f64> = scores.column(0).into_owned();
        let (mut values, mut names) = (Vec::new(), Vec::new());
        for (channel, places, layout) in &self.channels {
            let of_channel: Vec<f64> = places.iter().map(|place| scores[*place]).collect();
            let statistics = self.asked(&of_channel, layout);
            for statistic in Statistic::ALL {
                let follows = statistics.strongest.filter(|_| statistic == Statistic::Covariate);
                let follows = follows.map_or_else(String::new, |index| frame.covariates[index].name.clone());
                names.push((frame.measured.channels[*channel].id.word(), statistic.name(), follows));
                values.push(statistics.get(statistic));
            }
        }
        let effects = self.catalogue.tr_mul(&self.residual);
        let strongest = (0..effects.len()).max_by(|a, b| effects[*a].total_cmp(&effects[*b]));
        let id = strongest.map_or("", |index| frame.candidates[self.candidates[index]].id.word());
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
            let sets = self.data_sets(numbers, seed);
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
            self.asked(&of_channel, layout).values
        };
        self.channels.iter().flat_map(statistics_of).collect()
    }

    /// The whitened residuals of the data sets `numbers`.
    fn data_sets(&self, numbers: &[usize], seed: u64) -> Vec<DVector<f64>> {
        let [shared, own] = self.design.columns();
        let set = |number: &usize| {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            random.set_stream(1 + *number as u64);
            let mut normal = |count: usize| DVector::from_fn(count, |_, _| StandardNormal.sample(&mut random));
            let calibration = normal(shared);
            let locals: Vec<DVector<f64>> = (0..self.design.rows().count()).map(|_| normal(own)).collect();
            let column = match &self.innovations {
                Some(innovations) => self.exchanged(innovations, &mut random),
                None => self.readings(&mut random),
            };
            ((calibration, locals), column)
        };
        let (moves, mut columns): (Vec<_>, Vec<_>) = numbers.iter().map(set).unzip();
        self.design.add(&moves, &mut columns);
        columns
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
            let what = format!("{} over {}", about.id, frame.covariates[along].name);
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
        let values = about_mean(&frame.covariates[along]);
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
                let beyond = |statistic: &Statistic| {
                    let [middle, high] = judged.scales[first + *statistic as usize];
                    high > middle && (statistic.of(&moved, layout) - middle) / (high - middle) > critical
                };
                found += f64::from(u8::from(LIKELIEST.iter().filter(|own| self.asks(**own)).any(beyond)));
                count += 1.0;
            }
            found / count.max(1.0)
        };
        let sizes = [0.7, 1.0, 1.4].map(|factor| factor * wanted / seen);
        interpolated(&sizes.map(|size| (size, power(size))), POWER).unwrap_or(f64::INFINITY)
    }

    /// How much the scores of each channel follow that noise and scatter do not.
    fn structure(&self, scores: &DVector<f64>) -> Vec<Structure> {
        let measured = &self.model.frame().measured;
        let one = |(channel, places, layout): &(usize, Vec<usize>, Channel)| {
            let of_channel: Vec<f64> = places.iter().map(|place| scores[*place]).collect();
            let count = of_channel.len() as f64;
            let mean = of_channel.iter().map(|z| z * z).sum::<f64>() / count;
            let (estimate, error) = match Structured::from_scores(&of_channel, layout) {
                Some(own) => (own.mean_square, own.error),
                // All that is beyond the noise of the sheet may be structure; groups, not readings, are independent.
                None => {
                    let of_group =
                        |group: &Range<usize>| of_channel[group.clone()].iter().map(|z| z * z - mean).sum::<f64>();
                    let by_group =
                        layout.groups.iter().map(|group| of_group(group).powi(2)).sum::<f64>().sqrt() / count;
                    (mean - 1.0, by_group.max((2.0 / count).sqrt()))
                }
            };
            let upper = estimate + super::constants::NINETY * error;
            let about = &measured.channels[*channel];
            let own: Vec<usize> = places.iter().map(|place| self.places[*place]).collect();
            let scale = ChannelScale::new(measured, &self.noise, &self.fit.linear.raw, *channel, &own);
            Structure {
                channel: about.id,
                rms: scale.sensor * estimate.max(0.0).sqrt(),
                upper: scale.sensor * upper.max(0.0).sqrt(),
                scatter: scale.sensor * mean.sqrt(),
                scale,
            }
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
        let values = about_mean(covariate);
        locals.iter().map(|row| values[measured.observations[places[*row]].row]).collect()
    };
    let covariates = model.frame().covariates.iter().map(covariate).collect();
    let own_scale = measured.unstated[channel];
    (channel, locals, Channel { own_scale, ..Channel::new(groups, covariates) })
}

/// The covariate about its mean, so that what all readings have in common follows none.
fn about_mean(covariate: &super::Covariate) -> Cow<'_, [f64]> {
    standardised(&covariate.values).map_or(Cow::Borrowed(&covariate.values), Cow::Owned)
}
