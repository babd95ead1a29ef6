//! Jobs that wait at a machine, kept in the way that its rules ask for.

use super::entry::{Facts, Keys, QueueEntry, Ranked};
use super::heap::Heap;
use super::keys::Measures;
use super::kinetic::{Kinetic, Plan};
use std::collections::VecDeque;

/// Jobs that wait at a machine. A job that another machine took stays in its place until it is met.
#[derive(Clone, Debug)]
pub struct Queue(Order);

/// How they are kept.
#[derive(Clone, Debug)]
enum Order {
    /// First come, first served: by arrival at the queue, then job number.
    Line {
        jobs: VecDeque<QueueEntry>,
        /// Length at which places of jobs that are gone are looked for.
        full: usize,
    },
    /// By keys that stand while a job waits: a decision costs the logarithm of the length.
    Heap {
        jobs: Heap,
        /// Length at which places of jobs that are gone are looked for.
        full: usize,
    },
    /// By keys that change with the clock, other queues or the machine: a decision looks at all once.
    Scan {
        jobs: Vec<(QueueEntry, Facts)>,
        /// As above.
        full: usize,
    },
    /// The same without looking at all.
    Kinetic(Box<Kinetic>),
}

/// How a queue has to be kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QueueKind {
    /// In the order of arrival.
    Line,
    /// By keys that stand while a job waits.
    Heap,
    /// By keys that change.
    Scan,
    /// By keys of which one changes in a known way.
    Kinetic(Plan),
}

/// Length from which a queue is looked through for jobs that are gone: a machine that does not choose for long would
/// otherwise keep the places of all that others have done since.
const FULL: usize = 64;

impl Queue {
    /// An empty queue of a kind.
    pub fn from_queue_kind(kind: QueueKind) -> Self {
        Self(match kind {
            QueueKind::Line => Order::Line { jobs: VecDeque::new(), full: FULL },
            QueueKind::Heap => Order::Heap { jobs: Heap::default(), full: FULL },
            QueueKind::Scan => Order::Scan { jobs: Vec::new(), full: FULL },
            QueueKind::Kinetic(plan) => Order::Kinetic(Box::new(Kinetic::from_plan(plan))),
        })
    }

    /// Puts a job in its place. `facts` gives what its rules look at, `keys` its keys where they stand;
    /// `here` tells whether a job still waits for what its place says.
    pub fn join(
        &mut self,
        waiting: QueueEntry,
        facts: impl FnOnce() -> Facts,
        keys: impl FnOnce(&Facts) -> Keys,
        here: impl Fn(&QueueEntry) -> bool,
    ) {
        match &mut self.0 {
            Order::Line { jobs, full } => {
                if jobs.len() >= *full {
                    jobs.retain(&here);
                    *full = (2 * jobs.len()).max(FULL);
                }
                let after = |other: &QueueEntry| (other.since, other.number) > (waiting.since, waiting.number);
                if jobs.back().is_some_and(after) {
                    let behind = jobs.iter().rev().take_while(|other| after(other)).count();
                    jobs.insert(jobs.len() - behind, waiting);
                } else {
                    jobs.push_back(waiting);
                }
            }
            Order::Heap { jobs, full } => {
                if jobs.len() >= *full {
                    jobs.retain(&here);
                    *full = (2 * jobs.len()).max(FULL);
                }
                jobs.push(Ranked { keys: keys(&facts()), waiting });
            }
            Order::Scan { jobs, full } => {
                if jobs.len() >= *full {
                    jobs.retain(|(waiting, _)| here(waiting));
                    *full = (2 * jobs.len()).max(FULL);
                }
                jobs.push((waiting, facts()));
            }
            Order::Kinetic(jobs) => {
                let facts = facts();
                let keys = keys(&facts);
                jobs.join(waiting, facts, keys);
            }
        }
    }

    /// A job is gone to another machine: only queues that cannot see that have to be told.
    pub fn leave(&mut self, slot: u32) {
        match &mut self.0 {
            Order::Line { .. } | Order::Heap { .. } | Order::Scan { .. } => {}
            Order::Kinetic(jobs) => _ = jobs.leave(slot),
        }
    }

    /// Takes out the job that goes first where keys stand, so that neither clock nor machine counts; `None` where they do not.
    #[inline]
    pub fn take_standing(&mut self, here: impl Fn(&QueueEntry) -> bool) -> Option<Option<QueueEntry>> {
        match &mut self.0 {
            Order::Line { jobs, .. } => Some(std::iter::from_fn(|| jobs.pop_front()).find(here)),
            Order::Heap { jobs, .. } => Some(std::iter::from_fn(|| jobs.pop()).find(here)),
            Order::Scan { .. } | Order::Kinetic(_) => None,
        }
    }

    /// Where jobs are kept that are likely to be taken soon, where the queue is so long that its jobs are not in the nearest
    /// memory.
    #[inline]
    pub fn soon(&self) -> impl Iterator<Item = u32> + '_ {
        let sorted = match &self.0 {
            Order::Heap { jobs, .. } => Some(jobs.soon()),
            Order::Line { .. } | Order::Scan { .. } | Order::Kinetic(_) => None,
        };
        sorted.into_iter().flatten()
    }

    /// Takes out the job that goes first at time `now`, s. `here` tells whether a job is still to be had; `keys` gives its
    /// keys at this moment, from the means over all that are of what `measures` gives. Only a queue whose keys change asks for
    /// them.
    pub fn take(
        &mut self,
        now: f64,
        here: impl Fn(&QueueEntry) -> bool,
        measures: impl Fn(&Facts) -> Measures,
        keys: impl Fn(&QueueEntry, &Facts, Measures) -> Keys,
    ) -> Option<QueueEntry> {
        match &mut self.0 {
            Order::Line { .. } | Order::Heap { .. } => self.take_standing(here).flatten(),
            Order::Scan { jobs, .. } => {
                jobs.retain(|(waiting, _)| here(waiting));
                let mean = mean(jobs, measures);
                let ranked = |(waiting, facts): &(QueueEntry, Facts)| Ranked {
                    keys: keys(waiting, facts, mean),
                    waiting: *waiting,
                };
                let first = jobs.iter().map(ranked).enumerate().min_by_key(|(_, ranked)| *ranked);
                first.map(|(place, _)| jobs.swap_remove(place).0)
            }
            Order::Kinetic(jobs) => {
                jobs.take(now, |waiting, facts, time| keys(waiting, facts, Measures { time, setup: 0.0 }))
            }
        }
    }

    /// Jobs that are still to be had, the one that goes first in front; they stay. Those that are gone are
    /// forgotten. Only a queue whose keys may change is asked.
    pub fn in_order(
        &mut self,
        here: impl Fn(&QueueEntry) -> bool,
        measures: impl Fn(&Facts) -> Measures,
        keys: impl Fn(&QueueEntry, &Facts, Measures) -> Keys,
    ) -> Vec<QueueEntry> {
        let Order::Scan { jobs, .. } = &mut self.0 else { unreachable!("queues of batch machines are looked through") };
        jobs.retain(|(waiting, _)| here(waiting));
        let mean = mean(jobs, measures);
        let ranked =
            |(waiting, facts): &(QueueEntry, Facts)| Ranked { keys: keys(waiting, facts, mean), waiting: *waiting };
        let mut all: Vec<Ranked> = jobs.iter().map(ranked).collect();
        all.sort_unstable();
        all.dedup_by_key(|ranked| ranked.waiting.number);
        all.into_iter().map(|ranked| ranked.waiting).collect()
    }

    /// Number of places, those of jobs that are gone included.
    pub fn len(&self) -> usize {
        match &self.0 {
            Order::Line { jobs, .. } => jobs.len(),
            Order::Heap { jobs, .. } => jobs.len(),
            Order::Scan { jobs, .. } => jobs.len(),
            Order::Kinetic(jobs) => jobs.len(),
        }
    }

    /// Whether there is no place at all.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Means over jobs.
fn mean(jobs: &[(QueueEntry, Facts)], measures: impl Fn(&Facts) -> Measures) -> Measures {
    let add = |sum: Measures, own: Measures| Measures { time: sum.time + own.time, setup: sum.setup + own.setup };
    let sum = jobs.iter().map(|(_, facts)| measures(facts)).fold(Measures { time: -0.0, setup: 0.0 }, add);
    Measures { time: sum.time / jobs.len() as f64, setup: sum.setup / jobs.len() as f64 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use toolroom_kernel::SimTime;
    use toolroom_scenario::MOST_RULES;

    fn key(time: f64) -> Keys {
        let mut keys = [0.0; MOST_RULES];
        keys[0] = time;
        keys
    }

    /// The order in which a queue gives jobs (arrival, number, key), one after the other.
    fn order(kind: QueueKind, jobs: &[(f64, u32, f64)], gone: u32) -> Vec<u32> {
        let mut queue = Queue::from_queue_kind(kind);
        let here = |waiting: &QueueEntry| waiting.number != gone;
        for &(since, number, time) in jobs {
            let since = SimTime::from_seconds(since).unwrap();
            let waiting = QueueEntry { since, number, slot: number, operation: 0 };
            queue.join(waiting, || Facts { time, ..Facts::default() }, |facts| key(facts.time), here);
        }
        std::iter::from_fn(|| queue.take(0.0, here, |_| Measures::default(), |_, facts, _| key(facts.time)))
            .map(|taken| taken.number)
            .collect()
    }

    #[test]
    fn a_line_is_ordered_by_arrival_then_job() {
        let jobs = [(1.0, 5, 9.0), (2.0, 3, 1.0), (2.0, 1, 2.0), (2.0, 2, 3.0)];
        assert_eq!(order(QueueKind::Line, &jobs, 9), [5, 1, 2, 3]);
        assert_eq!(order(QueueKind::Line, &jobs, 1), [5, 2, 3]);
    }

    #[test]
    fn the_least_key_goes_first_and_ties_go_to_the_first() {
        let jobs = [(0.0, 0, 0.0), (1.0, 1, 1.0), (2.0, 2, 2.0), (3.0, 3, 0.0), (4.0, 4, 1.0)];
        for kind in [QueueKind::Heap, QueueKind::Scan] {
            assert_eq!(order(kind, &jobs, 1), [0, 3, 4, 2]);
        }
    }

    /// The same where jobs come and go in turns: after each of `bursts` so many are taken.
    fn in_turns(kind: QueueKind, bursts: &[(usize, usize)], keys: u32) -> Vec<u32> {
        let (mut queue, mut number, mut taken) = (Queue::from_queue_kind(kind), 0u32, Vec::new());
        let here = |waiting: &QueueEntry| waiting.number % 7 != 3;
        for &(come, go) in bursts {
            for _ in 0..come {
                let since = SimTime::from_seconds(f64::from(number / 5)).unwrap();
                let time = f64::from(number.wrapping_mul(2_654_435_761) >> 8 & keys);
                let waiting = QueueEntry { since, number, slot: number, operation: 0 };
                queue.join(waiting, || Facts { time, ..Facts::default() }, |facts| key(facts.time), here);
                number += 1;
            }
            for _ in 0..go {
                let next = queue.take(0.0, here, |_| Measures::default(), |_, facts, _| key(facts.time));
                taken.extend(next.map(|own| own.number));
            }
        }
        taken
    }

    proptest! {
        #[test]
        fn long_queues_in_turns_give_the_same_order(
            bursts in prop::collection::vec((0usize..150, 0usize..120), 1..6), keys in prop::sample::select(vec![3u32, 63, u32::MAX])
        ) {
            let heap = in_turns(QueueKind::Heap, &bursts, keys);
            prop_assert_eq!(heap, in_turns(QueueKind::Scan, &bursts, keys));
        }

        #[test]
        fn a_heap_and_a_scan_give_the_same_order(
            times in prop::collection::vec(0u32..5, 1..300), gone in 0u32..300
        ) {
            let job = |(number, time): (u32, &u32)| (f64::from(number / 3), number, f64::from(*time));
            let jobs: Vec<_> = (0..).zip(&times).map(job).collect();
            prop_assert_eq!(order(QueueKind::Heap, &jobs, gone), order(QueueKind::Scan, &jobs, gone));
        }
    }
}
