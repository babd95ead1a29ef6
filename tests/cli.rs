//! The command line as a user meets it: output, errors, exit codes, files.

#[path = "cli/owned.rs"]
mod owned;

mod faults;
mod files;
mod first_hour;
mod order_system;
mod orders;
mod planner;
mod point;
mod resumed;
mod shards;
mod snapshots;
mod study;

use crate::command_line::{directory, json, shipped, stderr, stdout, toolroom};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

fn file(name: &str, bytes: impl AsRef<[u8]>) -> String {
    let path = directory("cli", name).join("scenario.toml");
    fs::write(&path, bytes).expect("the target directory is writable");
    path.display().to_string()
}

/// A study that takes a fraction of a second.
fn quick(verb: &str, folder: &Path, more: &[&str]) -> Output {
    quick_of(verb, folder, &[&["--replications", "3"], more].concat())
}

/// The same with a number of replications to name.
fn quick_of(verb: &str, folder: &Path, more: &[&str]) -> Output {
    let (path, folder) = (shipped("template"), folder.display().to_string());
    let mut arguments = vec![verb, &path, "--set", "shop.horizon=6 h", "--out", &folder];
    arguments.extend(["--policy", "constant", "--policy", "best constant"]);
    arguments.extend(more);
    toolroom(&arguments)
}

fn names(dir: &Path) -> Vec<String> {
    let entries = fs::read_dir(dir).expect("a directory").map(|entry| entry.expect("an entry").file_name());
    let mut names: Vec<String> = entries.map(|name| name.to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

#[test]
fn every_published_number_is_met() {
    let output = toolroom(&["validate", "--json"]);
    let claims: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let claims = claims.as_array().expect("a list");
    for model in ["wear", "milling", "infeed"] {
        assert!(claims.iter().any(|claim| claim["model"] == model), "{model}");
    }
    for claim in claims {
        let (published, computed) = (claim["published"].as_f64(), claim["computed"].as_f64());
        let (Some(published), Some(computed)) = (published, computed) else { panic!("{claim}") };
        let scale = if published == 0.0 { 1.0 } else { published.abs() };
        let within = (computed - published).abs() <= claim["tolerance"].as_f64().expect("a number") * scale;
        assert_eq!(claim["pass"], within, "{claim}");
    }
    let failed: Vec<_> = claims.iter().filter(|claim| claim["pass"] != true).collect();
    assert!(failed.is_empty(), "{failed:#?}");
    assert_eq!(output.status.code(), Some(0));
}

#[test]
fn explain_knows_its_codes_and_effects_its_catalogue() {
    assert!(stdout(&toolroom(&["explain", "quantity"])).contains("m/min"));
    assert_eq!(toolroom(&["explain", "nonsense"]).status.code(), Some(2));
    let effects = json(&toolroom(&["effects", "--json"]));
    assert!(effects["effects"].as_array().is_some_and(|list| list.iter().any(|effect| effect["id"] == "wear_force")));
    assert!(stdout(&toolroom(&["completions", "bash"])).contains("compare"));
}

#[test]
fn help_leads_with_examples() {
    let help = toolroom(&["--help"]);
    assert_eq!(help.status.code(), Some(0));
    assert!(stdout(&help).starts_with("Examples:"), "{}", stdout(&help));
    for verb in ["check", "compare", "run", "point", "lobes", "new", "demo", "report", "diff", "validate"] {
        let help = toolroom(&[verb, "--help"]);
        assert!(stdout(&help).starts_with("Examples:"), "{verb}");
    }
}
