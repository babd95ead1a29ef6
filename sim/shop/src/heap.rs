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
            if !self.is_before((first, place), self.order[above]) {
                break;
            }
            self.order[knot] = self.order[above];
            knot = above;
        }
        self.order[knot] = (first, place);
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

    /// Whether a job goes before another, each by its first key and its place.
    #[inline]
    fn is_before(&self, (a, own): (u64, u32), (b, its): (u64, u32)) -> bool {
        a < b || a == b && self.jobs[own as usize] < self.jobs[its as usize]
    }

    /// The job of a knot goes down to where it belongs.
    fn sink(&mut self, mut knot: usize) {
        let Some(&sinking) = self.order.get(knot) else { return };
        loop {
            let first = BRANCHES * knot + 1;
            let below = self.order.get(first..(first + BRANCHES).min(self.order.len())).unwrap_or_default();
            let earlier = |one: (usize, (u64, u32)), other: (usize, (u64, u32))| {
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
