//! `toolroom diff DIR DIR`: which key figures of two runs differ.

use crate::args::DiffArgs;
use crate::failure::Failure;
use crate::results::Results;
use crate::speak::Voice;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fmt::Write;
use toolroom_scenario::file::significant;

/// Mean and half-width of the interval of one figure of one policy.
type Figures = BTreeMap<(String, String), (f64, f64)>;

pub fn run(args: &DiffArgs, voice: &Voice) -> Result<(), Failure> {
    let (one, two) = (Results::read(&args.one)?, Results::read(&args.two)?);
    let identical = one.summary["digest"] == two.summary["digest"];
    let (left, right) = (figures(&one.summary), figures(&two.summary));
    let mut rows = Vec::new();
    for ((policy, figure), (a, _)) in &left {
        let Some((b, half_width)) = right.get(&(policy.clone(), figure.clone())) else { continue };
        if a != b {
            rows.push((policy, figure, *a, *b, *half_width));
        }
    }
    let only = |these: &Figures, those: &Figures| -> Vec<String> {
        let mut names: Vec<String> = these.keys().map(|(policy, _)| policy.clone()).collect();
        names.retain(|name| those.keys().all(|(policy, _)| policy != name));
        names.dedup();
        names
    };
    let (only_one, only_two) = (only(&left, &right), only(&right, &left));
    if voice.json {
        let differences: Vec<Value> = rows
            .iter()
            .map(|(policy, figure, a, b, _)| json!({ "policy": policy, "kpi": figure, "one": a, "two": b }))
            .collect();
        return voice.json(&json!({
            "schema": 1,
            "identical": identical,
            "differences": differences,
            "policies_only_in_one": only_one,
            "policies_only_in_two": only_two,
        }));
    }
    let mut text = String::new();
    let mut last = "";
    for (policy, figure, a, b, half_width) in rows {
        if policy.as_str() != last {
            let _ = writeln!(text, "{policy}");
        }
        last = policy;
        let change = if a == 0.0 { String::new() } else { format!("{:+.1} %", 100.0 * (b - a) / a.abs()) };
        // Two runs share no random numbers unless their seeds agree: the interval says how much to believe.
        let beyond = if (b - a).abs() > half_width { "" } else { "   within the interval" };
        let _ = writeln!(text, "  {figure:34} {:>12} → {:>12} {change:>10}{beyond}", significant(a), significant(b));
    }
    for (names, dir) in [(only_one, &args.one), (only_two, &args.two)] {
        if !names.is_empty() {
            let _ = writeln!(text, "only in {}: {}", dir.display(), names.join(", "));
        }
    }
    if text.is_empty() {
        text = if identical { "identical runs" } else { "no key figure differs" }.to_owned();
    }
    voice.data(text.trim_end())
}

fn figures(summary: &Value) -> Figures {
    let mut figures = Figures::new();
    for policy in summary["policies"].as_array().into_iter().flatten() {
        let Some(name) = policy["name"].as_str() else { continue };
        for (figure, value) in policy["kpi"].as_object().into_iter().flatten() {
            let Some(mean) = value["mean"].as_f64() else { continue };
            let half_width = value["ci95"][1].as_f64().map_or(0.0, |high| high - mean);
            figures.insert((name.to_owned(), figure.clone()), (mean, half_width));
        }
    }
    figures
}
