//! Effects that records cannot tell apart.
//!
//! An effect that is named alone has as its rivals the others beside the nominal model. One of several that are named
//! together has to be compared beside the rest of them: alone, another effect may explain much of what a second cause
//! did, and nothing of it once that is taken into account.

use super::constants::{CLEAR, CLEARLY_LEFT_OUT, GATE, PAIR_GATE, RIVAL, ROUGHLY, SAME};
use super::decision::Decision;
use super::diagnosing::Diagnosing;
use super::evidence::{Evidence, gain, predictive_gain};
use super::stops;
use super::trial::Trial;
use super::{EffectId, Forward};

/// Candidates that the data cannot tell from `candidate`, an effect of `trial`, by other ids; each with the reason.
pub(super) fn class(
    context: Diagnosing<'_>,
    decision: &Decision,
    trial: &Trial,
    candidate: usize,
) -> Vec<(EffectId, String)> {
    let mut class = by_evidence(context, decision, trial, candidate);
    class.retain(|(id, _)| !stops::tells_from(context, trial, candidate, *id));
    class
}

/// The same by signatures and evidence alone.
fn by_evidence(
    context: Diagnosing<'_>,
    decision: &Decision,
    trial: &Trial,
    candidate: usize,
) -> Vec<(EffectId, String)> {
    let others: Vec<usize> = trial.fit.active.iter().copied().filter(|index| *index != candidate).collect();
    if others.is_empty() {
        let all = decision.singles.iter().map(|single| (single.candidate, single.evidence.clone())).collect();
        return rivals(context.model, &decision.base, all, candidate);
    }
    let beside = context.trial(&trial.fit, &others).complete(context.model, context.basis, context.folds);
    let rivals_of = in_place(&beside, candidate);
    rivals(context.model, &beside, rivals_of, candidate)
}

/// `candidate` and what comes near to it beside the rest of the model, with the evidence of each.
fn in_place(rival: &Trial, candidate: usize) -> Vec<(usize, Evidence)> {
    let strengths = rival.strengths();
    let (cosine, alternatives) = (rival.scores().cosine, rival.alternatives());
    let near = |other: &usize| {
        let strong =
            strengths[*other] > 0.0 && strengths[*other].powi(2) > ROUGHLY / RIVAL * strengths[candidate].powi(2);
        !rival.fit.active.contains(other) && (*other == candidate || strong || cosine[(candidate, *other)] > SAME)
    };
    // What is still asked for beside another effect is not what that one explains.
    let takes_over = |(other, evidence): &(usize, Evidence)| {
        let both = || alternatives.with(&[candidate, *other]);
        *other == candidate || cosine[(candidate, *other)] > SAME || gain(&both(), evidence) <= PAIR_GATE
    };
    let with = |other: usize| (other, alternatives.with(&[other]));
    let mut all: Vec<(usize, Evidence)> = (0..strengths.len()).filter(near).map(with).filter(takes_over).collect();
    all.sort_by(|a, b| b.1.profile.total_cmp(&a.1.profile));
    all
}

/// Whether `other` may have the sign that the records ask of `candidate`.
fn may_go_with(model: &dyn Forward, base: &Trial, candidate: usize, other: usize) -> bool {
    base.scores().score[candidate] >= 0.0 || model.frame().candidates[other].two_sided()
}

/// Of `all` candidates beside the model `base`, by falling gain, those that come near to `candidate`.
fn rivals(model: &dyn Forward, base: &Trial, all: Vec<(usize, Evidence)>, candidate: usize) -> Vec<(EffectId, String)> {
    let candidates = &model.frame().candidates;
    let Some(own) = all.iter().find(|(index, _)| *index == candidate).map(|(_, evidence)| evidence.clone()) else {
        return Vec::new();
    };
    let cosine = base.scores().cosine;
    let own_gain = gain(&own, &base.evidence);
    let mut class: Vec<(EffectId, String)> = Vec::new();
    for (other, evidence) in &all {
        let id = candidates[*other].id;
        if id == candidates[candidate].id || class.iter().any(|(known, _)| *known == id) {
            continue;
        }
        let lead = gain(&own, evidence);
        let (left_out, error) = predictive_gain(&own, evidence);
        let close = lead < GATE || (lead < CLEAR && left_out < CLEARLY_LEFT_OUT * error);
        let alike = cosine[(candidate, *other)];
        if alike > SAME && may_go_with(model, base, candidate, *other) {
            class.push((id, format!("{id} leaves the same signature (cosine {alike:.2})")));
        } else if evidence.admissible && close && gain(evidence, &base.evidence) > own_gain / RIVAL {
            class.push((id, format!("{id} explains nearly as much (log evidence {lead:.1} less)")));
        }
    }
    class
}
