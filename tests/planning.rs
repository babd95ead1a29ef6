//! `toolroom identify`, `grind` and `contour`: published and reference numbers, files, refusals.

use crate::command_line::{directory, stderr, stdout, toolroom};
use serde_json::Value;
use std::fs;
use std::path::Path;

fn shipped(name: &str) -> String {
    format!("{}/scenarios/{name}", env!("CARGO_MANIFEST_DIR"))
}

/// An input file of a test.
fn written(test: &str, name: &str, text: &str) -> String {
    let path = directory("planning", test).join(name);
    fs::write(&path, text).expect("the target directory is writable");
    path.display().to_string()
}

/// The JSON of a verb on a file, results in a directory of the test.
fn result(test: &str, verb: &str, file: &str, more: &[&str]) -> Value {
    let out = directory("planning", &format!("{test}-out")).display().to_string();
    let mut arguments = vec![verb, file, "--json", "--out", &out];
    arguments.extend(more);
    let output = toolroom(&arguments);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {}", stdout(&output)))
}

/// Code, file and line of every problem for which a file is refused.
fn problems(verb: &str, file: &str, more: &[&str]) -> Vec<(String, String, u64, String)> {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out");
    let place = out.display().to_string();
    let mut arguments = vec![verb, file, "--json", "--out", &place];
    arguments.extend(more);
    let output = toolroom(&arguments);
    assert_eq!(output.status.code(), Some(2), "{} {}", stdout(&output), stderr(&output));
    assert!(!out.exists(), "nothing is written");
    let refusal: Value = serde_json::from_slice(&output.stdout).expect("the refusal is JSON");
    assert_eq!(refusal["valid"], false);
    let text = |problem: &Value, key: &str| problem[key].as_str().expect("text").to_owned();
    let problems = refusal["problems"].as_array().expect("a list").iter().map(|problem| {
        let code = text(problem, "code");
        // The terminal shows place and text, and every code has its explanation.
        assert!(stderr(&output).contains(&code));
        assert_eq!(toolroom(&["explain", &code]).status.code(), Some(0), "{code} is not explained");
        (code, text(problem, "file"), problem["line"].as_u64().expect("a line"), text(problem, "message"))
    });
    problems.collect()
}

/// The only problem of a file: code and line, with its message.
fn problem(verb: &str, file: &str, more: &[&str]) -> (String, u64, String) {
    let mut problems = problems(verb, file, more);
    assert_eq!(problems.len(), 1, "{problems:?}");
    let (code, _, line, message) = problems.remove(0);
    (code, line, message)
}

fn close(value: &Value, expected: f64, relative: f64) {
    let value = value.as_f64().unwrap_or_else(|| panic!("{value} is no number"));
    assert!((value - expected).abs() <= relative * expected.abs(), "{value} against {expected}");
}

/// Six significant digits.
const SIX: f64 = 2e-6;

/// The report is one small file without requests.
fn self_contained(folder: &Path) {
    let html = fs::read_to_string(folder.join("report.html")).expect("a report");
    assert!(html.len() < 2_000_000, "{} bytes", html.len());
    assert!(html.matches("<svg").count() >= 3);
    for request in ["<script", "<link", "<img", "<iframe", "src=", "href=\"http", "url(", "@import"] {
        assert!(!html.contains(request), "the report contains {request}");
    }
}

#[test]
fn the_papers_trials_give_the_papers_lag_and_a_consistent_stiffness() {
    let found = result("paper", "identify", &shipped("data/zb153u_trials.csv"), &[]);
    let lags = [0.524176, 0.603305, 0.542099, 0.55243, 0.542561];
    let stiffnesses = [34.8349, 24.546, 32.3858, 31.2031, 30.3912];
    // The reference takes the force for that of the end, of which a trial reaches 1 − K^n.
    let reached = |lag: f64, revolutions: i32| 1.0 - lag.powi(revolutions);
    let trials = found["trials"].as_array().expect("a list").iter();
    for (((trial, lag), stiffness), revolutions) in trials.zip(lags).zip(stiffnesses).zip([16, 16, 18, 17, 17]) {
        close(&trial["K"], lag, SIX);
        close(&trial["system_stiffness [N/um]"], stiffness / reached(lag, revolutions), SIX);
    }
    close(&found["trials"][0]["process_stiffness [N/um]"], 38.3747 / reached(lags[0], 16), SIX);
    close(&found["mean"]["K"], 0.552914, SIX);
    close(&found["mean"]["ci95"][0], 0.515718, SIX);
    close(&found["mean"]["ci95"][1], 0.59011, SIX);
    close(&found["mean"]["prediction95"][1], 0.644025, SIX);
    close(&found["bootstrap"]["ci95"][0], 0.533503, SIX);
    close(&found["pooled"]["K"], 0.554672, SIX);
    close(&found["pooled"]["sd_stock [um]"], 0.71172, SIX);
    close(&found["half_revolution"]["K_minus"], 0.423412, SIX);
    close(&found["half_revolution"]["K_plus"], 0.634894, SIX);
    assert_eq!(found["best_revolutions"], 12);
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("planning-paper-out");
    self_contained(&folder);
    let table = fs::read_to_string(folder.join("trials.csv")).expect("a table");
    assert_eq!(table.lines().count(), 6);
    let run: Value =
        serde_json::from_str(&fs::read_to_string(folder.join("run.json")).expect("a record")).expect("JSON");
    assert_eq!(run["complete"], true);
}

#[test]
fn fresh_trials_with_decimal_commas_agree_with_an_independent_calculation() {
    let text = "trial_id;infeed_per_rev [um];revolutions;stock_removed [um];normal_force [N]\n\
                a;3,1;9;22;95\nb;5,7;20;101;260\nc;2,4;6;9;66\n";
    let found = result("fresh-trials", "identify", &written("fresh-trials", "trials.csv", text), &[]);
    let expected = [0.661_043_636_0, 0.695_335_114_3, 0.724_568_235_5];
    for (trial, lag) in found["trials"].as_array().expect("a list").iter().zip(expected) {
        close(&trial["K"], lag, 1e-9);
    }
    // The calculation took the force of the last of 20 revolutions for that of the end.
    close(&found["trials"][1]["system_stiffness [N/um]"], 19.986_039_105_98 / (1.0 - expected[1].powi(20)), 1e-9);
    close(&found["mean"]["ci95"][0], 0.614_663_730_8, 1e-9);
    close(&found["mean"]["prediction95"][1], 0.851_619_524_2, 1e-9);
    close(&found["pooled"]["K"], 0.691_916_888_5, 1e-7);
    close(&found["half_revolution"]["K_minus"], 0.629_319_001_1, 1e-9);
    assert_eq!(found["best_revolutions"], 17);
}

#[test]
fn a_recorded_force_tells_the_lag_that_a_threshold_force_hides_in_the_stock() {
    let lag: f64 = 0.6;
    let (infeed, stiffness, floor) = (4.0, 40.0, 30.0);
    let mut trace = "trial_id,revolution,normal_force [N]\n".to_owned();
    let steady = stiffness * infeed;
    for i in 1..=20 {
        let rise = 1.0 - lag.powi(i.min(12));
        let force = if i <= 12 { steady * rise } else { steady * rise * lag.powi(i - 12) };
        trace += &format!("t,{i},{}\n", floor + force);
    }
    let folder = directory("planning", "force");
    fs::write(folder.join("force.csv"), trace).expect("writable");
    // The stock lacks what the threshold force keeps uncut.
    fs::write(
        folder.join("trials.csv"),
        "trial_id,infeed_per_rev [um],revolutions,spark_out_revolutions,stock_removed [um],normal_force [N]\n\
         t,4,12,8,46.5,190\n",
    )
    .expect("writable");
    let (trials, force) =
        (folder.join("trials.csv").display().to_string(), folder.join("force.csv").display().to_string());
    let by_force = result("force", "identify", &trials, &["--forces", &force, "--basis", "force"]);
    close(&by_force["trials"][0]["K"], 0.6, 1e-6);
    assert!(by_force["half_revolution"]["K_minus"].is_null(), "the force needs no count of revolutions");
    let by_stock = result("force", "identify", &trials, &["--basis", "stock"]);
    assert!(by_stock["trials"][0]["K"].as_f64().expect("a number") > 0.65, "{by_stock}");
    let both = result("force", "identify", &trials, &["--forces", &force, "--error", "force=0.5 N"]);
    let advice = both["advice"].to_string();
    assert!(advice.contains("threshold force") && advice.contains("single trial"), "{advice}");
}

#[test]
fn impossible_trials_are_left_out_by_name_or_refused_all_at_once() {
    let text = "trial_id,infeed_per_rev [um],revolutions,stock_removed [um]\n\
                good,4,10,35\nfull,4,10,40\nfew,4,1,2\n";
    let file = written("impossible", "trials.csv", text);
    let kept = result("impossible", "identify", &file, &[]);
    assert_eq!(kept["trials"].as_array().map(Vec::len), Some(1));
    let left: Vec<&str> =
        kept["left_out"].as_array().expect("a list").iter().filter_map(|one| one["trial_id"].as_str()).collect();
    assert_eq!(left, ["full", "few"]);
    let found = problems("identify", &file, &["--strict"]);
    let codes: Vec<(&str, u64)> = found.iter().map(|problem| (problem.0.as_str(), problem.2)).collect();
    assert_eq!(codes, [("stock-beyond-infeed", 3), ("too-few-revolutions", 4)]);
    assert!(found[0].3.contains("`full`") && found[1].3.contains("`few`"), "{found:?}");
    let file = written("no-column", "trials.csv", "trial_id,infeed_per_rev [mm],stock_removed [um]\n1,0.004,35\n");
    assert_eq!(problem("identify", &file, &[]).0, "missing-key");
    let wrong = toolroom(&["identify", &file, "--error", "stok=1 um"]);
    assert_eq!(wrong.status.code(), Some(2));
    assert!(stderr(&wrong).contains("did you mean `stock`"), "{}", stderr(&wrong));
}

#[test]
fn the_shipped_cycle_is_the_reference_cycle_and_follows_the_coolant() {
    let file = shipped("grinding/cycle.toml");
    let design = result("cycle", "grind", &file, &[]);
    let cycle = &design["cycle"];
    assert_eq!(cycle["revolutions"], 27);
    close(&cycle["time [s]"], 5.54795, SIX);
    let phases = cycle["phases"].as_array().expect("a list");
    for (phase, (infeed, revolutions)) in phases.iter().zip([(4.92105, 19), (1.3, 5), (0.0, 3)]) {
        close(&phase["infeed_per_rev [um]"], infeed, SIX);
        assert_eq!(phase["revolutions"], revolutions);
    }
    assert_eq!(design["dressing"]["estimated_cycles"]["parts"], 46);
    close(&design["dressing"]["estimated_cycles"]["time_per_part [s]"], 9.97766, 1e-4);
    self_contained(&Path::new(env!("CARGO_TARGET_TMPDIR")).join("planning-cycle-out"));
    // Without dulling within the part the numbers of the reference come out to six digits.
    let sharp = result("cycle", "grind", &file, &["--set", "parameters.dulling_rate=0 mm/mm3"]);
    close(&sharp["cycle"]["last_depth [um]"], 0.251515, 3e-5);
    close(&sharp["cycle"]["size_error [um]"], 0.311158, 3e-5);
    // Of a wheel that dulls within the part, the reference cycle of a dull wheel would break the limit of temperature.
    for (factor, revolutions, dulling) in [("0.75", 18, 18), ("1.25", 36, 38), ("1.5", 48, 49)] {
        let change = format!("conditions.coolant_factor={factor}");
        let set = ["--set", &change, "--set", "parameters.dulling_rate=0 mm/mm3"];
        assert_eq!(result("cycle", "grind", &file, &set)["cycle"]["revolutions"], revolutions, "{factor}");
        let other = result("cycle", "grind", &file, &set[..2]);
        assert_eq!(other["cycle"]["revolutions"], dulling, "{factor}");
        assert!(other["cycle"]["peak_temperature_rise [K]"].as_f64().expect("a number") <= 650.0, "{other}");
    }
}

const TASK: &str = "schema = 1\n[conditions]\nwork_rotation_speed = \"200 rpm\"\n[limits]\nstock = \"60 um\"\n\
                    rough_temperature_rise = \"500 K\"\nfinish_temperature_rise = \"300 K\"\nfinish_stock = \"8 um\"\n\
                    last_depth = \"0.25 um\"\nsize_error = \"0.6 um\"\ninfeed_step = \"0.2 um\"\n";

#[test]
fn fresh_cycles_with_and_without_effects_are_those_of_an_independent_enumeration() {
    let plain = result("fresh-cycle", "grind", &written("fresh-cycle", "task.toml", TASK), &[]);
    assert_eq!(plain["cycle"]["revolutions"], 29);
    close(&plain["cycle"]["last_depth [um]"], 0.214_928_749_4, 1e-4);
    let with = TASK.replace("[conditions]", "effects = [{ id = \"threshold_force\", size = \"5 N\" }]\n[conditions]");
    let with = result("fresh-cycle", "grind", &written("fresh-cycle", "task.toml", &with), &[]);
    assert_eq!(with["cycle"]["revolutions"], 32);
    close(&with["cycle"]["last_depth [um]"], 0.175_630_810_7, 1e-4);
    close(&with["cycle"]["size_error [um]"], 0.378_470_604_2, 1e-4);
    let file = written("fresh-cycle", "task.toml", TASK);
    let by_flag = result("fresh-cycle", "grind", &file, &["--set", "effects.threshold_force=5 N"]);
    assert_eq!(by_flag["cycle"], with["cycle"]);
}

#[test]
fn a_cycle_keeps_what_machine_and_wheel_can_bear() {
    let file = shipped("grinding/cycle.toml");
    let cycle = |set: &[&str]| {
        let set: Vec<&str> = set.iter().flat_map(|change| ["--set", change]).collect();
        result("limits", "grind", &file, &set)["cycle"].clone()
    };
    let number = |cycle: &Value, key: &str| cycle[key].as_f64().expect("a number");
    let sharp = "parameters.dulling_rate=0 mm/mm3";
    let weak = cycle(&[sharp, "limits.power=2 kW"]);
    assert_eq!(weak["revolutions"], 38);
    close(&weak["peak_power [W]"], 1996.5, 3e-5);
    // A soft process stays cool at any depth: the wheel limits it.
    let soft = cycle(&["parameters.process_stiffness=8 N/um"]);
    assert!(number(&soft, "peak_removal_rate [mm2/s]") <= 8.0 + 1e-6, "{soft}");
    assert!(number(&soft, "revolutions") > 10.0, "{soft}");
    let dulling = cycle(&["parameters.dulling_rate=0.00333333333333 mm/mm3"]);
    assert_eq!(dulling["revolutions"], 28);
    close(&dulling["peak_temperature_rise [K]"], 639.3, 1e-4);
    let worst = cycle(&["wheel=worst"]);
    close(&worst["wheel_removed_volume [mm3/mm]"], 43.0 * std::f64::consts::PI * 5.0, 1e-6);
    assert!(number(&worst, "revolutions") > 27.0 && number(&worst, "peak_temperature_rise [K]") <= 650.0, "{worst}");
    let (code, _, message) = problem("grind", &file, &["--set", "limits.roughness=0.3 um"]);
    assert_eq!(code, "limits-conflict");
    assert!(message.contains("[roughness]"), "{message}");
}

#[test]
fn a_cycle_that_no_limit_admits_names_the_limits_and_their_place() {
    let file = written("conflict", "task.toml", &TASK.replace("0.6 um", "0.1 um"));
    let (code, line, message) = problem("grind", &file, &["--set", "effects.threshold_force=5 N"]);
    assert_eq!((code.as_str(), line), ("limits-conflict", 10));
    assert!(message.contains("size_error") && message.contains("threshold force"), "{message}");
    let file = written("conflict", "task.toml", &TASK.replace("\"8 um\"", "\"60 um\""));
    let (code, line, message) = problem("grind", &file, &[]);
    assert_eq!((code.as_str(), line), ("limits-conflict", 8));
    assert!(message.contains("finish_stock") && message.contains("stock"), "{message}");
}

#[test]
fn every_fault_of_a_cycle_file_is_told_with_its_place() {
    let text = "schema = 1\nparameter_set = \"zb153\"\neffects = [{ id = \"runout\", size = \"1 um\" }]\n[limits]\nstok = \"9 um\"\n\
                last_depth = \"1 K\"\n";
    let found = problems("grind", &written("faults", "task.toml", text), &[]);
    let codes: Vec<(&str, u64)> = found.iter().map(|problem| (problem.0.as_str(), problem.2)).collect();
    assert_eq!(codes, [("unknown-name", 2), ("effect", 3), ("unknown-key", 5), ("quantity", 6)]);
}

#[test]
fn the_profile_hole_gains_what_the_paper_reports_under_the_stated_conditions() {
    let plan = result("rk3", "contour", &shipped("contour/rk3.toml"), &["--pass", "finish", "--draws", "20"]);
    let [time, cost] = [&plan["plans"][0], &plan["plans"][1]];
    assert_eq!([&time["objective"], &cost["objective"]], ["time", "cost"]);
    close(&cost["productivity_gain"], 0.1307, 1e-3);
    close(&cost["cost_change"], -0.1516, 1e-3);
    close(&time["productivity_gain"], 0.1464, 1e-3);
    close(&plan["baselines"][0]["time [min]"], 0.556324, SIX);
    close(&plan["baselines"][0]["cost"], 0.321631, SIX);
    let first = &cost["sections"][0];
    assert_eq!(first["spindle_speed [rpm]"], 1600.0);
    close(&first["feed_per_tooth [mm]"], 0.070, 1e-9);
    assert_eq!(first["active_constraint"], "accuracy");
    // The gain is one of these conditions: without the empirical path error it is another.
    let conditions = plan["conditions"].as_array().expect("a list");
    let gain = |name: &str| {
        let condition = conditions.iter().find(|each| each["condition"] == name).unwrap_or_else(|| panic!("{name}"));
        condition["time"]["productivity_gain"].as_f64().expect("a number")
    };
    assert!((gain("no path error") - 1.2812).abs() < 1e-3);
    assert!((gain("path error of ideal servos") - 1.1508).abs() < 1e-3);
    assert_eq!(conditions[0]["cost"]["as_reported"], true);
    let all = plan["sensitivity"].as_array().expect("a list").last().expect("four of them");
    let band = &all["cost"]["productivity_gain"];
    assert!(band["p95"].as_f64() > band["p05"].as_f64());
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("planning-rk3-out");
    self_contained(&folder);
    let program = fs::read_to_string(folder.join("finish-cost.nc")).expect("a part program");
    assert!(program.contains("S1600 M3") && program.contains("F448.0"), "{program}");
    let sections = fs::read_to_string(folder.join("sections.csv")).expect("a table");
    assert_eq!(sections.lines().count(), 1 + 6 * 18);
}

const SETUP: &str = r#"schema = 1
name = "fresh"
title = "Line, hollow, line, bulge"
closed = false
cutter_side = "left"
engagement = "section"
economics = { edge_cost = "12 EUR" }
[[pass]]
name = "semi"
allowance = "0.8 mm"
tolerance = "0.06 mm"
roughness = "12 um"
table_feed = "0.07 mm"
"#;

const DRAWN: &str = r#"[[section]]
line = "40 mm"
[[section]]
arc = "90 deg"
radius = "25 mm"
[[section]]
line = "30 mm"
[[section]]
arc = "-60 deg"
radius = "18 mm"
"#;

/// Time and cost of both plans and of the handbook regime, by an independent implementation.
fn is_the_fresh_plan(plan: &Value, relative: f64) {
    close(&plan["plans"][0]["time [min]"], 0.123_151_467_100_6, relative);
    close(&plan["plans"][0]["cost"], 0.071_747_557_225_3, relative);
    close(&plan["plans"][1]["time [min]"], 0.127_167_058_082_6, relative);
    close(&plan["plans"][1]["cost"], 0.069_859_774_686_2, relative);
    close(&plan["baselines"][0]["time [min]"], 0.296_978_878_179_2, relative);
    close(&plan["baselines"][0]["cost"], 0.161_464_187_604_9, relative);
}

#[test]
fn a_fresh_contour_is_planned_as_an_independent_implementation_plans_it() {
    let file = written("fresh-contour", "contour.toml", &format!("{SETUP}{DRAWN}"));
    let plan = result("fresh-contour", "contour", &file, &["--draws", "0"]);
    is_the_fresh_plan(&plan, 1e-9);
    let feeds: Vec<f64> = plan["plans"][1]["sections"]
        .as_array()
        .expect("a list")
        .iter()
        .map(|section| section["feed_per_tooth [mm]"].as_f64().expect("a number"))
        .collect();
    assert!(feeds.iter().zip([0.224, 0.086, 0.224, 0.224]).all(|(a, b)| (a - b).abs() < 1e-9), "{feeds:?}");
    let ramps = result("fresh-contour", "contour", &file, &["--draws", "0", "--ramps"]);
    assert!(ramps["plans"][0]["ramp_time [min]"].as_f64() > Some(0.0));
    assert!(ramps["plans"][0]["time [min]"].as_f64() > plan["plans"][0]["time [min]"].as_f64());
    let worn = result("fresh-contour", "contour", &file, &["--draws", "0", "--ramps", "--edge", "0"]);
    assert_eq!(worn["plans"][0]["edge_changes"].as_array().map(Vec::len), Some(1));
}

#[test]
fn a_contour_in_g_code_gives_the_plan_of_the_same_contour_in_sections() {
    let setup = written("gcode", "setup.toml", SETUP);
    let (sin, cos) = (std::f64::consts::FRAC_PI_3).sin_cos();
    // The bulge turns right by 60 degrees from the heading +Y.
    let (x, y) = (65.0 + 18.0 * (1.0 - cos), 55.0 + 18.0 * sin);
    let program =
        format!("G21 G90 G41\nG0 X0 Y0\nG1 X40 F100\nG3 X65 Y25 I0 J25\nG1 Y55\nG2 X{x:.5} Y{y:.5} I18 J0\nM30\n");
    let program = written("gcode-program", "part.nc", &program);
    is_the_fresh_plan(&result("gcode", "contour", &setup, &["--gcode", &program, "--draws", "0"]), 1e-4);
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("planning-gcode-program");
    let refused = |text: &str| {
        let path = folder.join("bad.nc");
        fs::write(&path, text).expect("writable");
        let found = problems("contour", &setup, &["--gcode", &path.display().to_string()]);
        assert!(found[0].1.ends_with("bad.nc"), "the fault is in the program: {found:?}");
        (found[0].0.clone(), found[0].2)
    };
    assert_eq!(refused("G21 G41 G0 X0 Y0\nG1 X40\nG3 X65 Y25 I0 J24\n"), ("gcode".to_owned(), 3));
    assert_eq!(refused("G21 G41 G0 X0 Y0\nG1 X40\nG12 I5\n"), ("gcode".to_owned(), 3));
    assert_eq!(refused("G21 G41 G0 X0 Y0\nG1 X40\nG3 X50 Y10 I0 J10\n"), ("cutter-too-large".to_owned(), 3));
}

#[test]
fn a_contour_in_a_drawing_gives_the_plan_of_the_same_contour_in_sections() {
    let setup = written("dxf", "setup.toml", SETUP);
    let entity = |name: &str, layer: &str, pairs: &[(i32, f64)]| {
        let pairs: String = pairs.iter().map(|(code, value)| format!("{code}\n{value}\n")).collect();
        format!("0\n{name}\n8\n{layer}\n{pairs}")
    };
    // In disorder; arcs of a drawing turn left, so that the bulge stands against the direction of travel.
    let drawing = format!(
        "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n{}{}{}{}{}0\nENDSEC\n0\nEOF\n",
        entity("LINE", "WALL", &[(10, 0.0), (20, 0.0), (11, 40.0), (21, 0.0)]),
        entity("ARC", "WALL", &[(10, 83.0), (20, 55.0), (40, 18.0), (50, 120.0), (51, 180.0)]),
        entity("CIRCLE", "HOLES", &[(10, 10.0), (20, 30.0), (40, 4.0)]),
        entity("LINE", "WALL", &[(10, 65.0), (20, 55.0), (11, 65.0), (21, 25.0)]),
        entity("ARC", "WALL", &[(10, 40.0), (20, 25.0), (40, 25.0), (50, 270.0), (51, 0.0)]),
    );
    let path = written("dxf-drawing", "part.dxf", &drawing);
    is_the_fresh_plan(&result("dxf", "contour", &setup, &["--dxf", &path, "--layer", "WALL", "--draws", "0"]), 1e-4);
    // The drawing that a plan leaves holds the contour again, and the centre paths of its programs.
    let left = directory("planning", "dxf-left").join("contour.dxf");
    fs::copy(Path::new(env!("CARGO_TARGET_TMPDIR")).join("planning-dxf-out/contour.dxf"), &left).expect("a drawing");
    let text = fs::read_to_string(&left).expect("a drawing");
    assert!(text.lines().filter(|line| line.ends_with("-TIME")).count() > 5, "{text}");
    let again = ["--dxf", &left.display().to_string(), "--layer", "CONTOUR", "--draws", "0"];
    is_the_fresh_plan(&result("dxf-again", "contour", &setup, &again), 1e-4);
    let found = problems("contour", &setup, &["--dxf", &path]);
    assert!(found[0].0 == "dxf" && found[0].1.ends_with("part.dxf") && found[0].2 > 1, "{found:?}");
}

#[test]
fn bad_contours_are_refused_with_reason_and_place() {
    let refused = |text: &str, more: &[&str]| problem("contour", &written("bad-contour", "contour.toml", text), more);
    let closed = format!("{SETUP}{DRAWN}").replace("closed = false", "closed = true");
    let (code, line, message) = refused(&closed, &[]);
    assert_eq!((code.as_str(), line), ("open-contour", 21));
    assert!(message.contains("closed = false"), "{message}");
    let missed = format!(
        "{SETUP}[[section]]\narc_to = [\"20 mm\", \"0 mm\"]\ncenter = [\"11 mm\", \"0 mm\"]\ndirection = \"left\"\n"
    );
    let (code, line, message) = refused(&missed, &[]);
    assert_eq!((code.as_str(), line), ("arc-misses-end", 14));
    assert!(message.contains("2.0000 mm"), "{message}");
    let tight = format!("{SETUP}{DRAWN}").replace("radius = \"25 mm\"", "radius = \"15 mm\"");
    let (code, line, message) = refused(&tight, &[]);
    assert_eq!((code.as_str(), line), ("cutter-too-large", 16));
    assert!(message.contains("15.0000 mm") && message.contains("16.0000 mm"), "{message}");
    // What no feed can hold: the least feed of the machine against the tolerance on the hollow.
    let drawn = format!("{SETUP}{DRAWN}");
    let (code, line, message) =
        refused(&drawn, &["--set", "pass.tolerance=0.045 mm", "--set", "machine.lowest_feed=900 mm/min"]);
    assert_eq!((code.as_str(), line), ("limits-conflict", 16));
    assert!(message.contains("lowest_feed") && message.contains("accuracy"), "{message}");
    let (code, line, _) = refused(&drawn.replace("allowance =", "alowance ="), &[]);
    assert_eq!((code.as_str(), line), ("unknown-key", 10));
    for (more, word) in [
        (["--pass", "finish"], "semi"),
        (["--set", "economics.edge_price=1 EUR"], "edge_cost"),
        (["--set", "pass.semi.tolerance=1"], "unit"),
        (["--edge", "3"], "0 to 1"),
    ] {
        let path = written("bad-contour", "contour.toml", &drawn);
        let folder = tempfile::tempdir().expect("a folder");
        let out = folder.path().join("out").display().to_string();
        let output = toolroom(&["contour", &path, more[0], more[1], "--out", &out]);
        assert_eq!(output.status.code(), Some(2), "{more:?}");
        assert!(stderr(&output).contains(word), "{more:?}: {}", stderr(&output));
    }
}

#[test]
fn tables_on_the_terminal_say_what_they_compare() {
    let out = directory("planning", "terminal").display().to_string();
    let output = toolroom(&["contour", &shipped("contour/mc1.toml"), "--draws", "0", "--out", &out]);
    let text = stdout(&output);
    for words in [
        "pass rough",
        "pass finish",
        "handbook by section",
        "least cost",
        "all passes",
        "112 sections in sections.csv",
        "+148.6 %",
    ] {
        assert!(text.contains(words), "{words} is missing:\n{text}");
    }
    assert!(stderr(&output).contains("report.html"));
    let text = stdout(&toolroom(&["grind", &shipped("grinding/cycle.toml"), "--out", &out]));
    assert!(text.contains("27 revolutions") && text.contains("dress after 44 parts"), "{text}");
    let text = stdout(&toolroom(&["identify", &shipped("data/zb153u_trials.csv"), "--out", &out]));
    assert!(text.contains("0.55291") && text.contains("0.4234, 0.6349"), "{text}");
}
