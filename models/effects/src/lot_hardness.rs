//! One lot of material is harder.

use crate::catalogue::{CatalogueEntry, rises};
use crate::{Context, Search, Terms};
use toolroom_process::{Number, Record, record};

record! {
    /// One lot of material is harder: on that lot the specific cutting force and the mechanical
    /// wear are each × (1 + size).
    ///
    /// # Source
    /// Assumption for the equal shares. For scale, VDI 3323 groups 1 and 3 (125 and 250 HB) have
    /// k_c1.1 = 1350 and 1675 N/mm²: size 0.24 is a doubling of the hardness.
    pub struct LotHardness {
        /// Share by which the deviating lot is harder to cut; below zero it is softer.
        size: Real = 0.0, -0.3..=5.0;
    }
}

pub(crate) const ENTRY: CatalogueEntry = CatalogueEntry {
    id: "lot_hardness",
    title: "one lot of material is harder",
    size: &LotHardness::<f64>::FIELDS[0],
    channels: &[rises("cutting_force"), rises("feed_force"), rises("spindle_power"), rises("flank_wear")],
    regime: "lot",
    confounder: "machine or calendar drift",
    separating_test: "both lots with one edge on one machine",
    source: "ISCAR table of specific cutting forces, VDI 3323 groups 1 and 3; equal shares are an assumption",
    processes: &[("turning", Search::Lots(0.1)), ("milling", Search::Lots(0.1))],
};

impl<N: Number> LotHardness<N> {
    pub(crate) fn act(&self, context: &Context<N>, terms: &mut Terms<N>) {
        let factor = self.size * context.lot_deviation + 1.0;
        terms.specific_cutting_force *= factor;
        terms.mechanical_wear *= factor;
    }
}
