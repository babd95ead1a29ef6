//! Processes that only go forward: what interrupts a pass asks them to go back to where it began.

use super::error::ShopError;
use toolroom_scenario::{Interruption, Operation, Scenario, ShiftCalendar};

/// Refuses a tool that cannot go back for passes that are interrupted before the horizon.
pub(super) fn check(scenario: &Scenario) -> Result<(), ShopError> {
    for operation in scenario.parts.iter().flat_map(|part| &part.operations) {
        let tools = (0..operation.work.passes()).filter_map(|pass| operation.tool_of_pass(pass));
        for tool in tools.map(|tool| &scenario.tools[tool]).filter(|tool| !tool.process.machine_process().goes_back()) {
            let interrupted = |machine: &usize| {
                let by = of_machine(scenario, *machine).or_else(|| of_people(scenario, operation))?;
                Some((scenario.machines[*machine].name.clone(), by))
            };
            if let Some((machine, by)) = operation.machines.iter().find_map(interrupted) {
                return Err(ShopError::CannotGoBack { tool: tool.name.clone(), machine, by });
            }
        }
    }
    Ok(())
}

/// What interrupts the passes on a machine.
fn of_machine(scenario: &Scenario, machine: usize) -> Option<String> {
    if scenario.failures.iter().any(|failure| failure.machine == machine) {
        return Some("its breakdowns".to_owned());
    }
    let calendar = &scenario.calendars[scenario.machines[machine].calendar?];
    if calendar.at_end != Interruption::Finish {
        return Some(format!("the end of a shift of calendar `{}` (at_end = \"finish\" would not)", calendar.name));
    }
    // A break does, whatever becomes of the part when the shift is over.
    pauses(calendar, scenario.horizon).then(|| format!("a break of calendar `{}`", calendar.name))
}

/// Whether a pass waits for somebody to attend it: it is planned before, and again when the person has come.
fn of_people(scenario: &Scenario, operation: &Operation) -> Option<String> {
    let attended = operation.attendance.run.is_some() && !scenario.operators.is_empty();
    attended.then(|| format!("waits for the person who attends operation `{}`", operation.name))
}

/// Whether a break comes before `horizon` (s).
fn pauses(calendar: &ShiftCalendar, horizon: f64) -> bool {
    std::iter::successors(calendar.next_boundary(0.0), |last| calendar.next_boundary(last.time))
        .take_while(|boundary| boundary.time < horizon)
        .any(|boundary| boundary.pauses)
}
