//! The master against closed forms: two integrators that drive each other, dA/dt = 1 - B and dB/dt = A, so that
//! A = sin t and B = 1 - cos t. With inputs held over a step of h the integrators are exact; by Jacobi the system is the
//! explicit Euler method, by Gauss–Seidel the symplectic one.
#![cfg(feature = "fmi")]

#[path = "../../import/tests/run/fixture.rs"]
#[allow(dead_code)] // the tests of the import of units use the rest
mod fixture;
mod packed;

use packed::with_units;
use std::collections::BTreeMap;
use std::path::PathBuf;
use tempfile::TempDir;
use toolroom_fmu_import::Isolation;
use toolroom_ssp::{Experiment, MasterError, Order, Package, System};

const STRUCTURE: &str = r#"<ssd:SystemStructureDescription name="circle" version="2.0">
  <ssd:System name="circle">
    <ssd:Elements>
      <ssd:Component name="A" source="wear.fmu"><ssd:Connectors>
        <ssd:Connector name="cut.cutting_speed" kind="input"/><ssd:Connector name="tool.VB" kind="output"/>
      </ssd:Connectors></ssd:Component>
      <ssd:Component name="B" source="wear.fmu"><ssd:Connectors>
        <ssd:Connector name="cut.cutting_speed" kind="input"/><ssd:Connector name="tool.VB" kind="output"/>
      </ssd:Connectors></ssd:Component>
    </ssd:Elements>
    <ssd:Connections>
      <ssd:Connection startElement="A" startConnector="tool.VB" endElement="B" endConnector="cut.cutting_speed" suppressUnitConversion="true"/>
      <ssd:Connection startElement="B" startConnector="tool.VB" endElement="A" endConnector="cut.cutting_speed" suppressUnitConversion="true">
        <ssc:LinearTransformation factor="-1" offset="1"/>
      </ssd:Connection>
    </ssd:Connections>
  </ssd:System>
  <ssd:DefaultExperiment startTime="0" stopTime="6"/>
</ssd:SystemStructureDescription>"#;

/// The system with `from` replaced by `to`. The unit tells of its integral in mm and takes m/min:
/// a rate of 0.06 makes dA/dt the number at the input.
fn package(switches: &[&str], from: &str, to: &str) -> (TempDir, PathBuf) {
    let folder = TempDir::new().expect("a folder");
    let unit = fixture::unit(folder.path(), switches, ("start=\"1e-6\"", "start=\"0.06\""));
    assert!(STRUCTURE.contains(from), "{from}");
    with_units(&STRUCTURE.replacen(from, to, 1), &[("wear.fmu", std::fs::read(unit).expect("a unit"))])
}

fn rates() -> BTreeMap<String, String> {
    ["A.rate", "B.rate"].map(|name| (name.to_owned(), "0.06".to_owned())).into()
}

/// Rows of time, A and B.
fn run(order: &Order, step: f64) -> Vec<[f64; 3]> {
    let (_folder, path) = package(&[], "", "");
    let mut package = Package::open(&path).expect("a sound package");
    let system = System::load(&mut package, &rates(), &Isolation::None).expect("a system");
    let mut table = Vec::new();
    let done = system.simulate(&Experiment { stop: None, step: Some(step) }, order, &mut table).expect("a run");
    assert_eq!(done.steps as f64, (6.0 / step).round());
    let text = String::from_utf8(table).expect("text");
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("time [s],A.tool.VB [mm],B.tool.VB [mm]"));
    let row = |line: &str| {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().expect("a number")).collect();
        [cells[0], cells[1], cells[2]]
    };
    lines.map(row).collect()
}

/// Greatest difference from what `next` makes of one row after the other.
fn from_recursion(rows: &[[f64; 3]], next: impl Fn(f64, f64, f64) -> (f64, f64)) -> f64 {
    let (mut a, mut b, mut greatest) = (0.0, 0.0, 0.0f64);
    for pair in rows.windows(2) {
        (a, b) = next(pair[1][0] - pair[0][0], a, b);
        greatest = greatest.max((pair[1][1] - a).abs()).max((pair[1][2] - b).abs());
    }
    greatest
}

#[test]
fn jacobi_is_the_explicit_and_gauss_seidel_the_symplectic_method_of_euler() {
    // A thousand roundings of numbers of order one.
    let rounding = 1e-12;
    let jacobi = run(&Order::Jacobi, 0.1);
    assert_eq!(jacobi.len(), 61);
    assert!(from_recursion(&jacobi, |h, a, b| (a + h * (1.0 - b), b + h * a)) < rounding);
    let ordered = run(&Order::GaussSeidel, 0.1);
    let first_a = |h: f64, a: f64, b: f64| {
        let a = a + h * (1.0 - b);
        (a, b + h * a)
    };
    assert!(from_recursion(&ordered, first_a) < rounding);
    let first_b = |h: f64, a: f64, b: f64| {
        let b = b + h * a;
        (a + h * (1.0 - b), b)
    };
    let other = run(&Order::Given(vec!["B".to_owned(), "A".to_owned()]), 0.1);
    assert!(from_recursion(&other, first_b) < rounding);
    assert!(from_recursion(&other, first_a) > 1e-3, "the order counts");
}

#[test]
fn the_error_of_both_is_of_first_order_in_the_step() {
    for order in [Order::Jacobi, Order::GaussSeidel] {
        let error = |step: f64| {
            let rows = run(&order, step);
            rows.iter().map(|[t, a, b]| (a - t.sin()).hypot(b - 1.0 + t.cos())).fold(0.0, f64::max)
        };
        let ratio = error(0.02) / error(0.01);
        // Terms of second order are of the size of the step against the first.
        assert!((1.9..2.2).contains(&ratio), "{order:?}: {ratio}");
    }
}

#[test]
fn a_connector_of_another_kind_than_its_variable_is_refused() {
    let output = "<ssd:Connector name=\"tool.VB\" kind=\"output\"/>";
    let contrary = format!("{output}<ssd:Connector name=\"tool.worn\" kind=\"input\"/>");
    let (_folder, path) = package(&[], output, &contrary);
    let loaded = System::load(&mut Package::open(&path).expect("a package"), &rates(), &Isolation::None);
    let error = loaded.expect_err("an output is no input").to_string();
    assert_eq!(error, "A.tool.worn: input of the system, but output of the unit");
}

#[test]
fn units_of_a_signal_are_converted_or_refused() {
    let (_folder, path) = package(&[], " suppressUnitConversion=\"true\"/>", "/>");
    let loaded = System::load(&mut Package::open(&path).expect("a package"), &rates(), &Isolation::None);
    let error = loaded.expect_err("mm is no speed").to_string();
    assert_eq!(error, "A.tool.VB -> B.cut.cutting_speed: [mm] is no unit of what is in [m/min]");
    // The connector says in which unit its side is: m/s go over as sixty times as many m/min.
    let unit = "<ssd:Connector name=\"tool.VB\" kind=\"output\"><ssc:Real unit=\"m/s\"/></ssd:Connector>";
    let (_folder, path) = package(&[], "<ssd:Connector name=\"tool.VB\" kind=\"output\"/>", unit);
    let text = STRUCTURE
        .replacen("<ssd:Connector name=\"tool.VB\" kind=\"output\"/>", unit, 1)
        .replacen(" suppressUnitConversion=\"true\"/>", "/>", 1)
        .replace(
            "<ssd:DefaultExperiment",
            "<ssd:Units><ssc:Unit name=\"m/s\"><ssc:BaseUnit m=\"1\" s=\"-1\"/></ssc:Unit></ssd:Units><ssd:DefaultExperiment",
        );
    let mut archive = toolroom_fmu_import::Archive::open(&path).expect("a zip file");
    let (_folder, path) = with_units(&text, &[("wear.fmu", archive.read("wear.fmu").expect("the unit"))]);
    let mut package = Package::open(&path).expect("a package");
    let system = System::load(&mut package, &rates(), &Isolation::None).expect("a system");
    let mut table = Vec::new();
    system
        .simulate(&Experiment { stop: Some(0.02), step: Some(0.01) }, &Order::GaussSeidel, &mut table)
        .expect("a run");
    let text = String::from_utf8(table).expect("text");
    let second: Vec<f64> =
        text.lines().nth(2).expect("a row").split(',').map(|cell| cell.parse().expect("a number")).collect();
    assert!((second[2] - 0.01 * 60.0 * second[1]).abs() < 1e-12, "{text}");
}

#[test]
fn a_unit_that_fails_or_ends_the_simulation_is_named_with_the_time() {
    let long = Experiment { stop: Some(200.0), step: Some(10.0) };
    let (_folder, path) = package(&["FAILS"], "", "");
    let system =
        System::load(&mut Package::open(&path).expect("a package"), &rates(), &Isolation::None).expect("a system");
    let mut table = Vec::new();
    let error = system.simulate(&long, &Order::Jacobi, &mut table).expect_err("steps fail from 100 s on");
    assert!(matches!(error, MasterError::Unit { ref component, .. } if component == "A"), "{error}");
    assert!(error.to_string().starts_with("A: at 100 s: fmi2DoStep"), "{error}");

    let (_folder, path) = package(&["TERMINATE=35"], "", "");
    let system =
        System::load(&mut Package::open(&path).expect("a package"), &rates(), &Isolation::None).expect("a system");
    let done = system.simulate(&long, &Order::Jacobi, &mut Vec::new()).expect("an end, no failure");
    assert!(done.ended && done.stop == 35.0, "{done:?}");
}

#[test]
fn an_order_names_each_unit_once_and_start_values_begin_with_one() {
    let (_folder, path) = package(&[], "", "");
    let mut package = Package::open(&path).expect("a package");
    let system = System::load(&mut package, &rates(), &Isolation::None).expect("a system");
    for names in [&["A"][..], &["A", "A"], &["A", "C"], &["A", "B", "B"]] {
        let order = Order::Given(names.iter().map(|name| (*name).to_owned()).collect());
        let error = system.simulate(&Experiment::default(), &order, &mut Vec::new()).expect_err("no order");
        assert!(error.to_string().ends_with("each of them once: A, B"), "{error}");
    }
    let start = BTreeMap::from([("rate".to_owned(), "1".to_owned())]);
    let error = System::load(&mut package, &start, &Isolation::None).expect_err("whose rate?").to_string();
    assert!(error.contains("start values begin with the name of a component"), "{error}");
}

/// The structure with outputs of the units that follow their inputs at once, or are said to.
fn looped(switches: &[&str], dependencies: &str) -> (TempDir, PathBuf) {
    let folder = TempDir::new().expect("a folder");
    let output = ("<Outputs><Unknown index=\"3\"/>", format!("<Outputs><Unknown index=\"3\"{dependencies}/>"));
    let unit = fixture::changed(folder.path(), switches, &[(output.0, &output.1)]);
    with_units(STRUCTURE, &[("wear.fmu", std::fs::read(unit).expect("a unit"))])
}

#[test]
fn an_algebraic_loop_is_told_and_settled_at_the_start_or_refused() {
    let load = |path: &PathBuf| {
        let mut package = Package::open(path).expect("a package");
        System::load(&mut package, &BTreeMap::new(), &Isolation::None).expect("a system")
    };
    let short = Experiment { stop: Some(1.0), step: Some(1.0) };
    // A = g (1 - B), B = g A: A = g / (1 + g²). By Gauss–Seidel the error falls by g² in each round.
    let (_folder, path) = looped(&["GAIN=0.5"], " dependencies=\"1\"");
    let system = load(&path);
    let [told] = system.loops() else { panic!("one loop: {:?}", system.loops()) };
    assert_eq!(told.signals, "A.tool.VB -> B.cut.cutting_speed, B.tool.VB -> A.cut.cutting_speed");
    assert_eq!(told.undeclared, [""; 0]);
    let mut table = Vec::new();
    system.simulate(&short, &Order::GaussSeidel, &mut table).expect("it settles");
    let text = String::from_utf8(table).expect("text");
    for line in text.lines().skip(1) {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().expect("a number")).collect();
        assert!((cells[1] - 0.4).abs() < 1e-11 && (cells[2] - 0.2).abs() < 1e-11, "{text}");
    }
    let (_folder, path) = looped(&["GAIN=2"], " dependencies=\"1\"");
    let mut table = Vec::new();
    let error = load(&path).simulate(&short, &Order::GaussSeidel, &mut table).expect_err("it does not settle");
    assert!(
        error.is_refusal() && error.to_string().starts_with("an algebraic loop that does not settle at 0 s: A."),
        "{error}"
    );
    // Without dependencies it may be a loop; with none it is not.
    let (_folder, path) = looped(&[], "");
    assert_eq!(load(&path).loops()[0].undeclared, ["B", "A"]);
    let (_folder, path) = looped(&[], " dependencies=\"\"");
    assert_eq!(load(&path).loops(), []);
}

#[test]
fn outputs_of_the_system_are_columns_in_their_own_units() {
    let connector = "<ssd:System name=\"circle\"><ssd:Connectors><ssd:Connector name=\"land\" kind=\"output\">\
                     <ssc:Real unit=\"um\"/></ssd:Connector></ssd:Connectors>";
    let connection = "<ssd:Connections><ssd:Connection startElement=\"A\" startConnector=\"tool.VB\" endConnector=\"land\">\
                      <ssc:LinearTransformation factor=\"2\" offset=\"1\"/></ssd:Connection>";
    let units = "<ssd:Units><ssc:Unit name=\"um\"><ssc:BaseUnit m=\"1\" factor=\"1e-6\"/></ssc:Unit></ssd:Units>";
    let structure = STRUCTURE
        .replace("<ssd:System name=\"circle\">", connector)
        .replace("<ssd:Connections>", connection)
        .replace("  <ssd:DefaultExperiment", &format!("  {units}<ssd:DefaultExperiment"));
    let folder = TempDir::new().expect("a folder");
    let unit = fixture::unit(folder.path(), &[], ("", ""));
    let (_folder, path) = with_units(&structure, &[("wear.fmu", std::fs::read(unit).expect("a unit"))]);
    let mut package = Package::open(&path).expect("a package");
    let system = System::load(&mut package, &rates(), &Isolation::None).expect("a system");
    let mut table = Vec::new();
    system.simulate(&Experiment { stop: None, step: Some(1.0) }, &Order::Jacobi, &mut table).expect("a run");
    let text = String::from_utf8(table).expect("text");
    assert_eq!(text.lines().next(), Some("time [s],A.tool.VB [mm],B.tool.VB [mm],land [um]"));
    for line in text.lines().skip(1) {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().expect("a number")).collect();
        // Of mm in um, then the transformation.
        assert!((cells[3] - (2.0 * 1e3 * cells[1] + 1.0)).abs() < 1e-9, "{line}");
    }
    assert!(text.lines().count() == 8, "{text}");
}

#[test]
fn a_start_value_that_cannot_be_is_refused_with_its_file_and_line_before_a_row_is_written() {
    let bound = |name: &str, value: &str| {
        let list = format!(
            "<ssd:Component name=\"A\" source=\"wear.fmu\"><ssd:ParameterBindings><ssd:ParameterBinding><ssd:ParameterValues>\n\
             <ssv:ParameterSet version=\"1.0\" name=\"p\"><ssv:Parameters>\n<ssv:Parameter name=\"{name}\"><ssv:Real value=\"{value}\"/>\
             </ssv:Parameter></ssv:Parameters></ssv:ParameterSet>\n</ssd:ParameterValues></ssd:ParameterBinding></ssd:ParameterBindings>"
        );
        let (_folder, path) = package(&[], "<ssd:Component name=\"A\" source=\"wear.fmu\">", &list);
        let mut package = Package::open(&path).expect("a package");
        let error = System::load(&mut package, &BTreeMap::new(), &Isolation::None).expect_err("refused");
        assert!(error.is_refusal());
        error.to_string()
    };
    let text = bound("rate", "abc");
    assert!(
        text.ends_with("cell.ssp: SystemStructure.ssd:6: circle: A.rate: start value \"abc\" of \"rate\" is no real"),
        "{text}"
    );
    let text = bound("pace", "1");
    assert!(text.contains("SystemStructure.ssd:6: circle: A.pace: the unit has no parameter \"pace\""), "{text}");
    let (_folder, path) = package(&[], "", "");
    let mut package = Package::open(&path).expect("a package");
    let start = BTreeMap::from([("B.rate".to_owned(), "NaN".to_owned())]);
    let error = System::load(&mut package, &start, &Isolation::None).expect_err("refused").to_string();
    assert_eq!(error, "circle: B.rate: start value \"NaN\" of \"rate\" is no real");
}
