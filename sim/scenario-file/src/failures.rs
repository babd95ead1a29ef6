//! Breakdowns.

use super::names::{Names, machine_indices, reference};
use super::random::distribution;
use toolroom_form::{Fault, Section, Walk};
use toolroom_scenario::{FailureClock, FailureMode, Interruption};

/// Breakdowns, one for each of their machines.
pub(super) fn failures(walk: &mut Walk, root: &Section<'_>, names: &Names) -> Vec<FailureMode> {
    let (mut failures, mut seen) = (Vec::new(), Vec::new());
    for section in walk.sections(root, "failure", None) {
        let name = section.text("name").map(str::to_owned);
        if let Some(name) = &name {
            if seen.contains(name) {
                walk.fault(section.span_of("name"), Fault::DuplicateName { kind: "failure", name: name.clone() });
            }
            seen.push(name.clone());
        }
        let time_between = distribution(walk, &section, "time_between");
        let time_to_repair = distribution(walk, &section, "time_to_repair");
        // Without a word a problem was noted.
        let clock = section.chosen("clock", FailureClock::from_word).unwrap_or(FailureClock::Busy);
        let part = section.chosen("part", Interruption::from_word).unwrap_or(Interruption::Resume);
        let crew = reference(walk, "crew", section.got("crew"), names.crews.iter().map(String::as_str));
        for machine in machine_indices(walk, &section, "machines", names) {
            let (time_between, time_to_repair) = (time_between.clone(), time_to_repair.clone());
            let name = name.clone();
            failures.push(FailureMode { name, machine, time_between, time_to_repair, clock, crew, part });
        }
    }
    failures
}
