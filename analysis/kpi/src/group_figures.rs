//! Key figures of a part of the work of the shop: by part type, by customer, by station.

use super::definition::Better::{Less, More, Neither};
use super::definition::{Definition, define};
use super::delivery_figures::{FLOW_FACTOR, LEAD_TIME_P95, QUEUE_TIME, queue_time};
use super::groups::{JobGroup, customers, parts, stations};
use super::machine_tally::MachineTally;
use super::tally::Tally;
use toolroom_scenario::{Scenario, station_name};

/// By what figures are told apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GroupKind {
    /// Part types.
    Part,
    /// Customers of orders.
    Customer,
    /// Stations: machines that do the same operations.
    Station,
}

impl GroupKind {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Part, Self::Customer, Self::Station];

    /// Name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Part => "part",
            Self::Customer => "customer",
            Self::Station => "station",
        }
    }

    /// Groups of a kind by name: part types where there are several, customers that are named, all stations.
    pub fn groups(self, scenario: &Scenario) -> Vec<String> {
        match self {
            Self::Part => parts(scenario).iter().map(|part| scenario.parts[*part].name.clone()).collect(),
            Self::Customer => customers(scenario).into_iter().map(str::to_owned).collect(),
            Self::Station => {
                let named = |machines: &Vec<usize>| {
                    station_name(machines.iter().map(|machine| scenario.machines[*machine].name.as_str()))
                };
                stations(scenario).iter().map(named).collect()
            }
        }
    }

    /// What is known of each group.
    pub fn definitions(self) -> impl Iterator<Item = &'static Definition> {
        let jobs = OF_JOBS.iter().map(|(definition, _)| definition);
        let stations = OF_STATION.iter().map(|(definition, _)| definition);
        let is = move |kind: Self| kind == self;
        let of_jobs = jobs.filter(move |_| !is(Self::Station));
        of_jobs
            .chain(std::iter::once(&QUEUE_TIME).filter(move |_| is(Self::Part)))
            .chain(stations.filter(move |_| is(Self::Station)))
    }
}

/// Number of figures by groups of a scenario, as [`Counting::group_values`](super::Counting::group_values) has them.
pub fn group_values_len(scenario: &Scenario) -> usize {
    GroupKind::ALL.into_iter().map(|kind| kind.groups(scenario).len() * kind.definitions().count()).sum()
}

/// Values of the groups of every kind, of each its figures, SI; NaN where one is not defined.
pub(super) fn group_values(tally: &Tally) -> Vec<f64> {
    let groups = &tally.groups;
    let finite = |value: f64| if value.is_finite() { value } else { f64::NAN };
    let of_jobs = |own: &JobGroup| OF_JOBS.map(|(_, value)| value(tally.window, own));
    let of_part =
        |own: &JobGroup| of_jobs(own).into_iter().chain([queue_time(own.lead_time, own.in_process, own.jobs)]);
    let parts = groups.parts.iter().flat_map(of_part);
    let customers = groups.customers.iter().flat_map(of_jobs);
    let stations = groups.stations.iter().flat_map(|own| OF_STATION.map(|(_, value)| value(tally, own)));
    parts.chain(customers).chain(stations).map(finite).collect()
}

/// Sum over the machines of a station.
fn sum(tally: &Tally, station: &[usize], of: fn(&MachineTally) -> f64) -> f64 {
    station.iter().map(|machine| of(&tally.machines[*machine])).sum()
}

/// A figure of a group of jobs from the length of the window, s, and its sums.
type JobFigure = (Definition, fn(f64, &JobGroup) -> f64);

/// Figures of part types and customers.
const OF_JOBS: [JobFigure; 10] = [
    (define("good", "good parts", "1", "1", More, "Good parts."), |_, own| f64::from(own.good)),
    (define("scrap_rate", "scrap", "1", "%", Less, "Scrapped over finished parts, components included."), |_, own| {
        f64::from(own.scrapped) / f64::from(own.finished)
    }),
    (define("lead_time", "lead time", "s", "min", Less, "Mean time from arrival to finish of good jobs."), |_, own| {
        own.lead_time / f64::from(own.jobs)
    }),
    (LEAD_TIME_P95, |_, own| own.lead_times.quantile(0.95)),
    (FLOW_FACTOR, |_, own| own.lead_time / own.raw_time),
    (define("tardiness", "tardiness", "s", "min", Less, "Mean of max(0, finish − due) of good jobs."), |_, own| {
        own.tardiness / f64::from(own.jobs)
    }),
    (
        define(
            "weighted_tardiness",
            "weighted tardiness",
            "s",
            "min",
            Less,
            "Mean of weight times max(0, finish − due) of good jobs.",
        ),
        |_, own| own.weighted_tardiness / f64::from(own.jobs),
    ),
    (
        define("greatest_tardiness", "greatest tardiness", "s", "min", Less, "Greatest max(0, finish − due)."),
        |_, own| if own.jobs > 0 { own.greatest_tardiness } else { f64::NAN },
    ),
    (
        define("tardy_share", "tardy jobs", "1", "%", Less, "Share of good jobs that finished after they were due."),
        |_, own| f64::from(own.tardy) / f64::from(own.jobs),
    ),
    (
        define("wip", "work in process", "1", "1", Less, "Time average of the number of jobs in the shop."),
        |window, own| own.job_time / window,
    ),
];

/// A figure of a station.
type StationFigure = (Definition, fn(&Tally, &[usize]) -> f64);

/// Figures of stations.
const OF_STATION: [StationFigure; 6] = [
    (define("begun", "operations begun", "1", "1", Neither, "Operations begun in the window."), |t, own| {
        sum(t, own, |machine| machine.begun)
    }),
    (
        define(
            "queue_wait",
            "wait in the queue",
            "s",
            "min",
            Less,
            "Mean time from when a job comes to the queue to the beginning of its operation, of operations begun in the window.",
        ),
        |t, own| sum(t, own, |machine| machine.waited) / sum(t, own, |machine| machine.begun),
    ),
    (
        define(
            "good_operations",
            "good operations",
            "1",
            "1",
            More,
            "Pieces of good operations completed, all machines.",
        ),
        |t, own| sum(t, own, |machine| machine.good),
    ),
    (
        define(
            "availability",
            "availability",
            "1",
            "1",
            More,
            "Production time over planned busy time, all machines of the station.",
        ),
        |t, own| sum(t, own, MachineTally::production_time) / sum(t, own, MachineTally::planned_busy_time),
    ),
    (
        define(
            "setup_ratio",
            "setup ratio",
            "1",
            "%",
            Less,
            "Setup over production and setup, all machines of the station.",
        ),
        |t, own| {
            let setup = sum(t, own, MachineTally::setup_time);
            setup / (sum(t, own, MachineTally::production_time) + setup)
        },
    ),
    (
        define(
            "allocation_ratio",
            "allocation",
            "1",
            "%",
            Neither,
            "Busy time (production, setup and delay) over planned busy time, all machines of the station.",
        ),
        |t, own| sum(t, own, MachineTally::busy_time) / sum(t, own, MachineTally::planned_busy_time),
    ),
];
