//! Pieces that an inspection scraps more often than the file of a shop says: found as a constant, applied, and gone afterwards.

use crate::command_line::toolroom;
use serde_json::Value;
use std::fs;
use std::path::Path;

const PLANNED: &str = r#"
schema = 1
[shop]
name = "inspected"
horizon = "480 h"
replications = 2
[[machine]]
name = "W"
count = 2
process = "plain"
rate = "60 EUR/h"
load_time = { distribution = "lognormal", mean = "40 s", cv = 0.2 }
[[machine]]
name = "C"
process = "plain"
rate = "60 EUR/h"
load_time = { distribution = "lognormal", mean = "30 s", cv = 0.2 }
[[part]]
name = "ring"
[[part.operation]]
name = "weld"
machines = ["W"]
work = { distribution = "lognormal", mean = "8 min", cv = 0.1 }
[[part.operation]]
name = "check"
machines = ["C"]
work = { distribution = "lognormal", mean = "3 min", cv = 0.1 }
outcomes = [{ share = 0.10, go = "weld" }, { share = 0.04, scrap = true }]
[[arrivals]]
part = "ring"
pattern = "poisson"
rate = "6 1/h"
[dispatch]
rule = "fifo"
[[policy]]
name = "programmed"
speed = "programmed"
tool_change = { rule = "part_count", parts = 10 }
[gap]
process = "shop"
"#;

fn done(arguments: &[&str]) {
    let output = toolroom(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn an_inspection_that_scraps_more_than_planned_is_named_applied_and_explained() {
    let worse = PLANNED.replace("share = 0.04", "share = 0.08");
    let dir = tempfile::tempdir().expect("a folder");
    let at = |name: &str| Path::join(dir.path(), name).display().to_string();
    fs::write(at("shop.toml"), &worse).expect("a writable folder");
    fs::write(at("model.toml"), PLANNED).expect("a writable folder");
    for seed in ["1", "2"] {
        done(&["run", &at("shop.toml"), "--seed", seed, "--records", &at(&format!("r{seed}")), "--out", &at("o")]);
    }
    let diagnosed = |model: &str, seed: &str| -> Value {
        let (data, out) = (at(&format!("r{seed}")), at(&format!("d{seed}")));
        done(&["gap", "diagnose", "--model", &at(model), "--data", &data, "--out", &out]);
        let text = fs::read_to_string(at(&format!("d{seed}/diagnosis.json"))).expect("a diagnosis");
        serde_json::from_str(&text).expect("JSON")
    };
    let scrap = |found: &Value| -> Value {
        let facts = found["facts"].as_array().expect("facts");
        facts.iter().find(|fact| fact["fact"] == "scrap").cloned().expect("scrap is tested")
    };
    let first = diagnosed("model.toml", "1");
    assert_eq!(first["verdict"], "constant", "{}", first["notes"]);
    let fact = scrap(&first);
    assert!(fact["rejected"] == true && fact["where"] == "ring/check", "{fact}");
    let constants = first["applied"]["calibration"].as_array().expect("a list");
    let moved = constants.iter().find(|own| own["parameter"] == "scrap").expect("the share");
    assert_eq!(moved["target"], "part ring/check");
    // Pieces that are worked on again come to the inspection again: 4 % of ten ninths are planned, 8 % happen.
    let factor = moved["factor"].as_f64().expect("a factor");
    assert!((factor / 2.0 - 1.0).abs() < 0.2, "{factor}");
    let (diagnosis, applied) = (at("d1/diagnosis.json"), at("applied.toml"));
    done(&["gap", "apply", "--model", &at("model.toml"), "--diagnosis", &diagnosis, "--out", &applied]);
    let second = diagnosed("applied.toml", "2");
    assert_eq!(scrap(&second)["rejected"], false, "{}", second["facts"]);
    assert_eq!(second["verdict"], "no_gap", "{} {}", second["facts"], second["notes"]);
    // The right file is not blamed.
    let right = diagnosed("shop.toml", "1");
    assert_eq!(scrap(&right)["rejected"], false, "{}", right["facts"]);
    assert_eq!(right["verdict"], "no_gap", "{} {}", right["facts"], right["notes"]);
}
