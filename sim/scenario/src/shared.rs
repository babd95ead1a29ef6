//! Counted things that an operation needs beside its machine: fixtures, pallets, edges.

use super::{Crib, Stock};

/// What operations need beside their machines.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shared {
    /// Fixtures and pallets.
    pub fixtures: Vec<Fixture>,
    /// Edges of the tools of which there are not as many as are needed.
    pub cribs: Vec<Crib>,
    /// Components in stock at the start, and their reorders.
    pub stocks: Vec<Stock>,
}

impl Shared {
    /// The crib of a tool, by index.
    pub fn crib_of(&self, tool: usize) -> Option<usize> {
        self.cribs.iter().position(|crib| crib.tool == tool)
    }
}

/// A fixture or pallet of which there are so many.
#[derive(Clone, Debug, PartialEq)]
pub struct Fixture {
    /// Name, unique.
    pub name: String,
    /// How many there are.
    pub count: u32,
    /// Which operations need one.
    pub holds: Vec<Hold>,
}

/// Operations from whose first to whose last a job has one of a fixture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hold {
    /// Part, by index.
    pub part: usize,
    /// The operation that begins only with it, by index.
    pub from: usize,
    /// The operation after which it is free again, by index: `from` where it does not travel.
    pub until: usize,
}

impl Hold {
    /// Whether an operation of a part needs it.
    #[inline]
    pub fn contains(&self, part: usize, operation: usize) -> bool {
        self.part == part && self.from <= operation && operation <= self.until
    }

    /// Whether it goes with its job from one operation to the next.
    pub fn travels(&self) -> bool {
        self.until > self.from
    }
}
