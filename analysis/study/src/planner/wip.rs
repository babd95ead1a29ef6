//! Work in process over time: orders in the shop, and the work that they still ask for.

use super::Figures;
use std::collections::BTreeMap;
use toolroom_numerics::rank_quantile;
use toolroom_scenario::{Scenario, WorkPer};
use toolroom_shop::programmed_cutting_times;
use toolroom_shop::runlog::{OperationRow, RunLog};

/// Most steps between instants at which stock is taken, an assumption: as many points as a chart shows.
const MOST_STEPS: f64 = 200.0;

/// Distances between the instants, s: the least that keeps to [`MOST_STEPS`] is taken.
const STEPS: [f64; 14] = [
    60.0,
    300.0,
    900.0,
    3600.0,
    2.0 * 3600.0,
    4.0 * 3600.0,
    8.0 * 3600.0,
    86_400.0,
    2.0 * 86_400.0,
    7.0 * 86_400.0,
    14.0 * 86_400.0,
    28.0 * 86_400.0,
    91.0 * 86_400.0,
    364.0 * 86_400.0,
];

/// Stock of an instant, in the order of the figures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum WipFigure {
    /// Orders, and jobs of sources, that have come and have not left, 1.
    Orders,
    /// Mean times of the operations of these that have not ended, without setups, s.
    Work,
}

impl WipFigure {
    pub(super) const COUNT: usize = 2;
}

/// Work in process at an instant: mean, and what 10 and 90 % of the replications do not exceed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WipAnswer {
    /// When, s.
    pub time: f64,
    /// Orders in the shop, 1.
    pub orders: [f64; 3],
    /// Work that they still ask for, s.
    pub work: [f64; 3],
}

/// The instants at which stock is taken, from 0 to the horizon, s.
pub(super) fn instants(horizon: f64) -> Vec<f64> {
    let step = STEPS.into_iter().find(|step| horizon / step <= MOST_STEPS).unwrap_or(horizon / MOST_STEPS);
    (0..=(horizon / step).floor() as usize).map(|each| each as f64 * step).collect()
}

/// Mean of the replications, and what 10 and 90 % of them do not exceed.
fn band(mut values: Vec<f64>) -> [f64; 3] {
    values.sort_by(f64::total_cmp);
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    [mean, rank_quantile(&values, 0.1), rank_quantile(&values, 0.9)]
}

impl Figures {
    pub(super) fn wip_answers(&self, runs: &[&[f64]]) -> Vec<WipAnswer> {
        let of =
            |instant: usize, figure: WipFigure| band(runs.iter().map(|run| run[self.wip(instant, figure)]).collect());
        let answer = |(instant, &time): (usize, &f64)| WipAnswer {
            time,
            orders: of(instant, WipFigure::Orders),
            work: of(instant, WipFigure::Work),
        };
        self.instants.iter().enumerate().map(answer).collect()
    }

    /// What is in the shop after all events of an instant.
    pub(super) fn add_wip(&self, scenario: &Scenario, log: &RunLog, values: &mut [f64]) {
        // What belongs together is one: the jobs of an order, and what inspections divided from a job.
        let mut stays: BTreeMap<(bool, usize), (f64, f64)> = BTreeMap::new();
        for (number, job) in log.jobs.iter().enumerate() {
            let own = job.order.map_or((false, log.root(number)), |order| (true, order as usize));
            let finish = if job.finish.is_nan() { f64::INFINITY } else { job.finish };
            let stay = stays.entry(own).or_insert((job.arrival, finish));
            *stay = (stay.0.min(job.arrival), stay.1.max(finish));
        }
        for (from, to) in stays.into_values() {
            self.add_between(values, WipFigure::Orders, (from, to), 1.0);
        }
        self.add_work(scenario, log, values);
    }

    fn add_between(&self, values: &mut [f64], figure: WipFigure, (from, to): (f64, f64), value: f64) {
        let first = self.instants.partition_point(|instant| *instant < from);
        let end = self.instants.partition_point(|instant| *instant < to);
        for instant in first..end {
            values[self.wip(instant, figure)] += value;
        }
    }

    fn add_work(&self, scenario: &Scenario, log: &RunLog, values: &mut [f64]) {
        let left = WorkLeft::from_scenario(scenario);
        let mut rows: Vec<Vec<&OperationRow>> = vec![Vec::new(); log.jobs.len()];
        for row in log.operations.iter().filter(|row| row.end.is_finite()) {
            rows[row.job as usize].push(row);
        }
        for (number, job) in log.jobs.iter().enumerate() {
            // Pieces that were divided from a job have gone as far as that until then: the operation that divided them has a
            // row of their own.
            let mut steps: Vec<(f64, u32)> = rows[number].iter().map(|row| (row.end, row.next)).collect();
            let (mut own, mut until) = (number, rows[number].first().map_or(f64::INFINITY, |row| row.start));
            while let Some(parent) = log.jobs[own].divided_from {
                own = parent as usize;
                let before: Vec<&&OperationRow> = rows[own].iter().filter(|row| row.end <= until).collect();
                until = until.min(before.first().map_or(until, |row| row.start));
                steps.splice(0..0, before.iter().map(|row| (row.end, row.next)));
            }
            let in_process = job.order.and_then(|order| scenario.orders[order as usize].in_process.as_ref());
            let mut state = (job.arrival, in_process.map_or(0, |own| own.operation));
            let finish = if job.finish.is_nan() { f64::INFINITY } else { job.finish };
            for (end, next) in steps.into_iter().chain([(finish, 0)]) {
                let work = left.of_job(job.part as usize, state.1, f64::from(job.quantity));
                self.add_between(values, WipFigure::Work, (state.0, end), work);
                state = (end, next as usize);
            }
        }
    }
}

/// Mean times of an operation and all behind it in the routing, s, by part and operation: of a piece, and of a lot or batch once.
struct WorkLeft(Vec<Vec<(f64, f64)>>);

impl WorkLeft {
    fn from_scenario(scenario: &Scenario) -> Self {
        let handling = |machine: usize| {
            scenario.machines[machine].load_time.mean() + scenario.machines[machine].unload_time.mean()
        };
        let part = |(part, cutting): (&toolroom_scenario::Part, Vec<f64>)| {
            let mut behind = (0.0, 0.0);
            let own = part.operations.iter().zip(cutting).rev().map(|(operation, cutting)| {
                // On the machine that is named first.
                let handled = operation.machines.first().map_or(0.0, |machine| handling(*machine));
                let time = operation.work.plain_time() + cutting;
                match operation.work_per {
                    WorkPer::Part => behind.0 += time,
                    WorkPer::Lot | WorkPer::Batch => behind.1 += time,
                }
                behind.0 += handled;
                behind
            });
            let mut all: Vec<(f64, f64)> = own.collect();
            all.reverse();
            all
        };
        Self(scenario.parts.iter().zip(programmed_cutting_times(scenario)).map(part).collect())
    }

    /// Of so many pieces that move together; nothing behind the last operation.
    fn of_job(&self, part: usize, operation: usize, pieces: f64) -> f64 {
        self.0[part].get(operation).map_or(0.0, |(piece, lot)| piece * pieces + lot)
    }
}
