//! What a reader did.

use std::fmt;

/// What was read, what was dropped and why.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadReport {
    /// The file.
    pub file: String,
    /// Rows used.
    pub rows: usize,
    /// Columns used, as `header → name [SI]`.
    pub columns: Vec<String>,
    /// Columns that nothing uses.
    pub unused: Vec<String>,
    /// Rows left out: line and reason.
    pub dropped: Vec<(usize, String)>,
    /// Cells taken as missing: line, column and what stood there.
    pub unreadable: Vec<(usize, String, String)>,
    /// What else the reader did on its own account.
    pub notes: Vec<String>,
}

/// Lines of detail that are printed of each kind.
const SHOWN: usize = 5;

impl fmt::Display for ReadReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}: {} rows, columns {}", self.file, self.rows, self.columns.join(", "))?;
        if !self.unused.is_empty() {
            writeln!(f, "  not used: {}", self.unused.join(", "))?;
        }
        for note in &self.notes {
            writeln!(f, "  {note}")?;
        }
        if !self.dropped.is_empty() {
            writeln!(f, "  {} rows left out:", self.dropped.len())?;
            for (line, reason) in self.dropped.iter().take(SHOWN) {
                writeln!(f, "    line {line}: {reason}")?;
            }
        }
        if !self.unreadable.is_empty() {
            writeln!(f, "  {} cells taken as missing:", self.unreadable.len())?;
            for (line, column, read) in self.unreadable.iter().take(SHOWN) {
                writeln!(f, "    line {line}, {column}: `{read}`")?;
            }
        }
        Ok(())
    }
}
