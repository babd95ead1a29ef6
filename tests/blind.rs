//! The withheld-effect benchmark, as a user runs it.

use serde_json::Value;
use std::process::Command;

/// The smoke cases of turning, as JSON.
fn smoke(threads: &str) -> Value {
    let output = Command::new(env!("CARGO_BIN_EXE_toolroom"))
        .args(["gap", "blind", "--cases", "smoke", "--process", "turning", "--seed", "3", "--json"])
        .env("RAYON_NUM_THREADS", threads)
        .output()
        .expect("toolroom runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("JSON on standard output")
}

#[test]
fn no_cause_is_named_that_was_not_hidden() {
    let answer = smoke("2");
    let cases = answer["cases"].as_array().expect("cases");
    assert!(cases.len() >= 6, "{cases:?}");
    assert!(cases.iter().all(|case| case["mark"] != "wrong"), "{cases:#?}");
    let found = cases.iter().filter(|case| case["set"] == "effect" && case["mark"] == "exact").count();
    assert_eq!(found, 2, "{cases:#?}");
    assert_eq!(answer["cases"], smoke("1")["cases"], "the number of threads changes nothing");
}

#[test]
fn a_process_without_hidden_effects_is_refused() {
    let output = Command::new(env!("CARGO_BIN_EXE_toolroom"))
        .args(["gap", "blind", "--process", "knitting"])
        .output()
        .expect("toolroom runs");
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("turning"));
}
