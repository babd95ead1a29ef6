//! Same seed, same bytes, whatever the number of threads.

use std::collections::BTreeMap;
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
    for entry in std::fs::read_dir(folder).expect("the output folder") {
        let path = entry.expect("a file").path();
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        // run.json says when and how fast the run was; it alone may differ.
        if name != "run.json" {
            files.insert(name, std::fs::read(&path).expect("a readable file"));
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
        std::fs::create_dir_all(&parent).expect("a folder");
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
