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
use toolroom_facts::findings;
use toolroom_nominal::HeardCut;
use toolroom_records::Records;

/// Fewest cuts of a machine of which anything is said (assumption, as for readings of a channel).
const FEWEST: usize = 8;

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
