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
    /// Which pieces are judged; `None`: all of them.
    pub sample: Option<Sample>,
    /// Where parts go back that are cut and out of their tolerances, by operation; `None`: to the scrap.
    pub on_reject: Option<usize>,
}

impl Inspection {
    /// Whether pieces pass by the operation because they are in no sample.
    pub fn passes_by(&self) -> bool {
        self.sample.is_some_and(|sample| sample.others == OutsideSample::Pass)
    }

    /// Whether it sends any part back.
    pub fn sends_back(&self) -> bool {
        self.on_reject.is_some() || self.outcomes.iter().any(|own| own.to != InspectedTo::Scrap)
    }
}

/// Every so many pieces one is judged: of an order, or of a source, the first and every `every`th after it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sample {
    /// Distance of those that are judged.
    pub every: u32,
    /// What becomes of the others.
    pub others: OutsideSample,
}

impl Sample {
    /// Whether the piece of this number, from 0, is in it.
    pub fn has(self, piece: u64) -> bool {
        piece.is_multiple_of(u64::from(self.every.max(1)))
    }

    /// Pieces of it among `count` from the number `first` on.
    ///
    /// # Examples
    /// ```
    /// use toolroom_scenario::{OutsideSample, Sample};
    /// let fifth = Sample { every: 5, others: OutsideSample::Worked };
    /// // The numbers 0, 5 and 10 of eleven; of four from number 6 on none.
    /// assert_eq!([fifth.among(0, 11), fifth.among(6, 4), fifth.among(6, 5)], [3, 0, 1]);
    /// ```
    pub fn among(self, first: u64, count: u32) -> u32 {
        let every = u64::from(self.every.max(1));
        ((first + u64::from(count)).div_ceil(every) - first.div_ceil(every)) as u32
    }
}

vocabulary! {
    /// What becomes of pieces that are in no sample.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub enum OutsideSample {
        /// The operation is done on them, and nobody judges them.
        #[default]
        Worked = "worked",
        /// They pass by the operation, which is done on the sample only.
        Pass = "pass",
    }
}

/// What is done about pieces of an order that are lost.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Replenish {
    /// Nothing: they are missing.
    #[default]
    Nothing,
    /// As many begin anew at once.
    NewOrder {
        /// What their priority differs from that of the order; below 0 they are more urgent.
        priority: i32,
    },
    /// So many more are begun with, as a share of the quantity.
    Overrun(f64),
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
