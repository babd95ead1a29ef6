//! Who draws for breakdowns, planned maintenance and edges.
//!
//! What has a name draws by it. What has none draws by its place among those of its machine without a name, in the order of
//! their mean times, so that the order of sections in a file decides nothing.

use std::cmp::Ordering;
use toolroom_kernel::Entity;
use toolroom_scenario::{FailureClock, FailureMode, MachineType, Maintenance, Scenario, ToolType};

/// Owners of planned maintenance, parts of its machine's name: apart from those of its breakdowns.
const UPKEEP: u64 = 1 << 45;

/// Modes or plans of every machine in an order that does not hang on the file, and who draws for each of them.
pub(super) type Owned = (Vec<Vec<u32>>, Vec<Entity>);

/// Breakdowns; `machines` are the names of the machines.
pub(super) fn of_failures(scenario: &Scenario, machines: &[Entity]) -> Owned {
    let modes = &scenario.failures;
    let mut of_machines = grouped(machines.len(), modes.iter().map(|mode| mode.machine));
    let mut owners = vec![Entity::named(""); modes.len()];
    for (machine, own) in of_machines.iter_mut().enumerate() {
        own.sort_by(|a, b| by_name_or_times(&modes[*a as usize], &modes[*b as usize]));
        let mut unnamed = 0;
        for &mode in own.iter() {
            owners[mode as usize] = match &modes[mode as usize].name {
                Some(name) => Entity::named(&format!("failure {name} of {}", scenario.machines[machine].name)),
                None => {
                    unnamed += 1;
                    machines[machine].part(unnamed - 1)
                }
            };
        }
    }
    (of_machines, owners)
}

/// Planned maintenance; `machines` are the names of the machines.
pub(super) fn of_maintenance(scenario: &Scenario, machines: &[Entity]) -> Owned {
    let plans = &scenario.maintenance;
    let mut of_machines = grouped(machines.len(), plans.iter().map(|plan| plan.machine));
    let mut owners = vec![Entity::named(""); plans.len()];
    for (machine, own) in of_machines.iter_mut().enumerate() {
        let times = |plan: u32| {
            let Maintenance { every, duration, clock, .. } = &plans[plan as usize];
            [*every, duration.mean(), f64::from(u8::from(*clock == FailureClock::Calendar))]
        };
        own.sort_by(|a, b| in_order(times(*a), times(*b)));
        for (place, &plan) in (0..).zip(own.iter()) {
            owners[plan as usize] = machines[machine].part(UPKEEP + place);
        }
    }
    (of_machines, owners)
}

/// Edges of every tool on every machine, by the names of both.
pub(super) fn of_tools(scenario: &Scenario) -> Vec<Vec<Entity>> {
    let owner =
        |machine: &MachineType, tool: &ToolType| Entity::named(&format!("edges of {} on {}", tool.name, machine.name));
    let tools = |machine| scenario.tools.iter().map(|tool| owner(machine, tool)).collect();
    scenario.machines.iter().map(tools).collect()
}

/// Indices by machine.
fn grouped(machines: usize, of: impl Iterator<Item = usize>) -> Vec<Vec<u32>> {
    let mut of_machines = vec![Vec::new(); machines];
    for (index, machine) in (0..).zip(of) {
        of_machines[machine].push(index);
    }
    of_machines
}

fn by_name_or_times(a: &FailureMode, b: &FailureMode) -> Ordering {
    let times = |mode: &FailureMode| {
        let calendar = f64::from(u8::from(mode.clock == FailureClock::Calendar));
        [mode.time_between.mean(), mode.time_to_repair.mean(), calendar]
    };
    a.name.cmp(&b.name).then_with(|| in_order(times(a), times(b)))
}

fn in_order(a: [f64; 3], b: [f64; 3]) -> Ordering {
    a.iter().zip(&b).map(|(a, b)| a.total_cmp(b)).fold(Ordering::Equal, Ordering::then)
}
