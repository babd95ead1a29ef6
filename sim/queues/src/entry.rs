//! A waiting job: its place in a queue, what rules look at, and its keys.

use std::cmp::Ordering;
use toolroom_kernel::SimTime;
use toolroom_scenario::MOST_RULES;

/// A place in a queue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct QueueEntry {
    /// When the job came to this queue.
    pub since: SimTime,
    /// Job number: the tie break.
    pub number: u32,
    /// Where the job is kept.
    pub slot: u32,
    /// Operation that it waits for. A job that may go to several machines stands in all their
    /// queues; the places that it did not take are recognised by this and skipped.
    pub operation: u32,
}

/// Keys under the rules of a queue, the first one deciding; rules that it does not have are 0.
pub type Keys = [f64; MOST_RULES];

/// What the rules look at beside the clock and the queues.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Facts {
    /// When the job entered the shop, s.
    pub release: f64,
    /// The smaller, the more urgent.
    pub priority: f64,
    /// Weight of its order, 1.
    pub weight: f64,
    /// When it is due, s.
    pub due: f64,
    /// When this operation is due: the allowance of the job divided in proportion to work, s.
    pub operation_due: f64,
    /// Time of this operation, s.
    pub time: f64,
    /// Time of this and all later operations, s.
    pub work_left: f64,
    /// Number of this and all later operations.
    pub operations_left: f64,
    /// Time of the next operation, s; 0 if there is none.
    pub next_time: f64,
    /// Station of the next operation.
    pub next_station: Option<u32>,
    /// Setup group of this operation.
    pub setup_group: u32,
    /// Its setup time where the group changes, s.
    pub setup_time: f64,
    /// A random number of the job at this operation, 0 to below 1.
    pub rank: f64,
}

/// A job with its keys: the least goes first, ties by arrival at the queue, then job number.
#[derive(Clone, Copy, Debug)]
pub struct Ranked {
    /// Its keys.
    pub keys: Keys,
    /// Its place.
    pub waiting: QueueEntry,
}

impl Ord for Ranked {
    fn cmp(&self, other: &Self) -> Ordering {
        let keys = self.keys.iter().zip(&other.keys).map(|(a, b)| a.total_cmp(b));
        let arrival = |waiting: &QueueEntry| (waiting.since, waiting.number);
        keys.fold(Ordering::Equal, Ordering::then).then(arrival(&self.waiting).cmp(&arrival(&other.waiting)))
    }
}

impl PartialOrd for Ranked {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Ranked {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Ranked {}
