//! `toolroom diff DIR DIR`: which key figures of two runs differ.

use crate::args::DiffArgs;
use crate::failure::Failure;
use crate::results::Results;
use crate::speak::Voice;
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::Path;
use toolroom_form::significant;
use toolroom_statistics::{CONFIDENCE, Interval, t_interval};
use toolroom_study::difference::{Replications, difference, unpaired};

/// A figure that is not the same in both runs.
struct Row<'a> {
    policy: &'a str,
    kpi: &'a str,
    one: f64,
    two: f64,
    difference: Interval,
}

pub fn run(args: &DiffArgs, voice: &Voice) -> Result<(), Failure> {
    let (one, two) = (Results::read(&args.one)?, Results::read(&args.two)?);
    let identical = one.summary["digest"] == two.summary["digest"];
    let [currency, other] = [&one, &two].map(|run| run.summary["currency"].as_str().unwrap_or_default());
    // Money of two currencies is not compared: its figures keep their units and find no partner.
    let money = if currency == other { currency } else { "" };
    let (left, right) = (replications(&args.one, money)?, replications(&args.two, money)?);
    let because = unpaired(&one.run, &two.run);
    let mut rows = Vec::new();
    for (policy, kpi, a, b) in left.common(&right) {
        let [one, two] = [a, b].map(|sample| t_interval(&Vec::from_iter(sample.values().copied()), CONFIDENCE).mean);
        if one.is_finite() && two.is_finite() && one != two {
            rows.push(Row { policy, kpi, one, two, difference: difference(a, b, because.is_none()) });
        }
    }
    let only = |these: &Replications, those: &Replications| -> Vec<String> {
        let others = those.policies();
        these.policies().into_iter().filter(|name| !others.contains(name)).map(str::to_owned).collect()
    };
    let (only_one, only_two) = (only(&left, &right), only(&right, &left));
    if voice.json {
        let differences: Vec<Value> = rows
            .iter()
            .map(|row| {
                let Interval { mean, count, .. } = row.difference;
                let ends = [row.difference.low(), row.difference.high()];
                let difference = json!({ "mean": mean, "ci95": ends, "n": count });
                json!({ "policy": row.policy, "kpi": row.kpi, "one": row.one, "two": row.two, "difference": difference })
            })
            .collect();
        return voice.json(&json!({
            "schema": 1,
            "identical": identical,
            "paired": because.is_none(),
            "unpaired_because": because,
            "currencies": [currency, other],
            "differences": differences,
            "policies_only_in_one": only_one,
            "policies_only_in_two": only_two,
        }));
    }
    let mut text = String::new();
    if !rows.is_empty() {
        let _ = match &because {
            None => writeln!(text, "paired by replication on common random numbers, 95 % t intervals"),
            Some(because) => writeln!(text, "not paired, as {because}; 95 % Welch intervals"),
        };
    }
    let mut last = "";
    for row in &rows {
        if row.policy != last {
            let _ = writeln!(text, "{}", row.policy);
        }
        last = row.policy;
        let change = 100.0 * (row.two - row.one) / row.one.abs();
        let change = if change.is_finite() { format!("{change:+.1} %") } else { String::new() };
        let within = row.difference.half_width.is_finite() && !row.difference.excludes(0.0);
        let note = if within { "   within the interval" } else { "" };
        let _ = writeln!(
            text,
            "  {:34} {:>12} → {:>12} {change:>10}   {}{note}",
            row.kpi,
            significant(row.one),
            significant(row.two),
            shown(&row.difference),
        );
    }
    for (names, dir) in [(only_one, &args.one), (only_two, &args.two)] {
        if !names.is_empty() {
            let _ = writeln!(text, "only in {}: {}", dir.display(), names.join(", "));
        }
    }
    if currency != other {
        let _ = writeln!(text, "money is not compared: {currency} and {other}");
    }
    if text.is_empty() {
        text = if identical { "identical runs" } else { "no key figure differs" }.to_owned();
    }
    voice.data(text.trim_end())
}

fn replications(dir: &Path, currency: &str) -> Result<Replications, Failure> {
    Replications::read(dir, currency)
        .map_err(|error| Failure::argument(error, "give the directory of a finished run, such as out/demo"))
}

/// `-0.295 ± 0.057`: two digits of the half-width; the mean alone where there is none.
fn shown(difference: &Interval) -> String {
    let half_width = difference.half_width;
    if !half_width.is_finite() {
        return significant(difference.mean);
    }
    let lead = half_width.log10().floor();
    if !(-8.0..4.0).contains(&lead) {
        return format!("{} ± {}", significant(difference.mean), significant(half_width));
    }
    let digits = (1.0 - lead).max(0.0) as usize;
    format!("{:+.digits$} ± {half_width:.digits$}", difference.mean)
}
