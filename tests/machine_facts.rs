//! What the events of machines say beside the records of a process: changes of edges and handling that take longer than the
//! file says are no absence of a gap, and the loop closes for them.

use crate::command_line::{directory, json, toolroom};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// A run of `truth`, diagnosed by `model` on its folder of records and applied: the diagnosis, the key figures, and the
/// diagnosis of another run by the model that was written.
fn closed(name: &str, model: &str, truth: &str) -> [Value; 3] {
    let folder = directory("machine-facts", name);
    let at = |name: &str| Path::join(&folder, name).display().to_string();
    fs::write(at("model.toml"), model).expect("a writable folder");
    fs::write(at("truth.toml"), truth).expect("a writable folder");
    let done = |arguments: &[&str]| {
        let output = toolroom(arguments);
        assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
        output
    };
    for (records, seed) in [("r1", "7"), ("r2", "8")] {
        done(&["run", &at("truth.toml"), "--seed", seed, "--records", &at(records), "--out", &at(&format!("o{seed}"))]);
    }
    let diagnosed = |model: &str, records: &str, out: &str| -> Value {
        done(&["gap", "diagnose", "--model", &at(model), "--data", &at(records), "--out", &at(out)]);
        let text = fs::read_to_string(at(&format!("{out}/diagnosis.json"))).expect("a diagnosis");
        serde_json::from_str(&text).expect("JSON")
    };
    let first = diagnosed("model.toml", "r1", "d1");
    let diagnosis = at("d1/diagnosis.json");
    let (read, written, data) = (at("model.toml"), at("applied.toml"), at("r1"));
    let applied =
        ["gap", "apply", "--model", &read, "--diagnosis", &diagnosis, "--out", &written, "--data", &data, "--json"];
    let figures = json(&done(&applied))["kpi"].clone();
    [first, figures, diagnosed("applied.toml", "r2", "d2")]
}

fn shipped(name: &str) -> String {
    fs::read_to_string(crate::command_line::shipped(&format!("gap/{name}"))).expect("a shipped model")
}

/// Whether the figures with a gap close by 0.8 at least; how many there are.
fn closing(figures: &Value) -> usize {
    let list = figures.as_array().expect("a list");
    let shares = list.iter().filter_map(|own| Some((own["kpi"].as_str()?, own["closed"].as_f64()?)));
    let shares: Vec<(&str, f64)> = shares.collect();
    assert!(shares.iter().all(|(_, share)| *share > 0.8), "{shares:?}");
    assert!(list.iter().all(|own| own["grew"] == false), "{figures}");
    shares.len()
}

#[test]
fn changes_that_take_three_times_as_long_are_named_and_their_key_figures_close() {
    let model = shipped("turning");
    let truth = format!("{model}\n[[deviation]]\nid = \"tool_change_delay\"\nsize = \"120 s\"\n");
    let [first, figures, second] = closed("changes", &model, &truth);
    assert_eq!(first["verdict"], "constant", "{}", first["facts"]);
    let facts = first["facts"].as_array().expect("facts");
    let found: Vec<&Value> = facts.iter().filter(|fact| fact["rejected"] == true).collect();
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!((&found[0]["fact"], &found[0]["where"]), (&"tool_change_time".into(), &"L1, L2".into()));
    assert_eq!(found[0]["class"], serde_json::json!(["tool_change_time", "tool_change_delay"]));
    assert!((found[0]["factor"].as_f64().expect("a factor") - 3.0).abs() < 0.05, "{}", found[0]);
    assert!(closing(&figures) > 0, "{figures}");
    assert_eq!(second["verdict"], "no_gap", "{}", second["facts"]);
}

#[test]
fn delays_of_operators_at_a_grinder_are_named_and_their_key_figures_close() {
    let model = shipped("grinding");
    let truth = format!("{model}\n[[deviation]]\nid = \"operator_delay\"\nsize = \"25 s\"\n");
    let [first, figures, second] = closed("grinder", &model, &truth);
    assert_eq!(first["verdict"], "constant", "{}", first["facts"]);
    let facts = first["facts"].as_array().expect("facts");
    let found = facts.iter().find(|fact| fact["rejected"] == true).expect("a finding");
    assert_eq!(found["class"], serde_json::json!(["handling_time", "operator_delay"]), "{found}");
    assert!(closing(&figures) > 2, "{figures}");
    assert_eq!(second["verdict"], "no_gap", "{}", second["facts"]);
}

/// A delay of the late shift alone is no constant of a machine: it is written as the effect that it is.
#[test]
fn a_delay_of_one_shift_is_written_with_its_scope() {
    let calendar = "[[calendar]]\nname = \"two shifts\"\nperiod = \"8 h\"\n\
        shift = [{ start = \"0 h\", end = \"4 h\" }, { start = \"4 h\", end = \"8 h\" }]\nat_end = \"resume\"\n\n[[machine]]";
    let model = shipped("grinding")
        .replacen("[[machine]]", calendar, 1)
        .replacen("name = \"G\"", "name = \"G\"\ncalendar = \"two shifts\"", 1)
        .replacen("size = 200", "size = 900", 1);
    let late = "\n[[deviation]]\nid = \"operator_delay\"\nsize = \"25 s\"\nscope = { shift = \"S2\" }\n";
    let [first, figures, second] = closed("late", &model, &format!("{model}{late}"));
    assert_eq!((&first["verdict"], &first["effects"][0]["id"]), (&"effect".into(), &"operator_delay".into()));
    let written = first["applied"]["effects"].as_array().expect("effects");
    assert!(!written.is_empty(), "{}", first["facts"]);
    for own in written {
        assert_eq!(own["id"], "operator_delay", "{own}");
        assert_eq!(own["scope"]["shift"], serde_json::json!(["S2"]), "{own}");
        assert!((own["size"]["value"].as_f64().expect("a size") - 25.0).abs() < 0.5, "{own}");
    }
    assert!(closing(&figures) > 2, "{figures}");
    assert_eq!(second["verdict"], "no_gap", "{}", second["facts"]);
}
