//! Which models get the chance to be named: single effects, and step by step further ones beside them.

use super::constants::{
    DETECTABLE, EARLY, FURTHER, GATE, PAIRED, PAIRED_LEAD, PAIRED_SCORE, REFITTED, REFITTED_SCORE, SHAPES, STRAINED,
};
use super::decision::{Decision, Single};
use super::diagnosing::Diagnosing;
use super::evidence::{Evidence, gain};
use super::rules::strain;
use super::trial::{Remainder, Trial};
use super::{EffectId, Forward};
use rayon::prelude::*;

/// What the dictionary finds beside the nominal model, single effects by falling gain, and the refitted ones.
pub(super) fn singles(context: Diagnosing<'_>, base: &Trial) -> (Remainder, Vec<Single>, Vec<Trial>) {
    let (model, count) = (context.model, context.candidates());
    let (scores, alternatives) = (base.strengths(), base.alternatives());
    let single = |candidate: usize| Single {
        candidate,
        id: model.frame().candidates[candidate].id,
        score: scores[candidate],
        evidence: alternatives.with(&[candidate]),
        trial: None,
    };
    let (before, mut singles): (Remainder, Vec<Single>) =
        rayon::join(|| context.remainder(base), || (0..count).into_par_iter().map(single).collect());
    singles.sort_by(|a, b| b.score.total_cmp(&a.score));
    let mut refitted: Vec<usize> = Vec::new();
    for (place, single) in singles.iter().enumerate() {
        if refitted.len() == REFITTED || single.score < REFITTED_SCORE {
            break;
        }
        if refitted.iter().filter(|known| singles[**known].id == single.id).count() < SHAPES {
            refitted.push(place);
        }
    }
    let mut trials: Vec<Trial> = Vec::new();
    refit(context, base, &mut singles, &refitted, &mut trials);
    early(context, base, &mut singles, &mut trials);
    let value = |evidence: &Evidence| {
        if evidence.admissible { gain(evidence, &base.evidence) } else { f64::NEG_INFINITY }
    };
    singles.sort_by(|a, b| value(&b.evidence).total_cmp(&value(&a.evidence)));
    (before, singles, trials)
}

/// Where the nominal model was bent out of shape to follow the data, the scores beside it are not
/// what an effect promises: those at the nominal point are asked too.
fn early(context: Diagnosing<'_>, base: &Trial, singles: &mut [Single], trials: &mut Vec<Trial>) {
    if strain(context.model, base).is_none_or(|(_, x)| x < STRAINED) {
        return;
    }
    let unbent = super::Fit::at(context.basis.nominal.clone(), f64::INFINITY);
    let scores = context.trial_of(unbent).strengths();
    let mut order: Vec<usize> = (0..singles.len()).collect();
    order.sort_by(|a, b| scores[singles[*b].candidate].total_cmp(&scores[singles[*a].candidate]));
    let mut tried: Vec<EffectId> = Vec::new();
    let mut refitted: Vec<usize> = Vec::new();
    for place in order {
        let single = &mut singles[place];
        let score = scores[single.candidate];
        if tried.len() == EARLY || score < DETECTABLE {
            break;
        }
        if tried.contains(&single.id) {
            continue;
        }
        tried.push(single.id);
        single.score = single.score.max(score);
        if single.trial.is_none() {
            refitted.push(place);
        }
    }
    refit(context, base, singles, &refitted, trials);
}

/// Fits the singles at `places` anew, side by side.
fn refit(context: Diagnosing<'_>, base: &Trial, singles: &mut [Single], places: &[usize], trials: &mut Vec<Trial>) {
    let one = |place: &usize| context.trial(&base.fit, &[singles[*place].candidate]);
    let fitted: Vec<Trial> = places.par_iter().map(one).collect();
    for (place, trial) in places.iter().zip(fitted) {
        let single = &mut singles[*place];
        single.evidence = trial.evidence.clone();
        single.trial = Some(trials.len());
        trials.push(trial);
    }
}

/// Adds the best second effect to each of the best singles.
pub(super) fn pairs(context: Diagnosing<'_>, decision: &mut Decision) {
    let Diagnosing { model, basis, folds, .. } = context;
    let count = context.candidates();
    let best: Vec<usize> = decision.singles.iter().filter_map(|single| single.trial).take(PAIRED).collect();
    let promising = |first: &usize| {
        let trial = &decision.trials[*first];
        decision.gain_of(trial, count) >= GATE && trial.evidence.admissible
    };
    let best: Vec<usize> = best.into_iter().filter(promising).collect();
    let completed: Vec<(Trial, Option<Vec<usize>>)> = best
        .par_iter()
        .map(|first| {
            let single = decision.trials[*first].clone().complete(model, basis, folds);
            let second = beside(model, &single, 1).pop();
            (single, second)
        })
        .collect();
    let mut sought: Vec<(usize, Vec<usize>)> = Vec::new();
    for (first, (single, active)) in best.into_iter().zip(completed) {
        decision.trials[first] = single;
        if let Some(active) = active
            && sought.iter().all(|(_, known)| *known != active)
        {
            sought.push((first, active));
        }
    }
    let one = |(first, active): &(usize, Vec<usize>)| context.trial(&decision.trials[*first].fit, active);
    let fitted: Vec<Trial> = sought.par_iter().map(one).collect();
    decision.trials.extend(fitted);
}

/// The effects of `trial` with one more, the best first, where that leads; at most `most`. The trial is complete.
fn beside(model: &dyn Forward, trial: &Trial, most: usize) -> Vec<Vec<usize>> {
    let candidates = &model.frame().candidates;
    let scores = trial.strengths();
    // One effect may act twice where that is on two parts of the records.
    let known = |other: usize| {
        let alike = |index: &usize| candidates[*index].id == candidates[other].id;
        trial.fit.active.iter().filter(|index| alike(index)).any(|index| !apart(model, *index, other))
    };
    let asked: Vec<usize> =
        (0..candidates.len()).filter(|other| !known(*other) && scores[*other] > PAIRED_SCORE).collect();
    if asked.is_empty() {
        return Vec::new();
    }
    let alternatives = trial.alternatives();
    let mut leads: Vec<(usize, f64)> = asked
        .into_par_iter()
        .map(|other| (other, alternatives.with(&[other])))
        .collect::<Vec<_>>()
        .into_iter()
        .filter(|(_, evidence)| evidence.admissible)
        .map(|(other, evidence)| (other, gain(&evidence, &trial.evidence)))
        .filter(|(_, lead)| *lead >= PAIRED_LEAD)
        .collect();
    leads.sort_by(|a, b| b.1.total_cmp(&a.1));
    let with = |(other, _): (usize, f64)| {
        let mut active = trial.fit.active.clone();
        active.push(other);
        active.sort_unstable();
        active
    };
    leads.into_iter().take(most).map(with).collect()
}

/// Whether two candidates of one effect differ in nothing but the part of the records on which they act, neither on all.
fn apart(model: &dyn Forward, one: usize, other: usize) -> bool {
    let [one, other] = [one, other].map(|index| model.written(index));
    let scoped = !one.scope.is_everywhere() && !other.scope.is_everywhere();
    scoped && one.scope != other.scope && one.shape == other.shape
}

/// The models with one effect more than trial `index` that lead, fitted, the best first.
pub(super) fn further(context: Diagnosing<'_>, decision: &mut Decision, index: usize) -> Vec<usize> {
    let Diagnosing { model, basis, folds, .. } = context;
    decision.trials[index] = decision.trials[index].clone().complete(model, basis, folds);
    let sought = beside(model, &decision.trials[index], FURTHER);
    fitted(context, decision, index, &sought)
}

/// Another model of as many effects as trial `index` that is better by the gate: with one of the earlier effects
/// exchanged, since what was best alone need not be best beside the others.
pub(super) fn swapped(context: Diagnosing<'_>, decision: &mut Decision, index: usize) -> Option<usize> {
    let Diagnosing { model, basis, folds, .. } = context;
    let trial = decision.trials[index].clone();
    let without = |place: usize| {
        let mut active = trial.fit.active.clone();
        active.remove(place);
        let left = context.trial(&trial.fit, &active).complete(model, basis, folds);
        beside(model, &left, 1).pop().filter(|other| *other != trial.fit.active)
    };
    let places: Vec<usize> = (0..trial.fit.active.len()).collect();
    let mut sought: Vec<Vec<usize>> = places.into_par_iter().filter_map(without).collect();
    sought.dedup();
    let other = fitted(context, decision, index, &sought).first().copied()?;
    let better = gain(&decision.trials[other].evidence, &trial.evidence) > GATE;
    better.then_some(other)
}

/// Fits the models of the effects `sought` from trial `index`, keeps them, and gives those that are admissible, the best
/// first.
fn fitted(context: Diagnosing<'_>, decision: &mut Decision, index: usize, sought: &[Vec<usize>]) -> Vec<usize> {
    let first = decision.trials.len();
    let fit = decision.trials[index].fit.clone();
    let fitted: Vec<Trial> = sought.par_iter().map(|active| context.trial(&fit, active)).collect();
    decision.trials.extend(fitted);
    let profile = |index: &usize| decision.trials[*index].evidence.profile;
    let admissible = |index: &usize| decision.trials[*index].evidence.admissible;
    let mut ranked: Vec<usize> = (first..decision.trials.len()).filter(admissible).collect();
    ranked.sort_by(|a, b| profile(b).total_cmp(&profile(a)));
    ranked
}
