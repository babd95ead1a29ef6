//! Where in which file an error is, as data: a program that reads errors gets the place without reading the message.
//!
//! Whoever reads a file gives its errors a location where they arise; errors of other rooms that hold one hand it on.
//!
//! # What is not modelled
//! Places of a text with changes from the command line beside it: files of keys have their own, `toolroom_form::Place`.

#![deny(clippy::wildcard_enum_match_arm)]

use std::fmt::Display;

/// Where an error is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Location {
    /// Name of the file, as the user gave it.
    pub file: String,
    /// Line or row, from 1; `None` where the file as a whole is at fault.
    pub line: Option<usize>,
    /// Column, from 1, where it is known.
    pub column: Option<usize>,
}

impl Location {
    /// A file as a whole.
    pub fn of(file: impl Display) -> Self {
        Self { file: file.to_string(), line: None, column: None }
    }

    /// A line of a file, from 1.
    pub fn line(file: impl Display, line: usize) -> Self {
        Self { line: Some(line), ..Self::of(file) }
    }

    /// A column of a line, both from 1.
    pub fn column(file: impl Display, line: usize, column: usize) -> Self {
        Self { column: Some(column), ..Self::line(file, line) }
    }
}

/// An error that knows where it is.
pub trait Located {
    /// Where the error is; `None` where no file is at fault.
    fn location(&self) -> Option<Location>;
}
