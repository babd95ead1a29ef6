//! Parts that are put together from others.

use super::{Part, Scenario};

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
