//! The directory of a finished run, read again.

use crate::failure::Failure;
use serde_json::Value;
use std::fs;
use std::path::Path;

/// `run.json` and `summary.json` of a directory.
#[derive(Debug)]
pub struct Results {
    pub run: Value,
    pub summary: Value,
}

impl Results {
    pub fn read(dir: &Path) -> Result<Self, Failure> {
        Ok(Self { run: object(dir, "run.json")?, summary: object(dir, "summary.json")? })
    }

    /// Whether the run was not interrupted.
    pub fn complete(&self) -> bool {
        self.run["complete"] == true
    }
}

fn object(dir: &Path, name: &str) -> Result<Value, Failure> {
    let path = dir.join(name);
    let help = "give the directory of a finished run, such as out/demo";
    let text = fs::read_to_string(&path)
        .map_err(|error| Failure::argument(format_args!("{} cannot be read: {error}", path.display()), help))?;
    serde_json::from_str(&text)
        .map_err(|error| Failure::argument(format_args!("{} is no JSON: {error}", path.display()), help))
}
