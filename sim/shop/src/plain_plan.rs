//! What a shop of plain machines looks up at every event, small and side by side.

use super::layout::Layout;
use super::look::queue_kind;
use toolroom_kernel::Agenda;
use toolroom_queues::QueueKind;
use toolroom_scenario::{DispatchRule, NextQueue, Operation, Scenario, WorkPer};

/// Whether a shop is nothing but machines that do plain work of their own for jobs of sources, first come, first
/// served, by rules whose keys stand or by such that move with clock and queues: what a
/// [`PlainShop`](super::plain_shop::PlainShop) runs.
pub(super) fn is_plain(scenario: &Scenario, layout: &Layout) -> bool {
    let keys = &scenario.control.keys;
    let follows = |machine| {
        let rules = scenario.rules(machine);
        let draws = rules.contains(&DispatchRule::Random);
        let sets_up = |rule: &DispatchRule| matches!(rule, DispatchRule::LeastSetup | DispatchRule::AtcWithSetups);
        match queue_kind(rules, keys) {
            QueueKind::Line | QueueKind::Heap => !draws,
            QueueKind::Kinetic(_) => !draws && !keys.setup && !rules.iter().any(sets_up),
            QueueKind::Scan => false,
        }
    };
    let ahead = !layout.looks_ahead || keys.next_queue == NextQueue::Waiting;
    let usual = |operation: &Operation| {
        operation.setup_spread.is_none() && operation.work_per != WorkPer::Batch && !operation.has_own_times()
    };
    let parts = &scenario.parts;
    layout.machine_plans.iter().enumerate().all(|(machine, plan)| plan.is_alone && follows(machine))
        && ahead
        && scenario.branch.is_none()
        && !layout.samples
        && !layout.components.contains(&true)
        && (0..parts.len()).all(|part| !parts[part].random_routing && !scenario.is_regrind(part))
        && parts.iter().flat_map(|part| &part.operations).all(usual)
        && scenario.machines.len().max(scenario.arrivals.len()) < (Agenda::END / 2) as usize
}

/// An operation.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlainOperation {
    /// The machine that does it.
    pub machine: u32,
    pub setup_group: u32,
    /// Its setup where its machine has no setup matrix, s.
    pub setup_time: f64,
    /// Factor of the machine on its time.
    pub pace: f64,
    /// Whether its time is that of a piece.
    pub per_piece: bool,
}

impl PlainOperation {
    /// Time that it takes for so many pieces when this time was drawn, s.
    #[inline]
    pub fn time(&self, pieces: u32, drawn: f64) -> f64 {
        let times = if self.per_piece { self.pace * f64::from(pieces) } else { self.pace };
        times * drawn.max(0.0)
    }
}

/// Operations of all parts one after the other, and where those of each part begin; a last entry ends them.
pub(super) fn operations(scenario: &Scenario, layout: &Layout) -> (Vec<PlainOperation>, Vec<u32>) {
    let (mut all, mut firsts) = (Vec::new(), vec![0]);
    for (part, plans) in scenario.parts.iter().zip(&layout.operations) {
        for (operation, plan) in part.operations.iter().zip(plans) {
            let machine = operation.machines[0];
            all.push(PlainOperation {
                machine: machine as u32,
                setup_group: plan.setup_group,
                setup_time: plan.setup_time.unwrap_or(layout.machine_plans[machine].setup_time),
                pace: if plan.paced { operation.pace_on(machine) } else { 1.0 },
                per_piece: plan.work_per == WorkPer::Part,
            });
        }
        firsts.push(all.len() as u32);
    }
    (all, firsts)
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_shop_of_plain_machines_runs_by_itself_and_a_line_with_buffers_does_not() {
        for (name, plain) in [("queue", true), ("line", false)] {
            let path = format!("{}/../../scenarios/shop/{name}.toml", env!("CARGO_MANIFEST_DIR"));
            let text = std::fs::read_to_string(path).unwrap();
            let scenario = toolroom_scenario_file::parse(name, &text, &[]).unwrap().scenario;
            assert_eq!(super::is_plain(&scenario, &crate::Shop::new(&scenario, 0, 0).unwrap().layout), plain, "{name}");
        }
    }
}
