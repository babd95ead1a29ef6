//! A law of lives that was fitted to measured ones enters a shop: its edges are changed as often as renewal theory says.

use crate::command_line::{stderr, toolroom};
use serde_json::Value;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

/// Sixty lives of two materials: quantiles of Weibull laws of shape 2.6, of which a sixth is censored.
fn lives(unit: &str) -> String {
    let mut table = format!("life [{unit}],censored,group\n");
    for (group, scale) in [("steel", 41.0_f64), ("iron", 90.0)] {
        for i in 0..30 {
            let share = (f64::from(i) + 0.5) / 30.0;
            let life = scale * (-(1.0 - share).ln()).powf(1.0 / 2.6);
            let _ = writeln!(table, "{life:.3},{},{group}", u8::from(i % 6 == 5));
        }
    }
    table
}

/// A machine that drills without a break, with the life of its edges as given.
fn shop(life: &str) -> String {
    format!(
        r#"schema = 1
[shop]
name = "renewal"
seed = 7
replications = 30
horizon = "120 h"
[[machine]]
name = "M"
process = "plain"
tool_change_time = "3 min"
[[tool]]
name = "drill"
process = "life_only"
life = {life}
edge_cost = "24 EUR"
[[part]]
name = "plate"
operation = [{{ name = "drill", machines = "M", work = "7 min", tool = "drill" }}]
[[arrivals]]
part = "plate"
pattern = "constant_work"
jobs = 1
"#
    )
}

fn fitted(folder: &Path, name: &str, unit: &str) {
    let data = folder.join(format!("{name}.csv"));
    fs::write(&data, lives(unit)).expect("a table");
    let out = folder.join(name).display().to_string();
    let data = data.display().to_string();
    let output = toolroom(&["life", "--fit", &data, "--bootstrap", "20", "--goodness", "0", "--out", &out]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
}

/// Mean of a figure, and the ends of its 95 % interval.
fn figure(summary: &Value, name: &str) -> [f64; 3] {
    let figure = &summary["policies"][0]["kpi"][name];
    let number = |value: &Value| value.as_f64().unwrap_or_else(|| panic!("{name}: {figure}"));
    [number(&figure["mean"]), number(&figure["ci95"][0]), number(&figure["ci95"][1])]
}

#[test]
fn edges_with_a_fitted_law_of_lives_are_changed_at_the_rate_of_renewals() {
    let folder = tempfile::tempdir().expect("a folder");
    fitted(folder.path(), "lives", "min");
    let file = folder.path().join("shop.toml");
    let life = r#"{ distribution = "fitted", from = "lives/summary.json", law = "weibull", group = "steel" }"#;
    fs::write(&file, shop(life)).expect("a scenario");
    let (file, out) = (file.display().to_string(), folder.path().join("out").display().to_string());
    let output = toolroom(&["run", &file, "--json", "--out", &out]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let summary: Value = serde_json::from_slice(&output.stdout).expect("a summary");

    // The law as it was fitted: mean and coefficient of variation by the gamma function of its shape.
    let text = fs::read_to_string(folder.path().join("lives/summary.json")).expect("a summary");
    let fits: Value = serde_json::from_str(&text).expect("JSON");
    let groups = fits["groups"].as_array().expect("groups");
    let steel = groups.iter().find(|group| group["group"] == "steel").expect("steel");
    let law = steel["fits"].as_array().expect("fits").iter().find(|fit| fit["distribution"] == "weibull");
    let parameters = &law.expect("the law was fitted")["parameters"];
    let (shape, scale) =
        (parameters["shape"].as_f64().expect("shape"), parameters["scale [min]"].as_f64().expect("scale"));
    // Mean and variance by the midpoint rule over equal shares of all edges.
    let shares = 200_000;
    let quantile = |i: i32| scale * (-(1.0 - (f64::from(i) + 0.5) / f64::from(shares)).ln()).powf(1.0 / shape);
    let mean = (0..shares).map(quantile).sum::<f64>() / f64::from(shares);
    let variance = (0..shares).map(|i| (quantile(i) - mean).powi(2)).sum::<f64>() / f64::from(shares);
    let [life, low, high] = figure(&summary, "tool_life [min]");
    assert!(low <= mean && mean <= high, "{life} min ({low} … {high}), by the law {mean}");

    // Edges of a horizon with their change of three minutes: t/μ and the renewal constant (D. R. Cox, Renewal Theory, 1962).
    let (horizon, cycle) = (120.0 * 60.0, mean + 3.0);
    let expected = (horizon / cycle + 0.5 * (variance / (cycle * cycle) - 1.0)) / 120.0;
    let [edges, low, high] = figure(&summary, "edges_per_100_parts");
    let hourly = figure(&summary, "parts_per_shift")[0] / 8.0 / 100.0;
    let (low, high) = (low * hourly, high * hourly);
    assert!(
        low <= expected && expected <= high,
        "{} edges an hour ({low} … {high}), {expected} expected",
        edges * hourly
    );
}

#[test]
fn a_law_that_a_shop_cannot_draw_from_is_refused_with_its_reason() {
    let folder = tempfile::tempdir().expect("a folder");
    fitted(folder.path(), "cuts", "cuts");
    fitted(folder.path(), "lives", "min");
    let file = folder.path().join("shop.toml");
    for (from, more, reason) in [
        ("cuts", "", "is no time"),
        ("lives", r#", group = "steal""#, "did you mean `steel`?"),
        ("none", "", "fitted law of \"none/summary.json\""),
    ] {
        let life = format!(r#"{{ distribution = "fitted", from = "{from}/summary.json", law = "weibull"{more} }}"#);
        fs::write(&file, shop(&life)).expect("a scenario");
        let output = toolroom(&["check", &file.display().to_string()]);
        let said = stderr(&output).split_whitespace().filter(|word| *word != "│").collect::<Vec<_>>().join(" ");
        assert!(output.status.code() == Some(2) && said.contains(reason), "{said}");
    }
}
