//! Files of the user as `check`, `schema` and `new` meet them.

use super::*;

const SHIPPED: [&str; 8] = [
    "template",
    "demo",
    "constant-vs-adaptive",
    "steel-shafts",
    "adverse",
    "grinder-bottleneck",
    "fmu-lathe-native",
    "lathe-cell",
];

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
    let value_of = |key: &str| values.iter().find(|value| value["key"] == key).unwrap_or_else(|| panic!("{key}"));
    assert_eq!(value_of("tool_change_time")["value"], "3 min");
    assert_eq!(value_of("depth_of_cut")["value"], "0.75 mm");
    assert_eq!(value_of("setup_time")["default"], true);
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
    let message = stderr(&output);
    for expected in [
        "did you mean `tool_change_time`?",
        "accepted: ",
        "0.12 mm/rev",
        "1 to 1000000",
        "4 problems",
        &format!("{path}:12:"),
    ] {
        assert!(message.contains(expected), "{expected} in\n{message}");
    }
    let output = toolroom(&["check", &path, "--json"]);
    assert_eq!(output.status.code(), Some(2));
    let result: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(result["problems"].as_array().map(Vec::len), Some(4));
    assert_eq!(result["problems"][0]["line"], 12);
}

/// One shipped file of every kind that can be read.
const KINDS: [(&str, &str); 14] = [
    ("scenario", "template"),
    ("lobes", "chatter/milling-slot"),
    ("structure", "chatter/spindle"),
    ("tool", "chatter/endmill12"),
    ("life", "life/policies"),
    ("cycle", "grinding/cycle"),
    ("contour", "contour/rk3"),
    ("contour", "contour/cam"),
    ("mapping", "gap/map-vicomtech"),
    ("shop-mapping", "new/shop/map"),
    ("gap", "gap/vicomtech"),
    ("gap", "gap/program"),
    ("machine", "machines/vmc"),
    ("program-setup", "programs/plate-setup"),
];

#[test]
fn check_tells_every_kind_of_file_by_its_content() {
    for (kind, name) in KINDS {
        let text = fs::read_to_string(shipped(name)).expect("shipped");
        let output = toolroom(&["check", &shipped(name), "--json"]);
        assert_eq!(output.status.code(), Some(0), "{name}: {}", stderr(&output));
        let result = json(&output);
        assert_eq!(result["valid"], true, "{name}");
        assert_eq!(result["kind"], kind, "{name}");
        // Neither the name of the file nor a header in a comment tells anything.
        let path = file(&format!("kind_{}", name.replace('/', "_")), format!("# [shop]\n{text}"));
        assert_eq!(json(&toolroom(&["check", &path, "--json"]))["kind"], kind, "{name}");
    }
}

#[test]
fn check_tells_a_slip_in_any_kind_of_file() {
    for (name, from, to, code) in [
        ("chatter/milling-slot", "[chart]", "[chart]\nspeeed = 1", "unknown-key"),
        ("life/policies", "lives = 2000", "lives = 0", "out-of-range"),
        ("grinding/cycle", "coolant_factor = 1.0", "coolant_faktor = 1.0", "unknown-key"),
        (
            "contour/rk3",
            "path_error = { model = \"empirical\" }",
            "path_error = { model = \"none\" }",
            "unknown-choice",
        ),
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
    let message = stderr(&output);
    for (kind, _) in KINDS {
        assert!(message.contains(&format!("{kind} by ")), "{kind} in\n{message}");
    }
    assert!(message.contains("--kind"), "{message}");
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
fn every_kind_has_a_schema() {
    for kind in ["mapping", "gap", "cycle", "contour", "setup"] {
        let schema = json(&toolroom(&["schema", kind]));
        assert!(schema["title"].as_str().is_some_and(|title| title.starts_with("toolroom ")), "{kind}");
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
    let path = directory("cli", "new").join("shop");
    let dir = path.display().to_string();
    assert_eq!(toolroom(&["new", &dir]).status.code(), Some(0));
    let scenario = path.join("scenario.toml").display().to_string();
    assert_eq!(toolroom(&["check", &scenario]).status.code(), Some(0));
    fs::write(&scenario, "mine").expect("writable");
    let again = toolroom(&["new", &dir]);
    assert_eq!(again.status.code(), Some(2), "{}", stderr(&again));
    assert_eq!(fs::read_to_string(&scenario).expect("there"), "mine");
    let other = directory("cli", "new_schema");
    fs::write(other.join("scenario.schema.json"), "mine").expect("writable");
    let refused = toolroom(&["new", &other.display().to_string()]);
    assert_eq!(refused.status.code(), Some(2), "{}", stderr(&refused));
    assert_eq!(names(&other), ["scenario.schema.json"]);
}
