//! How far the gap shrinks on groups that the fit did not see.

use super::diagnose::{entry, settled};
use super::evidence::{left_out_solutions, solution};
use super::fit::{offset_residual, own_factors};
use super::noise::HUBER;
use super::trial::{Trial, columns};
use super::{Basis, Closure, Diagnosed, Direction, Forward, Frame, Measured, Method, Point};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;

/// Resamples of groups for an interval.
const RESAMPLES: usize = 400;

/// Residuals of every observation predicted without its own group: the fit that predicts a group
/// has not seen it. Of the group's own factors, those that are mere scatter follow its readings, with
/// or without an effect: no model of means predicts them, and beside them a gap of the means would
/// drown. The others are unknown. The form allowance protects the attribution only: it is no part of
/// the model that is scored.
pub fn held_out_residuals(model: &dyn Forward, basis: &Basis, trial: &Trial, folds: &[Vec<usize>]) -> Vec<f64> {
    let measured = &model.frame().measured;
    let linear = &trial.fit.linear;
    let nuisance = linear.nuisance.len();
    let parameters = model.frame().parameters.iter().map(|parameter| parameter.allowance);
    let allowance: Vec<bool> =
        parameters.chain(model.frame().surfaces.iter().map(|surface| surface.allowance)).collect();
    let shared = trial.shared;
    let mut at: Vec<usize> = columns(shared, &trial.fit.active);
    at.retain(|i| *i >= shared || (*i < nuisance && !allowance[*i]));
    let solutions = left_out_solutions(&trial.gram, &at, shared);
    let mut left = offset_residual(model, linear, &trial.fit.active);
    let column = |i: usize| if i < nuisance { &linear.nuisance[i] } else { &linear.effects[i - shared] };
    // Groups outside the fit are predicted by the fit to all that is inside.
    let whole = solution(&trial.gram, &at, shared);
    let mut fold_of = vec![None; measured.groups.len()];
    for (index, fold) in folds.iter().enumerate() {
        fold.iter().for_each(|group| fold_of[*group] = Some(index));
    }
    for (span, fold) in measured.spans.iter().zip(fold_of) {
        let solution = fold.map_or(&whole, |fold| &solutions[fold]);
        for (i, x) in at.iter().zip(solution.iter()) {
            let slope = column(*i);
            span.clone().for_each(|row| left[row] -= slope[row] * x);
        }
    }
    let own = own_factors(model, &basis.noise, linear, &left, &basis.local_scale);
    for ((column, x), local) in linear.locals.iter().zip(&own).zip(&model.frame().locals) {
        if local.scatter {
            let each = measured.spans.iter().zip(x).flat_map(|(span, x)| span.clone().map(move |row| (row, x)));
            each.for_each(|(row, x)| left[row] -= column[row] * x);
        }
    }
    left
}

/// Closure on groups that were kept out of the fit, of any effects that one asks about: by how much
/// an effect that is known to be there would close the gap.
pub struct Outside<'a> {
    model: &'a dyn Forward,
    basis: Basis,
    base: Trial,
    left: Vec<f64>,
    groups: Vec<usize>,
}

impl<'a> Outside<'a> {
    /// Fits the nominal model to the groups that are to be fitted; `None` where none is kept out.
    pub fn new(model: &'a dyn Forward) -> Option<Self> {
        let measured = &model.frame().measured;
        let kept_out = |group: &usize| !measured.fitted[*group] && !measured.spans[*group].is_empty();
        let groups: Vec<usize> = (0..measured.groups.len()).filter(kept_out).collect();
        if groups.is_empty() {
            return None;
        }
        let (basis, fit) = settled(model, Method::default());
        let base = Trial::of(model, &basis, &[], fit);
        let left = held_out_residuals(model, &basis, &base, &[]);
        Some(Self { model, basis, base, left, groups })
    }

    /// Closure of the candidates `active` over the channels `touched`, and what their fit costs.
    pub fn closure(&self, active: &[usize], touched: &[&str], seed: u64) -> (Closure, f64) {
        let trial = Trial::new(self.model, &self.basis, &[], &self.base.fit, active);
        let chosen = held_out_residuals(self.model, &self.basis, &trial, &[]);
        let (total, _) = closures(self.model, &self.basis, &self.left, &chosen, &self.groups, touched, seed);
        (total, trial.fit.cost)
    }

    /// Size (SI) of the candidate `index` that the groups kept out ask for by themselves.
    pub fn size(&self, index: usize) -> f64 {
        let mut frame = self.model.frame().clone();
        frame.measured.fitted.iter_mut().for_each(|fitted| *fitted = !*fitted);
        let turned = Turned { model: self.model, frame };
        let trial = Trial::new(&turned, &self.basis, &[], &self.base.fit, &[index]);
        trial.fit.linear.point.effects[index]
    }
}

/// A model with fitted groups and those kept out exchanged.
struct Turned<'a> {
    model: &'a dyn Forward,
    frame: Frame,
}

impl Forward for Turned<'_> {
    fn frame(&self) -> &Frame {
        &self.frame
    }

    fn simulate(&self, at: &Point) -> Vec<f64> {
        self.model.simulate(at)
    }

    fn slopes(&self, at: &Point, raw: &[f64], along: &[Direction]) -> Vec<Vec<f64>> {
        self.model.slopes(at, raw, along)
    }
}

/// Sums of squares of the groups on which a closure is scored.
struct Sums {
    before: Vec<f64>,
    after: Vec<f64>,
    floor: Vec<f64>,
    count: Vec<f64>,
}

/// Closure by channel and over those that are `touched` (all, if none is named); the total is in
/// units of noise.
pub fn closures(
    model: &dyn Forward,
    basis: &Basis,
    base: &[f64],
    chosen: &[f64],
    scored: &[usize],
    touched: &[&str],
    seed: u64,
) -> (Closure, Vec<(&'static str, Closure)>) {
    let measured = &model.frame().measured;
    let among = counted(measured, touched);
    let sums = |channel: Option<usize>| {
        let counts = |i: usize| match channel {
            Some(channel) => measured.observations[i].channel == channel,
            None => among[measured.observations[i].channel],
        };
        let mut sums = Sums { before: Vec::new(), after: Vec::new(), floor: Vec::new(), count: Vec::new() };
        for group in scored {
            let inside = measured.spans[*group].clone();
            let inside = inside.filter(|i| counts(*i));
            let (mut before, mut after, mut floor, mut count) = (0.0, 0.0, 0.0, 0.0);
            for i in inside {
                let unit = basis.noise.deviation(measured, i);
                let scale = if channel.is_none() { unit } else { 1.0 };
                before += huber(base[i] / unit) * (unit / scale).powi(2);
                after += huber(chosen[i] / unit) * (unit / scale).powi(2);
                floor += (unit / scale).powi(2);
                count += 1.0;
            }
            sums.before.push(before);
            sums.after.push(after);
            sums.floor.push(floor);
            sums.count.push(count);
        }
        sums
    };
    let channels = measured.channels.iter().enumerate();
    let channels = channels.map(|(index, channel)| (channel.name, closure(&sums(Some(index)), seed))).collect();
    (closure(&sums(None), seed), channels)
}

/// Closure over several models, in units of noise; those of one process share groups of one name.
/// Where an effect is named only the channels count that it touches.
pub fn pooled(parts: &[(usize, &dyn Forward, &Diagnosed)], seed: u64) -> Closure {
    let mut sums: BTreeMap<(usize, &str), [f64; 4]> = BTreeMap::new();
    for (process, model, diagnosed) in parts {
        let measured = &model.frame().measured;
        let [base, chosen] = &diagnosed.held_out;
        let rows = diagnosed.diagnosis.effects.iter().filter_map(|effect| entry(effect.id));
        let touched: Vec<&str> = rows.flat_map(|entry| entry.channels.iter().map(|own| own.channel)).collect();
        let counts = counted(measured, &touched);
        for group in scored(measured) {
            let own = sums.entry((*process, measured.groups[group].as_str())).or_default();
            for i in measured.spans[group].clone().filter(|i| counts[measured.observations[*i].channel]) {
                let unit = diagnosed.basis.noise.deviation(measured, i);
                let each = [huber(base[i] / unit), huber(chosen[i] / unit), 1.0, 1.0];
                own.iter_mut().zip(each).for_each(|(sum, value)| *sum += value);
            }
        }
    }
    let column = |at: usize| sums.values().map(|own| own[at]).collect();
    closure(&Sums { before: column(0), after: column(1), floor: column(2), count: column(3) }, seed)
}

/// Whether each channel counts for effects that touch some: all, if none of them is measured.
fn counted(measured: &Measured, touched: &[&str]) -> Vec<bool> {
    let own: Vec<bool> = measured.channels.iter().map(|channel| touched.contains(&channel.name)).collect();
    // An effect may act where the catalogue does not list it: then everything counts.
    if own.iter().any(|counts| *counts) { own } else { vec![true; own.len()] }
}

/// Channels that the effects of a trial touch.
pub fn touched(model: &dyn Forward, trial: &Trial) -> Vec<&'static str> {
    let rows = trial.fit.active.iter().filter_map(|index| entry(model.frame().candidates[*index].id));
    rows.flat_map(|entry| entry.channels.iter().map(|touched| touched.channel)).collect()
}

/// Closure of `trial` over the nominal `base` on the groups of the fit, each predicted by a fit to
/// the others; what is kept out of the fit altogether has no part in a decision.
pub fn crossed(
    model: &dyn Forward,
    basis: &Basis,
    folds: &[Vec<usize>],
    base: &Trial,
    trial: &Trial,
    seed: u64,
) -> Closure {
    let [before, after] = [base, trial].map(|each| held_out_residuals(model, basis, each, folds));
    let groups: Vec<usize> = model.frame().measured.fitted_groups().collect();
    closures(model, basis, &before, &after, &groups, &touched(model, trial), seed).0
}

/// Groups on which a closure is scored: those outside the fit, or all.
pub fn scored(measured: &Measured) -> Vec<usize> {
    let outside: Vec<usize> = (0..measured.groups.len())
        .filter(|group| !measured.fitted[*group] && !measured.spans[*group].is_empty())
        .collect();
    if outside.is_empty() { measured.fitted_groups().collect() } else { outside }
}

/// Square up to far outliers, then linear: a single reading does not decide about a gap.
fn huber(standard: f64) -> f64 {
    let far = 4.0 * HUBER;
    if standard.abs() <= far { standard * standard } else { far * (2.0 * standard.abs() - far) }
}

fn closure(sums: &Sums, seed: u64) -> Closure {
    let groups: Vec<usize> = (0..sums.count.len()).filter(|i| sums.count[*i] > 0.0).collect();
    // Every group counts alike: else the one with the most readings would decide.
    let root = |values: &[f64], groups: &[usize]| {
        (groups.iter().map(|i| values[*i] / sums.count[*i]).sum::<f64>() / groups.len() as f64).sqrt()
    };
    let closed = |groups: &[usize]| 1.0 - root(&sums.after, groups) / root(&sums.before, groups);
    let (before, after, floor) = (root(&sums.before, &groups), root(&sums.after, &groups), root(&sums.floor, &groups));
    let value = closed(&groups);
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut draws: Vec<f64> = (0..RESAMPLES)
        .map(|_| {
            let sample: Vec<usize> = groups.iter().map(|_| groups[random.random_range(0..groups.len())]).collect();
            closed(&sample)
        })
        .filter(|draw| draw.is_finite())
        .collect();
    draws.sort_by(f64::total_cmp);
    let quantile = |share: f64| {
        draws.get(((draws.len() as f64 * share) as usize).min(draws.len().saturating_sub(1))).copied().unwrap_or(value)
    };
    // Resampling few groups gives intervals that are too short: those of Student against those of
    // the normal, with one degree of freedom less for the mean.
    let count = groups.len() as f64;
    let wider = crate::statistics::student(0.9, count - 1.0) / 1.645 * (count / (count - 1.0)).sqrt();
    let stretch = |end: f64| (value + (end - value) * if wider.is_finite() { wider } else { 3.0 }).min(1.0);
    let closable = before * before - floor * floor;
    Closure {
        before,
        after,
        closed: value,
        ci90: [stretch(quantile(0.05)), stretch(quantile(0.95))],
        of_closable: if closable > 0.0 { (before * before - after * after) / closable } else { f64::NAN },
    }
}
