//! `summary.json`: the comparison for programs.
//!
//! Keys of figures carry their unit (`tool_life [min]`); shares are shares, not per cent; what is
//! not defined is null. Keys are never renamed, more may come.

use crate::compare::{BreakEven, Comparison, Difference, PolicyResult, SWING};
use crate::groups;
use crate::kpi::Kpi;
use crate::planner;
use crate::study::Study;
use crate::tune::tuning_json;
use crate::variants;
use serde_json::{Map, Value, json};
use toolroom_scenario::Scenario;
use toolroom_statistics::{Interval, Paired};

/// The summary as JSON, the same bytes for the same study.
pub fn summary(scenario: &Scenario, study: &Study, comparison: &Comparison) -> Value {
    let names = |machines: &[usize]| -> Vec<&str> {
        machines.iter().map(|&machine| scenario.machines[machine].name.as_str()).collect()
    };
    let policies: Vec<Value> = comparison.policies.iter().map(|policy| policy_json(scenario, study, policy)).collect();
    let differences: Vec<Value> =
        comparison.differences.iter().map(|difference| difference_json(study, comparison, difference)).collect();
    let headline = comparison.headline.map(|index| &comparison.differences[index]);
    let name = |position: usize| comparison.policies[position].name.as_str();
    let decision = &comparison.decision;
    let stations: Vec<Value> = comparison
        .stations
        .iter()
        .map(|station| {
            json!({
                "name": station.name,
                "machines": names(&station.machines),
                "load": station.load,
                "cell_share": station.cell_share,
                "cutting_share": station.cutting_share,
            })
        })
        .collect();
    let break_even: Vec<Value> = comparison.break_even.iter().map(break_even_json).collect();
    let mut summary = json!({
        "schema": 1,
        "scenario": scenario.name,
        "title": scenario.title,
        "currency": scenario.currency,
        "seed": scenario.seed,
        "replications": study.replications,
        "complete": study.complete,
        "confidence": toolroom_statistics::CONFIDENCE,
        "compared_policy": headline.map(|difference| name(difference.policy)),
        "baseline": comparison.policies.first().map(|policy| policy.name.as_str()),
        "cell_gain": headline.map(|difference| difference.cell_gain.mean),
        "shop_gain": headline.map(|difference| difference.shop_gain.mean),
        "amdahl_limit": headline.map(|difference| difference.amdahl_limit),
        "cutting_share": cutting_share(study, comparison),
        "bottleneck": comparison.bottleneck().map(|station| station.name.as_str()),
        "decision": {
            "outcome": decision.outcome.name(),
            "adaptive": decision.adaptive.map(name),
            "rival": decision.rival.map(name),
            "difference": decision.difference.as_ref().map(|interval| interval_json(interval, 1.0)),
            "line": decision.line,
            "notes": decision.notes,
        },
        "break_even": break_even,
        "tornado": comparison.break_even.iter().map(tornado_json).collect::<Vec<_>>(),
        "digest": format!("{:016x}", study.digest),
    });
    // `json!` would copy what it is given.
    for (key, value) in [("policies", policies), ("differences", differences), ("stations", stations)] {
        summary[key] = Value::Array(value);
    }
    summary["run"] = if scenario.is_terminating() { "terminating" } else { "steady_state" }.into();
    if let Some(sequential) = study.sequential_json() {
        summary["sequential"] = sequential;
    }
    if let Some(found) = &study.warm_up {
        summary["warm_up"] = found.json();
    }
    let one_run = study.policies.iter().zip(&study.one_run);
    let one_run = one_run.filter_map(|(policy, found)| Some(found.as_ref()?.json(&scenario.policies[*policy].name)));
    let one_run: Vec<Value> = one_run.collect();
    if !one_run.is_empty() {
        summary["batch_means"] = one_run.into();
    }
    for (key, value) in planner::json(scenario, study).into_iter().flatten() {
        summary[key] = value;
    }
    for (key, value) in groups::json(scenario, study) {
        summary[key] = value;
    }
    if let Some(plan) = planner::plan_json(scenario, study) {
        summary["plan"] = plan;
    }
    if let Some(variants) = variants::json(scenario, study) {
        summary["variants"] = variants;
    }
    if let Some(selection) = &study.selection {
        summary["selection"] = selection.json();
    }
    if let Some(tuning) = &study.tuning {
        let pair = [decision.adaptive, decision.rival].map(|policy| policy.map(name));
        summary["tuning"] = tuning_json(tuning, study, comparison);
        summary["verdict"] = json!({
            "between": pair,
            "objective": tuning.objective,
            "difference": decision.difference.as_ref().map(|difference| difference.mean),
            "ci95": decision.plain_difference().map(|difference| [difference.low(), difference.high()]),
            "decided_at": decision.confidence,
            "wording": decision.line,
            "without_guard": tuning.without_guard.as_ref().map(|verdict| json!({
                "between": verdict.between,
                "difference": verdict.difference.map(|[mean, ..]| mean),
                "ci95": verdict.difference.map(|[_, low, high]| [low, high]),
                "wording": verdict.line,
            })),
        });
    }
    summary
}

/// Prices are reported as factors on the present ones, settings held, and where there is one such price as itself.
fn break_even_json(price: &BreakEven) -> Value {
    let interval = price.factor.interval.filter(|_| price.flips());
    let at = |now: f64| price.flips().then_some(price.factor.at * now);
    json!({
        "key": price.key,
        "now": 1.0,
        "flips_at": price.flips().then_some(price.factor.at),
        "ci90": interval.map(|(low, high)| [low, high]),
        "price": price.now.as_ref().map(|(now, unit)| json!({
            "unit": unit, "now": now, "flips_at": at(*now), "ci90": interval.map(|(low, high)| [low * now, high * now]),
        })),
        "retuned": false,
    })
}

/// The difference of the decision at other prices, settings held.
fn tornado_json(price: &BreakEven) -> Value {
    let ends = SWING.iter().zip(&price.swing).map(|(factor, difference)| {
        json!({ "factor": factor, "difference": difference.mean, "ci90": [difference.low(), difference.high()] })
    });
    json!({ "key": price.key, "at": ends.collect::<Vec<_>>(), "retuned": false })
}

/// Mean cutting share of the shop under the baseline.
pub(crate) fn cutting_share(study: &Study, comparison: &Comparison) -> f64 {
    let mean = |policy: &PolicyResult| study.index("cutting_share").map_or(f64::NAN, |kpi| policy.kpis[kpi].mean);
    comparison.policies.first().map_or(f64::NAN, mean)
}

fn policy_json(scenario: &Scenario, study: &Study, policy: &PolicyResult) -> Value {
    let figures = |machine| of_machine(study, machine, |index, kpi| interval_json(&policy.kpis[index], scale(kpi)));
    let machines = scenario.machines.iter().enumerate();
    let machines = machines.map(|(machine, named)| with_figures(&named.name, figures(Some(machine)))).collect();
    let mut value = with_figures(&policy.name, figures(None));
    value["role"] = policy.role.describe().into();
    value["machines"] = Value::Array(machines);
    value
}

/// Something with a name and its key figures.
pub(crate) fn with_figures(name: &str, figures: Map<String, Value>) -> Value {
    // `json!` would copy what it is given.
    let mut value = json!({ "name": name });
    value["kpi"] = Value::Object(figures);
    value
}

fn difference_json(study: &Study, comparison: &Comparison, difference: &Difference) -> Value {
    json!({
        "policy": comparison.policies[difference.policy].name,
        "baseline": comparison.policies[0].name,
        "kpi": of_machine(study, None, |index, kpi| paired_json(&difference.kpis[index], scale(kpi))),
        "cell_gain": interval_json(&difference.cell_gain, 1.0),
        "shop_gain": interval_json(&difference.shop_gain, 1.0),
        "amdahl_limit": difference.amdahl_limit,
        "beyond": difference.beyond,
        "break_even": difference.break_even.iter().map(break_even_json).collect::<Vec<_>>(),
    })
}

fn scale(kpi: &Kpi) -> f64 {
    kpi.definition.file_scale()
}

fn of_machine(study: &Study, machine: Option<usize>, value: impl Fn(usize, &Kpi) -> Value) -> Map<String, Value> {
    // Figures of the shop stand first, then those of each machine.
    let first = study.kpis.partition_point(|kpi| kpi.machine < machine);
    let figures = study.kpis.iter().enumerate().skip(first).take_while(|(_, kpi)| kpi.machine == machine);
    figures.map(|(index, kpi)| (kpi.key(), value(index, kpi))).collect()
}

fn interval_json(interval: &Interval, scale: f64) -> Value {
    let interval = interval.scaled(scale);
    json!({ "mean": interval.mean, "ci95": [interval.low(), interval.high()], "n": interval.count })
}

fn paired_json(pair: &Paired, scale: f64) -> Value {
    let mut value = interval_json(&pair.difference, scale);
    value["variance_reduction"] = json!(pair.variance_reduction);
    value
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture;
    use crate::study::{StudyOptions, study_with};
    use std::sync::atomic::AtomicBool;

    fn example() -> Value {
        let scenario = fixture::scenario();
        let simulate = |policy: usize, replication: u32| {
            let mut log = fixture::log();
            log.edges[0].tool = 0;
            log.jobs[0].finish += f64::from(replication) + 60.0 * policy as f64;
            Ok(log)
        };
        let options = StudyOptions { replications: 3, ..StudyOptions::of(&scenario) };
        let study =
            study_with(&scenario, &options, None, &|_| {}, &AtomicBool::new(false), &simulate).expect("a study");
        summary(&scenario, &study, &Comparison::new(&scenario, &study))
    }

    #[test]
    fn the_contract_of_compare_holds() {
        let json = example();
        for key in ["seed", "replications", "cell_gain", "shop_gain", "cutting_share"] {
            assert!(json[key].is_number(), "{key}: {}", json[key]);
        }
        assert_eq!((&json["schema"], &json["bottleneck"]), (&json!(1), &json!("L1 + L2")));
        assert_eq!(json["digest"].as_str().map(str::len), Some(16));
        for key in ["parts_per_shift", "cost_per_part", "edges_per_100_parts", "oee"] {
            let figure = &json["policies"][1]["kpi"][key];
            assert!(
                figure["mean"].is_number() && figure["ci95"].as_array().is_some_and(|ends| ends.len() == 2),
                "{key}"
            );
        }
        let difference = &json["differences"][0];
        assert_eq!((&difference["policy"], &difference["baseline"]), (&json!("adaptive"), &json!("constant")));
        assert!(difference["break_even"].is_array());
    }

    #[test]
    fn quantities_are_in_the_unit_of_their_key() {
        let json = example();
        let lead = &json["policies"][0]["kpi"]["lead_time [min]"];
        // 540, 541 and 542 s.
        assert!((lead["mean"].as_f64().expect("a number") - 541.0 / 60.0).abs() < 1e-12);
        let difference = &json["differences"][0]["kpi"]["lead_time [min]"];
        assert!((difference["mean"].as_f64().expect("a number") - 1.0).abs() < 1e-12);
        assert_eq!(json["policies"][0]["kpi"]["scrap_rate"]["mean"], json!(0.5), "a share, not per cent");
    }

    #[test]
    fn what_is_not_defined_is_null() {
        let json = example();
        // No variance: the reduction is 0 / 0.
        assert!(json["differences"][0]["kpi"]["oee"]["variance_reduction"].is_null());
    }
}
