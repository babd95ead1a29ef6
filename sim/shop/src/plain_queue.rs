//! How jobs wait at a machine of a shop of plain machines: in line, or by rules whose keys stand.

use super::branch::queue_of;
use super::layout::{Layout, time_of};
use super::look::{looks_at_operation_due, looks_at_work_left};
use super::plain_jobs::{Line, PlainJob, PlainJobs};
use std::hint::black_box;
use toolroom_kernel::SimTime;
use toolroom_queues::{Facts, Moment, Queue, QueueEntry, keys};
use toolroom_scenario::{DispatchRule, Scenario};

/// Jobs that wait at a machine.
#[derive(Clone, Debug)]
pub(super) enum Waiting<'a> {
    /// First come, first served.
    Line(Line),
    /// By rules whose keys stand.
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
    pub fn take(&mut self, jobs: &PlainJobs) -> Option<usize> {
        match self {
            Self::Line(line) => line.take(),
            Self::Ranked(ranked) => ranked.take(jobs),
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

    fn take(&mut self, jobs: &PlainJobs) -> Option<usize> {
        let first = self.queue.take_standing(|_| true).flatten()?;
        // Memory then has at hand what is taken soon.
        self.queue
            .soon()
            .for_each(|slot| _ = black_box((jobs.all[slot as usize].place, jobs.drawn_at(slot as usize)[0])));
        Some(first.slot as usize)
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
        ..Facts::default() // rules whose keys stand look at nothing else, but for chance, which no such shop has
    }
}
