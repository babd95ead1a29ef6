//! Shops of plain machines that hide nothing are blamed for nothing, whatever their times and queues are like.

use crate::command_line;
use crate::gap_folder::GapFolder;
use serde_json::Value;
use std::fs;

/// The answer to the records that the shop `run` leaves, by the model `planned`, with `set` in both.
fn answer(planned: &str, run: &str, set: &[&str]) -> Value {
    let shop =
        GapFolder::new(&[("model.toml", planned), ("shop.toml", run)]).with(&[set, &["shop.replications=1"]].concat());
    shop.record("shop.toml", 5, "records");
    shop.diagnose("model.toml", "records")
}

/// A shipped shop. Without a simulated tool its log is what is diagnosed, and no section has to say so.
fn shipped(name: &str) -> String {
    let text = fs::read_to_string(command_line::shipped(&format!("shop/{name}"))).expect("a shipped shop");
    if text.contains("parameter_set") { text + "\n[gap]\nprocess = \"shop\"\n" } else { text }
}

/// Exponential times, parts that go back, batches, limited places, shifts: what is as its file says is told so.
#[test]
fn shops_of_wide_times_and_of_queues_that_are_no_queues_are_told_to_be_right() {
    let spt: &[&str] = &["dispatch.rule=spt", "shop.horizon=400 h"];
    let shops: [(&str, &[&str], Option<&str>); 6] = [
        ("rework", &["shop.horizon=400 h"], None),
        ("rework", spt, Some("does not take the first that came")),
        ("furnace", &[], Some("several jobs at a time")),
        ("line", &["shop.horizon=400 h"], Some("places are limited")),
        ("cell", &[], None),
        // Times that do not scatter at all beside exponential ones.
        ("crib", &[], Some("jobs come when others have left")),
    ];
    for (name, set, untested) in shops {
        let model = shipped(name);
        let found = answer(&model, &model, set);
        let notes = found["notes"].to_string();
        assert_eq!(found["verdict"], "no_gap", "{name} {set:?}: {} {notes}", found["facts"]);
        let waits = notes.contains("not tested: waits");
        assert_eq!(waits, untested.is_some(), "{name} {set:?}: {notes}");
        assert!(untested.is_none_or(|reason| notes.contains(reason)), "{name} {set:?}: {notes}");
    }
}

/// A machine on which an operation takes longer by its file is not blamed for that.
#[test]
fn a_machine_that_is_slower_by_its_file_is_told_to_be_right() {
    let plain = "work = { distribution = \"lognormal\", mean = \"8 min\", cv = 0.1 }";
    let shop = format!(
        r#"schema = 1
[shop]
name = "pair"
horizon = "400 h"
replications = 1
[[machine]]
name = "W"
count = 2
process = "plain"
[[part]]
name = "ring"
operation = [{{ name = "weld", machines = "W", {plain}, time_on = {{ W2 = 1.4 }} }}]
[[arrivals]]
part = "ring"
pattern = "poisson"
rate = "8 1/h"
[gap]
process = "shop"
"#
    );
    let found = answer(&shop, &shop, &[]);
    assert_eq!(found["verdict"], "no_gap", "{} {}", found["effects"], found["notes"]);
}

/// A shop of exponential times with its programs slowed is named for it.
#[test]
fn an_override_of_exponential_times_is_named() {
    let model = shipped("rework");
    let slowed = model.clone() + "\n[[deviation]]\nid = \"feed_override\"\nsize = \"0.6\"\n";
    let found = answer(&model, &slowed, &["shop.horizon=400 h"]);
    let names: Vec<&str> =
        found["effects"].as_array().expect("effects").iter().filter_map(|own| own["id"].as_str()).collect();
    assert_eq!((found["verdict"].as_str(), &names[..]), (Some("effect"), &["feed_override"][..]), "{}", found["notes"]);
    let size = found["effects"][0]["size"]["value"].as_f64().expect("a size");
    assert!((0.4..0.8).contains(&size), "{size}");
}

/// What the file says of edges that are ground again is moved as the times of parts are.
#[test]
fn the_grinding_of_edges_again_is_moved_as_other_work() {
    let planned = shipped("crib");
    let slower = planned.replace("mean = \"45 min\"", "mean = \"63 min\"");
    assert_ne!(planned, slower);
    let folder = GapFolder::new(&[("model.toml", &planned), ("shop.toml", &slower)]).with(&["shop.replications=1"]);
    let [before, after] = folder.twice("", [5, 6]);
    assert_ne!(before["verdict"], "no_gap", "{}", before["facts"]);
    assert_eq!(after["verdict"], "no_gap", "{} {}", after["effects"], after["notes"]);
}
