//! What the events of machines say beside the records of a process: changes of edges and handling that take longer than the
//! file says are no absence of a gap, and the loop closes for them.

use crate::command_line::{directory, json, shipped, toolroom};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// A shipped model of the diagnosis.
fn model(name: &str) -> String {
    fs::read_to_string(shipped(&format!("gap/{name}"))).expect("a shipped model")
}

/// A run of `truth`, diagnosed by `model` on its folder of records and applied: what was found, the key figures of both and
/// the verdict on a further run.
fn recovered(name: &str, model: &str, truth: &str) -> Value {
    let folder = directory("machine-facts", name);
    let at = |name: &str| Path::join(&folder, name).display().to_string();
    fs::write(at("model.toml"), model).expect("a writable folder");
    fs::write(at("truth.toml"), truth).expect("a writable folder");
    let (model, truth, out) = (at("model.toml"), at("truth.toml"), at("out"));
    let asked = ["--logs", "1", "--seed", "7", "--figures", "--fresh", "--out", &out, "--json"];
    let study = json(&toolroom(&[&["gap", "recovery", "--model", &model, "--truth", &truth][..], &asked].concat()));
    study["logs"][0].clone()
}

/// Asserts that the gap of every key figure closes by four fifths of what the truth closes, and grows nowhere.
fn closes(log: &Value, least: usize) {
    let figures = log["figures"].as_array().expect("a list");
    assert!(figures.len() >= least, "{log:#}");
    for own in figures {
        let share = |key: &str| own[key].as_f64().expect("a share");
        assert!(share("closed") > 0.8 * share("closed_by_truth") && own["grew"] == false, "{own}");
    }
    assert_eq!(log["fresh"]["verdict"], "no_gap", "{log:#}");
}

#[test]
fn changes_of_edges_that_take_three_times_as_long_are_a_constant_of_the_file_or_a_delay() {
    // Fast cuts, so that a night has several changes.
    let model = model("turning").replacen("220 m/min", "300 m/min", 1).replacen("size = 200", "size = 400", 1);
    let truth = format!("{model}\n[[deviation]]\nid = \"tool_change_delay\"\nsize = \"120 s\"\n");
    let log = recovered("changes", &model, &truth);
    assert_eq!((&log["verdict"], &log["hidden"][0]["found"]), (&"constant".into(), &true.into()), "{log:#}");
    let words = log["facts"][0].as_str().expect("a fact");
    assert!(words.starts_with("tool change time of L1, L2: 180 s recorded"), "{words}");
    assert!(words.ends_with("the data do not distinguish it from tool_change_delay of 120.0 s"), "{words}");
    // What the number of a handful of changes makes of the figures is chance.
    assert_eq!(log["fresh"]["verdict"], "no_gap", "{log:#}");
}

#[test]
fn delays_of_operators_at_a_grinder_are_found_and_their_key_figures_close() {
    let model = model("grinding");
    let truth = format!("{model}\n[[deviation]]\nid = \"operator_delay\"\nsize = \"25 s\"\n");
    let log = recovered("grinder", &model, &truth);
    assert_eq!((&log["verdict"], &log["hidden"][0]["found"]), (&"constant".into(), &true.into()), "{log:#}");
    closes(&log, 3);
}

/// A delay of the late shift alone is no constant of a machine: it is named and written as the effect that it is.
#[test]
fn a_delay_of_one_shift_is_named_with_its_scope() {
    let calendar = "[[calendar]]\nname = \"two shifts\"\nperiod = \"8 h\"\n\
        shift = [{ start = \"0 h\", end = \"4 h\" }, { start = \"4 h\", end = \"8 h\" }]\nat_end = \"resume\"\n\n[[machine]]";
    let model = model("grinding")
        .replacen("[[machine]]", calendar, 1)
        .replacen("name = \"G\"", "name = \"G\"\ncalendar = \"two shifts\"", 1)
        .replacen("size = 200", "size = 900", 1);
    let late = "\n[[deviation]]\nid = \"operator_delay\"\nsize = \"25 s\"\nscope = { shift = \"S2\" }\n";
    let log = recovered("late", &model, &format!("{model}{late}"));
    assert_eq!(log["verdict"], "effect", "{log:#}");
    assert_eq!(log["hidden"][0], serde_json::json!({ "found": true, "scope": true, "covered": true }), "{log:#}");
    closes(&log, 3);
}
