//! Pieces that an inspection scraps more often than the file of a shop says: found as a constant, applied, and gone afterwards.

use crate::gap_folder::GapFolder;
use serde_json::Value;

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

#[test]
fn an_inspection_that_scraps_more_than_planned_is_named_applied_and_explained() {
    let worse = PLANNED.replace("share = 0.04", "share = 0.08");
    let shop = GapFolder::new(&[("shop.toml", &worse), ("model.toml", PLANNED)]);
    let [first, second] = shop.twice("", [1, 2]);
    let scrap = |found: &Value| -> Value {
        let facts = found["facts"].as_array().expect("facts");
        facts.iter().find(|fact| fact["fact"] == "scrap").cloned().expect("scrap is tested")
    };
    assert_eq!(first["verdict"], "constant", "{}", first["notes"]);
    let fact = scrap(&first);
    assert!(fact["rejected"] == true && fact["where"] == "ring/check", "{fact}");
    let constants = first["applied"]["calibration"].as_array().expect("a list");
    let moved = constants.iter().find(|own| own["parameter"] == "scrap").expect("the share");
    assert_eq!(moved["target"], "part ring/check");
    // Pieces that are worked on again come to the inspection again: 4 % of ten ninths are planned, 8 % happen.
    let factor = moved["factor"].as_f64().expect("a factor");
    assert!((factor / 2.0 - 1.0).abs() < 0.2, "{factor}");
    assert_eq!(scrap(&second)["rejected"], false, "{}", second["facts"]);
    assert_eq!(second["verdict"], "no_gap", "{} {}", second["facts"], second["notes"]);
    // The right file is not blamed.
    let right = shop.diagnose("shop.toml", "first");
    assert_eq!(scrap(&right)["rejected"], false, "{}", right["facts"]);
    assert_eq!(right["verdict"], "no_gap", "{} {}", right["facts"], right["notes"]);
}
