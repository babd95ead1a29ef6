//! The answers as tables, JSON and text.

use super::answers::{Answers, OrderAnswer, shown, stamped};
use super::{Figures, LoadKind, answers};
use crate::study::Study;
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::io;
use toolroom_process::table::{Cell, CsvWriter};
use toolroom_scenario::{Scenario, date, station_name};

/// Files with the answers, beside the other results of a scenario with orders.
pub const FILES: [&str; 4] = ["orders.csv", "load.csv", "queues.csv", "wip.csv"];

/// Most orders that are named on a terminal.
const MOST_NAMED: usize = 20;

/// Minutes; empty where there are none.
fn minutes(seconds: f64) -> Cell<'static> {
    if seconds.is_nan() { Cell::Empty } else { (seconds / 60.0).into() }
}

fn share(value: f64) -> Cell<'static> {
    if value.is_nan() { Cell::Empty } else { value.into() }
}

/// Writes one of [`FILES`], with the rows of every policy.
///
/// # Errors
/// What the writer says.
pub fn write(name: &str, scenario: &Scenario, study: &Study, out: impl io::Write) -> io::Result<()> {
    let named = |position: usize| scenario.policies[study.policies[position]].name.as_str();
    let every = (0..study.policies.len()).filter_map(|each| Some((named(each), answers(scenario, study, each)?)));
    match name {
        "orders.csv" => write_orders(scenario, every, out),
        "load.csv" => write_loads(scenario, every, out),
        "queues.csv" => write_queues(scenario, every, out),
        _ => write_wip(scenario, every, out),
    }
}

fn write_orders<'a>(
    scenario: &Scenario,
    every: impl Iterator<Item = (&'a str, Answers)>,
    out: impl io::Write,
) -> io::Result<()> {
    let header = [
        "policy",
        "id",
        "part",
        "customer",
        "quantity",
        "release",
        "due",
        "finish_mean",
        "finish_p50",
        "finish_p80",
        "finish_p95",
        "tardiness_mean [min]",
        "on_time",
        "on_time_low",
        "on_time_high",
        "unfinished",
        "pieces_lost",
        "waited_longest",
        "waited_longest_share",
        "waited_there [min]",
    ];
    let mut csv = CsvWriter::new(out, header)?;
    for (policy, all) in every {
        for answer in &all.orders {
            let order = &scenario.orders[answer.order];
            let [p50, p80, p95] = answer.quantiles.map(|finish| Cell::Own(finish.stamped(scenario)));
            csv.row([
                policy.into(),
                (&order.id).into(),
                (&scenario.parts[order.part].name).into(),
                (&order.customer).into(),
                order.quantity.into(),
                stamped(scenario, order.release).into(),
                stamped(scenario, order.due).into(),
                stamped(scenario, answer.mean).into(),
                p50,
                p80,
                p95,
                minutes(answer.tardiness),
                share(answer.share),
                share(answer.interval[0]),
                share(answer.interval[1]),
                share(answer.unfinished as f64 / answer.replications as f64),
                answer.lost.into(),
                answer
                    .longest
                    .map_or(Cell::Empty, |longest| Cell::Own(station(scenario, &all.queues[longest.station].machines))),
                answer
                    .longest
                    .map_or(Cell::Empty, |longest| share(longest.replications as f64 / answer.replications as f64)),
                answer.longest.map_or(Cell::Empty, |longest| minutes(longest.wait)),
            ])?;
        }
    }
    Ok(csv.flush()?)
}

fn write_loads<'a>(
    scenario: &Scenario,
    every: impl Iterator<Item = (&'a str, Answers)>,
    out: impl io::Write,
) -> io::Result<()> {
    let weeks = Figures::of(scenario).weeks;
    let times = LoadKind::of_scenario(scenario).map(|kind| format!("{} [h]", kind.name()));
    let header = ["policy", "resource", "week", "load", "load_p90"].map(str::to_owned).into_iter().chain(times);
    let mut csv = CsvWriter::new(out, header)?;
    for (policy, all) in every {
        for answer in all.loads {
            let first = [
                policy.into(),
                resource_name(scenario, answer.resource).into(),
                (&weeks[answer.week].name).into(),
                share(answer.load()),
                share(answer.high_load),
            ];
            let times = LoadKind::of_scenario(scenario).map(|kind| Cell::from(answer.mean(kind) / 3600.0));
            csv.row(first.into_iter().chain(times))?;
        }
    }
    Ok(csv.flush()?)
}

fn write_queues<'a>(
    scenario: &Scenario,
    every: impl Iterator<Item = (&'a str, Answers)>,
    out: impl io::Write,
) -> io::Result<()> {
    let header = [
        "policy",
        "station",
        "length_mean",
        "length_p95",
        "longest_mean",
        "longest_p95",
        "wait_mean [min]",
        "wait_p95 [min]",
        "wait_total [h]",
    ];
    let mut csv = CsvWriter::new(out, header)?;
    for (policy, all) in every {
        for answer in all.queues {
            csv.row([
                policy.into(),
                station(scenario, &answer.machines).into(),
                share(answer.length),
                share(answer.upper_length),
                share(answer.longest[0]),
                share(answer.longest[1]),
                minutes(answer.wait[0]),
                minutes(answer.wait[1]),
                (answer.total / 3600.0).into(),
            ])?;
        }
    }
    Ok(csv.flush()?)
}

fn write_wip<'a>(
    scenario: &Scenario,
    every: impl Iterator<Item = (&'a str, Answers)>,
    out: impl io::Write,
) -> io::Result<()> {
    let header =
        ["policy", "time", "orders_mean", "orders_p10", "orders_p90", "work_mean [h]", "work_p10 [h]", "work_p90 [h]"];
    let mut csv = CsvWriter::new(out, header)?;
    for (policy, all) in every {
        for answer in all.wip {
            let work = answer.work.map(|seconds| Cell::from(seconds / 3600.0));
            let first = [policy.into(), stamped(scenario, answer.time).into()];
            csv.row(first.into_iter().chain(answer.orders.map(share)).chain(work))?;
        }
    }
    Ok(csv.flush()?)
}

/// Name of a machine, or of a person behind them.
pub(crate) fn resource_name(scenario: &Scenario, resource: usize) -> &str {
    match scenario.machines.get(resource) {
        Some(machine) => &machine.name,
        None => &scenario.operators[resource - scenario.machines.len()].name,
    }
}

/// Name of a station: of its machines.
pub(crate) fn station(scenario: &Scenario, machines: &[usize]) -> String {
    station_name(machines.iter().map(|&machine| scenario.machines[machine].name.as_str()))
}

/// The answers under the first policy for programs: `orders`, `resources`, `queues` and `wip` of a summary.
pub fn json(scenario: &Scenario, study: &Study) -> Option<[(&'static str, Value); 4]> {
    let all = answers(scenario, study, 0)?;
    let weeks = Figures::of(scenario).weeks;
    let number = |value: f64| value.is_finite().then_some(value);
    let order = |answer: &OrderAnswer| {
        let order = &scenario.orders[answer.order];
        let [p50, p80, p95] = answer.quantiles.map(|finish| finish.shown(scenario));
        json!({
            "id": order.id,
            "part": scenario.parts[order.part].name,
            "customer": order.customer,
            "quantity": order.quantity,
            "due": shown(scenario, order.due),
            "finish": { "mean": shown(scenario, answer.mean), "p50": p50, "p80": p80, "p95": p95 },
            "tardiness [min]": number(answer.tardiness / 60.0),
            "on_time": { "share": answer.share, "ci95": answer.interval },
            "unfinished": answer.unfinished as f64 / answer.replications as f64,
            "pieces_lost": answer.lost,
            "waited_longest": answer.longest.map(|longest| json!({
                "station": station(scenario, &all.queues[longest.station].machines),
                "share": longest.replications as f64 / answer.replications as f64,
                "wait [min]": longest.wait / 60.0,
            })),
        })
    };
    let resource = |resource: usize| {
        let weeks = all.loads.iter().filter(|answer| answer.resource == resource).map(|answer| {
            let mut week = json!({
                "week": weeks[answer.week].name,
                "load": { "mean": number(answer.load()), "p90": number(answer.high_load) },
            });
            for kind in LoadKind::of_scenario(scenario) {
                week[format!("{} [h]", kind.name())] = json!(answer.mean(kind) / 3600.0);
            }
            week
        });
        let kind = if resource < scenario.machines.len() { "machine" } else { "operator" };
        json!({ "name": resource_name(scenario, resource), "kind": kind, "weeks": weeks.collect::<Vec<_>>() })
    };
    let queues = all.queues.iter().map(|answer| {
        json!({
            "station": station(scenario, &answer.machines),
            "length": { "mean": answer.length, "p95": answer.upper_length },
            "longest": { "mean": answer.longest[0], "p95": answer.longest[1] },
            "wait [min]": { "mean": number(answer.wait[0] / 60.0), "p95": number(answer.wait[1] / 60.0) },
            "wait_total [h]": answer.total / 3600.0,
        })
    });
    let wip = all.wip.iter().map(|answer| {
        let [mean, p10, p90] = answer.orders;
        let [work, work_p10, work_p90] = answer.work.map(|seconds| seconds / 3600.0);
        json!({
            "time": shown(scenario, answer.time),
            "orders": { "mean": mean, "p10": p10, "p90": p90 },
            "work [h]": { "mean": work, "p10": work_p10, "p90": work_p90 },
        })
    });
    Some([
        ("orders", all.orders.iter().map(order).collect()),
        ("resources", (0..scenario.machines.len() + scenario.operators.len()).map(resource).collect()),
        ("queues", queues.collect()),
        ("wip", wip.collect()),
    ])
}

/// The orders that may be late under the first policy, as text; empty for a scenario without orders.
pub fn late_orders(scenario: &Scenario, study: &Study) -> String {
    let Some(all) = answers(scenario, study, 0) else { return String::new() };
    let risky: Vec<&OrderAnswer> = all.orders.iter().filter(|answer| answer.on_time < answer.replications).collect();
    let mut out = String::new();
    let count = scenario.orders.len();
    if risky.is_empty() {
        let _ = writeln!(out, "\nall {count} orders are on time in every replication");
        return out;
    }
    let _ = writeln!(out, "\n{} of {count} orders are late in some replication", risky.len());
    let mut rows = vec![["order", "part", "due", "finish P50", "P95", "on time", "95 %"].map(str::to_owned)];
    for answer in risky.iter().take(MOST_NAMED) {
        let order = &scenario.orders[answer.order];
        let percent = |share: f64| format!("{:.0}", 100.0 * share);
        rows.push([
            order.id.clone(),
            scenario.parts[order.part].name.clone(),
            shown(scenario, order.due),
            answer.quantiles[0].shown(scenario),
            answer.quantiles[2].shown(scenario),
            format!("{} %", percent(answer.share)),
            format!("{} … {} %", percent(answer.interval[0]), percent(answer.interval[1])),
        ]);
    }
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..rows[0].len()).map(width).collect();
    for row in &rows {
        let cells = row.iter().zip(&widths).map(|(cell, width)| format!("{cell:width$}"));
        let _ = writeln!(out, "  {}", cells.collect::<Vec<_>>().join("  ").trim_end());
    }
    if risky.len() > MOST_NAMED {
        let _ = writeln!(out, "  … and {} more: orders.csv", risky.len() - MOST_NAMED);
    }
    out
}

/// Days and hours of an axis of time from `from` to `to` (s since the start): where to write what.
pub(crate) fn ticks(start: f64, from: f64, to: f64) -> Vec<(f64, String)> {
    const DAY: f64 = 86_400.0;
    // At most about a dozen labels.
    let step = [1.0, 2.0, 7.0, 14.0, 28.0, 91.0, 364.0]
        .into_iter()
        .find(|days| (to - from) / (days * DAY) <= 14.0)
        .unwrap_or(364.0);
    let first = ((start + from) / DAY).ceil() * DAY - start;
    let count = ((to - first) / (step * DAY)).floor().max(0.0) as usize;
    (0..=count)
        .map(|each| first + each as f64 * step * DAY)
        .map(|time| (time, date::show(start + time)[5..10].to_owned()))
        .collect()
}
