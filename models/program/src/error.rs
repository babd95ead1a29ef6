//! Faults of part programs.

use crate::Dialect;
use std::fmt;

/// A fault of one block, before it is known where it stands.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Fault {
    /// Column of the word, from 1; 0 for the block as a whole.
    pub column: usize,
    /// What is wrong and what to do.
    pub message: String,
}

impl Fault {
    pub fn new(message: impl Into<String>) -> Self {
        Self { column: 0, message: message.into() }
    }

    pub fn at(column: usize, message: impl Into<String>) -> Self {
        Self { column, message: message.into() }
    }

    /// Names a column where the fault has none.
    pub fn or_at(mut self, column: usize) -> Self {
        if self.column == 0 {
            self.column = column;
        }
        self
    }
}

/// A part program that cannot be followed: where, in the words of which control, why, and what mends it.
#[derive(Clone, Debug, PartialEq)]
pub struct ProgramError {
    /// File of a subprogram beside the program; `None` for the program itself.
    pub file: Option<String>,
    /// Line, from 1.
    pub line: usize,
    /// Column, from 1.
    pub column: usize,
    /// Control that the program was read for.
    pub dialect: Dialect,
    /// What is wrong and what to do.
    pub message: String,
    /// Calls of subprograms that led there, the innermost first: line of the call and how often it has run.
    pub calls: Vec<(usize, usize)>,
}

impl ProgramError {
    /// The error of a program for `dialect` in which nothing moves.
    pub fn still(dialect: Dialect) -> Self {
        Self::of_line(1, dialect, "the program moves no axis; check that it is the right file")
    }

    /// A fault of a line of the program itself.
    pub(crate) fn of_line(line: usize, dialect: Dialect, message: impl Into<String>) -> Self {
        Self { file: None, line: line.max(1), column: 1, dialect, message: message.into(), calls: Vec::new() }
    }
}

impl fmt::Display for ProgramError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}: {}: ", self.line, self.column, self.dialect.name())?;
        if let Some(file) = &self.file {
            write!(f, "{file}: ")?;
        }
        f.write_str(&self.message)?;
        for (line, count) in &self.calls {
            write!(f, " (called from line {line}, run {count})")?;
        }
        Ok(())
    }
}

impl std::error::Error for ProgramError {}

/// The message of a word that is refused because nobody knows what it does.
pub(crate) fn unknown(word: &str, table: &str, number: &str) -> String {
    format!(
        "{word} is not understood; it might move axes or take time: mend it, or say what it costs with \
         --set control.{table}.{number}=\"0 s\""
    )
}
