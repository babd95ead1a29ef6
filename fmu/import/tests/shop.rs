//! Units as machines of a shop.
#![cfg(feature = "fmi")]

#[path = "run/fixture.rs"]
mod fixture;

use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};
use tempfile::TempDir;
use toolroom_fmu::{Binary, Platform, Version, package, units};
use toolroom_fmu_import::{Instance, Isolation, Unit, UnitProcess};
use toolroom_process::MachineProcess;
use toolroom_scenario::{Scenario, UnitRefusal, UnitRequest, set_importer};
use toolroom_scenario_file as file;
use toolroom_shop as shop;
use toolroom_shop::{RunLog, ShopError};

fn import(request: &UnitRequest<'_>) -> Result<Arc<dyn MachineProcess>, UnitRefusal> {
    let refusal = |error: &dyn std::fmt::Display| UnitRefusal { reason: error.to_string(), fix: String::new() };
    let unit = Unit::load(request.path, &Isolation::None).map_err(|error| refusal(&error))?;
    UnitProcess::new(Arc::new(unit), request.process, request.inputs, request.outputs, request.wiring)
        .map(|process| Arc::new(process) as Arc<dyn MachineProcess>)
        .map_err(|error| refusal(&error))
}

/// The exported turning unit of either version, packaged once for all tests.
fn turning(version: Version) -> PathBuf {
    static FOLDER: OnceLock<TempDir> = OnceLock::new();
    let path = |folder: &TempDir, version: Version| folder.path().join(format!("turning{}.fmu", version.number()));
    let folder = FOLDER.get_or_init(|| {
        let folder = TempDir::new().expect("a folder");
        let platform = Platform::host().expect("tests run on a known platform");
        // Cargo puts the shared library of a dependency beside the test.
        let library = std::env::current_exe().expect("a program").with_file_name(platform.library_name());
        let library = std::fs::read(&library).unwrap_or_else(|error| panic!("{}: {error}", library.display()));
        let unit = units().find(|unit| unit.name == "turning").expect("a unit");
        for version in [Version::Two, Version::Three] {
            let binary = Binary { platform, library: library.clone() };
            let bytes = package(unit, version, &[binary], &[]).expect("a package");
            std::fs::write(path(&folder, version), bytes).expect("writable");
        }
        folder
    });
    path(folder, version)
}

fn scenario(name: &str, overrides: &[String]) -> Scenario {
    set_importer(import);
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../../scenarios/{name}.toml"));
    file::read(&path, overrides).unwrap_or_else(|error| panic!("{error}")).scenario
}

fn with_unit(path: &Path, more: &[&str]) -> Vec<String> {
    let mut overrides = vec![format!("tool.insert.fmu={}", path.display())];
    overrides.extend(more.iter().map(|each| (*each).to_owned()));
    overrides
}

/// Every number of a log, with what it belongs to.
fn numbers(log: &RunLog) -> Vec<(String, f64)> {
    let mut all = Vec::new();
    for (i, pass) in log.passes.iter().enumerate() {
        for (name, value) in [
            ("start", pass.start),
            ("end", pass.end),
            ("speed", pass.speed_start),
            ("speed at end", pass.speed_end),
            ("wear", pass.flank_wear_end),
            ("estimate", pass.flank_wear_estimate),
            ("force", pass.cutting_force),
            ("power", pass.spindle_power),
            ("temperature", pass.temperature),
            ("energy", pass.energy),
            ("size", pass.size_error),
        ] {
            all.push((format!("{name} of pass {i}"), value));
        }
    }
    for (i, edge) in log.edges.iter().enumerate() {
        all.push((format!("cutting time of edge {i}"), edge.cutting_time));
        all.push((format!("wear of edge {i}"), edge.flank_wear));
    }
    all
}

/// The shop of fmu-lathe.toml under one policy, native and imported, agrees to `relative`.
fn agree(version: Version, policy: usize, limit: &str, relative: f64) {
    agree_under(version, policy, limit, relative, &[]);
}

/// The same with more `changes` of both.
fn agree_under(version: Version, policy: usize, limit: &str, relative: f64, more: &[&str]) {
    let limits = ["constant", "adaptive"].map(|name| format!("policy.{name}.tool_change.limit={limit}"));
    let mut changes = vec!["shop.horizon=6 h"];
    changes.extend(limits.iter().map(String::as_str).chain(more.iter().copied()));
    let native = scenario("fmu-lathe-native", &changes.iter().map(|each| (*each).to_owned()).collect::<Vec<_>>());
    let imported = scenario("fmu-lathe", &with_unit(&turning(version), &changes));
    let (a, b) = (shop::run(&native, policy, 0).unwrap(), shop::run(&imported, policy, 0).unwrap());
    assert!(a.passes.len() > 100 && a.edges.len() > 3, "{} passes, {} edges", a.passes.len(), a.edges.len());
    assert_eq!((a.passes.len(), a.edges.len(), a.jobs.len()), (b.passes.len(), b.edges.len(), b.jobs.len()));
    let outcomes = |log: &RunLog| log.jobs.iter().map(|job| job.outcome).collect::<Vec<_>>();
    assert_eq!(outcomes(&a), outcomes(&b));
    for ((name, one), (_, other)) in numbers(&a).into_iter().zip(numbers(&b)) {
        let same = (one - other).abs() <= relative * one.abs().max(other.abs()) || one.is_nan() && other.is_nan();
        assert!(same, "{version:?}, {limit}, policy {policy}, {name}: {one} native, {other} imported");
    }
}

#[test]
fn the_exported_turning_unit_gives_the_native_shop() {
    for version in [Version::Two, Version::Three] {
        agree(version, 0, "0.2 mm", 1e-12);
    }
    // Edges collapse within a pass here, and the instant is found to 30 us.
    agree(Version::Three, 0, "0.5 mm", 1e-5);
    // The native process samples its sensors without restarting its integrator.
    agree(Version::Three, 1, "0.2 mm", 1e-4);
}

#[test]
fn policies_that_know_the_wear_are_shown_that_of_a_unit() {
    for change in ["policy.adaptive.speed=oracle", "policy.adaptive.knows=wear", "policy.adaptive.knows=edge"] {
        agree_under(Version::Three, 1, "0.2 mm", 1e-6, &[change]);
    }
}

#[test]
fn replications_side_by_side_are_the_same_as_one_by_one() {
    let imported = scenario("fmu-lathe", &with_unit(&turning(Version::Three), &["shop.horizon=4 h"]));
    let alone: Vec<String> = (0..4).map(|i| format!("{:?}", shop::run(&imported, 0, i).unwrap().passes)).collect();
    std::thread::scope(|scope| {
        let imported = &imported;
        let runs: Vec<_> = (0..4).map(|i| scope.spawn(move || shop::run(imported, 0, i).unwrap())).collect();
        for (run, alone) in runs.into_iter().zip(&alone) {
            assert_eq!(&format!("{:?}", run.join().expect("no panic").passes), alone);
        }
    });
}

#[test]
fn the_exported_unit_goes_back_more_often_than_it_has_places_for_states() {
    for version in [Version::Two, Version::Three] {
        let unit = Arc::new(Unit::load(&turning(version), &Isolation::None).expect("it loads"));
        let mut instance = Instance::new(&unit, &[], 0.0).expect("an instance");
        let bytes = instance.serialize().expect("a state");
        for _ in 0..=1 << 16 {
            instance.deserialize(&bytes).unwrap_or_else(|error| panic!("{version:?}: {error}"));
        }
        assert_eq!(instance.serialize().expect("a state"), bytes);
    }
}

/// The shop with the unit made for the tests, without breakdowns where they are not wanted.
fn with_fixture(folder: &Path, switches: &[&str], change: (&str, &str), breakdowns: bool) -> Result<Scenario, String> {
    set_importer(import);
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/fmu-lathe.toml");
    let mut text = std::fs::read_to_string(path).expect("shipped");
    let unit = fixture::unit(folder, switches, change);
    text = text.replace("../out/fmu/toolroom_turning_fmi3.fmu", &unit.display().to_string());
    let wiring = "outputs = { flank_wear = \"tool.VB\" }\nevents = { wear_limit = \"tool.worn\" }";
    text = text.replace("start = { \"tool.set\" = \"ni_vk6om\" }", wiring);
    if !breakdowns {
        let start = text.find("[[failure]]").expect("a failure");
        let end = text.find("[[policy]]").expect("a policy");
        text.replace_range(start..end, "");
    }
    file::parse("shop.toml", &text, &[]).map(|file| file.scenario).map_err(|error| error.to_string())
}

#[test]
fn an_event_of_a_unit_changes_the_edge() {
    let folder = TempDir::new().expect("a folder");
    let shop = with_fixture(folder.path(), &[], ("", ""), true).expect("valid");
    let log = shop::run(&shop, 0, 0).expect("it runs");
    assert!(log.events.iter().any(|event| event.event.name() == "wear_limit"), "the unit tells of its limit");
    assert!(log.edges.len() > 5, "{} edges", log.edges.len());
}

#[test]
fn without_fmu_state_a_shop_with_breakdowns_is_refused_and_one_without_runs() {
    let folder = TempDir::new().expect("a folder");
    let stateless = ("canGetAndSetFMUstate=\"true\" canSerializeFMUstate=\"true\"", "");
    let shop = with_fixture(folder.path(), &[], stateless, true).expect("valid");
    let refused = shop::run(&shop, 0, 0).expect_err("it would have to go back");
    assert!(matches!(&refused, ShopError::CannotGoBack { machine, .. } if machine == "L1"), "{refused}");
    let steady = with_fixture(folder.path(), &[], stateless, false).expect("valid");
    let forward = shop::run(&steady, 0, 0).expect("it runs forward");
    let able = with_fixture(folder.path(), &[], ("", ""), false).expect("valid");
    let whole = shop::run(&able, 0, 0).expect("it runs");
    // The same shop but for the passes that the horizon cuts short.
    assert!(forward.passes.len() > 200);
    assert!(whole.passes.len() - forward.passes.len() <= 2);
    for (a, b) in forward.passes.iter().zip(&whole.passes) {
        assert_eq!((a.end, a.flank_wear_end), (b.end, b.flank_wear_end));
    }
}

#[test]
fn a_policy_that_plans_with_a_unit_says_what_it_believes() {
    let text = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/fmu-lathe.toml"));
    let text = text
        .expect("shipped")
        .replace("../out/fmu/toolroom_turning_fmi3.fmu", &turning(Version::Two).display().to_string());
    set_importer(import);
    let without = text.replace("believed_model = \"ni_vk6om\"\n", "");
    assert_ne!(text, without);
    let refused = file::parse("shop.toml", &without, &[]).expect_err("nothing to plan on").to_string();
    assert!(refused.contains("policy \"adaptive\" plans the cuts of tool \"insert\""), "{refused}");
    assert!(!refused.contains("policy \"constant\""), "{refused}");
    let programmed = without.replace("speed = \"productivity\"", "speed = \"programmed\"");
    file::parse("shop.toml", &programmed, &[]).expect("as programmed it needs no model");
}

#[test]
fn a_unit_of_fixed_steps_longer_than_two_passes_is_refused() {
    let folder = TempDir::new().expect("a folder");
    let fixed = |step: &str| {
        let flags = "canHandleVariableCommunicationStepSize=\"true\"";
        let to = format!("fixedInternalStepSize=\"{step}\"");
        let shop = with_fixture(folder.path(), &[], (flags, &to), false).expect("valid");
        shop::run(&shop, 0, 0)
    };
    // A pass takes 56.5 s.
    let refused = fixed("1000").expect_err("no step is taken in a pass");
    assert!(matches!(&refused, ShopError::FixedStep { pass, .. } if (pass - 56.55).abs() < 0.01), "{refused}");
    fixed("113").expect("its end is met within half a step");
}

#[test]
fn a_unit_that_fails_a_step_stops_the_run_with_place_and_reason() {
    let folder = TempDir::new().expect("a folder");
    let shop = with_fixture(folder.path(), &["FAILS"], ("", ""), false).expect("valid");
    let ShopError::Model(refusal) = shop::run(&shop, 0, 0).expect_err("it fails") else { panic!("another error") };
    let text = refusal.to_string();
    for expected in ["on machine `L", "part `ring`", "operation `turn`, pass", "the solver gave up", "wear.fmu"] {
        assert!(text.contains(expected), "{expected} in {text}");
    }
    assert!(refusal.inputs.iter().any(|(name, value)| *name == "cutting_speed" && *value > 0.6));
}

#[test]
fn a_scenario_names_what_is_wrong_with_its_unit() {
    let folder = TempDir::new().expect("a folder");
    for (switches, change, expected) in [
        (&["NO_STEP"][..], ("", ""), "lacks functions that FMI asks for: fmi2DoStep"),
        (&["DENIES"], ("", ""), "the licence has run out"),
        (&[], ("cut.cutting_speed", "cut.speed"), "the unit has no input for cutting_speed"),
        (&[], ("<CoSimulation", "<ScheduledExecution"), "has no interface for Co-Simulation or Model Exchange"),
    ] {
        let refused = with_fixture(folder.path(), switches, change, true).expect_err(expected);
        assert!(refused.contains("shop.toml:") && refused.contains(expected), "{refused}");
    }
    let missing = scenario_error("tool.insert.fmu=not/there.fmu");
    assert!(missing.contains("not/there.fmu cannot be read"), "{missing}");
    let both = scenario_error("tool.insert.parameter_set=ni_vk6om");
    assert!(both.contains("`parameter_set` does not apply beside `fmu`"), "{both}");
}

fn scenario_error(change: &str) -> String {
    set_importer(import);
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/fmu-lathe.toml");
    let overrides = with_unit(&turning(Version::Three), &[change]);
    file::read(&path, &overrides).expect_err("refused").to_string()
}
