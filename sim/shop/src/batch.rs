//! Machines that work on several jobs at once.
//!
//! Jobs of one family gather before such a machine until there are enough of them, or until the one that
//! came first has waited for long enough. Of several families that are ready the one goes whose best job,
//! by the rules of the queue, is better; it fills the machine in the order of the queue.

use super::event::Event;
use super::queue_change::QueueChange;
use super::recorder::Recorder;
use super::{Shop, ShopError};
use toolroom_kernel::{Entity, EventKey, Purpose, SimTime};
use toolroom_queues::QueueEntry;
use toolroom_scenario::{Batch, BatchFamily, BatchUnit, Work, WorkPer};

/// What a machine that makes batches remembers.
#[derive(Clone, Copy, Debug, Default)]
pub struct BatchState {
    /// Batches begun so far: the number of the next one, by which its time is drawn.
    pub begun: u64,
    /// When it is to be looked whether a job has waited for too long.
    pub(super) due: Option<(SimTime, EventKey)>,
}

/// Jobs of one family that wait, in the order of the queue.
struct Family {
    key: u32,
    members: Vec<QueueEntry>,
    size: u64,
    oldest: SimTime,
}

impl<R: Recorder> Shop<'_, R> {
    /// A machine begins a batch where one is ready; false where none is.
    pub(super) fn begin_batch(&mut self, machine: usize) -> Result<bool, ShopError> {
        let Some(batch) = self.scenario.machines[machine].batch else { return Ok(false) };
        if let Some((_, due)) = self.world.machines[machine].batch.due.take() {
            self.calendar.cancel(due);
        }
        let families = self.families(machine, &batch);
        let now = self.now();
        let mut next: Option<SimTime> = None;
        let mut ready: Option<Family> = None;
        for family in families {
            let time_out = batch.time_out.map(|wait| family.oldest.after(wait)).transpose()?;
            if family.size >= u64::from(batch.min) || time_out.is_some_and(|at| at <= now) {
                ready = Some(family);
                break;
            }
            next = [next, time_out].into_iter().flatten().min();
        }
        let Some(family) = ready else {
            if let Some(due) = next {
                let key = self.schedule(due, Event::BatchDue { machine: machine as u32 })?;
                self.world.machines[machine].batch.due = Some((due, key));
            }
            return Ok(false);
        };
        let mut members: Vec<u32> = Vec::new();
        let mut room = u64::from(batch.max);
        for waiting in family.members {
            let size = self.batch_size(waiting.slot, &batch);
            if size <= room || members.is_empty() {
                room = room.saturating_sub(size);
                members.push(waiting.slot);
            }
        }
        for &slot in &members {
            self.leave_line(slot);
            self.world.jobs.at_mut(slot).waiting = false;
            self.weigh(slot, QueueChange::Leaves);
        }
        let lead = members.remove(0);
        self.begin(machine, lead, members)?;
        self.world.machines[machine].batch.begun += 1;
        Ok(true)
    }

    /// Jobs that wait at a machine by family, the family of the best job first.
    fn families(&mut self, machine: usize, batch: &Batch) -> Vec<Family> {
        let mut families: Vec<Family> = Vec::new();
        for waiting in self.in_order(machine) {
            let job = self.world.jobs.at(waiting.slot);
            let key = match batch.same {
                BatchFamily::SetupGroup => {
                    self.layout.operations[job.row.part as usize][job.operation as usize].setup_group
                }
                // A part has fewer operations than that.
                BatchFamily::Part => job.row.part << 12 | job.operation,
                BatchFamily::Any => 0,
            };
            let size = self.batch_size(waiting.slot, batch);
            match families.iter_mut().find(|family| family.key == key) {
                Some(family) => {
                    family.members.push(waiting);
                    family.size += size;
                    family.oldest = family.oldest.min(waiting.since);
                }
                None => families.push(Family { key, members: vec![waiting], size, oldest: waiting.since }),
            }
        }
        families
    }

    /// Places that a job takes in a batch.
    fn batch_size(&self, slot: u32, batch: &Batch) -> u64 {
        match batch.by {
            BatchUnit::Pieces => u64::from(self.world.jobs.at(slot).row.quantity),
            BatchUnit::Lots => 1,
        }
    }

    /// It is time to look whether a job has waited for too long.
    pub(super) fn batch_due(&mut self, machine: usize) {
        self.world.machines[machine].batch.due = None;
        self.may_choose(machine);
    }

    /// Plain work of a job in a machine beside others, s, as a number of times its operation: pieces, or one.
    #[inline]
    pub(super) fn plain_work(&self, machine: usize, slot: u32) -> (f64, f64) {
        let job = self.world.jobs.at(slot);
        let (part, index) = (job.row.part as usize, job.operation as usize);
        let plan = &self.layout.operations[part][index];
        let pace = if plan.paced { self.scenario.parts[part].operations[index].pace_on(machine) } else { 1.0 };
        let drawn = || self.own_work(machine, slot, index).unwrap_or_else(|| self.world.jobs.drawn(slot, index));
        match plan.work_per {
            WorkPer::Part => (pace * f64::from(job.row.quantity), drawn()),
            WorkPer::Lot => (pace, drawn()),
            WorkPer::Batch => {
                let number = self.world.machines[machine].batch.begun;
                let owner = Entity::named(&format!("batches of {}", self.scenario.machines[machine].name));
                let mut stream = self.streams.at(owner, Purpose::Processing, number);
                let operation = &self.scenario.parts[part].operations[index];
                let Work::Plain(time) = &operation.work else { return (pace, 0.0) };
                (pace, operation.own_time_on(machine).unwrap_or(time).sample(&mut stream))
            }
        }
    }
}
