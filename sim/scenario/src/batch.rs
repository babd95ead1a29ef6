//! Machines that work on several jobs at once: furnaces, washing machines, ovens.

use toolroom_form::vocabulary;

/// How a machine gathers the jobs that it works on together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Batch {
    /// Most that fit in.
    pub max: u32,
    /// Number of one family from which it starts at once.
    pub min: u32,
    /// Time after which it starts with fewer, from the arrival of the one that has waited longest, s; `None`: never.
    pub time_out: Option<f64>,
    /// What may go in together.
    pub same: BatchFamily,
    /// What is counted.
    pub by: BatchUnit,
}

vocabulary! {
    /// Jobs that may be worked on together.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum BatchFamily {
        /// Those of one setup group.
        SetupGroup = "setup_group",
        /// Those of one part at the same operation.
        Part = "part",
        /// All.
        Any = "any",
    }
}

vocabulary! {
    /// What the size of a batch counts.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum BatchUnit {
        /// Pieces.
        Pieces = "pieces",
        /// Jobs: a piece, or all that moves together of an order.
        Lots = "lots",
    }
}

vocabulary! {
    /// For what a random time of plain work is drawn.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub enum DrawUnit {
        /// For all pieces of an order at once: what deviates for one deviates for all.
        #[default]
        Lot = "lot",
        /// For every piece by itself.
        Part = "part",
    }
}

vocabulary! {
    /// What takes the time of plain work once.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub enum WorkPer {
        /// Every piece.
        #[default]
        Part = "part",
        /// All that moves together.
        Lot = "lot",
        /// All that a batch machine works on together.
        Batch = "batch",
    }
}

/// What the pieces of a job have to do with the time of an operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PieceTimes {
    /// Each takes as long as the first.
    Alike,
    /// All of them take one time.
    Together,
    /// All that a batch machine works on together takes one time.
    OfBatch,
    /// Each has a time of its own, or some pass by.
    Own,
}
