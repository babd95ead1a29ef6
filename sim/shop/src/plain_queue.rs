//! How jobs wait at a machine of a shop of plain machines: in line, or in the order of rules.

use super::branch::queue_of;
use super::layout::{Layout, time_of};
use super::look::{looks_at_operation_due, looks_at_work_left};
use super::plain_jobs::{Line, PlainJob, PlainJobs};
use super::queue_change::QueueChange;
use std::hint::black_box;
use toolroom_kernel::SimTime;
use toolroom_queues::{Facts, Measures, Moment, Queue, QueueEntry, keys};
use toolroom_scenario::{DispatchRule, Scenario};

/// Jobs that wait at a machine.
#[derive(Clone, Debug)]
pub(super) enum Waiting<'a> {
    /// First come, first served.
    Line(Line),
    /// By rules whose keys stand, or move with the clock and other queues.
    Ranked(Box<Ranked<'a>>),
}

/// Jobs in the order of rules.
#[derive(Clone, Debug)]
pub(super) struct Ranked<'a> {
    queue: Queue,
    scenario: &'a Scenario,
    rules: &'a [DispatchRule],
}

impl<'a> Waiting<'a> {
    /// Nobody waits at a machine yet.
    pub fn at(scenario: &'a Scenario, machine: usize) -> Self {
        let rules = scenario.rules(machine);
        if rules.iter().all(|rule| *rule == DispatchRule::Fifo) {
            return Self::Line(Line::default());
        }
        Self::Ranked(Box::new(Ranked { queue: queue_of(scenario, machine, rules), scenario, rules }))
    }

    pub fn is_empty(&self) -> bool {
        match self {
            Self::Line(line) => line.is_empty(),
            Self::Ranked(ranked) => ranked.queue.is_empty(),
        }
    }

    /// The job at a place comes.
    #[inline]
    pub fn join(&mut self, layout: &Layout, jobs: &PlainJobs, slot: usize, now: SimTime) {
        match self {
            Self::Line(line) => line.join(slot, jobs.all[slot].number, now),
            Self::Ranked(ranked) => ranked.join(layout, jobs, slot, now),
        }
    }

    /// Takes out the job that goes first: its place.
    #[inline]
    pub fn take(&mut self, layout: &Layout, jobs: &PlainJobs, work: &WaitingWork, now: SimTime) -> Option<usize> {
        match self {
            Self::Line(line) => line.take(),
            Self::Ranked(ranked) => ranked.take(layout, jobs, work, now),
        }
    }
}

impl Ranked<'_> {
    fn join(&mut self, layout: &Layout, jobs: &PlainJobs, slot: usize, now: SimTime) {
        let (job, rules) = (&jobs.all[slot], self.rules);
        let waiting = QueueEntry { since: now, number: job.number, slot: slot as u32, operation: job.operation };
        let facts = || facts(self.scenario, layout, (job, jobs.drawn_at(slot)), rules);
        // Nobody but this machine takes a job.
        self.queue.join(waiting, facts, |facts| keys(rules, now.seconds(), facts, &Moment::default()), |_| true);
    }

    fn take(&mut self, layout: &Layout, jobs: &PlainJobs, work: &WaitingWork, now: SimTime) -> Option<usize> {
        if let Some(first) = self.queue.take_standing(|_| true) {
            // Memory then has at hand what is taken soon.
            self.queue
                .soon()
                .for_each(|slot| _ = black_box((jobs.all[slot as usize].operation, jobs.drawn_at(slot as usize)[0])));
            return first.map(|first| first.slot as usize);
        }
        let (rules, options) = (self.rules, &self.scenario.control.keys);
        let at = |waiting: &QueueEntry, facts: &Facts, mean: Measures| {
            let next_work = facts.next_station.map_or(0.0, |station| work.of_station(layout, station));
            let moment = Moment { now: now.seconds(), mean, next_work, setup: 0.0, options };
            keys(rules, waiting.since.seconds(), facts, &moment)
        };
        let first = self.queue.take(now.seconds(), |_| true, |_| Measures::default(), at)?;
        Some(first.slot as usize)
    }
}

/// Work that waits at every station, where a rule looks at it.
#[derive(Clone, Debug, Default)]
pub(super) struct WaitingWork {
    /// Jobs and their time, s, by station.
    stations: Vec<(u32, f64)>,
}

impl WaitingWork {
    /// Nothing waits yet.
    pub fn of(layout: &Layout) -> Self {
        Self { stations: if layout.looks_ahead { vec![(0, 0.0); layout.overlapping.len()] } else { Vec::new() } }
    }

    /// What waits at the machines of a station, s.
    fn of_station(&self, layout: &Layout, station: u32) -> f64 {
        let together = || layout.overlapping[station as usize].iter();
        together().filter_map(|station| self.stations.get(*station as usize)).map(|own| own.1).sum::<f64>() + 0.0
    }

    /// The job at a place comes to the queue of its operation, or leaves it.
    #[inline]
    pub fn weigh(&mut self, layout: &Layout, jobs: &PlainJobs, slot: usize, change: QueueChange) {
        if self.stations.is_empty() {
            return;
        }
        let job = &jobs.all[slot];
        let (part, index) = (job.part as usize, job.operation as usize);
        let plan = &layout.operations[part][index];
        let known = layout.expected.get(part).map_or(jobs.drawn_at(slot), |expected| expected);
        let time = time_of(plan, f64::from(job.quantity), known[index]);
        let (count, work) = &mut self.stations[plan.station as usize];
        match change {
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
}

/// What rules look at of a job that comes to a queue, see [`look::facts`](super::look::facts).
fn facts(scenario: &Scenario, layout: &Layout, (job, drawn): (&PlainJob, &[f64]), rules: &[DispatchRule]) -> Facts {
    let (part, index) = (job.part as usize, job.operation as usize);
    let (plans, source) = (&layout.operations[part], &scenario.arrivals[job.source as usize]);
    let known = layout.expected.get(part).map_or(drawn, |expected| expected);
    let time = |operation: usize| time_of(&plans[operation], f64::from(job.quantity), known[operation]);
    let looks = |at: &dyn Fn(DispatchRule) -> bool| rules.iter().any(|rule| at(*rule));
    let operation_due = || {
        let (until, total): (f64, f64) = ((0..=index).map(time).sum(), (0..plans.len()).map(time).sum());
        let share = if total > 0.0 { until / total } else { 1.0 };
        job.arrival + (job.due - job.arrival) * share
    };
    let own_due = looks(&|rule| looks_at_operation_due(rule, &scenario.control.keys));
    Facts {
        release: job.arrival,
        priority: f64::from(source.priority),
        weight: source.weight,
        due: job.due,
        operation_due: if own_due { operation_due() } else { job.due },
        time: time(index),
        work_left: if looks(&looks_at_work_left) { (index..plans.len()).map(time).sum() } else { 0.0 },
        operations_left: (plans.len() - index) as f64,
        next_time: plans.get(index + 1).map_or(0.0, |_| time(index + 1)),
        next_station: plans.get(index + 1).map(|plan| plan.station),
        ..Facts::default() // nothing else is looked at but setups and chance, by rules that no such shop has
    }
}
