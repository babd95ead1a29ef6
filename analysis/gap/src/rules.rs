//! The rules by which a model with effects is named or not, in the order in which they are asked.
//!
//! Every rule is a value: what it is called, what it asks, when it applies, and what it finds. A diagnosis lists
//! the rules that stood against the best model, so that a reader sees why nothing was named, and the blind benchmark
//! counts for each rule the cases in which it alone decided.

use super::belief::held_against;
use super::closure::closures;
use super::constants::{
    AGREED, CONVINCING, FEWEST_GROUPS, GATE, IMITATED, LEAST_CLOSED, LEAST_OF_CLOSABLE, PAIR_GATE, REMAINDER,
    SCATTERED, STRAINED,
};
use super::decision::Decision;
use super::diagnosing::Diagnosing;
use super::evidence::predictive_gain;
use super::size::too_small;
use super::trial::{Remainder, Trial, shape_lead};
use super::{Closure, Fit, Forward};
use std::sync::OnceLock;

/// One rule of the decision.
pub struct Rule {
    /// Stable word in diagnoses and tables.
    pub id: &'static str,
    /// What it asks of a model before the effects of that are named.
    pub reason: &'static str,
    /// What follows where it is not kept.
    pub refusal: Refusal,
    /// Whether it is asked.
    pub(super) applies: fn(&Judged<'_>) -> bool,
    /// What it has against the model; `None` where the rule is kept.
    pub(super) verdict: fn(&Judged<'_>) -> Option<String>,
}

/// What follows where a rule is not kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// The data do not ask for the effect: nothing stands that would have to be explained.
    Nothing,
    /// The data ask for something, and it is not named: the answer is `unknown`.
    Abstention,
}

/// The rule that asks for groups enough.
pub(super) const GROUPS: &str = "groups";

/// Every rule, in the order in which they are asked.
pub const RULES: &[Rule] = &[
    Rule {
        id: "gain",
        reason: "the gain in log posterior density, less the price of the choice, exceeds 4",
        refusal: Refusal::Nothing,
        applies: |judged| judged.whole(),
        verdict: |judged| (judged.lead <= GATE).then(|| format!("its gain is {:.1}", judged.lead)),
    },
    Rule {
        id: "lead",
        reason: "a further effect leads by more than 8 over the model without it",
        refusal: Refusal::Nothing,
        applies: |judged| judged.further(),
        verdict: |judged| (judged.lead <= PAIR_GATE).then(|| format!("its lead is {:.1}", judged.lead)),
    },
    Rule {
        id: "agreement",
        reason: "every size is more than twice its standard error between groups",
        refusal: Refusal::Nothing,
        applies: |judged| judged.groups() >= FEWEST_GROUPS && judged.context.basis.method.agreement,
        verdict: |judged| (!agreed(judged.model(), judged.trial)).then(|| "groups do not agree on its size".to_owned()),
    },
    Rule {
        id: "score",
        reason: "every effect scores more than 4.5 at its size",
        refusal: Refusal::Nothing,
        applies: |judged| judged.groups() >= FEWEST_GROUPS,
        verdict: |judged| {
            let least = scores(judged).into_iter().fold(f64::INFINITY, f64::min);
            (least <= CONVINCING).then(|| format!("its score is {least:.1}"))
        },
    },
    Rule {
        id: GROUPS,
        reason: "at least five groups were fitted",
        refusal: Refusal::Abstention,
        applies: |judged| judged.whole(),
        verdict: |judged| {
            let groups = judged.groups();
            let why = || format!("{groups} groups are too few to name an effect, at least {FEWEST_GROUPS} are due");
            (groups < FEWEST_GROUPS).then(why)
        },
    },
    Rule {
        id: "strain",
        reason: "no form allowance is strained by more than five prior standard deviations beside it",
        refusal: Refusal::Abstention,
        applies: |judged| judged.whole(),
        verdict: |judged| {
            let (name, x) = strain(judged.model(), judged.trial).filter(|(_, x)| *x > STRAINED)?;
            let far = format!("`{name}` would be off by {x:.1} prior standard deviations");
            Some(format!("beside the best effect the form of the equations is wrong: {far}"))
        },
    },
    Rule {
        id: "closure",
        reason: "it closes more than 2 % of the gap of left-out groups, or a tenth of what can be closed of it",
        refusal: Refusal::Abstention,
        applies: |_| true,
        verdict: closes,
    },
    Rule {
        id: "size",
        reason: "its size is at least a quarter of an ordinary one, or it moves a channel by as much as matters",
        refusal: Refusal::Abstention,
        applies: |_| true,
        verdict: |judged| too_small(judged.model(), judged.context.basis, judged.trial),
    },
    Rule {
        id: "remainder",
        reason: "not half as much structure is left beside it as it explains",
        refusal: Refusal::Abstention,
        applies: |judged| judged.whole(),
        verdict: |judged| {
            let after = judged.after();
            let left = after.scores.score.get(after.strongest).map_or(0.0, |score| score.abs());
            let remaining = 0.5 * left * left - (after.dictionary.len().max(1) as f64).ln();
            let beside = remaining > REMAINDER * judged.lead && left > after.threshold;
            beside.then(|| format!("beside the best effect as much structure is left (score {left:.1})"))
        },
    },
];

/// A model that is judged.
pub(super) struct Judged<'a> {
    context: Diagnosing<'a>,
    decision: &'a Decision,
    /// The model.
    pub trial: &'a Trial,
    /// What it is held against: the nominal model, or the model without its last effect.
    beside: &'a Trial,
    /// Gain over that, the choice paid for.
    lead: f64,
    own: OnceLock<Closure>,
    after: OnceLock<Remainder>,
}

impl<'a> Judged<'a> {
    /// `trial` against the nominal model.
    pub fn against_nominal(context: Diagnosing<'a>, decision: &'a Decision, trial: &'a Trial) -> Self {
        let lead = decision.gain_of(trial, context.candidates());
        Self::new(context, decision, trial, &decision.base, lead)
    }

    /// `trial` against the model without what it adds to `rival`.
    pub fn against(context: Diagnosing<'a>, decision: &'a Decision, trial: &'a Trial, rival: &'a Trial) -> Self {
        let count = context.candidates();
        let lead = decision.gain_of(trial, count) - decision.gain_of(rival, count);
        Self::new(context, decision, trial, rival, lead)
    }

    fn new(context: Diagnosing<'a>, decision: &'a Decision, trial: &'a Trial, rival: &'a Trial, lead: f64) -> Self {
        Self { context, decision, trial, beside: rival, lead, own: OnceLock::new(), after: OnceLock::new() }
    }

    /// The rules that stand against the model, with what they found; without abstention only those of
    /// [`Refusal::Nothing`] are asked.
    pub fn refusals(&self) -> Vec<(&'static Rule, String)> {
        let abstains = self.context.basis.method.abstention;
        let asked = RULES.iter().filter(|rule| abstains || rule.refusal == Refusal::Nothing);
        let asked = asked.filter(|rule| (rule.applies)(self));
        asked.filter_map(|rule| Some((rule, (rule.verdict)(self)?))).collect()
    }

    fn model(&self) -> &'a dyn Forward {
        self.context.model
    }

    fn groups(&self) -> usize {
        self.model().frame().measured.fitted_groups().count()
    }

    fn whole(&self) -> bool {
        self.beside.fit.active.is_empty()
    }

    fn further(&self) -> bool {
        !self.whole()
    }

    /// Candidates that the model has and the one beside it has not.
    fn added(&self) -> Vec<usize> {
        let new = |index: &usize| !self.beside.fit.active.contains(index);
        self.trial.fit.active.iter().copied().filter(new).collect()
    }

    /// Closure on groups left out by what is added, over the channels that it touches.
    pub fn own(&self) -> &Closure {
        self.own.get_or_init(|| {
            let Diagnosing { model, basis, seed, .. } = self.context;
            let (before, after) = held_against(self.context, self.beside, self.trial, Diagnosing::left_out);
            let groups: Vec<usize> = model.frame().measured.fitted_groups().collect();
            let touched = super::closure::touched_by(model, &self.added());
            closures(model, basis, &before, &after, &groups, &touched, seed).0
        })
    }

    /// What the generic dictionary finds beside the model.
    pub fn after(&self) -> &Remainder {
        self.after.get_or_init(|| self.context.remainder(self.trial))
    }

    /// The same, to be kept.
    pub fn into_after(self) -> Remainder {
        self.after();
        self.after.into_inner().unwrap_or_else(|| self.context.remainder(self.trial))
    }
}

/// What is added has to shrink the gap of groups left out by more than [`LEAST_CLOSED`], or by [`LEAST_OF_CLOSABLE`] of
/// what can be closed at all. An effect of which the form allowance could take half has to close more than [`LEAST_CLOSED`] for certain,
/// alone and beside another one.
///
/// The form of the equations drowns a gap where the interval of the closure holds zero and is wider than the least
/// closure. An effect that the form could not imitate is then named if it improves the prediction of left-out groups
/// beside the allowance, for certain. Another further effect that moves the same readings has to be certain, or to lead by more.
fn closes(judged: &Judged<'_>) -> Option<String> {
    let closed = judged.own();
    let imitated = judged.added().iter().any(|index| judged.decision.base.imitated(judged.model(), *index) > IMITATED);
    let certain = closed.ci90[0] > if imitated { LEAST_CLOSED } else { 0.0 };
    // Where noise is most of a gap, a root mean square hides what is closed; where form errors are, the other does.
    // Nothing to be closed above the noise is no objection.
    let share = if closed.of_closable.is_nan() { 1.0 } else { closed.of_closable };
    let much = closed.closed > LEAST_CLOSED || (closed.closed > 0.0 && share >= LEAST_OF_CLOSABLE);
    let kept = if judged.further() {
        much && (certain || (!imitated && judged.lead > PAIR_GATE + scattered(judged)))
    } else {
        let drowned = !certain && closed.ci90[1] > 0.0 && closed.ci90[1] - closed.ci90[0] > LEAST_CLOSED;
        (much && (certain || !imitated)) || (drowned && !imitated && predicts(judged))
    };
    if kept {
        return None;
    }
    let names: Vec<&str> =
        judged.added().iter().map(|index| judged.model().frame().candidates[*index].id.word()).collect();
    let [low, high] = closed.ci90.map(|end| 100.0 * end);
    let names = names.join(" with ");
    Some(format!("{names} would close {low:.0} … {high:.0} % of the gap on groups left out: it is not named"))
}

/// Whether the model predicts groups left out better than the one beside it while the form allowance is active, for
/// certain.
fn predicts(judged: &Judged<'_>) -> bool {
    let (left_out, error) = predictive_gain(&judged.trial.evidence, &judged.beside.evidence);
    let folds = judged.trial.evidence.folds.len() as f64;
    left_out > toolroom_statistics::student(0.9, folds - 1.0) * error
}

/// Further lead that a further effect needs because occurrences of the first cause scatter.
fn scattered(judged: &Judged<'_>) -> f64 {
    let first = judged.decision.gain_of(judged.beside, judged.context.candidates());
    SCATTERED * first * overlap(judged)
}

/// Share of what the further effects do that they do to readings which the others move too.
fn overlap(judged: &Judged<'_>) -> f64 {
    let (model, own, other) = (judged.model(), &judged.trial.fit, &judged.beside.fit);
    // Each fit has the derivatives by its own effects: the model need not have kept those of the one beside it.
    let moves = |fit: &Fit, list: &[usize], i: usize| {
        let slope = |index: &usize| fit.linear.effects[*index].get(i).map_or(0.0, |slope| slope.abs());
        list.iter().map(slope).sum::<f64>()
    };
    let added = judged.added();
    let deviation = |i: usize| judged.context.basis.noise.deviation(&model.frame().measured, i);
    let square = |i: usize| (moves(own, &added, i) / deviation(i)).powi(2);
    let rows = 0..own.linear.residual.len();
    let all: f64 = rows.clone().map(square).sum();
    let shared: f64 = rows.filter(|i| moves(other, &other.active, *i) != 0.0).map(square).sum();
    if all > 0.0 { shared / all } else { 0.0 }
}

/// Whether the groups agree on every effect of a trial.
pub(super) fn agreed(model: &dyn Forward, trial: &Trial) -> bool {
    let errors = trial.jackknife();
    trial.sizes(model).iter().zip(errors).all(|(size, error)| size.abs() > AGREED * error)
}

/// The form allowance that a trial strains most, among those that act where its effects act: name and
/// prior standard deviations.
pub(super) fn strain<'m>(model: &'m dyn Forward, trial: &Trial) -> Option<(&'m str, f64)> {
    let (frame, linear) = (model.frame(), &trial.fit.linear);
    let parameters = frame.parameters.iter().map(|each| (each.name.as_str(), each.role.is_allowance()));
    let surfaces = frame.surfaces.iter().map(|each| (each.name.as_str(), each.role.is_allowance()));
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

/// Score of every effect of a trial at its size, by the means of readings and by their shape.
fn scores(judged: &Judged<'_>) -> Vec<f64> {
    let (model, lengths) = (judged.model(), judged.decision.base.scores().length);
    let score = |(index, size): (&usize, f64)| {
        let shape = shape_lead(model, *index);
        (lengths[*index] * size).hypot((2.0 * shape).sqrt())
    };
    judged.trial.fit.active.iter().zip(judged.trial.sizes(model)).map(score).collect()
}

/// Whether a model keeps the rules of [`Refusal::Nothing`] that need no new prediction.
pub(super) fn stands(judged: &Judged<'_>) -> bool {
    RULES
        .iter()
        .filter(|rule| rule.refusal == Refusal::Nothing && (rule.applies)(judged))
        .all(|rule| (rule.verdict)(judged).is_none())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_rule_has_a_word_of_its_own_and_says_what_it_asks() {
        for (i, rule) in RULES.iter().enumerate() {
            assert!(!rule.id.is_empty() && rule.reason.len() > 20, "{}", rule.id);
            assert!(RULES[..i].iter().all(|before| before.id != rule.id), "{} stands twice", rule.id);
        }
    }

    /// Parts of the method that the ablation leaves out and that have a constant of their own.
    const PARTS: [&str; 1] = ["form tolerance"];

    #[test]
    fn every_rule_is_the_row_of_a_constant_and_every_row_that_a_constant_names_is_there() {
        let text = include_str!("constants.rs").replace("\n///", "");
        let named: Vec<&str> = text.split("the row \"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
        for rule in RULES {
            assert!(named.contains(&rule.id), "no constant names the row {}", rule.id);
        }
        for row in named {
            let known = RULES.iter().any(|rule| rule.id == row) || PARTS.contains(&row);
            assert!(known, "there is no row {row}");
        }
    }
}
