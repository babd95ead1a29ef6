//! What a run grows older by, and work that differs: machines, sensors, passes, coolant, lots.

use crate::scenarios::{self, jobs_at, operation, run, tool};
use std::sync::Arc;
use toolroom_cutting::Turning;
use toolroom_effects::{Effect, Effects};
use toolroom_infeed::{Infeed, Input};
use toolroom_process::Process;
use toolroom_scenario::*;
use toolroom_shop::RunLog;

const TURN: f64 = 60.0 / 292.0;

fn effects(id: &str, size: f64) -> Effects {
    Effects::new(vec![Effect::named(id).unwrap().with_size(size)]).unwrap()
}

/// A grinder to which a part comes at each of `times`; 16 revolutions at 4.43 um.
fn grinder(infeed: Infeed, times: &[f64]) -> Scenario {
    let mut shop = scenarios::scenario();
    shop.horizon = 1e5;
    shop.tools = vec![tool(scenarios::eternal())];
    shop.tools[0].process = ProcessModel::Infeed(Arc::new(infeed));
    let phases = vec![GrindingPhase { infeed_per_rev: 4.43e-6, revolutions: 16 }];
    let work = Work::Grinding { work_rotation_speed: Input::default().work_rotation_speed, phases };
    shop.parts[0].operations = vec![Operation { work, ..operation(&[0], &[]) }];
    shop.arrivals = vec![jobs_at(&times.iter().map(|time| (*time, 1)).collect::<Vec<_>>())];
    shop
}

/// A lathe to which a part comes at each of `times`.
fn lathe(effects: Effects, times: &[f64]) -> Scenario {
    let mut shop = scenarios::scenario();
    shop.horizon = 1e5;
    shop.tools = vec![tool(scenarios::eternal())];
    shop.tools[0].process =
        ProcessModel::Turning(Arc::new(Turning { effects, ..Turning::named("c45_t15k6").unwrap() }));
    let mut turned = operation(&[0], &[120.0]);
    if let Work::Cutting(cuts) = &mut turned.work {
        cuts[0] = Cut { cutting_speed: 2.0, feed: 2e-4, depth_of_cut: 1e-3, ..cuts[0] };
    }
    shop.parts[0].operations = vec![turned];
    shop.arrivals = vec![jobs_at(&times.iter().map(|time| (*time, 1)).collect::<Vec<_>>())];
    shop
}

fn forces(log: &RunLog) -> Vec<f64> {
    log.passes.iter().map(|pass| pass.cutting_force).collect()
}

#[test]
fn a_machine_that_grows_softer_presses_less_later_in_the_day() {
    let infeed = Infeed { effects: effects("stiffness_drift", 0.3 / 3600.0), ..Infeed::default() };
    let times = [0.0, 3600.0, 9000.0];
    for (force, machine_time) in forces(&run(&grinder(infeed.clone(), &times))).iter().zip(times) {
        let mut part = infeed.initial();
        let input = Input { machine_time, ..Input::default() };
        infeed.advance(&mut part, &input, 16.0 * TURN).unwrap();
        let expected = infeed.output(&part, &input).normal_force;
        assert!((force - expected).abs() < 1e-6 * expected, "{machine_time}: {force} {expected}");
    }
}

#[test]
fn a_machine_whose_stiffness_has_drifted_away_stops_the_run_and_says_why() {
    let infeed = Infeed { effects: effects("stiffness_drift", 0.3 / 3600.0), ..Infeed::default() };
    let error = toolroom_shop::run(&grinder(infeed, &[0.0, 12_001.0]), 0, 0).unwrap_err().to_string();
    assert!(error.contains("stiffness_drift leaves nothing of it"), "{error}");
}

#[test]
fn another_coolant_acts_from_its_change_on() {
    let infeed = Infeed { effects: effects("coolant_change", 0.2), ..Infeed::default() };
    let mut shop = grinder(infeed, &[0.0, 5000.0]);
    let before = forces(&run(&shop));
    shop.machines[0].coolant_change = Some(5000.0);
    let after = forces(&run(&shop));
    assert_eq!(before[0], after[0]);
    assert!(after[1] < 0.99 * before[1], "{before:?} {after:?}");
}

#[test]
fn another_coolant_is_fresh() {
    let mut shop = lathe(effects("coolant_ageing", 0.1 / 3600.0), &[0.0, 7200.0]);
    let hot: Vec<f64> = run(&shop).passes.iter().map(|pass| pass.temperature).collect();
    shop.machines[0].coolant_change = Some(7200.0);
    let fresh: Vec<f64> = run(&shop).passes.iter().map(|pass| pass.temperature).collect();
    assert_eq!(hot[0], fresh[0]);
    assert!(fresh[1] < hot[1] - 20.0, "{hot:?} {fresh:?}");
}

#[test]
fn the_lot_that_deviates_is_harder_to_cut() {
    let mut shop = lathe(effects("lot_hardness", 0.3), &[0.0, 500.0, 1000.0]);
    shop.parts[0].batch_size = 1;
    let plain = forces(&run(&shop));
    shop.parts[0].deviating_lot = Some(2);
    let log = run(&shop);
    assert_eq!(log.jobs.iter().map(|job| job.lot).collect::<Vec<_>>(), [1, 2, 3]);
    let ratio: Vec<f64> = forces(&log).iter().zip(&plain).map(|(hard, plain)| hard / plain).collect();
    assert_eq!(ratio[0], 1.0);
    // The cut is 1.3 times as hard, and the land it leaves a little wider.
    assert!((1.25..1.35).contains(&ratio[1]), "{ratio:?}");
    assert!((1.0..1.05).contains(&ratio[2]), "{ratio:?}");
}

#[test]
fn a_sensor_drifts_over_the_run_and_lags_within_a_pass() {
    let times = [0.0, 7200.0];
    let plain = run(&lathe(Effects::default(), &times));
    let drifting = forces(&run(&lathe(effects("force_drift", 0.01 / 3600.0), &times)));
    for ((drifting, pass), time) in drifting.iter().zip(&plain.passes).zip(times) {
        let expected = pass.cutting_force * (1.0 + 0.01 * time / 3600.0);
        assert!((drifting / expected - 1.0).abs() < 1e-9, "{drifting} {expected}");
    }
    let lagging = run(&lathe(effects("temperature_lag", 40.0), &times));
    let behind = plain.passes[0].temperature - lagging.passes[0].temperature;
    assert!(behind > 0.0 && behind < 20.0, "a pass of a minute lets it come nearer: {behind} K");
}
