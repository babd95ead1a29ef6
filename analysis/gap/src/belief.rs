//! How far calibration may go before it is a finding of its own.
//!
//! A constant that leaves its prior by many standard deviations explains much at a price, and the evidence asks that
//! price. A prediction of groups left out does not: there a constant that went fifteen standard deviations counts as
//! much as one that went none, and nothing is left for the cause that it stood in for. So a model with effects is
//! held against the model without them **within belief**: no constant goes farther than [`FAR_CONSTANT`] there, or than
//! the model with the effects needs it to go as well.

use super::closure::{closures, touched};
use super::constants::FAR_CONSTANT;
use super::diagnosing::Diagnosing;
use super::evidence::solution;
use super::fit::fit_within;
use super::left_out::{LeftOut, scoring};
use super::trial::Trial;
use super::{Closure, Forward, Linear};

/// Where the calibration of `trial` stands without its form allowance: parameters, then surfaces, in prior standard
/// deviations; zero for the allowance.
fn calibration(model: &dyn Forward, trial: &Trial) -> Vec<f64> {
    let at = scoring(model, trial);
    let found = solution(&trial.gram, &at, trial.shared, &[]);
    let mut moved = vec![0.0; trial.fit.linear.nuisance.len()];
    at.iter().zip(found.iter()).take_while(|(i, _)| **i < trial.shared).for_each(|(i, x)| moved[*i] = *x);
    moved
}

/// Draws the reach of the constants of a family in where they went farther together than is believed of so many, or than
/// the model with effects needs them to: many that each go two standard deviations are as little believed as one that goes
/// six. The sum of n squares of standard normal numbers has the mean n and the standard deviation √2n.
fn together(model: &dyn Forward, moved: &[f64], needed: &[f64], reach: &mut [f64]) {
    let frame = model.frame();
    let place = |name: &String| frame.surfaces.iter().position(|surface| surface.name == *name);
    for family in &frame.families {
        let members: Vec<usize> =
            family.surfaces.iter().filter_map(place).map(|surface| frame.parameters.len() + surface).collect();
        let length = |all: &[f64]| members.iter().map(|i| all.get(*i).map_or(0.0, |x| x * x)).sum::<f64>().sqrt();
        let count = members.len() as f64;
        let believed = (count + FAR_CONSTANT * (2.0 * count).sqrt()).sqrt().max(length(needed));
        let gone = length(moved);
        if gone > believed {
            members.iter().for_each(|i| reach[*i] = reach[*i].min(moved[*i].abs() * believed / gone));
        }
    }
}

/// The model of `previous` with no constant farther from nominal than is believed, or than `after` needs it; `None` where
/// that is how it stands.
fn believed(context: Diagnosing<'_>, previous: &Trial, after: Option<&Trial>) -> Option<Trial> {
    let Diagnosing { model, basis, folds, .. } = context;
    let needed = after.map(|after| calibration(model, after)).unwrap_or_default();
    let moved = calibration(model, previous);
    let reach = |(i, allowance): (usize, &bool)| {
        if *allowance { f64::INFINITY } else { needed.get(i).map_or(0.0, |x: &f64| x.abs()).max(FAR_CONSTANT) }
    };
    let mut reach: Vec<f64> = model.frame().allowances().iter().enumerate().map(reach).collect();
    together(model, &moved, &needed, &mut reach);
    if moved.iter().zip(&reach).all(|(x, reach)| x.abs() <= *reach) {
        return None;
    }
    let (linear, active) = (&previous.fit.linear, &previous.fit.active);
    let mut point = linear.point.clone();
    let parameters = point.parameters.len();
    let near = |(x, reach): (&mut f64, &f64)| *x = x.clamp(-reach, *reach);
    point.parameters.iter_mut().zip(&reach).for_each(near);
    point.surfaces.iter_mut().zip(&reach[parameters..]).for_each(near);
    let start = Linear::with(model, point, active);
    let fit = fit_within(model, &basis.noise, start, active, &basis.local_scale, &reach);
    Some(Trial::of(model, basis, folds, fit.settled(model)).within(reach))
}

/// Whether the model of `next_trial` does without a constant beyond belief that the model of `previous` needs.
pub(super) fn spares(context: Diagnosing<'_>, previous: &Trial, next_trial: &Trial) -> bool {
    believed(context, previous, Some(next_trial)).is_some()
}

/// What constants that go beyond belief close on groups left out; `None` where none does.
pub(super) fn closed_by_constants(context: Diagnosing<'_>, base: &Trial) -> Option<Closure> {
    let Diagnosing { model, basis, seed, .. } = context;
    let within = believed(context, base, None)?;
    let (before, after) = rayon::join(|| context.left_out(&within), || context.left_out(base));
    let groups: Vec<usize> = model.frame().measured.fitted_groups().collect();
    Some(closures(model, basis, &before, &after, &groups, &[], seed).0)
}

/// Residuals of groups left out: of `previous` within belief, and of `next_trial`; `left_out` works out those of one model.
pub(super) fn held_against<'a>(
    context: Diagnosing<'a>,
    previous: &Trial,
    next_trial: &Trial,
    left_out: impl Fn(Diagnosing<'a>, &Trial) -> LeftOut + Sync,
) -> (LeftOut, LeftOut) {
    let within = || match believed(context, previous, Some(next_trial)) {
        Some(within) => left_out(context, &within),
        None => left_out(context, previous),
    };
    rayon::join(within, || left_out(context, next_trial))
}

/// Closure of `trial` over the nominal `base` on the groups of the fit, each predicted by a fit to
/// the others; what is kept out of the fit altogether has no part in a decision.
pub(super) fn crossed(context: Diagnosing<'_>, base: &Trial, trial: &Trial) -> Closure {
    let Diagnosing { model, basis, seed, .. } = context;
    let (before, after) = held_against(context, base, trial, Diagnosing::left_out);
    let groups: Vec<usize> = model.frame().measured.fitted_groups().collect();
    closures(model, basis, &before, &after, &groups, &touched(model, trial), seed).0
}
