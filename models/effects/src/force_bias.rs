//! The force reading has a zero error.

use crate::catalogue::{CatalogueEntry, rises};
use crate::{Context, Search, Terms};
use toolroom_process::{Number, Record, record};

record! {
    /// The force reading has a zero error: the cutting force reads `+ size`.
    ///
    /// # Source
    /// Assumption: constant.
    pub struct ForceBias {
        /// Force that is read without a cut.
        size: Real["N" => "N"] = 0.0, -1e4..=1e4;
    }
}

pub(crate) const ENTRY: CatalogueEntry = CatalogueEntry {
    id: "force_bias",
    title: "the force reading has a zero error",
    size: &ForceBias::<f64>::FIELDS[0],
    channels: &[rises("cutting_force")],
    regime: "small cuts, where forces are low",
    confounder: "edge force of the sharp edge",
    separating_test: "read the sensor in air before and after each cut",
    source: "assumption: constant",
    processes: &[
        ("turning", Search::ShareOfMedian { column: "cutting_force", share: 0.05 }),
        ("milling", Search::ShareOfMedian { column: "cutting_force", share: 0.05 }),
    ],
};

impl<N: Number> ForceBias<N> {
    pub(crate) fn act(&self, _context: &Context<N>, terms: &mut Terms<N>) {
        terms.force_offset += self.size;
    }
}
