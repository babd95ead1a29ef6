//! What becomes of parts when an operation is done: they go on, are worked on again, or are scrapped.

use toolroom_form::vocabulary;

/// What an inspection after an operation finds, and what becomes of it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Inspection {
    /// What may happen beside going on, each to its share.
    pub outcomes: Vec<InspectionOutcome>,
    /// Whether pieces of an order are judged one by one or all alike.
    pub per: InspectedUnit,
    /// How often a job is sent back before it is scrapped instead; `None`: without limit.
    pub rework_max: Option<u32>,
}

/// One thing that may happen after an operation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InspectionOutcome {
    /// Share of all to which it happens, 0 to 1.
    pub share: f64,
    /// Where they go.
    pub to: InspectedTo,
}

/// Where an inspection sends a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InspectedTo {
    /// Back to an operation of its routing, by index.
    Operation(usize),
    /// To the scrap.
    Scrap,
}

vocabulary! {
    /// What an inspection judges.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub enum InspectedUnit {
        /// Every piece for itself.
        #[default]
        Part = "part",
        /// All that moves together.
        Lot = "lot",
    }
}
