//! A lathe with its controller: in the shop, and as an exported system of units by the master of this crate. The same wear
//! curve; the difference falls with the communication step.
#![cfg(feature = "fmi")]

use std::path::{Path, PathBuf};
use toolroom_cell::{Cell, Choice, Form};
use toolroom_fmu::{Binary, Platform, Version};
use toolroom_fmu_import::Isolation;
use toolroom_scenario::Scenario;
use toolroom_ssp::{Experiment, Order, Package, System};

/// Time of the comparison, s.
const STOP: f64 = 3000.0;

fn scenario(changes: &[&str]) -> Scenario {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/lathe-cell.toml");
    let changes: Vec<String> = changes.iter().map(|each| (*each).to_owned()).collect();
    toolroom_scenario_file::read(&file, &changes).expect("the shipped scenario").scenario
}

/// The library that cargo built beside this test.
fn library() -> Binary {
    let platform = Platform::host().expect("tests run on a known platform");
    let test = std::env::current_exe().expect("a path");
    let library = std::fs::read(test.with_file_name(platform.library_name())).expect("the library of units");
    Binary { platform, library }
}

/// The exported cell under a policy.
fn exported(scenario: &Scenario, policy: &str, version: Version, folder: &Path) -> PathBuf {
    in_form(Form::Whole, scenario, policy, version, folder)
}

fn in_form(form: Form, scenario: &Scenario, policy: &str, version: Version, folder: &Path) -> PathBuf {
    let choice = Choice { machine: "L".to_owned(), policy: Some(policy.to_owned()), operation: None };
    let cell = Cell::of(scenario, &choice).expect("a cell");
    let path = folder.join("cell.ssp");
    std::fs::write(&path, cell.in_form(form, version, &[library()], STOP).expect("a package")).expect("writable");
    path
}

/// Time, flank wear, edges and speed of the cell.
fn simulated(path: &Path, order: &Order, step: f64) -> Vec<[f64; 4]> {
    let mut package = Package::open(path).expect("a sound package");
    let system = System::load(&mut package, &Default::default(), &Isolation::None).expect("a system");
    let mut table = Vec::new();
    system.simulate(&Experiment { stop: Some(STOP), step: Some(step) }, order, &mut table).expect("a run");
    let text = String::from_utf8(table).expect("text");
    let mut lines = text.lines();
    let heads: Vec<&str> = lines.next().expect("heads").split(',').collect();
    let wanted =
        ["time [s]", "lathe.process.flank_wear [m]", "lathe.tool.count", "controller.process.cutting_speed [m/s]"];
    let places = wanted.map(|name| heads.iter().position(|head| *head == name).unwrap_or_else(|| panic!("{heads:?}")));
    lines
        .map(|line| {
            let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().expect("a number")).collect();
            places.map(|place| cells[place])
        })
        .collect()
}

/// Ends of the shop's passes: time in cut since the start, s, flank wear, m, number of the edge from 1.
fn in_the_shop(scenario: &Scenario, policy: &str) -> Vec<[f64; 3]> {
    let policy = scenario.policies.iter().position(|each| each.name == policy).expect("a policy");
    let log = toolroom_shop::run(scenario, policy, 0).expect("a run");
    let first = log.passes.first().expect("passes").edge;
    let mut time = 0.0;
    let ended = log.passes.iter().map(|pass| {
        time += pass.cutting_time;
        [time, pass.flank_wear_end, f64::from(pass.edge - first + 1)]
    });
    ended.collect()
}

/// Greatest difference of wear at the ends of the shop's passes over the greatest wear, the cell's between two
/// communication points in a straight line. An edge that only one of the two has changed yet is left out.
fn difference(shop: &[[f64; 3]], cell: &[[f64; 4]]) -> f64 {
    let greatest = shop.iter().map(|row| row[1]).fold(0.0, f64::max);
    let mut worst = 0.0f64;
    for [time, wear, edge] in shop.iter().copied().take_while(|row| row[0] < STOP) {
        let after = cell.iter().position(|row| row[0] >= time).expect("a later point").max(1);
        let (one, other) = (cell[after - 1], cell[after]);
        if one[2] == edge && other[2] == edge {
            let share = (time - one[0]) / (other[0] - one[0]);
            worst = worst.max((one[1] + share * (other[1] - one[1]) - wear).abs() / greatest);
        }
    }
    worst
}

fn compared(policy: &str, version: Version, bound: f64) {
    let folder = tempfile::TempDir::new().expect("a folder");
    let scenario = scenario(&[]);
    let path = exported(&scenario, policy, version, folder.path());
    let shop = in_the_shop(&scenario, policy);
    let fine = simulated(&path, &Order::GaussSeidel, 0.25);
    let coarse = simulated(&path, &Order::GaussSeidel, 1.0);
    let late = simulated(&path, &Order::Jacobi, 1.0);
    let used = shop.iter().take_while(|row| row[0] < STOP).last().expect("passes")[2];
    let [fine_error, coarse_error, late_error] = [&fine, &coarse, &late].map(|rows| difference(&shop, rows));
    assert!(used >= 2.0 && (fine.last().expect("rows")[2] - used).abs() <= 1.0, "{policy}: {used} edges");
    // A pass ends between two communication points: the next one, and an edge, begin up to a step early.
    assert!(fine_error < bound && fine_error < coarse_error, "{policy}: {fine_error}, {coarse_error}");
    assert!(coarse_error < 2e-2 && late_error < 5e-2, "{policy}: {coarse_error}, {late_error}");
}

#[test]
fn a_cell_that_is_fed_by_sensors_wears_as_in_the_shop() {
    compared("adaptive", Version::Two, 2e-3);
}

#[test]
fn a_cell_that_predicts_its_wear_wears_as_in_the_shop() {
    compared("minimum wear", Version::Three, 2e-3);
}

#[test]
fn a_cell_that_is_shown_its_wear_wears_as_in_the_shop() {
    compared("set path", Version::Two, 2e-3);
}

#[test]
fn a_cell_of_constant_speed_wears_as_in_the_shop() {
    compared("constant", Version::Two, 2e-3);
}

#[test]
fn the_same_cell_gives_the_same_bytes_and_what_no_unit_stands_for_is_refused() {
    let folder = tempfile::TempDir::new().expect("a folder");
    let scenario_ = scenario(&["part.ring.operation.turn.diameter=100 mm", "tool.insert.parameter_set=ni_vk6om_hb"]);
    let path = exported(&scenario_, "adaptive", Version::Two, folder.path());
    let bytes = std::fs::read(&path).expect("a package");
    exported(&scenario_, "adaptive", Version::Two, folder.path());
    assert!(bytes == std::fs::read(&path).expect("a package"), "the same cell twice");
    let package = Package::open(&path).expect("a sound package");
    let values = |component: usize| &package.structure().components[component].parameters;
    let differing = toolroom_fmu::parameter_values(&toolroom_cutting::Turning::named("ni_vk6om_hb").expect("shipped"));
    let other = toolroom_fmu::parameter_values(&toolroom_cutting::Turning::named("ni_vk6om").expect("shipped"));
    let ours: Vec<_> =
        differing.iter().zip(&other).filter(|(ours, other)| ours.1 != other.1).map(|(ours, _)| ours).collect();
    assert!(ours.len() > 3, "{ours:?}");
    for (name, value) in ours {
        for component in [0, 1] {
            let given = values(component).iter().find(|each| each.name == *name);
            let given = given.map(|each| each.value.parse::<f64>().expect("a number"));
            assert!(given == Some(*value) || name.starts_with("limits."), "{name} of both units: {given:?}, {value}");
        }
    }

    let refused = |machine: &str, policy: &str, changes: &[&str]| {
        let choice = Choice { machine: machine.to_owned(), policy: Some(policy.to_owned()), operation: None };
        Cell::of(&scenario(changes), &choice).expect_err("no cell").to_string()
    };
    assert_eq!(refused("M", "adaptive", &[]), "there is no machine `M`; there are L");
    assert!(refused("L", "fast", &[]).starts_with("there is no policy `fast`; there are adaptive, minimum wear"));
    let schedule = refused("L", "constant", &["policy.constant.speed=schedule"]);
    assert_eq!(schedule, "policy `constant`: a schedule of speed against path is not exported");
}

#[test]
fn a_flat_cell_has_everything_at_its_components_and_is_the_same_system() {
    let (folder, scenario) = (tempfile::TempDir::new().expect("a folder"), scenario(&[]));
    for policy in ["adaptive", "minimum wear", "set path"] {
        let whole = simulated(&exported(&scenario, policy, Version::Two, folder.path()), &Order::Jacobi, 5.0);
        let path = in_form(Form::Flat, &scenario, policy, Version::Two, folder.path());
        assert_eq!(simulated(&path, &Order::Jacobi, 5.0), whole, "{policy}");
        let mut package = zip::ZipArchive::new(std::fs::File::open(&path).expect("a file")).expect("a zip file");
        let mut text = |name: &str| {
            let entry = package.by_name(name).unwrap_or_else(|error| panic!("{name}: {error}"));
            std::io::read_to_string(entry).expect("text")
        };
        let structure = text("SystemStructure.ssd");
        let connections: Vec<&str> = structure.lines().filter(|line| line.contains("<ssd:Connection ")).collect();
        assert!(connections.iter().all(|line| line.contains("startElement") && line.contains("endElement")));
        let (system, _) = structure.split_once("<ssd:Elements>").expect("elements");
        assert!(!system.contains("ParameterBinding") && !system.contains("Connector"), "{system}");
        for component in ["controller", "lathe"] {
            assert!(!text(&format!("resources/{component}.ssv")).contains(&format!("name=\"{component}.")));
        }
    }
}
