//! Why records were not read.

use super::table::TableError;
use std::path::PathBuf;
use toolroom_location::{Located, Location};
use toolroom_process::table::BrokenQuote;

/// Why records were not read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordError {
    /// The file cannot be opened.
    #[error("cannot read {path}: {source}")]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the file system said.
        source: std::io::Error,
    },
    /// A table that is no delimited text cannot be read.
    #[error("cannot read {path}: {source}")]
    Table {
        /// The file.
        path: PathBuf,
        /// What its format said.
        source: TableError,
    },
    /// A directory without records of the kind.
    #[error("{path} holds no {stem}.csv or {stem}.parquet")]
    NoFile {
        /// The directory.
        path: PathBuf,
        /// Name of the file that was looked for.
        stem: &'static str,
    },
    /// A quote that cannot be read.
    #[error("{file}:{}: {fault}", .fault.line())]
    Quote {
        /// The file.
        file: String,
        /// The quote.
        fault: BrokenQuote,
    },
    /// A column that must be there.
    #[error("{file}: the column `{column}` is missing{}{}", if example == column { String::new() } else { format!("; expected `{example}`") }, .nearest.as_ref().map(|near| format!(", is it `{near}`?")).unwrap_or_default())]
    MissingColumn {
        /// The file.
        file: String,
        /// Its name.
        column: &'static str,
        /// A header that would do.
        example: String,
        /// The header that is most alike.
        nearest: Option<String>,
    },
    /// A unit that does not fit its column.
    #[error("{file}: column `{column}` has the unit `{read}`; accepted: {accepted}")]
    Unit {
        /// The file.
        file: String,
        /// Its name.
        column: &'static str,
        /// What was read.
        read: String,
        /// Units that fit.
        accepted: String,
    },
    /// No row can be used.
    #[error("{file}: {}{}", if *rows == 0 { "there is no row of data".to_owned() } else { format!("none of {rows} rows can be used") }, .first.as_ref().map(|first| format!("; the first: {first}")).unwrap_or_default())]
    NoRows {
        /// The file.
        file: String,
        /// Rows under the header.
        rows: usize,
        /// Why the first was left out.
        first: Option<String>,
        /// Whether some row was left out for what it holds; otherwise there is only nothing in them.
        wrong: bool,
    },
}

impl Located for RecordError {
    fn location(&self) -> Option<Location> {
        match self {
            Self::Quote { file, fault } => Some(Location::line(file, fault.line())),
            Self::Unreadable { path, .. } | Self::Table { path, .. } | Self::NoFile { path, .. } => {
                Some(Location::of(path.display()))
            }
            Self::MissingColumn { file, .. } | Self::Unit { file, .. } | Self::NoRows { file, .. } => {
                Some(Location::of(file))
            }
        }
    }
}
