//! Key figures of one replication, counted while it runs, or from its log alone.
//!
//! Words and time elements follow ISO 22400-2. Statistics cover the window from the end of the
//! warm-up to the horizon; what straddles one of its ends counts with its share inside.
//!
//! | time element | here | states |
//! |---|---|---|
//! | planned busy time PBT | working time of the calendar without planned maintenance, and overtime that was worked; paid | all in shift but maintenance |
//! | actual production time APT | a part is cut, worked on or handled | cutting, working, handling |
//! | actual unit setup time AUST | change of the setup group | setup |
//! | actual unit delay time ADET | tool change, dressing, starved within an order, blocked, waiting for an operator, a fixture or an edge, broken down | tool_change, dressing, starved, blocked, waiting_operator, waiting_fixture, waiting_tool, down |
//! | ADOT | available, no order | idle |
//! | actual unit busy time AUBT | APT + AUST + ADET | |
//! | planned run time per item PRI | programmed cutting time or mean time of plain work, + mean load + mean unload | – |
//!
//! PBT = AUBT + ADOT. It follows from the calendar alone, whatever the machine does: a repair that
//! goes on after the shift is no planned time, is not paid and counts in no figure but the mean time
//! to repair.
//!
//! availability = APT/PBT, effectiveness = earned time/APT, quality ratio = GQ/PQ, OEE =
//! availability · effectiveness · quality ratio. An operation earns PRI times the share of its own
//! production time that lies in the window, so that one over the end of the window counts for its
//! part; of one in process at the horizon the time still to come is that of its program. PQ and GQ,
//! the produced and the good quantity of operations, count those completed in the window. Work that
//! an interruption undid takes time and earns nothing. PRI is
//! that of the *programmed* speeds under every policy, so a faster policy has an effectiveness
//! above 1 and the OEE of policies can be compared.
//!
//! # Edges are counted as they wear
//! An edge that left the machine counts 1, spread over its cutting time; one that is still in the
//! machine at the end counts cutting time over the mean life of the finished edges of its tool, at
//! most 1 (and 1 if none finished). Counting only finished edges would flatter the policy with the
//! longer tool life, counting only new ones the other. Dressings are counted alike, on their own.
//!
//! # What is not modelled
//! The cost of the material of good parts and energy prices: they are the same under every policy. People are paid for the
//! time of their calendars where they have a rate, overtime that they work left out.

#![deny(clippy::wildcard_enum_match_arm)]

mod counting;
mod definition;
mod delivery;
mod delivery_figures;
mod group_figures;
mod groups;
mod histogram;
mod machine;
mod machine_tally;
mod reference;
mod runs;
mod shop;
mod tally;

pub use counting::Counting;
pub use definition::{Better, CURRENCY, Definition, Kpi};
pub use group_figures::{GroupKind, group_values_len};
pub use reference::reference;
pub use runs::{Progress, unless_stopped};

use delivery_figures::DELIVERIES;
use machine::{MACHINE, of_machine};
use shop::SHOP;
use toolroom_scenario::{Scenario, ToolType};
use toolroom_shop::runlog::RunLog;

/// Figures of the shop, in the order of reports.
fn of_shop() -> impl Iterator<Item = &'static definition::ShopFigure> {
    SHOP.iter().chain(DELIVERIES)
}

/// Every figure that there is, and whether it is one of a machine: those of the shop first.
pub fn definitions() -> impl Iterator<Item = (&'static Definition, bool)> {
    let shop = of_shop().map(|(definition, _)| (definition, false));
    shop.chain(MACHINE.iter().map(|(definition, _)| (definition, true)))
}

/// All figures of a scenario: those of the shop, then those of each machine.
pub fn kpis(scenario: &Scenario) -> Vec<Kpi> {
    let shop = of_shop().map(|&(definition, _)| Kpi { definition, machine: None });
    let machines = (0..scenario.machines.len()).flat_map(|machine| {
        of_machine(scenario).map(move |(definition, _)| Kpi { definition: *definition, machine: Some(machine) })
    });
    shop.chain(machines).collect()
}

/// Values of [`kpis`] in their order, SI; NaN where a figure is not defined (per part without
/// parts).
///
/// # Examples
/// ```
/// let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/demo.toml");
/// let scenario = toolroom_scenario_file::read(file.as_ref(), &[]).unwrap().scenario;
/// let log = toolroom_shop::run(&scenario, 0, 0).unwrap();
/// assert_eq!(toolroom_kpi::evaluate(&scenario, &log).len(), toolroom_kpi::kpis(&scenario).len());
/// ```
pub fn evaluate(scenario: &Scenario, log: &RunLog) -> Vec<f64> {
    Counting::from_scenario(scenario, log).values()
}

/// The machines whose speed the policy sets, by their tools (the lathes); all machines in a shop
/// without one.
pub fn cell(scenario: &Scenario) -> Vec<usize> {
    let operations = || scenario.parts.iter().flat_map(|part| &part.operations);
    let set = |machine: &usize| {
        operations().any(|operation| {
            let takes_commands = |tool: &ToolType| tool.process.takes_speed_commands();
            let tool = operation.tool.and_then(|tool| scenario.tools.get(tool));
            operation.machines.contains(machine) && tool.is_some_and(takes_commands)
        })
    };
    let cell: Vec<usize> = (0..scenario.machines.len()).filter(set).collect();
    if cell.is_empty() { (0..scenario.machines.len()).collect() } else { cell }
}

#[cfg(test)]
#[path = "../../study/src/fixture.rs"]
mod fixture;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod worked;
