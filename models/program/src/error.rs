//! Faults of part programs.

use crate::Dialect;
use std::fmt;
pub(crate) use toolroom_dialect::Fault;

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
    /// Words in later lines that are refused whatever went before, at most [`MOST`](Self::MOST) with this one.
    pub others: Vec<ProgramError>,
}

impl ProgramError {
    /// Greatest number of refusals that are told at once.
    pub const MOST: usize = 20;

    /// This refusal and the others, in the order in which the program comes to them.
    pub fn all(&self) -> impl Iterator<Item = &Self> {
        std::iter::once(self).chain(&self.others)
    }

    /// The error of a program for `dialect` in which nothing moves.
    pub fn still(dialect: Dialect) -> Self {
        Self::of_line(1, dialect, "the program moves no axis and dwells nowhere; check that it is the right file")
    }

    /// A fault of a line, from 1, of the program itself.
    pub fn of_line(line: usize, dialect: Dialect, message: impl Into<String>) -> Self {
        let (calls, others) = (Vec::new(), Vec::new());
        Self { file: None, line: line.max(1), column: 1, dialect, message: message.into(), calls, others }
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
