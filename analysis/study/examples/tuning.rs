//! How far tuned settings are from the best ones: a rule is tuned on several seeds, and its settings are judged beside those of a
//! scan on fresh random numbers.
//!
//! ```text
//! cargo run --release -p toolroom-study --example tuning -- scenarios/constant-vs-adaptive.toml constant 10 200
//! ```
//! Arguments: scenario, policy, seeds of the tuning, replications of the judgement, and changes of the file as after `--set`.
#![allow(clippy::print_stdout)] // it prints its table

use rayon::prelude::*;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use toolroom_scenario::Scenario;
use toolroom_scenario_file::read;
use toolroom_study::kpi::{evaluate, kpis};
use toolroom_study::tune::tune;

/// Seed of the judgement, another one than those of the scenario and of the tuning.
const JUDGING: u64 = 2002;
/// First seed of the tuning.
const FIRST: u64 = 1001;
/// Replications of every setting of the scan, and settings of it that are judged like the tuned ones.
const SCANNED: (u32, usize) = (24, 8);

/// Mean cost of a part of policy number `policy`, and its standard error.
fn cost(scenario: &Scenario, policy: usize, replications: u32) -> (f64, f64) {
    let index = kpis(scenario).iter().position(|kpi| kpi.machine.is_none() && kpi.definition.id == "cost_per_part");
    let index = index.expect("a key figure");
    let one = |replication: u32| {
        let world = scenario.drawn(replication).expect("a draw");
        let log = toolroom_shop::run(&world, policy, replication).expect("a run");
        evaluate(scenario, &log)[index]
    };
    let costs: Vec<f64> = (0..replications).into_par_iter().map(one).collect();
    let count = f64::from(replications);
    let mean = costs.iter().sum::<f64>() / count;
    let variance = costs.iter().map(|cost| (cost - mean).powi(2)).sum::<f64>() / (count - 1.0);
    (mean, (variance / count).sqrt())
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let number = |index: usize, usual: u32| words.get(index).and_then(|word| word.parse().ok()).unwrap_or(usual);
    let (Some(path), Some(name)) = (words.first(), words.get(1)) else {
        println!("SCENARIO POLICY [SEEDS] [REPLICATIONS] [CHANGE …]");
        return;
    };
    let (seeds, replications) = (number(2, 10), number(3, 200));
    let own: Vec<String> = words.iter().skip(4).cloned().collect();
    let scenario = |changes: &[String]| {
        let all: Vec<String> = own.iter().chain(changes).cloned().collect();
        let file = read(Path::new(path), &all).expect("a scenario");
        let policy = file.scenario.policies.iter().position(|rule| rule.name == *name).expect("a policy");
        (file, policy)
    };
    let (file, policy) = scenario(&[]);
    let mut tuned = Vec::new();
    for seed in FIRST..FIRST + u64::from(seeds) {
        let request = toolroom_scenario::TuneRequest { seed, ..file.tune.clone().unwrap_or_default() };
        let found = tune(&file.scenario, &[policy], &request, 0, &|_| (), &AtomicBool::new(false)).expect("settings");
        let (mut judged, policy) = scenario(&found.changes());
        judged.scenario.seed = JUDGING;
        let (mean, error) = cost(&judged.scenario, policy, replications);
        let settings: Vec<&str> = found.policies[0].settings.iter().map(|setting| setting.value.as_str()).collect();
        println!(
            "seed {seed}: {} tuned {:.3}, judged {mean:.3} ± {error:.3}",
            settings.join(", "),
            found.policies[0].objective.unwrap_or(f64::NAN)
        );
        tuned.push((mean, settings.join(", ")));
    }
    // The scan: all combinations of values around the tuned ones.
    let rule = &file.scenario.policies[policy];
    let settings = rule.settings();
    let values_of = |place: usize| {
        let values =
            tuned.iter().filter_map(|(_, shown)| shown.split(", ").nth(place)?.split(' ').next()?.parse::<f64>().ok());
        let (low, high) = values.fold((f64::INFINITY, 0.0_f64), |(a, b), value| (a.min(value), b.max(value)));
        let (low, high) = (0.94 * low, 1.06 * high);
        (0..7).map(move |step| low + (high - low) * f64::from(step) / 6.0).collect::<Vec<f64>>()
    };
    let mut grid: Vec<Vec<String>> = vec![Vec::new()];
    for (place, setting) in settings.iter().enumerate() {
        let (unit, display) = setting.units();
        let change = |value: &f64| {
            let si = toolroom_process::unit::convert(*value, display, unit);
            rule.override_of(*setting, setting.rounded(si))
        };
        let list: Vec<String> = values_of(place).iter().map(change).collect();
        grid = grid
            .iter()
            .flat_map(|before| list.iter().map(move |own| [before.as_slice(), std::slice::from_ref(own)].concat()))
            .collect();
    }
    let scanned = |changes: &Vec<String>, replications: u32| {
        let (mut file, policy) = scenario(changes);
        file.scenario.seed = JUDGING;
        cost(&file.scenario, policy, replications)
    };
    let mut rough: Vec<(f64, Vec<String>)> = grid.into_iter().map(|own| (scanned(&own, SCANNED.0).0, own)).collect();
    rough.sort_by(|a, b| a.0.total_cmp(&b.0));
    rough.truncate(SCANNED.1);
    let best = rough.iter().map(|(_, own)| (scanned(own, replications), own)).min_by(|a, b| a.0.0.total_cmp(&b.0.0));
    let ((least, error), own) = best.expect("a scan");
    println!("scan: {least:.3} ± {error:.3} at {}", own.join(", "));
    for share in [0.003, 0.01] {
        let within = tuned.iter().filter(|(mean, _)| *mean <= least * (1.0 + share)).count();
        println!("within {:.1} % of the least: {within} of {seeds}", 100.0 * share);
    }
}
