//! Sums over a part of the work of the shop: by part type, by customer, by station.

use super::histogram::Histogram;
use toolroom_scenario::Scenario;
use toolroom_shop::runlog::JobRow;

/// Part types that are told apart, by index: all but edges that are ground anew, where there are several.
pub(super) fn parts(scenario: &Scenario) -> Vec<usize> {
    let parts: Vec<usize> = (0..scenario.parts.len()).filter(|part| !scenario.is_regrind(*part)).collect();
    if parts.len() > 1 { parts } else { Vec::new() }
}

/// Customers of orders, in the order of their names.
pub(super) fn customers(scenario: &Scenario) -> Vec<&str> {
    let mut names: Vec<&str> =
        scenario.orders.iter().map(|order| order.customer.as_str()).filter(|name| !name.is_empty()).collect();
    names.sort_unstable();
    names.dedup();
    names
}

/// Machines of every station, by index, in the order of the machines.
pub(super) fn stations(scenario: &Scenario) -> Vec<Vec<usize>> {
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
    pub jobs: u32,
    pub tardy: u32,
    pub good: u32,
    /// Pieces that are finished: good ones, components that go into other parts, scrapped ones.
    pub finished: u32,
    pub scrapped: u32,
    pub lead_time: f64,
    pub lead_times: Histogram,
    pub in_process: f64,
    pub raw_time: f64,
    pub tardiness: f64,
    pub weighted_tardiness: f64,
    pub greatest_tardiness: f64,
    /// Integral of the number of its jobs in the shop.
    pub job_time: f64,
}

/// Everything by groups.
#[derive(Clone, Debug, Default)]
pub(super) struct Groups {
    pub parts: Vec<JobGroup>,
    /// Group of every part.
    pub part_of: Vec<Option<u32>>,
    pub customers: Vec<JobGroup>,
    /// Group of every order.
    pub customer_of: Vec<Option<u32>>,
    /// Machines of every station, by index.
    pub stations: Vec<Vec<usize>>,
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
        Self {
            part_of: (0..scenario.parts.len()).map(part_of).collect(),
            parts: vec![JobGroup::default(); parts.len()],
            customer_of: scenario.orders.iter().map(|order| customer(&order.customer)).collect(),
            customers: vec![JobGroup::default(); customers.len()],
            stations: stations(scenario),
        }
    }

    /// A job was in the shop in the window for this time, s; it left it `good`, or with so many pieces finished and scrapped, or
    /// is in it still.
    pub fn add(&mut self, job: &JobRow, time: f64, (good, [finished, scrapped]): (Option<&GoodJob>, [u32; 2])) {
        let customer = job.order.and_then(|order| self.customer_of[order as usize]);
        let part = self.part_of[job.part as usize].map(|group| &mut self.parts[group as usize]);
        let customer = customer.map(|group| &mut self.customers[group as usize]);
        for group in part.into_iter().chain(customer) {
            group.job_time += time;
            group.finished += finished;
            group.scrapped += scrapped;
            if let Some(good) = good {
                group.add_good(job, good);
            }
        }
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
        self.in_process += job.in_process;
        self.raw_time += good.raw_time;
        self.tardiness += late;
        self.weighted_tardiness += good.weight * late;
        self.greatest_tardiness = self.greatest_tardiness.max(late);
    }
}
