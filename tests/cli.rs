//! The command line as a user meets it: output, errors, exit codes, files.

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

const SHIPPED: [&str; 6] =
    ["template", "demo", "constant-vs-adaptive", "steel-shafts", "adverse", "grinder-bottleneck"];

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
    assert!(stderr(&cyrillic).contains(":2:3: ") && stderr(&cyrillic).contains("Windows-1251"), "{}", stderr(&cyrillic));
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
fn the_shipped_schema_is_the_printed_one() {
    let printed = json(&toolroom(&["schema"]));
    let shipped = fs::read_to_string(format!("{}/scenarios/schema/scenario.schema.json", env!("CARGO_MANIFEST_DIR")));
    let shipped: Value = serde_json::from_str(&shipped.expect("shipped")).expect("JSON");
    assert!(printed == shipped, "run: toolroom schema > scenarios/schema/scenario.schema.json");
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
}

#[test]
fn point_meets_the_reference_numbers_of_turning() {
    let arguments = ["point", "turning", "--tool", "ni_vk6om", "--set", "cutting_speed=40 m/min", "--set", "flank_wear=0.2 mm", "--json"];
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
fn point_takes_effects_and_refuses_slips() {
    let plain = json(&toolroom(&["point", "turning", "--set", "flank_wear=0.4 mm", "--json"]));
    let worn = json(&toolroom(&["point", "turning", "--set", "flank_wear=0.4 mm", "--effect", "wear_force=0.2", "--json"]));
    assert!(worn["outputs"]["cutting_force [N]"].as_f64() > plain["outputs"]["cutting_force [N]"].as_f64());
    let none = json(&toolroom(&["point", "turning", "--set", "flank_wear=0.4 mm", "--effect", "wear_force=0", "--json"]));
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
    for verb in ["check", "compare", "run", "point", "new", "demo", "report", "diff", "validate"] {
        let help = toolroom(&[verb, "--help"]);
        assert!(stdout(&help).starts_with("Examples:"), "{verb}");
    }
}
