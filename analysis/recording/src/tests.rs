//! What is written of a run reads back as what happened.

use crate::simulated;
use crate::visits::whole_states;
use toolroom_records::{RecordKind, Records, Sensor, parse_csv, write_csv};
use toolroom_scenario::Scenario;
use toolroom_shop::RunLog;
use toolroom_shop::runlog::{MachineState, StateRow};

fn shop(file: &str, overrides: &[&str]) -> (Scenario, RunLog, Vec<Records>) {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/gap").join(file);
    let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
    let scenario = toolroom_scenario_file::read(&path, &overrides).expect("a shipped scenario").scenario;
    let log = toolroom_shop::run(&scenario, 0, 0).expect("it runs");
    let all = simulated(&scenario, &log, &|_, channel| Sensor::usual(channel)).expect("records");
    let again = |records: &Records| {
        let mut bytes = Vec::new();
        write_csv(records, &mut bytes).expect("memory can be written");
        let (read, report) = parse_csv("records", &bytes, records.kind).expect("its own records");
        assert!(report.dropped.is_empty() && report.unused.is_empty(), "{report}");
        read
    };
    let all = all.iter().map(again).collect();
    (scenario, log, all)
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let all: Vec<f64> = values.collect();
    all.iter().sum::<f64>() / all.len() as f64
}

#[test]
fn a_shop_reads_back_as_operations_cuts_and_events() {
    let (_, log, all) = shop("shop.toml", &["shop.horizon=48 h"]);
    let kinds: Vec<RecordKind> = all.iter().map(|records| records.kind).collect();
    assert_eq!(kinds, [RecordKind::Turning, RecordKind::Milling, RecordKind::Shop, RecordKind::Orders]);
    // Every job that came, at its time, and what became of it.
    let jobs = &all[3];
    assert_eq!(jobs.len(), log.jobs.len());
    let sums = |of: &dyn Fn(usize) -> f64| (0..jobs.len()).map(of).filter(|time| time.is_finite()).sum::<f64>();
    let (came, left) = (jobs.numbers("arrival_time").expect("times"), jobs.numbers("finish_time").expect("times"));
    assert!((sums(&|row| came[row]) - sums(&|row| log.jobs[row].arrival)).abs() < 1e-3);
    assert!((sums(&|row| left[row]) - sums(&|row| log.jobs[row].finish)).abs() < 1e-3);
    let rows: usize = all[..2].iter().map(Records::len).sum();
    assert_eq!(rows, log.passes.iter().filter(|pass| pass.cutting_time > 0.0).count());
    // Stays in a state last until the next event of the machine.
    let events = &all[2];
    let (time, machine) = (events.numbers("time").expect("times"), events.texts("machine").expect("machines"));
    let state = events.texts("state").expect("states");
    let stayed = |name: &str| -> f64 {
        (1..events.len())
            .filter(|row| machine[*row] == machine[row - 1] && state[row - 1] == name)
            .map(|row| time[row] - time[row - 1])
            .sum()
    };
    for kind in [MachineState::Cutting, MachineState::Handling, MachineState::ToolChange, MachineState::Down] {
        let logged: f64 = log.states.iter().filter(|row| row.state == kind).map(|row| row.end - row.start).sum();
        assert!((stayed(kind.name()) - logged).abs() < 1e-3 * logged + 1e-3, "{}", kind.name());
        assert!(logged > 0.0);
    }
}

/// A machine without a tool has events as others have: its work is that of an operation of a job.
#[test]
fn plain_work_is_recorded_with_its_program_and_its_operation() {
    let (_, log, all) = shop("../shop/cell.toml", &["shop.horizon=24 h"]);
    let events = all.iter().find(|records| records.kind == RecordKind::Shop).expect("events");
    let text = |name: &str| events.texts(name).expect("a column");
    let working: Vec<usize> = (0..events.len()).filter(|row| text("state")[*row] == "working").collect();
    assert_eq!(working.len(), log.states.iter().filter(|row| row.state == MachineState::Working).count());
    assert!(!working.is_empty());
    for row in working {
        let (program, operation) = (&text("program")[row], &text("operation_id")[row]);
        assert!(program.contains('/') && !operation.is_empty(), "{row}: `{program}`, `{operation}`");
    }
}

#[test]
fn a_repair_over_the_end_of_a_shift_is_one_stay() {
    let row = |start, end, state, in_shift| StateRow { machine: 0, state, start, end, in_shift, job: Some(1) };
    let (down, handling) = (MachineState::Down, MachineState::Handling);
    let night = [row(0.0, 5.0, down, true), row(5.0, 20.0, down, false), row(20.0, 25.0, down, true)];
    // Unloading after one operation and loading for the next are two.
    let day = [row(25.0, 26.0, handling, true), row(26.0, 28.0, handling, true)];
    let whole = whole_states(&RunLog { states: [&night[..], &day].concat(), ..RunLog::default() });
    let ends: Vec<(f64, f64)> = whole.iter().map(|row| (row.start, row.end)).collect();
    assert_eq!(ends, [(0.0, 25.0), (25.0, 26.0), (26.0, 28.0)]);
}

#[test]
fn forces_and_wear_are_those_of_the_log_within_their_sensors() {
    let (_, log, all) = shop("turning.toml", &[]);
    let force = mean(all[0].numbers("cutting_force").expect("forces").iter().copied());
    let ends = mean(log.passes.iter().map(|pass| pass.cutting_force));
    // The land is narrower in the middle of a pass than at its end.
    assert!(force < 1.01 * ends && force > 0.9 * ends, "{force} N, {ends} N");
    let wear = mean(all[0].numbers("flank_wear").expect("wear").iter().copied());
    let logged = mean(log.passes.iter().map(|pass| pass.flank_wear_end));
    assert!((wear / logged - 1.0).abs() < 0.02, "{wear} m, {logged} m");
    let cycles = all[0].numbers("cycle_time").expect("cycles");
    let cycle = mean(cycles.iter().copied().filter(|cycle| cycle.is_finite()));
    let handling: f64 =
        log.states.iter().filter(|row| row.state == MachineState::Handling).map(|row| row.end - row.start).sum();
    let cutting: f64 = log.passes.iter().map(|pass| pass.cutting_time).sum();
    let expected = (handling + cutting) / log.passes.len() as f64;
    assert!((cycle / expected - 1.0).abs() < 0.01, "{cycle} s, {expected} s");
}

/// What a shop does otherwise than programmed is in the time that its control clocks, faster or slower.
#[test]
fn a_cycle_lasts_as_long_as_the_machine_was_at_it() {
    let cycle = |deviation: &str| {
        let (_, _, all) = shop("turning.toml", &[&format!("deviation=[{deviation}]")]);
        mean(all[0].numbers("cycle_time").expect("cycles").iter().copied().filter(|cycle| cycle.is_finite()))
    };
    let (planned, cut) = (cycle(""), 60.0 * 0.575_958_653);
    let added = |deviation: &str| cycle(deviation) - planned;
    for size in [0.15, -0.15] {
        let added = added(&format!(r#"{{ id = "feed_override", size = {size} }}"#));
        assert!((added / (size * cut) - 1.0).abs() < 0.05, "{size}: {added} s");
    }
    // Ten stops of 20 s in an hour of cutting, some nineteen in two hundred operations.
    let stopped = added(r#"{ id = "micro_stops", size = "10 1/h" }"#);
    let expected = cut * 10.0 / 3600.0 * 20.0;
    assert!(stopped > 0.4 * expected && stopped < 1.8 * expected, "{stopped} s, {expected} s");
}

/// A shop stops in the middle of what it does: the control has clocked no cycle of it.
#[test]
fn an_operation_in_process_at_the_end_has_no_cycle_time() {
    // Between operations, and in the middle of one on each of both machines.
    for (horizon, cut_off) in [("shop.horizon=1.02 h", 0), ("shop.horizon=1.03 h", 2)] {
        let (_, log, all) = shop("turning.toml", &[horizon]);
        let whole = log.operations.iter().filter(|row| row.end.is_finite()).count();
        let begun = log.passes.iter().filter(|pass| pass.cutting_time > 0.0).count();
        let clocked = all[0].numbers("cycle_time").expect("cycles").iter().filter(|cycle| cycle.is_finite()).count();
        assert_eq!((clocked, begun - whole), (whole, cut_off), "{horizon}");
    }
}

#[test]
fn grinding_trials_carry_the_stock_of_the_paper_machine() {
    let (_, log, all) = shop("grinding.toml", &[]);
    assert_eq!(all[0].kind, RecordKind::Grinding);
    // 16 revolutions of 4.43 um and 4 of spark-out, K = 0.553: all but what springs back, and half the depth of the last
    // revolution, by which a gauge finds the mean radius behind the wheel.
    let stock = mean(all[0].numbers("stock_removed").expect("stock").iter().copied());
    let commanded = 16.0 * 4.43e-6;
    assert!(stock < commanded + 1e-6 && stock > 0.98 * commanded, "{stock} m");
    let force = mean(all[0].numbers("normal_force").expect("forces").iter().copied());
    let logged = mean(log.passes.iter().filter(|pass| pass.pass == 0).map(|pass| pass.cutting_force));
    assert!((force / logged - 1.0).abs() < 0.01, "{force} N, {logged} N");
}

#[test]
fn trials_of_rough_and_finish_stages_are_recorded_with_both() {
    let phases = r#"part.part.operation.grind.phase=[{ infeed_per_rev = "4.43 um/rev", revolutions = 12 }, { infeed_per_rev = "1 um/rev", revolutions = 8 }, { infeed_per_rev = "0 um/rev", revolutions = 4 }]"#;
    let (_, log, all) = shop("grinding.toml", &[phases]);
    let trials = &all[0];
    assert!(trials.kind == RecordKind::Grinding && trials.len() > 50, "{} trials", trials.len());
    let column = |name: &str| trials.numbers(name).unwrap_or_else(|| panic!("{name}"));
    assert!(column("finish_infeed_per_rev").iter().all(|infeed| (infeed / 1e-6 - 1.0).abs() < 1e-9));
    assert!(
        column("finish_revolutions").iter().zip(column("revolutions")).all(|(finish, n)| (*finish, *n) == (8.0, 12.0))
    );
    // 61.04 um of the recursion, less half of the last depth of 0.096 um and what springs back.
    let stock = mean(column("stock_removed").iter().copied());
    assert!((stock / 61.04e-6 - 1.0).abs() < 0.01, "{stock} m");
    // The steady force is that of the rough stage, what is left that of the whole.
    let force = mean(column("normal_force").iter().copied());
    let logged = mean(log.passes.iter().filter(|pass| pass.pass == 0).map(|pass| pass.cutting_force));
    assert!((force / logged - 1.0).abs() < 0.01, "{force} N, {logged} N");
    // Infeed that goes on behind a spark-out is no trial.
    let twice = phases.replace(
        r#"{ infeed_per_rev = "1 um/rev", revolutions = 8 }, { infeed_per_rev = "0 um/rev", revolutions = 4 }"#,
        r#"{ infeed_per_rev = "0 um/rev", revolutions = 4 }, { infeed_per_rev = "1 um/rev", revolutions = 8 }"#,
    );
    let (_, _, all) = shop("grinding.toml", &[&twice]);
    assert!(all.iter().all(|records| records.kind != RecordKind::Grinding || records.is_empty()));
}

/// What the heat of the infeed has done to a part is still there when it is gauged after the spark-out.
#[test]
fn a_part_that_is_gauged_warm_is_read_too_small_by_what_the_infeed_heated_it() {
    let stock = |overrides: &[&str]| {
        let (_, _, all) = shop("grinding.toml", overrides);
        let stock = mean(all[0].numbers("stock_removed").expect("stock").iter().copied());
        (stock, mean(all[0].numbers("normal_force").expect("forces").iter().copied()))
    };
    let (cold, force) = stock(&[]);
    let (warm, _) = stock(&[r#"tool.wheel.effects=[{ id = "thermal_growth", size = "0.001 um/N" }]"#]);
    // Size times force times the sixteen revolutions of the infeed, by hand; noise of the gauge is 0.5 um a part.
    let grown = 1e-9 * force * 16.0;
    assert!(((cold - warm) / grown - 1.0).abs() < 0.1, "{cold} m, {warm} m, {grown} m");
}

#[test]
fn lots_and_coolants_are_written_where_they_matter() {
    let overrides = ["part.part.batch_size=20", "part.part.deviating_lot=2", "machine.L.coolant_change=1 h"];
    let (_, log, all) = shop("turning.toml", &overrides);
    let (lots, coolants) = (all[0].texts("lot").expect("lots"), all[0].texts("coolant_id").expect("coolants"));
    let (ids, starts) = (all[0].texts("operation_id").expect("ids"), all[0].numbers("start_time").expect("starts"));
    let ages = all[0].numbers("coolant_age").expect("ages");
    for row in 0..all[0].len() {
        let job: usize = ids[row][1..].split('/').next().and_then(|number| number.parse().ok()).expect("J12/turn");
        assert_eq!(lots[row], format!("part-{}", log.jobs[job].lot));
        let later = starts[row] >= 3600.0;
        assert_eq!(coolants[row], if later { "second" } else { "first" });
        let age = starts[row] - if later { 3600.0 } else { 0.0 };
        assert!((ages[row] - age).abs() < 1e-6 * starts[row], "{} s at {} s", ages[row], starts[row]);
    }
    let (_, _, plain) = shop("turning.toml", &[]);
    assert!(plain[0].texts("lot").is_none() && plain[0].texts("coolant_id").is_none());
}
