//! The directory of results: complete or not there.

use crate::failure::Failure;
use crate::study::quoted;
use serde_json::{Value, json};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;
use toolroom_analysis::page::Provenance;
use toolroom_analysis::results::fingerprint;
use toolroom_process::table::{Cell, csv_text};

/// A directory that is filled under another name and takes its own when it is complete, so that
/// nothing half-written can be taken for a result.
#[derive(Debug)]
pub struct OutputDir {
    target: PathBuf,
    draft: PathBuf,
    published: bool,
}

/// What a directory of results always holds.
const MARK: &str = "run.json";

impl OutputDir {
    /// Makes the draft beside `target`, so that an unwritable place is told before any work.
    pub fn create(target: &Path) -> Result<Self, Failure> {
        let unwritable = |source| Failure::Unwritable { path: target.to_owned(), source };
        if target.is_dir() {
            let empty = fs::read_dir(target).map_err(unwritable)?.next().is_none();
            if !empty && !target.join(MARK).is_file() {
                let message = format!("{} holds files that are no results of toolroom", target.display());
                return Err(Failure::argument(message, "choose another directory with --out DIR; nothing was changed"));
            }
        } else if target.exists() {
            return Err(unwritable(io::Error::new(io::ErrorKind::NotADirectory, "it is a file")));
        }
        let name = target.file_name().ok_or_else(|| unwritable(io::Error::from(io::ErrorKind::InvalidFilename)))?;
        let mut draft_name = name.to_owned();
        draft_name.push(format!(".partial-{}", std::process::id()));
        let draft = target.with_file_name(draft_name);
        fs::create_dir_all(&draft).map_err(unwritable)?;
        Ok(Self { target: target.to_owned(), draft, published: false })
    }

    /// Where to write.
    pub fn draft(&self) -> &Path {
        &self.draft
    }

    /// Writes a file of the draft.
    pub fn put(&self, name: &str, text: &str) -> Result<(), Failure> {
        self.put_bytes(name, text.as_bytes())
    }

    /// Writes a file of the draft that is no text.
    pub fn put_bytes(&self, name: &str, bytes: &[u8]) -> Result<(), Failure> {
        let path = self.draft.join(name);
        fs::write(&path, bytes).map_err(|source| Failure::Unwritable { path, source })
    }

    /// Writes a CSV table of the draft.
    pub fn put_table<'a, R: IntoIterator<Item = Cell<'a>>>(
        &self,
        name: &str,
        header: impl IntoIterator<Item = impl AsRef<str>>,
        rows: impl IntoIterator<Item = R>,
    ) -> Result<(), Failure> {
        self.put(name, &csv_text(header, rows).map_err(|error| no_table(name, &error))?)
    }

    /// Writes a JSON file of the draft.
    pub fn put_json(&self, name: &str, value: &Value) -> Result<(), Failure> {
        self.put(name, &(serde_json::to_string_pretty(value).map_err(Failure::Json)? + "\n"))
    }

    /// Writes `run.json`: what was computed from what.
    pub fn record(&self, provenance: &Provenance, wall: Duration) -> Result<(), Failure> {
        let inputs: Vec<Value> =
            provenance.inputs.iter().map(|(name, hash)| json!({ "name": name, "hash": hash })).collect();
        let mut run = json!({
            "schema": 1,
            "version": provenance.version,
            "command": provenance.command,
            "inputs": inputs,
            "complete": true,
            "wall_time [s]": wall.as_secs_f64(),
        });
        if let Some(seed) = provenance.seed {
            run["seed"] = json!(seed);
        }
        self.put_json(MARK, &run)
    }

    /// Leaves the draft as it is, under its own name.
    pub fn keep(mut self) -> PathBuf {
        self.published = true;
        self.draft.clone()
    }

    /// Gives the draft its name; earlier results in its place are removed only then.
    pub fn publish(mut self) -> Result<PathBuf, Failure> {
        let unwritable = |source| Failure::Unwritable { path: self.target.clone(), source };
        let mut aside = self.draft.clone().into_os_string();
        aside.push("-old");
        if self.target.exists() {
            fs::rename(&self.target, &aside).map_err(unwritable)?;
        }
        fs::rename(&self.draft, &self.target).map_err(unwritable)?;
        self.published = true;
        if Path::new(&aside).exists() {
            fs::remove_dir_all(&aside).map_err(unwritable)?;
        }
        Ok(self.target.clone())
    }
}

/// A table that has no form as CSV.
pub fn no_table(name: &str, error: &dyn std::fmt::Display) -> Failure {
    Failure::Work { message: format!("{name}: {error}") }
}

/// The command as it has to be typed, and the input files with their hashes. `arguments` follow
/// verb and files.
pub fn provenance(
    verb: &str,
    inputs: &[(String, &[u8])],
    arguments: impl IntoIterator<Item = String>,
    seed: Option<u64>,
) -> Provenance {
    let words = inputs.iter().map(|(name, _)| name.clone()).chain(arguments);
    let command = words.fold(format!("toolroom {verb}"), |command, word| command + " " + &quoted(&word));
    let inputs = inputs.iter().map(|(name, bytes)| (name.clone(), fingerprint(bytes))).collect();
    Provenance { version: env!("CARGO_PKG_VERSION").to_owned(), command, seed, inputs }
}

impl Drop for OutputDir {
    fn drop(&mut self) {
        if !self.published {
            // The failure that brought us here is told already.
            let _ = fs::remove_dir_all(&self.draft);
        }
    }
}
