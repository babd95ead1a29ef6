//! Which waiting job a free machine takes.

use super::layout::Layout;
use super::queue::Waiting;
use super::recorder::Recorder;
use super::{Shop, ShopError};
use crate::job::Job;
use toolroom_scenario::DispatchRule;

impl<R: Recorder> Shop<'_, R> {
    /// Puts a machine on the list of those that may choose when the instant is settled.
    pub(super) fn may_choose(&mut self, machine: usize) {
        let state = &mut self.world.machines[machine];
        if !state.listed {
            state.listed = true;
            self.world.candidates.push(machine as u32);
        }
    }

    /// Every idle machine on the list takes a job, in the order of the scenario.
    pub(super) fn dispatch(&mut self) -> Result<(), ShopError> {
        if self.world.candidates.len() > 1 {
            self.world.candidates.sort_unstable();
        }
        let mut next = 0;
        while let Some(&machine) = self.world.candidates.get(next) {
            next += 1;
            let machine = machine as usize;
            self.world.machines[machine].listed = false;
            if self.world.machines[machine].is_up()
                && self.world.machines[machine].task.is_none()
                && let Some(waiting) = self.choose(machine)
            {
                self.world.jobs.at_mut(waiting.slot).waiting = false;
                self.begin(machine, waiting.slot)?;
            }
        }
        self.world.candidates.clear();
        Ok(())
    }

    fn choose(&mut self, machine: usize) -> Option<Waiting> {
        let now = self.now().seconds();
        let (jobs, layout) = (&self.world.jobs, &self.layout);
        let here = |waiting: &Waiting| {
            jobs.get(waiting.slot)
                .filter(|job| job.waiting && job.number == waiting.number && job.operation == waiting.operation)
        };
        let state = &mut self.world.machines[machine];
        match self.scenario.dispatch {
            DispatchRule::Fifo => state.queue.take_first(|waiting| here(waiting).is_some()),
            rule @ (DispatchRule::ShortestProcessingTime
            | DispatchRule::EarliestDueDate
            | DispatchRule::CriticalRatio
            | DispatchRule::LeastSetup) => {
                let group = state.setup_group;
                state.queue.take_least(|waiting| here(waiting).map(|job| key(rule, job, layout, group, now)))
            }
        }
    }
}

/// Key of a job under a rule: the job with the least key goes first.
fn key(rule: DispatchRule, job: &Job, layout: &Layout, setup_group: Option<u32>, now: f64) -> f64 {
    let operation = &layout.operations[job.row.part as usize][job.operation as usize];
    match rule {
        DispatchRule::Fifo => 0.0,
        DispatchRule::ShortestProcessingTime => operation.nominal_time,
        DispatchRule::EarliestDueDate => job.row.due,
        DispatchRule::CriticalRatio => (job.row.due - now) / operation.work_left.max(f64::MIN_POSITIVE),
        DispatchRule::LeastSetup => {
            let change = setup_group.is_some_and(|group| group != operation.setup_group);
            f64::from(u8::from(change))
        }
    }
}
