//! Same seed, same bytes, whatever the number of threads.

use crate::command_line::{directory, stderr, toolroom};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;

fn outputs(folder: &Path, threads: &str, seed: &str) -> BTreeMap<String, Vec<u8>> {
    let output = Command::new(env!("CARGO_BIN_EXE_toolroom"))
        .args(["compare", "scenarios/constant-vs-adaptive.toml", "--replications", "4", "--quiet"])
        .args(["--threads", threads, "--seed", seed, "--out"])
        .arg(folder)
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("toolroom runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let mut files = BTreeMap::from([("standard output".to_owned(), table(&output.stdout))]);
    for entry in fs::read_dir(folder).expect("the output folder") {
        let path = entry.expect("a file").path();
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        // run.json says when and how fast the run was; it alone may differ.
        if name != "run.json" {
            files.insert(name, fs::read(&path).expect("a readable file"));
        }
    }
    files
}

/// The comparison table without the line that names time taken and folder.
fn table(stdout: &[u8]) -> Vec<u8> {
    let text = String::from_utf8_lossy(stdout);
    text.lines().filter(|line| line.contains('+') || line.contains('−')).collect::<Vec<_>>().join("\n").into_bytes()
}

#[test]
fn the_same_seed_gives_the_same_bytes_on_one_and_two_threads() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    // The same folder name both times: it is named in the outputs.
    let run = |name: &str, threads: &str, seed: &str| {
        let parent = folder.path().join(name);
        fs::create_dir_all(&parent).expect("a folder");
        outputs(&parent.join("out"), threads, seed)
    };
    let (one, two) = (run("one", "1", "7"), run("two", "2", "7"));
    assert_eq!(one.keys().collect::<Vec<_>>(), two.keys().collect::<Vec<_>>());
    for (name, bytes) in &one {
        assert!(bytes == &two[name], "{name} differs between one and two threads");
    }
    assert!(one.contains_key("summary.json") && one.contains_key("report.html") && one.contains_key("kpi.csv"));
    let other = run("other", "2", "8");
    assert!(other["summary.json"] != one["summary.json"], "another seed gives other numbers");
}

/// A scenario with the order of the tables of every kind turned round, as `[[machine]]` and what belongs to it up to the next one.
fn turned_round(text: &str) -> String {
    let mut blocks: Vec<(Option<&str>, String)> = vec![(None, String::new())];
    for line in text.lines() {
        let kind = line.strip_prefix("[[").and_then(|rest| rest.split("]]").next()).filter(|kind| !kind.contains('.'));
        if kind.is_some() || (line.starts_with('[') && !line.starts_with("[[") && !line.contains('.')) {
            blocks.push((kind, String::new()));
        }
        let (_, block) = blocks.last_mut().expect("a block");
        *block += line;
        block.push('\n');
    }
    let mut left: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for (kind, block) in &blocks {
        if let Some(kind) = kind {
            left.entry(*kind).or_default().push(block.clone());
        }
    }
    let next = |(kind, block): (Option<&str>, String)| match kind {
        Some(kind) => left.get_mut(kind).and_then(Vec::pop).expect("one for each"),
        None => block,
    };
    blocks.into_iter().map(next).collect()
}

#[test]
fn the_order_of_the_tables_does_not_matter() {
    let folder = directory("determinism", "tables");
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/shop");
    let run = |file: &Path, out: &str| -> Vec<String> {
        let out = folder.join(out);
        let (file, out_text) = (file.display().to_string(), out.display().to_string());
        let output = toolroom(&["run", &file, "--replications", "2", "--out", &out_text, "--quiet"]);
        assert_eq!(output.status.code(), Some(0), "{file}: {}", stderr(&output));
        let table = fs::read_to_string(out.join("kpi.csv")).expect("key figures");
        let mut rows: Vec<String> = table.lines().map(str::to_owned).collect();
        rows.sort();
        rows
    };
    for (name, table) in [("orders", Some("orders.csv")), ("mixed", Some("mixed.csv")), ("urgent", None)] {
        let text = fs::read_to_string(shipped.join(name).with_extension("toml")).expect("a shipped shop");
        let turned = turned_round(&text);
        assert_ne!(turned, text, "{name}");
        let file = folder.join(format!("{name}.toml"));
        fs::write(&file, turned).expect("a scenario");
        if let Some(table) = table {
            let rows = fs::read_to_string(shipped.join(table)).expect("a shipped table");
            let (head, rows) = rows.split_once('\n').expect("rows");
            let mut rows: Vec<&str> = rows.lines().collect();
            rows.reverse();
            fs::write(folder.join(table), format!("{head}\n{}\n", rows.join("\n"))).expect("a table");
        }
        let there = run(&shipped.join(name).with_extension("toml"), &format!("{name}-there"));
        assert_eq!(there, run(&file, &format!("{name}-turned")), "{name}");
    }
}
