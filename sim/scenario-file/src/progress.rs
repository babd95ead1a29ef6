//! Sources that bring jobs without end in no time: such a shop never gets past the instant.

use super::fault::ScenarioFault;
use toolroom_form::{Section, Walk};
use toolroom_scenario::{Arrival, ArrivalPattern, Distribution, Operation, ReleaseRule, Scenario, Work};

/// Refuses a time between jobs that is nought.
pub(super) fn check_interval(walk: &mut Walk, section: &Section<'_>, time_between: &Distribution) {
    if time_between.mean() == 0.0 {
        let reason = "the time between jobs is 0: endlessly many come in an instant".to_owned();
        let fix = "give a time above 0, or several jobs at a time by `pattern = \"batch\"` or `schedule`".to_owned();
        walk.fault(section.span_of("time_between"), ScenarioFault::Arrangement { reason, fix });
    }
}

/// Refuses sources that keep jobs in the shop which pass it in no time: each that leaves brings the next one at once.
pub(super) fn check(walk: &mut Walk, root: &Section<'_>, scenario: &Scenario) {
    for source in &scenario.arrivals {
        let endless = match source.pattern {
            ArrivalPattern::ConstantWork { .. } => passes_in_no_time(scenario, source),
            ArrivalPattern::Schedule(_)
            | ArrivalPattern::Renewal(_)
            | ArrivalPattern::Poisson { .. }
            | ArrivalPattern::Batch { .. } => false,
        };
        if endless {
            let parts = source.parts_named(&scenario.parts);
            let reason = format!(
                "part \"{parts}\" takes no time, and `constant_work` brings the next one when one leaves: endlessly many come in an instant"
            );
            let fix =
                "give an operation of the part a time above 0, or let the jobs come by another pattern".to_owned();
            walk.fault(root.span_of("arrivals"), ScenarioFault::Arrangement { reason, fix });
        }
    }
}

/// Whether no job of a source ever needs any time in the shop. Where that hangs on the state of a machine (setups, batches)
/// or on moves and releases, the answer is no: time may pass.
fn passes_in_no_time(scenario: &Scenario, source: &Arrival) -> bool {
    let waits = scenario.move_time.mean() > 0.0
        || !scenario.transports.is_empty()
        || !matches!(scenario.control.release, ReleaseRule::Immediate);
    let parts = source.parts.iter().map(|(part, _)| &scenario.parts[*part]);
    !waits
        && parts.into_iter().all(|part| {
            part.components.is_empty() && part.operations.iter().all(|operation| takes_no_time(scenario, operation))
        })
}

fn takes_no_time(scenario: &Scenario, operation: &Operation) -> bool {
    let plain = matches!(operation.work, Work::Plain(_)) && operation.work.plain_time() == 0.0;
    plain
        && operation.setup_spread.is_none()
        && operation.machines.iter().all(|machine| {
            let machine = &scenario.machines[*machine];
            machine.batch.is_none()
                && machine.setup_matrix.is_none()
                && operation.setup_time.unwrap_or(machine.setup_time) == 0.0
                && machine.load_time.mean() == 0.0
                && machine.unload_time.mean() == 0.0
        })
}
