//! Machines that do plain work, one job after the other, with nothing else to look at.
//!
//! Most of what a shop may have is asked for once in the life of an operation: places, cards, fixtures, people, components,
//! orders that move together. In a shop without them, the steps of a machine whose operations are its own and are not
//! inspected come down to a few. They are taken here, to the same effect as one by one: the same events at the same times and
//! the same rows in the log.

use super::Shop;
use super::ShopError;
use super::event::Event;
use super::operation_plan::ContentPlan;
use super::readiness::Readiness;
use super::recorder::Recorder;
use super::task::{Content, Step, Task};
use crate::runlog::{JobOutcome, LogEvent, MachineState, OperationResult, OperationRow};

impl<R: Recorder> Shop<'_, R> {
    /// The step of such a machine ends by its event; false where it is a setup or work without duration.
    pub(super) fn end_quick(&mut self, machine: usize) -> Result<bool, ShopError> {
        let now = self.calendar.now().seconds();
        let state = &self.world.machines[machine];
        let Some(task) = state.task.as_ref().filter(|task| matches!(task.step, Step::Work)) else { return Ok(false) };
        let slot = task.slot;
        let row = self.row(machine, task, slot, self.world.jobs.at(slot).row.quantity);
        let job = self.world.jobs.at_mut(slot);
        job.operation = job.next_operation(self.layout.operations[row.part as usize].len()) as u32;
        job.row.in_process += now - row.start;
        let next = job.operation;
        self.log_state(machine);
        self.recorder.operation(OperationRow { end: now, result: OperationResult::Good, next, ..row });
        let state = &mut self.world.machines[machine];
        state.task = None;
        (state.state, state.state_job) = (MachineState::Idle, None);
        self.may_choose(machine);
        if next as usize >= self.layout.operations[row.part as usize].len() {
            self.leave(slot, JobOutcome::Good)?;
        } else {
            self.enqueue(slot, Some(machine))?;
        }
        Ok(true)
    }

    /// Begins plain work that is one step, to the same effect as step by step; false where it is not.
    pub(super) fn begin_one_step(&mut self, machine: usize, slot: u32) -> Result<bool, ShopError> {
        let (now, job) = (self.now(), self.world.jobs.at(slot));
        let plan = &self.layout.operations[job.row.part as usize][job.operation as usize];
        if !matches!(plan.content, ContentPlan::Plain) || plan.stretched {
            return Ok(false);
        }
        let (group, number) = (plan.setup_group, job.number);
        let setup = self.setup_for(machine, job.row.part as usize, job.operation as usize);
        // A setup that takes no time is but a line in the log.
        let takes_none = !plan.random_setup && self.world.machines[machine].kept_for.is_none();
        if setup.is_some_and(|time| time != 0.0 || !takes_none) {
            return Ok(false);
        }
        let (times, drawn) = self.plain_work(machine, slot);
        let time = job.rest.unwrap_or(times * drawn.max(0.0));
        if time <= 0.0 {
            return Ok(false);
        }
        if setup.is_some() {
            self.log_event(LogEvent::Setup, Some(machine), Some(number), None);
        }
        let taken = time / self.pace_at(machine, now);
        let end = self.schedule(now.after(taken)?, Event::StepEnd { machine: machine as u32 })?;
        let job = self.world.jobs.at_mut(slot);
        job.rest = None;
        if job.row.start.is_nan() {
            job.row.start = now.seconds();
        }
        let state = &mut self.world.machines[machine];
        state.ready = Readiness::Group(group);
        state.task = Some(Task {
            slot,
            begun: now,
            step: Step::Work,
            left: time,
            since: now,
            end: Some(end),
            operator: None,
            presence: 0.0,
            waits: false,
            load_time: 0.0,
            unload_time: 0.0,
            content: Content::Plain(time),
            before: 0.0,
            riders: Vec::new(),
            tending: None,
        });
        self.log_state(machine);
        let logged = &mut self.world.machines[machine];
        (logged.state, logged.state_in_shift, logged.state_job) = (MachineState::Working, true, Some(number));
        if setup.is_some() {
            self.look_ahead(slot);
        }
        Ok(true)
    }

    /// A job comes to such a machine.
    pub(super) fn wait_quick(&mut self, slot: u32, machine: usize) {
        let now = self.now();
        let job = self.world.jobs.at_mut(slot);
        (job.queued, job.waiting) = (now, true);
        self.join(machine, slot);
        self.may_choose(machine);
    }

    /// Such a machine takes the first job by its rules.
    pub(super) fn take_quick(&mut self, machine: usize) -> Result<(), ShopError> {
        while self.world.machines[machine].is_free() {
            let Some(waiting) = self.choose(machine) else { break };
            self.world.jobs.at_mut(waiting.slot).waiting = false;
            if !self.begin_one_step(machine, waiting.slot)? {
                self.begin(machine, waiting.slot, Vec::new())?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
#[path = "../tests/unit/quick.rs"]
mod tests;
