//! When jobs and orders leave the shop, against when they are due and what their work takes.

use super::histogram::Histogram;
use toolroom_scenario::{Order, Scenario};
use toolroom_shop::runlog::{JobOutcome, JobRow};

/// Sums over the good jobs that left, and what became of every order.
#[derive(Clone, Debug, Default)]
pub(super) struct Delivery {
    /// Jobs that were good: a part, or parts of an order that move together.
    pub jobs: u32,
    /// Of them those that left after they were due.
    pub tardy: u32,
    /// Sum of lead times, s.
    pub lead_time: f64,
    /// Sum of the times for which their operations were in process, s.
    pub in_process: f64,
    /// Sum of tardiness, s.
    pub tardiness: f64,
    /// Sum of tardiness times weight, s; NaN with a job whose weight nobody knows.
    pub weighted_tardiness: f64,
    /// Greatest tardiness, s.
    pub greatest_tardiness: f64,
    /// Sum of what the work of the jobs takes as programmed, s.
    pub raw_time: f64,
    /// Lead times.
    pub lead_times: Histogram,
    /// By order.
    orders: Vec<Left>,
    /// Weight of jobs of sources, by part; `None` where sources of one part differ in it.
    weights: Vec<Option<f64>>,
}

/// What has left of an order.
#[derive(Clone, Copy, Debug, Default)]
struct Left {
    /// When its last job left, s; infinite while one is in the shop.
    last: f64,
    /// Whether anything good did.
    good: bool,
}

impl Delivery {
    pub fn new(scenario: &Scenario) -> Self {
        let weight = |part: usize| {
            let mut sources = scenario.arrivals.iter().filter(|arrival| arrival.parts.iter().any(|own| own.0 == part));
            let first = sources.next()?.weight;
            sources.all(|other| other.weight == first).then_some(first)
        };
        let begun = |order: &Order| Left { last: 0.0, good: order.finished_before(&scenario.parts[order.part]) > 0 };
        Self {
            orders: scenario.orders.iter().map(begun).collect(),
            weights: (0..scenario.parts.len()).map(weight).collect(),
            ..Self::default()
        }
    }

    /// A good job that has left the shop; `raw_time` is what its work takes, s.
    #[inline]
    pub fn add(&mut self, scenario: &Scenario, job: &JobRow, raw_time: f64) {
        let late = (job.finish - job.due).max(0.0);
        self.jobs += 1;
        self.lead_time += job.finish - job.arrival;
        self.in_process += job.in_process;
        self.lead_times.add(job.finish - job.arrival);
        self.tardiness += late;
        self.greatest_tardiness = self.greatest_tardiness.max(late);
        self.tardy += u32::from(job.finish > job.due);
        self.raw_time += raw_time;
        self.weighted_tardiness += self.weight(scenario, job) * late;
    }

    /// Weight of the order or source of a job; NaN where sources of its part differ in it.
    pub fn weight(&self, scenario: &Scenario, job: &JobRow) -> f64 {
        match job.order {
            Some(order) => scenario.orders[order as usize].weight,
            None => self.weights[job.part as usize].unwrap_or(f64::NAN),
        }
    }

    /// A job of any outcome that has left the shop, or is in it at the end of the run.
    #[inline]
    pub fn see(&mut self, job: &JobRow) {
        let Some(order) = job.order else { return };
        let own = &mut self.orders[order as usize];
        own.last = own.last.max(if job.finish.is_nan() { f64::INFINITY } else { job.finish });
        own.good |= job.outcome == JobOutcome::Good;
    }

    /// Share of the orders due until `horizon`, s, that had left the shop when they were due, with anything good of them; NaN
    /// without any.
    pub fn on_time(&self, scenario: &Scenario, horizon: f64) -> f64 {
        let due = || scenario.orders.iter().zip(&self.orders).filter(|(order, _)| order.due <= horizon);
        let in_time = due().filter(|(order, left)| left.good && left.last <= order.due).count();
        in_time as f64 / due().count() as f64
    }
}
