//! The dependency rules of ARCHITECTURE.md, read off `cargo metadata`.

use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
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

/// The table of ARCHITECTURE.md: folder, crate, crates that it names, responsibility.
fn rows() -> Vec<[String; 4]> {
    let page = std::fs::read_to_string(root().join("ARCHITECTURE.md")).expect("ARCHITECTURE.md");
    let rows = page.lines().filter(|line| line.starts_with("| ") && !line.starts_with("| folder"));
    let cells = |line: &str| line.split('|').skip(1).take(4).map(|cell| cell.trim().to_owned()).collect::<Vec<_>>();
    rows.map(|line| cells(line).try_into().unwrap_or_else(|_| panic!("a row of four cells: {line}"))).collect()
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn every_crate_names_what_the_architecture_page_says() {
    let edges = dependencies();
    let rows = rows();
    for [folder, name, names, _] in &rows {
        assert!(root().join(folder).is_dir(), "folder {folder} does not exist");
        if name == "–" || name == "toolroom" {
            continue;
        }
        let needs = edges.get(name).unwrap_or_else(|| panic!("crate {name} does not exist"));
        let needs: BTreeSet<&str> = needs.iter().filter_map(|need| need.strip_prefix("toolroom-")).collect();
        let said: BTreeSet<&str> = names.split(", ").filter(|name| *name != "–").collect();
        assert_eq!(needs, said, "{name}: what it names, and what ARCHITECTURE.md says");
    }
    for name in edges.keys().filter(|name| name.starts_with("toolroom")) {
        assert!(rows.iter().any(|[_, row, ..]| row == name), "{name} is missing in ARCHITECTURE.md");
    }
}

#[test]
fn only_parquet_knows_polars_and_the_rest_compiles_beside_it() {
    let edges = dependencies();
    let named = edges.iter().filter(|(name, needs)| name.starts_with("toolroom") && needs.contains("polars"));
    assert_eq!(named.map(|(name, _)| name.as_str()).collect::<Vec<_>>(), ["toolroom-parquet"]);
    for free in ["toolroom-chart", "toolroom-life", "toolroom-gap", "toolroom-shop", "toolroom-fmu"] {
        assert!(!reachable(&edges, free).contains("polars"), "{free} waits for polars");
    }
}

#[test]
fn the_diagnosis_knows_no_truth_and_the_truth_no_model() {
    let edges = dependencies();
    assert!(!reachable(&edges, "toolroom-gap").contains("toolroom-truth"), "the diagnosis knows no truth");
    let models = reachable(&edges, "toolroom-truth").into_iter().filter(|name| name.starts_with("toolroom"));
    assert_eq!(models.count(), 0, "the truth knows no model");
}

/// Lines of Rust below a folder.
fn lines(folder: &Path) -> usize {
    let entries = std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    let count = |path: PathBuf| {
        if path.is_dir() {
            lines(&path)
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            std::fs::read_to_string(&path).expect("text").lines().count()
        } else {
            0
        }
    };
    entries.map(count).sum()
}

#[test]
fn no_crate_outgrows_what_one_reader_can_hold() {
    for [folder, name, ..] in rows().iter().filter(|[_, name, ..]| name != "–") {
        let source = root().join(folder).join(if name == "toolroom" { "" } else { "src" });
        assert!(lines(&source) <= 12_000, "{name} has {} lines", lines(&source));
    }
}
