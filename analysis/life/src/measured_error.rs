//! Why tables of measured lives were not read, and where in them.

use toolroom_location::{Located, Location};
use toolroom_process::table::BrokenQuote;

/// Lives that occur, in the unit of their column: from less than a microsecond in hours to thirty thousand
/// years in seconds (assumption). Squares and quotients of such numbers are far from the ends of what a
/// number can be.
pub(crate) const LEAST: f64 = 1e-9;
pub(crate) const GREATEST: f64 = 1e12;

/// Why a file of measured lives was not read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeasuredError {
    /// Bytes that are no UTF-8.
    #[error("{file}: byte {byte} is no UTF-8; save the table as UTF-8")]
    Encoding {
        /// File.
        file: String,
        /// Position of the byte.
        byte: usize,
    },
    /// A quote that cannot be read.
    #[error("{file}:{}: {fault}", .fault.line())]
    Quote {
        /// File.
        file: String,
        /// The quote.
        fault: BrokenQuote,
    },
    /// No header or no rows under it.
    #[error("{file}: no rows; expected a header such as `life [min],censored,group` and one life a line")]
    NoRows {
        /// File.
        file: String,
    },
    /// A column that must be there.
    #[error("{file}:1: there is no column `{column}`; there are {known}")]
    MissingColumn {
        /// File.
        file: String,
        /// Column.
        column: String,
        /// Columns of the file.
        known: String,
    },
    /// A row of another length than the header.
    #[error("{file}:{line}: {found} cells where the header has {expected}")]
    CellCount {
        /// File.
        file: String,
        /// Line.
        line: usize,
        /// Cells in the row.
        found: usize,
        /// Cells in the header.
        expected: usize,
    },
    /// A cell that should be a number.
    #[error("{file}:{line}: `{column}` is `{read}`, but {expected} is due")]
    Cell {
        /// File.
        file: String,
        /// Line.
        line: usize,
        /// Column.
        column: String,
        /// What was read.
        read: String,
        /// What was expected.
        expected: &'static str,
    },
    /// Points and commas as decimal signs in one file.
    #[error("{file}:{line}: `{read}` has a decimal comma, other numbers have a point; use one of them")]
    DecimalSign {
        /// File.
        file: String,
        /// Line.
        line: usize,
        /// What was read.
        read: String,
    },
    /// An age that no edge has.
    #[error(
        "{file}:{line}: `{column}` is {read}, but a life from {LEAST:e} to {GREATEST:e} is due; take the row out, or \
         check its unit"
    )]
    Age {
        /// File.
        file: String,
        /// Line.
        line: usize,
        /// Column.
        column: String,
        /// What was read or found.
        read: String,
    },
    /// Readings of an edge out of order.
    #[error("{file}:{line}: edge `{edge}` was read at {age} after a reading at {before}: ages rise from row to row")]
    Backwards {
        /// File.
        file: String,
        /// Line.
        line: usize,
        /// Edge.
        edge: String,
        /// Age read.
        age: f64,
        /// Age before.
        before: f64,
    },
    /// Several of these in one table.
    #[error("{} rows cannot be read:{}", .faults.len(), listed(.faults))]
    Several {
        /// Two or more, in the order of lines.
        faults: Vec<MeasuredError>,
    },
}

/// Faults that are shown: somebody mends a few and looks again (assumption).
const SHOWN: usize = 50;

fn listed(faults: &[MeasuredError]) -> String {
    let shown = faults.iter().take(SHOWN).map(|fault| format!("\n  {fault}"));
    let more = faults.len().saturating_sub(SHOWN);
    let more = (more > 0).then(|| format!("\n  and {more} more"));
    shown.chain(more).collect()
}

impl MeasuredError {
    /// What is wrong with a table of which all `faults` are known; nothing where there is none.
    pub(crate) fn of(mut faults: Vec<Self>) -> Result<(), Self> {
        faults.sort_by_key(|fault| fault.location().and_then(|place| place.line));
        match faults.pop() {
            None => Ok(()),
            Some(only) if faults.is_empty() => Err(only),
            Some(last) => {
                faults.push(last);
                Err(Self::Several { faults })
            }
        }
    }
}

impl Located for MeasuredError {
    fn location(&self) -> Option<Location> {
        match self {
            Self::Quote { file, fault } => Some(Location::line(file, fault.line())),
            Self::MissingColumn { file, .. } => Some(Location::line(file, 1)),
            Self::CellCount { file, line, .. }
            | Self::Cell { file, line, .. }
            | Self::DecimalSign { file, line, .. }
            | Self::Age { file, line, .. }
            | Self::Backwards { file, line, .. } => Some(Location::line(file, *line)),
            Self::Several { faults } => faults.first().and_then(Located::location),
            Self::Encoding { file, .. } | Self::NoRows { file, .. } => Some(Location::of(file)),
        }
    }
}
