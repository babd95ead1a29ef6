//! Units that run, and units that do what units do wrong.
#![cfg(feature = "fmi")]

mod arrays;
mod exchange;
mod fixture;

use fixture::unit;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tempfile::TempDir;
use toolroom_fmu_import::check::{Severity, check};
use toolroom_fmu_import::simulate::{Experiment, Inputs, SimulateError, simulate};
use toolroom_fmu_import::{Archive, Isolation, LoadError, Unit, UnitProcess, WiringError};
use toolroom_process::{Field, MachineProcess, ModelError, ProcessEvent, Record, Wiring, record};

record! {
    /// What the shop commands.
    pub struct Command {
        /// Cutting speed.
        cutting_speed: Real["m/s" => "m/min"] = 0.5, 0.0..=50.0;
        /// Its change in time.
        cutting_acceleration: Real["m/s2" => "m/min2"] = 0.0, -10.0..=10.0;
        /// Whether the edge cuts.
        engaged: Boolean = 1.0;
        /// Nothing that the unit knows.
        hardness_ratio: Real["1" => "1"] = 1.0, 0.1..=10.0;
    }
}

record! {
    /// What the shop reads.
    pub struct Reading {
        /// Land.
        flank_wear: Real["m" => "mm"] = 0.0, 0.0..=1.0;
    }
}

fn wiring() -> Wiring {
    let pair = |a: &str, b: &str| [(a.to_owned(), b.to_owned())].into();
    Wiring { outputs: pair("flank_wear", "tool.VB"), events: pair("wear_limit", "tool.worn"), ..Wiring::default() }
}

fn machine(path: &Path, wiring: &Wiring) -> Result<UnitProcess, WiringError> {
    let unit = Unit::load(path, &Isolation::None).expect("it loads");
    UnitProcess::new(Arc::new(unit), "turning", Command::<f64>::FIELDS, Reading::<f64>::FIELDS, wiring)
}

/// A unit that can neither save nor serialise its state, and one that cannot serialise it.
const STATELESS: (&str, &str) = ("canGetAndSetFMUstate=\"true\" canSerializeFMUstate=\"true\"", "");
const IN_MEMORY: (&str, &str) = ("canSerializeFMUstate=\"true\"", "");

fn input(process: &UnitProcess, values: &[(&str, f64)]) -> Vec<f64> {
    let start = |field: &Field| values.iter().find(|(name, _)| *name == field.name).map_or(field.start, |(_, v)| *v);
    process.inputs().iter().map(start).collect()
}

#[test]
fn the_fixture_is_a_sound_unit() {
    let folder = TempDir::new().expect("a folder");
    let report = check(&mut Archive::open(&unit(folder.path(), &[], ("", ""))).expect("a zip file"));
    assert_eq!(report.count(Severity::Error), 0, "{:?}", report.findings);
}

#[test]
fn a_unit_in_its_own_units_is_driven_in_si() {
    let folder = TempDir::new().expect("a folder");
    let process = machine(&unit(folder.path(), &[], ("", "")), &wiring()).expect("it fits");
    let names: Vec<&str> = process.inputs().iter().map(|field| field.name).collect();
    assert_eq!(names, ["cutting_speed", "engaged", "cutting_acceleration"]);
    let (mut x, mut u, mut y) = (process.initial(), input(&process, &[("cutting_speed", 2.0)]), vec![0.0]);
    let advance = process.advance(&mut x, &mut u, 60.0).expect("a step");
    assert_eq!((advance.elapsed, advance.event), (60.0, None));
    process.output(&x, &u, &mut y);
    assert!((y[0] - 120e-6).abs() < 1e-15, "1 um for each of 120 m, not {}", y[0]);
    // Out of cut nothing wears.
    let mut resting = input(&process, &[("engaged", 0.0)]);
    process.advance(&mut x, &mut resting, 1e4).expect("a step");
    process.output(&x, &u, &mut y);
    assert!((y[0] - 120e-6).abs() < 1e-15);
}

#[test]
fn a_state_goes_back_branches_and_runs_in_threads() {
    let folder = TempDir::new().expect("a folder");
    let process = machine(&unit(folder.path(), &[], ("", "")), &wiring()).expect("it fits");
    assert!(process.goes_back());
    let run = |from: &[f64], speed: f64, times: &[f64]| {
        let (mut x, mut y) = (from.to_vec(), vec![0.0]);
        for time in times {
            let mut u = input(&process, &[("cutting_speed", speed)]);
            process.advance(&mut x, &mut u, *time).expect("a step");
            process.output(&x, &u, &mut y);
        }
        (x, y[0])
    };
    let (base, _) = run(&process.initial(), 1.0, &[10.0]);
    let (_, whole) = run(&base, 1.5, &[30.0]);
    let (_, part) = run(&base, 1.5, &[12.0]);
    assert!(part < whole);
    assert_eq!(run(&base, 1.5, &[12.0, 18.0]).1, run(&base, 1.5, &[12.0, 18.0]).1);
    assert!((run(&base, 1.5, &[12.0, 18.0]).1 - whole).abs() < 1e-18);
    std::thread::scope(|scope| {
        let threads: Vec<_> = (0..8).map(|_| scope.spawn(|| run(&base, 1.5, &[30.0]).1)).collect();
        for thread in threads {
            assert_eq!(thread.join().expect("no panic"), whole);
        }
    });
}

#[test]
fn a_unit_holds_two_saved_states_for_each_instance_however_often_it_goes_back() {
    let folder = TempDir::new().expect("a folder");
    // 1 um for each metre, 1 m/s: 0.3 mm after 300 s, located by going back some forty times.
    let process = machine(&unit(folder.path(), &["STATES=2"], ("", "")), &wiring()).expect("it fits");
    let (fresh, mut y) = (process.initial(), vec![0.0]);
    for _ in 0..3 {
        let (mut x, mut u) = (fresh.clone(), input(&process, &[("cutting_speed", 1.0)]));
        let advance = process.advance(&mut x, &mut u, 400.0).expect("a step");
        assert_eq!(advance.event, Some(ProcessEvent::WearLimit));
        process.output(&fresh, &u, &mut y);
        assert_eq!(y[0], 0.0, "a state is read where it was, not where the last step left it");
    }
}

#[test]
fn an_event_stops_the_step_where_it_happens_or_at_the_end_of_a_step_without_state() {
    let folder = TempDir::new().expect("a folder");
    // 1 um for each metre, 1 m/s: 0.3 mm after 300 s.
    let stateless = unit(folder.path(), &[], STATELESS);
    let process = machine(&stateless, &Wiring { step: Some(7.0), ..wiring() }).expect("it fits");
    let (mut x, mut u) = (process.initial(), input(&process, &[("cutting_speed", 1.0)]));
    let advance = process.advance(&mut x, &mut u, 400.0).expect("a step");
    assert_eq!(advance.event, Some(ProcessEvent::WearLimit));
    assert!(advance.elapsed >= 300.0 && advance.elapsed <= 307.0, "{}", advance.elapsed);
    let process = machine(&unit(folder.path(), &[], ("", "")), &wiring()).expect("it fits");
    let (mut x, mut u) = (process.initial(), input(&process, &[("cutting_speed", 1.0)]));
    let advance = process.advance(&mut x, &mut u, 400.0).expect("a step");
    assert_eq!(advance.event, Some(ProcessEvent::WearLimit));
    assert!((advance.elapsed - 300.0).abs() <= 1e-9, "{}", advance.elapsed);
    // It is reported once: the flag stays, the step goes on.
    let rest = process.advance(&mut x, &mut u, 50.0).expect("a step");
    assert_eq!((rest.elapsed, rest.event), (50.0, None));
}

#[test]
fn a_ramp_covers_its_path_in_a_unit_that_knows_none() {
    let folder = TempDir::new().expect("a folder");
    let process = machine(&unit(folder.path(), &[], ("", "")), &wiring()).expect("it fits");
    let (mut x, mut y) = (process.initial(), vec![0.0]);
    let mut u = input(&process, &[("cutting_speed", 1.0), ("cutting_acceleration", 0.01)]);
    process.advance(&mut x, &mut u, 100.0).expect("a step");
    process.output(&x, &u, &mut y);
    assert!((y[0] - 150e-6).abs() < 1e-12, "150 m of path, not {}", y[0]);
    assert!((u[0] - 2.0).abs() < 1e-12, "the speed at the end is 2 m/s, not {}", u[0]);
}

#[test]
fn start_values_and_units_of_the_scenario_reach_the_unit() {
    let folder = TempDir::new().expect("a folder");
    let path = unit(folder.path(), &[], (" unit=\"m/min\"", ""));
    let refused = machine(&path, &wiring()).expect_err("no unit");
    assert!(refused.to_string().contains("write \"cut.cutting_speed [m/min]\""), "{refused}");
    let given = Wiring {
        inputs: [("cutting_speed".to_owned(), "cut.cutting_speed [m/min]".to_owned())].into(),
        start: [("rate".to_owned(), "2e-6".to_owned())].into(),
        ..wiring()
    };
    let process = machine(&path, &given).expect("it fits");
    let (mut x, mut u, mut y) = (process.initial(), input(&process, &[("cutting_speed", 1.0)]), vec![0.0]);
    process.advance(&mut x, &mut u, 50.0).expect("a step");
    process.output(&x, &u, &mut y);
    assert!((y[0] - 100e-6).abs() < 1e-15, "{}", y[0]);
}

#[test]
fn a_wiring_that_cannot_be_is_refused_with_what_there_is() {
    let folder = TempDir::new().expect("a folder");
    let path = unit(folder.path(), &[], ("", ""));
    let pair = |a: &str, b: &str| [(a.to_owned(), b.to_owned())].into();
    let cases = [
        (Wiring { inputs: pair("cutting_speed", "speed"), ..wiring() }, "it has: cut.cutting_speed, cut.engaged"),
        (Wiring { inputs: pair("cuting_speed", "x"), ..wiring() }, "the process has no input \"cuting_speed\""),
        (Wiring { inputs: pair("cutting_speed", "cut.cutting_speed [N]"), ..wiring() }, "is in N, which is no unit of"),
        (Wiring { outputs: pair("flank_wear", "cut.engaged"), ..wiring() }, "no output \"cut.engaged\""),
        (Wiring { events: pair("explosion", "tool.worn"), ..wiring() }, "no event \"explosion\""),
        (Wiring { start: pair("rate", "fast"), ..wiring() }, "start value \"fast\" of \"rate\" is no real"),
        (Wiring { start: pair("gain", "1"), ..wiring() }, "no parameter \"gain\""),
    ];
    for (wiring, expected) in cases {
        let refused = machine(&path, &wiring).expect_err(expected).to_string();
        assert!(refused.contains(expected), "{refused}");
    }
}

#[test]
fn without_fmu_state_a_unit_goes_forward_only() {
    let folder = TempDir::new().expect("a folder");
    let path = unit(folder.path(), &[], STATELESS);
    let process = machine(&path, &wiring()).expect("it fits");
    assert!(!process.goes_back());
    let (one, two) = (process.initial(), process.initial());
    let (mut u, mut y) = (input(&process, &[("cutting_speed", 1.0)]), vec![0.0]);
    let mut x = one.clone();
    process.advance(&mut x, &mut u, 10.0).expect("forward");
    process.advance(&mut x, &mut u, 20.0).expect("forward");
    process.output(&x, &u, &mut y);
    assert!((y[0] - 30e-6).abs() < 1e-15);
    let refused = process.advance(&mut one.clone(), &mut u, 5.0).expect_err("back");
    assert!(refused.to_string().contains("cannot go back"), "{refused}");
    // Another edge has an instance of its own.
    let mut other = two;
    process.advance(&mut other, &mut u, 5.0).expect("forward");
    process.output(&other, &u, &mut y);
    assert!((y[0] - 5e-6).abs() < 1e-15);
}

#[test]
fn a_failing_step_is_an_error_with_the_words_of_the_unit() {
    let folder = TempDir::new().expect("a folder");
    for switches in [&["FAILS"][..], &["FAILS", "LOUD"]] {
        let process = machine(&unit(folder.path(), switches, ("", "")), &wiring()).expect("it fits");
        let (mut x, mut u) = (process.initial(), input(&process, &[]));
        process.advance(&mut x, &mut u, 90.0).expect("a step");
        let before = x.clone();
        let ModelError::Unit { reason, unit } = process.advance(&mut x, &mut u, 20.0).expect_err("it fails") else {
            panic!("another error")
        };
        assert_eq!(reason, "fmi2DoStep answered error: the solver gave up");
        assert!(unit.ends_with("wear.fmu"));
        assert_eq!(x, before);
        // The failed instance is gone; the state before is good for another one.
        process.advance(&mut x, &mut u, 5.0).expect("a step");
    }
}

#[test]
fn a_value_that_is_read_between_two_steps_is_read_again_where_the_first_instance_fails() {
    let folder = TempDir::new().expect("a folder");
    let marker = folder.path().join("marker");
    let path = unit(folder.path(), &[&format!("MARKER=\"{}\"", marker.display())], ("", ""));
    let process = machine(&path, &wiring()).expect("it fits");
    let (mut x, mut u, mut y) = (process.initial(), input(&process, &[("cutting_speed", 1.0)]), [0.0]);
    process.advance(&mut x, &mut u, 400.0).expect("past the wear limit");
    process.output(&x, &u, &mut y);
    let wear = y[0];
    assert!(wear > 0.0 && process.holds(ProcessEvent::WearLimit, &x, &u));
    // What was read at the end of the step is known and not asked for again.
    std::fs::write(&marker, "").expect("writable");
    process.output(&x, &u, &mut y);
    assert!(y[0] == wear && process.holds(ProcessEvent::WearLimit, &x, &u) && marker.exists());
    // A log has no place for a value that is not there: another instance goes back to the state and answers.
    let other = input(&process, &[("cutting_speed", 0.5)]);
    for _ in 0..2 {
        std::fs::write(&marker, "").expect("writable");
        process.output(&x, &other, &mut y);
        assert!(y[0] == wear && !marker.exists(), "{} instead of {wear}", y[0]);
    }
    let told = format!(
        "unit {}: 2 values between two steps had to be read again, by a new instance at the same state: fmi2GetReal answered error",
        path.display()
    );
    assert_eq!(process.notes(), [told]);
    // A step that fails is told.
    std::fs::write(&marker, "").expect("writable");
    assert!(process.advance(&mut x, &mut u, 10.0).is_err() && !marker.exists());
}

#[test]
fn a_state_of_more_bytes_than_there_can_be_is_refused() {
    let folder = TempDir::new().expect("a folder");
    for size in ["1 << 27 | 1", "(size_t)1 << 62", "(size_t)-1"] {
        let path = unit(folder.path(), &[&format!("SIZE={size}")], ("", ""));
        let refused = machine(&path, &wiring()).expect_err(size).to_string();
        let expected = "bytes, and a state may have at most 134217728";
        assert!(refused.contains("fmi2SerializedFMUstateSize answered") && refused.contains(expected), "{refused}");
    }
}

#[test]
fn a_unit_that_cannot_be_loaded_is_told_why() {
    let folder = TempDir::new().expect("a folder");
    let load = |path: &Path| Unit::load(path, &Isolation::None).map(|_| ()).expect_err("refused");
    let missing = load(&unit(folder.path(), &["NO_STEP"], ("", "")));
    assert!(matches!(&missing, LoadError::Symbols { missing, .. } if missing == "fmi2DoStep"), "{missing}");
    let scheduled = load(&unit(folder.path(), &[], ("<CoSimulation", "<ScheduledExecution")));
    assert!(matches!(&scheduled, LoadError::Interface { there, .. } if there == "Scheduled Execution"), "{scheduled}");
    let named = load(&unit(folder.path(), &[], ("modelIdentifier=\"wear\"", "modelIdentifier=\"other\"")));
    assert!(matches!(named, LoadError::Platform { .. }), "{named}");
    let path = folder.path().join("text.fmu");
    std::fs::write(&path, "no zip").expect("writable");
    assert!(matches!(load(&path), LoadError::Archive(_)));
    let denied = machine(&unit(folder.path(), &["DENIES"], ("", "")), &wiring()).expect_err("no instance");
    assert_eq!(denied.to_string(), "fmi2Instantiate answered no instance: the licence has run out");
    let token = machine(&unit(folder.path(), &[], ("{wear}", "{other}")), &wiring()).expect_err("no instance");
    assert_eq!(token.to_string(), "fmi2Instantiate answered no instance");
}

#[test]
fn a_simulation_writes_a_row_for_each_communication_point() {
    let folder = TempDir::new().expect("a folder");
    let unit = Arc::new(Unit::load(&unit(folder.path(), &[], ("", "")), &Isolation::None).expect("it loads"));
    let table = "time [s],cut.cutting_speed [m/min],cut.engaged\n0,60,true\n10,60,1\n20,120,false\n";
    let inputs = Inputs::read(unit.description(), &BTreeMap::new(), table.as_bytes()).expect("a table");
    let mut rows = Vec::new();
    let done = simulate(&unit, &Experiment::default(), Some(&inputs), &mut rows).expect("to the end");
    assert_eq!((done.stop, done.step, done.steps), (20.0, 1.0, 20));
    let text = String::from_utf8(rows).expect("UTF-8");
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!((lines[0], lines.len()), ("time [s],tool.VB [mm],tool.worn", 22));
    // 10 s at 1 m/s, then a ramp held over each second: 1.0, 1.1 … 1.9 m/s.
    let last: f64 = lines[21].split(',').nth(1).and_then(|cell| cell.parse().ok()).expect("a number");
    assert!((last - (10.0 + 14.5) * 1e-3).abs() < 1e-12, "{last}");
    for (table, expected) in [
        ("t,cut.engaged\n0,1\n", "line 1: the first column"),
        ("time,speed\n0,1\n", "line 1: the unit has no input \"speed\"; it has: cut.cutting_speed, cut.engaged"),
        ("time,cut.engaged\n0,1\n1,on\n", "line 3: \"on\" is no number"),
        ("time,cut.engaged\n1,1\n0,1\n", "line 3: time goes back"),
        ("time,cut.engaged\n0,1,2\n", "line 2"),
        ("time,cut.engaged\n", "no rows"),
        ("time [m],cut.engaged\n0,1\n", "the column \"time\" is in m, which is no unit of s"),
        ("time,cut.cutting_speed [K]\n0,1\n", "\"cut.cutting_speed\" is in K, which is no unit of m/min"),
        ("time,cut.engaged,cut.engaged\n0,1,1\n", "the column \"cut.engaged\" stands twice"),
        ("time,cut.engaged\n0,0.5\n", "line 2: 0.5 is no value of \"cut.engaged\", which is of type boolean"),
    ] {
        let refused =
            Inputs::read(unit.description(), &BTreeMap::new(), table.as_bytes()).expect_err(expected).to_string();
        assert!(refused.contains(expected), "{refused}");
    }
}

#[test]
fn a_table_in_other_units_than_those_of_the_unit_is_converted() {
    let folder = TempDir::new().expect("a folder");
    let unit = Arc::new(Unit::load(&unit(folder.path(), &[], ("", "")), &Isolation::None).expect("it loads"));
    let wear = |table: &str| {
        let inputs = Inputs::read(unit.description(), &BTreeMap::new(), table.as_bytes()).expect("a table");
        let mut rows = Vec::new();
        let done = simulate(&unit, &Experiment::default(), Some(&inputs), &mut rows).expect("to the end");
        let text = String::from_utf8(rows).expect("UTF-8");
        let wear = text.lines().last().and_then(|row| row.split(',').nth(1)?.parse::<f64>().ok());
        (done.stop, wear.expect("a number"))
    };
    let (stop, own) = wear("time,cut.cutting_speed\n0,40\n60,40\n");
    let (minute, other) = wear("time [min],cut.cutting_speed [m/s]\n0,0.66666666666666667\n1,0.66666666666666667\n");
    assert_eq!((stop, minute), (60.0, 60.0));
    assert!(own > 0.0 && (own - other).abs() < 1e-12 * own, "{own} {other}");
}

#[test]
fn a_wiring_that_contradicts_the_description_is_refused() {
    let folder = TempDir::new().expect("a folder");
    let path = unit(folder.path(), &[], ("", ""));
    let refused = |change: &dyn Fn(&mut Wiring)| {
        let mut wiring = wiring();
        change(&mut wiring);
        machine(&path, &wiring).expect_err("a contradiction").to_string()
    };
    let told = refused(&|wiring| drop(wiring.outputs.insert("flank_wear".to_owned(), "tool.VB [um]".to_owned())));
    assert!(told.starts_with("\"tool.VB\" is in mm by its description"), "{told}");
    let told = refused(&|wiring| drop(wiring.events.insert("wear_limit".to_owned(), "tool.VB".to_owned())));
    assert_eq!(told, "\"tool.VB\" is of type real: the event wear_limit is told by a Boolean output");
    let told = refused(&|wiring| drop(wiring.start.insert("cut.engaged".to_owned(), "2".to_owned())));
    assert_eq!(told, "start value \"2\" of \"cut.engaged\" is no boolean");
    let told = refused(&|wiring| drop(wiring.start.insert("rate".to_owned(), "1 2".to_owned())));
    assert_eq!(told, "start value \"1 2\" of \"rate\": it takes 1 numbers, with blanks between them");
}

#[test]
fn an_input_beyond_the_bounds_of_its_description_is_refused() {
    let folder = TempDir::new().expect("a folder");
    let bound = ("unit=\"m/min\" start=\"30\"", "unit=\"m/min\" start=\"30\" max=\"45\"");
    let process = machine(&unit(folder.path(), &[], bound), &wiring()).expect("it fits");
    let (mut x, mut u) = (process.initial(), input(&process, &[("cutting_speed", 0.75)]));
    process.advance(&mut x, &mut u, 1.0).expect("at the bound");
    let mut u = input(&process, &[("cutting_speed", 1.0)]);
    let told = process.advance(&mut x, &mut u, 1.0).expect_err("beyond").to_string();
    assert!(told.contains("cutting_speed = 60 is outside -inf to 45 of its description"), "{told}");
}

#[test]
fn a_simulation_that_fails_leaves_what_came_before() {
    let folder = TempDir::new().expect("a folder");
    let unit = Arc::new(Unit::load(&unit(folder.path(), &["FAILS"], ("", "")), &Isolation::None).expect("it loads"));
    let mut rows = Vec::new();
    let long = Experiment { stop: Some(200.0), step: Some(10.0), ..Experiment::default() };
    let error = simulate(&unit, &long, None, &mut rows).expect_err("it fails");
    assert!(matches!(error, SimulateError::Call { time: 100.0, .. }), "{error}");
    assert_eq!(String::from_utf8(rows).expect("UTF-8").lines().count(), 12);
}

#[test]
fn states_in_memory_do_what_serialised_ones_do_and_are_freed() {
    let folder = TempDir::new().expect("a folder");
    let serialised = machine(&unit(folder.path(), &[], ("", "")), &wiring()).expect("it fits");
    // One state at which the shop settled, one at the end of the step, one at its start.
    let path = unit(folder.path(), &["STATES=5", "UNITS=2"], IN_MEMORY);
    let in_memory = machine(&path, &wiring()).expect("it fits");
    assert!(in_memory.goes_back());
    let run = |process: &UnitProcess| {
        let (mut x, mut y, mut passes) = (process.initial(), vec![0.0], Vec::new());
        for pass in 0..60 {
            let mut u = input(process, &[("cutting_speed", 1.0)]);
            // Planned whole, interrupted, planned anew from the start.
            for duration in [30.0, 7.0] {
                let mut plan = x.clone();
                let advance = process.advance(&mut plan, &mut u, duration).expect("a step");
                process.output(&plan, &u, &mut y);
                passes.push((pass, advance.elapsed, advance.event, y[0]));
                if duration < 10.0 {
                    x = plan;
                    process.settle(&x);
                }
            }
        }
        process.retire(&x);
        passes
    };
    let expected = run(&serialised);
    assert!(expected.iter().any(|(_, _, event, _)| *event == Some(ProcessEvent::WearLimit)));
    // More edges than the unit has instances: each is freed with its edge.
    for _ in 0..4 {
        assert_eq!(run(&in_memory), expected);
    }
}

#[test]
fn a_unit_without_states_frees_the_instance_of_an_edge_that_is_gone() {
    let folder = TempDir::new().expect("a folder");
    let process = machine(&unit(folder.path(), &["UNITS=2"], STATELESS), &wiring()).expect("it fits");
    for _ in 0..10 {
        let (mut x, mut u) = (process.initial(), input(&process, &[]));
        process.advance(&mut x, &mut u, 10.0).expect("an instance");
        process.retire(&x);
    }
    let edges: Vec<Vec<f64>> = (0..3).map(|_| process.initial()).collect();
    let refused = process.advance(&mut edges[2].clone(), &mut input(&process, &[]), 10.0).expect_err("no third one");
    assert!(refused.to_string().contains("no instance could be made"), "{refused}");
}

#[test]
fn a_wear_that_cannot_be_is_refused_with_variable_value_and_time() {
    let folder = TempDir::new().expect("a folder");
    for (value, expected) in [
        ("NAN", "at 200 s of its time tool.VB = NaN mm, which is no finite number"),
        ("INFINITY", "tool.VB = inf mm, which is no finite number"),
        ("-5.0", "tool.VB = -5 mm, which cannot be: flank_wear = -5 mm is outside 0 to 1000 mm"),
        ("500.0", "no land of a cutting edge is wider than 10 mm"),
        ("1e300", "outside 0 to 1000 mm"),
        ("0.001", "is less than before"),
    ] {
        let path = unit(folder.path(), &[&format!("VALUE={value}")], ("", ""));
        let process = machine(&path, &wiring()).expect("it fits");
        let (mut x, mut u) = (process.initial(), input(&process, &[("cutting_speed", 1.0)]));
        process.advance(&mut x, &mut u, 100.0).expect("sound so far");
        let before = x.clone();
        let refused = process.advance(&mut x, &mut u, 100.0).expect_err(value).to_string();
        assert!(refused.contains(expected) && refused.contains("wear.fmu"), "{value}: {refused}");
        assert_eq!(x, before, "a refused step changes nothing");
    }
    // The bounds of the description are in the unit of the unit.
    let bounded = ("<Real unit=\"mm\"/>", "<Real unit=\"mm\" min=\"0\" max=\"0.05\"/>");
    let process = machine(&unit(folder.path(), &[], bounded), &wiring()).expect("it fits");
    let mut u = input(&process, &[("cutting_speed", 1.0)]);
    let refused = process.advance(&mut process.initial(), &mut u, 60.0).expect_err("0.06 mm").to_string();
    assert!(refused.contains("tool.VB = 0.06 mm, outside 0 to 0.05 mm of its description"), "{refused}");
}

#[test]
fn a_discarded_step_is_taken_in_parts_and_an_end_is_told() {
    let folder = TempDir::new().expect("a folder");
    let whole = machine(&unit(folder.path(), &[], ("", "")), &wiring()).expect("it fits");
    let parts = machine(&unit(folder.path(), &["DISCARD=7"], ("", "")), &wiring()).expect("it fits");
    let wear = |process: &UnitProcess| {
        let (mut x, mut u, mut y) = (process.initial(), input(process, &[("cutting_speed", 1.0)]), vec![0.0]);
        process.advance(&mut x, &mut u, 50.0).expect("a step");
        process.output(&x, &u, &mut y);
        y[0]
    };
    assert!((wear(&parts) - wear(&whole)).abs() < 1e-15);
    // A unit whose own time is the importer's but for rounding.
    let path = unit(folder.path(), &["DISCARD=7", "BEHIND"], ("", ""));
    let behind = machine(&path, &wiring()).expect("it fits");
    assert!((wear(&behind) - wear(&whole)).abs() < 1e-15);
    let discarding = Arc::new(Unit::load(&path, &Isolation::None).expect("it loads"));
    let odd = Experiment { start: Some(0.1), stop: Some(59.7), step: Some(11.92), ..Experiment::default() };
    simulate(&discarding, &odd, None, &mut Vec::new()).expect("to the end");
    // By itself, in a step that takes more parts than one part may be halved.
    let path = unit(folder.path(), &["DISCARD=7"], ("", ""));
    let discarding = Arc::new(Unit::load(&path, &Isolation::None).expect("it loads"));
    let long = Experiment { stop: Some(590.0), step: Some(590.0), ..Experiment::default() };
    let mut rows = Vec::new();
    simulate(&discarding, &long, None, &mut rows).expect("to the end");
    let last = String::from_utf8(rows).expect("UTF-8").lines().last().map(str::to_owned).expect("a row");
    let mm: f64 = last.split(',').nth(1).and_then(|cell| cell.parse().ok()).expect("a wear");
    assert!((mm - 0.295).abs() < 1e-9, "{last}");
    let forward = machine(&unit(folder.path(), &["DISCARD=7"], STATELESS), &wiring()).expect("it fits");
    let mut u = input(&forward, &[]);
    let refused = forward.advance(&mut forward.initial(), &mut u, 50.0).expect_err("it cannot go back").to_string();
    assert!(refused.contains("it discarded a step of 50 s, came to 7 s, and cannot go back"), "{refused}");
    let path = unit(folder.path(), &["TERMINATE=33.0"], ("", ""));
    let ended = machine(&path, &wiring()).expect("it fits");
    let mut u = input(&ended, &[]);
    let refused = ended.advance(&mut ended.initial(), &mut u, 50.0).expect_err("it ended").to_string();
    assert!(refused.contains("at 33 s it ended its simulation"), "{refused}");
    // By itself it may end when it likes.
    let unit = Arc::new(Unit::load(&path, &Isolation::None).expect("it loads"));
    let mut rows = Vec::new();
    let long = Experiment { stop: Some(60.0), step: Some(10.0), ..Experiment::default() };
    let done = simulate(&unit, &long, None, &mut rows).expect("a normal end");
    assert_eq!((done.stop, done.steps, done.ended), (33.0, 4, true));
    let text = String::from_utf8(rows).expect("UTF-8");
    assert!(text.lines().last().is_some_and(|line| line.starts_with("33,")), "{text}");
}

#[test]
fn a_unit_is_told_that_its_simulation_is_over() {
    let folder = TempDir::new().expect("a folder");
    let end = folder.path().join("end");
    let last = format!("LAST=\"{}\"", end.display());
    // At the stop time, and where the unit ended the simulation by itself; by steps and by equations.
    let (steps, ended) = (&[last.as_str()], &[last.as_str(), "TERMINATE=33.0"]);
    let units: [(&dyn Fn() -> PathBuf, &str); 3] = [
        (&|| unit(folder.path(), steps, ("", "")), "60"),
        (&|| unit(folder.path(), ended, ("", "")), "33"),
        (&|| exchange::exchange(folder.path(), steps), "60"),
    ];
    for (path, stop) in units {
        let unit = Arc::new(Unit::load(&path(), &Isolation::None).expect("it loads"));
        simulate(&unit, &Experiment::default(), None, &mut Vec::new()).expect("to the end");
        assert_eq!(std::fs::read_to_string(&end).expect("it was told"), format!("{stop}\n"));
        std::fs::remove_file(&end).expect("a file");
    }
    // Rows stand where it cannot end well, and its words are told.
    let unit = Arc::new(Unit::load(&unit(folder.path(), &["UNENDED"], ("", "")), &Isolation::None).expect("it loads"));
    let mut rows = Vec::new();
    let error = simulate(&unit, &Experiment::default(), None, &mut rows).expect_err("no end").to_string();
    assert!(error.contains("at 60 s: fmi2Terminate answered error: the results are lost"), "{error}");
    assert_eq!(String::from_utf8(rows).expect("UTF-8").lines().count(), 62);
}
