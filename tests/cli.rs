//! The command line as a user meets it: output, errors, exit codes, files.

#[path = "cli/owned.rs"]
mod owned;

use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

fn toolroom(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_toolroom"))
        .args(arguments)
        .env("NO_COLOR", "1")
        .stdin(Stdio::null())
        .output()
        .expect("the binary runs")
}

fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).expect("UTF-8")
}

fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).expect("UTF-8")
}

fn json(output: &Output) -> Value {
    assert_eq!(output.status.code(), Some(0), "{}", stderr(output));
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {}", stdout(output)))
}

/// An empty directory of this test.
fn directory(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&path);
    fs::create_dir_all(&path).expect("the target directory is writable");
    path
}

fn file(name: &str, bytes: impl AsRef<[u8]>) -> String {
    let path = directory(name).join("scenario.toml");
    fs::write(&path, bytes).expect("the target directory is writable");
    path.display().to_string()
}

fn shipped(name: &str) -> String {
    format!("{}/scenarios/{name}.toml", env!("CARGO_MANIFEST_DIR"))
}

/// A study that takes a fraction of a second.
fn quick(verb: &str, out: &Path, more: &[&str]) -> Output {
    quick_of(verb, out, &[&["--replications", "3"], more].concat())
}

/// The same with a number of replications to name.
fn quick_of(verb: &str, out: &Path, more: &[&str]) -> Output {
    let (path, out) = (shipped("template"), out.display().to_string());
    let mut arguments = vec![verb, &path, "--set", "shop.horizon=6 h", "--out", &out];
    arguments.extend(["--policy", "constant", "--policy", "best constant"]);
    arguments.extend(more);
    toolroom(&arguments)
}

fn names(dir: &Path) -> Vec<String> {
    let entries = fs::read_dir(dir).expect("a directory").map(|entry| entry.expect("an entry").file_name());
    let mut names: Vec<String> = entries.map(|name| name.to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

const SHIPPED: [&str; 7] =
    ["template", "demo", "constant-vs-adaptive", "steel-shafts", "adverse", "grinder-bottleneck", "fmu-lathe-native"];

#[test]
fn every_shipped_scenario_is_valid() {
    for name in SHIPPED {
        let output = toolroom(&["check", &shipped(name)]);
        assert_eq!(output.status.code(), Some(0), "{name}: {}", stderr(&output));
        assert!(stdout(&output).contains("tool_change_time"), "{name}");
        assert!(stderr(&output).contains("valid: "), "{name}");
    }
}

#[test]
fn check_echoes_what_was_understood() {
    let path = shipped("template");
    let result = json(&toolroom(&["check", &path, "--json", "--set", "machine.L.tool_change_time=0.05 h"]));
    assert_eq!(result["valid"], true);
    let values = result["values"].as_array().expect("a list");
    let of = |key: &str| values.iter().find(|value| value["key"] == key).unwrap_or_else(|| panic!("{key}"));
    assert_eq!(of("tool_change_time")["value"], "3 min");
    assert_eq!(of("depth_of_cut")["value"], "0.75 mm");
    assert_eq!(of("setup_time")["default"], true);
}

#[test]
fn every_problem_is_reported_at_once_with_file_line_and_column() {
    let text = fs::read_to_string(shipped("template")).expect("shipped");
    let text = text
        .replace("tool_change_time = \"2 min\"", "tool_chnage_time = \"2 min\"")
        .replace("\"0.75 mm\"", "0.75")
        .replace("feed_per_rev = \"0.12 mm/rev\"", "feed_per_rev = \"250 mm/min\"")
        .replace("replications = 10", "replications = 0");
    let path = file("all_problems", text);
    let output = toolroom(&["check", &path]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stdout(&output).is_empty());
    let told = stderr(&output);
    for expected in [
        "did you mean `tool_change_time`?",
        "accepted: ",
        "0.12 mm/rev",
        "1 to 1000000",
        "4 problems",
        &format!("{path}:12:"),
    ] {
        assert!(told.contains(expected), "{expected} in\n{told}");
    }
    let told = toolroom(&["check", &path, "--json"]);
    assert_eq!(told.status.code(), Some(2));
    let result: Value = serde_json::from_slice(&told.stdout).expect("JSON");
    assert_eq!(result["problems"].as_array().map(Vec::len), Some(4));
    assert_eq!(result["problems"][0]["line"], 12);
}

/// One shipped file of every kind that can be read.
const KINDS: [(&str, &str); 9] = [
    ("scenario", "template"),
    ("lobes", "chatter/milling-slot"),
    ("life", "life/policies"),
    ("cycle", "grinding/cycle"),
    ("contour", "contour/rk3"),
    ("contour", "contour/cam"),
    ("mapping", "gap/map-vicomtech"),
    ("gap", "gap/vicomtech"),
    ("gap", "gap/program"),
];

#[test]
fn check_tells_every_kind_of_file_by_its_content() {
    for (kind, name) in KINDS {
        let text = fs::read_to_string(shipped(name)).expect("shipped");
        let output = toolroom(&["check", &shipped(name), "--json"]);
        assert_eq!(output.status.code(), Some(0), "{name}: {}", stderr(&output));
        let result = json(&output);
        assert_eq!(result["valid"], true, "{name}");
        let told = if kind == "scenario" { Value::Null } else { kind.into() };
        assert_eq!(result["kind"], told, "{name}");
        // Neither the name of the file nor a header in a comment tells anything.
        let path = file(&format!("kind_{}", name.replace('/', "_")), format!("# [shop]\n{text}"));
        assert_eq!(json(&toolroom(&["check", &path, "--json"]))["kind"], told, "{name}");
    }
}

#[test]
fn check_tells_a_slip_in_any_kind_of_file() {
    for (name, from, to, code) in [
        ("chatter/milling-slot", "[chart]", "[chart]\nspeeed = 1", "unknown-key"),
        ("life/policies", "lives = 2000", "lives = 0", "out-of-range"),
        ("grinding/cycle", "coolant_factor = 1.0", "coolant_faktor = 1.0", "unknown-key"),
        ("contour/rk3", "path_error = { model = \"empirical\" }", "path_error = { model = \"none\" }", "syntax"),
        ("gap/map-vicomtech", "rows_per_operation = 10", "rows_per_operation = 0", "out-of-range"),
        ("gap/vicomtech", "process = \"empirical\"", "proces = \"empirical\"", "unknown-key"),
    ] {
        let text = fs::read_to_string(shipped(name)).expect("shipped");
        assert!(text.contains(from), "{name}");
        let path = file(&format!("slip_{}", name.replace('/', "_")), text.replacen(from, to, 1));
        let output = toolroom(&["check", &path, "--json"]);
        assert_eq!(output.status.code(), Some(2), "{name}");
        let result: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        assert_eq!(result["valid"], false, "{name}");
        let line = text.lines().position(|line| line.contains(from)).expect("a line") + 1;
        let problem = &result["problems"][0];
        assert!(problem["line"].as_u64().is_some_and(|at| at.abs_diff(line as u64) <= 1), "{name}: {problem}");
        assert_eq!(problem["code"], code, "{name}: {problem}");
    }
}

#[test]
fn a_file_of_no_kind_is_an_error_that_names_the_kinds() {
    let path = file("no_kind", "schema = 1\ntitle = \"\"\"\n[shop]\n\"\"\"\n");
    let output = toolroom(&["check", &path]);
    assert_eq!(output.status.code(), Some(2));
    let told = stderr(&output);
    for (kind, _) in KINDS {
        assert!(told.contains(&format!("{kind} by ")), "{kind} in\n{told}");
    }
    assert!(told.contains("--kind"), "{told}");
    // With the kind, its reader tells what is missing.
    let output = toolroom(&["check", &path, "--kind", "scenario"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("missing-key"), "{}", stderr(&output));
    // A shop with priors is a scenario, and with --kind a nominal model.
    let shop = shipped("gap/turning");
    assert!(json(&toolroom(&["check", &shop, "--json"]))["policies"].is_array());
    assert_eq!(json(&toolroom(&["check", &shop, "--json", "--kind", "gap"]))["kind"], "gap");
    assert_eq!(toolroom(&["check", &shop, "--kind", "diagnosis"]).status.code(), Some(2));
    // Slips of TOML are told of any text.
    let broken = file("no_kind_broken", "schema = \n");
    assert!(stderr(&toolroom(&["check", &broken])).contains("syntax"));
}

#[test]
fn check_finds_a_policy_faster_than_any_model_of_a_cut() {
    let text = fs::read_to_string(shipped("template")).expect("shipped");
    let wide = text.replace("\"80 m/min\"", "\"5000 m/min\"");
    let fast = |speed: &str| {
        format!("{wide}\n[[policy]]\nname = \"fast\"\nspeed = \"constant\"\ncutting_speed = \"{speed}\"\n")
    };
    let path = file("too_fast", fast("4000 m/min"));
    let output = toolroom(&["check", &path, "--json"]);
    assert_eq!(output.status.code(), Some(2));
    let result: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(result["problems"].as_array().map(Vec::len), Some(1));
    assert_eq!(result["problems"][0]["code"], "out-of-range");
    assert!(result["problems"][0]["message"].as_str().is_some_and(|text| text.contains("3000 m/min")), "{result}");
    assert_eq!(toolroom(&["check", &file("fast", fast("3000 m/min"))]).status.code(), Some(0));
}

#[test]
fn kinds_without_schema_say_so() {
    for kind in ["mapping", "gap"] {
        let schema = json(&toolroom(&["schema", kind]));
        assert!(schema["title"].as_str().is_some_and(|title| title.starts_with("toolroom ")), "{kind}");
    }
    for kind in ["cycle", "contour"] {
        let output = toolroom(&["schema", kind]);
        assert_eq!(output.status.code(), Some(2), "{kind}");
        assert!(stderr(&output).contains(&format!("there is no schema of {kind} files yet")), "{}", stderr(&output));
    }
}

#[test]
fn encodings_are_named() {
    let text = fs::read_to_string(shipped("template")).expect("shipped");
    let marked = toolroom(&["check", &file("bom", format!("\u{FEFF}{text}"))]);
    assert_eq!(marked.status.code(), Some(0), "{}", stderr(&marked));
    let wide: Vec<u8> = [0xFF, 0xFE].into_iter().chain(text.encode_utf16().flat_map(u16::to_le_bytes)).collect();
    let wide = toolroom(&["check", &file("utf16", wide)]);
    assert_eq!(wide.status.code(), Some(2));
    assert!(stderr(&wide).contains("UTF-16"), "{}", stderr(&wide));
    let cyrillic = toolroom(&["check", &file("cp1251", b"schema = 1\n# \xD6\xE5\xF5\n")]);
    assert_eq!(cyrillic.status.code(), Some(2));
    assert!(
        stderr(&cyrillic).contains(":2:3: ") && stderr(&cyrillic).contains("Windows-1251"),
        "{}",
        stderr(&cyrillic)
    );
}

#[test]
fn a_missing_file_and_a_wrong_verb_are_input_errors() {
    for arguments in [vec!["check", "/nowhere/shop.toml"], vec!["chekc", "x"], vec!["run"], vec!["point", "sawing"]] {
        let output = toolroom(&arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {}", stderr(&output));
        assert!(stdout(&output).is_empty() && !stderr(&output).is_empty());
    }
}

#[test]
fn the_shipped_schemas_are_the_printed_ones() {
    for kind in ["scenario", "lobes", "life", "diagnosis"] {
        let printed = json(&toolroom(&["schema", kind]));
        let path = format!("{}/scenarios/schema/{kind}.schema.json", env!("CARGO_MANIFEST_DIR"));
        let shipped = fs::read_to_string(path).expect("shipped");
        let shipped: Value = serde_json::from_str(&shipped).expect("JSON");
        assert!(printed == shipped, "run: toolroom schema {kind} > scenarios/schema/{kind}.schema.json");
    }
    assert_eq!(json(&toolroom(&["schema"]))["title"], "toolroom scenario");
}

#[test]
fn new_writes_a_valid_scenario_and_never_overwrites() {
    let path = directory("new").join("shop");
    let dir = path.display().to_string();
    assert_eq!(toolroom(&["new", &dir]).status.code(), Some(0));
    let scenario = path.join("scenario.toml").display().to_string();
    assert_eq!(toolroom(&["check", &scenario]).status.code(), Some(0));
    fs::write(&scenario, "mine").expect("writable");
    let again = toolroom(&["new", &dir]);
    assert_eq!(again.status.code(), Some(2), "{}", stderr(&again));
    assert_eq!(fs::read_to_string(&scenario).expect("there"), "mine");
    let other = directory("new_schema");
    fs::write(other.join("scenario.schema.json"), "mine").expect("writable");
    let refused = toolroom(&["new", &other.display().to_string()]);
    assert_eq!(refused.status.code(), Some(2), "{}", stderr(&refused));
    assert_eq!(names(&other), ["scenario.schema.json"]);
}

#[test]
fn point_meets_the_reference_numbers_of_turning() {
    let arguments = [
        "point",
        "turning",
        "--tool",
        "ni_vk6om",
        "--set",
        "cutting_speed=40 m/min",
        "--set",
        "flank_wear=0.2 mm",
        "--json",
    ];
    let result = json(&toolroom(&arguments));
    assert_eq!(result["schema"], 1);
    assert_eq!(result["inputs"]["cutting_speed [m/min]"], 40.0);
    let outputs = &result["outputs"];
    let close = |key: &str, expected: f64, tolerance: f64| {
        let value = outputs[key].as_f64().unwrap_or_else(|| panic!("{key} in {outputs}"));
        assert!((value / expected - 1.0).abs() < tolerance, "{key} = {value}, not {expected}");
    };
    // Reference implementation of the wear model: v*(0.2 mm), life and path at 40 m/min.
    close("minimum_wear_speed [m/min]", 39.997815, 1e-6);
    close("tool_life [min]", 14.932164, 1e-6);
    close("path_life [m]", 597.28658, 1e-6);
    close("temperature [K]", 1028.9, 1e-4);
    close("wear_intensity [um/m]", 0.5, 1e-4);
    assert_eq!(outputs["life_model"], "quasi_steady");
}

#[test]
fn an_edge_that_a_cut_overheats_at_once_has_no_life() {
    let life = |speed: &str, model: &str| {
        let speed = format!("cutting_speed={speed}");
        let cut = ["--set", &speed, "--set", "feed_per_rev=0.4 mm", "--set", "depth_of_cut=3 mm"];
        let point = json(&toolroom(&[&["point", "turning", "--life-model", model, "--json"][..], &cut].concat()));
        (point["outputs"]["tool_life [min]"].as_f64().expect("a life"), point["outputs"]["life_ends_by"].clone())
    };
    let (slower, faster) = (life("80 m/min", "quasi_steady"), life("90 m/min", "quasi_steady"));
    assert!((slower.0 - 0.0148).abs() < 1e-4 && slower.1 == "thermal_collapse", "{slower:?}");
    assert_eq!(faster, (0.0, "thermal_collapse".into()));
}

#[test]
fn point_takes_effects_and_refuses_slips() {
    let plain = json(&toolroom(&["point", "turning", "--set", "flank_wear=0.4 mm", "--json"]));
    let worn =
        json(&toolroom(&["point", "turning", "--set", "flank_wear=0.4 mm", "--effect", "wear_force=0.2", "--json"]));
    assert!(worn["outputs"]["cutting_force [N]"].as_f64() > plain["outputs"]["cutting_force [N]"].as_f64());
    let none =
        json(&toolroom(&["point", "turning", "--set", "flank_wear=0.4 mm", "--effect", "wear_force=0", "--json"]));
    let close = |key: &str| {
        let of = |result: &Value| result["outputs"][key].as_f64().expect("a number");
        assert!((of(&none) / of(&plain) - 1.0).abs() < 1e-7, "{key}");
    };
    close("cutting_force [N]");
    close("minimum_wear_speed [m/min]");
    for (wrong, told) in [
        ("cutting_speed=40", "m/min"),
        ("cuting_speed=40 m/min", "did you mean `cutting_speed`?"),
        ("cutting_speed=40 mm", "m/min"),
        ("cutting_speed=9000 m/min", "outside"),
        ("limits.wear=1", "wear_limit"),
        ("nonsense", "key=value"),
    ] {
        let output = toolroom(&["point", "turning", "--set", wrong]);
        assert_eq!(output.status.code(), Some(2), "{wrong}");
        assert!(stderr(&output).contains(told), "{wrong}: {}", stderr(&output));
    }
}

#[test]
fn every_published_number_is_met_or_named() {
    let output = toolroom(&["validate", "--json"]);
    let claims: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let claims = claims.as_array().expect("a list");
    for model in ["wear", "milling", "infeed"] {
        assert!(claims.iter().any(|claim| claim["model"] == model), "{model}");
    }
    for claim in claims {
        let (published, computed) = (claim["published"].as_f64(), claim["computed"].as_f64());
        let (Some(published), Some(computed)) = (published, computed) else { panic!("{claim}") };
        let scale = if published == 0.0 { 1.0 } else { published.abs() };
        let within = (computed - published).abs() <= claim["tolerance"].as_f64().expect("a number") * scale;
        assert_eq!(claim["pass"], within, "{claim}");
    }
    let failed = claims.iter().any(|claim| claim["pass"] != true);
    assert_eq!(output.status.code(), Some(i32::from(failed)));
}

#[test]
fn explain_knows_its_codes_and_effects_its_catalogue() {
    assert!(stdout(&toolroom(&["explain", "quantity"])).contains("m/min"));
    assert_eq!(toolroom(&["explain", "nonsense"]).status.code(), Some(2));
    let effects = json(&toolroom(&["effects", "--json"]));
    assert!(effects["effects"].as_array().is_some_and(|list| list.iter().any(|effect| effect["id"] == "wear_force")));
    assert!(stdout(&toolroom(&["completions", "bash"])).contains("compare"));
}

#[test]
fn help_leads_with_examples() {
    let help = toolroom(&["--help"]);
    assert_eq!(help.status.code(), Some(0));
    assert!(stdout(&help).starts_with("Examples:"), "{}", stdout(&help));
    for verb in ["check", "compare", "run", "point", "lobes", "new", "demo", "report", "diff", "validate"] {
        let help = toolroom(&[verb, "--help"]);
        assert!(stdout(&help).starts_with("Examples:"), "{verb}");
    }
}

#[test]
fn compare_prints_the_table_and_leaves_a_complete_directory() {
    let dir = directory("compare");
    let out = dir.join("result");
    let output = quick("compare", &out, &[]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let table = stdout(&output);
    for expected in ["parts / shift", "cost / part", "cell gain", "shop gain", "bottleneck"] {
        assert!(table.contains(expected), "{expected} in\n{table}");
    }
    assert!(stderr(&output).contains("toolroom report --open"));
    assert_eq!(names(&dir), ["result"], "no draft is left");
    let files = [
        "events.parquet",
        "jobs.parquet",
        "kpi.csv",
        "operations.parquet",
        "report.html",
        "run.json",
        "states.parquet",
        "study.json",
        "summary.json",
        "tools.parquet",
        "trace.json",
    ];
    assert_eq!(names(&out), files);
    let run: Value = serde_json::from_slice(&fs::read(out.join("run.json")).expect("run.json")).expect("JSON");
    assert_eq!((&run["complete"], &run["replications"], &run["schema"]), (&true.into(), &3.into(), &1.into()));
    let again = quick("compare", &out, &["--json", "--quiet"]);
    let summary = json(&again);
    assert!(stderr(&again).is_empty(), "{}", stderr(&again));
    for key in [
        "seed",
        "replications",
        "policies",
        "differences",
        "cell_gain",
        "shop_gain",
        "cutting_share",
        "bottleneck",
        "digest",
    ] {
        assert!(!summary[key].is_null(), "{key}");
    }
    for key in ["parts_per_shift", "cost_per_part", "edges_per_100_parts", "oee"] {
        let value = &summary["policies"][0]["kpi"][key];
        assert!(value["mean"].is_f64() && value["ci95"][1].is_f64(), "{key}: {value}");
    }
    assert_eq!(summary["policies"][1]["name"], "best constant");
    assert_eq!(names(&dir), ["result"], "the second run took the place of the first");
}

#[test]
fn run_writes_csv_and_report_and_diff_read_it_again() {
    let dir = directory("run");
    let (one, two) = (dir.join("one"), dir.join("two"));
    assert_eq!(quick("run", &one, &["--format", "csv"]).status.code(), Some(0));
    let jobs = fs::read_to_string(one.join("jobs.csv")).expect("a log table");
    assert!(jobs.lines().next().is_some_and(|header| header.contains("arrival [min]")), "{jobs}");
    assert!(jobs.lines().any(|line| line.starts_with("best constant,2,")), "all replications are logged");
    assert_eq!(quick("run", &two, &["--seed", "9", "--logged", "0"]).status.code(), Some(0));
    assert!(!two.join("jobs.parquet").exists());
    let (one, two) = (one.display().to_string(), two.display().to_string());
    let report = toolroom(&["report", &one]);
    assert!(stdout(&report).trim().ends_with("report.html"), "{}", stderr(&report));
    assert_eq!(json(&toolroom(&["diff", &one, &one, "--json"]))["identical"], true);
    let difference = json(&toolroom(&["diff", &one, &two, "--json"]));
    assert_eq!(difference["identical"], false);
    assert!(difference["differences"].as_array().is_some_and(|list| !list.is_empty()));
    assert!(stdout(&toolroom(&["diff", &one, &two])).contains("parts_per_shift"));
    let missing = toolroom(&["diff", &one, "/nowhere"]);
    assert_eq!(missing.status.code(), Some(2), "{}", stderr(&missing));
}

/// A grinder that is busy most of the time with short and long parts.
const BUSY: &str = r#"schema = 1
[shop]
name = "busy"
title = "Short and long parts"
seed = 5
replications = 12
horizon = "24 h"
[[machine]]
name = "G"
process = "infeed"
rate = "60 EUR/h"
load_time = "0 s"
unload_time = "0 s"
[[tool]]
name = "wheel"
process = "infeed"
parameter_set = "zb153u_40kh"
edge_cost = "1 EUR"
[[part]]
name = "short"
[[part.operation]]
name = "grind"
machines = "G"
tool = "wheel"
work_rotation_speed = "120 rpm"
phase = [{ infeed_per_rev = "1 um/rev", revolutions = 60 }]
size_tolerance = "1 mm"
[[part]]
name = "long"
[[part.operation]]
name = "grind"
machines = "G"
tool = "wheel"
work_rotation_speed = "120 rpm"
phase = [{ infeed_per_rev = "1 um/rev", revolutions = 480 }]
size_tolerance = "1 mm"
[[arrivals]]
part = "short"
pattern = "poisson"
rate = "40 1/h"
[[arrivals]]
part = "long"
pattern = "poisson"
rate = "6 1/h"
[[policy]]
name = "programmed"
speed = "programmed"
"#;

/// Values of a figure of the shop in the replications of a run, from its `kpi.csv`.
fn figure(dir: &Path, id: &str) -> Vec<f64> {
    let text = fs::read_to_string(dir.join("kpi.csv")).expect("a table");
    let rows = text.lines().skip(1).map(|line| line.split(',').collect::<Vec<_>>());
    rows.filter(|row| row[2].is_empty() && row[3] == id).map(|row| row[5].parse().expect("a number")).collect()
}

#[test]
fn runs_that_differ_in_the_dispatch_rule_are_compared_in_pairs() {
    let dir = directory("diff");
    let file = dir.join("busy.toml");
    fs::write(&file, BUSY).expect("writable");
    let run = |name: &str, more: &[&str]| {
        let out = dir.join(name).display().to_string();
        let file = file.display().to_string();
        let output = toolroom(&[&["run", &file, "--logged", "0", "--out", &out], more].concat());
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        out
    };
    let fifo = run("fifo", &[]);
    let rule = "dispatch.rule=shortest_processing_time";
    let shortest = run("shortest", &["--set", rule]);
    let seed = run("seed", &["--set", rule, "--seed", "6"]);
    fs::write(&file, BUSY.replace("\"G\"", "\"H\"")).expect("writable");
    let renamed = run("renamed", &["--set", rule]);

    let lead = |other: &str| {
        let all = json(&toolroom(&["diff", &fifo, other, "--json"]));
        let found =
            all["differences"].as_array().and_then(|list| list.iter().find(|row| row["kpi"] == "lead_time [min]"));
        let row = found.expect("a difference").clone();
        let ends = [0, 1].map(|end| row["difference"]["ci95"][end].as_f64().expect("a number"));
        (all, row, 0.5 * (ends[1] - ends[0]))
    };
    let (all, row, half_width) = lead(&shortest);
    assert_eq!((&all["paired"], &all["unpaired_because"]), (&true.into(), &Value::Null));
    // The t interval of twelve differences: 2.200985 is the 97.5 % point of eleven degrees of freedom.
    let [one, two] = [&fifo, &shortest].map(|run| figure(Path::new(run), "lead_time"));
    let pairs: Vec<f64> = one.iter().zip(&two).map(|(one, two)| two - one).collect();
    assert_eq!(pairs.len(), 12);
    let mean = pairs.iter().sum::<f64>() / 12.0;
    let variance = pairs.iter().map(|pair| (pair - mean).powi(2)).sum::<f64>() / 11.0;
    assert!((row["difference"]["mean"].as_f64().expect("a number") - mean).abs() < 1e-9 * mean.abs());
    assert!((half_width - 2.200_985 * (variance / 12.0).sqrt()).abs() < 1e-5 * half_width, "{row}");
    assert!(mean + half_width < 0.0, "the shorter part first shortens the mean lead time: {row}");
    let text = stdout(&toolroom(&["diff", &fifo, &shortest]));
    assert!(text.starts_with("paired by replication on common random numbers"), "{text}");
    let line = text.lines().find(|line| line.contains("lead_time [min]")).expect("a row");
    assert!(line.contains(" ± ") && !line.contains("within the interval"), "{line}");

    // Other random numbers: two samples that have nothing to do with one another.
    for (other, told) in
        [(&seed, "their seeds are 5 and 6"), (&renamed, "machine `G` of the first is not in the second")]
    {
        let (all, row, unpaired) = lead(other);
        assert_eq!((&all["paired"], &all["unpaired_because"]), (&false.into(), &told.into()), "{row}");
        assert!(unpaired > 1.5 * half_width, "{unpaired} against {half_width}");
        let text = stdout(&toolroom(&["diff", &fifo, other]));
        assert!(text.starts_with(&format!("not paired, as {told}; 95 % Welch intervals")), "{text}");
    }

    // A table that was touched is refused with its line.
    let table = Path::new(&seed).join("kpi.csv");
    let broken = fs::read_to_string(&table).expect("a table").replacen("programmed,0,", "programmed,x,", 1);
    fs::write(&table, broken).expect("writable");
    let refused = toolroom(&["diff", &fifo, &seed]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(stderr(&refused).contains("kpi.csv:2: `x` is no replication"), "{}", stderr(&refused));
}

#[test]
fn what_cannot_be_written_is_told_before_any_work() {
    let dir = directory("unwritable");
    fs::write(dir.join("file"), "x").expect("writable");
    fs::create_dir(dir.join("mine")).expect("writable");
    fs::write(dir.join("mine/report.html"), "x").expect("writable");
    for place in ["file", "file/below", "mine"] {
        let output = quick("compare", &dir.join(place), &[]);
        assert_eq!(output.status.code(), Some(2), "{place}: {}", stderr(&output));
        assert!(stdout(&output).is_empty(), "{place}");
    }
    assert_eq!(names(&dir), ["file", "mine"]);
    assert_eq!(names(&dir.join("mine")), ["report.html"]);
}

#[test]
fn a_study_of_nothing_is_an_input_error() {
    let out = directory("nothing").join("out");
    let path = shipped("template");
    let out_name = out.display().to_string();
    let with = |more: &[&str]| toolroom(&[&["compare", &path, "--out", &out_name], more].concat());
    for (more, told) in [
        (&["--replications", "0"][..], "--replications"),
        (&["--set", "shop.replications=0"], "1 to 1000000"),
        (&["--policy", "adaptvie"], "did you mean \"adaptive\"?"),
        (&["--policy", "constant"], "only one policy"),
        (&["--set", "machine.L.tool_change_time=2"], "has no unit"),
        (&["--set", "machine.M.rate=2 EUR/h"], "is not in the file"),
        (&["--until", "often"], "half-width 2%"),
        (&["-P", "shop.seed", "1", "3", "0"], "STEP is positive"),
    ] {
        let output = with(more);
        assert_eq!(output.status.code(), Some(2), "{more:?}: {}", stderr(&output));
        assert!(stderr(&output).contains(told), "{more:?}: {}", stderr(&output));
    }
    assert!(!out.exists());
}

#[test]
fn a_sweep_gives_a_comparison_at_every_value() {
    let out = directory("sweep").join("out");
    let sweep = ["-P", "machine.L.tool_change_time", "1 min", "2 min", "1 min"];
    let result = json(&quick("compare", &out, &[&sweep[..], &["--json"]].concat()));
    let points = result["points"].as_array().expect("points");
    assert_eq!(points.iter().map(|point| point["value"].as_str()).collect::<Vec<_>>(), [Some("1 min"), Some("2 min")]);
    assert!(points[0]["summary"]["digest"] != points[1]["summary"]["digest"]);
}

#[test]
fn precision_stops_a_study_early() {
    let out = directory("until").join("out");
    let (path, out) = (shipped("template"), out.display().to_string());
    let until = ["--until", "half-width 90%", "--replications", "400", "--json"];
    let policies = ["--policy", "constant", "--policy", "best constant", "--set", "shop.horizon=6 h"];
    let result = json(&toolroom(&[&["compare", &path, "--out", &out][..], &until, &policies].concat()));
    assert_eq!(result["complete"], true);
    let replications = result["replications"].as_u64().expect("a count");
    assert!((8..400).contains(&replications), "{replications}");
}

/// Every file of a directory but `run.json`, which tells the time.
fn bytes(dir: &Path) -> Vec<(String, Vec<u8>)> {
    let kept = names(dir).into_iter().filter(|name| name != "run.json");
    kept.map(|name| (name.clone(), fs::read(dir.join(name)).expect("a file"))).collect()
}

fn assert_same(one: &Path, two: &Path) {
    let (one, two) = (bytes(one), bytes(two));
    assert_eq!(
        one.iter().map(|(name, _)| name).collect::<Vec<_>>(),
        two.iter().map(|(name, _)| name).collect::<Vec<_>>()
    );
    for ((name, one), (_, two)) in one.iter().zip(&two) {
        assert!(one == two, "{name} differs");
    }
}

#[test]
fn a_stopped_study_goes_on_to_the_same_bytes() {
    let dir = directory("resume");
    for (verb, more) in [
        ("run", &["--replications", "7"][..]),
        ("run", &["--replications", "7", "--format", "csv"]),
        ("compare", &["--replications", "19", "--until", "half-width 0.001%"]),
    ] {
        let (whole, parts) = (dir.join("whole"), dir.join("parts"));
        let _ = fs::remove_dir_all(&parts);
        let ask = |out: &Path, last: &[&str]| quick_of(verb, out, &[more, last].concat());
        assert_eq!(ask(&whole, &[]).status.code(), Some(0));
        for stop in ["2", "5"] {
            let stopped = ask(&parts, &["--stop-after", stop, "--resume"]);
            assert_eq!(stopped.status.code(), Some(1), "{}", stderr(&stopped));
            assert!(stderr(&stopped).contains("--resume"), "{}", stderr(&stopped));
            let run: Value = serde_json::from_slice(&fs::read(parts.join("run.json")).expect("there")).expect("JSON");
            assert_eq!(run["complete"], false);
            assert_eq!(run["replications"].to_string(), stop);
        }
        let rest = ask(&parts, &["--resume", "--threads", "2"]);
        assert_eq!(rest.status.code(), Some(0), "{}", stderr(&rest));
        assert!(stderr(&rest).contains("going on after 5 replications"), "{}", stderr(&rest));
        assert_same(&whole, &parts);
        let again = ask(&parts, &["--resume"]);
        assert_eq!(again.status.code(), Some(0));
        assert!(stderr(&again).contains("complete"), "{}", stderr(&again));
    }
    assert_eq!(names(&dir), ["parts", "whole"], "no draft is left");
}

#[test]
fn another_study_does_not_go_on_and_says_what_differs() {
    let dir = directory("resume_other");
    let out = dir.join("out");
    assert_eq!(quick("run", &out, &["--stop-after", "1"]).status.code(), Some(1));
    let before = bytes(&out);
    for (verb, more, told) in [
        ("run", &["--seed", "9"][..], "seed was 1 and is 9"),
        ("run", &["--format", "csv"], "format was \"parquet\" and is \"csv\""),
        ("run", &["--logged", "1"], "logged was 3 and is 1"),
        ("run", &["--until", "half-width 2%"], "until was null and is 0.02"),
        ("run", &["--policy", "adaptive"], "policies was"),
        ("run", &["--set", "machine.L.tool_change_time=1 min"], "changes was"),
        ("compare", &["--logged", "3"], "the command was"),
    ] {
        let refused = quick(verb, &out, &[more, &["--resume"]].concat());
        assert_eq!(refused.status.code(), Some(2), "{more:?}: {}", stderr(&refused));
        assert!(stderr(&refused).contains(told), "{more:?}: {}", stderr(&refused));
    }
    // A finished part that the program does not repeat.
    let study = fs::read_to_string(out.join("study.json")).expect("there");
    let number = study.find("[[[").expect("figures") + 3;
    let end = number + study[number..].find([',', ']']).expect("a list");
    fs::write(out.join("study.json"), format!("{}12345.5{}", &study[..number], &study[end..])).expect("writable");
    let refused = quick("run", &out, &["--resume"]);
    assert!(stderr(&refused).contains("study.json was changed since"), "{}", stderr(&refused));
    let refused = quick("run", &out, &["--resume", "--force"]);
    assert!(stderr(&refused).contains("does not repeat"), "{}", stderr(&refused));
    fs::write(out.join("study.json"), study).expect("writable");
    assert!(bytes(&out) == before, "a refusal changes nothing");
    assert_eq!(names(&dir), ["out"], "no draft is left");
}

#[test]
fn a_missing_report_is_drawn_again() {
    let dir = directory("redraw");
    for (name, more, code) in [("whole", &[][..], 0), ("part", &["--stop-after", "2"], 1)] {
        let out = dir.join(name);
        assert_eq!(quick("compare", &out, more).status.code(), Some(code));
        let before = bytes(&out);
        fs::remove_file(out.join("report.html")).expect("there");
        let output = toolroom(&["report", &out.display().to_string()]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        assert!(stdout(&output).trim().ends_with("report.html"));
        assert!(bytes(&out) == before, "{name}: the report is the one that was there");
    }
}

/// A signal `seconds` after the start of an endless study, which ends with `code`.
#[cfg(unix)]
fn interrupted_after(seconds: u64, out: &Path, signal: &str, code: i32) {
    let mut child = Command::new(env!("CARGO_BIN_EXE_toolroom"))
        .args(["compare", &shipped("template"), "--replications", "100000", "--logged", "0", "--out"])
        .arg(out)
        .args(["--policy", "constant", "--policy", "best constant", "--set", "shop.horizon=6 h"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the binary runs");
    std::thread::sleep(std::time::Duration::from_secs(seconds));
    let interrupt = Command::new("kill").args([signal, &child.id().to_string()]).status().expect("kill runs");
    assert!(interrupt.success());
    assert_eq!(child.wait().expect("it ends").code(), Some(code));
}

#[cfg(unix)]
#[test]
fn an_interrupted_study_keeps_what_is_complete() {
    for (signal, code) in [("-INT", 130), ("-TERM", 143)] {
        let dir = directory("interrupt");
        let out = dir.join("out");
        // A busy machine may need longer for its first replications; until then nothing is written.
        for seconds in [1, 4, 16, 64] {
            interrupted_after(seconds, &out, signal, code);
            if out.exists() {
                break;
            }
            assert!(names(&dir).is_empty(), "no draft is left");
        }
        is_readable_as_far_as_it_came(&out);
    }
}

#[cfg(unix)]
fn is_readable_as_far_as_it_came(out: &Path) {
    assert!(names(out).iter().all(|name| !name.starts_with('.')), "no draft and no lock is left");
    let run: Value = serde_json::from_slice(&fs::read(out.join("run.json")).expect("run.json")).expect("JSON");
    assert_eq!(run["complete"], false);
    let done = run["replications"].as_u64().expect("a count");
    assert!((1..100_000).contains(&done), "{done}");
    let report = toolroom(&["report", &out.display().to_string()]);
    assert!(stderr(&report).contains("interrupted"), "{}", stderr(&report));
}

#[test]
fn a_recorded_shop_is_diagnosed_and_its_key_figures_come_nearer() {
    let dir = directory("recorded-shop");
    let path = |name: &str| dir.join(name).display().to_string();
    let nominal = shipped("gap/shop");
    let late = "\n[[deviation]]\nid = \"operator_delay\"\nsize = \"15 s\"\nshift = \"S2\"\n";
    let text = fs::read_to_string(&nominal).expect("a shipped scenario");
    fs::write(path("true.toml"), text + late).expect("writable");
    let (records, out, better) = (path("records"), path("gap"), path("better.toml"));
    let run = ["run", &path("true.toml"), "--replications", "2", "--out", &path("run"), "--records", &records];
    assert_eq!(toolroom(&run).status.code(), Some(0), "{}", stderr(&toolroom(&run)));
    assert_eq!(names(Path::new(&records)), [".toolroom.json", "cuts.csv", "events.csv", "operations.csv"]);
    let found = json(&toolroom(&["gap", "diagnose", "--model", &nominal, "--data", &records, "--out", &out, "--json"]));
    assert_eq!(
        (&found["verdict"], &found["effects"][0]["id"]),
        (&"effect".into(), &"operator_delay".into()),
        "{found}"
    );
    assert_eq!(found["effects"][0]["shape"], "shift=S2");
    let diagnosis = format!("{out}/diagnosis.json");
    let apply = ["gap", "apply", "--model", &nominal, "--diagnosis", &diagnosis, "--out", &better];
    let applied = json(&toolroom(&[&apply[..], &["--data", &records, "--json"]].concat()));
    let cycle = &applied["kpi"][0];
    assert_eq!(cycle["kpi"], "cycle_time");
    assert!(cycle["closed"].as_f64().is_some_and(|closed| closed > 0.7), "{applied}");
    assert_eq!(toolroom(&["check", &better]).status.code(), Some(0));
}
