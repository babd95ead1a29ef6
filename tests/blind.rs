//! The withheld-effect benchmark, as a user runs it.

use serde_json::Value;
use std::process::Command;

/// The smoke cases of a process, as JSON.
fn smoke(process: &str, threads: &str, more: &[&str]) -> Value {
    let output = Command::new(env!("CARGO_BIN_EXE_toolroom"))
        .args(["gap", "blind", "--cases", "smoke", "--process", process, "--seed", "3", "--json"])
        .args(more)
        .env("RAYON_NUM_THREADS", threads)
        .output()
        .expect("toolroom runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("JSON on standard output")
}

#[test]
fn no_cause_is_named_that_was_not_hidden() {
    let answer = smoke("turning", "2", &[]);
    let cases = answer["cases"].as_array().expect("cases");
    assert!(cases.len() >= 6, "{cases:?}");
    assert!(cases.iter().all(|case| case["mark"] != "wrong"), "{cases:#?}");
    let found = cases.iter().filter(|case| case["set"] == "effect" && case["mark"] == "exact").count();
    assert_eq!(found, 2, "{cases:#?}");
}

/// Part programs are diagnosed fastest, by the same search and the same tests as turning, of which one case is enough.
#[test]
fn the_number_of_threads_changes_no_diagnosis() {
    for (process, more) in [("program", &[][..]), ("turning", &["--only", "null"])] {
        let [one, two] = ["1", "2"].map(|threads| smoke(process, threads, more));
        assert!(one["cases"].as_array().is_some_and(|cases| !cases.is_empty()), "{process}");
        assert_eq!(one["cases"], two["cases"], "{process}");
    }
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
