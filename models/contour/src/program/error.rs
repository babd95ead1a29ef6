//! What a part program is refused for.

/// Why the time of a program cannot be told.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ProgramFault {
    /// Not words and numbers.
    #[error("{message}")]
    Syntax {
        /// What the parser says.
        message: String,
    },
    /// A word whose time is not known here.
    #[error("{word} is not supported: {reason}")]
    Unsupported {
        /// The word.
        word: String,
        /// Why.
        reason: &'static str,
    },
    /// A number given by a variable.
    #[error("{letter} is a variable; only numbers can be read")]
    Variable {
        /// Letter of the word.
        letter: char,
    },
    /// Two motions in one block.
    #[error("two motions stand in one block; write one block a motion")]
    TwoMotions,
    /// A motion at feed before any feed.
    #[error("a motion at feed, but no F above zero stands before it")]
    NoFeed,
    /// An arc without centre or radius, or one that misses its end.
    #[error("{message}")]
    Arc {
        /// What is wrong.
        message: String,
    },
    /// A canned cycle that lacks a word.
    #[error("the canned cycle G{cycle} needs {word}")]
    Cycle {
        /// Number of the cycle.
        cycle: u32,
        /// What is missing.
        word: &'static str,
    },
    /// A program without any motion.
    #[error("the program moves nothing")]
    Empty,
}

/// A fault and its place, from line and column 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("line {line}, column {column}: {fault}")]
pub struct ProgramError {
    /// Line.
    pub line: usize,
    /// Column.
    pub column: usize,
    /// What is wrong.
    pub fault: ProgramFault,
}

impl ProgramError {
    pub(super) fn at(text: &str, offset: usize, fault: ProgramFault) -> Self {
        let (line, column) = toolroom_process::parameters::place(text, offset);
        Self { line, column, fault }
    }
}
