//! From fitted trials to a verdict.

use super::closure::crossed;
use super::constants::{
    AGREED, CLEAR, CLEARLY_LEFT_OUT, CONVINCING, DETECTABLE, EARLY, EVIDENT, FEWEST_GROUPS, FORM, GATE, IMITATED,
    PAIR_GATE, PAIRED, PAIRED_LEAD, PAIRED_SCORE, PROMISED, REFITTED, REFITTED_SCORE, REMAINDER, RIVAL, SAME,
    SCATTERED, SHAPES, SLACK, STRAINED,
};
use super::diagnosing::Diagnosing;
use super::evidence::{Evidence, gain, predictive_gain};
use super::trial::{Remainder, Trial};
use super::{Basis, Closure, Forward, GapVerdict};
use rayon::prelude::*;

/// A single effect with its gain over the nominal model.
#[derive(Clone, Debug)]
pub struct Single {
    /// Candidate.
    pub candidate: usize,
    /// Its id.
    pub id: &'static str,
    /// Score at the nominal fit.
    pub score: f64,
    /// Evidence.
    pub evidence: Evidence,
    /// Index among the refitted trials, where it was.
    pub trial: Option<usize>,
}

/// Everything on which a verdict rests.
pub struct Decision {
    /// The answer.
    pub verdict: GapVerdict,
    /// The nominal model, calibrated.
    pub base: Trial,
    /// Singles by falling gain.
    pub singles: Vec<Single>,
    /// Refitted trials: singles, then pairs.
    pub trials: Vec<Trial>,
    /// The chosen trial; `None` keeps the nominal model.
    pub chosen: Option<usize>,
    /// What the dictionary finds beside the nominal model.
    pub before: Remainder,
    /// What it finds beside the chosen trial.
    pub after: Option<Remainder>,
    /// Why, in words.
    pub reasons: Vec<String>,
    /// What a name pays for having been chosen among several processes.
    pub share: f64,
}

impl Decision {
    /// The trial that the diagnosis goes on with.
    pub fn model(&self) -> &Trial {
        self.chosen.map_or(&self.base, |index| &self.trials[index])
    }

    /// Gain of a trial over the nominal model, the choice among many paid for.
    pub fn gain_of(&self, trial: &Trial, candidates: usize) -> f64 {
        gain(&trial.evidence, &self.base.evidence) - price(candidates, trial.fit.active.len()) - self.share
    }

    /// Whether the strongest generic signature is nothing but the image of one of `effects`.
    pub(super) fn imaged(&self, context: Diagnosing<'_>, effects: &[usize]) -> bool {
        let base = &self.base.fit;
        let Some(signature) = self.before.dictionary.get(self.before.strongest) else { return false };
        let gram = super::trial::gram(context.model, context.basis, base, &[], &[signature.column.as_slice()], &[]);
        let cosine = super::score::scores(&gram, base.linear.nuisance.len(), &[]).cosine;
        let generic = cosine.nrows() - 1;
        effects.iter().any(|index| cosine[(*index, generic)].abs() > SAME)
    }

    /// Candidates that the data cannot tell from `candidate`, by other ids.
    pub fn class(&self, model: &dyn Forward, candidate: usize) -> Vec<(&'static str, String)> {
        let own = self.singles.iter().find(|single| single.candidate == candidate);
        let Some(own) = own else { return Vec::new() };
        let id = model.frame().candidates[candidate].id;
        let cosine = self.base.scores().cosine;
        let own_gain = gain(&own.evidence, &self.base.evidence);
        let mut class: Vec<(&'static str, String)> = Vec::new();
        for other in &self.singles {
            let other_id = model.frame().candidates[other.candidate].id;
            if other_id == id || class.iter().any(|(known, _)| *known == other_id) {
                continue;
            }
            let lead = gain(&own.evidence, &other.evidence);
            let (left_out, error) = predictive_gain(&own.evidence, &other.evidence);
            let other_gain = gain(&other.evidence, &self.base.evidence);
            let close = lead < GATE || (lead < CLEAR && left_out < CLEARLY_LEFT_OUT * error);
            let alike = cosine[(candidate, other.candidate)];
            if alike > SAME {
                class.push((other_id, format!("{other_id} leaves the same signature (cosine {alike:.2})")));
            } else if other.evidence.admissible && close && other_gain > own_gain / RIVAL {
                class.push((other_id, format!("{other_id} explains nearly as much (log evidence {lead:.1} less)")));
            }
        }
        class
    }
}

/// What it costs to have chosen among `candidates`.
fn price(candidates: usize, effects: usize) -> f64 {
    let count = candidates as f64;
    match effects {
        0 => 0.0,
        1 => count.max(1.0).ln(),
        _ => (0.5 * count * (count - 1.0)).max(1.0).ln(),
    }
}

/// Chooses a model and says why.
pub(super) fn decide(context: Diagnosing<'_>, base: Trial) -> Decision {
    let (model, count) = (context.model, context.candidates());
    let scores = base.scores();
    let single = |candidate: usize| Single {
        candidate,
        id: model.frame().candidates[candidate].id,
        score: scores.score[candidate],
        evidence: base.with(candidate),
        trial: None,
    };
    let (before, mut singles): (Remainder, Vec<Single>) =
        rayon::join(|| context.remainder(&base), || (0..count).into_par_iter().map(single).collect());
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
    refit(context, &base, &mut singles, &refitted, &mut trials);
    early(context, &base, &mut singles, &mut trials);
    let base_evidence = base.evidence.clone();
    let value = |evidence: &Evidence| {
        if evidence.admissible { gain(evidence, &base_evidence) } else { f64::NEG_INFINITY }
    };
    singles.sort_by(|a, b| value(&b.evidence).total_cmp(&value(&a.evidence)));
    let mut decision = Decision {
        verdict: GapVerdict::NoGap,
        base,
        singles,
        trials,
        chosen: None,
        before,
        after: None,
        reasons: Vec::new(),
        share: context.basis.method.share(),
    };
    pairs(context, &mut decision);
    choose(context, &mut decision);
    decision
}

/// Where the nominal model was bent out of shape to follow the data, the scores beside it are not
/// what an effect promises: those at the nominal point are asked too.
fn early(context: Diagnosing<'_>, base: &Trial, singles: &mut [Single], trials: &mut Vec<Trial>) {
    if strain(context.model, base).is_none_or(|(_, x)| x < STRAINED) {
        return;
    }
    let unbent = super::Fit::at(context.basis.nominal.clone(), f64::INFINITY);
    let scores = context.trial_of(unbent).scores();
    let mut order: Vec<usize> = (0..singles.len()).collect();
    order.sort_by(|a, b| scores.score[singles[*b].candidate].total_cmp(&scores.score[singles[*a].candidate]));
    let mut tried: Vec<&'static str> = Vec::new();
    let mut refitted: Vec<usize> = Vec::new();
    for place in order {
        let single = &mut singles[place];
        let score = scores.score[single.candidate];
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
fn pairs(context: Diagnosing<'_>, decision: &mut Decision) {
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
            let second = second(model, &single);
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

/// The effect of `single` with the one that is best beside it, if that leads.
fn second(model: &dyn Forward, single: &Trial) -> Option<Vec<usize>> {
    let candidates = &model.frame().candidates;
    let scores = single.scores();
    let first = single.fit.active[0];
    let (second, lead) = (0..candidates.len())
        .filter(|other| candidates[*other].id != candidates[first].id && scores.score[*other] > PAIRED_SCORE)
        .map(|other| (other, single.with(other)))
        .filter(|(_, evidence)| evidence.admissible)
        .map(|(other, evidence)| (other, gain(&evidence, &single.evidence)))
        .max_by(|a, b| a.1.total_cmp(&b.1))?;
    let mut active = vec![first, second];
    active.sort_unstable();
    (lead >= PAIRED_LEAD).then_some(active)
}

/// Whether the gain of a trial is of the order that the scores of its effects at the nominal fit
/// promise; a far greater one means that the nominal fit was caught somewhere else.
fn credible(model: &dyn Forward, decision: &Decision, trial: &Trial) -> bool {
    let candidates = &model.frame().candidates;
    let lengths = decision.base.scores().length;
    // Of several shapes of an effect the one that shows best speaks for all, or its size where the
    // nominal fit gave much of it to calibration.
    let promise = |(index, size): (&usize, f64)| {
        let alike = decision.singles.iter().filter(|single| single.id == candidates[*index].id);
        0.5 * alike.map(|single| single.score).fold(lengths[*index] * size, f64::max).powi(2)
    };
    let promised: f64 = trial.fit.active.iter().zip(trial.sizes(model)).map(promise).sum();
    decision.gain_of(trial, candidates.len()) < PROMISED * promised + SLACK
}

/// Whether the groups agree on every effect of a trial.
fn agreed(model: &dyn Forward, trial: &Trial) -> bool {
    let errors = trial.jackknife();
    trial.sizes(model).iter().zip(errors).all(|(size, error)| *size > AGREED * error)
}

/// Share of what an effect of a pair does that it does to readings which the other moves too; of the
/// effect that is not `first`.
fn overlap(model: &dyn Forward, basis: &Basis, pair: &Trial, first: usize) -> f64 {
    let [one, other] = pair.fit.active[..] else { return 0.0 };
    let (first, second) = if other == first { (other, one) } else { (one, other) };
    let slopes = |index: usize| &pair.fit.linear.effects[index];
    let square = |i: usize| (slopes(second)[i] / basis.noise.deviation(&model.frame().measured, i)).powi(2);
    let all: f64 = (0..slopes(second).len()).map(square).sum();
    let shared: f64 = (0..slopes(second).len()).filter(|i| slopes(first)[*i] != 0.0).map(square).sum();
    if all > 0.0 { shared / all } else { 0.0 }
}

/// The form allowance that a trial strains most, among those that act where its effects act: name and
/// prior standard deviations.
fn strain<'m>(model: &'m dyn Forward, trial: &Trial) -> Option<(&'m str, f64)> {
    let (frame, linear) = (model.frame(), &trial.fit.linear);
    let parameters = frame.parameters.iter().map(|each| (each.name.as_str(), each.allowance));
    let surfaces = frame.surfaces.iter().map(|each| (each.name.as_str(), each.allowance));
    let moved = linear.point.parameters.iter().chain(&linear.point.surfaces);
    let active = &trial.fit.active;
    let concerns = |column: &[f64]| {
        let meets = |index: &usize| linear.effects[*index].iter().zip(column).any(|(a, b)| *a != 0.0 && *b != 0.0);
        active.is_empty() || active.iter().any(meets)
    };
    let all = parameters.chain(surfaces).zip(moved).zip(linear.nuisance.iter());
    let allowances = all.filter(|(((_, allowance), _), column)| *allowance && concerns(column));
    allowances.map(|(((name, _), x), _)| (name, x.abs())).max_by(|a, b| a.1.total_cmp(&b.1))
}

/// Whether every effect of a trial scores at its size.
fn convincing(model: &dyn Forward, trial: &Trial, base: &Trial) -> bool {
    let lengths = base.scores().length;
    let scores = trial.fit.active.iter().zip(trial.sizes(model)).map(|(index, size)| lengths[*index] * size);
    scores.into_iter().all(|score| score > CONVINCING)
}

/// Whether the gap of groups left out shrinks by `closed`, as the name of `trial` asks for: at all; and
/// certainly, if the gain is small and the form of the equations could be off by the same. Without the form
/// allowance the form of the equations may be off by so much that the gap does not tell: its interval holds zero.
/// An effect that the form could not imitate has to predict groups left out better beside the allowance, then, and
/// certainly.
fn shrinks(model: &dyn Forward, decision: &Decision, trial: &Trial, closed: &Closure, gain: f64) -> bool {
    let imitated = trial.fit.active.iter().any(|index| decision.base.imitated(model, *index) > IMITATED);
    if closed.closed > 0.0 {
        return gain > EVIDENT || !imitated || closed.ci90[0] > 0.0;
    }
    let (left_out, error) = predictive_gain(&trial.evidence, &decision.base.evidence);
    let folds = trial.evidence.folds.len() as f64;
    !imitated && closed.ci90[1] > 0.0 && left_out > toolroom_statistics::student(0.9, folds - 1.0) * error
}

/// Another shape of the effect of trial `index` that shrinks the gap clearly further on groups left
/// out, and what to say about it. The gain is judged beside the form allowance, which is no part of
/// the model that a user goes on with: a shape that needs the allowance is the worse one there.
fn shape(context: Diagnosing<'_>, decision: &Decision, index: usize, closed: &Closure) -> Option<(usize, String)> {
    let model = context.model;
    let candidates = &model.frame().candidates;
    let [own] = decision.trials[index].fit.active[..] else { return None };
    let stands = |other: usize| {
        let trial = &decision.trials[other];
        let alike = other != index && matches!(trial.fit.active[..], [one] if candidates[one].id == candidates[own].id);
        alike
            && trial.evidence.admissible
            && decision.gain_of(trial, candidates.len()) > GATE
            && agreed(model, trial)
            && convincing(model, trial, &decision.base)
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
        candidates[own].id,
        name(own),
        100.0 * closed.closed,
        name(decision.trials[other].fit.active[0]),
        100.0 * further.closed,
    );
    Some((other, note))
}

fn choose(context: Diagnosing<'_>, decision: &mut Decision) {
    let Diagnosing { model, basis, .. } = context;
    let count = context.candidates();
    let groups = model.frame().measured.fitted_groups().count();
    // Where groups disagree about the best effect, the next may be the one they agree on.
    let spoken: Vec<bool> =
        decision.trials.iter().map(|trial| groups < FEWEST_GROUPS || agreed(model, trial)).collect();
    let best_of = |decision: &Decision, effects: usize| {
        let eligible = |trial: &Trial| trial.fit.active.len() == effects && trial.evidence.admissible;
        (0..decision.trials.len()).filter(|i| spoken[*i] && eligible(&decision.trials[*i])).max_by(|a, b| {
            let value = |i: usize| decision.gain_of(&decision.trials[i], count);
            value(*a).total_cmp(&value(*b))
        })
    };
    let mut chosen = best_of(decision, 1);
    if let (Some(single), Some(pair)) = (chosen, best_of(decision, 2)) {
        let lead = gain(&decision.trials[pair].evidence, &decision.trials[single].evidence);
        let lead = lead - (price(count, 2) - price(count, 1));
        let first = decision.trials[single].fit.active[0];
        let both = &decision.trials[pair];
        let stands = agreed(model, both) && convincing(model, both, &decision.base);
        if lead > PAIR_GATE && stands {
            // Beside the first, the second has to shrink the gap of groups left out by itself; where both
            // move the same readings it has to be certain of that, or to lead by more.
            let further = crossed(context, &decision.trials[single], both);
            let gained = decision.gain_of(&decision.trials[single], count);
            let scattered = SCATTERED * gained * overlap(model, basis, both, first);
            let sure = lead > PAIR_GATE + scattered || further.ci90[0] > 0.0;
            if !basis.method.abstention || (sure && further.closed > 0.0) {
                chosen = Some(pair);
            }
        }
    }
    let strongest = decision.before.strongest;
    let structure = decision.before.scores.score.get(strongest).map_or(0.0, |score| score.abs());
    let generic_gain = gain(&decision.before.evidence, &decision.base.evidence);
    let generic_gain = generic_gain - (decision.before.dictionary.len().max(1) as f64).ln() - decision.share;
    let structured = structure > decision.before.threshold && generic_gain > GATE;
    if let Some(index) = chosen {
        let trial = &decision.trials[index];
        let value = decision.gain_of(trial, count);
        let abstains = basis.method.abstention;
        let passes = value > GATE && agreed(model, trial) && convincing(model, trial, &decision.base);
        let (after, closed) = rayon::join(
            || context.remainder(trial),
            || (passes && abstains).then(|| crossed(context, &decision.base, trial)),
        );
        let left = after.scores.score.get(after.strongest).map_or(0.0, |score| score.abs());
        let remaining = 0.5 * left * left - (after.dictionary.len().max(1) as f64).ln();
        // What an effect does from time to time scatters, and a signature may follow the scatter of a few
        // groups: it has to be the better one for all of them, and more than an image of the effect.
        let (lead, error) = predictive_gain(&decision.before.evidence, &trial.evidence);
        let stronger = generic_gain - value > GATE + FORM * value && lead > AGREED * error;
        let beaten = abstains && stronger && !decision.imaged(context, &trial.fit.active);
        let strained = strain(model, trial).filter(|(_, x)| abstains && *x > STRAINED);
        let beside = abstains && remaining > REMAINDER * value && left > after.threshold;
        if value > GATE && groups < FEWEST_GROUPS {
            let mut alike = vec![model.frame().candidates[trial.fit.active[0]].id];
            alike.extend(decision.class(model, trial.fit.active[0]).into_iter().map(|(id, _)| id));
            let reason = format!(
                "{groups} groups are too few to name an effect, at least {FEWEST_GROUPS} are due; suspected: {}",
                alike.join(" or ")
            );
            decision.reasons.push(reason);
            decision.after = Some(after);
            decision.verdict = GapVerdict::Unknown;
            return;
        }
        if passes && beaten {
            decision.reasons.push("a generic signature predicts groups left out better than any effect".to_owned());
        } else if passes && abstains && !credible(model, decision, trial) {
            decision.reasons.push("the calibration of the nominal model did not settle: no effect is named".to_owned());
        } else if let Some((name, x)) = strained.filter(|_| passes) {
            let far = format!("`{name}` would be off by {x:.1} prior standard deviations");
            decision.reasons.push(format!("beside the best effect the form of the equations is wrong: {far}"));
        } else if passes && closed.as_ref().is_some_and(|closed| !shrinks(model, decision, trial, closed, value)) {
            let [low, high] = closed.map_or([0.0; 2], |closed| closed.ci90.map(|end| 100.0 * end));
            let names: Vec<&str> = trial.fit.active.iter().map(|index| model.frame().candidates[*index].id).collect();
            decision.reasons.push(format!(
                "{} would close {low:.0} … {high:.0} % of the gap on groups left out: it is not named",
                names.join(" with ")
            ));
        } else if passes && beside {
            decision.reasons.push(format!("beside the best effect as much structure is left (score {left:.1})"));
        } else if passes {
            if closed.as_ref().is_some_and(|closed| closed.closed <= 0.0) {
                let id = model.frame().candidates[trial.fit.active[0]].id;
                let why =
                    "the form of the equations drowns what it closes on groups left out; beside the form allowance";
                decision.reasons.push(format!("{id}: {why} they are predicted better for certain"));
            }
            let shape = closed.and_then(|closed| shape(context, decision, index, &closed));
            if let Some((other, note)) = shape {
                decision.reasons.push(note);
                decision.after = Some(context.remainder(&decision.trials[other]));
                decision.chosen = Some(other);
            } else {
                decision.chosen = Some(index);
                decision.after = Some(after);
            }
            decision.verdict = GapVerdict::Effect;
            return;
        }
        if passes {
            decision.after = Some(after);
            decision.verdict = GapVerdict::Unknown;
            return;
        }
    }
    if structured && basis.method.abstention {
        decision.reasons.push("structure is left that no effect of the catalogue explains".to_owned());
        decision.verdict = GapVerdict::Unknown;
    }
}
