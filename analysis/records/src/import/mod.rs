//! Tables of others to records: a mapping says which column is what.
//!
//! ```text
//!  file ─► raw table ─► rows kept ─► cells by mapping, SI ─► edges in order ─► operations ─► Records
//!                                                                └─► ReadReport: what became of the rest
//! ```

mod mapping;
mod operations;
mod source;
#[cfg(test)]
mod tests;

pub use super::combine::Combine;
pub use mapping::{Keep, MAPPING, Mapped, Mapping, Origin};

use super::read::cells;
use super::{OtherTable, RawTable, ReadReport, RecordError, RecordKind, Records};
use std::path::Path;
use toolroom_location::{Located, Location};

/// Why a table was not imported.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ImportError {
    /// The file cannot be read, or its rows are of no use.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// A column that the mapping asks for.
    #[error("{file} has no column `{column}`{}; it has: {known}", .nearest.as_ref().map(|near| format!(", is it `{near}`?")).unwrap_or_default())]
    NoColumn {
        /// The file.
        file: String,
        /// What the mapping calls it.
        column: String,
        /// The header that is most alike.
        nearest: Option<String>,
        /// The first headers of the file.
        known: String,
    },
    /// A column that the records need and the mapping lacks.
    #[error("the mapping gives no `{column}`, which {process} records need; add a [[column]] with from or constant")]
    NotMapped {
        /// Name in the records.
        column: &'static str,
        /// Kind of records.
        process: &'static str,
    },
}

impl Located for ImportError {
    fn location(&self) -> Option<Location> {
        match self {
            Self::Record(error) => error.location(),
            Self::NoColumn { file, .. } => Some(Location::of(file)),
            Self::NotMapped { .. } => None,
        }
    }
}

impl ImportError {
    /// The likely fix.
    pub fn fix(&self) -> &'static str {
        match self {
            Self::Record(RecordError::Unreadable { .. } | RecordError::NoFile { .. }) => "check the path",
            Self::Record(RecordError::Quote { .. }) => "mend that line; nothing was imported",
            Self::Record(
                RecordError::Table { .. }
                | RecordError::MissingColumn { .. }
                | RecordError::Unit { .. }
                | RecordError::NoRows { .. },
            ) => "the mapping says what each column is: name, from, unit",
            Self::NoColumn { .. } => "`from` in the mapping is a header of the file",
            Self::NotMapped { .. } => "a constant will do, such as constant = \"L1\"",
        }
    }
}

/// Reads a table of any layout by a mapping: CSV in any delimiter, encoding and decimal sign, or
/// Parquet, which `parquet` reads. The report says what was used, left out, and why.
///
/// # Errors
/// [`ImportError`]: a file that cannot be read, a column that it lacks, no row of use.
pub fn import(path: &Path, mapping: &Mapping, parquet: OtherTable<'_>) -> Result<(Records, ReadReport), ImportError> {
    let table = if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("parquet")) {
        parquet(path)?
    } else {
        let bytes = std::fs::read(path).map_err(|source| RecordError::Unreadable { path: path.to_owned(), source })?;
        cells(&path.display().to_string(), &bytes)?
    };
    import_table(&path.display().to_string(), &table, mapping)
}

/// [`import`] of delimited text; `file` is its name in messages.
///
/// # Errors
/// As [`import`].
///
/// # Examples
/// ```
/// use toolroom_records::import::{Mapping, import_csv};
/// let map = "schema = 1\nprocess = \"empirical\"\n\
///            column = [{ name = \"tool_id\", from = \"tool\" }, { name = \"cutting_force\", from = \"Fc\", unit = \"kN\" }]";
/// let mapping = Mapping::parse("map.toml", map, &[])?;
/// let (records, _) = import_csv("log.csv", "tool;Fc\nA;0,9\n".as_bytes(), &mapping)?;
/// assert_eq!(records.numbers("cutting_force"), Some(&[900.0][..]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn import_csv(file: &str, bytes: &[u8], mapping: &Mapping) -> Result<(Records, ReadReport), ImportError> {
    import_table(file, &cells(file, bytes)?, mapping)
}

fn import_table(file: &str, table: &RawTable, mapping: &Mapping) -> Result<(Records, ReadReport), ImportError> {
    let mut report = ReadReport { file: file.to_owned(), notes: table.notes.clone(), ..ReadReport::default() };
    let source = source::Source::new(file, table, mapping, &mut report)?;
    let records = operations::records(&source, mapping, &mut report)?;
    report.rows = records.len();
    Ok((records, report))
}

impl RecordKind {
    /// Word in files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Turning => "turning",
            Self::Milling => "milling",
            Self::Grinding => "grinding",
            Self::Shop => "shop",
            Self::Orders => "orders",
            Self::Empirical => "empirical",
            Self::Program => "program",
        }
    }

    /// The column whose levels are followed from row to row, and that of their order.
    pub(super) fn sequence(self) -> (&'static str, &'static str) {
        match self {
            Self::Grinding => ("dressing_cycle", "part_in_cycle"),
            Self::Shop => ("machine", "time"),
            Self::Orders => ("part_type", "arrival_time"),
            Self::Program => ("operation_id", "sequence"),
            Self::Turning | Self::Milling | Self::Empirical => ("tool_id", "sequence"),
        }
    }

    /// The columns of the order and of the name of a row, which are made where a mapping gives none.
    pub(super) fn generated(self) -> Option<[&'static str; 2]> {
        let (_, order) = self.sequence();
        match self {
            Self::Shop | Self::Orders => None,
            Self::Grinding => Some([order, "trial_id"]),
            Self::Turning | Self::Milling | Self::Empirical | Self::Program => Some([order, "operation_id"]),
        }
    }
}
