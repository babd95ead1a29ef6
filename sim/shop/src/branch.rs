//! A shop that is changed while it runs.
//!
//! Until the change everything goes by the old rules and urgencies; what comes or goes by dates (machines, people,
//! shifts, orders) is in the calendars and in the table of orders. In the instant of the change all events of that instant
//! are settled first. Then waiting jobs are put in the order of the new rules, in new queues.

use super::job::Origin;
use super::look::queue_kind;
use super::recorder::Recorder;
use super::{Shop, ShopError};
use toolroom_kernel::SimTime;
use toolroom_queues::{Queue, QueueKind};
use toolroom_scenario::{Branch, DispatchRule, MachineChoice, Scenario, Urgency};

/// The queue of a machine under its rules.
pub(super) fn queue_of(scenario: &Scenario, machine: usize, rules: &[DispatchRule]) -> Queue {
    Queue::from_queue_kind(if scenario.machines[machine].batch.is_some() {
        QueueKind::Scan
    } else {
        queue_kind(rules, &scenario.control.keys)
    })
}

impl<'a, R: Recorder> Shop<'a, R> {
    /// How the shop is ruled now where that differs from its scenario: before it is changed.
    fn before(&self) -> Option<&'a Branch> {
        self.scenario.branch.as_ref().filter(|_| !self.world.branched)
    }

    /// Rules of the queue of a machine.
    pub(super) fn rules(&self, machine: usize) -> &'a [DispatchRule] {
        rules(self.scenario, self.world.branched, machine)
    }

    /// Which of several idle machines takes a job.
    pub(super) fn machine_choice(&self) -> MachineChoice {
        self.before().map_or(self.scenario.machine_choice, |before| before.machine_choice)
    }

    /// What makes an order go before others.
    pub(super) fn urgency(&self, order: usize) -> Urgency {
        self.before().map_or_else(|| self.scenario.orders[order].urgency(), |before| before.orders[order])
    }

    /// When the shop is changed, where it has not been and that is not after `time`.
    pub(super) fn change_until(&self, time: SimTime) -> Result<Option<SimTime>, ShopError> {
        let change = self.before().map(|before| SimTime::from_seconds(before.at)).transpose()?;
        Ok(change.filter(|change| *change <= time))
    }

    /// The shop is changed.
    pub(super) fn change(&mut self) {
        self.world.branched = true;
        let scenario = self.scenario;
        for slot in 0..self.world.jobs.places() {
            let Some(Origin::Order(order)) = self.world.jobs.get(slot).map(|job| job.origin) else { continue };
            let Urgency { priority, weight, due } = self.urgency(order as usize);
            let job = self.world.jobs.at_mut(slot);
            (job.priority, job.weight, job.row.due) = (priority, weight, due);
        }
        for machine in 0..scenario.machines.len() {
            self.world.machines[machine].queue = queue_of(scenario, machine, self.rules(machine));
        }
        let waits = |slot: &u32| self.world.jobs.get(*slot).is_some_and(|job| job.waiting);
        let waiting: Vec<u32> = (0..self.world.jobs.places()).filter(waits).collect();
        waiting.into_iter().for_each(|slot| self.join_all(slot));
    }
}

/// Rules of the queue of a machine, before or after the shop is changed.
#[inline]
pub(super) fn rules(scenario: &Scenario, branched: bool, machine: usize) -> &[DispatchRule] {
    match &scenario.branch {
        Some(branch) if !branched => &branch.rules[machine],
        Some(_) | None => scenario.rules(machine),
    }
}
