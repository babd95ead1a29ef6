//! The answers over all replications of one policy.

use super::waits::QueueFigure;
use super::{Figures, LoadKind, WipAnswer};
use crate::study::Study;
use toolroom_numerics::rank_quantile;
use toolroom_scenario::{Scenario, date};
use toolroom_statistics::{CONFIDENCE, wilson};

/// Everything that a planner asks, under one policy.
#[derive(Clone, Debug, PartialEq)]
pub struct Answers {
    /// Orders, those most at risk first.
    pub orders: Vec<OrderAnswer>,
    /// Every machine and everybody in every week.
    pub loads: Vec<LoadAnswer>,
    /// Every station.
    pub queues: Vec<QueueAnswer>,
    /// Work in process over time.
    pub wip: Vec<WipAnswer>,
}

/// When an order will be finished.
#[derive(Clone, Debug, PartialEq)]
pub struct OrderAnswer {
    /// Index into the orders of the scenario.
    pub order: usize,
    /// Mean of the replications in which it is finished, s; NaN where it never is.
    pub mean: f64,
    /// Times by which it is finished in 50, 80 and 95 % of the replications.
    pub quantiles: [Finish; 3],
    /// Replications in which it is finished when it is due.
    pub on_time: usize,
    /// Replications in which it is not finished at the horizon.
    pub unfinished: usize,
    /// Replications.
    pub replications: usize,
    /// Share of replications in which it is on time, with its interval of 95 %.
    pub share: f64,
    /// Ends of that interval.
    pub interval: [f64; 2],
    /// Mean tardiness of the replications in which it is finished, s; NaN where it never is.
    pub tardiness: f64,
    /// Mean number of pieces that are lost.
    pub lost: f64,
    /// Where it waited longest; `None` where it waited nowhere in any replication.
    pub longest: Option<LongestWait>,
}

/// The station at which an order waits longest: that of most replications, of equally many the one with the longer
/// wait, then the first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LongestWait {
    /// Station, by index into [`Answers::queues`].
    pub station: usize,
    /// Replications in which it is this one.
    pub replications: usize,
    /// Mean wait there in these, s: of a piece, all visits together.
    pub wait: f64,
}

/// The time of a finish.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Finish {
    /// At this time, s.
    At(f64),
    /// After the end of the run, s.
    After(f64),
}

impl Finish {
    /// As people read it: a date, or hours since the start.
    pub fn shown(self, scenario: &Scenario) -> String {
        match self {
            Self::At(time) => shown(scenario, time),
            Self::After(horizon) => format!("after {}", shown(scenario, horizon)),
        }
    }

    /// As a column of dates holds it.
    pub fn stamped(self, scenario: &Scenario) -> String {
        match self {
            Self::At(time) => stamped(scenario, time),
            Self::After(horizon) => format!("after {}", stamped(scenario, horizon)),
        }
    }
}

/// A time as a column of a table holds it: dates always with their seconds, so that programs read all of a column alike.
pub(crate) fn stamped(scenario: &Scenario, time: f64) -> String {
    const WITHOUT_SECONDS: usize = "2026-01-01 00:00".len();
    let text = shown(scenario, time);
    if scenario.start.is_some() && text.len() == WITHOUT_SECONDS { text + ":00" } else { text }
}

/// A time as people read it; empty where there is none.
pub(crate) fn shown(scenario: &Scenario, time: f64) -> String {
    match scenario.start {
        _ if time.is_nan() => String::new(),
        Some(start) => date::show(start + time),
        None => format!("{} h", hours(time)),
    }
}

/// Hours to the second, as dates are: four decimals tell seconds apart, of which zeros behind the second are left out.
fn hours(time: f64) -> String {
    let all = format!("{:.4}", time.round() / 3600.0);
    let short = all.strip_suffix("00").or(all.strip_suffix('0'));
    short.unwrap_or(&all).to_owned()
}

/// Number of orders that are late in every replication, those that are not finished included; empty where there are
/// no orders.
pub(crate) fn late(scenario: &Scenario, study: &Study, policy: usize) -> Vec<f64> {
    if scenario.orders.is_empty() {
        return Vec::new();
    }
    study.planner_figures(policy).map(|figures| late_in(scenario, &figures)).collect()
}

/// The same of one run, from its figures.
pub(crate) fn late_in(scenario: &Scenario, values: &[f64]) -> f64 {
    let figures = Figures::of(scenario);
    (0..scenario.orders.len()).filter(|order| !figures.is_on_time(scenario, values, *order)).count() as f64
}

/// What a machine or a person does in a week.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadAnswer {
    /// Machine, by index, or behind them a person.
    pub resource: usize,
    /// Week of the run, by index.
    pub week: usize,
    /// Mean times, s, by [`LoadKind`].
    pub means: [f64; LoadKind::ALL.len()],
    /// Load that is not exceeded in 90 % of the replications: busy time over planned busy time; NaN where no
    /// work is planned.
    pub high_load: f64,
}

impl LoadAnswer {
    /// Mean time of a kind, s.
    pub fn mean(&self, kind: LoadKind) -> f64 {
        self.means[kind as usize]
    }

    /// Mean busy time over planned busy time; NaN where no work is planned.
    pub fn load(&self) -> f64 {
        busy(&self.means)
    }
}

/// Share of the planned busy time in which a machine is not free.
fn busy(times: &[f64]) -> f64 {
    let planned = times[LoadKind::PlannedBusy as usize];
    if planned > 0.0 { 1.0 - times[LoadKind::Free as usize] / planned } else { f64::NAN }
}

/// What waits at a station.
#[derive(Clone, Debug, PartialEq)]
pub struct QueueAnswer {
    /// Machines, by index.
    pub machines: Vec<usize>,
    /// Jobs that wait on average.
    pub length: f64,
    /// Most jobs that wait in 95 % of the time: mean over the replications.
    pub upper_length: f64,
    /// Most jobs that wait at once: mean and 95 % quantile over the replications.
    pub longest: [f64; 2],
    /// Time that a job waits and that 95 % of the jobs wait at most, s: means over the replications; NaN where nothing is
    /// begun.
    pub wait: [f64; 2],
    /// Time that all jobs together wait in a replication until the horizon, s: mean.
    pub total: f64,
}

/// The answers of a study under its policy number `position`; `None` for a scenario without orders and a study
/// without replications.
pub fn answers(scenario: &Scenario, study: &Study, position: usize) -> Option<Answers> {
    let figures = Figures::of(scenario);
    if figures.is_empty() || study.replications == 0 {
        return None;
    }
    let runs: Vec<Vec<f64>> = study.planner_figures(position).collect();
    let runs: Vec<&[f64]> = runs.iter().map(Vec::as_slice).collect();
    let mut orders: Vec<OrderAnswer> =
        (0..scenario.orders.len()).map(|order| order_answer(scenario, &figures, &runs, order)).collect();
    let due = |answer: &OrderAnswer| scenario.orders[answer.order].due;
    orders.sort_by(|a, b| a.share.total_cmp(&b.share).then(due(a).total_cmp(&due(b))).then(a.order.cmp(&b.order)));
    let places = (0..figures.resources).flat_map(|resource| (0..figures.weeks.len()).map(move |week| (resource, week)));
    let loads = places.map(|(resource, week)| load_answer(&figures, &runs, resource, week)).collect();
    let queues = (0..figures.stations.len()).map(|station| queue_answer(scenario, &figures, &runs, station));
    let queues = queues.collect();
    Some(Answers { orders, loads, queues, wip: figures.wip_answers(&runs) })
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn order_answer(scenario: &Scenario, figures: &Figures, runs: &[&[f64]], order: usize) -> OrderAnswer {
    let order_row = &scenario.orders[order];
    let mut finishes: Vec<f64> = runs.iter().map(|run| run[figures.finish(order)]).collect();
    let finished: Vec<f64> = finishes.iter().copied().filter(|finish| finish.is_finite()).collect();
    let on_time = runs.iter().filter(|run| figures.is_on_time(scenario, run, order)).count();
    let late: Vec<f64> = finished.iter().map(|finish| (finish - order_row.due).max(0.0)).collect();
    let good: Vec<f64> = runs.iter().map(|run| run[figures.good(order)]).collect();
    // An order that is not finished is later than all that are.
    finishes.iter_mut().filter(|finish| finish.is_nan()).for_each(|finish| *finish = f64::INFINITY);
    finishes.sort_by(f64::total_cmp);
    let by = |share: f64| {
        let finish = rank_quantile(&finishes, share);
        if finish.is_finite() { Finish::At(finish) } else { Finish::After(scenario.horizon) }
    };
    let lost = if finished.is_empty() {
        0.0
    } else {
        f64::from(order_row.quantity - order_row.finished_before(&scenario.parts[order_row.part])) - mean(&good)
    };
    OrderAnswer {
        order,
        mean: mean(&finished),
        quantiles: [by(0.5), by(0.8), by(0.95)],
        on_time,
        unfinished: runs.len() - finished.len(),
        replications: runs.len(),
        share: on_time as f64 / runs.len() as f64,
        interval: wilson(on_time, runs.len(), CONFIDENCE),
        tardiness: mean(&late),
        lost: if finished.len() == runs.len() { lost } else { 0.0 },
        longest: longest_wait(figures, runs, order),
    }
}

fn longest_wait(figures: &Figures, runs: &[&[f64]], order: usize) -> Option<LongestWait> {
    let mut by_station = vec![(0_usize, 0.0); figures.stations.len()];
    for run in runs {
        // NaN where it waited nowhere.
        let station = run[figures.longest_at(order)];
        if station >= 0.0 {
            let own = &mut by_station[station as usize];
            *own = (own.0 + 1, own.1 + run[figures.longest_wait(order)]);
        }
    }
    // The last of equals is taken: from behind it is the first of the file.
    let places = (0..by_station.len()).rev().filter(|station| by_station[*station].0 > 0);
    let order = |station: &usize| by_station[*station];
    let station = places.max_by(|a, b| {
        let ((count_a, wait_a), (count_b, wait_b)) = (order(a), order(b));
        count_a.cmp(&count_b).then(wait_a.total_cmp(&wait_b))
    })?;
    let (replications, wait) = by_station[station];
    Some(LongestWait { station, replications, wait: wait / replications as f64 })
}

fn load_answer(figures: &Figures, runs: &[&[f64]], resource: usize, week: usize) -> LoadAnswer {
    let times = |run: &[f64]| LoadKind::ALL.map(|kind| run[figures.load(resource, week, kind)]);
    let means = LoadKind::ALL.map(|kind| mean(&runs.iter().map(|run| times(run)[kind as usize]).collect::<Vec<_>>()));
    let mut loads: Vec<f64> = runs.iter().map(|run| busy(&times(run))).filter(|load| load.is_finite()).collect();
    LoadAnswer { resource, week, means, high_load: upper(&mut loads, 0.9) }
}

fn queue_answer(scenario: &Scenario, figures: &Figures, runs: &[&[f64]], station: usize) -> QueueAnswer {
    let values_of = |figure: QueueFigure| -> Vec<f64> {
        runs.iter().map(|run| run[figures.queue(station, figure)]).filter(|value| value.is_finite()).collect()
    };
    let mean_of = |figure: QueueFigure| mean(&values_of(figure));
    let mut most = values_of(QueueFigure::MaximumLength);
    let length = mean_of(QueueFigure::MeanLength);
    QueueAnswer {
        machines: figures.stations[station].clone(),
        length,
        upper_length: mean_of(QueueFigure::UpperLength),
        longest: [mean(&most), upper(&mut most, 0.95)],
        wait: [mean_of(QueueFigure::MeanWait), mean_of(QueueFigure::UpperWait)],
        total: length * scenario.horizon,
    }
}

/// Quantile over the replications; NaN without values.
fn upper(values: &mut [f64], share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    rank_quantile(values, share)
}
