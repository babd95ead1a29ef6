//! Queues with exact answers, through the real shop: loading is the service.

use crate::scenarios::{self, machine, run};
use crate::statistics::Estimate;
use std::sync::Arc;
use toolroom_kernel::SimTime;
use toolroom_scenario::policies::ResolvedPolicy;
use toolroom_scenario::{
    Arrival, ArrivalPattern, DispatchRule, Distribution, Interruption, Scenario, Shift, ShiftCalendar, Work,
};
use toolroom_shop::{Shop, Silent};

fn queue(servers: usize, rate: f64, service: Distribution, customers: f64) -> Scenario {
    let mut shop = scenarios::scenario();
    let server = |index: usize| {
        let mut machine = machine(&format!("server {index}"));
        machine.load_time = service.clone();
        machine
    };
    shop.machines = (0..servers).map(server).collect();
    shop.parts[0].operations[0].machines = (0..servers).collect();
    shop.parts[0].operations[0].work = Work::Cutting(Vec::new());
    shop.arrivals = vec![Arrival::from_part(0, ArrivalPattern::Poisson { rate })];
    shop.horizon = customers / rate;
    shop
}

/// Waiting times of all customers that were served, in the order of arrival.
fn waits(shop: &Scenario) -> Vec<f64> {
    let log = run(shop);
    log.jobs.iter().map(|job| job.start - job.arrival).filter(|wait| wait.is_finite()).collect()
}

#[test]
fn one_server_waits_as_pollaczek_and_khinchine_say() {
    // λ = 0.8, mean service 1: Wq = λ E[S²] / (2 (1 - ρ)).
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let cases = [
        (Distribution::Exponential { mean: 1.0 }, 4.0),
        (Distribution::Constant(1.0), 2.0),
        (Distribution::Lognormal { mean: 1.0, cv: half }, 3.0),
    ];
    for (service, exact) in cases {
        let waits = waits(&queue(1, 0.8, service, 400_000.0));
        Estimate::of_series(&waits).assert_agrees("waiting time", exact, 0.03);
    }
}

#[test]
fn several_servers_wait_as_erlang_says() {
    for (servers, rate, exact) in [(2, 1.6, 1.777_778), (4, 3.2, 0.745_541)] {
        let service = Distribution::Exponential { mean: 1.0 };
        let waits = waits(&queue(servers, rate, service, 400_000.0));
        Estimate::of_series(&waits).assert_agrees("waiting time", exact, 0.03);
    }
}

#[test]
fn a_machine_that_stands_by_keeps_no_places_of_jobs_that_others_have_done() {
    for rule in [DispatchRule::Fifo, DispatchRule::ShortestProcessingTime, DispatchRule::CriticalRatio] {
        let mut shop = queue(2, 0.8, Distribution::Exponential { mean: 1.0 }, 20_000.0);
        let shifts = vec![Shift { start: 9e6, end: 9.1e6 }];
        shop.calendars = vec![ShiftCalendar::periodic("later", 1e7, shifts, Interruption::Resume)];
        shop.machines[1].calendar = Some(0);
        shop.dispatch = vec![rule];
        let policy = Arc::new(ResolvedPolicy::from_scenario(&shop, 0).unwrap());
        let mut running = Shop::with_recorder(&shop, policy, 0, Silent).unwrap();
        running.run_until(SimTime::from_seconds(shop.horizon).unwrap()).unwrap();
        let machines = &running.world().machines;
        let (works, stands_by) = (machines[0].queue.len(), machines[1].queue.len());
        assert!(stands_by < 1000, "{rule:?}: {stands_by} places, {works} jobs wait");
    }
}

#[test]
fn constant_work_in_process_gives_the_throughput_of_mean_value_analysis() {
    // Three exponential stations of mean 1, 0.8, 0.5 and three jobs: 0.756267 per unit time.
    let mut shop = scenarios::scenario();
    let stations = [1.0, 0.8, 0.5].into_iter().enumerate().map(|(index, mean)| {
        let mut machine = machine(&format!("station {index}"));
        machine.load_time = Distribution::Exponential { mean };
        machine
    });
    shop.machines = stations.collect();
    let mut step = shop.parts[0].operations[0].clone();
    step.work = Work::Cutting(Vec::new());
    shop.parts[0].operations = (0..3)
        .map(|index| {
            let mut step = step.clone();
            step.machines = vec![index];
            step
        })
        .collect();
    shop.arrivals = vec![Arrival::from_part(0, ArrivalPattern::ConstantWork { jobs: 3 })];
    shop.horizon = 200_000.0;
    let log = run(&shop);
    let mut counts = vec![0.0; 1000];
    for finish in log.jobs.iter().map(|job| job.finish).filter(|finish| finish.is_finite()) {
        counts[((finish / 200.0) as usize).min(999)] += 1.0 / 200.0;
    }
    Estimate::of_series(&counts).assert_agrees("throughput", 0.756_267, 0.005);
    // The work in process never changes.
    let in_shop = log.jobs.iter().filter(|job| job.finish.is_nan()).count();
    assert_eq!(in_shop, 3);
}
