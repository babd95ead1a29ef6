//! What a diagnosis says, and its JSON form (schema 1).

use super::drift::DynamicsDrift;
use super::number::number;
use super::{ChannelId, EffectId, Fitness, Identifiable, Measures};
use serde_json::{Value, json};
use toolroom_facts::{Fact, Finding};
use toolroom_nominal::WrittenEffect;

/// The answer in one word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GapVerdict {
    /// A missing effect is named.
    Effect,
    /// A constant of the model is off: more than was believed, or contradicted by what the log counts.
    Constant,
    /// There is a gap that no effect of the catalogue explains.
    Unknown,
    /// What is missing cannot be seen in such data: calibration takes it up.
    Masked,
    /// The model does not fit, but what it leaves matters nowhere.
    Small,
    /// The calibrated model fits: a test with a stated level does not reject it.
    NoGap,
    /// Too little was measured for any answer.
    CannotTell,
}

impl GapVerdict {
    /// Every verdict, that by which most is found first.
    pub const ALL: [Self; 7] =
        [Self::Effect, Self::Unknown, Self::Constant, Self::Masked, Self::Small, Self::CannotTell, Self::NoGap];

    /// The verdict over several parts: that of the part where most is found. No gap is answered only where every part
    /// could be told.
    pub fn of_all(parts: impl Iterator<Item = Self>) -> Self {
        let rank = |verdict: &Self| Self::ALL.iter().position(|own| own == verdict);
        parts.min_by_key(rank).unwrap_or(Self::NoGap)
    }

    /// Word in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Effect => "effect",
            Self::Constant => "constant",
            Self::Unknown => "unknown",
            Self::Masked => "masked",
            Self::Small => "small",
            Self::NoGap => "no_gap",
            Self::CannotTell => "cannot_tell",
        }
    }
}

/// A named effect. Sizes are in the display unit of the catalogue.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedEffect {
    /// The effect.
    pub id: EffectId,
    /// What it is, in words.
    pub title: &'static str,
    /// Whether it describes the records without saying why, as its author says: **empirical, not a cause**.
    pub empirical: bool,
    /// Which lot, window or time constant, or where it acts, for people; may be empty.
    pub shape: String,
    /// How a scenario says it.
    pub written: WrittenEffect,
    /// Size.
    pub size: f64,
    /// Unit of the size.
    pub unit: &'static str,
    /// 90 % interval of the size.
    pub ci90: [f64; 2],
    /// Probability that it belongs to the model, by the posterior weights of all models that were tried.
    pub probability: f64,
    /// Score after projection.
    pub z: f64,
    /// Gain of log posterior density, the choice among many paid for; gain of log predictive
    /// density on groups left out.
    pub gain: [f64; 2],
    /// Effects that the data cannot tell from it, itself first.
    pub class: Vec<EffectId>,
    /// Why the class has more than one.
    pub class_reason: String,
}

/// A cell of the localisation map.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// Channel or channels.
    pub channel: String,
    /// Group of rows, `machine=L1`, or `all`.
    pub group: String,
    /// Covariate that the gap follows.
    pub regime: String,
    /// Score.
    pub score: f64,
    /// Relative root mean square of what the nominal model leaves where the covariate is high.
    pub rms_before: f64,
    /// The same after the named effects.
    pub rms_after: f64,
}

/// How far a gap shrinks on groups that the fit did not see.
#[derive(Clone, Debug, PartialEq)]
pub struct Closure {
    /// Root mean square without the effects, in the channel's comparison unit.
    pub before: f64,
    /// With them.
    pub after: f64,
    /// `1 − after/before`.
    pub closed: f64,
    /// 90 % interval of confidence for the closure on all groups of this kind, of which the scored ones are a sample.
    pub ci90: [f64; 2],
    /// 90 % interval of prediction for the closure on as many new groups: those scatter by themselves, too.
    pub pi90: [f64; 2],
    /// Share of what could be closed at all: of the mean square above the noise floor, at most 1. No number where less
    /// than a fifth of the mean square lies above it.
    pub of_closable: f64,
    /// Other measures of the same readings; a far reading counts as it is except where a measure says otherwise.
    pub measures: Measures,
}

/// A reading that stands apart from all others of its channel, with the named effects as without.
#[derive(Clone, Debug, PartialEq)]
pub struct OutlyingReading {
    /// Row of the records.
    pub row: usize,
    /// Its operation; empty where nobody said.
    pub operation_id: String,
    /// Channel.
    pub channel: ChannelId,
    /// Measured less predicted without effects, SI.
    pub excess: f64,
    /// SI unit.
    pub unit: &'static str,
}

/// Share of the gap by cause, each beyond those before it and beyond chance; none of the explained ones is negative, they
/// sum to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Budget {
    /// Removed by recalibration of the nominal constants.
    pub calibration: f64,
    /// Removed by the form allowance beside calibration and effects.
    pub form_allowance: f64,
    /// Removed by the named effects beside calibration.
    pub effects: f64,
    /// Structure that nothing explains.
    pub unexplained: f64,
    /// Noise, scatter from edge to edge, and what numbers explain of them by chance.
    pub noise_floor: f64,
}

/// The experiment to do next.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NextExperiment {
    /// What to run.
    pub design: String,
    /// Machine time, min.
    pub minutes: f64,
    /// Pairs that it separates.
    pub separates: Vec<[String; 2]>,
}

/// Where calibration went.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibrated {
    /// Parameter.
    pub parameter: String,
    /// Fitted factor on the nominal value; of what is added rather than multiplied, the summand, SI.
    pub value: f64,
    /// 90 % interval of that, beside the allowance and the effects.
    pub ci90: [f64; 2],
    /// Distance from nominal in prior standard deviations.
    pub prior_sd_moved: f64,
    /// Whether it is the gain of a sensor.
    pub gain: bool,
    /// Whether it is a constant of the model: no form allowance, no gain of a sensor.
    pub constant: bool,
}

/// Everything that a diagnosis says.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnosis {
    /// The answer.
    pub verdict: GapVerdict,
    /// Named effects.
    pub effects: Vec<NamedEffect>,
    /// Where the gap lies, strongest first.
    pub cells: Vec<Cell>,
    /// Closure over all channels, in units of noise.
    pub total: Closure,
    /// Closure by channel.
    pub channels: Vec<(ChannelId, Closure)>,
    /// Groups on which it was scored.
    pub held_out: Vec<String>,
    /// Readings in those that stand apart.
    pub apart: Vec<OutlyingReading>,
    /// Where the gap goes.
    pub budget: Budget,
    /// What cannot be seen.
    pub masked: Vec<Identifiable>,
    /// What to do next.
    pub next: NextExperiment,
    /// Calibration.
    pub calibration: Vec<Calibrated>,
    /// Ranking of single effects: id, shape, size, gain and its standard error.
    pub ranking: Vec<Ranked>,
    /// What every model that was fitted would close.
    pub tried: Vec<Tried>,
    /// Anything else worth knowing.
    pub notes: Vec<String>,
    /// The test of the calibrated nominal model; `None` where none was made.
    pub fit: Option<Fitness>,
    /// The same test with the named effects; `None` where none is named.
    pub fit_with_effects: Option<Fitness>,
    /// Which effects calibration may have taken up, in words; `None` unless the verdict is `masked`.
    pub suspected: Option<String>,
    /// Best models that were not named, and why.
    pub not_named: Vec<NotNamed>,
    /// What was counted and no channel predicts.
    pub facts: Vec<Fact>,
    /// The facts that contradict the file.
    pub findings: Vec<Finding>,
    /// What chatter says of the structure around the cut, machine by machine.
    pub dynamics: Vec<DynamicsDrift>,
}

/// A model that was the best of its kind and was not named.
#[derive(Clone, Debug, PartialEq)]
pub struct NotNamed {
    /// Its effects.
    pub effects: Vec<EffectId>,
    /// The rules that stood against it, in their order.
    pub rules: Vec<RuleFinding>,
}

/// What a rule of the decision found against a model.
#[derive(Clone, Debug, PartialEq)]
pub struct RuleFinding {
    /// Word of the rule.
    pub rule: &'static str,
    /// What the rule asks.
    pub asks: &'static str,
    /// What it found.
    pub found: String,
}

/// A model with effects that was fitted.
#[derive(Clone, Debug, PartialEq)]
pub struct Tried {
    /// Its effects with their shapes.
    pub effects: Vec<String>,
    /// Gain over the nominal model, the choice among many paid for.
    pub gain: f64,
    /// Closure on groups left out.
    pub closure: Closure,
}

/// One row of the ranking.
#[derive(Clone, Debug, PartialEq)]
pub struct Ranked {
    /// The effect.
    pub id: EffectId,
    /// Shape; may be empty.
    pub shape: String,
    /// Size, display unit.
    pub size: f64,
    /// Unit.
    pub unit: &'static str,
    /// Score after projection.
    pub z: f64,
    /// Gain over the nominal model, the choice among many paid for.
    pub gain: f64,
    /// Gain on groups left out, and its standard error.
    pub left_out: [f64; 2],
}

impl NotNamed {
    fn json(&self) -> Value {
        let rule = |found: &RuleFinding| json!({ "id": found.rule, "asks": found.asks, "found": found.found });
        json!({ "effects": EffectId::words(&self.effects), "rules": self.rules.iter().map(rule).collect::<Vec<_>>() })
    }
}

impl Budget {
    /// Of a gap of which nothing is known.
    const UNKNOWN: Self = Self {
        calibration: f64::NAN,
        form_allowance: f64::NAN,
        effects: f64::NAN,
        unexplained: f64::NAN,
        noise_floor: f64::NAN,
    };

    pub(super) fn json(&self) -> Value {
        json!({
            "calibration": number(self.calibration), "form_allowance": number(self.form_allowance),
            "effects": number(self.effects), "unexplained": number(self.unexplained),
            "noise_floor": number(self.noise_floor),
        })
    }
}

impl Closure {
    /// Of a gap of which nothing is known.
    pub(super) const UNKNOWN: Self = Self {
        before: f64::NAN,
        after: f64::NAN,
        closed: f64::NAN,
        ci90: [f64::NAN; 2],
        pi90: [f64::NAN; 2],
        of_closable: f64::NAN,
        measures: Measures::UNKNOWN,
    };

    pub(super) fn json(&self, with_groups: Option<&[String]>) -> Value {
        let mut value = json!({
            "before": number(self.before), "after": number(self.after), "closed": number(self.closed),
            "ci90": self.ci90.map(number), "pi90": self.pi90.map(number), "of_closable": number(self.of_closable),
            "measures": self.measures.json(),
        });
        if let Some(groups) = with_groups {
            value["heldout_groups"] = json!(groups);
        }
        value
    }
}

impl Diagnosis {
    /// Too little was measured, and why that is too little.
    pub fn cannot_tell(why: String) -> Self {
        Self {
            verdict: GapVerdict::CannotTell,
            effects: Vec::new(),
            cells: Vec::new(),
            total: Closure::UNKNOWN,
            channels: Vec::new(),
            held_out: Vec::new(),
            apart: Vec::new(),
            budget: Budget::UNKNOWN,
            masked: Vec::new(),
            next: NextExperiment::default(),
            calibration: Vec::new(),
            ranking: Vec::new(),
            tried: Vec::new(),
            notes: vec![why],
            fit: None,
            fit_with_effects: None,
            suspected: None,
            not_named: Vec::new(),
            facts: Vec::new(),
            findings: Vec::new(),
            dynamics: Vec::new(),
        }
    }

    /// The document `diagnosis.json`.
    pub fn json(&self) -> Value {
        let effect = |effect: &NamedEffect| {
            json!({
                "id": effect.id.word(), "title": effect.title, "shape": effect.shape, "size": number(effect.size), "unit": effect.unit,
                "ci90": [number(effect.ci90[0]), number(effect.ci90[1])], "probability": number(effect.probability),
                "z": number(effect.z), "gain": number(effect.gain[0]), "gain_left_out": number(effect.gain[1]),
                "class": EffectId::words(&effect.class), "class_reason": effect.class_reason,
            })
        };
        let cell = |cell: &Cell| {
            json!({
                "channel": cell.channel, "group": cell.group, "regime": cell.regime, "score": number(cell.score),
                "rms_before": number(cell.rms_before), "rms_after": number(cell.rms_after),
            })
        };
        let masked = |masked: &Identifiable| {
            json!({
                "id": masked.id.word(), "shape": masked.shape, "masking": number(masked.masking),
                "minimal_detectable": number(masked.minimal_detectable), "unit": masked.unit,
                "separating_test": masked.separating_test, "calibration_bias": masked.bias,
            })
        };
        let ranked = |ranked: &Ranked| {
            json!({
                "id": ranked.id.word(), "shape": ranked.shape, "size": number(ranked.size), "unit": ranked.unit,
                "z": number(ranked.z), "gain": number(ranked.gain), "left_out": ranked.left_out.map(number),
            })
        };
        let channels: serde_json::Map<String, Value> =
            self.channels.iter().map(|(name, closure)| (name.to_string(), closure.json(None))).collect();
        json!({
            "schema": 1,
            "verdict": self.verdict.name(),
            "effects": self.effects.iter().map(effect).collect::<Vec<_>>(),
            "where": self.cells.iter().map(cell).collect::<Vec<_>>(),
            "closure": { "total": self.total.json(Some(&self.held_out)), "channels": channels },
            "apart": self.apart.iter().map(|own| json!({
                "operation_id": own.operation_id, "row": own.row, "channel": own.channel.word(), "excess": number(own.excess),
                "unit": own.unit,
            })).collect::<Vec<_>>(),
            "budget": self.budget.json(),
            "masked": self.masked.iter().map(masked).collect::<Vec<_>>(),
            "next_experiment": {
                "design": self.next.design, "minutes": number(self.next.minutes), "separates": self.next.separates,
            },
            "calibration": self.calibration.iter().map(|each| json!({
                "parameter": each.parameter, "value": number(each.value), "ci90": each.ci90.map(number),
                "prior_sd_moved": number(each.prior_sd_moved),
            })).collect::<Vec<_>>(),
            "ranking": self.ranking.iter().map(ranked).collect::<Vec<_>>(),
            "tried": self.tried.iter().map(|tried| json!({
                "effects": tried.effects, "gain": number(tried.gain), "closure": tried.closure.json(None),
            })).collect::<Vec<_>>(),
            "not_named": self.not_named.iter().map(NotNamed::json).collect::<Vec<_>>(),
            "notes": self.notes,
            "fit": self.fit.as_ref().map_or(Value::Null, Fitness::json),
            "remaining": self.remaining(),
            "facts": self.facts.iter().enumerate().map(|(index, fact)| {
                fact.json(self.findings.iter().any(|finding| finding.fact == index))
            }).collect::<Vec<_>>(),
            "dynamics_drift": self.dynamics.iter().map(DynamicsDrift::json).collect::<Vec<_>>(),
        })
    }
}
