//! Edges: when they are changed, what that costs, what it does to the part.

use crate::scenarios::{self, Rubbing, jobs_at, operation, run, time_in, tool};
use std::sync::Arc;
use toolroom_cutting::{Milling, MillingInput};
use toolroom_process::{Process, ProcessEvent};
use toolroom_scenario::{Cut, ProcessModel, Scenario, ToolChangeRule, Work};
use toolroom_shop::runlog::{ChangeReason, JobOutcome, LogEvent, MachineState, RunLog};

/// Twelve parts of two passes of 10 m at 1 mm wear per metre.
fn shop(rule: ToolChangeRule) -> Scenario {
    let mut shop = scenarios::scenario();
    shop.tools = vec![tool(Rubbing { wear_per_path: 0.001, wear_limit: 0.055, breaks_at: 1.0 })];
    shop.parts[0].operations = vec![operation(&[0], &[10.0, 10.0])];
    shop.arrivals[0] = jobs_at(&[(0.0, 12)]);
    shop.policies[0].tool_change = rule;
    shop
}

fn passes_and_reasons(log: &RunLog) -> Vec<(u32, ChangeReason)> {
    log.edges.iter().map(|edge| (edge.passes, edge.reason)).collect()
}

const NEVER: ToolChangeRule = ToolChangeRule::PartCount { parts: u32::MAX };

#[test]
fn an_edge_past_its_wear_limit_finishes_the_pass_and_goes() {
    let log = run(&shop(NEVER));
    use ChangeReason::{EndOfRun, WearLimit};
    let expected = [(6, WearLimit), (6, WearLimit), (6, WearLimit), (6, WearLimit), (0, EndOfRun)];
    assert_eq!(passes_and_reasons(&log), expected);
    assert!(log.edges[..4].iter().all(|edge| (edge.flank_wear - 0.06).abs() < 1e-12 && edge.parts == 3));
    let crossings: Vec<f64> = log
        .events
        .iter()
        .filter(|row| row.event == LogEvent::Cut(ProcessEvent::WearLimit))
        .map(|row| row.time)
        .collect();
    assert!((crossings[0] - 55.0).abs() < 1e-9);
    // Changes count as tool change time, between passes.
    assert!((time_in(&log, 0, MachineState::ToolChange) - 4.0 * 7.0).abs() < 1e-9);
}

#[test]
fn an_edge_that_is_mounted_past_its_wear_limit_is_found_after_its_first_pass() {
    let mut shop = shop(NEVER);
    shop.tools[0].scatter.initial_wear = 0.06e-3;
    shop.tools[0].process =
        ProcessModel::Other(Arc::new(Rubbing { wear_per_path: 1e-9, wear_limit: 0.055e-3, breaks_at: 1.0 }));
    let log = run(&shop);
    // Twelve parts of two passes, an edge a pass.
    assert_eq!(passes_and_reasons(&log)[..24], [(1, ChangeReason::WearLimit); 24]);
    let crossings: Vec<f64> = log
        .events
        .iter()
        .filter(|row| row.event == LogEvent::Cut(ProcessEvent::WearLimit))
        .map(|row| row.time)
        .collect();
    assert_eq!((crossings.len(), crossings[0]), (24, 0.0));
}

#[test]
fn part_count_and_cutting_time_change_before_the_next_pass() {
    let log = run(&shop(ToolChangeRule::PartCount { parts: 2 }));
    assert_eq!(log.edges.len(), 6);
    assert!(log.edges.iter().all(|edge| edge.passes == 4 && edge.parts == 2));
    assert_eq!(log.edges[5].reason, ChangeReason::EndOfRun);
    let log = run(&shop(ToolChangeRule::CuttingTime { time: 35.0 }));
    assert_eq!(log.edges.len(), 8);
    assert!(log.edges.iter().all(|edge| edge.passes == 3 && edge.cutting_time == 30.0));
}

#[test]
fn a_reading_at_the_limit_changes_the_edge_at_once() {
    let log = run(&shop(ToolChangeRule::WearLimit { limit: Some(0.0295) }));
    assert!(log.edges[..8].iter().all(|edge| edge.passes == 3 && edge.reason == ChangeReason::Rule));
}

#[test]
fn reading_errors_change_edges_early_and_late() {
    let mut shop = shop(ToolChangeRule::WearLimit { limit: Some(0.035) });
    shop.tools = vec![tool(Rubbing { wear_per_path: 0.001, wear_limit: 1.0, breaks_at: 2.0 })];
    shop.arrivals[0] = jobs_at(&[(0.0, 400)]);
    shop.horizon = 20_000.0;
    shop.policies[0].sensors.flank_wear = 0.008;
    let passes: Vec<u32> = run(&shop).edges.iter().map(|edge| edge.passes).collect();
    assert!(passes.contains(&3) && passes.contains(&4) && passes.contains(&5), "{passes:?}");
}

#[test]
fn a_magazine_is_refilled_when_it_is_empty() {
    let mut shop = shop(ToolChangeRule::PartCount { parts: 1 });
    shop.machines[0].magazine = 3;
    shop.machines[0].refill_time = 100.0;
    shop.horizon = 1000.0;
    let log = run(&shop);
    let changes: Vec<f64> =
        log.states.iter().filter(|row| row.state == MachineState::ToolChange).map(|row| row.end - row.start).collect();
    // Edges 1 to 3 are in the magazine, then one refill for three.
    assert_eq!(changes.iter().map(|time| time.round()).collect::<Vec<_>>()[..6], [7.0, 7.0, 107.0, 7.0, 7.0, 107.0]);
}

#[test]
fn a_broken_edge_is_replaced_inside_the_pass() {
    let mut shop = shop(NEVER);
    shop.tools = vec![tool(Rubbing { wear_per_path: 0.001, wear_limit: 1.0, breaks_at: 0.014 })];
    shop.arrivals[0] = jobs_at(&[(0.0, 1)]);
    let log = run(&shop);
    let rows: Vec<(u32, u32, f64)> =
        log.passes.iter().map(|row| (row.pass, row.edge, (row.path * 1e6).round() / 1e6)).collect();
    assert_eq!(rows, [(0, 0, 10.0), (1, 0, 4.0), (1, 1, 6.0)]);
    assert_eq!(log.edges[0].reason, ChangeReason::Chipping);
    assert_eq!(log.jobs[0].outcome, JobOutcome::Good);
    assert!((log.jobs[0].finish - 27.0).abs() < 1e-9);
}

#[test]
fn a_broken_edge_spoils_its_share_of_parts() {
    let mut shop = shop(NEVER);
    shop.tools = vec![tool(Rubbing { wear_per_path: 0.001, wear_limit: 1.0, breaks_at: 0.014 })];
    shop.parts[0].operations[0].scrap_on_tool_failure = 0.3;
    shop.arrivals[0] = jobs_at(&[(0.0, 20_000)]);
    shop.horizon = 1e6;
    let log = run(&shop);
    let failures = log.edges.iter().filter(|edge| edge.reason == ChangeReason::Chipping).count() as f64;
    let scrap = log.jobs.iter().filter(|job| job.outcome == JobOutcome::ToolFailure).count() as f64;
    let deviation = (0.3 * 0.7 / failures).sqrt();
    assert!((scrap / failures - 0.3).abs() < 4.0 * deviation, "{scrap} of {failures}");
}

#[test]
fn a_part_out_of_tolerance_is_scrapped_at_inspection() {
    let mut shop = shop(NEVER);
    shop.parts[0].operations[0].size_tolerance = 0.045; // wear is 20, 40, 60 um at the end of parts
    let log = run(&shop);
    let outcomes: Vec<JobOutcome> = log.jobs.iter().take(6).map(|job| job.outcome).collect();
    use JobOutcome::{Good, OutOfTolerance};
    assert_eq!(outcomes, [Good, Good, OutOfTolerance, Good, Good, OutOfTolerance]);
}

#[test]
fn a_milling_pass_lasts_its_way_over_the_feed_rate() {
    let mut shop = shop(ToolChangeRule::WearLimit { limit: None });
    let milling = Milling::default();
    shop.tools[0].process = ProcessModel::Milling(Arc::new(milling.clone()));
    let cut = Cut {
        cutting_speed: 160.0 / 60.0,
        feed: 0.05e-3,
        depth_of_cut: 12e-3,
        width_of_cut: 3e-3,
        path_length: 0.5,
        ..Cut::default()
    };
    shop.parts[0].operations[0].work = Work::Cutting(vec![cut]);
    shop.arrivals[0] = jobs_at(&[(0.0, 200)]);
    shop.horizon = 20_000.0;
    let log = run(&shop);
    // 4 teeth, 0.05 mm, 160 m/min on 12 mm: 4244 rpm, 848.8 mm/min.
    let duration = 0.5 / (4.0 * 0.05e-3 * (160.0 / 60.0) / (std::f64::consts::PI * 12e-3));
    assert!((log.passes[0].cutting_time / duration - 1.0).abs() < 1e-9);
    assert_eq!(
        (log.passes[0].path, log.passes[0].speed_start, log.passes[0].speed_end),
        (0.5, cut.cutting_speed, cut.cutting_speed)
    );
    // The life of the process itself, in whole passes.
    let input = MillingInput { cutting_speed: cut.cutting_speed, ..MillingInput::default() };
    let life = milling.output(&milling.initial(), &input).tool_life;
    assert!(log.edges.len() > 1);
    assert_eq!(f64::from(log.edges[0].passes), (life / duration).ceil());
    assert_eq!(log.edges[0].reason, ChangeReason::WearLimit);
    // A rule on cutting time counts that time.
    shop.policies[0].tool_change = ToolChangeRule::CuttingTime { time: 3.5 * duration };
    let log = run(&shop);
    assert!(log.edges.len() > 3 && log.edges[0].passes == 3 && log.edges[1].passes == 3);
}

#[test]
fn energy_is_power_over_time_in_cut() {
    let log = run(&shop(NEVER));
    assert!(log.passes.iter().all(|row| (row.energy - 100.0 * row.cutting_time).abs() < 1e-9 * row.energy));
}
