//! Policies of a small shop at their best settings.

use std::path::Path;
use std::sync::atomic::AtomicBool;
use toolroom_scenario::{Scenario, TuneRequest};
use toolroom_scenario_file::{ScenarioFile, read};
use toolroom_tune::{TuneError, TunedPolicy, Tuning, tune};

/// A short demo shop with changes as after `--set`.
fn shop(changes: &[&str]) -> ScenarioFile {
    let mut all = vec!["shop.horizon=2 h".to_owned()];
    all.extend(changes.iter().map(|change| (*change).to_owned()));
    read(Path::new("../../scenarios/demo.toml"), &all).unwrap_or_else(|error| panic!("{error}"))
}

fn position(scenario: &Scenario, name: &str) -> usize {
    scenario.policies.iter().position(|policy| policy.name == name).expect("a policy")
}

/// The policy called `name`, tuned with a budget.
fn tuned(file: &ScenarioFile, name: &str, budget: u32, threads: usize) -> Result<Tuning, TuneError> {
    let request = TuneRequest { budget, ..file.tune.clone().unwrap_or_default() };
    let policies = [position(&file.scenario, name)];
    tune(&file.scenario, &policies, &request, threads, &|_| (), &AtomicBool::new(false))
}

fn of<'a>(tuning: &'a Tuning, name: &str) -> &'a TunedPolicy {
    tuning.of(name).expect("a policy")
}

const FREE: &str = "policy.\"schedule\".tune={ change = true }";

#[test]
fn where_the_rule_of_tool_change_is_free_the_best_of_all_rules_is_taken() {
    let file = shop(&[FREE]);
    let tuning = tuned(&file, "schedule", 400, 0).expect("settings");
    let found = of(&tuning, "schedule");
    assert_eq!(found.evaluations, 400, "the budget is the same as that of any other policy");
    let mut words: Vec<&str> = found.tool_changes.iter().map(|tried| tried.rule.as_str()).collect();
    let costs: Vec<f64> = found.tool_changes.iter().filter_map(|tried| tried.objective).collect();
    assert!(costs.len() == 3 && costs.iter().all(|cost| *cost >= costs[0]), "{:?}", found.tool_changes);
    // The changes of the file give the policy the rule that was chosen, at the setting that is told.
    let again = read(Path::new("../../scenarios/demo.toml"), &[vec![FREE.to_owned()], tuning.changes()].concat());
    let again = again.expect("a scenario").scenario;
    let rule = &again.policies[position(&again, "schedule")];
    assert_eq!(rule.tool_change.word(), words[0]);
    assert!(rule.chooses_change(), "the file still says so: the verdict compares policies with the same freedom");
    words.sort_unstable();
    assert_eq!(words, ["cutting_time", "predicted", "wear_limit"]);
    // Three rules and the better ones have a share each.
    let refused = tuned(&file, "schedule", 300, 0).expect_err("too small a budget");
    assert!(refused.fix().contains("400 or more"), "{}", refused.fix());
    assert!(of(&tuned(&shop(&[]), "schedule", 100, 0).expect("settings"), "schedule").tool_changes.is_empty());
}

#[test]
fn settings_that_the_guard_excludes_are_told_with_the_changes_that_give_them() {
    // So strict a guard lets no setting stand: the policy is out, and what it would be without the guard is told.
    let strict = shop(&["tune.guard={ collapse = \"2 %\", failure = \"0 %\" }"]);
    let tuning = tuned(&strict, "schedule", 100, 0).expect("settings");
    let found = of(&tuning, "schedule");
    assert!(!found.is_tuned(), "{found:?}");
    let excluded = found.excluded.as_ref().expect("settings");
    assert_eq!(excluded.changes.len(), 2, "{excluded:?}");
    let freed = tuning.freed_of_guard().expect("a tuning without the guard");
    let free = of(&freed, "schedule");
    assert!(free.is_tuned() && free.changes == excluded.changes && free.excluded.is_none(), "{free:?}");
    // A guard that nothing breaks excludes nothing.
    let loose = tuned(&shop(&["tune.guard={ collapse = \"100 %\" }"]), "schedule", 100, 0).expect("settings");
    assert!(loose.freed_of_guard().is_none());
}

#[test]
fn the_map_of_two_settings_has_a_value_for_every_point_of_the_grid() {
    let tuning = tuned(&shop(&[]), "schedule", 100, 0).expect("settings");
    let map = of(&tuning, "schedule").map.clone().expect("a map");
    let [columns, rows] = &map.values;
    assert_eq!((map.settings[0].0.as_str(), map.settings[1].0.as_str()), ("speed_factor", "limit"));
    assert_eq!((map.objective.len(), map.excluded.len()), (columns.len() * rows.len(), columns.len() * rows.len()));
    assert!(map.objective.iter().all(Option::is_some), "{map:?}");
    assert!(columns.is_sorted() && rows.is_sorted());
    assert_eq!(tuned(&shop(&[]), "schedule", 100, 1).expect("settings"), tuning, "whatever the threads");
}
