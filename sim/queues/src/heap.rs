//! Waiting jobs whose keys stand: few bytes move, and long queues are read in the order of memory.
//!
//! What is ordered are sixteen bytes a job: the first key, as a number that compares as whole numbers do, the place of
//! the job, where all of its keys are, and where the shop keeps it. Only where first keys are equal are the others looked at.
//!
//! New jobs come into a heap in which each knot has four below it, so that a job sinks through half as many levels as in a
//! binary heap, and the four stand side by side in memory. A heap that has become longer than all that is sorted is sorted
//! into it before the next job is taken: every job is sorted in at the cost of those that came with it, and what
//! waits for long is then taken from the end of a list, with its keys beside those of its neighbours. Whoever takes a job
//! also knows which ones come soon.

use super::entry::{QueueEntry, Ranked};
use std::cmp::Ordering;

/// Knots below a knot.
const BRANCHES: usize = 4;

/// Longest heap that is left as it is: its levels are in the nearest memory (assumption: 64 knots are a kilobyte).
const SHORT: usize = 64;

/// Jobs that are told together to come soon: memory answers them together in about the time of one (assumption: a processor
/// waits for some ten lines of its memory at once, and a job has three).
const SOON: usize = 8;

/// What is ordered of a job.
#[derive(Clone, Copy, Debug)]
struct Knot {
    /// Its first key.
    first: u64,
    /// Where its keys are.
    place: u32,
    /// Where the shop keeps it.
    slot: u32,
}

/// Jobs by keys that stand, the least on top.
#[derive(Clone, Debug, Default)]
pub struct Heap {
    /// The newer ones, none before the one above it.
    order: Vec<Knot>,
    /// The others, the least last.
    sorted: Vec<Knot>,
    jobs: Vec<Ranked>,
    /// Places without a job.
    free: Vec<u32>,
}

/// A number as bits that compare as whole numbers do, in the order of [`f64::total_cmp`].
pub fn ordered(key: f64) -> u64 {
    let bits = key.to_bits();
    bits ^ (((bits as i64 >> 63) as u64) | 1 << 63)
}

impl Heap {
    /// Number of jobs.
    pub fn len(&self) -> usize {
        self.order.len() + self.sorted.len()
    }

    /// A job comes.
    pub fn push(&mut self, ranked: Ranked) {
        let first = ordered(ranked.keys[0]);
        let slot = ranked.waiting.slot;
        let place = match self.free.pop() {
            Some(place) => {
                self.jobs[place as usize] = ranked;
                place
            }
            None => {
                self.jobs.push(ranked);
                (self.jobs.len() - 1) as u32
            }
        };
        let own = Knot { first, place, slot };
        self.order.push(own);
        let mut knot = self.order.len() - 1;
        while knot > 0 {
            let above = (knot - 1) / BRANCHES;
            if !self.is_before(own, self.order[above]) {
                break;
            }
            self.order[knot] = self.order[above];
            knot = above;
        }
        self.order[knot] = own;
    }

    /// Takes out the job that goes first.
    pub fn pop(&mut self) -> Option<QueueEntry> {
        if self.order.len() > self.sorted.len().max(SHORT) {
            self.sort();
        }
        let from_sorted = match (self.sorted.last(), self.order.first()) {
            (Some(last), Some(top)) => !self.is_before(*top, *last),
            (last, _) => last.is_some(),
        };
        let place = if from_sorted {
            self.sorted.pop()?.place
        } else {
            if self.order.is_empty() {
                return None;
            }
            let top = self.order.swap_remove(0);
            self.sink(0);
            top.place
        };
        self.free.push(place);
        Some(self.jobs[place as usize].waiting)
    }

    /// Where the shop keeps the next jobs of the list, each of them once while it goes down.
    #[inline]
    pub fn soon(&self) -> impl Iterator<Item = u32> + '_ {
        let count = self.sorted.len();
        let first = if count.is_multiple_of(SOON) { count.saturating_sub(SOON) } else { count };
        self.sorted[first..].iter().map(|knot| knot.slot)
    }

    /// Sorts the heap into the list. The keys then stand in memory as the list does.
    fn sort(&mut self) {
        let mut newer = std::mem::take(&mut self.order);
        newer.sort_unstable_by(|a, b| self.compare(*b, *a));
        let mut older = std::mem::take(&mut self.sorted).into_iter().peekable();
        let mut newer = newer.into_iter().peekable();
        let count = older.len() + newer.len();
        let (mut sorted, mut jobs) = (Vec::with_capacity(count), Vec::with_capacity(count));
        loop {
            // The one that goes later comes first.
            let next = match (older.peek(), newer.peek()) {
                (Some(old), Some(new)) if self.is_before(*old, *new) => newer.next(),
                (Some(_), _) => older.next(),
                (None, _) => newer.next(),
            };
            let Some(knot) = next else { break };
            sorted.push(Knot { place: jobs.len() as u32, ..knot });
            jobs.push(self.jobs[knot.place as usize]);
        }
        (self.sorted, self.jobs) = (sorted, jobs);
        self.free.clear();
    }

    /// Keeps the jobs for which a condition holds.
    pub fn retain(&mut self, keeps: impl Fn(&QueueEntry) -> bool) {
        let (jobs, free) = (&self.jobs, &mut self.free);
        let mut kept = |knot: &Knot| {
            let kept = keeps(&jobs[knot.place as usize].waiting);
            if !kept {
                free.push(knot.place);
            }
            kept
        };
        self.sorted.retain(&mut kept);
        self.order.retain(kept);
        (0..self.order.len().div_ceil(BRANCHES)).rev().for_each(|knot| self.sink(knot));
    }

    /// Whether a job goes before another.
    #[inline]
    fn is_before(&self, own: Knot, other: Knot) -> bool {
        own.first < other.first || own.first == other.first && self.compare(own, other).is_lt()
    }

    fn compare(&self, own: Knot, other: Knot) -> Ordering {
        let all = || self.jobs[own.place as usize].cmp(&self.jobs[other.place as usize]);
        own.first.cmp(&other.first).then_with(all)
    }

    /// The job of a knot goes down to where it belongs.
    fn sink(&mut self, mut knot: usize) {
        let Some(&sinking) = self.order.get(knot) else { return };
        loop {
            let first = BRANCHES * knot + 1;
            let below = self.order.get(first..(first + BRANCHES).min(self.order.len())).unwrap_or_default();
            let earlier = |one: (usize, Knot), other: (usize, Knot)| {
                if self.is_before(other.1, one.1) { other } else { one }
            };
            let Some((place, least)) = below.iter().copied().enumerate().reduce(earlier) else { break };
            if !self.is_before(least, sinking) {
                break;
            }
            self.order[knot] = least;
            knot = first + place;
        }
        self.order[knot] = sinking;
    }
}
