//! What chatter says of a structure: the explanations, their names, what is written of them.

use serde_json::{Value, json};

/// Gain by which an explanation leads before the other one is ruled out: odds of seven to one (assumption).
const LEADS: f64 = 2.0;

/// What may have moved a structure's lobes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StructureChange {
    /// Natural frequencies, all by one factor: lobes move along the speed.
    ModeFrequency,
    /// Stiffness, by which the depth of the limit moves.
    ModeStiffness,
}

impl StructureChange {
    /// Its name in `diagnosis.json`.
    pub fn id(self) -> &'static str {
        match self {
            Self::ModeFrequency => "mode_frequency",
            Self::ModeStiffness => "mode_stiffness",
        }
    }

    /// The names of all changes that move the lobes as this one does, itself first.
    fn alike(self) -> &'static [&'static str] {
        match self {
            Self::ModeFrequency => &["mode_frequency"],
            Self::ModeStiffness => &["mode_stiffness", "mode_damping", "cutting_coefficient"],
        }
    }

    fn words(self) -> &'static str {
        match self {
            Self::ModeFrequency => "natural frequencies",
            Self::ModeStiffness => "the depth of the limit",
        }
    }
}

/// What a hypothesis makes of the cuts of a machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriftExplanation {
    /// What has moved.
    pub change: StructureChange,
    /// Factor on the natural frequencies, or on the depth of the limit.
    pub factor: f64,
    /// Its 90 % interval.
    pub ci90: [f64; 2],
    /// Gain in log evidence over the structure as it was known.
    pub gain: f64,
}

/// What the chatter of a machine says of its structure.
#[derive(Clone, Debug, PartialEq)]
pub struct DynamicsDrift {
    /// Machine.
    pub machine: String,
    /// Cuts of which is known whether they chattered, how many did, and how many were expected to.
    pub cuts: usize,
    /// Cuts with chatter.
    pub chattered: usize,
    /// Mean of what the structure as it was known lets expect.
    pub expected: f64,
    /// Probability of such a gain by chance.
    pub p: f64,
    /// Explanations, the better one first.
    pub explanations: [DriftExplanation; 2],
    /// Whether the structure has drifted, at the level of the facts.
    pub drift: bool,
}

impl DynamicsDrift {
    /// The explanations that the cuts leave: the best, and the other one where it is nearly as good.
    fn left(&self) -> &[DriftExplanation] {
        let [best, other] = &self.explanations;
        if best.gain - other.gain < LEADS { &self.explanations } else { &self.explanations[..1] }
    }

    /// Names of the changes that the cuts cannot tell from the best: all that move the limit alike, and those of the other
    /// explanation where it is nearly as good.
    pub fn class(&self) -> Vec<&'static str> {
        self.left().iter().flat_map(|own| own.change.alike()).copied().collect()
    }

    /// The entry of `dynamics_drift` in `diagnosis.json`.
    pub(super) fn json(&self) -> Value {
        let explanation = |own: &DriftExplanation| json!({ "id": own.change.id(), "factor": own.factor, "size": own.factor - 1.0, "ci90": own.ci90, "gain": own.gain });
        json!({
            "machine": self.machine, "cuts": self.cuts, "chattered": self.chattered, "expected": self.expected,
            "p": self.p, "drift": self.drift, "class": self.class(),
            "explanations": self.explanations.iter().map(explanation).collect::<Vec<_>>(),
        })
    }

    /// One sentence for people.
    pub(super) fn words(&self) -> String {
        let best = &self.explanations[0];
        let percent = |factor: f64| 100.0 * (factor - 1.0);
        let nearly = |own: &DriftExplanation| {
            format!("; {} by {:+.1} % would explain it nearly as well", own.change.words(), percent(own.factor))
        };
        let near = self.left().get(1).map(nearly).unwrap_or_default();
        let alike = if self.left().iter().any(|own| own.change == StructureChange::ModeStiffness) {
            "; stiffness, damping and coefficient of the force move the limit alike"
        } else {
            ""
        };
        format!(
            "dynamics_drift on {}: {} of {} cuts chattered, {:.1} were expected; {} by {:+.1} % ({:+.1} … {:+.1}) explains it{near}{alike}",
            self.machine,
            self.chattered,
            self.cuts,
            self.expected,
            best.change.words(),
            percent(best.factor),
            percent(best.ci90[0]),
            percent(best.ci90[1]),
        )
    }
}
