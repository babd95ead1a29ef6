//! Grinding cycles and contours in scenarios: what is at fault is named with its place, and the same
//! seed gives the same shop on any number of threads.

use crate::command_line::toolroom;
use serde_json::Value;
use std::path::Path;

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
    assert!(
        message.contains("finish_stock =") && message.contains("um conflict: 99.6308 um can be removed at most"),
        "{message}"
    );
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
    assert!(message.contains("from the folder of the file that names them"), "{message}");
}

#[test]
fn a_fault_in_the_contour_file_has_its_line_there() {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = with_contour(folder.path(), &rk3().replace("allowance = \"0.5 mm\"", "allowance = \"0.5 kg\""));
    let message = refused(&scenario, &[]);
    let line = rk3().lines().position(|line| line.contains("allowance = \"0.5 mm\"")).expect("a line") + 1;
    assert!(message.contains(&format!("own.toml:{line}:")), "{message}");
}

#[test]
fn a_cutter_larger_than_a_concave_radius_is_refused_with_the_section() {
    let folder = tempfile::tempdir().expect("a folder");
    // Smallest radius d/2 − 8 e = 3.6 mm, 11.6 mm on average over a section; the cutter has 16 mm.
    let scenario =
        with_contour(folder.path(), &rk3().replace("eccentricity = \"3.5 mm\"", "eccentricity = \"5.8 mm\""));
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

/// Parts per shift, cost per part, scrap out of tolerance, burnt, grinding time in s, dressings and
/// edges per 100 parts, of two replications of four hours; six significant digits.
type Golden = (&'static str, [f64; 7]);

const GRINDING_GOLDEN: [Golden; 7] = [
    ("fixed", [2028.0, 0.644973, 0.0, 0.0, 10.6831, 2.13026, 0.0]),
    ("fixed for sharp", [728.0, 22.1188, 0.0, 0.692424, 6.57339, 6.92853, 0.0]),
    ("sharp, dress by 12", [1841.0, 1.26388, 0.0, 0.0416358, 6.57442, 8.70617, 0.0]),
    ("sharp, dress by part", [510.0, 4.87255, 0.0, 0.0, 6.58218, 100.784, 0.0]),
    ("force", [2109.0, 0.639328, 0.0, 0.0, 8.90208, 2.81339, 0.0]),
    ("time constant", [2080.0, 0.677855, 0.0, 0.00048216, 8.35807, 3.86319, 0.0]),
    ("redesign", [2147.0, 0.608166, 0.0, 0.0, 9.19902, 1.96987, 0.0]),
];

const CONTOUR_GOLDEN: [Golden; 5] = [
    ("handbook", [489.0, 1.34582, 0.0, 0.0, f64::NAN, 0.0, 2.27616]),
    ("handbook by section", [494.0, 1.45221, 0.0, 0.0, f64::NAN, 0.0, 3.00346]),
    ("best constant", [512.0, 1.23799, 0.0, 0.0, f64::NAN, 0.0, 1.87805]),
    ("planned for time", [590.0, 1.14474, 0.0, 0.0, f64::NAN, 0.0, 2.06967]),
    ("planned for cost", [597.0, 1.07965, 0.0, 0.0, f64::NAN, 0.0, 1.72264]),
];

#[test]
fn the_shipped_scenarios_give_their_numbers() {
    const KEYS: [&str; 7] = [
        "parts_per_shift",
        "cost_per_part",
        "scrap_out_of_tolerance",
        "scrap_burnt",
        "grinding_time [s]",
        "dressings_per_100_parts",
        "edges_per_100_parts",
    ];
    for (scenario, golden) in [(GRINDING, &GRINDING_GOLDEN[..]), (CONTOUR, &CONTOUR_GOLDEN[..])] {
        let folder = tempfile::tempdir().expect("a folder");
        let out = folder.path().join("out").display().to_string();
        let args = ["compare", scenario, "--json", "--quiet", "--replications", "2", "--set", "shop.horizon=4 h"];
        let output = toolroom(&[&args[..], &["--out", &out]].concat());
        let result: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        let policies = result["policies"].as_array().expect("policies");
        assert_eq!(policies.len(), golden.len());
        for (policy, (name, values)) in policies.iter().zip(golden) {
            assert_eq!(policy["name"], *name);
            for (key, value) in KEYS.iter().zip(values) {
                let mean = policy["kpi"][key]["mean"].as_f64().unwrap_or(f64::NAN);
                let same = (mean - value).abs() <= 5e-6 * value.abs() || mean.is_nan() && value.is_nan();
                assert!(same, "{scenario}, {name}, {key}: {mean} instead of {value}");
            }
        }
    }
}

#[test]
fn the_record_of_a_run_tells_the_contour_that_it_milled() {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = with_contour(folder.path(), &rk3());
    let hash = |name: &str| {
        let out = folder.path().join(name);
        let args =
            ["run", &scenario, "--policy", "handbook", "--replications", "1", "--quiet", "--set", "shop.horizon=1 h"];
        let output = toolroom(&[&args[..], &["--out", &out.display().to_string()]].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let run = std::fs::read_to_string(out.join("run.json")).expect("run.json");
        let run: Value = serde_json::from_str(&run).expect("JSON");
        let inputs = run["inputs"].as_array().expect("inputs").clone();
        let contour = inputs.iter().find(|input| input["name"].as_str().is_some_and(|name| name.ends_with("own.toml")));
        contour.expect("the contour file among the inputs")["hash"].clone()
    };
    let before = hash("before");
    std::fs::write(folder.path().join("own.toml"), rk3().replace("\"3.5 mm\"", "\"3.0 mm\"")).expect("a contour file");
    assert_ne!(before, hash("after"));
}
