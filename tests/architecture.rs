//! The dependency rules of ARCHITECTURE.md, read off `cargo metadata`.

use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::Command;

/// Normal (not development) dependencies of every package, by name.
fn dependencies() -> BTreeMap<String, BTreeSet<String>> {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--locked"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("cargo metadata runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let metadata: Value = serde_json::from_slice(&output.stdout).expect("cargo metadata prints JSON");
    let list = |value: &Value| value.as_array().cloned().unwrap_or_default();
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let names: BTreeMap<String, String> =
        list(&metadata["packages"]).iter().map(|package| (text(&package["id"]), text(&package["name"]))).collect();
    let mut edges: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for node in list(&metadata["resolve"]["nodes"]) {
        let needs = edges.entry(names[&text(&node["id"])].clone()).or_default();
        for dependency in list(&node["deps"]) {
            if list(&dependency["dep_kinds"]).iter().any(|kind| kind["kind"].is_null()) {
                needs.insert(names[&text(&dependency["pkg"])].clone());
            }
        }
    }
    edges
}

/// Everything that `package` needs, directly or not.
fn reachable(edges: &BTreeMap<String, BTreeSet<String>>, package: &str) -> BTreeSet<String> {
    let mut seen = BTreeSet::new();
    let mut open = vec![package.to_owned()];
    while let Some(name) = open.pop() {
        for next in edges.get(&name).into_iter().flatten() {
            if seen.insert(next.clone()) {
                open.push(next.clone());
            }
        }
    }
    seen
}

#[test]
fn dependencies_point_down_only() {
    let edges = dependencies();
    let models: Vec<&String> = edges
        .keys()
        .filter(|name| name.starts_with("toolroom-") && !name.ends_with("sim") && !name.ends_with("analysis"))
        .collect();
    assert!(models.len() >= 5, "models found: {models:?}");
    for model in models {
        let needs = reachable(&edges, model);
        for above in ["toolroom-sim", "toolroom-analysis", "toolroom", "polars"] {
            assert!(!needs.contains(above), "{model} reaches {above}");
        }
    }
    let own = |name: &String| name.starts_with("toolroom");
    assert!(!edges["toolroom-process"].iter().any(own), "process stands on nothing of toolroom");
    for leaf in ["toolroom-wear", "toolroom-effects"] {
        assert_eq!(edges[leaf].iter().filter(|name| own(name)).collect::<Vec<_>>(), ["toolroom-process"], "{leaf}");
    }
    assert!(!edges["toolroom-truth"].iter().any(own), "the truth of the blind benchmark knows no model");
    assert!(!reachable(&edges, "toolroom-analysis").contains("toolroom-truth"), "the diagnosis knows no truth");
    let sim = reachable(&edges, "toolroom-sim");
    assert!(!sim.contains("polars") && !sim.contains("toolroom-analysis"), "sim stays below analysis and polars");
}

#[test]
fn only_analysis_names_polars() {
    let named: Vec<String> = dependencies()
        .into_iter()
        .filter(|(name, needs)| name.starts_with("toolroom") && needs.contains("polars"))
        .map(|(name, _)| name)
        .collect();
    assert_eq!(named, ["toolroom-analysis"]);
}

#[test]
fn every_folder_and_crate_of_the_architecture_page_exists() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let page = std::fs::read_to_string(root.join("ARCHITECTURE.md")).expect("ARCHITECTURE.md");
    let edges = dependencies();
    let rows: Vec<Vec<&str>> = page
        .lines()
        .filter(|line| line.starts_with("| ") && !line.starts_with("| folder"))
        .map(|line| line.split('|').map(str::trim).collect())
        .collect();
    assert!(rows.len() >= 10, "table of ARCHITECTURE.md: {rows:?}");
    for row in &rows {
        assert!(root.join(row[1]).is_dir(), "folder {} does not exist", row[1]);
        assert!(row[2] == "–" || edges.contains_key(row[2]), "crate {} does not exist", row[2]);
    }
    for name in edges.keys().filter(|name| name.starts_with("toolroom")) {
        assert!(rows.iter().any(|row| row[2] == name), "{name} is missing in ARCHITECTURE.md");
    }
}
