//! Jobs that interrupt others: a waiting job of strictly better priority takes the machine of the worst one
//! in work.
//!
//! Only plain work is interrupted, of machines that take one job at a time and are not kept for an order.
//! What the interrupted job has of its setup is lost, and so is its loading; the part leaves the machine and
//! waits in the queue with its old time of arrival.

use super::queue_change::QueueChange;
use super::recorder::Recorder;
use super::task::{Content, Step};
use super::{Shop, ShopError};
use crate::runlog::{JobOutcome, LogEvent};
use toolroom_scenario::Preemption;

impl<R: Recorder> Shop<'_, R> {
    /// A machine has come back with its job: others that wait for it may be more urgent.
    pub(super) fn challenge(&mut self, machine: usize) {
        if self.scenario.preemption == Preemption::None {
            return;
        }
        let places = self.world.jobs.places();
        let waits = |slot: &u32| {
            let job = self.world.jobs.get(*slot);
            job.is_some_and(|job| job.waiting) && self.next_machines(*slot).contains(&machine)
        };
        let waiting: Vec<u32> = (0..places).filter(waits).collect();
        self.world.challengers.extend(waiting);
    }

    /// Waiting jobs interrupt those that are less urgent, until none can.
    pub(super) fn let_urgent_interrupt(&mut self) -> Result<(), ShopError> {
        while !self.world.challengers.is_empty() {
            let mut slots = std::mem::take(&mut self.world.challengers);
            slots.retain(|slot| self.world.jobs.get(*slot).is_some_and(|job| job.waiting));
            slots.sort_by_key(|slot| {
                let job = self.world.jobs.at(*slot);
                (job.priority, job.queued, job.number)
            });
            slots.dedup();
            for slot in slots {
                if !self.world.jobs.get(slot).is_some_and(|job| job.waiting) || !self.is_supplied(slot) {
                    continue;
                }
                let Some(machine) = self
                    .worst_for(slot)
                    .filter(|machine| self.may_take_over(*machine, slot) && self.fits(*machine, slot))
                else {
                    continue;
                };
                self.displace(machine)?;
                self.stop_waiting(slot, None);
                self.keep(machine, slot);
                self.weigh(slot, QueueChange::Leaves);
                self.supply(slot)?;
                self.clamp(slot);
                self.begin(machine, slot, Vec::new())?;
            }
            self.dispatch()?;
        }
        Ok(())
    }

    /// The machine that a waiting job may take from the least urgent job in work: of several the one that has
    /// begun last.
    fn worst_for(&self, slot: u32) -> Option<usize> {
        let priority = self.world.jobs.at(slot).priority;
        let candidates = self.next_machines(slot).iter().filter_map(|&machine| {
            let state = &self.world.machines[machine];
            let task = state.task.as_ref()?;
            let running = self.world.jobs.at(task.slot);
            let operation = &self.scenario.parts[running.row.part as usize].operations[running.operation as usize];
            let stoppable = matches!(task.step, Step::Setup | Step::Load | Step::Work)
                && matches!(task.content, Content::Plain(_))
                && operation.preemptible;
            let own_machine = state.is_up() && !state.leaving && state.kept_for.is_none() && task.riders.is_empty();
            let batch = self.scenario.machines[machine].batch.is_some();
            let allowed = stoppable && own_machine && !batch && running.priority > priority;
            allowed.then_some((running.priority, task.begun, machine))
        });
        candidates.max_by(|a, b| a.0.cmp(&b.0).then(a.1.cmp(&b.1)).then(b.2.cmp(&a.2))).map(|(_, _, machine)| machine)
    }

    /// Takes the job out of a machine.
    fn displace(&mut self, machine: usize) -> Result<(), ShopError> {
        self.stop_clocks(machine);
        self.halt(machine)?;
        self.release_operator(machine);
        let Some(task) = self.world.machines[machine].task.take() else { return Ok(()) };
        let (slot, now) = (task.slot, self.now());
        let job = self.world.jobs.at_mut(slot);
        job.row.in_process += now - task.begun;
        let number = job.number;
        self.log_event(LogEvent::Preempt, Some(machine), Some(number), None);
        let in_machine = !matches!(task.step, Step::Setup);
        let Content::Plain(whole) = task.content else { return Ok(()) };
        match self.scenario.preemption {
            Preemption::Scrap if in_machine => self.lose(machine, &task, slot, JobOutcome::Preempted),
            Preemption::None | Preemption::Resume | Preemption::Repeat | Preemption::Scrap => {
                let left = if matches!(task.step, Step::Work) { task.left } else { whole };
                let keeps = self.scenario.preemption == Preemption::Resume || !in_machine;
                self.world.jobs.at_mut(slot).rest = keeps.then_some(left);
                self.unclamp(slot, self.world.jobs.at(slot).operation as usize, false);
                self.wait(slot);
                Ok(())
            }
        }
    }
}
