//! Jobs that come more often than the file of a shop says: found as a constant, applied, and gone afterwards.

use crate::command_line::toolroom;
use serde_json::Value;
use std::fs;
use std::path::Path;

fn done(arguments: &[&str]) {
    let output = toolroom(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn a_source_that_brings_more_than_planned_is_named_applied_and_explained() {
    let shipped = format!("{}/scenarios/gap/shop.toml", env!("CARGO_MANIFEST_DIR"));
    let planned =
        fs::read_to_string(shipped).expect("the shipped model").replace("horizon = \"240 h\"", "horizon = \"96 h\"");
    let busy = planned.replacen("rate = \"6 1/h\"", "rate = \"7.5 1/h\"", 1);
    assert_ne!(planned, busy);
    let dir = tempfile::tempdir().expect("a folder");
    let at = |name: &str| Path::join(dir.path(), name).display().to_string();
    fs::write(at("shop.toml"), &busy).expect("a writable folder");
    fs::write(at("model.toml"), &planned).expect("a writable folder");
    for seed in ["1", "2"] {
        done(&["run", &at("shop.toml"), "--seed", seed, "--records", &at(&format!("r{seed}")), "--out", &at("o")]);
    }
    let diagnosed = |model: &str, seed: &str| -> Value {
        let (data, out) = (at(&format!("r{seed}")), at(&format!("d{seed}")));
        done(&["gap", "diagnose", "--model", &at(model), "--data", &data, "--out", &out]);
        let text = fs::read_to_string(at(&format!("d{seed}/diagnosis.json"))).expect("a diagnosis");
        serde_json::from_str(&text).expect("JSON")
    };
    let rejected = |found: &Value| -> Vec<String> {
        let facts = found["facts"].as_array().expect("facts");
        let arrivals: Vec<&Value> = facts.iter().filter(|fact| fact["fact"] == "arrival_interval").collect();
        assert_eq!(arrivals.len(), 3, "every source is tested: {}", found["facts"]);
        let off = arrivals.into_iter().filter(|fact| fact["rejected"] == true);
        off.map(|fact| fact["where"].as_str().expect("a part").to_owned()).collect()
    };
    let first = diagnosed("model.toml", "1");
    assert_eq!(first["verdict"], "constant", "{}", first["notes"]);
    assert_eq!(rejected(&first), ["shaft"]);
    let constants = first["applied"]["calibration"].as_array().expect("a list");
    let moved = constants.iter().find(|own| own["parameter"] == "arrival_interval").expect("the interval");
    assert_eq!(moved["target"], "source shaft");
    // 7.5 jobs an hour come where 6 are planned, some seven hundred of them.
    let factor = moved["factor"].as_f64().expect("a factor");
    assert!((factor * 7.5 / 6.0 - 1.0).abs() < 0.12, "{factor}");
    let (diagnosis, applied) = (at("d1/diagnosis.json"), at("applied.toml"));
    done(&["gap", "apply", "--model", &at("model.toml"), "--diagnosis", &diagnosis, "--out", &applied]);
    let second = diagnosed("applied.toml", "2");
    assert_eq!(rejected(&second), Vec::<String>::new());
    assert_eq!(second["verdict"], "no_gap", "{}", second["facts"]);
    // Without the jobs that came nobody can know, and it is said.
    let output = toolroom(&["gap", "diagnose", "--model", &at("model.toml"), "--data", &at("r1/events.csv"), "--json"]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.contains("not tested: arrivals"), "{text}");
}
