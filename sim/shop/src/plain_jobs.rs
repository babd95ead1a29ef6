//! Jobs of a shop of plain machines, and the lines in which they wait.

use crate::runlog::JobRow;
use std::collections::VecDeque;
use toolroom_kernel::SimTime;

/// A job on its way: one line of the processor's memory.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct PlainJob {
    /// When it came, s.
    pub arrival: f64,
    /// When its first operation began, s; NaN: not yet.
    pub start: f64,
    /// When it is due, s.
    pub due: f64,
    /// When it came to the queue, s.
    pub queued: f64,
    /// Time of its operations in process, s.
    pub in_process: f64,
    /// Number in the order of arrival; [`NOBODY`] where the place is free.
    pub number: u32,
    pub part: u32,
    pub quantity: u32,
    /// Hardness batch of its source, from 1.
    pub lot: u32,
    pub source: u32,
    /// Operation that it waits for or is in, within its part.
    pub operation: u32,
}

/// Number of a job that is none.
pub(super) const NOBODY: u32 = u32::MAX;

impl PlainJob {
    /// Its row of the log as far as it has come.
    #[inline]
    pub fn row(&self) -> JobRow {
        let row = JobRow::new(self.part, self.quantity, self.arrival, self.due);
        JobRow { lot: self.lot, start: self.start, in_process: self.in_process, ..row }
    }
}

/// Jobs in the shop; a place is used again when its job has left.
#[derive(Clone, Debug, Default)]
pub(super) struct PlainJobs {
    pub all: Vec<PlainJob>,
    /// Times of plain work of the jobs at every place, s, `stride` each.
    pub drawn: Vec<f64>,
    pub stride: usize,
    free: Vec<u32>,
    /// Jobs released so far.
    pub released: u32,
}

impl PlainJobs {
    /// No jobs, which have at most so many operations.
    pub fn with_operations(stride: usize) -> Self {
        Self { stride, ..Self::default() }
    }

    /// Lets a job in: its place.
    #[inline]
    pub fn insert(&mut self, job: PlainJob) -> usize {
        self.released += 1;
        if let Some(slot) = self.free.pop() {
            self.all[slot as usize] = job;
            return slot as usize;
        }
        self.all.push(job);
        self.drawn.resize(self.all.len() * self.stride, 0.0);
        self.all.len() - 1
    }

    /// Lets a job out.
    #[inline]
    pub fn remove(&mut self, slot: usize) {
        self.all[slot].number = NOBODY;
        self.free.push(slot as u32);
    }

    /// Times of plain work of the job at a place, s, by operation.
    #[inline]
    pub fn drawn_of(&mut self, slot: usize) -> &mut [f64] {
        &mut self.drawn[slot * self.stride..(slot + 1) * self.stride]
    }

    /// The same to read them.
    #[inline]
    pub fn drawn_at(&self, slot: usize) -> &[f64] {
        &self.drawn[slot * self.stride..(slot + 1) * self.stride]
    }

    /// Jobs in the shop, by place.
    pub fn iter(&self) -> impl Iterator<Item = &PlainJob> {
        self.all.iter().filter(|job| job.number != NOBODY)
    }
}

/// Jobs that wait at a machine, by arrival there, then number.
#[derive(Clone, Debug, Default)]
pub(super) struct Line {
    /// Where each is kept, and its number.
    jobs: VecDeque<(u32, u32)>,
    /// When the last one came.
    last: SimTime,
    /// How many came then.
    together: usize,
}

impl Line {
    /// A job comes.
    #[inline]
    pub fn join(&mut self, slot: usize, number: u32, now: SimTime) {
        let job = (slot as u32, number);
        if now > self.last {
            (self.last, self.together) = (now, 0);
        }
        // Some of those that came in this instant may have been taken.
        let together = self.together.min(self.jobs.len());
        let behind = self.jobs.iter().rev().take(together).take_while(|(_, other)| *other > number).count();
        if behind == 0 {
            self.jobs.push_back(job);
        } else {
            self.jobs.insert(self.jobs.len() - behind, job);
        }
        self.together = together + 1;
    }

    /// Takes out the first job: its place.
    #[inline]
    pub fn take(&mut self) -> Option<usize> {
        self.jobs.pop_front().map(|(slot, _)| slot as usize)
    }

    pub fn is_empty(&self) -> bool {
        self.jobs.is_empty()
    }
}
