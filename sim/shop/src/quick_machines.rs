//! Machines that do plain work and have nothing else to look at.

use super::operation_plan::{ContentPlan, OperationPlan};
use toolroom_scenario::{Assignment, Scenario};

/// Which machines have nothing else to look at but their queues; `one_step` are those on which plain work is one step, `bare` is
/// whether the shop has nothing beside machines with queues that is looked at in every instant.
pub(super) fn machines(
    scenario: &Scenario,
    operations: &[Vec<OperationPlan>],
    one_step: Vec<bool>,
    bare: bool,
) -> Vec<bool> {
    let control = &scenario.control;
    let simple = bare
        && scenario.orders.is_empty()
        && scenario.shared.cribs.is_empty()
        && scenario.shared.stocks.is_empty()
        && scenario.maintenance.is_empty()
        && control.schedule.is_none()
        && control.assign != Assignment::AtArrival;
    if !simple {
        return vec![false; one_step.len()];
    }
    let mut quick: Vec<bool> = one_step
        .into_iter()
        .zip(&scenario.machines)
        .map(|(one_step, machine)| one_step && machine.calendar.is_none() && machine.batch.is_none())
        .collect();
    for (plan, operation) in operations.iter().flatten().zip(scenario.parts.iter().flat_map(|part| &part.operations)) {
        let alone = plan.only_machine.is_some() && !plan.stretched && !plan.inspected && !plan.assembles && !plan.apart;
        if !alone || !matches!(plan.content, ContentPlan::Plain) {
            operation.machines.iter().for_each(|machine| quick[*machine] = false);
        }
    }
    quick
}
