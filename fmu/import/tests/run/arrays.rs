//! Arrays, strings and steps of one length.

use super::fixture::compiled;
use super::{input, machine, wiring};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tempfile::TempDir;
use toolroom_fmu_import::check::{Severity, check};
use toolroom_fmu_import::simulate::{Done, Experiment, Inputs, SimulateError, left_out, simulate};
use toolroom_fmu_import::{Archive, Isolation, Unit, WiringError};
use toolroom_process::{MachineProcess, ProcessEvent, Wiring};

const DESCRIPTION: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="3.0" modelName="array" instantiationToken="{array}">
  <CoSimulation modelIdentifier="array" fixedInternalStepSize="0.25"/>
  <UnitDefinitions><Unit name="mm"><BaseUnit m="1" factor="0.001"/></Unit></UnitDefinitions>
  <LogCategories><Category name="logAll"/></LogCategories>
  <DefaultExperiment startTime="0" stopTime="2" stepSize="0.5"/>
  <ModelVariables>
    <Float64 name="time" valueReference="0" causality="independent" variability="continuous"/>
    <UInt64 name="n" valueReference="1" causality="structuralParameter" variability="fixed" min="1" max="8" start="2"/>
    <Float64 name="u" valueReference="2" causality="input" start="0 0"><Dimension valueReference="1"/></Float64>
    <Float64 name="y" valueReference="3" causality="output"><Dimension valueReference="1"/></Float64>
    <String name="text" valueReference="4" causality="output"/>
    <String name="called" valueReference="7" causality="input"><Start value=""/></String>
  </ModelVariables>
  <ModelStructure>
    <Output valueReference="3"/><Output valueReference="4"/>
    <InitialUnknown valueReference="3"/><InitialUnknown valueReference="4"/>
  </ModelStructure>
</fmiModelDescription>"#;

fn array(folder: &Path) -> PathBuf {
    compiled(folder, "array", include_str!("array.c"), DESCRIPTION, &[], 3)
}

/// A unit that takes steps of any length up to 7 s, discards longer ones, and cannot go back.
fn discarding(folder: &Path) -> PathBuf {
    let scalars = r#"<Float64 name="cutting_speed" valueReference="5" causality="input" unit="m/s" start="1"/>
    <Float64 name="flank_wear" valueReference="6" causality="output" unit="m"/>
  </ModelVariables>"#;
    let description = DESCRIPTION
        .replace("fixedInternalStepSize=\"0.25\"", "canHandleVariableCommunicationStepSize=\"true\"")
        .replace("</UnitDefinitions>", "<Unit name=\"m/s\"><BaseUnit m=\"1\" s=\"-1\"/></Unit><Unit name=\"m\"><BaseUnit m=\"1\"/></Unit></UnitDefinitions>")
        .replace("</ModelVariables>", scalars)
        .replace("</ModelStructure>", "<Output valueReference=\"6\"/><InitialUnknown valueReference=\"6\"/></ModelStructure>");
    compiled(folder, "array", include_str!("array.c"), &description, &["DISCARD=7"], 3)
}

fn run(path: &Path, table: Option<&str>, experiment: &Experiment) -> Result<(Done, Vec<String>), SimulateError> {
    let unit = Arc::new(Unit::load(path, &Isolation::None).expect("it loads"));
    let read = |table: &str| Inputs::read(unit.description(), &experiment.start_values, table.as_bytes());
    let inputs = table.map(read).transpose()?;
    let mut rows = Vec::new();
    let done = simulate(&unit, experiment, inputs.as_ref(), &mut rows)?;
    Ok((done, String::from_utf8(rows).expect("UTF-8").lines().map(str::to_owned).collect()))
}

#[test]
fn arrays_and_strings_are_columns() {
    let folder = TempDir::new().expect("a folder");
    let path = array(folder.path());
    let report = check(&mut Archive::open(&path).expect("a zip file"));
    assert_eq!(report.count(Severity::Error), 0, "{:?}", report.findings);
    let table = "time,u[2],u[1]\n0,3,1\n2,5,1\n";
    let (done, rows) = run(&path, Some(table), &Experiment::default()).expect("to the end");
    assert_eq!((done.steps, done.step), (4, 0.5));
    assert_eq!(rows[0], "time [s],y[1],y[2],text");
    // Two of its own steps in each; the second element is a ramp.
    assert_eq!(rows[1], "0,2,6,\"0 steps, \"\"few\"\"\"");
    assert_eq!(rows[5], "2,2,10,\"8 steps, \"\"few\"\"\"");
}

#[test]
fn a_string_of_the_table_reaches_the_unit_when_its_time_comes() {
    let folder = TempDir::new().expect("a folder");
    let table = "time,called,u[1],u[2]\n0,turn,1,1\n1,\"mill, twice\",1,1\n2,x,1,1\n";
    let (_, rows) = run(&array(folder.path()), Some(table), &Experiment::default()).expect("to the end");
    let calls: Vec<&str> = rows.iter().skip(1).filter_map(|row| row.split("\"\"").nth(1)).collect();
    assert_eq!(calls, ["turn", "turn", "mill, twice", "mill, twice", "x"]);
}

#[test]
fn a_unit_that_discards_a_step_is_where_it_was_and_takes_it_in_parts() {
    let folder = TempDir::new().expect("a folder");
    let path = discarding(folder.path());
    let speed = [("cutting_speed".to_owned(), "1".to_owned())].into();
    let experiment = Experiment { stop: Some(100.0), step: Some(50.0), start_values: speed, ..Experiment::default() };
    let (done, rows) = run(&path, None, &experiment).expect("to the end");
    assert_eq!((done.steps, rows.len()), (2, 4), "{rows:?}");
    let wear = rows[3].rsplit_once(',').and_then(|(_, wear)| wear.parse::<f64>().ok()).expect("a wear");
    assert!((wear - 100e-6).abs() < 1e-15, "{}", rows[3]);
    // In the place of a process, which goes forward only: 2 m/s over passes of two minutes and of five.
    let process = machine(&path, &Wiring::default()).expect("it fits");
    let (mut x, mut y) = (process.initial(), [0.0]);
    let mut u = input(&process, &[("cutting_speed", 2.0)]);
    for (pass, expected) in [(120.0, 240e-6), (310.0, 860e-6)] {
        process.advance(&mut x, &mut u, pass).expect("a pass");
        process.output(&x, &u, &mut y);
        assert!((y[0] - expected).abs() < 1e-12, "{} m after {pass} s", y[0]);
    }
}

#[test]
fn a_step_that_ends_at_no_time_is_refused() {
    let folder = TempDir::new().expect("a folder");
    let reached = |time: &str| {
        let switch = format!("REACHED={time}");
        let path = compiled(folder.path(), "array", include_str!("array.c"), DESCRIPTION, &[&switch], 3);
        run(&path, None, &Experiment::default())
    };
    for (time, told) in [("NAN", "NaN"), ("INFINITY", "inf"), ("time+2*step", "0.5")] {
        let refused = reached(time).expect_err("no time").to_string();
        assert!(refused.contains(&format!("fmi3DoStep answered ok, and {told} s as the time it reached")), "{refused}");
    }
    // A unit of steps of its own may be behind, and one that adds up its own time a little ahead.
    reached("time").expect("to the end");
    reached("(time+step)*(1+1e-14)").expect("to the end");
}

#[test]
fn a_difference_of_temperatures_has_no_offset() {
    let folder = TempDir::new().expect("a folder");
    let first = |of_variable: &str, of_type: &str| {
        let kinds = format!(
            "</UnitDefinitions><TypeDefinitions><Float64Type name=\"Rise\" unit=\"K\"{of_type}/></TypeDefinitions>"
        );
        let description = DESCRIPTION
            .replace("<UnitDefinitions>", "<UnitDefinitions><Unit name=\"K\"><BaseUnit K=\"1\"/></Unit>")
            .replace("</UnitDefinitions>", &kinds)
            .replace(
                "causality=\"input\" start=\"0 0\"",
                &format!("causality=\"input\" declaredType=\"Rise\"{of_variable} start=\"0 0\""),
            );
        let path = compiled(folder.path(), "array", include_str!("array.c"), &description, &[], 3);
        let table = "time,u[1] [degC],u[2] [K]\n0,10,1\n2,10,1\n";
        let (_, rows) = run(&path, Some(table), &Experiment::default()).expect("to the end");
        // The unit doubles its inputs.
        rows[1].split(',').nth(1).and_then(|cell| cell.parse::<f64>().ok()).expect("a number") / 2.0
    };
    assert_eq!(first("", ""), 283.15);
    assert_eq!(first(" relativeQuantity=\"true\"", ""), 10.0);
    assert_eq!(first("", " relativeQuantity=\"true\""), 10.0);
    assert_eq!(first(" relativeQuantity=\"false\"", " relativeQuantity=\"true\""), 283.15);
}

#[test]
fn a_clock_that_has_to_be_ticked_is_refused_and_what_belongs_to_one_is_left_out() {
    let folder = TempDir::new().expect("a folder");
    let clocked = |description: &str, interval: &str| {
        let clock = format!(
            "<Clock name=\"tick\" valueReference=\"8\" causality=\"input\" intervalVariability={interval}/>\n\
             <Int32 name=\"ticks\" valueReference=\"9\" causality=\"output\" clocks=\"8\"/></ModelVariables>"
        );
        let description = description.replace("</ModelVariables>", &clock);
        compiled(folder.path(), "array", include_str!("array.c"), &description, &[], 3)
    };
    // In Co-Simulation without Event Mode the unit does without: the table has what belongs to no clock.
    let (_, rows) = run(&clocked(DESCRIPTION, "\"constant\" intervalDecimal=\"1\""), None, &Experiment::default())
        .expect("to the end");
    assert_eq!(rows[0], "time [s],y[1],y[2],text");
    let unit = Unit::load(&folder.path().join("array.fmu"), &Isolation::None).expect("it loads");
    assert_eq!(left_out(unit.description(), &Default::default()), ["ticks"]);
    // In Model Exchange the importer would have to tick it.
    let exchange =
        DESCRIPTION.replace("<CoSimulation", "<ModelExchange").replace(" fixedInternalStepSize=\"0.25\"", "");
    let refused = Unit::load(&clocked(&exchange, "\"countdown\""), &Isolation::None).map(|_| ()).expect_err("refused");
    assert!(refused.to_string().contains("tick the clock tick"), "{refused}");
}

#[test]
fn a_structural_parameter_sets_the_size_of_arrays() {
    let folder = TempDir::new().expect("a folder");
    let path = array(folder.path());
    let start = |pairs: &[(&str, &str)]| Experiment {
        start_values: pairs.iter().map(|(name, value)| ((*name).to_owned(), (*value).to_owned())).collect(),
        ..Experiment::default()
    };
    let (_, rows) = run(&path, None, &start(&[("u", "1 2 4"), ("n", "3")])).expect("to the end");
    assert_eq!(rows[0], "time [s],y[1],y[2],y[3],text");
    assert_eq!(rows[1], "0,2,4,8,\"0 steps, \"\"many\"\"\"");
    let refused = run(&path, None, &start(&[("u", "1 2 4")])).expect_err("two elements").to_string();
    assert!(refused.contains("start value \"1 2 4\" of \"u\""), "{refused}");
    let wide = run(&path, None, &start(&[("n", "9"), ("u", "1 2 4 8 1 2 4 8 1")])).expect_err("too wide").to_string();
    assert!(wide.contains("start value 9 of \"n\" is outside 1 to 8 of its description"), "{wide}");
    let table = |table| run(&path, Some(table), &Experiment::default()).expect_err("refused").to_string();
    assert!(table("time,u[1]\n0,1\n").contains("a column \"u[2]\" is missing: an array is set as a whole"));
    assert!(table("time,u\n0,1\n").contains("the unit has no input \"u\"; it has: u[1], u[2]"));
}

#[test]
fn a_unit_of_fixed_steps_takes_them_in_a_simulation_or_says_why_not() {
    let folder = TempDir::new().expect("a folder");
    let path = array(folder.path());
    let refused = |experiment: Experiment| run(&path, None, &experiment).expect_err("no multiple").to_string();
    let step = refused(Experiment { step: Some(0.3), ..Experiment::default() });
    assert_eq!(step, "the unit takes steps of 0.25 s only: --step = 0.3 s is no multiple of it");
    let stop = refused(Experiment { stop: Some(1.9), ..Experiment::default() });
    assert_eq!(stop, "the unit takes steps of 0.25 s only: --stop = 1.9 s is no multiple of it");
    // What the default experiment would like gives way to what the unit can.
    let own = ("canHandleVariableCommunicationStepSize=\"true\"", "fixedInternalStepSize=\"0.3\"");
    let unit = Arc::new(Unit::load(&super::unit(folder.path(), &[], own), &Isolation::None).expect("it loads"));
    let done = simulate(&unit, &Experiment::default(), None, &mut Vec::new()).expect("to the end");
    assert_eq!((done.step, done.steps), (0.3, 200));
}

#[test]
fn a_unit_of_fixed_steps_keeps_to_the_clock_of_the_shop_within_half_a_step() {
    let folder = TempDir::new().expect("a folder");
    let fixed = ("canHandleVariableCommunicationStepSize=\"true\" ", "");
    // The default experiment says 1 s; 1 um for each metre.
    let process = machine(&super::unit(folder.path(), &[], fixed), &wiring()).expect("it fits");
    let (mut x, mut y) = (process.initial(), [0.0]);
    let mut elapsed = 0.0;
    for dt in [0.3, 0.3, 7.7, 1.4, 0.05, 20.25, 0.7] {
        let mut u = input(&process, &[("cutting_speed", 2.0)]);
        let advance = process.advance(&mut x, &mut u, dt).expect("a step");
        assert_eq!((advance.elapsed, advance.event), (dt, None));
        elapsed += dt;
        process.output(&x, &u, &mut y);
        assert!((y[0] - 2e-6 * elapsed).abs() <= 1e-6 + 1e-12, "{} m after {elapsed} s", y[0]);
    }
    let [told] = &process.notes()[..] else { panic!("{:?}", process.notes()) };
    assert!(
        told.contains("it takes steps of 1 s only; passes ended up to 0.4 s away from the clock of the shop"),
        "{told}"
    );
    // 0.3 mm after 150 s: the event is reported at the end of the unit's step, which is no longer than the pass.
    let mut u = input(&process, &[("cutting_speed", 2.0)]);
    let advance = process.advance(&mut x, &mut u, 400.0).expect("a step");
    assert_eq!(advance.event, Some(ProcessEvent::WearLimit));
    assert!((elapsed + advance.elapsed - 150.0).abs() <= 1.0, "{}", elapsed + advance.elapsed);
}

#[test]
fn a_unit_of_fixed_steps_of_unknown_length_needs_one_from_the_wiring() {
    let folder = TempDir::new().expect("a folder");
    let changes = [("canHandleVariableCommunicationStepSize=\"true\" ", ""), (" stepSize=\"1\"", "")];
    let path = super::fixture::changed(folder.path(), &[], &changes);
    assert!(matches!(machine(&path, &wiring()), Err(WiringError::FixedStep)));
    machine(&path, &Wiring { step: Some(0.5), ..wiring() }).expect("it fits");
}
