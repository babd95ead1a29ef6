//! Which waiting job a free machine takes.

use super::branch;
use super::job::Jobs;
use super::look::{Look, facts, started_work};
use super::queue_change::QueueChange;
use super::recorder::Recorder;
use super::{Shop, ShopError};
use toolroom_queues::{Keys, Measures, Moment, Queue, QueueEntry, keys};
use toolroom_scenario::{Assignment, Blocking, Preemption};

/// Whether a job still waits for what a place in a queue says.
#[inline]
fn is_here(jobs: &Jobs, waiting: &QueueEntry) -> bool {
    let job = jobs.get(waiting.slot);
    job.is_some_and(|job| {
        let operation = job.waiting && job.number == waiting.number && job.operation == waiting.operation;
        // An inspection may have sent it back to the same operation.
        operation && job.queued == waiting.since
    })
}

impl<R: Recorder> Shop<'_, R> {
    /// Keys of a job in a machine under the machine's rules, at this moment.
    pub(super) fn keys_of(&self, machine: usize, slot: u32) -> Keys {
        let (scenario, jobs) = (self.scenario, &self.world.jobs);
        let rules = self.rules(machine);
        let facts = facts(scenario, &self.layout, &self.streams, (jobs, slot), (machine, rules));
        let options = &scenario.control.keys;
        let mean = Measures { time: facts.time, setup: 0.0 };
        let moment = Moment { now: self.now().seconds(), mean, options, ..Moment::default() };
        keys(rules, jobs.at(slot).queued.seconds(), &facts, &moment)
    }

    /// Puts a machine on the list of those that may choose when the instant is settled.
    pub(super) fn may_choose(&mut self, machine: usize) {
        let state = &mut self.world.machines[machine];
        if !state.listed {
            state.listed = true;
            self.world.candidates.push(machine as u32);
        }
    }

    /// Every idle machine on the list picks a job, in the order of the scenario. Of the idle machines that may
    /// do it the one takes it that the scenario's choice of machines prefers; if that is another, the machine
    /// picks again.
    pub(super) fn dispatch(&mut self) -> Result<(), ShopError> {
        self.offer_again();
        self.maintain()?;
        if self.world.candidates.len() > 1 {
            self.world.candidates.sort_unstable();
        }
        let mut next = 0;
        while let Some(&machine) = self.world.candidates.get(next) {
            next += 1;
            let machine = machine as usize;
            self.world.machines[machine].listed = false;
            if self.layout.machine_plans[machine].is_quick {
                self.take_quick(machine)?;
                continue;
            }
            if self.layout.machine_plans[machine].is_batch {
                while self.world.machines[machine].is_free() && self.begin_batch(machine)? {}
                continue;
            }
            while self.world.machines[machine].is_free() {
                self.serve_first()?;
                let Some(slot) = self.pick(machine)? else { break };
                let taker = self.preferred(machine, slot);
                self.keep(taker, slot);
                self.weigh(slot, QueueChange::Leaves);
                if self.world.flow.is_limited() {
                    self.leave_buffer(slot);
                }
                self.supply(slot)?;
                self.clamp(slot);
                self.look_at_lacking(slot);
                self.begin(taker, slot, Vec::new())?;
                self.serve_first()?;
            }
        }
        self.world.candidates.clear();
        if !self.world.dividing.is_empty() {
            self.divide_lots();
            if !self.world.candidates.is_empty() {
                return self.dispatch(); // jobs that were offered are back in line
            }
        }
        if !self.world.setups_ahead.is_empty() {
            self.set_up_ahead()?;
        }
        Ok(())
    }

    /// The job that a machine takes next: of the order for which it is kept, or by its rules.
    fn pick(&mut self, machine: usize) -> Result<Option<u32>, ShopError> {
        if let Some(kept) = self.world.machines[machine].kept_for {
            return Ok(self.next_kept(machine, kept).or_else(|| self.edges_meanwhile(machine)));
        }
        if self.scenario.control.schedule.is_some() {
            return self.pick_planned(machine);
        }
        let found = if self.layout.machine_plans[machine].takes_first {
            self.choose(machine).map(|waiting| waiting.slot)
        } else {
            let reserves = self.world.flow.is_limited() && self.scenario.blocking == Blocking::BeforeService;
            self.first_able(machine, reserves)
        };
        if let Some(slot) = found {
            self.stop_waiting(slot, Some(machine));
        }
        Ok(found)
    }

    /// The next job of the order for which a machine is kept, where it is there and can be begun.
    fn next_kept(&mut self, machine: usize, (order, operation): (u32, u32)) -> Option<u32> {
        if self.has_fixtures() || self.looks_at_shift_end(machine) {
            let next = self.world.peek_of_lot(order, operation, machine);
            let lack = next.and_then(|slot| self.lack_of(machine, slot));
            self.set_lack(machine, lack);
            if lack.is_some() || next.is_some_and(|slot| !self.fits(machine, slot)) {
                return None;
            }
        }
        let next = self.world.next_of_lot(order, operation, machine);
        if next.is_none() {
            self.starves(machine, (order, operation));
        }
        next
    }

    /// A job waits no longer; the queue of `machine` does not have it any more.
    pub(super) fn stop_waiting(&mut self, slot: u32, machine: Option<usize>) {
        self.leave_line(slot);
        let job = self.world.jobs.at_mut(slot);
        job.waiting = false;
        let (part, operation) = (job.row.part as usize, job.operation as usize);
        if machine.is_some() && self.layout.operations[part][operation].only_machine.is_some() {
            return;
        }
        for &other in
            self.scenario.parts[part].operations[operation].machines.iter().filter(|own| Some(**own) != machine)
        {
            self.world.machines[other].queue.leave(slot);
        }
    }

    /// The first job by the rules of a machine whose components and fixtures are there and, where it has to, for which a
    /// place can be reserved; it then is. Where there is none, but other work for want of a place, the machine
    /// is held up.
    fn first_able(&mut self, machine: usize, reserves: bool) -> Option<u32> {
        let (mut found, mut aside, mut without_place, mut lack) = (None, Vec::new(), false, None);
        while let Some(waiting) = self.choose(machine) {
            let supplied = self.is_supplied(waiting.slot);
            let missing =
                if supplied { self.lack_of(self.preferred(machine, waiting.slot), waiting.slot) } else { None };
            let equipped = supplied && missing.is_none() && self.fits(machine, waiting.slot);
            if equipped && (!reserves || self.reserve(waiting.slot)) {
                found = Some(waiting.slot);
                break;
            }
            without_place |= equipped;
            lack = lack.or(missing);
            aside.push(waiting.slot);
        }
        let held_up = found.is_none() && without_place;
        aside.into_iter().for_each(|slot| self.join(machine, slot));
        self.set_lack(machine, lack.filter(|_| found.is_none()));
        if held_up {
            self.world.flow.held_up.push(machine as u32);
            self.world.flow.suspect = true;
        }
        if std::mem::replace(&mut self.world.machines[machine].held_up, held_up) != held_up {
            self.show_state(machine);
        }
        found
    }

    /// Of the idle machines that may do a job's operation, the one that takes it; `machine` picked it.
    fn preferred(&self, machine: usize, slot: u32) -> usize {
        let job = self.world.jobs.at(slot);
        let (part, index) = (job.row.part as usize, job.operation as usize);
        let plan = &self.layout.operations[part][index];
        let control = &self.scenario.control;
        let settled = || control.assign == Assignment::AtArrival || control.schedule.is_some();
        if plan.only_machine.is_some() || settled() || self.world.machines[machine].kept_for.is_some() {
            return machine;
        }
        let taker = self.idle_for((part, index), f64::from(job.row.quantity), (job.buffer, job.entity));
        taker.filter(|taker| self.fits(*taker, slot)).unwrap_or(machine)
    }

    /// A job joins the queues of its operation.
    pub(super) fn wait(&mut self, slot: u32) {
        self.weigh(slot, QueueChange::Comes);
        self.queue_up(slot);
    }

    /// A job whose work is counted at its station already joins the queues of its operation.
    pub(super) fn queue_up(&mut self, slot: u32) {
        self.world.jobs.at_mut(slot).waiting = true;
        if self.scenario.preemption != Preemption::None {
            self.world.challengers.push(slot);
        }
        self.join_all(slot);
    }

    /// A job joins the queues of its operation, which may choose.
    pub(super) fn join_all(&mut self, slot: u32) {
        let job = self.world.jobs.at(slot);
        let (part, operation) = (job.row.part as usize, job.operation as usize);
        // A job in a buffer waits for the machines behind it only.
        let (limited, buffer) = (self.world.flow.is_limited(), job.buffer);
        if self.scenario.control.assign == Assignment::AtArrival {
            self.join_one(slot);
            return;
        }
        if let Some(only) = self.layout.operations[part][operation].only_machine
            && !limited
        {
            self.join(only as usize, slot);
            self.may_choose(only as usize);
            return;
        }
        let machines = &self.scenario.parts[part].operations[operation].machines;
        for &machine in machines {
            if !limited || self.input(machine) == buffer {
                self.join(machine, slot);
                self.may_choose(machine);
            }
        }
    }

    /// A job joins the queue of a machine.
    pub(super) fn join(&mut self, machine: usize, slot: u32) {
        let (scenario, layout, streams, jobs) = (self.scenario, &self.layout, &self.streams, &self.world.jobs);
        let job = jobs.at(slot);
        let waiting = QueueEntry { since: job.queued, number: job.number, slot, operation: job.operation };
        let branched = self.world.branched;
        let rules = || branch::rules(scenario, branched, machine);
        self.world.machines[machine].queue.join(
            waiting,
            || facts(scenario, layout, streams, (jobs, slot), (machine, rules())),
            |facts| keys(rules(), waiting.since.seconds(), facts, &Moment::default()),
            |waiting| is_here(jobs, waiting),
        );
    }

    /// Keeps the work that waits at the station of a job's operation, where a rule looks at it.
    pub(super) fn weigh(&mut self, slot: u32, weighing: QueueChange) {
        if !self.layout.looks_ahead {
            return;
        }
        let job = self.world.jobs.at(slot);
        let (part, operation) = (job.row.part as usize, job.operation as usize);
        let time = self.layout.time(&self.world.jobs, slot, part, operation);
        let (count, work) = &mut self.world.waiting_work[self.layout.operations[part][operation].station as usize];
        match weighing {
            QueueChange::Comes => {
                *count += 1;
                *work += time;
            }
            QueueChange::Leaves => {
                *count -= 1;
                // No rounding stays where nobody waits.
                *work = if *count == 0 { 0.0 } else { *work - time };
            }
        }
    }

    pub(super) fn choose(&mut self, machine: usize) -> Option<QueueEntry> {
        let jobs = &self.world.jobs;
        let queue = &mut self.world.machines[machine].queue;
        if let Some(first) = queue.take_standing(|waiting| is_here(jobs, waiting)) {
            queue.soon().for_each(|slot| jobs.call(slot));
            return first;
        }
        let (queue, look) = self.look(machine);
        queue.take(
            look.now,
            |waiting| is_here(look.jobs, waiting),
            |facts| look.measures(facts),
            |waiting, facts, mean| look.keys(waiting, facts, mean),
        )
    }

    /// Jobs that wait at a machine which makes batches, in the order of its rules.
    pub(super) fn in_order(&mut self, machine: usize) -> Vec<QueueEntry> {
        let (queue, look) = self.look(machine);
        queue.in_order(
            |waiting| is_here(look.jobs, waiting),
            |facts| look.measures(facts),
            |waiting, facts, mean| look.keys(waiting, facts, mean),
        )
    }

    /// The queue of a machine, and what its rules look at.
    fn look(&mut self, machine: usize) -> (&mut Queue, Look<'_>) {
        let now = self.now().seconds();
        let (scenario, layout, world) = (self.scenario, &*self.layout, &mut self.world);
        let rules = branch::rules(scenario, world.branched, machine);
        let started = started_work(scenario, layout, (&world.jobs, &world.machines), now);
        let state = &mut world.machines[machine];
        let (ready, jobs, waiting_work) = (state.ready, &world.jobs, world.waiting_work.as_slice());
        let chooser = Some((machine, ready));
        (&mut state.queue, Look { scenario, layout, jobs, waiting_work, started, chooser, rules, now })
    }
}
