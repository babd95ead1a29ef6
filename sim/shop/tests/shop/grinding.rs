//! Plunge grinding in the shop: phases, wheel state over parts, dressing, burn.

use crate::scenarios::{self, jobs_at, operation, run, time_in, tool};
use std::sync::Arc;
use toolroom_infeed::{Infeed, Input};
use toolroom_process::{Process, ProcessEvent};
use toolroom_scenario::*;
use toolroom_shop::runlog::{ChangeReason, JobOutcome, LogEvent, MachineState};

const TURN: f64 = 60.0 / 292.0;

/// 16 revolutions at 4.43 um, 4 of spark-out, at 292 rpm.
fn grinder(infeed: Infeed, jobs: u32) -> Scenario {
    let mut shop = scenarios::scenario();
    shop.tools = vec![tool(scenarios::eternal())];
    shop.tools[0].process = ProcessModel::Infeed(Arc::new(infeed));
    shop.tools[0].dressing_time = 90.0;
    let phase = |infeed_per_rev, revolutions| GrindingPhase { infeed_per_rev, revolutions };
    let work = Work::Grinding {
        work_rotation_speed: Input::default().work_rotation_speed,
        phases: vec![phase(4.43e-6, 16), phase(0.0, 4)],
    };
    shop.parts[0].operations = vec![Operation { work, ..operation(&[0], &[]) }];
    shop.arrivals = vec![jobs_at(&[(0.0, jobs)])];
    shop
}

#[test]
fn a_cycle_in_the_shop_is_the_cycle_of_the_process() {
    let infeed = Infeed::default();
    let log = run(&grinder(infeed.clone(), 2));
    assert_eq!(log.passes.len(), 4);
    let mut input = Input::default();
    let mut part = infeed.initial();
    infeed.advance(&mut part, &input, 16.0 * TURN).unwrap();
    let rough = infeed.output(&part, &input);
    input.infeed_per_rev = 0.0;
    infeed.advance(&mut part, &input, 4.0 * TURN).unwrap();
    let spark = infeed.output(&part, &input);
    for (row, expected) in log.passes.iter().zip([rough, spark]) {
        assert!((row.size_error - expected.size_error).abs() < 1e-12);
        assert!((row.cutting_force - expected.normal_force).abs() < 1e-6);
    }
    // The paper's force after the rough phase, 170 N, and its lag of 5.48 um.
    assert!((log.passes[0].cutting_force - 170.0).abs() < 0.1, "{}", log.passes[0].cutting_force);
    assert!((log.passes[0].size_error - 5.48e-6).abs() < 0.02e-6, "{}", log.passes[0].size_error);
    assert!((log.jobs[0].finish - 20.0 * TURN).abs() < 1e-9);
}

#[test]
fn a_dull_wheel_is_dressed_after_the_part() {
    let mut infeed = Infeed::default();
    let per_part = {
        let mut part = infeed.initial();
        infeed.advance(&mut part, &Input::default(), 16.0 * TURN).unwrap();
        part.removed_volume
    };
    infeed.parameters.dressing_limit = 2.5 * per_part;
    let log = run(&grinder(infeed, 9));
    let reasons: Vec<(u32, ChangeReason)> = log.edges.iter().map(|edge| (edge.parts, edge.reason)).collect();
    use ChangeReason::{Dressing, EndOfRun};
    assert_eq!(reasons, [(3, Dressing), (3, Dressing), (3, Dressing), (0, EndOfRun)]);
    assert_eq!(time_in(&log, 0, MachineState::Dressing), 3.0 * 90.0);
    assert_eq!(log.events.iter().filter(|row| row.event == LogEvent::Dressing).count(), 3);
}

#[test]
fn a_burnt_part_is_scrapped() {
    let mut infeed = Infeed::default();
    infeed.parameters.burn_temperature_rise = 300.0; // the rough phase heats by 585 K
    let log = run(&grinder(infeed, 3));
    assert!(log.jobs.iter().all(|job| job.outcome == JobOutcome::Burnt));
    assert!(log.events.iter().any(|row| row.event == LogEvent::Cut(ProcessEvent::Burn)));
}

#[test]
fn an_interrupted_phase_gives_the_same_part() {
    let whole = run(&grinder(Infeed::default(), 1));
    let mut shop = grinder(Infeed::default(), 1);
    shop.failures = vec![FailureMode {
        name: None,
        machine: 0,
        time_between: Distribution::Constant(1.234),
        time_to_repair: Distribution::Constant(50.0),
        clock: FailureClock::Busy,
        crew: None,
        part: Interruption::Resume,
    }];
    let parts = run(&shop);
    assert!(parts.events.iter().filter(|row| row.event == LogEvent::Failure).count() >= 3);
    for (a, b) in whole.passes.iter().zip(&parts.passes) {
        assert!((a.size_error - b.size_error).abs() < 1e-12 && (a.cutting_time - b.cutting_time).abs() < 1e-9);
    }
}
