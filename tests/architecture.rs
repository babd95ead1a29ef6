//! The dependency rules of ARCHITECTURE.md, read off `cargo metadata`.

use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;

/// What cargo says about the workspace and everything that it is built from.
fn metadata() -> Value {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--locked"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("cargo metadata runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("cargo metadata prints JSON")
}

/// Normal (not development) dependencies of every package, by name.
fn dependencies() -> BTreeMap<String, BTreeSet<String>> {
    let metadata = metadata();
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

/// The table of ARCHITECTURE.md: folder, crate, crates that it names, responsibility, circles of files (none where nothing stands).
fn rows() -> Vec<[String; 5]> {
    let page = std::fs::read_to_string(root().join("ARCHITECTURE.md")).expect("ARCHITECTURE.md");
    let rows = page.lines().filter(|line| line.starts_with("| ") && !line.starts_with("| folder"));
    let cells = |line: &str| line.split('|').skip(1).take(5).map(|cell| cell.trim().to_owned()).collect::<Vec<_>>();
    rows.map(|line| cells(line).try_into().unwrap_or_else(|_| panic!("a row of four or five cells: {line}"))).collect()
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn every_crate_names_what_the_architecture_page_says() {
    let edges = dependencies();
    let rows = rows();
    for [folder, name, names, ..] in &rows {
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
    assert_eq!(named.map(|(name, _)| name.as_str()).collect::<Vec<_>>(), ["toolroom-parquet", "toolroom-python"]);
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
        // The program holds arguments, dispatch, output folder and voice: what is computed has a room of its own.
        let most = if name == "toolroom" { 6_000 } else { 12_000 };
        assert!(lines(&source) <= most, "{name} has {} lines", lines(&source));
    }
}

/// A text whose groups of paths are written out: `a::{b, c::D}` is `a::b, a::c::D`.
fn ungrouped(mut text: String) -> String {
    while let Some(open) = text.rfind("::{") {
        let Some(close) = text[open..].find('}').map(|length| open + length) else { break };
        let start = text[..open].rfind(|c: char| !c.is_alphanumeric() && c != '_' && c != ':').map_or(0, |at| at + 1);
        let parts = text[open + 3..close].split(',').map(str::trim).filter(|part| !part.is_empty());
        let parts: Vec<String> = parts.map(|part| format!("{}::{part}", &text[start..open])).collect();
        text.replace_range(start..=close, &parts.join(", "));
    }
    text
}

/// Text of every module of a crate without comments and unit tests, by its path such as `crate::policies::grinding`.
fn modules(folder: &Path, parent: &str, found: &mut BTreeMap<String, String>) {
    for path in std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()) {
        let stem = path.file_stem().and_then(|stem| stem.to_str()).expect("a name");
        let name = if matches!(stem, "lib" | "main" | "mod") { parent.to_owned() } else { format!("{parent}::{stem}") };
        if path.is_dir() {
            modules(&path, &name, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            let text = std::fs::read_to_string(&path).expect("text");
            let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default().lines();
            let code: Vec<&str> = code.filter(|line| !line.trim_start().starts_with("//")).collect();
            found.entry(name).or_default().push_str(&ungrouped(code.join("\n")));
        }
    }
}

/// Circles of the files of a crate by the paths that they write. A name that a module hands on counts for the file that it is
/// from. A file may name the modules that it is a part of.
fn circles(source: &Path) -> BTreeSet<BTreeSet<String>> {
    let (mut files, mut imports, mut named) = (BTreeMap::new(), BTreeMap::new(), Vec::new());
    modules(source, "crate", &mut files);
    for (module, text) in &files {
        for (colons, _) in text.match_indices("::") {
            let start = text[..colons].rfind(|c: char| !c.is_alphanumeric() && c != '_').map_or(0, |at| at + 1);
            let line = text[..start].rsplit('\n').next().unwrap_or_default();
            let path =
                text[start..].split(|c: char| !c.is_alphanumeric() && c != '_' && c != ':').next().unwrap_or_default();
            let mut place: Vec<&str> =
                if path.starts_with("crate::") { Vec::new() } else { module.split("::").collect() };
            for part in path.split("::") {
                match part {
                    "super" => drop(place.pop()),
                    "self" | "" => {}
                    name => place.push(name),
                }
            }
            let place = place.join("::");
            if line.contains("use ") {
                imports.insert(format!("{module}::{}", place.rsplit("::").next().unwrap_or_default()), place.clone());
            }
            if !(line.ends_with(':') || line.contains("use ") && line.trim_start().starts_with("pub")) {
                named.push((module, place));
            }
        }
    }
    let mut arrows: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for (module, mut place) in named {
        for _ in 0..9 {
            place = match (imports.get(&place), place.rsplit_once("::")) {
                _ if files.contains_key(&place) => break,
                (Some(from), _) if *from != place => from.clone(),
                (_, Some((before, _))) => before.to_owned(),
                (_, None) => break,
            };
        }
        if files.contains_key(&place) && !format!("{module}::").starts_with(&format!("{place}::")) {
            arrows.entry(module.clone()).or_default().insert(place);
        }
    }
    let ahead = |module: &String| reachable(&arrows, module);
    let circle = |module: &String| ahead(module).into_iter().filter(|other| ahead(other).contains(module)).collect();
    files.keys().map(circle).filter(|circle: &BTreeSet<String>| circle.len() > 1).collect()
}

#[test]
fn circles_of_files_become_fewer() {
    let mut more = Vec::new();
    for [folder, name, _, _, most] in rows().iter().filter(|[_, name, ..]| name != "–") {
        let found = circles(&root().join(folder).join(if name == "toolroom" { "" } else { "src" }));
        let most: usize = if most.is_empty() { 0 } else { most.parse().expect("a number of circles") };
        more.extend((found.len() > most).then(|| format!("{name} has {} of {most}: {found:?}", found.len())));
    }
    assert!(more.is_empty(), "circles of files, and how many ARCHITECTURE.md allows:\n{}", more.join("\n"));
}

/// Whether a file below a folder holds unit tests.
fn has_unit_tests(folder: &Path) -> bool {
    std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()).any(|path| {
        if path.is_dir() {
            return has_unit_tests(&path);
        }
        let is_rust = path.extension().is_some_and(|extension| extension == "rs");
        is_rust && std::fs::read_to_string(&path).expect("text").contains("#[test]")
    })
}

/// `test = false` saves compiling a crate twice, and would pass over a unit test that somebody adds to it.
#[test]
fn a_crate_that_is_not_compiled_for_unit_tests_has_none() {
    let mut without = 0;
    for [folder, name, ..] in rows().iter().filter(|[_, name, ..]| name != "–" && name != "toolroom") {
        let manifest = std::fs::read_to_string(root().join(folder).join("Cargo.toml")).expect("a manifest");
        if manifest.contains("[lib]\ntest = false") {
            without += 1;
            assert!(!has_unit_tests(&root().join(folder).join("src")), "{name} has unit tests that never run");
        }
    }
    assert!(without > 0, "no crate leaves its unit tests out");
}

/// Licences under which others may build on toolroom without opening their own code; deny.toml has the same ones.
const PERMISSIVE: [&str; 14] = [
    "0BSD",
    "Apache-2.0",
    "Apache-2.0 WITH LLVM-exception",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "BSL-1.0",
    "CC0-1.0",
    "ISC",
    "MIT",
    "MIT-0",
    "Unicode-3.0",
    "Unlicense",
    "Zlib",
    "bzip2-1.0.6",
];

/// Parts of an SPDX expression between the words `operator` that stand outside parentheses.
fn parts<'a>(expression: &'a str, operator: &str) -> Vec<&'a str> {
    let (mut parts, mut start, mut depth) = (Vec::new(), 0, 0);
    for (index, letter) in expression.char_indices() {
        depth += i32::from(letter == '(') - i32::from(letter == ')');
        if depth == 0 && index >= start && expression[index..].starts_with(operator) {
            parts.push(&expression[start..index]);
            start = index + operator.len();
        }
    }
    parts.push(&expression[start..]);
    parts
}

/// Whether some choice that an SPDX expression leaves is permissive altogether.
fn is_permissive(expression: &str) -> bool {
    let expression = expression.trim();
    let any = parts(expression, " OR ");
    if any.len() > 1 {
        return any.into_iter().any(is_permissive);
    }
    let all = parts(expression, " AND ");
    if all.len() > 1 {
        return all.into_iter().all(is_permissive);
    }
    match expression.strip_prefix('(').and_then(|inner| inner.strip_suffix(')')) {
        Some(inner) => is_permissive(inner),
        None => PERMISSIVE.contains(&expression),
    }
}

#[test]
fn every_dependency_has_a_permissive_licence() {
    assert!(is_permissive("(MIT OR GPL-3.0) AND Unicode-3.0") && is_permissive("GPL-3.0 OR MIT"));
    assert!(!is_permissive("MIT AND GPL-3.0") && !is_permissive("(MIT OR ISC) AND GPL-3.0") && !is_permissive(""));
    let deny = std::fs::read_to_string(root().join("deny.toml")).expect("deny.toml");
    let allowed = deny.lines().filter(|line| line.starts_with("  \"")).filter_map(|line| line.split('"').nth(1));
    let allowed: Vec<&str> = allowed.skip_while(|name| *name != PERMISSIVE[0]).collect();
    assert_eq!(allowed, PERMISSIVE, "deny.toml and this list");
    let metadata = metadata();
    let packages = metadata["packages"].as_array().expect("packages");
    assert!(packages.len() > 100, "{} packages", packages.len());
    let refused: Vec<String> = packages
        .iter()
        .map(|package| (&package["name"], package["license"].as_str().unwrap_or_default()))
        // Cargo's older way to write a choice.
        .filter(|(_, licence)| !is_permissive(&licence.replace(" / ", " OR ").replace('/', " OR ")))
        .map(|(name, licence)| format!("{name}: {licence:?}"))
        .collect();
    assert!(refused.is_empty(), "licences that are not permissive: {refused:?}");
}

#[test]
fn the_minimum_version_of_rust_is_enough_for_every_dependency() {
    let version = |text: &str| -> Vec<u32> { text.split('.').filter_map(|part| part.parse().ok()).collect() };
    let metadata = metadata();
    let packages = metadata["packages"].as_array().expect("packages");
    let package = packages.iter().find(|package| package["name"] == "toolroom").expect("toolroom");
    let minimum = version(package["rust_version"].as_str().expect("a minimum version"));
    let newer: Vec<String> = packages
        .iter()
        .filter_map(|package| Some((&package["name"], package["rust_version"].as_str()?)))
        .filter(|(_, needed)| version(needed)[..2] > minimum[..2])
        .map(|(name, needed)| format!("{name} needs {needed}"))
        .collect();
    assert!(newer.is_empty(), "rust-version in Cargo.toml is too low: {newer:?}");
}

/// A kind that is added to an enum of ours has to be thought of everywhere: no `_ =>` stands for it unseen. The package of
/// Python hands on the errors of all crates, and those without a place are alike to it.
#[test]
fn every_crate_denies_arms_for_all_the_rest() {
    for [folder, name, ..] in rows().iter().filter(|[_, name, ..]| name != "–" && name != "toolroom-python") {
        let places = ["src/lib.rs", "lib.rs"].map(|place| root().join(folder).join(place));
        let place = places.iter().find(|place| place.is_file()).unwrap_or_else(|| panic!("{name} has no root"));
        let text = std::fs::read_to_string(place).expect("text");
        assert!(text.contains("deny(clippy::wildcard_enum_match_arm)"), "{name}: {} lacks the lint", place.display());
    }
}
