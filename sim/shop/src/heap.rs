//! A heap of waiting jobs whose keys stand: few bytes move.
//!
//! The heap orders sixteen bytes a job: the first key, as a number that compares as whole numbers do, and the place of
//! the job, where all of its keys are. Only where first keys are equal are the others looked at. Each knot has four
//! below it, so that a job sinks through half as many levels as in a binary heap, and the four stand side by side in
//! memory.

use super::queue::{Ranked, Waiting};

/// Knots below a knot.
const BRANCHES: usize = 4;

/// Jobs by keys that stand, the least on top.
#[derive(Clone, Debug, Default)]
pub(super) struct Heap {
    /// First key and place of each job, none before the one above it.
    order: Vec<(u64, u32)>,
    jobs: Vec<Ranked>,
    /// Places without a job.
    free: Vec<u32>,
}

/// A number as bits that compare as whole numbers do, in the order of [`f64::total_cmp`].
pub(super) fn ordered(key: f64) -> u64 {
    let bits = key.to_bits();
    bits ^ (((bits as i64 >> 63) as u64) | 1 << 63)
}

impl Heap {
    /// Number of jobs.
    pub fn len(&self) -> usize {
        self.order.len()
    }

    /// A job comes.
    pub fn push(&mut self, ranked: Ranked) {
        let first = ordered(ranked.keys[0]);
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
        self.order.push((first, place));
        let mut knot = self.order.len() - 1;
        while knot > 0 {
            let above = (knot - 1) / BRANCHES;
            if !self.is_before(knot, above) {
                break;
            }
            self.order.swap(knot, above);
            knot = above;
        }
    }

    /// Takes out the job that goes first.
    pub fn pop(&mut self) -> Option<Waiting> {
        let last = self.order.len().checked_sub(1)?;
        let (_, place) = self.order.swap_remove(0);
        debug_assert_eq!(self.order.len(), last);
        self.sink(0);
        self.free.push(place);
        Some(self.jobs[place as usize].waiting)
    }

    /// Keeps the jobs for which a condition holds.
    pub fn retain(&mut self, keeps: impl Fn(&Waiting) -> bool) {
        let (jobs, free) = (&self.jobs, &mut self.free);
        self.order.retain(|(_, place)| {
            let kept = keeps(&jobs[*place as usize].waiting);
            if !kept {
                free.push(*place);
            }
            kept
        });
        (0..self.order.len().div_ceil(BRANCHES)).rev().for_each(|knot| self.sink(knot));
    }

    /// Whether the job of one knot goes before that of another.
    fn is_before(&self, one: usize, other: usize) -> bool {
        let ((a, own), (b, its)) = (self.order[one], self.order[other]);
        a < b || a == b && self.jobs[own as usize] < self.jobs[its as usize]
    }

    fn sink(&mut self, mut knot: usize) {
        loop {
            let first = BRANCHES * knot + 1;
            let below = first..(first + BRANCHES).min(self.order.len());
            let Some(least) = below.reduce(|one, other| if self.is_before(other, one) { other } else { one }) else {
                return;
            };
            if !self.is_before(least, knot) {
                return;
            }
            self.order.swap(least, knot);
            knot = least;
        }
    }
}
