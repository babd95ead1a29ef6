//! Which of several machines does an operation.

use super::Shop;
use super::recorder::Recorder;
use rand::RngExt;
use toolroom_kernel::{Entity, Purpose};
use toolroom_scenario::{MachineChoice, QueueChoice, WorkPer};

/// Owner of the draw of a machine, part of the name of a job; operations are parts of it.
const MACHINE: u64 = 1 << 44;

impl<R: Recorder> Shop<'_, R> {
    /// Of the idle machines that may do an operation on so many pieces and stand behind a buffer, the one that the choice of machines prefers;
    /// `entity` draws where chance chooses.
    pub(super) fn idle_for(
        &self,
        (part, index): (usize, usize),
        pieces: f64,
        (buffer, entity): (Option<usize>, Entity),
    ) -> Option<usize> {
        let operation = &self.scenario.parts[part].operations[index];
        let choice = operation.machine_choice.unwrap_or_else(|| self.machine_choice());
        let setup = |candidate: usize| self.setup_for(candidate, part, index).unwrap_or(0.0);
        let dislike = |candidate: usize| {
            let state = &self.world.machines[candidate];
            match choice {
                MachineChoice::First | MachineChoice::Random => 0.0,
                MachineChoice::LeastSetup => setup(candidate),
                MachineChoice::LongestIdle => state.state_since.seconds(),
                MachineChoice::EarliestFinish => setup(candidate) + self.time_on(candidate, (part, index), pieces),
                MachineChoice::Fastest => self.time_on(candidate, (part, index), pieces),
                MachineChoice::LeastUsed => state.worked,
            }
        };
        // A job in a buffer goes to the machines behind it only.
        let limited = self.world.flow.is_limited();
        let free = |candidate: &usize| {
            let state = &self.world.machines[*candidate];
            let behind = !limited || self.input(*candidate) == buffer;
            state.is_free() && state.kept_for.is_none() && behind
        };
        let others = operation.machines.iter().copied().filter(free);
        if choice == MachineChoice::Random {
            let mut free: Vec<usize> = others.collect();
            free.sort_unstable();
            let owner = entity.part(MACHINE).part(index as u64);
            let rank: f64 = self.streams.open(owner, Purpose::Policy).random();
            return free.get((rank * free.len() as f64) as usize).copied();
        }
        let order = |a: &usize, b: &usize| dislike(*a).total_cmp(&dislike(*b)).then(a.cmp(b));
        others.min_by(order)
    }

    /// Expected time of an operation on so many pieces on a machine, s, without setup: handling, and passes as programmed or the
    /// mean of plain work.
    fn time_on(&self, machine: usize, (part, index): (usize, usize), pieces: f64) -> f64 {
        let operation = &self.scenario.parts[part].operations[index];
        let passes: f64 = self.layout.pass_times[part][index].iter().sum();
        let handling = self.layout.handling[machine].iter().sum::<f64>();
        let together = if operation.work_per == WorkPer::Part { pieces } else { 1.0 };
        pieces * (handling + passes) + together * operation.mean_time_on(machine)
    }

    /// A job joins the queue of one machine of its operation, where that is settled when it comes.
    pub(super) fn join_one(&mut self, slot: u32) {
        let machine = match self.world.jobs.at(slot).assigned {
            Some(machine) => machine, // its queue is made anew
            None => self.shortest_line(slot),
        };
        let time = self.time_in_line(slot, machine);
        if self.world.jobs.at_mut(slot).assigned.replace(machine).is_none() {
            let state = &mut self.world.machines[machine];
            state.line = (state.line.0 + 1, state.line.1 + time);
        }
        self.join(machine, slot);
        self.may_choose(machine);
    }

    /// A job waits no longer in the queue that it joined.
    pub(super) fn leave_line(&mut self, slot: u32) {
        let Some(machine) = self.world.jobs.at_mut(slot).assigned.take() else { return };
        let time = self.time_in_line(slot, machine);
        let (count, work) = &mut self.world.machines[machine].line;
        *count -= 1;
        // No rounding stays where nobody waits.
        *work = if *count == 0 { 0.0 } else { *work - time };
    }

    /// Time of the operation for which a job waits on a machine, s, without setup, as rules know it.
    pub(super) fn time_in_line(&self, slot: u32, machine: usize) -> f64 {
        let job = self.world.jobs.at(slot);
        let (part, index) = (job.row.part as usize, job.operation as usize);
        let operation = &self.scenario.parts[part].operations[index];
        if let Some(own) = operation.own_time_on(machine) {
            let known =
                if self.layout.expected.is_empty() { self.own_work(machine, slot, index) } else { Some(own.mean()) };
            return self.layout.time_with(&self.world.jobs, (slot, part, index), known);
        }
        self.layout.time(&self.world.jobs, slot, part, index) * operation.pace_on(machine)
    }

    /// The machine whose queue a job joins.
    fn shortest_line(&self, slot: u32) -> usize {
        let job = self.world.jobs.at(slot);
        let operation = &self.scenario.parts[job.row.part as usize].operations[job.operation as usize];
        let limited = self.world.flow.is_limited();
        let length = |machine: usize| {
            let state = &self.world.machines[machine];
            match self.scenario.control.queue_choice {
                QueueChoice::ShortestQueue => {
                    f64::from(state.line.0 + u32::from(state.task.is_some() || state.blocked.is_some()))
                }
                QueueChoice::LeastWork => state.line.1 + self.left_in(machine).unwrap_or(0.0),
            }
        };
        let reachable = operation.machines.iter().copied().filter(|own| !limited || self.input(*own) == job.buffer);
        let shortest = reachable.min_by(|a, b| length(*a).total_cmp(&length(*b)).then(a.cmp(b)));
        shortest.expect("a job stands before a machine of its operation")
    }
}
