//! Parts that are put together from others.

use super::{Part, Scenario};
use toolroom_form::vocabulary;

/// Pieces of a component in stock when the run begins, and when more are made or bought.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stock {
    /// Part, by index.
    pub part: usize,
    /// Pieces at the start.
    pub quantity: u32,
    /// When more come; `None`: nobody orders any.
    pub reorder: Option<Reorder>,
}

/// A lot that is ordered whenever pieces in stock and on their way are few.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reorder {
    /// Pieces in stock and on order below which a lot is ordered.
    pub below: u32,
    /// Pieces of a lot.
    pub lot: u32,
    /// Time until bought pieces come, s; `None`: the shop makes them.
    pub lead: Option<f64>,
    /// Priority of the lots in the shop: the smaller, the more urgent.
    pub priority: u32,
}

vocabulary! {
    /// Which components an operation that assembles may take.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub enum Pegging {
        /// Whatever is in stock.
        #[default]
        Stock = "stock",
        /// Only what was made for its order: by orders that name it as their `parent`.
        Order = "order",
    }
}

/// What goes into a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Component {
    /// Part, by index.
    pub part: usize,
    /// Pieces of it that go into one.
    pub quantity: u32,
}

impl Part {
    /// Index of the operation before which its components have to be there.
    pub fn assembly(&self) -> Option<usize> {
        self.operations.iter().position(|operation| operation.assembles)
    }
}

impl Scenario {
    /// Whether a part goes into another one.
    pub fn is_component(&self, part: usize) -> bool {
        self.parts.iter().any(|other| other.components.iter().any(|component| component.part == part))
    }

    /// Whether a part stands for edges that are ground anew: it is none that the shop makes.
    pub fn is_regrind(&self, part: usize) -> bool {
        self.shared.cribs.iter().filter_map(|crib| crib.regrind.as_ref()).any(|own| own.part == Some(part))
    }
}
