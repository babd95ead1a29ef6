//! Typed rows on their way to a file, for crates that do not care which format it has.

use std::error::Error;
use std::fs::File;

/// Kind of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// 64-bit floating point.
    Real,
    /// 32-bit unsigned.
    Count,
    /// Text.
    Text,
}

/// A cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value<'a> {
    /// A number in the display unit; `None` where it is not defined.
    Real(Option<f64>),
    /// A whole number or an index.
    Count(Option<u32>),
    /// A name.
    Text(&'a str),
}

/// What the format of a table said.
pub type TableError = Box<dyn Error + Send + Sync>;

/// A table being written.
pub trait TableWriter {
    /// Adds a row, one cell a column in the order of the columns.
    ///
    /// # Errors
    /// What the format says.
    fn row(&mut self, cells: &[Value<'_>]) -> Result<(), TableError>;

    /// Ends a group of rows that is read as one.
    ///
    /// # Errors
    /// What the format says.
    fn end_group(&mut self) -> Result<(), TableError>;

    /// Closes the table; without it the file cannot be read.
    ///
    /// # Errors
    /// What the format says.
    fn finish(self: Box<Self>) -> Result<(), TableError>;
}

/// Starts a table in a file, given the header and the kind of every column.
pub type NewTable<'a> = &'a (dyn Fn(File, &[(&str, Kind)]) -> Result<Box<dyn TableWriter + Send>, TableError> + Sync);
