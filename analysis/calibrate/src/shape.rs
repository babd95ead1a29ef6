//! The shape of the wear curve of laws of lives, and a law with its shape.

use crate::law::Law;

/// How flank wear rises over the life of an edge, where the law states lives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Shape {
    /// Evenly.
    Straight,
    /// In three stages: fast, slow, fast.
    Curved,
    /// In three stages of which the first and the last differ.
    Tilted,
}

impl Shape {
    /// Every shape, that of fewest parameters first.
    pub const ALL: [Self; 3] = [Self::Straight, Self::Curved, Self::Tilted];

    /// Word on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Straight => "straight",
            Self::Curved => "curved",
            Self::Tilted => "tilted",
        }
    }

    /// The shape of a word.
    pub fn named(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|shape| shape.name() == word)
    }
}

/// A law with the shape of its wear curve: what the data choose among.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Candidate {
    /// The law.
    pub law: Law,
    /// The shape; laws of wear rates have one of their own and are [`Shape::Curved`].
    pub shape: Shape,
}

impl From<Law> for Candidate {
    fn from(law: Law) -> Self {
        Self { law, shape: Shape::Curved }
    }
}

impl Candidate {
    /// The law's group, with the shape where it is not the usual one.
    pub fn name(self) -> String {
        let law = self.law.group();
        match self.shape {
            Shape::Curved => law.to_owned(),
            Shape::Straight | Shape::Tilted => format!("{law}, {}", self.shape.name()),
        }
    }
}
