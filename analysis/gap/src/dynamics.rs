//! Whether what was heard of chatter contradicts the structure of the model file: `dynamics_drift`.
//!
//! A lobe moves along the speed with natural frequencies, and along the depth with stiffness times damping over the
//! coefficient of the force. Three hypotheses are held against the cuts of every machine:
//!
//! | hypothesis | natural frequencies | depth of the limit | damping ratios |
//! |---|---|---|---|
//! | as known | prior of the file | prior of the file | prior of the file |
//! | `mode_frequency` | anywhere within ± 20 % | as known | as known |
//! | `mode_stiffness` | as known | anywhere within a factor of 2.5 | as known |
//!
//! A cut says chatter with probability `e + (1 − 2e) Φ((ln depth − ln limit)/s)`; s is the scatter of hardness. What the
//! better of the last two gains in log evidence over the first is compared with what it gains in records that the first one
//! draws, lots and pieces of one hardness and wrong records among them: the probability `p` holds whatever the prior.
//!
//! # What chatter cannot tell
//! Stiffness, damping and the coefficient of the force move the limit alike; a tap or a force tells them apart.
//!
//! # Not modelled
//! A structure that changes while the records go on; cuts at varying speed; depths that are stable again beyond the first limit.

mod question;
#[cfg(test)]
mod tests;

use super::{Diagnosis, GapVerdict, NominalModel};
use question::Question;
use serde_json::{Value, json};
use toolroom_facts::findings;
use toolroom_nominal::HeardCut;
use toolroom_records::Records;

/// Fewest cuts of a machine of which anything is said (assumption, as for readings of a channel).
const FEWEST: usize = 8;
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

    fn words(&self) -> String {
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

/// Tests what was heard of chatter against the structure of the model file, machine by machine, and adds it to what is said: a
/// structure that the cuts contradict leaves no `no_gap`. Nothing is added where no cut says whether it chattered.
pub fn add_dynamics(model: &NominalModel, records: &Records, diagnosis: &mut Diagnosis, seed: u64) {
    let heard = model.heard_cuts(records);
    if heard.is_empty() {
        if model.vibrates() {
            let note = "not asked: whether the structure has drifted; records need `chatter` (0 or 1), and in turning `spindle_speed`";
            diagnosis.notes.push(note.to_owned());
        }
        return;
    }
    let prior = model.structure_prior();
    let mut machines: Vec<&str> = heard.iter().map(|cut| cut.machine.as_str()).collect();
    machines.sort_unstable();
    machines.dedup();
    let first = diagnosis.facts.len();
    for (number, machine) in machines.into_iter().enumerate() {
        let cuts: Vec<&HeardCut> = heard.iter().filter(|cut| cut.machine == machine).collect();
        if cuts.len() < FEWEST {
            let count = cuts.len();
            diagnosis
                .notes
                .push(format!("{machine}: {count} cuts with `chatter`; {FEWEST} tell of a drift of its dynamics"));
            continue;
        }
        let question = Question::new(model, &cuts, prior);
        let drift = question.answered(machine, seed.wrapping_add(number as u64));
        diagnosis.facts.push(question.fact(model, &drift));
        diagnosis.dynamics.push(drift);
    }
    diagnosis.findings = findings(&diagnosis.facts);
    for finding in diagnosis.findings.iter().filter(|finding| finding.fact >= first) {
        let drift = &mut diagnosis.dynamics[finding.fact - first];
        drift.drift = true;
        diagnosis.notes.push(drift.words());
    }
    let quiet = matches!(diagnosis.verdict, GapVerdict::NoGap | GapVerdict::Masked | GapVerdict::Small);
    if quiet && diagnosis.dynamics.iter().any(|own| own.drift) {
        diagnosis.verdict = GapVerdict::Constant;
    }
}
