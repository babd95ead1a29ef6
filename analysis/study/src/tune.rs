//! The best settings of every policy ([`toolroom_tune`]), what they are worth on fresh random numbers, and the verdict without the
//! guard.

mod told;

pub use told::{tuning_json, tuning_text};
pub use toolroom_tune::*;

use crate::compare::Comparison;
use crate::study::{Progress, StudyError, StudyOptions, run_study};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use toolroom_scenario::Scenario;

/// The verdict between policies whose settings were `freed` of the guard ([`Tuning::freed_of_guard`]) and stand in `scenario`, on
/// the random numbers that judge the others; `None` where `stop` was set before all replications were complete.
///
/// # Errors
/// See [`StudyError`].
pub fn guardless(
    scenario: &Scenario,
    freed: Tuning,
    policies: &[usize],
    threads: usize,
    progress: &(dyn Fn(Progress) + Sync),
    stop: &AtomicBool,
) -> Result<Option<GuardlessVerdict>, StudyError> {
    let options = StudyOptions {
        policies: policies.to_vec(),
        threads,
        logged: 0,
        tuning: Some(Arc::new(freed)),
        ..StudyOptions::of(scenario)
    };
    let study = run_study(scenario, &options, None, progress, stop)?;
    let comparison = Comparison::new(scenario, &study);
    let decision = &comparison.decision;
    let name = |position: usize| comparison.policies[position].name.clone();
    Ok(study.complete.then(|| GuardlessVerdict {
        line: decision.line.clone(),
        between: [decision.adaptive, decision.rival].map(|position| position.map(name)),
        difference: decision.difference.as_ref().map(|own| [own.mean, own.low(), own.high()]),
    }))
}
