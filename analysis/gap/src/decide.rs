//! From fitted trials to a verdict.

use super::belief::crossed;
use super::class::class;
use super::constants::{FEW_GROUPS_GATE, FEWEST_GROUPS, FURTHER, GATE, MOST_EFFECTS};
use super::decision::{Decision, Single};
use super::diagnosing::Diagnosing;
use super::evidence::gain;
use super::rules::{Judged, Refusal, Rule, agreed, stands};
use super::stepwise;
use super::stops;
use super::trial::{Remainder, Trial, shape_lead};
use super::{Closure, EffectId, GapVerdict, NotNamed, RuleFinding};

impl Decision {
    /// The model that the data ask for, named or not, if they ask loudly enough: few groups, whose agreement nobody can
    /// judge, by [`FEW_GROUPS_GATE`]. Its effects with those that cannot be told from them, and its gain.
    pub(super) fn asked_for(&self, context: Diagnosing<'_>) -> Option<(String, f64)> {
        let index = self.chosen.or(self.refused)?;
        let gain = self.gain_of(&self.trials[index], context.candidates());
        let few = context.model.frame().measured.fitted_groups().count() < FEWEST_GROUPS;
        let gate = if few { FEW_GROUPS_GATE } else { GATE };
        (gain > gate).then(|| (self.suspects(context, index), gain))
    }

    /// Effects of trial `index` with those that the data cannot tell from the first.
    fn suspects(&self, context: Diagnosing<'_>, index: usize) -> String {
        let active = &self.trials[index].fit.active;
        let mut names: Vec<EffectId> = active.iter().map(|index| context.model.frame().candidates[*index].id).collect();
        let alike = class(context, self, &self.trials[index], active[0]).into_iter().map(|(id, _)| id);
        names.extend(alike.filter(|id| !names.contains(id)).collect::<Vec<_>>());
        EffectId::words(&names).join(" or ")
    }
}

/// Chooses a model and says why.
pub(super) fn decide(context: Diagnosing<'_>, base: Trial) -> Decision {
    let (before, singles, trials) = stepwise::singles(context, &base);
    let mut decision = Decision {
        verdict: GapVerdict::NoGap,
        base,
        singles,
        trials,
        chosen: None,
        refused: None,
        before,
        after: None,
        reasons: Vec::new(),
        not_named: Vec::new(),
        share: context.basis.method.share(),
    };
    stepwise::pairs(context, &mut decision);
    choose(context, &mut decision);
    decision
}

/// Another shape of the effect of trial `index` that shrinks the gap clearly further on groups left
/// out, and what to say about it. The gain is judged beside the form allowance, which is no part of
/// the model that a user goes on with: a shape that needs the allowance is the worse one there.
fn shape(context: Diagnosing<'_>, decision: &Decision, index: usize, closed: &Closure) -> Option<(usize, String)> {
    let model = context.model;
    let candidates = &model.frame().candidates;
    let [candidate] = decision.trials[index].fit.active[..] else { return None };
    let scope = model.written(candidate).scope;
    let stands = |other: usize| {
        let trial = &decision.trials[other];
        // Where an effect acts is no shape of it: a part of the records has to be asked for by itself.
        let same = |one: usize| candidates[one].id == candidates[candidate].id && model.written(one).scope == scope;
        let alike = other != index && matches!(trial.fit.active[..], [one] if same(one));
        alike && trial.evidence.admissible && stands(&Judged::against_nominal(context, decision, trial))
    };
    // Group by group against the first shape: what both leave of a group, they leave alike.
    let further = |other: usize| {
        let (first, second) = (&decision.trials[index], &decision.trials[other]);
        (other, crossed(context, first, second))
    };
    let others = (0..decision.trials.len()).filter(|other| stands(*other)).map(further);
    let clearly = others.filter(|(_, further)| further.ci90[0] > 0.0);
    let (other, _) = clearly.max_by(|a, b| a.1.closed.total_cmp(&b.1.closed))?;
    let further = crossed(context, &decision.base, &decision.trials[other]);
    let name = |index: usize| match candidates[index].shape.as_str() {
        "" => "the plain form",
        shape => shape,
    };
    let note = format!(
        "{}: {} fits better beside the form allowance, but closes {:.0} % of the gap on groups left out where {} closes {:.0} %",
        candidates[candidate].id,
        name(candidate),
        100.0 * closed.closed,
        name(decision.trials[other].fit.active[0]),
        100.0 * further.closed,
    );
    Some((other, note))
}

/// The trial of that many effects with the greatest gain, among those on which the groups agree: where they disagree
/// about the best effect, the next may be the one they agree on.
fn best_of(context: Diagnosing<'_>, decision: &Decision, effects: usize) -> Option<usize> {
    ranked(context, decision, effects).first().copied()
}

/// All trials of that many effects on which the groups agree, by falling gain.
fn ranked(context: Diagnosing<'_>, decision: &Decision, effects: usize) -> Vec<usize> {
    let (model, count) = (context.model, context.candidates());
    let few = model.frame().measured.fitted_groups().count() < FEWEST_GROUPS;
    let unasked = few || !context.basis.method.agreement;
    let eligible = |index: &usize| {
        let trial = &decision.trials[*index];
        trial.fit.active.len() == effects && trial.evidence.admissible && (unasked || agreed(model, trial))
    };
    let value = |index: &usize| decision.gain_of(&decision.trials[*index], count);
    let mut ranked: Vec<usize> = (0..decision.trials.len()).filter(eligible).collect();
    // Of equals the later one comes first.
    ranked.reverse();
    ranked.sort_by(|a, b| value(b).total_cmp(&value(a)));
    ranked
}

/// Notes the rules against trial `index`.
fn not_named(decision: &mut Decision, context: Diagnosing<'_>, index: usize, rules: Vec<(&'static Rule, String)>) {
    let candidates = &context.model.frame().candidates;
    let effects = decision.trials[index].fit.active.iter().map(|index| candidates[*index].id).collect();
    let found = |(rule, found): (&Rule, String)| RuleFinding { rule: rule.id, asks: rule.reason, found };
    decision
        .not_named
        .push(NotNamed { effects, rules: rules.into_iter().map(|(rule, each)| found((rule, each))).collect() });
}

/// The trial of the same effect everywhere, where the part of the records on which trial `index` has it is not requested:
/// a part leads by the gate and by the choice among all parts, and closes more of the gap of left-out groups for
/// certain than an effect everywhere that the records ask for.
fn unsplit(context: Diagnosing<'_>, decision: &mut Decision, index: usize) -> usize {
    let model = context.model;
    let [candidate] = decision.trials[index].fit.active[..] else { return index };
    let written = model.written(candidate);
    let candidates = &model.frame().candidates;
    if written.scope.is_everywhere() {
        return index;
    }
    let alike = |other: &usize| {
        let there = model.written(*other);
        candidates[*other].id == candidates[candidate].id && there.shape == written.shape && there.scope.is_everywhere()
    };
    // An effect that is only ever tried on parts has nothing that it could be instead.
    let Some(everywhere) = (0..candidates.len()).find(alike) else { return index };
    let parts = (0..candidates.len()).filter(|other| candidates[*other].id == candidates[candidate].id).count();
    let position = decision.trials.iter().position(|trial| trial.fit.active == [everywhere]);
    let whole = position.unwrap_or_else(|| {
        decision.trials.push(context.trial(&decision.base.fit, &[everywhere]));
        decision.trials.len() - 1
    });
    let (first, second) = (&decision.trials[whole], &decision.trials[index]);
    let lead = gain(&second.evidence, &first.evidence);
    // The same effect everywhere is no rival where the records do not ask for it: then the rules decide about the part.
    let rival = decision.gain_of(first, candidates.len()) > GATE;
    let clear = GATE + (parts as f64).ln();
    // What the shape of the readings tells, closes no more of their means.
    let by_shape = shape_lead(model, candidate) - shape_lead(model, everywhere) > clear;
    let asked_for = lead > clear && (by_shape || !rival || crossed(context, first, second).ci90[0] > 0.0);
    if asked_for || !first.evidence.admissible { index } else { whole }
}

/// The best single effect, and further ones beside it as long as the rules let them.
fn best_model(context: Diagnosing<'_>, decision: &mut Decision) -> Option<usize> {
    let mut chosen = best_of(context, decision, 1)?;
    chosen = unsplit(context, decision, chosen);
    for effects in 2..=MOST_EFFECTS {
        let Some(next) = kept(context, decision, chosen, effects) else { break };
        chosen = next;
        if effects > 2
            && let Some(other) = stepwise::swapped(context, decision, chosen)
        {
            chosen = other;
        }
    }
    Some(chosen)
}

/// The first model of so many effects that the rules let stand beside trial `chosen`: where they refuse the one that leads
/// most, the next may hold the effect that is missing.
fn kept(context: Diagnosing<'_>, decision: &mut Decision, chosen: usize, effects: usize) -> Option<usize> {
    let sought = match effects {
        // Beside each of the best singles a second one was sought, whether or not they are the very best.
        2 => {
            let mut pairs = ranked(context, decision, 2);
            pairs.truncate(FURTHER);
            pairs.extend(stepwise::further(context, decision, chosen));
            pairs
        }
        _ => stepwise::further(context, decision, chosen),
    };
    for (place, next) in sought.into_iter().enumerate() {
        let judged = Judged::against(context, decision, &decision.trials[next], &decision.trials[chosen]);
        // Of the first everything is said that stands against it; of the others it has to lead at least.
        if place > 0 && !stands(&judged) {
            continue;
        }
        let rules = judged.refusals();
        if rules.is_empty() {
            return Some(next);
        }
        not_named(decision, context, next, rules);
    }
    None
}

fn choose(context: Diagnosing<'_>, decision: &mut Decision) {
    if let Some(index) = best_model(context, decision) {
        let index = stops::settled(context, decision, index);
        let judged = Judged::against_nominal(context, decision, &decision.trials[index]);
        let rules = judged.refusals();
        if rules.iter().all(|(rule, _)| rule.refusal == Refusal::Abstention) {
            let closed = judged.own().clone();
            let after = judged.into_after();
            match rules.first() {
                None => named(context, decision, index, &closed, after),
                Some((rule, found)) => {
                    let ids = decision.suspects(context, index);
                    decision.reasons.push(format!("{ids} not named because of the rule {}: {found}", rule.id));
                    decision.after = Some(after);
                    decision.verdict = GapVerdict::Unknown;
                    decision.refused = Some(index);
                    not_named(decision, context, index, rules);
                }
            }
            return;
        }
        not_named(decision, context, index, rules);
    }
    if decision.structure(context.model).is_some() && context.basis.method.abstention {
        decision.reasons.push("structure is left that no effect of the catalogue explains".to_owned());
        decision.verdict = GapVerdict::Unknown;
    }
}

/// Names the effects of trial `index`.
fn named(context: Diagnosing<'_>, decision: &mut Decision, index: usize, closed: &Closure, remainder: Remainder) {
    if closed.closed <= 0.0 {
        let id = context.model.frame().candidates[decision.trials[index].fit.active[0]].id;
        let why = "the form of the equations drowns what it closes on groups left out; beside the form allowance";
        decision.reasons.push(format!("{id}: {why} they are predicted better for certain"));
    }
    decision.chosen = Some(index);
    decision.after = Some(remainder);
    if context.basis.method.abstention
        && let Some((other, note)) = shape(context, decision, index, closed)
    {
        decision.reasons.push(note);
        decision.after = Some(context.remainder(&decision.trials[other]));
        decision.chosen = Some(other);
    }
    decision.reasons.extend(elsewhere(context, decision));
    decision.verdict = GapVerdict::Effect;
}

/// What to say where the named effect on one part of the records is hardly told from the same effect on another: longer times
/// here leave what shorter times elsewhere leave, once calibration has moved all of them.
fn elsewhere(context: Diagnosing<'_>, decision: &Decision) -> Option<String> {
    let (model, candidates) = (context.model, &context.model.frame().candidates);
    let trial = decision.model();
    let [candidate] = trial.fit.active[..] else { return None };
    let written = model.written(candidate);
    if written.scope.is_everywhere() {
        return None;
    }
    let apart = |single: &&Single| {
        let there = model.written(single.candidate);
        single.id == candidates[candidate].id && !there.scope.is_everywhere() && there.scope != written.scope
    };
    let lead = |single: &Single| gain(&trial.evidence, &single.evidence);
    let others = decision.singles.iter().filter(|single| single.evidence.admissible).filter(apart);
    let nearest = others.min_by(|a, b| lead(a).total_cmp(&lead(b))).filter(|single| lead(single) < GATE)?;
    Some(format!(
        "{} ({}) explains the records as well as {} (log evidence {:.1} less): only what the file says of times and constants \
         decides between them",
        nearest.id,
        model.written(nearest.candidate).scope.words(),
        written.scope.words(),
        lead(nearest)
    ))
}
