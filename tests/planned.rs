//! Grinding cycles and contours in scenarios: what is at fault is named with its place, and the same
//! seed gives the same shop on any number of threads.

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

fn toolroom(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_toolroom"))
        .args(args)
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("toolroom runs")
}

/// The first message of `toolroom check` on a scenario with changes, which has to be refused.
fn refused(scenario: &str, changes: &[&str]) -> String {
    let mut args = vec!["check", scenario];
    for change in changes {
        args.extend(["--set", change]);
    }
    let output = toolroom(&args);
    assert_eq!(output.status.code(), Some(2), "{}", String::from_utf8_lossy(&output.stdout));
    // Drawn frames and line breaks are the terminal's.
    let text = String::from_utf8_lossy(&output.stderr).replace(['│', '├', '╰', '╭', '─', '▶'], " ");
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

const GRINDING: &str = "scenarios/grinding-policies.toml";
const CONTOUR: &str = "scenarios/contour-milling.toml";

/// A scenario beside a contour file of its own.
fn with_contour(folder: &Path, contour: &str) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let scenario = std::fs::read_to_string(root.join(CONTOUR)).expect("the shipped scenario");
    std::fs::write(folder.join("own.toml"), contour).expect("a contour file");
    let path = folder.join("shop.toml");
    std::fs::write(&path, scenario.replace("contour/rk3.toml", "own.toml")).expect("a scenario");
    path.display().to_string()
}

fn rk3() -> String {
    std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/contour/rk3.toml")).expect("rk3")
}

#[test]
fn a_cycle_that_cannot_hold_the_size_names_the_limits_that_conflict() {
    // 5 N over 31 N/um and the wear of the wheel leave 0.37 um however long the spark-out.
    let message = refused(GRINDING, &["part.ring.operation.grind.cycle.size_error=\"0.2 um\""]);
    assert!(message.contains("conflicts with threshold force and wheel wear"), "{message}");
    let message = refused(GRINDING, &["part.ring.operation.grind.cycle.finish_stock=\"200 um\""]);
    assert!(message.contains("finish_stock = 200 um and stock = 100 um conflict"), "{message}");
}

#[test]
fn a_policy_without_a_cycle_is_named() {
    let message = refused(GRINDING, &["policy.fixed.grinding.dulling=9"]);
    assert!(message.contains("policy \"fixed\" with tool \"wheel\": grinding cycle"), "{message}");
    assert!(message.contains("grinding-policies.toml:"), "{message}");
}

#[test]
fn unknown_limits_and_units_are_found_where_they_stand() {
    let message = refused(GRINDING, &["part.ring.operation.grind.cycle.size_eror=\"0.2 um\""]);
    assert!(message.contains("size_eror") && message.contains("size_error"), "{message}");
    let message = refused(GRINDING, &["part.ring.operation.grind.cycle.stock=\"100 N\""]);
    assert!(message.contains("stock"), "{message}");
}

#[test]
fn a_contour_file_that_is_missing_is_named_with_the_line_that_names_it() {
    let message = refused(CONTOUR, &["part.hole.operation.profile.contour=\"contour/none.toml\""]);
    assert!(message.contains("contour/none.toml cannot be read"), "{message}");
    assert!(message.contains("from the folder of the scenario file"), "{message}");
}

#[test]
fn a_fault_in_the_contour_file_has_its_line_there() {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = with_contour(folder.path(), &rk3().replace("allowance = \"0.5 mm\"", "allowance = \"0.5 kg\""));
    let message = refused(&scenario, &[]);
    let line = rk3().lines().position(|line| line.contains("allowance = \"0.5 mm\"")).expect("a line") + 1;
    assert!(message.contains(&format!("own.toml, line {line}")), "{message}");
}

#[test]
fn a_cutter_larger_than_a_concave_radius_is_refused_with_the_section() {
    let folder = tempfile::tempdir().expect("a folder");
    // Smallest radius d/2 − 8 e = 14 mm, the cutter has 16 mm.
    let scenario =
        with_contour(folder.path(), &rk3().replace("eccentricity = \"3.5 mm\"", "eccentricity = \"4.5 mm\""));
    let message = refused(&scenario, &[]);
    assert!(message.contains("is concave with a radius of") && message.contains("16.0000 mm"), "{message}");
}

#[test]
fn a_plan_without_a_solution_names_section_and_limits() {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = with_contour(folder.path(), &rk3().replace("tolerance = \"0.05 mm\"", "tolerance = \"0.002 mm\""));
    let message = refused(&scenario, &[]);
    assert!(message.contains("pass \"finish\" of own.toml") && message.contains("accuracy"), "{message}");
}

#[test]
fn a_contour_for_another_cutter_is_refused() {
    let change = "tool.\"end mill\".parameter_set=c45_endmill_d12";
    let message = refused(CONTOUR, &[change]);
    assert!(message.contains("diameter in mm of 32, the tool has 12"), "{message}");
}

#[test]
fn what_a_contour_or_cycle_makes_superfluous_is_refused() {
    let message = refused(CONTOUR, &["part.hole.operation.profile.cutting_speed=\"60 m/min\""]);
    assert!(message.contains("`cutting_speed` does not apply"), "{message}");
    let message = refused(CONTOUR, &["part.hole.operation.profile.contour_passes=[\"polish\"]"]);
    assert!(message.contains("polish") && message.contains("rough, finish"), "{message}");
}

#[test]
fn the_same_seed_gives_the_same_shop_on_one_and_two_threads() {
    for scenario in [GRINDING, CONTOUR] {
        let digest = |threads: &str| {
            let folder = tempfile::tempdir().expect("a folder");
            let out = folder.path().join("out").display().to_string();
            let args = ["compare", scenario, "--json", "--quiet", "--replications", "3", "--threads", threads];
            let output = toolroom(&[&args[..], &["--set", "shop.horizon=2 h", "--out", &out]].concat());
            assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
            serde_json::from_slice::<Value>(&output.stdout).expect("JSON")
        };
        let (one, two) = (digest("1"), digest("2"));
        assert_eq!(one, two, "{scenario}");
        assert!(one["digest"].is_string());
    }
}
