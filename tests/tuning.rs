//! Rivals are compared at their best: every rule is tuned with the same budget on a seed of its own, and judged on fresh
//! random numbers.

use crate::command_line::toolroom;
use serde_json::Value;
use std::path::Path;

/// A short comparison of two rules of the demo shop, tuned with the least budget.
fn compared(folder: &Path, more: &[&str]) -> Value {
    let out = folder.display().to_string();
    let mut args = vec!["compare", "scenarios/demo.toml", "--tune", "--json", "--out", &out];
    args.extend(["--policy", "best cost", "--policy", "productivity", "--policy", "oracle"]);
    args.extend(["--set", "shop.horizon=3 h", "--set", "shop.replications=6", "--set", "tune.budget=100"]);
    args.extend(more);
    let output = toolroom(&args);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("a summary")
}

#[test]
fn every_rule_is_tuned_with_one_budget_and_judged_on_another_seed() {
    let folder = tempfile::tempdir().expect("a folder");
    let summary = compared(folder.path(), &[]);
    let tuning = summary["tuning"].as_array().expect("a list");
    assert_eq!(tuning.len(), 3);
    for rule in tuning {
        assert_eq!(rule["evaluations"], 100, "{rule}");
        let (tuned, judged) = (rule["tuned"].as_f64().expect("a cost"), rule["judged"].as_f64().expect("a cost"));
        assert!((rule["optimism"].as_f64().expect("a cost") - (judged - tuned)).abs() < 1e-9, "{rule}");
        assert!(rule["settings"]["limit"].is_string(), "{rule}");
    }
    assert!(tuning[1]["settings"]["price"].is_string(), "{}", tuning[1]);
    assert_eq!(summary["verdict"]["between"], serde_json::json!(["productivity", "best cost"]));
    let wording = summary["verdict"]["wording"].as_str().expect("a line");
    assert!(
        ["adaptive pays", "adaptive loses", "not resolved"].iter().any(|start| wording.starts_with(start)),
        "{wording}"
    );

    // The settings are keys of the file: the same comparison follows from them without tuning.
    let again = tempfile::tempdir().expect("a folder");
    let out = again.path().display().to_string();
    let mut args = vec!["compare", "scenarios/demo.toml", "--json", "--out", &out];
    args.extend(["--policy", "best cost", "--policy", "productivity", "--policy", "oracle"]);
    args.extend(["--set", "shop.horizon=3 h", "--set", "shop.replications=6"]);
    for change in tuning.iter().flat_map(|rule| rule["set"].as_array().expect("changes")) {
        args.extend(["--set", change.as_str().expect("a change")]);
    }
    let output = toolroom(&args);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let untuned: Value = serde_json::from_slice(&output.stdout).expect("a summary");
    assert_eq!(untuned["digest"], summary["digest"]);
    assert!(untuned["verdict"].is_null() && untuned["tuning"].is_null());
    assert!(untuned["decision"]["notes"].to_string().contains("--tune"), "{}", untuned["decision"]);
}

#[test]
fn tuning_does_not_depend_on_the_number_of_threads() {
    let folder = tempfile::tempdir().expect("a folder");
    let [one, three] = ["1", "3"].map(|threads| compared(&folder.path().join(threads), &["--threads", threads]));
    assert_eq!(one, three);
    let drawn = |threads: &str| std::fs::read(folder.path().join(threads).join("report.html")).expect("a report");
    assert_eq!(drawn("1"), drawn("3"));
}

#[test]
fn a_policy_that_stands_as_given_is_named_and_decides_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let summary = compared(folder.path(), &["--set", "policy.\"best cost\".tune=false"]);
    let notes = summary["decision"]["notes"].to_string();
    assert!(notes.contains("best cost stands as given and is no rival"), "{notes}");
    assert_eq!(summary["decision"]["outcome"], "undecided");
}

#[test]
fn what_cannot_be_tuned_is_refused_with_the_way_out() {
    let refused = |args: &[&str]| {
        let output = toolroom(&[&["compare", "--tune", "--out", "/nowhere/at/all"], args].concat());
        assert_eq!(output.status.code(), Some(2), "{}", String::from_utf8_lossy(&output.stdout));
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    let demo = "scenarios/demo.toml";
    let message = refused(&[demo, "--set", "tune.objective=cost_per_prat"]);
    assert!(message.contains("cost_per_part"), "{message}");
    let message = refused(&[demo, "--seed", "1001"]);
    assert!(message.contains("1001"), "{message}");
    let message = refused(&["scenarios/grinding-policies.toml"]);
    assert!(message.contains("commanded speed"), "{message}");
    let message = refused(&[demo, "--plan", "plan.json"]);
    assert!(message.contains("--plan"), "{message}");
}

#[test]
fn where_the_rule_of_tool_change_is_free_the_best_of_all_rules_is_taken() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = |name: &str, changes: &[&str]| -> Value {
        let out = folder.path().join(name).display().to_string();
        let mut args = vec!["compare", "scenarios/demo.toml", "--json", "--out", &out];
        args.extend(["--policy", "best cost", "--policy", "productivity"]);
        args.extend(["--set", "shop.horizon=3 h", "--set", "shop.replications=4"]);
        args.extend(changes);
        let output = toolroom(&args);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice(&output.stdout).expect("a summary")
    };
    let free = "policy.\"productivity\".tune={ change = true }";
    let other = "policy.\"best cost\".tune={ change = true }";
    let summary = run("free", &["--tune", "--set", "tune.budget=400", "--set", free, "--set", other]);
    for rule in summary["tuning"].as_array().expect("a list") {
        assert_eq!(rule["evaluations"], 400, "{rule}");
        let tried = rule["tool_change"].as_array().expect("rules");
        let mut words: Vec<&str> = tried.iter().filter_map(|tried| tried["rule"].as_str()).collect();
        let costs: Vec<f64> = tried.iter().filter_map(|tried| tried["objective"].as_f64()).collect();
        assert!(costs.iter().all(|cost| *cost >= costs[0]), "{rule}");
        // The settings are those of the rule that was chosen, and give it to the policy.
        let chosen = format!("rule = \"{}\"", words[0]);
        assert!(
            rule["set"]
                .as_array()
                .expect("changes")
                .iter()
                .any(|set| set.to_string().contains(&chosen.replace('"', "\\\""))),
            "{rule}"
        );
        words.sort_unstable();
        assert_eq!(words, ["cutting_time", "predicted", "wear_limit"]);
    }
    assert_eq!(summary["verdict"]["between"], serde_json::json!(["productivity", "best cost"]));
    let mut again = Vec::new();
    for rule in summary["tuning"].as_array().expect("a list") {
        for change in rule["set"].as_array().expect("changes") {
            again.extend(["--set", change.as_str().expect("a change")]);
        }
    }
    assert_eq!(run("again", &again)["digest"], summary["digest"]);

    // A rule that may choose has no rival in one that may not.
    let mixed = run("mixed", &["--tune", "--set", "tune.budget=400", "--set", free]);
    assert_eq!(mixed["decision"]["outcome"], "undecided", "{}", mixed["decision"]);
    // Four searches need the budget of four.
    let out = folder.path().join("small").display().to_string();
    let small = toolroom(&[
        "compare",
        "scenarios/demo.toml",
        "--tune",
        "--set",
        "tune.budget=300",
        "--set",
        free,
        "--out",
        &out,
    ]);
    let said = String::from_utf8_lossy(&small.stderr).into_owned();
    assert!(small.status.code() == Some(2) && said.contains("a budget of 400 or more"), "{said}");
}

#[test]
fn a_guard_that_excludes_cheaper_settings_is_told_with_the_verdict_without_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let guard = ["--set", "tune.guard={ collapse = \"2 %\", failure = \"3 %\" }"];
    let summary = compared(&folder.path().join("guarded"), &guard);
    let tuning = summary["tuning"].as_array().expect("a list");
    let excluded = tuning.iter().filter(|rule| !rule["excluded"].is_null());
    assert!(excluded.clone().count() > 0, "{}", summary["tuning"]);
    for rule in excluded {
        assert!(rule["excluded"]["set"].as_array().is_some_and(|set| !set.is_empty()), "{rule}");
    }
    let freed = &summary["verdict"]["without_guard"];
    assert!(freed["wording"].is_string() && freed["between"][0] == "productivity", "{}", summary["verdict"]);
    // A guard that nothing breaks has one verdict.
    let loose = ["--set", "tune.guard={ collapse = \"100 %\" }"];
    let summary = compared(&folder.path().join("loose"), &loose);
    assert!(summary["verdict"]["without_guard"].is_null(), "{}", summary["verdict"]);
}
