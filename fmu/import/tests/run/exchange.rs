//! Units of Model Exchange.

use super::fixture::{changed, compiled};
use super::{input, machine, wiring};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tempfile::TempDir;
use toolroom_fmu_import::check::{Severity, check};
use toolroom_fmu_import::simulate::{Experiment, SimulateError, simulate};
use toolroom_fmu_import::{Archive, Driven, Isolation, LoadError, Unit};
use toolroom_process::{MachineProcess, ProcessEvent, Wiring};

/// The unit of the tests with wear as a state: 1 um for each metre, 0.5 m/s.
pub fn exchange(folder: &Path, switches: &[&str]) -> PathBuf {
    let switches: Vec<&str> = ["EXCHANGE", "NO_STEP"].iter().chain(switches).copied().collect();
    let derivative = r#"<ScalarVariable name="der(wear)" valueReference="6" causality="local" variability="continuous" initial="calculated"><Real derivative="3"/></ScalarVariable>
  </ModelVariables>"#;
    let changes = [
        ("<CoSimulation", "<ModelExchange"),
        ("canHandleVariableCommunicationStepSize=\"true\" ", ""),
        ("numberOfEventIndicators=\"0\"", "numberOfEventIndicators=\"1\""),
        ("</ModelVariables>", derivative),
        ("</Outputs>", "</Outputs><Derivatives><Unknown index=\"6\"/></Derivatives>"),
        ("</InitialUnknowns>", "<Unknown index=\"6\"/></InitialUnknowns>"),
    ];
    changed(folder, &switches, &changes)
}

/// Rows of a simulation from 0 s to `stop` in steps of `step`, s: time, wear in mm, the flag of the wear limit.
fn rows(path: &Path, stop: f64, step: f64) -> Result<Vec<[f64; 3]>, SimulateError> {
    let unit = Arc::new(Unit::load(path, &Isolation::None).expect("it loads"));
    let experiment = Experiment { stop: Some(stop), step: Some(step), ..Experiment::default() };
    let mut table = Vec::new();
    let done = simulate(&unit, &experiment, None, &mut table);
    let text = String::from_utf8(table).expect("UTF-8");
    let rows = text.lines().skip(1).map(|line| {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().expect("a number")).collect();
        <[f64; 3]>::try_from(cells).expect("three columns")
    });
    done.map(|_| rows.collect())
}

#[test]
fn the_unit_is_sound() {
    let folder = TempDir::new().expect("a folder");
    let report = check(&mut Archive::open(&exchange(folder.path(), &[])).expect("a zip file"));
    assert_eq!(report.count(Severity::Error), 0, "{:?}", report.findings);
}

#[test]
fn equations_are_integrated_over_state_time_and_step_events() {
    let folder = TempDir::new().expect("a folder");
    // The wear limit of 0.3 mm lies at 600 s; with twice the rate from 250.5 s on, at 425.25 s.
    for (switches, wear, limit) in [
        (&[][..], (&|time: f64| 5e-4 * time) as &dyn Fn(f64) -> f64, 600.0),
        (&["TICK=250.5"], &|time| 5e-4 * (time + (time - 250.5f64).max(0.0)), 425.25),
        (&["CALLS=2"], &|time| 5e-4 * time, 600.0),
    ] {
        let path = exchange(folder.path(), switches);
        for step in [10.0, 700.0] {
            for [time, mm, worn] in rows(&path, 700.0, step).expect("to the end") {
                assert!((mm - wear(time)).abs() < 1e-12, "{switches:?}: {mm} mm at {time} s");
                assert_eq!(worn != 0.0, time >= limit, "{switches:?} at {time} s");
            }
        }
    }
}

#[test]
fn a_unit_of_model_exchange_is_a_machine_of_the_shop() {
    let folder = TempDir::new().expect("a folder");
    let process = machine(&exchange(folder.path(), &["TICK=100"]), &wiring()).expect("it fits");
    assert!(process.goes_back());
    let fresh = process.initial();
    // 1 m/s: 0.1 mm after 100 s, then twice as fast: 0.3 mm at 200 s. Twice, since a state knows its time events.
    for _ in 0..2 {
        let (mut x, mut u) = (fresh.clone(), input(&process, &[("cutting_speed", 1.0)]));
        let first = process.advance(&mut x, &mut u, 80.0).expect("a step");
        assert_eq!((first.elapsed, first.event), (80.0, None));
        let second = process.advance(&mut x, &mut u, 400.0).expect("a step");
        assert_eq!(second.event, Some(ProcessEvent::WearLimit));
        assert!((second.elapsed - 120.0).abs() < 1e-6, "{}", second.elapsed);
        let mut y = [0.0];
        process.output(&x, &u, &mut y);
        assert!((y[0] - 0.3e-3).abs() < 1e-12, "{}", y[0]);
    }
    // No interface says how it steps.
    machine(&exchange(folder.path(), &[]), &Wiring { step: Some(1.0), ..wiring() }).expect("it fits");
}

#[test]
fn a_unit_ends_a_simulation_or_cannot_be_integrated_and_says_so() {
    let folder = TempDir::new().expect("a folder");
    let ended = rows(&exchange(folder.path(), &["TERMINATE=55"]), 100.0, 10.0).expect("an end of its own");
    assert_eq!(ended.last().map(|row| row[0]), Some(55.0));
    for (switch, expected) in [
        ("REFUSES=42", "cannot be integrated any further"),
        ("STIFF", "its equations are stiff"),
        ("UNDEFINED=40", "at 40 s der(wear) = NaN, which is no finite number"),
        ("UNDEFINED=42", "cannot be integrated any further: at 42"),
    ] {
        let error = rows(&exchange(folder.path(), &[switch]), 100.0, 10.0).expect_err(switch).to_string();
        assert!(error.contains(expected), "{error}");
    }
}

/// A unit of FMI 3.0 with one state, which grows by 0.5 in each second.
const SCALAR: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="3.0" modelName="array" instantiationToken="{array}">
  <ModelExchange modelIdentifier="array"/>
  <DefaultExperiment startTime="0" stopTime="2" stepSize="0.5"/>
  <ModelVariables>
    <Float64 name="time" valueReference="0" causality="independent" variability="continuous"/>
    <Float64 name="rate" valueReference="5" causality="input" start="0.5"/>
    <Float64 name="state" valueReference="6" causality="output" initial="exact" start="0"/>
    <Float64 name="der(state)" valueReference="8" causality="local" derivative="6"/>
  </ModelVariables>
  <ModelStructure>
    <Output valueReference="6"/><ContinuousStateDerivative valueReference="8"/><InitialUnknown valueReference="8"/>
  </ModelStructure>
</fmiModelDescription>"#;

#[test]
fn a_library_that_contradicts_its_description_about_its_states_is_refused() {
    let folder = TempDir::new().expect("a folder");
    let run = |switch: &str| {
        let source = include_str!("array.c");
        let path = compiled(folder.path(), "array", source, SCALAR, &["EXCHANGE", switch], 3);
        let unit = Arc::new(Unit::load(&path, &Isolation::None).expect("it loads"));
        let experiment = Experiment { start_values: [("rate".into(), "0.5".into())].into(), ..Experiment::default() };
        let mut rows = Vec::new();
        simulate(&unit, &experiment, None, &mut rows).map(|_| String::from_utf8(rows).expect("UTF-8"))
    };
    let sound = run("STATES=1").expect("to the end");
    let grown: f64 = sound.trim_end().rsplit(',').next().and_then(|cell| cell.parse().ok()).expect("a number");
    assert!((grown - 1.0).abs() < 1e-12, "{sound}");
    for (switch, expected) in [
        ("STATES=0", "fmi3GetNumberOfContinuousStates answered 0, and its description has 1"),
        ("STATES=2", "fmi3GetNumberOfContinuousStates answered 2, and its description has 1"),
        ("INDICATORS=(size_t)-1", "event indicators, at most 1048576 of each are integrated"),
        ("NOMINAL=NAN", "at 0 s the nominal value of state 1 of 1 = NaN, which is no finite number"),
    ] {
        let error = run(switch).expect_err(switch).to_string();
        assert!(error.contains(expected), "{error}");
    }
}

#[test]
fn a_unit_without_the_interface_that_is_wanted_is_refused() {
    let folder = TempDir::new().expect("a folder");
    let path = exchange(folder.path(), &[]);
    let refused = Unit::load_driven(&path, &Isolation::None, Driven::CoSimulation).map(|_| ()).expect_err("refused");
    assert!(matches!(&refused, LoadError::Interface { wanted, .. } if wanted == "Co-Simulation"), "{refused}");
}
