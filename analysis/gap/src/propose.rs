//! Terms that describe a gap of which nobody knows the cause: empirical, and no cause.
//!
//! Terms of a library are sought one after the other beside the calibrated model, its form allowance and its discrepancy
//! (orthogonal matching pursuit). Each step refits the best few and takes the one that predicts best on groups left out. How
//! far that closes the gap is counted by choosing anew without a third of the groups at a time and predicting these
//! (nested folds): of the best of many terms the closure on the groups that chose it would be too high.
//!
//! # Source
//! Tropp 2004 (orthogonal matching pursuit); Varma & Simon 2006 (nested cross-validation).

use super::closure::{closures, touched_by};
use super::constants::{
    AGREED, ALIKE_TERMS, FEWEST_GROUPS, GATE, LEAST_CLOSED, LEAST_OF_CLOSABLE, MOST_TERMS, PAIRED_SCORE,
    REFITTED_TERMS, SAME, SIMPLER_TERM,
};
use super::diagnosing::Diagnosing;
use super::discrepancy::Widened;
use super::evidence::{folds, gain, predictive_gain};
use super::left_out::LeftOut;
use super::settle::settled;
use super::trial::Trial;
use super::{Basis, Closure, Fit, Forward, Method, Point};
use rayon::prelude::*;

/// A term that is proposed.
#[derive(Clone, Debug, PartialEq)]
pub struct ProposedTerm {
    /// Its candidate.
    pub candidate: usize,
    /// Its size in the fit to all fitted groups, SI.
    pub size: f64,
    /// Standard error of the size, SI.
    pub standard_error: f64,
    /// Candidates that the data cannot tell from it.
    pub as_good: Vec<usize>,
}

/// What describes a gap.
pub struct Proposal {
    /// The terms.
    pub terms: Vec<ProposedTerm>,
    /// Gain of log predictive density on groups left out in the choice, and its standard error.
    pub left_out: [f64; 2],
    /// Closure on groups that had no part in the choice.
    pub closure: Closure,
    /// Noise and scatter by which the terms were chosen.
    pub basis: Basis,
    /// Where the model stood without and with the terms, its discrepancy included.
    pub points: [Point; 2],
}

/// A model in which terms are sought.
#[derive(Clone, Copy)]
pub struct Library<'a> {
    /// The model over the records.
    pub model: &'a dyn Forward,
    /// Candidates that are in the model already: named effects.
    pub named: &'a [usize],
    /// Candidates among which terms are sought, those of one quantity at most first.
    pub terms: &'a [usize],
    /// How many of them are of one quantity at most.
    pub simple: usize,
}

/// The terms of `whole` that describe its gap; `None` where none does for certain. `without` are the same model and
/// candidates, each with another part of the groups of `whole` kept out of its fit; together they keep out all of them.
pub fn propose(whole: &Library<'_>, without: &[&dyn Forward], seed: u64) -> Option<Proposal> {
    let measured = &whole.model.frame().measured;
    let fewest = without.iter().map(|model| model.frame().measured.fitted_groups().count()).min()?;
    let alike = |model: &&dyn Forward| model.frame().measured.len() == measured.len();
    if fewest < FEWEST_GROUPS || !without.iter().all(alike) {
        return None;
    }
    let method = Method::default();
    let (basis, fit) = settled(whole.model, method);
    let widened = Widened::new(whole.model, &basis, &fit);
    let (model, basis, fit): (&dyn Forward, _, _) = match &widened {
        None => (whole.model, basis, fit),
        Some(widened) => {
            let (basis, fit) = settled(&widened.model, method);
            (&widened.model, basis, fit)
        }
    };
    let folds = folds(&model.frame().measured);
    let context = Diagnosing { model, basis: &basis, folds: &folds, seed };
    let (base, chosen) = sought(context, fit, whole);
    let chosen = chosen?;
    // Every part is predicted by terms that were chosen without it.
    let unseen: Vec<(Vec<f64>, Vec<f64>)> =
        without.par_iter().map(|model| left(&Library { model: *model, ..*whole }, seed)).collect();
    let mut residuals = [vec![0.0; measured.len()], vec![0.0; measured.len()]];
    let mut scored = Vec::new();
    for (part, (before, after)) in without.iter().zip(&unseen) {
        let own = &part.frame().measured;
        let kept_out = measured.fitted_groups().filter(|group| !own.fitted[*group]);
        for group in kept_out {
            for i in measured.spans[group].clone() {
                (residuals[0][i], residuals[1][i]) = (before[i], after[i]);
            }
            scored.push(group);
        }
    }
    let [before, after] = residuals.map(LeftOut::alone);
    let added: Vec<usize> = chosen.fit.active.iter().copied().filter(|index| !whole.named.contains(index)).collect();
    let touched = touched_by(model, &added);
    let (closure, _) = closures(model, &basis, &before, &after, &scored, &touched, seed);
    let much = closure.of_closable.is_nan() || closure.of_closable >= LEAST_OF_CLOSABLE;
    if closure.ci90[0].is_nan() || closure.ci90[0] <= LEAST_CLOSED || !much {
        return None;
    }
    let cosine = base.scores().cosine;
    let deviations = chosen.deviations();
    let term = |index: &usize| {
        let place = chosen.fit.active.iter().position(|own| own == index).unwrap_or(0);
        let same = |other: &&usize| *other != index && cosine[(*index, **other)].abs() > SAME;
        ProposedTerm {
            candidate: *index,
            size: chosen.fit.linear.point.effects[*index],
            standard_error: deviations[place] * model.frame().candidates[*index].typical,
            as_good: whole.terms.iter().filter(same).copied().collect(),
        }
    };
    let (left_out, error) = predictive_gain(&chosen.evidence, &base.evidence);
    let terms = added.iter().map(term).collect();
    let points = [&base, &chosen].map(|trial| trial.fit.linear.point.clone());
    Some(Proposal { terms, left_out: [left_out, error], closure, basis, points })
}

/// What is left of the groups that the model keeps out of its fit, without terms and with those that the others choose.
fn left(library: &Library<'_>, seed: u64) -> (Vec<f64>, Vec<f64>) {
    let method = Method::default();
    let (basis, fit) = settled(library.model, method);
    let of = |model: &dyn Forward, basis: &Basis, fit: Fit| {
        let folds = folds(&model.frame().measured);
        let context = Diagnosing { model, basis, folds: &folds, seed };
        let (base, chosen) = sought(context, fit, library);
        let before = LeftOut::of(model, basis, &base, &[]).residual;
        let after = chosen.map_or_else(|| before.clone(), |own| LeftOut::of(model, basis, &own, &[]).residual);
        (before, after)
    };
    match Widened::new(library.model, &basis, &fit) {
        None => of(library.model, &basis, fit),
        Some(widened) => {
            let (basis, fit) = settled(&widened.model, method);
            of(&widened.model, &basis, fit)
        }
    }
}

/// The model without terms, and with those that are asked for.
fn sought(context: Diagnosing<'_>, fit: Fit, library: &Library<'_>) -> (Trial, Option<Trial>) {
    let Diagnosing { model, basis, folds, .. } = context;
    let mut base = context.trial_of(fit);
    if !library.named.is_empty() {
        base = context.trial(&base.fit, library.named).complete(model, basis, folds);
    }
    let mut chosen: Option<Trial> = None;
    for _ in 0..MOST_TERMS {
        let Some(next) = step(context, chosen.as_ref().unwrap_or(&base), library) else { break };
        chosen = Some(next.complete(model, basis, folds));
    }
    (base, chosen)
}

/// The model of `from` with the term that predicts groups left out best, where one is asked for; with one of a single quantity
/// where one of several does not lead over that by [`SIMPLER_TERM`].
fn step(context: Diagnosing<'_>, from: &Trial, library: &Library<'_>) -> Option<Trial> {
    let terms = library.terms;
    let (scores, alternatives) = (from.strengths(), from.alternatives());
    let open = terms.iter().filter(|index| !from.fit.active.contains(index) && scores[**index] > PAIRED_SCORE);
    let mut leads: Vec<(usize, f64)> = open
        .map(|index| (*index, alternatives.with(&[*index])))
        .filter(|(_, evidence)| evidence.admissible)
        .map(|(index, evidence)| (index, gain(&evidence, &from.evidence)))
        .collect();
    leads.sort_by(|a, b| b.1.total_cmp(&a.1));
    let simple = |index: usize| terms[..library.simple].contains(&index);
    // The best simple term is among those that are fitted.
    let simplest = leads.iter().copied().find(|(index, _)| simple(*index));
    leads.truncate(REFITTED_TERMS);
    leads.extend(simplest.filter(|best| !leads.contains(best)));
    let one = |(index, _): &(usize, f64)| {
        let mut active = from.fit.active.clone();
        active.push(*index);
        active.sort_unstable();
        context.trial(&from.fit, &active)
    };
    let fitted: Vec<Trial> = leads.par_iter().map(one).collect();
    let price = (terms.len() as f64 / ALIKE_TERMS).max(1.0).ln();
    let asked_for = |trial: &Trial| {
        let (lead, error) = predictive_gain(&trial.evidence, &from.evidence);
        let certain = trial.evidence.admissible && lead > AGREED * error;
        (certain && gain(&trial.evidence, &from.evidence) > GATE + price).then_some(lead)
    };
    let kept: Vec<(f64, Trial)> = fitted.into_iter().filter_map(|trial| Some((asked_for(&trial)?, trial))).collect();
    let best = |simple_only: bool| {
        let added =
            |trial: &Trial| trial.fit.active.iter().any(|index| !from.fit.active.contains(index) && simple(*index));
        let among = kept.iter().filter(|(_, trial)| !simple_only || added(trial));
        among.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, trial)| trial)
    };
    let (any, of_one) = (best(false)?, best(true));
    let chosen = of_one.filter(|own| gain(&any.evidence, &own.evidence) <= SIMPLER_TERM).unwrap_or(any);
    Some(chosen.clone())
}
