//! Why modes cannot be brought up to date.

use toolroom_chatter::ChatterError;

/// Why modes cannot be brought up to date.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum UpdateError {
    /// A lobes file of another process.
    #[error("modes are brought up to date by cuts of milling or turning at constant speed")]
    Process,
    /// Nothing is uncertain.
    #[error("every value of the structure file is exact: without `sd` there is nothing to learn")]
    Exact,
    /// A table without cuts.
    #[error("the table has no cuts")]
    NoCuts,
    /// Modes that change with the speed.
    #[error(
        "the modes of the structure file change with the spindle speed: bring those of one speed up to date by the cuts at that speed"
    )]
    Speeds,
    /// Modes that change along the path.
    #[error(
        "the modes of the structure file change along the path: bring those of one station up to date by the cuts there"
    )]
    Stations,
    /// An immersion of a turned cut.
    #[error("a turned cut has no immersion: leave out that column")]
    Immersion,
    /// A column that records need.
    #[error("the records have no column `{column}`{}", if *column == "spindle_speed" { ", without which nobody knows the waves between two cuts" } else { "" })]
    Column {
        /// The column.
        column: &'static str,
    },
    /// Records of several machines.
    #[error("the records are of machines {known}, whose structures differ; choose one by --machine")]
    Machines {
        /// Their names.
        known: String,
    },
    /// A machine without records.
    #[error("no record is of machine {name}; there are {known}")]
    NoMachine {
        /// Its name.
        name: String,
        /// Names that are there.
        known: String,
    },
    /// The model refused a value.
    #[error(transparent)]
    Refused(#[from] ChatterError),
}
