//! The directory of a finished run, read again.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::{fs, io};
use toolroom_location::{Located, Location};

/// `run.json` and `summary.json` of a directory.
#[derive(Clone, Debug)]
pub struct FinishedRun {
    /// How it was made.
    pub run: Value,
    /// What it says.
    pub summary: Value,
}

/// Why a directory is not that of a finished run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FinishedRunError {
    /// A file is missing or cannot be read.
    #[error("{path} cannot be read: {source}")]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the file system said.
        source: io::Error,
    },
    /// A file is not JSON.
    #[error("{path} is no JSON: {source}")]
    NoJson {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: serde_json::Error,
    },
}

impl Located for FinishedRunError {
    fn location(&self) -> Option<Location> {
        match self {
            Self::NoJson { path, source } => Some(Location::column(path.display(), source.line(), source.column())),
            Self::Unreadable { path, .. } => Some(Location::of(path.display())),
        }
    }
}

impl FinishedRun {
    /// The way out where a directory is not that of a finished run.
    pub const FIX: &str = "give the directory of a finished run, such as out/demo";

    /// Reads a directory.
    ///
    /// # Errors
    /// See [`FinishedRunError`].
    pub fn read(directory: &Path) -> Result<Self, FinishedRunError> {
        Ok(Self { run: object(directory, "run.json")?, summary: object(directory, "summary.json")? })
    }

    /// Whether the run was not interrupted.
    pub fn complete(&self) -> bool {
        self.run["complete"] == true
    }
}

fn object(directory: &Path, name: &str) -> Result<Value, FinishedRunError> {
    let path = directory.join(name);
    let text =
        fs::read_to_string(&path).map_err(|source| FinishedRunError::Unreadable { path: path.clone(), source })?;
    serde_json::from_str(&text).map_err(|source| FinishedRunError::NoJson { path, source })
}
