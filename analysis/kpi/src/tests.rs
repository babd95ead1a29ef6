use super::*;
use crate::fixture;
use std::sync::Arc;
use toolroom_cutting::Milling;
use toolroom_scenario::{ArrivalPattern, ProcessModel, Work};
use toolroom_shop::programmed_cutting_times;
use toolroom_shop::runlog::{ChangeReason, EventRow, JobOutcome, LogEvent, OperationResult, OperationRow};

/// Value of a figure of the shop, or of a machine, in `values` of [`evaluate`].
fn value(scenario: &Scenario, values: &[f64], id: &str, machine: Option<usize>) -> f64 {
    let list = kpis(scenario);
    assert_eq!(list.len(), values.len());
    let index = list.iter().position(|kpi| kpi.definition.id == id && kpi.machine == machine);
    values[index.unwrap_or_else(|| panic!("no figure {id}"))]
}

fn near(left: f64, right: f64) -> bool {
    (left - right).abs() <= 1e-12 * right.abs().max(1.0)
}

#[test]
fn a_log_small_enough_for_the_back_of_an_envelope() {
    let scenario = fixture::scenario();
    let values = evaluate(&scenario, &fixture::log());
    let expected = [
        ("parts_per_shift", 1.0),
        ("parts_offered_per_shift", 2.0),
        // 3600 s · (0.01 + 0.01 + 0.02)
        ("machine_cost_per_part", 144.0),
        // two inserts of 2, one wheel dressing of 1
        ("edge_cost_per_part", 5.0),
        ("scrap_cost_per_part", 10.0),
        ("cost_per_part", 159.0),
        ("edges_per_100_parts", 200.0),
        ("dressings_per_100_parts", 100.0),
        ("scrap_rate", 0.5),
        ("scrap_from_tool_failure", 0.5),
        ("edge_failure_share", 0.5),
        // handling and cutting: 630 s on L1, 120 s on G1
        ("availability", 750.0 / 10_800.0),
        // programmed: two operations of 2·120 + 120 s on L1, one of 100 + 20 s on G1
        ("effectiveness", 840.0 / 750.0),
        ("quality_ratio", 480.0 / 840.0),
        ("oee", 480.0 / 10_800.0),
        ("utilisation", (690.0 / 3600.0 + 0.0 + 120.0 / 3600.0) / 3.0),
        ("cutting_share", 550.0 / 10_800.0),
        ("lead_time", 540.0),
        ("tardiness", 40.0),
        ("tardy_share", 1.0),
        ("wip", (540.0 + 690.0) / 3600.0),
        ("tool_life", 225.0),
        ("path_per_edge", 112.5),
        ("mean_cutting_speed", 0.5),
        ("energy_per_part", 4.0 * 1000.0 + 100.0 * 10_800.0),
        ("cell_time_ratio", (450.0 + 60.0) / 240.0),
    ];
    for (id, expected) in expected {
        let found = value(&scenario, &values, id, None);
        assert!(near(found, expected), "{id} = {found}, not {expected}");
    }
    let lathe = [("utilisation", 690.0 / 3600.0), ("load", 690.0 / 3600.0), ("throughput", 1.0 / 3600.0)];
    for (id, expected) in lathe {
        assert!(near(value(&scenario, &values, id, Some(0)), expected), "{id} of L1");
    }
}

#[test]
fn oee_is_the_product_of_its_three_factors() {
    let scenario = fixture::scenario();
    let values = evaluate(&scenario, &fixture::log());
    for machine in [None, Some(0), Some(2)] {
        let kpi = |id| value(&scenario, &values, id, machine);
        assert!(near(kpi("oee"), kpi("availability") * kpi("effectiveness") * kpi("quality_ratio")), "{machine:?}");
    }
}

#[test]
fn machine_time_shares_add_up_to_one() {
    let scenario = fixture::scenario();
    let values = evaluate(&scenario, &fixture::log());
    for machine in 0..scenario.machines.len() {
        let shares = kpis(&scenario)
            .iter()
            .zip(&values)
            .filter(|(kpi, _)| kpi.machine == Some(machine) && kpi.definition.id.ends_with("_time_share"))
            .map(|(_, value)| value)
            .sum::<f64>();
        assert!(near(shares, 1.0), "{shares}");
    }
}

#[test]
fn no_part_gives_undefined_figures_and_no_panic() {
    let scenario = fixture::scenario();
    let empty = RunLog { horizon: 3600.0, ..RunLog::default() };
    let values = evaluate(&scenario, &empty);
    assert!(value(&scenario, &values, "cost_per_part", None).is_nan());
    assert!(value(&scenario, &values, "effectiveness", None).is_nan());
    assert_eq!(value(&scenario, &values, "oee", None), 0.0, "planned and not used");
    assert!(values.iter().all(|value| value.is_finite() || value.is_nan()));
    let idle = RunLog { states: fixture::log().states, ..empty };
    let values = evaluate(&scenario, &idle);
    assert_eq!(value(&scenario, &values, "parts_per_shift", None), 0.0);
    assert!(value(&scenario, &values, "cost_per_part", None).is_nan());
}

#[test]
fn nothing_before_the_end_of_the_warm_up_counts() {
    let mut scenario = fixture::scenario();
    scenario.warm_up = 600.0;
    let values = evaluate(&scenario, &fixture::log());
    let kpi = |id| value(&scenario, &values, id, None);
    assert_eq!(kpi("parts_per_shift"), 0.0);
    assert_eq!(kpi("scrap_rate"), 1.0);
    // The scrapped operation has 90 of its 210 s left of handling and cut, and is planned for 360 s.
    assert!(near(kpi("effectiveness"), 360.0 * 90.0 / 210.0 / 90.0));
    // The second pass of the chipped edge has 90 of its 150 s left, one of one jobs 90 s.
    assert!(near(kpi("wip"), 90.0 / 3000.0));
    assert!(near(kpi("cutting_share"), 90.0 / 9000.0));
    assert!(near(kpi("tool_life"), 150.0));
    assert_eq!(value(&scenario, &values, "load", Some(2)), 0.0);
}

#[test]
fn an_edge_still_in_the_machine_counts_as_far_as_it_is_worn() {
    let scenario = fixture::scenario();
    let mut log = fixture::log();
    log.edges[1].reason = ChangeReason::EndOfRun;
    let values = evaluate(&scenario, &log);
    // 300 s is the only finished life; the other edge cut 150 s.
    assert!(near(value(&scenario, &values, "edges_per_100_parts", None), 150.0));
    assert!(near(value(&scenario, &values, "tool_life", None), 300.0));
}

#[test]
fn an_unfinished_operation_earns_its_part_and_is_not_produced() {
    let scenario = fixture::scenario();
    let mut log = fixture::log();
    let job = &mut log.jobs[1];
    (job.outcome, job.finish) = (JobOutcome::InProcess, f64::NAN);
    // 210 s are done, of 360 s.
    log.operations[2] =
        OperationRow { end: f64::NAN, time_left: 150.0, result: OperationResult::InProcess, ..log.operations[2] };
    let values = evaluate(&scenario, &log);
    assert!(near(value(&scenario, &values, "quality_ratio", None), 1.0));
    assert!(near(value(&scenario, &values, "throughput", Some(0)), 1.0 / 3600.0));
    assert!(near(value(&scenario, &values, "effectiveness", Some(0)), (360.0 + 360.0 * 210.0 / 360.0) / 630.0));
}

#[test]
fn constant_work_offers_any_number_of_parts() {
    let mut scenario = fixture::scenario();
    scenario.arrivals[0].pattern = ArrivalPattern::ConstantWork { jobs: 5 };
    let values = evaluate(&scenario, &fixture::log());
    assert!(value(&scenario, &values, "parts_offered_per_shift", None).is_nan());
}

#[test]
fn figures_have_distinct_keys_and_units_that_convert() {
    let scenario = fixture::scenario();
    let list = kpis(&scenario);
    for (index, kpi) in list.iter().enumerate() {
        let scale = kpi.definition.display_scale();
        assert!(scale.is_finite() && scale > 0.0, "{}", kpi.definition.id);
        assert!(kpi.definition.file_scale().is_finite());
        assert!(!list[..index].iter().any(|other| other.machine == kpi.machine && other.key() == kpi.key()));
    }
    let key = |id: &str| list.iter().find(|kpi| kpi.definition.id == id).map(Kpi::key).unwrap_or_default();
    assert_eq!((key("lead_time").as_str(), key("oee").as_str()), ("lead_time [min]", "oee"));
    assert_eq!(key("mean_cutting_speed"), "mean_cutting_speed [m/min]");
}

#[test]
fn turning_takes_path_over_speed_and_grinding_its_revolutions() {
    // Two cuts of 60 m at 0.5 m/s; 100 revolutions, one a second.
    let times = programmed_cutting_times(&fixture::scenario());
    assert_eq!(times.len(), 1);
    assert!((times[0][0] - 240.0).abs() < 1e-12 && (times[0][1] - 100.0).abs() < 1e-12);
}

#[test]
fn milling_takes_path_over_feed_rate() {
    let mut scenario = fixture::scenario();
    let milling = Milling::named("c45_endmill_d12").expect("a shipped set");
    let (teeth, diameter) = (milling.cutter.teeth, milling.cutter.diameter);
    scenario.tools[0].process = ProcessModel::Milling(Arc::new(milling));
    let Work::Cutting(cuts) = &mut scenario.parts[0].operations[0].work else { panic!("the fixture turns first") };
    cuts.truncate(1);
    cuts[0].width_of_cut = 0.5 * diameter;
    // Speed 0.5 m/s, feed 0.1 mm a tooth: feed rate = f z v / (π D).
    let feed_rate = 1e-4 * teeth * 0.5 / (std::f64::consts::PI * diameter);
    let time = programmed_cutting_times(&scenario)[0][0];
    assert!((time - 60.0 / feed_rate).abs() < 1e-9 * time, "{time}");
}

#[test]
fn chatter_counts_where_stability_is_judged_and_after_the_warm_up() {
    let mut scenario = fixture::scenario();
    let mut log = fixture::log();
    let undefined = evaluate(&scenario, &log);
    for id in ["chatter_share", "scrap_from_chatter", "chatter_onsets_per_shift"] {
        assert!(value(&scenario, &undefined, id, None).is_nan(), "{id}");
    }
    // 300 s of cuts are judged, 60 s of them chatter; one of three onsets lies in the warm-up.
    for (row, chatter_time) in log.passes.iter_mut().zip([45.0, 15.0]) {
        (row.stability_margin, row.chatter_time) = (-0.1, chatter_time);
    }
    for time in [10.0, 100.0, 250.0] {
        let onset = EventRow { time, event: LogEvent::ChatterOnset, machine: Some(0), job: Some(0), edge: Some(0) };
        log.events.push(onset);
    }
    log.jobs[1].outcome = JobOutcome::Chatter;
    scenario.warm_up = 30.0;
    let values = evaluate(&scenario, &log);
    // The shop is in shift for all of the 3570 s, of which a shift has 3600.
    for (id, expected) in
        [("chatter_share", 0.2), ("scrap_from_chatter", 0.5), ("chatter_onsets_per_shift", 2.0 * 3600.0 / 3570.0)]
    {
        let found = value(&scenario, &values, id, None);
        assert!(near(found, expected), "{id} = {found}, not {expected}");
    }
}
