//! What a reader did.

use serde_json::{Value, json};
use std::fmt;

/// What was read, what was dropped and why.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadReport {
    /// The file.
    pub file: String,
    /// Rows used.
    pub rows: usize,
    /// Line of the file of each row of the records; empty where they do not come from lines of one file.
    pub lines: Vec<usize>,
    /// Columns used, as `header → name [SI]`.
    pub columns: Vec<String>,
    /// Columns that nothing uses.
    pub unused: Vec<String>,
    /// Rows left out: line and reason.
    pub dropped: Vec<(usize, String)>,
    /// Of these the ones of which is not known what was cut, since a condition is missing or at it nothing is cut: line and
    /// condition.
    pub unknown_cuts: Vec<(usize, String)>,
    /// Cells taken as missing: line, column and what stood there.
    pub unreadable: Vec<(usize, String, String)>,
    /// What else the reader did on its own account.
    pub notes: Vec<String>,
}

/// Lines of detail that are printed of each kind.
const SHOWN: usize = 5;
/// Unused columns that are printed.
const SHOWN_UNUSED: usize = 8;

impl ReadReport {
    /// The same for programs.
    pub fn json(&self) -> Value {
        let dropped = |(line, reason): &(usize, String)| json!({ "line": line, "reason": reason });
        let cell =
            |(line, column, read): &(usize, String, String)| json!({ "line": line, "column": column, "read": read });
        json!({
            "schema": 1, "file": self.file, "rows": self.rows, "columns": self.columns, "unused": self.unused,
            "dropped": self.dropped.iter().map(dropped).collect::<Vec<_>>(),
            "unreadable": self.unreadable.iter().map(cell).collect::<Vec<_>>(), "notes": self.notes,
        })
    }
}

impl fmt::Display for ReadReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}: {} rows, columns {}", self.file, self.rows, self.columns.join(", "))?;
        if !self.unused.is_empty() {
            let more = self.unused.len().saturating_sub(SHOWN_UNUSED);
            let shown = self.unused.iter().take(SHOWN_UNUSED).cloned().collect::<Vec<_>>().join(", ");
            let more = if more > 0 { format!(" and {more} more") } else { String::new() };
            writeln!(f, "  not used: {shown}{more}")?;
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
