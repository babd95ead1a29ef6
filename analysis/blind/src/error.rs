//! What stops the benchmark.

use std::path::PathBuf;
use toolroom_gap::ModelFileError;
use toolroom_records::RecordError;

/// Why there is no answer.
#[derive(Debug, thiserror::Error)]
pub enum BlindError {
    /// A process for which no hidden effects are known.
    #[error("no hidden effects are known for the process `{process}`")]
    UnknownProcess {
        /// The name that was given.
        process: String,
        /// The processes that there are.
        known: Vec<&'static str>,
    },
    /// A set of cases that is none.
    #[error("no cases of the set `{set}`")]
    UnknownSet {
        /// The name that was given.
        set: String,
        /// The sets that there are.
        known: Vec<&'static str>,
    },
    /// The cases of a finished run cannot be read.
    #[error("{}: {source}", path.display())]
    Unreadable {
        /// The table of cases.
        path: PathBuf,
        /// What is wrong with it.
        source: csv::Error,
    },
    /// A case of two runs.
    #[error("the case {seed} of {process} stands in two of the runs")]
    Twice {
        /// Seed of the case.
        seed: u64,
        /// Its process.
        process: String,
    },
    /// A shipped nominal model does not suit this version.
    #[error("the shipped nominal model of {process}: {source}")]
    Model {
        /// Process of the model.
        process: String,
        /// What is wrong with it.
        source: Box<ModelFileError>,
    },
    /// Records of a case that the diagnosis does not read.
    #[error("records of {process} {seed}: {source}")]
    Records {
        /// Process of the case.
        process: String,
        /// Seed of the case.
        seed: u64,
        /// What is wrong with them.
        source: Box<RecordError>,
    },
}
