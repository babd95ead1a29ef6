//! The gap commands on measured data as it comes: lookalikes of public sets, bad data, and the sets
//! themselves where they are to be had.

use crate::command_line::{shipped, toolroom};
use serde_json::Value;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

/// Diagnosis of a table by a shipped model, with what was said.
fn diagnosis(model: &str, csv: &str) -> (Value, String) {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("operations.csv");
    fs::write(&path, csv).expect("a writable folder");
    let run = toolroom(&["gap", "diagnose", "--model", model, "--data", &path.display().to_string(), "--json"]);
    let said = String::from_utf8_lossy(&run.stderr).into_owned();
    assert_eq!(run.status.code(), Some(0), "{said}");
    (serde_json::from_slice(&run.stdout).expect("JSON"), said)
}

/// Repeatable numbers around zero, about normal.
fn noise(i: usize) -> f64 {
    let uniform = |k: usize| (((i * 12 + k) as f64 * 12.9898).sin() * 43758.547).rem_euclid(1.0);
    (0..12).map(uniform).sum::<f64>() - 6.0
}

/// Turning of `edges` edges whose force follows feed, wear and the edge; `scale` spoils the force.
fn lookalike(edges: usize, wear_force: f64, scale: f64) -> String {
    let mut csv = "operation_id,tool_id,sequence,feed_per_rev [mm],depth_of_cut [mm],cutting_time [min],flank_wear [mm],cutting_force [N]\n".to_owned();
    for edge in 0..edges {
        let level = 0.03 * noise(1000 + edge);
        let rate = 0.02 * (0.2 * noise(2000 + edge)).exp();
        for pass in 0..12_usize {
            let i = 12 * edge + pass;
            let feed: f64 = [0.1, 0.2, 0.3][(pass * 5 + edge) % 3];
            let land = rate * (pass + 1) as f64;
            let force = 2000.0 * feed.powf(0.75) * (level + 0.01 * noise(i)).exp() * (1.0 + wear_force * land / 0.3);
            let _ = writeln!(csv, "{edge}-{pass},T{edge},{},{feed},1,1,{land:.4},{:.3}", pass + 1, force * scale);
        }
    }
    csv
}

fn empirical() -> (tempfile::TempDir, String) {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("model.toml");
    fs::write(&path, "schema = 1\n[gap]\nprocess = \"empirical\"\n").expect("a writable folder");
    let name = path.display().to_string();
    (dir, name)
}

fn ids(diagnosis: &Value) -> Vec<&str> {
    diagnosis["effects"].as_array().expect("a list").iter().filter_map(|effect| effect["id"].as_str()).collect()
}

#[test]
fn force_that_grows_with_wear_is_named_without_a_physical_model() {
    let (_dir, model) = empirical();
    let csv: String = lookalike(12, 0.5, 1.0);
    let (found, _) = diagnosis(&model, &csv);
    assert_eq!((found["verdict"].as_str(), ids(&found).contains(&"wear_force")), (Some("effect"), true), "{found:#}");
    let closed = found["closure"]["channels"]["cutting_force"]["closed"].as_f64().expect("a number");
    assert!(closed > 0.4, "{closed}");
}

#[test]
fn nothing_hidden_in_an_empirical_set_is_no_gap() {
    let (_dir, model) = empirical();
    let (found, _) = diagnosis(&model, &lookalike(12, 0.0, 1.0));
    assert!(ids(&found).is_empty(), "{found:#}");
}

#[test]
fn forces_in_a_wrong_unit_are_said_and_blamed_on_nothing() {
    let (_dir, model) = empirical();
    for scale in [25.4, 60.0, 1000.0, 1.0 / 25.4, 1.0 / 60.0, 1e-3] {
        let (found, _) = diagnosis(&model, &lookalike(8, 0.0, scale));
        let notes = found["notes"].to_string();
        assert!(ids(&found).is_empty(), "{scale}: {found:#}");
        assert!(notes.contains("cutting_force") && notes.contains("unit"), "{scale}: {notes}");
    }
}

/// The numbers of a column, multiplied.
fn scaled(csv: &str, column: &str, factor: f64) -> String {
    let mut lines = csv.lines();
    let head = lines.next().unwrap_or_default();
    let index = head.split(',').position(|title| title.starts_with(column)).expect("the column");
    let mut text = format!("{head}\n");
    for line in lines {
        let cell = |(i, cell): (usize, &str)| match cell.parse::<f64>() {
            Ok(value) if i == index => (value * factor).to_string(),
            _ => cell.to_owned(),
        };
        let cells: Vec<String> = line.split(',').enumerate().map(cell).collect();
        let _ = writeln!(text, "{}", cells.join(","));
    }
    text
}

/// Channels in units that they are not in, of shops that hide nothing: said, and blamed on nothing.
fn wrong_units_are_said(process: &'static str, slips: &[(&str, f64)]) {
    let csv = toolroom_truth::Case::null(process, 7).records();
    for (column, factor) in slips {
        let (found, said) = diagnosis(&shipped(&format!("gap/{process}")), &scaled(&csv, column, *factor));
        let notes = format!("{} {said}", found["notes"]);
        assert!(ids(&found).is_empty(), "{column} ×{factor}: {found:#}");
        assert!(notes.contains(column) && notes.contains("unit"), "{column} ×{factor}: {notes}");
    }
}

#[test]
fn turning_in_wrong_units_is_said() {
    let slips = [("cutting_force", 1e-3), ("flank_wear", 25.4), ("spindle_power", 1000.0), ("cycle_time", 1.0 / 60.0)];
    wrong_units_are_said("turning", &slips);
}

#[test]
fn a_cutting_speed_in_a_wrong_unit_names_nothing() {
    let csv = toolroom_truth::Case::null("turning", 7).records();
    let (found, _) = diagnosis(&shipped("gap/turning"), &scaled(&csv, "cutting_speed", 1.0 / 25.4));
    assert!(ids(&found).is_empty(), "{found:#}");
    assert!(found["notes"].to_string().contains("a condition may be in a wrong unit"), "{}", found["notes"]);
}

#[test]
fn grinding_in_wrong_units_is_said() {
    let slips = [("normal_force", 1e-3), ("stock_removed", 1.0 / 25.4), ("rise_revolutions", 60.0)];
    wrong_units_are_said("grinding", &slips);
}

#[test]
fn milling_in_wrong_units_is_said() {
    wrong_units_are_said("milling", &[("cutting_force", 1e-3), ("flank_wear", 1.0 / 25.4)]);
}

#[test]
fn few_groups_and_constant_channels_name_nothing() {
    let (_dir, model) = empirical();
    let (found, _) = diagnosis(&model, &lookalike(4, 0.5, 1.0));
    assert!(ids(&found).is_empty() && found["verdict"] != "cannot_tell", "{found:#}");
    let constant: String = lookalike(8, 0.0, 1.0)
        .lines()
        .enumerate()
        .map(|(i, line)| {
            if i == 0 {
                format!("{line}\n")
            } else {
                format!("{},700\n", line.rsplit_once(',').map_or("", |(head, _)| head))
            }
        })
        .collect();
    let (found, _) = diagnosis(&model, &constant);
    assert!(ids(&found).is_empty(), "{found:#}");
}

#[test]
fn a_table_without_any_channel_is_refused() {
    let (dir, model) = empirical();
    let path = dir.path().join("operations.csv");
    fs::write(&path, "operation_id,tool_id,sequence,room\n1,A,1,\n2,A,2,n/a\n").expect("a writable folder");
    let run = toolroom(&["gap", "diagnose", "--model", &model, "--data", &path.display().to_string()]);
    assert_eq!(run.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&run.stderr).contains("no channel"), "{run:?}");
}

#[test]
fn too_little_data_is_the_answer_that_it_is() {
    let (dir, model) = empirical();
    let path = dir.path().join("operations.csv");
    let out = dir.path().join("gap");
    let head = "operation_id,tool_id,sequence,cutting_force [N]\n";
    let rows = |edges: usize, each: usize| -> String {
        let row = |i: usize| format!("{i},T{},{},{}\n", i / each, i % each + 1, 700 + i % 5);
        (0..edges * each).map(row).collect()
    };
    let cases = [
        // No row; rows without an edge; no value; one edge; two edges of three values each.
        ("there is no row of data", String::new()),
        ("tool_id is empty", "1,,1,700\n2,,2,710\n".to_owned()),
        ("no row has a value", "1,A,1,\n2,A,2,n/a\n3,B,1,nan\n".to_owned()),
        ("1 group of rows", rows(1, 40)),
        ("cutting_force has 6 values", rows(2, 3)),
    ];
    for (words, rows) in cases {
        fs::write(&path, format!("{head}{rows}")).expect("a writable folder");
        let (data, target) = (path.display().to_string(), out.display().to_string());
        let run = toolroom(&["gap", "diagnose", "--model", &model, "--data", &data, "--out", &target, "--json"]);
        let said = String::from_utf8_lossy(&run.stderr);
        assert_eq!(run.status.code(), Some(3), "{words}: {said}");
        assert!(said.contains("too little data") && said.contains(words), "{words}: {said}");
        let value: Value = serde_json::from_slice(&run.stdout).expect("JSON");
        assert_eq!(value["verdict"], "cannot_tell", "{value:#}");
        assert!(ids(&value).is_empty() && value["notes"].to_string().contains(words), "{value:#}");
        let written = fs::read_to_string(out.join("diagnosis.json")).expect("a diagnosis");
        assert_eq!(serde_json::from_str::<Value>(&written).expect("JSON"), value);
        assert!(fs::read_to_string(out.join("report.html")).expect("a report").contains("too little was measured"));
    }
    // From two edges and eight values on there is another answer.
    fs::write(&path, format!("{head}{}", rows(2, 4))).expect("a writable folder");
    let run = toolroom(&["gap", "diagnose", "--model", &model, "--data", &path.display().to_string()]);
    assert_eq!(run.status.code(), Some(0), "{run:?}");
    assert!(!String::from_utf8_lossy(&run.stdout).contains("too little"), "{run:?}");
}

#[test]
fn a_broken_quote_is_refused_with_its_line() {
    let (dir, model) = empirical();
    let path = dir.path().join("operations.csv");
    let rows = lookalike(4, 0.0, 1.0);
    let broken: Vec<String> =
        rows.lines().enumerate().map(|(i, line)| if i == 5 { format!("\"{line}") } else { line.to_owned() }).collect();
    fs::write(&path, broken.join("\n")).expect("a writable folder");
    let data = path.display().to_string();
    let out = dir.path().join("out").display().to_string();
    for arguments in [
        vec!["gap", "diagnose", "--model", &model, "--data", &data],
        vec!["import", "csv", &data, "--map", &shipped("gap/map-18-tools"), "--out", &out],
    ] {
        let run = toolroom(&arguments);
        let said = String::from_utf8_lossy(&run.stderr);
        assert_eq!(run.status.code(), Some(2), "{said}");
        assert!(said.contains("operations.csv:6:") && said.contains("never closed"), "{said}");
    }
}

#[test]
fn conditions_in_a_wrong_unit_are_refused_with_the_place() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("operations.csv");
    let head = "operation_id,machine,tool_id,sequence,cutting_speed [m/min],feed_per_rev [mm],depth_of_cut [mm],cutting_time [min],cutting_force [N]";
    fs::write(&path, format!("{head}\n1,L,A,1,12000,0.2,1,1,900\n")).expect("a writable folder");
    let run = toolroom(&["gap", "diagnose", "--model", &shipped("gap/turning"), "--data", &path.display().to_string()]);
    let said = String::from_utf8_lossy(&run.stderr);
    assert!(run.status.code() == Some(2) && said.contains("line 2") && said.contains("unit"), "{said}");
}

#[test]
fn a_plan_asks_for_three_edges_and_writes_the_runs() {
    let (dir, model) = empirical();
    let path = dir.path().join("operations.csv");
    fs::write(&path, lookalike(3, 0.0, 1.0)).expect("a writable folder");
    let out = dir.path().join("plan").display().to_string();
    let data = path.display().to_string();
    let run = toolroom(&["gap", "plan", "--model", &model, "--data", &data, "--out", &out, "--json"]);
    assert_eq!(run.status.code(), Some(0), "{run:?}");
    let plan: Value = serde_json::from_slice(&run.stdout).expect("JSON");
    let next = &plan["next"];
    assert!(next["edges"] == 3 && next["minutes"].as_f64().is_some_and(|minutes| minutes > 0.0), "{plan:#}");
    let pairs = next["pairs"].as_array().expect("a list");
    let shown = |pair: &Value| Some(pair["z_after"].as_f64()? - pair["z_before"].as_f64()?);
    assert!(pairs.iter().filter_map(shown).any(|more| more > 0.5), "{plan:#}");
    let runs = fs::read_to_string(Path::new(&out).join("runs.csv")).expect("runs");
    assert!(runs.lines().count() > 30 && !runs.contains("cutting_force"), "{runs}");
}

/// The public sets, where they are: docs/gap-on-real-data.md tells where to get them.
#[allow(clippy::print_stderr)] // a test that is left out says so
fn public(name: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("TOOLROOM_DATA")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data"), PathBuf::from);
    let path = folder.join(name);
    if !path.is_file() {
        eprintln!("skipped: {} is not there (TOOLROOM_DATA names its folder)", path.display());
        return None;
    }
    Some(path)
}

/// Diagnosis of a public set by its shipped mapping and model.
fn of_public(file: &str, map: &str, model: &str) -> Option<Value> {
    let path = public(file)?;
    let dir = tempfile::tempdir().expect("a folder");
    let out = dir.path().join("records").display().to_string();
    let run = toolroom(&[
        "import",
        "csv",
        &path.display().to_string(),
        "--map",
        &shipped(&format!("gap/{map}")),
        "--out",
        &out,
    ]);
    assert_eq!(run.status.code(), Some(0), "{run:?}");
    let run = toolroom(&["gap", "diagnose", "--model", &shipped(&format!("gap/{model}")), "--data", &out, "--json"]);
    assert_eq!(run.status.code(), Some(0), "{run:?}");
    Some(serde_json::from_slice(&run.stdout).expect("JSON"))
}

#[test]
fn three_cutters_of_phm_2010_name_no_cause() {
    let Some(found) = of_public("phm2010-milling-wear.csv", "map-phm2010", "phm2010") else { return };
    assert!(ids(&found).is_empty(), "{found:#}");
    assert!(found["notes"].to_string().contains("too few"), "{}", found["notes"]);
}
