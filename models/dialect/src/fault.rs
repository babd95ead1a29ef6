//! Faults of single blocks.

use toolroom_pages::ReadError;

/// A fault of one block, before it is known where it stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// Column of the word, from 1; 0 for the block as a whole.
    pub column: usize,
    /// What is wrong and what to do.
    pub message: String,
    /// Line, from 1, where it is not that of the block which runs; 0 else.
    pub line: usize,
    /// Whether the words of the block are refused whatever went before: this fault does not follow from another.
    pub refuses: bool,
}

impl Fault {
    /// A fault of the block as a whole.
    pub fn new(message: impl Into<String>) -> Self {
        Self::at(0, message)
    }

    /// A fault of the word in a column, from 1.
    pub fn at(column: usize, message: impl Into<String>) -> Self {
        Self { column, message: message.into(), line: 0, refuses: false }
    }

    /// Words that are refused whatever went before.
    #[must_use]
    pub fn refusing(mut self) -> Self {
        self.refuses = true;
        self
    }

    /// A fault of another line than the one that runs.
    #[must_use]
    pub fn in_line(mut self, line: usize) -> Self {
        self.line = line;
        self
    }

    /// Names a column where the fault has none.
    #[must_use]
    pub fn or_at(mut self, column: usize) -> Self {
        if self.column == 0 {
            self.column = column;
        }
        self
    }
}

impl From<ReadError> for Fault {
    fn from(error: ReadError) -> Self {
        Self::new(error.to_string())
    }
}
