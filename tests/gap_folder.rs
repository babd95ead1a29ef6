//! A folder in which shops are run and models are held against their records.

use crate::command_line::{stderr, toolroom};
use serde_json::Value;
use std::fs;
use tempfile::TempDir;

/// Shops and models by the names of their files; what commands leave stands beside them.
pub struct GapFolder {
    folder: TempDir,
    /// `--set KEY=VALUE` of every command.
    set: Vec<String>,
}

impl GapFolder {
    /// Of files: name and text of each.
    pub fn new(files: &[(&str, &str)]) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        for (name, text) in files {
            fs::write(folder.path().join(name), text).expect("a writable folder");
        }
        Self { folder, set: Vec::new() }
    }

    /// The same with values that replace those of the files.
    pub fn with(mut self, set: &[&str]) -> Self {
        self.set = set.iter().flat_map(|own| ["--set", own]).map(str::to_owned).collect();
        self
    }

    /// Where a file of it is.
    pub fn at(&self, name: &str) -> String {
        self.folder.path().join(name).display().to_string()
    }

    /// Leaves the records of a run of `shop` in the folder `records`.
    pub fn record(&self, shop: &str, seed: u64, records: &str) {
        let seed = seed.to_string();
        self.done(&["run", &self.at(shop), "--seed", &seed, "--records", &self.at(records), "--out", &self.at("run")]);
    }

    /// The diagnosis of `model` over `data`.
    pub fn diagnose(&self, model: &str, data: &str) -> Value {
        self.done(&["gap", "diagnose", "--model", &self.at(model), "--data", &self.at(data), "--out", &self.at("gap")]);
        let text = fs::read_to_string(self.at("gap/diagnosis.json")).expect("a diagnosis");
        serde_json::from_str(&text).expect("JSON")
    }

    /// Leaves `model` with what the last diagnosis found as `applied`.
    fn apply(&self, model: &str, applied: &str) {
        let diagnosis = self.at("gap/diagnosis.json");
        self.done(&["gap", "apply", "--model", &self.at(model), "--diagnosis", &diagnosis, "--out", &self.at(applied)]);
    }

    /// What `model.toml` says of a run of `shop.toml`, and, with that applied, of a second one, by the table of records of this
    /// name or, without one, by all of them. Records stand in `first` and `second`, the applied model in `applied.toml`.
    pub fn twice(&self, table: &str, seeds: [u64; 2]) -> [Value; 2] {
        for (seed, records) in seeds.into_iter().zip(["first", "second"]) {
            self.record("shop.toml", seed, records);
        }
        let first = self.diagnose("model.toml", &format!("first/{table}"));
        self.apply("model.toml", "applied.toml");
        [first, self.diagnose("applied.toml", &format!("second/{table}"))]
    }

    /// A command that has to succeed.
    fn done(&self, arguments: &[&str]) {
        let set = self.set.iter().map(String::as_str);
        let arguments: Vec<&str> = arguments.iter().copied().chain(set).collect();
        let output = toolroom(&arguments);
        assert!(output.status.success(), "{arguments:?}: {}", stderr(&output));
    }
}
