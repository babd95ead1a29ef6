//! Key figures of a part of the work of the shop: by part type, by customer, by station.

use super::definition::Better::{Less, More, Neither};
use super::definition::{Definition, define};
use super::histogram::Histogram;
use super::machine_tally::MachineTally;
use super::tally::Tally;
use toolroom_scenario::{Scenario, station_name};
use toolroom_shop::runlog::JobRow;

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
        let part = OF_PART.iter().map(|(definition, _)| definition);
        let stations = OF_STATION.iter().map(|(definition, _)| definition);
        let is = move |kind: Self| kind == self;
        let of_jobs = jobs.filter(move |_| !is(Self::Station));
        of_jobs.chain(part.filter(move |_| is(Self::Part))).chain(stations.filter(move |_| is(Self::Station)))
    }
}

/// Number of figures by groups of a scenario, as [`Counting::group_values`](super::Counting::group_values) has them.
pub fn group_values_len(scenario: &Scenario) -> usize {
    GroupKind::ALL.into_iter().map(|kind| kind.groups(scenario).len() * kind.definitions().count()).sum()
}

/// Part types that are told apart, by index: all but edges that are ground anew, where there are several.
fn parts(scenario: &Scenario) -> Vec<usize> {
    let parts: Vec<usize> = (0..scenario.parts.len()).filter(|part| !scenario.is_regrind(*part)).collect();
    if parts.len() > 1 { parts } else { Vec::new() }
}

/// Customers of orders, in the order of their names.
fn customers(scenario: &Scenario) -> Vec<&str> {
    let mut names: Vec<&str> =
        scenario.orders.iter().map(|order| order.customer.as_str()).filter(|name| !name.is_empty()).collect();
    names.sort_unstable();
    names.dedup();
    names
}

/// Machines of every station, by index, in the order of the machines.
fn stations(scenario: &Scenario) -> Vec<Vec<usize>> {
    let machines = |machines: &Vec<usize>| {
        let mut machines = machines.clone();
        machines.sort_unstable();
        machines
    };
    let operations = scenario.parts.iter().flat_map(|part| &part.operations);
    let mut stations: Vec<Vec<usize>> = operations.map(|operation| machines(&operation.machines)).collect();
    stations.sort();
    stations.dedup();
    stations
}

/// Sums over the good jobs of a group that left in the window, times in s.
#[derive(Clone, Debug, Default)]
pub(super) struct JobGroup {
    jobs: u32,
    tardy: u32,
    good: u32,
    scrapped: u32,
    lead_time: f64,
    lead_times: Histogram,
    raw_time: f64,
    tardiness: f64,
    weighted_tardiness: f64,
    greatest_tardiness: f64,
    /// Integral of the number of its jobs in the shop.
    job_time: f64,
    /// Of it the time in which an operation of the job was in process.
    operation_time: f64,
}

/// Sums over the operations of a station that were begun in the window.
#[derive(Clone, Debug, Default)]
pub(super) struct Station {
    begun: u32,
    waited: f64,
    waits: Histogram,
    /// Its machines, by index.
    machines: Vec<usize>,
}

/// Everything by groups.
#[derive(Clone, Debug, Default)]
pub(super) struct Groups {
    parts: Vec<JobGroup>,
    /// Group of every part.
    part_of: Vec<Option<u32>>,
    customers: Vec<JobGroup>,
    /// Group of every order.
    customer_of: Vec<Option<u32>>,
    stations: Vec<Station>,
}

/// A good job that left the shop.
pub(super) struct GoodJob {
    /// What its work takes as programmed, s.
    pub raw_time: f64,
    /// Weight of its order or source; NaN where nobody knows it.
    pub weight: f64,
}

impl Groups {
    pub fn new(scenario: &Scenario) -> Self {
        let (parts, customers) = (parts(scenario), customers(scenario));
        let part_of = |part: usize| parts.iter().position(|own| *own == part).map(|place| place as u32);
        let customer = |name: &str| customers.iter().position(|own| *own == name).map(|place| place as u32);
        let station = |machines: Vec<usize>| Station { machines, ..Station::default() };
        Self {
            part_of: (0..scenario.parts.len()).map(part_of).collect(),
            parts: vec![JobGroup::default(); parts.len()],
            customer_of: scenario.orders.iter().map(|order| customer(&order.customer)).collect(),
            customers: vec![JobGroup::default(); customers.len()],
            stations: stations(scenario).into_iter().map(station).collect(),
        }
    }

    /// Station of every operation of every part.
    pub fn station_of(&self, machines: &[usize]) -> u32 {
        let mut machines = machines.to_vec();
        machines.sort_unstable();
        self.stations.iter().position(|own| own.machines == machines).unwrap_or(0) as u32
    }

    /// An operation was begun after its job had waited, s.
    #[inline]
    pub fn begin(&mut self, station: u32, waited: f64) {
        let own = &mut self.stations[station as usize];
        own.begun += 1;
        own.waited += waited;
        own.waits.add(waited);
    }

    /// An operation of a part was in process in the window for this time, s.
    #[inline]
    pub fn work(&mut self, part: u32, time: f64) {
        if let Some(group) = self.part_of[part as usize] {
            self.parts[group as usize].operation_time += time;
        }
    }

    /// A job was in the shop in the window for this time, s, and left it, good with `left`, or is in it still.
    pub fn add(&mut self, job: &JobRow, time: f64, (good, scrapped): (Option<&GoodJob>, u32)) {
        let customer = job.order.and_then(|order| self.customer_of[order as usize]);
        let part = self.part_of[job.part as usize].map(|group| &mut self.parts[group as usize]);
        let customer = customer.map(|group| &mut self.customers[group as usize]);
        for group in part.into_iter().chain(customer) {
            group.job_time += time;
            group.scrapped += scrapped;
            if let Some(good) = good {
                group.add_good(job, good);
            }
        }
    }

    /// Values of the groups of every kind, of each its figures, SI; NaN where one is not defined.
    pub fn values(&self, tally: &Tally) -> Vec<f64> {
        let finite = |value: f64| if value.is_finite() { value } else { f64::NAN };
        let of_jobs = |own: &JobGroup| OF_JOBS.map(|(_, value)| value(tally.window, own));
        let of_part = |own: &JobGroup| OF_PART.map(|(_, value)| value(tally.window, own));
        let parts = self.parts.iter().flat_map(|own| of_jobs(own).into_iter().chain(of_part(own)));
        let customers = self.customers.iter().flat_map(of_jobs);
        let stations = self.stations.iter().flat_map(|own| OF_STATION.map(|(_, value)| value(tally, own)));
        parts.chain(customers).chain(stations).map(finite).collect()
    }
}

impl JobGroup {
    fn add_good(&mut self, job: &JobRow, good: &GoodJob) {
        let (lead_time, late) = (job.finish - job.arrival, (job.finish - job.due).max(0.0));
        self.jobs += 1;
        self.good += job.quantity;
        self.tardy += u32::from(job.finish > job.due);
        self.lead_time += lead_time;
        self.lead_times.add(lead_time);
        self.raw_time += good.raw_time;
        self.tardiness += late;
        self.weighted_tardiness += good.weight * late;
        self.greatest_tardiness = self.greatest_tardiness.max(late);
    }
}

impl Station {
    fn sum(&self, tally: &Tally, of: fn(&MachineTally) -> f64) -> f64 {
        self.machines.iter().map(|machine| of(&tally.machines[*machine])).sum()
    }
}

/// A figure of a group of jobs from the length of the window, s, and its sums.
type JobFigure = (Definition, fn(f64, &JobGroup) -> f64);

/// Figures of part types and customers.
const OF_JOBS: [JobFigure; 10] = [
    (define("good", "good parts", "1", "1", More, "Good parts."), |_, own| f64::from(own.good)),
    (define("scrap_rate", "scrap", "1", "%", Less, "Scrapped over finished parts."), |_, own| {
        f64::from(own.scrapped) / f64::from(own.good + own.scrapped)
    }),
    (define("lead_time", "lead time", "s", "min", Less, "Mean time from arrival to finish of good jobs."), |_, own| {
        own.lead_time / f64::from(own.jobs)
    }),
    (
        define(
            "lead_time_p95",
            "lead time, 95 %",
            "s",
            "min",
            Less,
            "Lead time that 95 % of the good jobs do not exceed, within 0.4 %.",
        ),
        |_, own| own.lead_times.quantile(0.95),
    ),
    (
        define(
            "flow_factor",
            "flow factor",
            "1",
            "1",
            Less,
            "Lead time over the programmed time of the good jobs on the first machine of each operation, without setup.",
        ),
        |_, own| own.lead_time / own.raw_time,
    ),
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

/// Figures of part types alone, of which operations are known.
const OF_PART: [JobFigure; 1] = [(
    define(
        "queue_time",
        "queue time",
        "s",
        "min",
        Less,
        "Time in the shop without an operation in process, per good job.",
    ),
    |_, own| (own.job_time - own.operation_time).max(0.0) / f64::from(own.jobs),
)];

/// A figure of a station.
type StationFigure = (Definition, fn(&Tally, &Station) -> f64);

/// Figures of stations.
const OF_STATION: [StationFigure; 7] = [
    (define("begun", "operations begun", "1", "1", Neither, "Operations begun in the window."), |_, own| {
        f64::from(own.begun)
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
        |_, own| own.waited / f64::from(own.begun),
    ),
    (
        define(
            "queue_wait_p95",
            "wait in the queue, 95 %",
            "s",
            "min",
            Less,
            "Such a time that 95 % of the operations do not exceed, within 0.4 %.",
        ),
        |_, own| own.waits.quantile(0.95),
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
        |t, own| own.sum(t, |machine| machine.good),
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
        |t, own| own.sum(t, MachineTally::production_time) / own.sum(t, MachineTally::planned_busy_time),
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
            let setup = own.sum(t, MachineTally::setup_time);
            setup / (own.sum(t, MachineTally::production_time) + setup)
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
        |t, own| own.sum(t, MachineTally::busy_time) / own.sum(t, MachineTally::planned_busy_time),
    ),
];
