//! `toolroom life`: which ends of an edge cost a failure when it is worked out when edges are best replaced.

use crate::command_line::{directory, stderr, toolroom};
use serde_json::Value;
use std::fs;

const STUDY: &str = "schema = 1\nname = \"small\"\nlives = 400\nparameter_set = \"ni_vk6om\"\n\
    [[condition]]\ncutting_speed = \"30 m/min\"\n[replacement]\nplanned = \"10 EUR\"\nfailure = \"50 EUR\"\n";

#[test]
fn a_limit_that_is_seen_is_a_failure_only_where_the_study_says_so() {
    let folder = directory("replacement", "failure");
    let file = folder.join("study.toml");
    let path = file.to_str().expect("UTF-8");
    let replaced = |more: &str| -> Value {
        fs::write(&file, format!("{STUDY}{more}")).expect("writable");
        let out = folder.join("out");
        let words = ["life", path, "--json", "--force", "--bootstrap", "20", "--out", out.to_str().expect("UTF-8")];
        let output = toolroom(&words);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let summary: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        summary["cells"][0]["replacement"].clone()
    };
    // Left out, edges are used up to the limit, where they cost no more than any other replacement.
    let (seen, unseen) = (replaced(""), replaced("[end]\nfailure = \"limit\"\n"));
    let rate = |replacement: &Value| replacement["run_to_failure"].as_f64().expect("a cost rate");
    assert_eq!((&seen["failure"], &unseen["failure"]), (&"cut".into(), &"limit".into()));
    assert!(rate(&seen) < 0.6 * rate(&unseen), "{seen} {unseen}");
    assert!(unseen["age [min]"].as_f64().is_some_and(|age| age > 5.0), "{unseen}");
    let age = |replacement: &Value| replacement["age [min]"].as_f64().unwrap_or(f64::INFINITY);
    assert!(age(&seen) > age(&unseen), "{seen} {unseen}");
    fs::write(&file, format!("{STUDY}[end]\nfailure = \"worn\"\n")).expect("writable");
    let refused = toolroom(&["check", path]);
    assert_eq!(refused.status.code(), Some(2));
    let said = stderr(&refused);
    assert!(said.contains("cut, limit"), "{said}");
}
