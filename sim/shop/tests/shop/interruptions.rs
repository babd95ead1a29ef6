//! What becomes of work that is interrupted, to the second.

use crate::scenarios::{self, Rubbing, jobs_at, operation, run, time_in, tool};
use toolroom_scenario::{Distribution, FailureClock, FailureMode, Interruption, Scenario};
use toolroom_shop::runlog::{JobOutcome, LogEvent, MachineState};

/// One job of load 5, passes 10 and 20, unload 5; one failure at 22, in the second pass, of 100 s.
fn shop(part: Interruption) -> Scenario {
    let mut shop = scenarios::scenario();
    shop.machines[0].load_time = Distribution::Constant(5.0);
    shop.machines[0].unload_time = Distribution::Constant(5.0);
    shop.tools = vec![tool(Rubbing { wear_per_path: 0.001, wear_limit: 1.0, breaks_at: 2.0 })];
    shop.parts[0].operations = vec![operation(&[0], &[10.0, 20.0])];
    shop.failures = vec![FailureMode {
        name: None,
        machine: 0,
        time_between: Distribution::Constant(22.0),
        time_to_repair: Distribution::Constant(100.0),
        clock: FailureClock::Calendar,
        crew: None,
        part,
    }];
    shop.horizon = 143.0;
    shop
}

#[test]
fn resumed_work_keeps_what_was_cut() {
    let mut shop = shop(Interruption::Resume);
    shop.horizon = 141.0; // up again at 122, 13 s of pass and 5 s of unloading left, next failure at 144
    let log = run(&shop);
    assert_eq!((log.jobs[0].outcome, log.jobs[0].finish), (JobOutcome::Good, 140.0));
    assert_eq!(log.passes.len(), 2);
    let pass = log.passes[1];
    assert_eq!((pass.start, pass.end, pass.cutting_time, pass.path), (15.0, 135.0, 20.0, 20.0));
    assert!((pass.flank_wear_end - 0.030).abs() < 1e-12);
    assert_eq!(time_in(&log, 0, MachineState::Down), 100.0);
}

#[test]
fn repeated_work_is_cut_again_by_a_more_worn_edge() {
    let log = run(&shop(Interruption::Repeat));
    assert_eq!(log.jobs[0].outcome, JobOutcome::InProcess); // 122 + 5 + 10, then 6 s into pass 1
    let passes: Vec<(u32, f64)> = log.passes.iter().map(|row| (row.pass, row.cutting_time)).collect();
    assert_eq!(passes, [(0, 10.0), (1, 7.0), (0, 10.0), (1, 6.0)]);
    assert!((log.edges[0].flank_wear - 0.033).abs() < 1e-12);
}

#[test]
fn scrapped_work_leaves_and_the_machine_takes_the_next_job() {
    let mut shop = shop(Interruption::Scrap);
    shop.arrivals[0] = jobs_at(&[(0.0, 2)]);
    let log = run(&shop);
    assert_eq!((log.jobs[0].outcome, log.jobs[0].finish), (JobOutcome::Breakdown, 22.0));
    assert_eq!((log.jobs[1].outcome, log.jobs[1].start), (JobOutcome::InProcess, 122.0));
}

#[test]
fn a_busy_clock_stands_while_the_machine_waits() {
    let mut shop = shop(Interruption::Resume);
    shop.failures[0].clock = FailureClock::Busy;
    shop.arrivals[0] = jobs_at(&[(1000.0, 1)]);
    shop.horizon = 2000.0;
    let log = run(&shop);
    let failures: Vec<f64> =
        log.events.iter().filter(|row| row.event == LogEvent::Failure).map(|row| row.time).collect();
    assert_eq!(failures, [1022.0]); // 22 s busy; the 18 s left after repair are too short for another
    assert_eq!(log.jobs[0].finish, 1140.0);
}

#[test]
fn a_failure_at_the_end_of_a_step_finds_it_done() {
    let mut shop = shop(Interruption::Scrap);
    shop.failures[0].time_between = Distribution::Constant(15.0); // the end of the first pass
    shop.horizon = 100.0;
    let log = run(&shop);
    assert_eq!(log.passes.len(), 2);
    assert_eq!((log.passes[0].cutting_time, log.passes[1].cutting_time), (10.0, 0.0));
    shop.failures[0].time_between = Distribution::Constant(40.0); // the end of the job
    let log = run(&shop);
    assert_eq!((log.jobs[0].outcome, log.jobs[0].finish), (JobOutcome::Good, 40.0));
}

#[test]
fn a_breakdown_that_lets_the_part_be_finished_is_refused() {
    let error = toolroom_shop::run(&shop(Interruption::Finish), 0, 0).unwrap_err();
    assert!(error.to_string().contains("resume, repeat or scrap"), "{error}");
}
