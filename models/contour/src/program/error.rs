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
    #[error("{word} is not followed: {reason}")]
    Unsupported {
        /// The word.
        word: String,
        /// Why.
        reason: &'static str,
    },
    /// A number given by a variable.
    #[error(
        "{letter} is a variable or an expression: only numbers can be read, so write its value, or post the program as plain G-code"
    )]
    Variable {
        /// Letter of the word.
        letter: char,
    },
    /// Two motions in one block.
    #[error("two motions stand in one block; write one block a motion")]
    TwoMotions,
    /// A motion at feed before any feed.
    #[error(
        "a motion at feed, but no F above zero stands before it; after a change between G94 and G95, or of the unit, F has to be given anew"
    )]
    NoFeed,
    /// A coordinate before any unit.
    #[error(
        "nothing says whether lengths are millimetres or inches: add G21 or G20 before the first motion, or say it with `--units mm`"
    )]
    NoUnits,
    /// Axes that are named while no motion code is in force.
    #[error(
        "axes are named, but which motion is meant differs by control at the start and behind G80: write G0, G1, G2 or G3"
    )]
    NoMotion,
    /// A dwell whose length is not known.
    #[error("the length of the dwell is not known: {reason}")]
    Dwell {
        /// Why, and what mends it.
        reason: &'static str,
    },
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

impl ProgramFault {
    pub(super) fn not_words(message: &str) -> Self {
        Self::Syntax { message: message.to_owned() }
    }
}

impl ProgramError {
    pub(super) fn at(text: &str, offset: usize, fault: ProgramFault) -> Self {
        let (line, column) = toolroom_process::parameters::place(text, offset);
        Self { line, column, fault }
    }
}
