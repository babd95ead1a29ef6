//! Why a file was not read, and where each fault is.

use crate::fault::Problem;
use std::fmt;
use std::ops::Range;
use toolroom_location::{Located, Location};
use toolroom_process::parameters::{place, places};

/// Why a file was not read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The file cannot be opened.
    #[error("{file} cannot be read: {source}")]
    Unreadable {
        /// File.
        file: String,
        /// What the system says.
        source: std::io::Error,
    },
    /// UTF-16 instead of UTF-8.
    #[error("{file} is UTF-16 (\"Unicode\" in some editors); save it as UTF-8")]
    Utf16 {
        /// File.
        file: String,
    },
    /// Bytes that are not UTF-8.
    #[error("{file}:{line}:{column}: byte 0x{byte:02X} is not UTF-8; the file seems to be {likely}: save it as UTF-8")]
    NotUtf8 {
        /// File.
        file: String,
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// The byte.
        byte: u8,
        /// What the encoding probably is.
        likely: &'static str,
    },
    /// Faults in what it says.
    #[error(transparent)]
    Faults(Box<FaultList>),
}

impl Located for ReadError {
    /// Of several faults the first.
    fn location(&self) -> Option<Location> {
        match self {
            Self::Unreadable { file, .. } | Self::Utf16 { file } => Some(Location::of(file)),
            Self::NotUtf8 { file, line, column, .. } => Some(Location::column(file, *line, *column)),
            Self::Faults(list) => list.problems.first().map(|problem| {
                let place = list.place(problem);
                Location::column(list.source(place.origin).0, place.line, place.column)
            }),
        }
    }
}

/// Every fault of one file, in the order of the text.
#[derive(Clone, Debug)]
pub struct FaultList {
    /// Name of the file.
    pub file: String,
    /// Its text.
    pub text: String,
    /// The `--set` texts, which follow the file in the count of bytes.
    pub overrides: Vec<String>,
    /// What is wrong, never empty.
    pub problems: Vec<Problem>,
}

/// Where the text of a fault comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// The file.
    File,
    /// The `--set` of this index.
    Override(usize),
}

/// Where a fault is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// Which text.
    pub origin: Origin,
    /// Bytes within that text.
    pub span: Range<usize>,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
}

impl FaultList {
    /// Where a problem is.
    pub fn place(&self, problem: &Problem) -> Place {
        let (origin, span) = self.bytes(problem);
        let (line, column) = place(self.source(origin).1, span.start);
        Place { origin, span, line, column }
    }

    /// Where every problem is, in their order. Each text is read once, however many problems it has.
    pub fn places(&self) -> Vec<Place> {
        let mut found: Vec<Place> = self
            .problems
            .iter()
            .map(|problem| self.bytes(problem))
            .map(|(origin, span)| Place { origin, span, line: 1, column: 1 })
            .collect();
        let texts = std::iter::once(Origin::File).chain((0..self.overrides.len()).map(Origin::Override));
        for origin in texts {
            let mut here: Vec<&mut Place> = found.iter_mut().filter(|place| place.origin == origin).collect();
            here.sort_by_key(|place| place.span.start);
            let starts: Vec<usize> = here.iter().map(|place| place.span.start).collect();
            let read = places(self.source(origin).1, &starts);
            for (place, (line, column)) in here.into_iter().zip(read) {
                (place.line, place.column) = (line, column);
            }
        }
        found
    }

    /// The text of a problem and its bytes within it.
    fn bytes(&self, problem: &Problem) -> (Origin, Range<usize>) {
        let mut base = 0;
        let texts = std::iter::once(&self.text).chain(&self.overrides).enumerate();
        let (mut origin, mut text, mut start) = (Origin::File, self.text.as_str(), 0);
        for (i, candidate) in texts {
            if problem.span.start >= base {
                origin = if i == 0 { Origin::File } else { Origin::Override(i - 1) };
                (text, start) = (candidate, base);
            }
            base += candidate.len() + 1;
        }
        let within = |at: usize| at.saturating_sub(start).min(text.len());
        (origin, within(problem.span.start)..within(problem.span.end).max(within(problem.span.start)))
    }

    /// The text that a place counts in, with its name.
    pub fn source(&self, origin: Origin) -> (&str, &str) {
        match origin {
            Origin::File => (&self.file, &self.text),
            Origin::Override(i) => ("--set", self.overrides.get(i).map_or("", String::as_str)),
        }
    }
}

impl fmt::Display for FaultList {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, (problem, place)) in self.problems.iter().zip(self.places()).enumerate() {
            let (name, _) = self.source(place.origin);
            let newline = if i == 0 { "" } else { "\n" };
            write!(f, "{newline}{name}:{}:{}: {}", place.line, place.column, problem.fault)?;
            if let Some(fix) = problem.fault.fix() {
                write!(f, "\n    {fix}")?;
            }
        }
        Ok(())
    }
}

impl std::error::Error for FaultList {}
