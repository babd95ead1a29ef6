//! Measured records: one row an operation, read from CSV or Parquet with every tolerance that
//! real files need, and written in the same form.
//!
//! ```text
//!  operations.csv │ .parquet ─► raw table ─► columns by name, SI by unit ─► Records
//!                                                └─► ReadReport: what was read, dropped and why
//! ```
//!
//! | type | what it is |
//! |---|---|
//! | [`Records`] | numbers in SI and texts, by column |
//! | [`RecordKind`], [`RecordColumn`] | the columns of turning, milling, grinding and shop records |
//! | [`ReadReport`] | what the reader used, dropped, and did on its own account |
//! | [`read`], [`tables`], [`parse_csv`], [`cells`], [`write_csv`] | files |
//! | [`WRONG_CHATTER_RECORD`], [`CHATTER_FREQUENCY_DEVIATION`] | how far records of chatter are to be believed |
//! | [`Sensor`] | errors of a sensor, and those that a channel usually has |
//! | [`table`] | typed rows on their way to a file of any format |
//! | [`mtconnect`] | logs of machines that speak MTConnect, as records |
//! | [`mod@import`] | tables of others, by a mapping |

#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

mod chatter;
mod columns;
mod combine;
mod csv_table;
mod error;
pub mod import;
pub mod mtconnect;
mod read;
mod report;
mod sensor;
pub mod table;
#[cfg(test)]
mod tests;
mod write;

pub use chatter::{CHATTER_FREQUENCY_DEVIATION, WRONG_CHATTER_RECORD};
pub use columns::{ColumnKind, RecordColumn};
pub use csv_table::{OtherTable, RawTable};
pub use error::RecordError;
pub use read::{cells, has_table, parse_csv, read, table_files, tables};
pub use report::ReadReport;
pub use sensor::Sensor;
pub use write::write_csv;

use std::collections::BTreeMap;

/// What the rows are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RecordKind {
    /// Turning operations.
    Turning,
    /// Milling cuts.
    Milling,
    /// Grinding trials.
    Grinding,
    /// Events of machines.
    Shop,
    /// Jobs that came to the shop.
    Orders,
    /// Runs of part programs, as a whole or stretch by stretch.
    Program,
    /// Operations of any process, for an empirical model.
    Empirical,
}

/// Rows of one kind, column by column. A missing number is NaN, a missing text empty.
#[derive(Clone, Debug, PartialEq)]
pub struct Records {
    /// What the rows are.
    pub kind: RecordKind,
    len: usize,
    numbers: BTreeMap<String, Vec<f64>>,
    texts: BTreeMap<String, Vec<String>>,
}

impl Records {
    /// No columns, `len` rows.
    pub fn new(kind: RecordKind, len: usize) -> Self {
        Self { kind, len, numbers: BTreeMap::new(), texts: BTreeMap::new() }
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there are no rows.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Numbers of a column in SI, NaN where missing.
    pub fn numbers(&self, name: &str) -> Option<&[f64]> {
        self.numbers.get(name).map(Vec::as_slice)
    }

    /// Texts of a column, empty where missing.
    pub fn texts(&self, name: &str) -> Option<&[String]> {
        self.texts.get(name).map(Vec::as_slice)
    }

    /// Names of the columns with numbers.
    pub fn number_columns(&self) -> impl Iterator<Item = &str> {
        self.numbers.keys().map(String::as_str)
    }

    /// Adds or replaces a column of numbers, SI.
    ///
    /// # Panics
    /// Where the length is not that of the rows.
    pub fn set_numbers(&mut self, name: &str, values: Vec<f64>) {
        assert_eq!(values.len(), self.len, "a column has a value a row");
        self.numbers.insert(name.to_owned(), values);
    }

    /// Drops a column.
    pub fn remove(&mut self, name: &str) {
        self.numbers.remove(name);
        self.texts.remove(name);
    }

    /// Adds or replaces a column of texts.
    ///
    /// # Panics
    /// Where the length is not that of the rows.
    pub fn set_texts(&mut self, name: &str, values: Vec<String>) {
        assert_eq!(values.len(), self.len, "a column has a value a row");
        self.texts.insert(name.to_owned(), values);
    }

    /// The levels of a text column and each row's level; `None` without the column or with a
    /// single level. Rows without text share the level called "".
    pub fn levels(&self, name: &str) -> Option<(Vec<String>, Vec<usize>)> {
        let texts = self.texts(name)?;
        let mut names: Vec<String> = texts.to_vec();
        names.sort();
        names.dedup();
        let of_row = texts.iter().map(|text| names.binary_search(text).unwrap_or(0)).collect();
        Some((names, of_row))
    }

    /// The rows given by index, in that order.
    #[must_use]
    pub fn select(&self, rows: &[usize]) -> Self {
        let mut selected = Self::new(self.kind, rows.len());
        for (name, values) in &self.numbers {
            selected.numbers.insert(name.clone(), rows.iter().map(|row| values[*row]).collect());
        }
        for (name, values) in &self.texts {
            selected.texts.insert(name.clone(), rows.iter().map(|row| values[*row].clone()).collect());
        }
        selected
    }

    /// Both, one after the other; columns that one of them lacks are missing there.
    #[must_use]
    pub fn followed_by(&self, other: &Self) -> Self {
        let mut joined = Self::new(self.kind, self.len + other.len);
        for name in self.numbers.keys().chain(other.numbers.keys()) {
            let part =
                |records: &Self| records.numbers.get(name).cloned().unwrap_or_else(|| vec![f64::NAN; records.len]);
            joined.numbers.insert(name.clone(), [part(self), part(other)].concat());
        }
        for name in self.texts.keys().chain(other.texts.keys()) {
            let part =
                |records: &Self| records.texts.get(name).cloned().unwrap_or_else(|| vec![String::new(); records.len]);
            joined.texts.insert(name.clone(), [part(self), part(other)].concat());
        }
        joined
    }
}
