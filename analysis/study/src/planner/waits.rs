//! Where jobs wait: what a run says of every queue, and of every order where most of its waiting was spent.
//!
//! A job waits from the end of one operation, or from when it came, to the beginning of the next: in a queue, out of shift, for a card
//! and on its way. Waits before the start of the run are not counted.

use super::Figures;
use toolroom_numerics::rank_quantile;
use toolroom_scenario::Scenario;
use toolroom_shop::runlog::{JobOutcome, JobRow, RunLog};

/// Share of the time, or of the jobs, that the upper figures of a queue leave below them.
const UPPER: f64 = 0.95;

/// What is known of a queue in one run, in the order of the figures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum QueueFigure {
    /// Time average of the jobs that wait, 1.
    MeanLength,
    /// Most jobs that wait in 95 % of the time, 1.
    UpperLength,
    /// Most jobs that waited at once, 1.
    MaximumLength,
    /// Mean time that jobs waited before they were begun, s.
    MeanWait,
    /// Time that 95 % of them waited at most, s.
    UpperWait,
}

impl QueueFigure {
    pub(super) const COUNT: usize = 5;
}

/// A job before an operation.
struct Wait {
    job: u32,
    station: usize,
    from: f64,
    to: f64,
    /// Whether the operation was begun; else the run ended before.
    begun: bool,
}

impl Figures {
    /// All waits of a run.
    fn waits(&self, scenario: &Scenario, log: &RunLog) -> Vec<Wait> {
        let station = |operation: &toolroom_scenario::Operation| {
            let mut machines = operation.machines.clone();
            machines.sort_unstable();
            self.stations.iter().position(|own| *own == machines).unwrap_or(0)
        };
        let stations: Vec<Vec<usize>> =
            scenario.parts.iter().map(|part| part.operations.iter().map(station).collect()).collect();
        // When every job was ready for its next operation, and which one that is.
        let first =
            |order: u32| scenario.orders[order as usize].in_process.as_ref().map_or(0, |own| own.operation as u32);
        // Pieces that an inspection divided from a job have waited with it.
        let from = |job: &JobRow| if job.divided_from.is_some() { f64::NAN } else { job.arrival.max(0.0) };
        let mut ready: Vec<(f64, u32)> = log.jobs.iter().map(|job| (from(job), job.order.map_or(0, first))).collect();
        let mut waits = Vec::with_capacity(log.operations.len());
        for row in &log.operations {
            let from = ready[row.job as usize].0;
            if from.is_finite() {
                let station = stations[row.part as usize][row.operation as usize];
                waits.push(Wait { job: row.job, station, from, to: row.start, begun: true });
            }
            ready[row.job as usize] = (row.end, row.next);
        }
        for (number, (job, (from, operation))) in (0..).zip(log.jobs.iter().zip(&ready)) {
            let next = stations[job.part as usize].get(*operation as usize);
            if let (Some(&station), JobOutcome::InProcess, true) = (next, job.outcome, from.is_finite()) {
                waits.push(Wait { job: number, station, from: *from, to: log.horizon, begun: false });
            }
        }
        waits
    }

    pub(super) fn add_waits(&self, scenario: &Scenario, log: &RunLog, values: &mut [f64]) {
        let waits = self.waits(scenario, log);
        for place in 0..self.stations.len() {
            let own = || waits.iter().filter(|wait| wait.station == place);
            let intervals: Vec<(f64, f64)> = own().map(|wait| (wait.from, wait.to)).collect();
            let mut begun: Vec<f64> = own().filter(|wait| wait.begun).map(|wait| wait.to - wait.from).collect();
            begun.sort_by(f64::total_cmp);
            let length: f64 = intervals.iter().map(|(from, to)| to - from).sum::<f64>() / log.horizon;
            let (most, upper) = lengths(&intervals, log.horizon);
            let (mean_wait, upper_wait) = if begun.is_empty() {
                (f64::NAN, f64::NAN)
            } else {
                (begun.iter().sum::<f64>() / begun.len() as f64, rank_quantile(&begun, UPPER))
            };
            values[self.queue(place, QueueFigure::MeanLength)] = length;
            values[self.queue(place, QueueFigure::UpperLength)] = f64::from(upper);
            values[self.queue(place, QueueFigure::MaximumLength)] = f64::from(most);
            values[self.queue(place, QueueFigure::MeanWait)] = mean_wait;
            values[self.queue(place, QueueFigure::UpperWait)] = upper_wait;
        }
        self.add_longest(log, &waits, values);
    }

    /// Where every order waited longest: the mean wait of its pieces at each station, all visits together.
    fn add_longest(&self, log: &RunLog, waits: &[Wait], values: &mut [f64]) {
        let mut own: Vec<(usize, usize, f64)> = Vec::new();
        for wait in waits.iter().filter(|wait| wait.to > wait.from) {
            let job = &log.jobs[wait.job as usize];
            let Some(order) = job.order else { continue };
            own.push((order as usize, wait.station, (wait.to - wait.from) * f64::from(job.quantity)));
        }
        own.sort_by_key(|(order, station, _)| (*order, *station));
        let mut pieces = vec![0.0; self.orders];
        for job in &log.jobs {
            if let Some(order) = job.order {
                pieces[order as usize] += f64::from(job.quantity);
            }
        }
        for order in 0..self.orders {
            values[self.longest_at(order)] = f64::NAN;
        }
        for at_station in own.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            let (order, station, _) = at_station[0];
            let time = at_station.iter().map(|(.., time)| time).sum::<f64>() / pieces[order].max(1.0);
            // Of equal ones the first by the order of stations.
            if time > values[self.longest_wait(order)] {
                values[self.longest_at(order)] = station as f64;
                values[self.longest_wait(order)] = time;
            }
        }
    }
}

/// Most intervals of some length that have an instant in common, and the most that have one in 95 % of the time from 0 to
/// `horizon`.
pub(super) fn lengths(intervals: &[(f64, f64)], horizon: f64) -> (u32, u32) {
    let mut changes: Vec<(f64, i32)> =
        intervals.iter().filter(|(from, to)| to > from).flat_map(|&(from, to)| [(from, 1), (to, -1)]).collect();
    changes.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let (mut now, mut since) = (0_usize, 0.0);
    let mut times = vec![0.0]; // by length
    for (time, change) in changes {
        times[now] += time - since;
        since = time;
        now = now.saturating_add_signed(change as isize);
        if now == times.len() {
            times.push(0.0);
        }
    }
    times[now] += horizon - since;
    let mut below = 0.0;
    let upper = times.iter().position(|time| {
        below += time;
        below >= UPPER * horizon
    });
    let most = times.len() as u32 - 1;
    (most, upper.map_or(most, |upper| upper as u32))
}
