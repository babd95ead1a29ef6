//! A job on its way through the shop.

use super::flow::Place;
use super::pieces::PieceTimes;
use crate::runlog::JobRow;
use std::hint::black_box;
use toolroom_kernel::{Entity, SimTime, Stream};

/// Where a job came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// A source, by index.
    Source(u32),
    /// An order, by index.
    Order(u32),
    /// Edges of a crib, by index, that are ground anew.
    Crib(u32),
    /// A stock, by index: what it had at the start, and what was ordered for it.
    Stock(u32),
}

/// A workpiece, or several of an order that move together.
///
/// What every operation looks at stands in front, in two lines of the processor's memory.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Job {
    /// What the log will say.
    pub row: JobRow,
    /// When it came to the queue.
    pub queued: SimTime,
    /// What is left of the plain work at which it was interrupted, s; `None`: all of it.
    pub rest: Option<f64>,
    /// The machine whose queue it has joined, where that is settled when it comes.
    pub assigned: Option<usize>,
    /// Number in the order of arrival; row of the log.
    pub number: u32,
    /// Operation that it waits for or is in.
    pub operation: u32,
    /// Whether it stands in a queue.
    pub waiting: bool,
    /// Whether it waits for a card.
    pub parked: bool,
    /// Whether it has taken the components of its part.
    pub supplied: bool,
    /// Whether it only has the place of a job for which a machine is set up.
    pub stand_in: bool,
    /// With whom it has its cards; 0 where there are none.
    pub ticket: u32,
    /// Where it came from.
    pub origin: Origin,
    /// Who draws for it: source and its number there, the same under every policy.
    pub entity: Entity,
    /// Its order of the operations of its part; `None`: that of the part.
    pub route: Option<Box<[u16]>>,
    /// The buffer in which it has its place, by index.
    pub buffer: Option<usize>,
    /// Its place before the next operation, with blocking before service.
    pub reserved: Option<Place>,
    /// Its times of loading and unloading, where any machine's are random. Kept apart: the few hundred bytes of a stream
    /// would be moved with every job that comes and goes.
    pub handling: Option<Box<Stream>>,
    /// Who draws for its hardness lot: the source, or the order.
    pub lot_owner: Entity,
    /// Hardness lot within the source.
    pub lot: u64,
    /// Number of its first piece within its order or source, from 0.
    pub first_piece: u64,
    /// Times of its pieces where they differ.
    pub(super) piece_times: Option<Box<PieceTimes>>,
    /// Weight in weighted rules, 1.
    pub weight: f64,
    /// The smaller, the more urgent.
    pub priority: u32,
    /// How often an inspection has sent it back.
    pub visits: u32,
    /// Jobs that were divided from it.
    pub divisions: u32,
}

impl Job {
    /// A job that comes into the shop: before the first operation of its part, with nothing done and nowhere yet.
    pub(super) fn new(number: u32, (entity, origin): (Entity, Origin), row: JobRow, now: SimTime) -> Self {
        Self {
            number,
            entity,
            origin,
            priority: 0,
            weight: 1.0,
            row,
            operation: 0,
            route: None,
            assigned: None,
            ticket: 0,
            parked: false,
            waiting: false,
            queued: now,
            buffer: None,
            reserved: None,
            lot_owner: entity,
            lot: 0,
            first_piece: 0,
            piece_times: None,
            visits: 0,
            divisions: 0,
            rest: None,
            supplied: false,
            stand_in: false,
            handling: None,
        }
    }

    /// Place of its operation in its routing.
    fn place(&self) -> usize {
        let own = |route: &[u16]| route.iter().position(|each| u32::from(*each) == self.operation);
        self.route.as_deref().map_or(Some(self.operation as usize), own).unwrap_or(usize::MAX)
    }

    /// Operation at a place of its routing; beyond the last one it is their number.
    fn operation_at(&self, place: usize, count: usize) -> usize {
        match &self.route {
            None => place.min(count),
            Some(route) => route.get(place).map_or(count, |own| usize::from(*own)),
        }
    }

    /// The operation after that for which it waits or in which it is; of the last one the number of operations.
    #[inline]
    pub(super) fn next_operation(&self, count: usize) -> usize {
        match &self.route {
            None => self.operation as usize + 1,
            Some(_) => self.operation_at(self.place().saturating_add(1), count),
        }
    }

    /// Places in its routing, from 0, and operations of those that are not done.
    pub(super) fn places_left(&self, count: usize) -> impl ExactSizeIterator<Item = (usize, usize)> + '_ {
        (self.place().min(count)..count).map(move |place| (place, self.operation_at(place, count)))
    }

    /// Operations that are not done.
    pub(super) fn operations_left(&self, count: usize) -> impl Iterator<Item = usize> + '_ {
        self.places_left(count).map(|(_, operation)| operation)
    }

    /// Operations up to and with one of them.
    pub(super) fn operations_until(&self, operation: usize) -> impl Iterator<Item = usize> + '_ {
        let last = match &self.route {
            None => operation,
            Some(route) => route.iter().position(|own| usize::from(*own) == operation).unwrap_or(0),
        };
        (0..=last).map(move |place| self.operation_at(place, usize::MAX))
    }
}

/// A place of a job, at the beginning of a line of the processor's memory.
#[derive(Clone, Debug)]
#[repr(align(64))]
struct Slot(Option<Job>);

/// Jobs in the shop; a place is used again when its job has left.
#[derive(Clone, Debug, Default)]
pub struct Jobs {
    slots: Vec<Slot>,
    /// Times of plain work of the jobs at every place, s, `stride` each.
    drawn: Vec<f64>,
    /// Ranks from which these were drawn, 0 to below 1, as long as machines with times of their own may ask for them.
    ranks: Vec<f64>,
    /// Most operations of any part with plain work.
    stride: usize,
    free: Vec<u32>,
    /// Jobs released so far.
    pub released: u32,
}

impl Jobs {
    /// A shop without jobs, in which those with plain work have at most `operations`.
    pub(super) fn with_plain_work(operations: usize) -> Self {
        Self { stride: operations, ..Self::default() }
    }

    /// Lets a job in.
    #[inline]
    pub fn insert(&mut self, job: Job) -> u32 {
        self.released += 1;
        self.place(job)
    }

    /// Gives a place to a job that is none of its own, with the times of plain work of the one at `of`.
    pub(super) fn insert_beside(&mut self, job: Job, of: u32) -> u32 {
        let slot = self.place(job);
        let from = of as usize * self.stride;
        self.drawn.copy_within(from..from + self.stride, slot as usize * self.stride);
        self.copy_ranks(of, slot);
        slot
    }

    /// The place of the first job of a kind.
    pub(super) fn find(&self, of_kind: impl Fn(&Job) -> bool) -> Option<u32> {
        self.slots.iter().position(|slot| slot.0.as_ref().is_some_and(&of_kind)).map(|slot| slot as u32)
    }

    fn place(&mut self, job: Job) -> u32 {
        match self.free.pop() {
            Some(slot) => {
                self.slots[slot as usize].0 = Some(job);
                slot
            }
            None => {
                self.slots.push(Slot(Some(job)));
                self.drawn.resize(self.slots.len() * self.stride, 0.0);
                (self.slots.len() - 1) as u32
            }
        }
    }

    /// Time of the plain work of an operation of a job, s. It is drawn when the job enters the shop, so
    /// that it is the same whatever machine does the work and whenever.
    #[inline]
    pub fn drawn(&self, slot: u32, operation: usize) -> f64 {
        self.drawn[slot as usize * self.stride + operation]
    }

    /// The same to draw it.
    #[inline]
    pub(super) fn drawn_mut(&mut self, slot: u32, operation: usize) -> &mut f64 {
        &mut self.drawn[slot as usize * self.stride + operation]
    }

    /// Times of plain work of a job by operation, s, to draw them.
    #[inline]
    pub(super) fn drawn_of(&mut self, slot: u32) -> &mut [f64] {
        let first = slot as usize * self.stride;
        &mut self.drawn[first..first + self.stride]
    }

    /// The rank from which the plain work of an operation of a job was drawn; 0 where nothing was.
    pub(super) fn rank(&self, slot: u32, operation: usize) -> f64 {
        self.ranks.get(slot as usize * self.stride + operation).copied().unwrap_or(0.0)
    }

    /// Keeps the rank from which the plain work of an operation of a job was drawn.
    pub(super) fn set_rank(&mut self, slot: u32, operation: usize, rank: f64) {
        self.ranks.resize(self.ranks.len().max(self.drawn.len()), 0.0);
        self.ranks[slot as usize * self.stride + operation] = rank;
    }

    /// A job has the ranks of another one.
    pub(super) fn copy_ranks(&mut self, from: u32, to: u32) {
        if !self.ranks.is_empty() {
            (0..self.stride).for_each(|operation| self.set_rank(to, operation, self.rank(from, operation)));
        }
    }

    /// Lets a job out.
    #[inline]
    pub fn remove(&mut self, slot: u32) {
        if let Some(Slot(job @ Some(_))) = self.slots.get_mut(slot as usize) {
            *job = None;
            self.free.push(slot);
        }
    }

    /// The job at a place, if there is one.
    #[inline]
    pub fn get(&self, slot: u32) -> Option<&Job> {
        self.slots.get(slot as usize)?.0.as_ref()
    }

    /// The job at a place that is known to be taken.
    #[inline]
    pub(super) fn at(&self, slot: u32) -> &Job {
        self.slots[slot as usize].0.as_ref().expect("a job in work is in the shop")
    }

    /// The same to change it.
    #[inline]
    pub(super) fn at_mut(&mut self, slot: u32) -> &mut Job {
        self.slots[slot as usize].0.as_mut().expect("a job in work is in the shop")
    }

    /// Reads what the next operation of a job looks at, so that memory has it at hand when that begins.
    #[inline]
    pub(super) fn call(&self, slot: u32) {
        if let Some(job) = self.get(slot) {
            black_box((job.row.part, job.operation, self.drawn.get(slot as usize * self.stride).copied()));
        }
    }

    /// Number of places, free ones included.
    pub(super) fn places(&self) -> u32 {
        self.slots.len() as u32
    }

    /// Jobs in the shop, by place.
    pub fn iter(&self) -> impl Iterator<Item = &Job> {
        self.slots.iter().filter_map(|slot| slot.0.as_ref())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_job_has_what_every_operation_looks_at_in_front() {
        assert_eq!((size_of::<JobRow>(), size_of::<Slot>()), (72, 256));
        assert!(std::mem::offset_of!(Job, ticket) < 128);
    }
}
