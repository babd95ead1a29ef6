//! Jobs that wait at a machine.

use std::collections::VecDeque;
use toolroom_kernel::SimTime;

/// A place in a queue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Waiting {
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

/// Jobs in the order of (arrival at the queue, job number).
#[derive(Clone, Debug, Default)]
pub struct Queue(VecDeque<Waiting>);

impl Queue {
    /// Puts a job in its place.
    pub fn join(&mut self, waiting: Waiting) {
        let after = |other: &Waiting| (other.since, other.number) > (waiting.since, waiting.number);
        let behind = self.0.iter().rev().take_while(|other| after(other)).count();
        if behind == 0 {
            self.0.push_back(waiting);
        } else {
            self.0.insert(self.0.len() - behind, waiting);
        }
    }

    /// Takes out the first of the waiting jobs with the least `key`; `None` for the key means
    /// that the job is gone.
    pub fn take_least(&mut self, key: impl Fn(&Waiting) -> Option<f64>) -> Option<Waiting> {
        let mut best: Option<(usize, f64)> = None;
        let mut gone = false;
        for (i, waiting) in self.0.iter().enumerate() {
            match key(waiting) {
                None => gone = true,
                Some(value) if best.is_none_or(|(_, least)| value < least) => best = Some((i, value)),
                Some(_) => {}
            }
        }
        let taken = best.and_then(|(i, _)| self.0.remove(i));
        if gone {
            self.0.retain(|waiting| key(waiting).is_some());
        }
        taken
    }

    /// Takes out the first of the waiting jobs; `here` tells whether it is still to be had.
    pub fn take_first(&mut self, here: impl Fn(&Waiting) -> bool) -> Option<Waiting> {
        while let Some(waiting) = self.0.pop_front() {
            if here(&waiting) {
                return Some(waiting);
            }
        }
        None
    }

    /// Number of places, those of jobs that are gone included.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether nobody ever came or everybody is known to be gone.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn waiting(since: f64, number: u32) -> Waiting {
        Waiting { since: SimTime::from_seconds(since).unwrap(), number, slot: number, operation: 0 }
    }

    #[test]
    fn a_queue_is_ordered_by_arrival_then_job() {
        let mut queue = Queue::default();
        for (since, number) in [(1.0, 5), (2.0, 3), (2.0, 1), (2.0, 2)] {
            queue.join(waiting(since, number));
        }
        let order: Vec<u32> = std::iter::from_fn(|| queue.take_first(|_| true)).map(|w| w.number).collect();
        assert_eq!(order, [5, 1, 2, 3]);
    }

    #[test]
    fn the_least_key_wins_and_ties_go_to_the_first() {
        let mut queue = Queue::default();
        for number in 0..6 {
            queue.join(waiting(f64::from(number), number));
        }
        let key = |w: &Waiting| (w.number != 1).then(|| f64::from(w.number % 3));
        assert_eq!(queue.take_least(key).map(|w| w.number), Some(0));
        assert_eq!(queue.len(), 4);
        assert_eq!(queue.take_least(key).map(|w| w.number), Some(3));
        assert_eq!(queue.take_least(key).map(|w| w.number), Some(4));
    }
}
