//! Jobs that come more often than the file of a shop says: found as a constant, applied, and gone afterwards.

use crate::command_line::{shipped, stdout, toolroom};
use crate::gap_folder::GapFolder;
use serde_json::Value;
use std::fs;

#[test]
fn a_source_that_brings_more_than_planned_is_named_applied_and_explained() {
    let planned = fs::read_to_string(shipped("gap/shop")).expect("the shipped model");
    let planned = planned.replace("horizon = \"240 h\"", "horizon = \"96 h\"");
    let busy = planned.replacen("rate = \"6 1/h\"", "rate = \"7.5 1/h\"", 1);
    assert_ne!(planned, busy);
    let shop = GapFolder::new(&[("shop.toml", &busy), ("model.toml", &planned)]);
    let [first, second] = shop.twice("", [1, 2]);
    let rejected = |found: &Value| -> Vec<String> {
        let facts = found["facts"].as_array().expect("facts");
        let arrivals: Vec<&Value> = facts.iter().filter(|fact| fact["fact"] == "arrival_interval").collect();
        assert_eq!(arrivals.len(), 3, "every source is tested: {}", found["facts"]);
        let off = arrivals.into_iter().filter(|fact| fact["rejected"] == true);
        off.map(|fact| fact["where"].as_str().expect("a part").to_owned()).collect()
    };
    assert_eq!(first["verdict"], "constant", "{}", first["notes"]);
    assert_eq!(rejected(&first), ["shaft"]);
    let constants = first["applied"]["calibration"].as_array().expect("a list");
    let moved = constants.iter().find(|own| own["parameter"] == "arrival_interval").expect("the interval");
    assert_eq!(moved["target"], "source shaft");
    // 7.5 jobs an hour come where 6 are planned, some seven hundred of them.
    let factor = moved["factor"].as_f64().expect("a factor");
    assert!((factor * 7.5 / 6.0 - 1.0).abs() < 0.12, "{factor}");
    assert_eq!(rejected(&second), Vec::<String>::new());
    assert_eq!(second["verdict"], "no_gap", "{}", second["facts"]);
    // Without the jobs that came nobody can know, and it is said.
    let (model, events) = (shop.at("model.toml"), shop.at("first/events.csv"));
    let text = stdout(&toolroom(&["gap", "diagnose", "--model", &model, "--data", &events, "--json"]));
    assert!(text.contains("not tested: arrivals"), "{text}");
}
