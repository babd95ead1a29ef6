//! Terms that describe a gap of which nobody knows the cause: empirical, and no cause.
//!
//! Terms of a library are sought one after the other beside the calibrated model and its form allowance (orthogonal
//! matching pursuit). Each step refits the best few and takes the one that predicts best on groups left out. How far that
//! closes the gap is then counted on groups that the choice has never seen: of the best of many terms the closure on the
//! groups that chose it would be too high.
//!
//! # Source
//! Tropp 2004 (orthogonal matching pursuit).

use super::closure::{closures, touched_by};
use super::constants::{FEWEST_GROUPS, GATE, LEAST_CLOSED, LEAST_OF_CLOSABLE, PAIRED_SCORE, SAME};
use super::diagnosing::Diagnosing;
use super::discrepancy::Widened;
use super::evidence::{folds, gain, predictive_gain};
use super::left_out::LeftOut;
use super::settle::settled;
use super::trial::Trial;
use super::{Basis, Closure, Fit, Forward, Method};
use rayon::prelude::*;

/// Terms that are proposed together at most (count). Assumption: more would be a model of their own.
const MOST_TERMS: usize = 2;
/// Terms that are fitted anew in a step (count). Assumption: the best is among them.
const REFITTED: usize = 6;
/// Terms that count as one choice (count). Assumption: neighbouring powers of a quantity are nearly the same term.
const ALIKE: f64 = 10.0;
/// Standard errors by which left-out groups have to be predicted better (1). Assumption: about 95 %.
const CERTAIN: f64 = 2.0;

/// A term that is proposed.
#[derive(Clone, Debug, PartialEq)]
pub struct ProposedTerm {
    /// Its id.
    pub id: &'static str,
    /// Size, SI, in the fit to the groups that chose it.
    pub size: f64,
    /// Standard error of the size, SI.
    pub standard_error: f64,
    /// Terms that the data cannot tell from it.
    pub as_good: Vec<&'static str>,
}

/// What describes a gap.
#[derive(Clone, Debug, PartialEq)]
pub struct Proposal {
    /// The terms.
    pub terms: Vec<ProposedTerm>,
    /// Gain of log predictive density on groups left out in the choice, and its standard error.
    pub left_out: [f64; 2],
    /// Closure on groups that had no part in the choice.
    pub closure: Closure,
}

/// The terms among the candidates of `model` for which `is_term` holds that describe its gap; `None` where none does for
/// certain. Groups that are not fitted have no part in the choice, and say how far it closes.
pub fn propose(model: &dyn Forward, is_term: &dyn Fn(&str) -> bool, seed: u64) -> Option<Proposal> {
    let measured = &model.frame().measured;
    let kept_out = |group: &usize| !measured.fitted[*group] && !measured.spans[*group].is_empty();
    let outside: Vec<usize> = (0..measured.groups.len()).filter(kept_out).collect();
    if outside.len() < FEWEST_GROUPS || measured.fitted_groups().count() < FEWEST_GROUPS {
        return None;
    }
    let terms: Vec<usize> = model
        .frame()
        .candidates
        .iter()
        .enumerate()
        .filter(|(_, own)| is_term(own.id))
        .map(|(index, _)| index)
        .collect();
    let method = Method::default();
    let (basis, fit) = settled(model, method);
    match Widened::new(model, &basis, &fit) {
        None => sought(model, &basis, fit, &terms, &outside, seed),
        Some(widened) => {
            let (basis, fit) = settled(&widened.model, method);
            sought(&widened.model, &basis, fit, &terms, &outside, seed)
        }
    }
}

fn sought(
    model: &dyn Forward,
    basis: &Basis,
    fit: Fit,
    terms: &[usize],
    outside: &[usize],
    seed: u64,
) -> Option<Proposal> {
    let folds = folds(&model.frame().measured);
    let context = Diagnosing { model, basis, folds: &folds, seed };
    let base = context.trial_of(fit);
    let mut chosen: Option<Trial> = None;
    for _ in 0..MOST_TERMS {
        let from = chosen.clone().unwrap_or_else(|| base.clone());
        let Some(next) = step(context, &from, terms) else { break };
        chosen = Some(next.complete(model, basis, &folds));
    }
    let chosen = chosen?;
    let (before, after) =
        rayon::join(|| LeftOut::of(model, basis, &base, &[]), || LeftOut::of(model, basis, &chosen, &[]));
    let touched = touched_by(model, &chosen.fit.active);
    let (closure, _) = closures(model, basis, &before, &after, outside, &touched, seed);
    let much = closure.of_closable.is_nan() || closure.of_closable >= LEAST_OF_CLOSABLE;
    if closure.ci90[0].is_nan() || closure.ci90[0] <= LEAST_CLOSED || !much {
        return None;
    }
    let candidates = &model.frame().candidates;
    let cosine = base.scores().cosine;
    let deviations = chosen.deviations();
    let term = |(place, index): (usize, &usize)| {
        let same = |other: &&usize| **other != *index && cosine[(*index, **other)].abs() > SAME;
        ProposedTerm {
            id: candidates[*index].id,
            size: chosen.fit.linear.point.effects[*index],
            standard_error: deviations[place] * candidates[*index].typical,
            as_good: terms.iter().filter(same).map(|other| candidates[*other].id).collect(),
        }
    };
    let (left_out, error) = predictive_gain(&chosen.evidence, &base.evidence);
    let terms = chosen.fit.active.iter().enumerate().map(term).collect();
    Some(Proposal { terms, left_out: [left_out, error], closure })
}

/// The model of `from` with the term that predicts groups left out best, where one is asked for.
fn step(context: Diagnosing<'_>, from: &Trial, terms: &[usize]) -> Option<Trial> {
    let scores = from.strengths();
    let open = terms.iter().filter(|index| !from.fit.active.contains(index) && scores[**index] > PAIRED_SCORE);
    let mut leads: Vec<(usize, f64)> = open
        .map(|index| (*index, from.with(*index)))
        .filter(|(_, evidence)| evidence.admissible)
        .map(|(index, evidence)| (index, gain(&evidence, &from.evidence)))
        .collect();
    leads.sort_by(|a, b| b.1.total_cmp(&a.1));
    leads.truncate(REFITTED);
    let one = |(index, _): &(usize, f64)| {
        let mut active = from.fit.active.clone();
        active.push(*index);
        active.sort_unstable();
        context.trial(&from.fit, &active)
    };
    let fitted: Vec<Trial> = leads.par_iter().map(one).collect();
    let price = (terms.len() as f64 / ALIKE).max(1.0).ln();
    let asked_for = |trial: &Trial| {
        let (lead, error) = predictive_gain(&trial.evidence, &from.evidence);
        let certain = trial.evidence.admissible && lead > CERTAIN * error;
        (certain && gain(&trial.evidence, &from.evidence) > GATE + price).then_some(lead)
    };
    let kept = fitted.into_iter().filter_map(|trial| Some((asked_for(&trial)?, trial)));
    kept.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, trial)| trial)
}
