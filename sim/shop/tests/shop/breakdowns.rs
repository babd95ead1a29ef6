//! Breakdowns against exact results.

use crate::scenarios::{self, operation, run, time_in};
use crate::statistics::Estimate;
use toolroom_scenario::{
    Arrival, ArrivalPattern, Distribution, FailureClock, FailureMode, Interruption, Scenario, Work,
};
use toolroom_shop::runlog::{LogEvent, MachineState, RunLog};

/// Poisson arrivals at rate 0.6, exponential work of mean 1, failures at rate 0.05 while busy,
/// repairs at rate 0.5.
fn failing_server(part: Interruption) -> Scenario {
    let mut shop = scenarios::scenario();
    shop.machines[0].load_time = Distribution::Exponential { mean: 1.0 };
    shop.parts[0].operations[0].work = Work::Cutting(Vec::new());
    shop.arrivals = vec![Arrival::from_part(0, ArrivalPattern::Poisson { rate: 0.6 })];
    shop.failures = vec![FailureMode {
        name: None,
        machine: 0,
        time_between: Distribution::Exponential { mean: 20.0 },
        time_to_repair: Distribution::Exponential { mean: 2.0 },
        clock: FailureClock::Busy,
        crew: None,
        part,
    }];
    shop.horizon = 500_000.0;
    shop
}

#[test]
fn work_that_resumes_after_repair_takes_the_exact_time() {
    // Completion time 1·(1 + 0.05/0.5) = 1.1; time in the system 3.58824.
    let log = run(&failing_server(Interruption::Resume));
    let finished = || log.jobs.iter().filter(|job| job.finish.is_finite());
    let completion: Vec<f64> = finished().map(|job| job.finish - job.start).collect();
    Estimate::of_series(&completion).assert_agrees("completion time", 1.1, 0.01);
    let system: Vec<f64> = finished().map(|job| job.finish - job.arrival).collect();
    Estimate::of_series(&system).assert_agrees("time in the system", 3.588_24, 0.02);
}

#[test]
fn scrapped_work_leaves_at_the_failure() {
    // Failure or end, whichever is first: a share 1/(1 + 20) of exponential work is scrapped.
    let log = run(&failing_server(Interruption::Scrap));
    let scrapped = |log: &RunLog| -> Vec<f64> {
        let ended = log.jobs.iter().filter(|job| job.finish.is_finite());
        ended.map(|job| f64::from(u8::from(job.outcome == toolroom_shop::runlog::JobOutcome::Breakdown))).collect()
    };
    Estimate::of_series(&scrapped(&log)).assert_agrees("share of scrap", 1.0 / 21.0, 0.02);
}

#[test]
fn a_calendar_clock_gives_the_availability_of_an_alternating_process() {
    let mut shop = scenarios::scenario();
    shop.arrivals.clear();
    shop.failures = vec![FailureMode {
        name: None,
        machine: 0,
        time_between: Distribution::Weibull { mean: 300.0, shape: 2.0 },
        time_to_repair: Distribution::Lognormal { mean: 30.0, cv: 1.0 },
        clock: FailureClock::Calendar,
        crew: None,
        part: Interruption::Resume,
    }];
    shop.horizon = 100_000.0;
    let availability: Vec<f64> = (0..200)
        .map(|replication| {
            let log = toolroom_shop::run(&shop, 0, replication).unwrap();
            1.0 - time_in(&log, 0, MachineState::Down) / shop.horizon
        })
        .collect();
    // The run starts up: within 1e-3 of the long-run value over 300 cycles.
    let Estimate { mean, standard_error } = Estimate::of_independent(&availability);
    assert!((mean - 300.0 / 330.0).abs() < 4.0 * standard_error + 1e-3, "{mean} ± {standard_error}");
    assert!(standard_error < 1e-3);
}

#[test]
fn failures_do_not_depend_on_what_else_the_shop_does() {
    let mut shop = scenarios::scenario();
    shop.failures = vec![FailureMode {
        name: None,
        machine: 0,
        time_between: Distribution::Exponential { mean: 100.0 },
        time_to_repair: Distribution::Exponential { mean: 10.0 },
        clock: FailureClock::Calendar,
        crew: None,
        part: Interruption::Resume,
    }];
    let times = |shop: &Scenario| -> Vec<f64> {
        let log = run(shop);
        log.events.iter().filter(|row| row.event == LogEvent::Failure).map(|row| row.time).collect()
    };
    let alone = times(&shop);
    assert!(alone.len() > 3);
    shop.parts[0].operations.push(operation(&[0], &[3.0, 4.0]));
    shop.arrivals[0] = scenarios::jobs_at(&[(0.0, 30)]);
    assert_eq!(alone, times(&shop));
}
