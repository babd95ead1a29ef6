//! There is more or less stock than planned.

use crate::catalogue::{CatalogueEntry, rises};
use crate::{Context, Search, Terms};
use toolroom_process::{Number, Record, record};

record! {
    /// There is more or less stock than planned: radial width of cut `+ size`.
    ///
    /// # Source
    /// Assumption: constant.
    pub struct StockOffset {
        /// Stock beside the planned allowance; below zero there is less.
        size: Real["m" => "mm"] = 0.0, -10e-3..=10e-3;
    }
}

pub(crate) const ENTRY: CatalogueEntry = CatalogueEntry {
    id: "stock_offset",
    title: "there is more or less stock than planned",
    size: &StockOffset::<f64>::FIELDS[0],
    channels: &[rises("cutting_force"), rises("spindle_power"), rises("flank_wear")],
    regime: "small widths of cut",
    confounder: "lot_hardness",
    separating_test: "probe the blank before the cut",
    source: "assumption: constant",
    processes: &[("milling", Search::ShareOfMedian { column: "width_of_cut", share: 0.1 })],
};

impl<N: Number> StockOffset<N> {
    pub(crate) fn act(&self, _context: &Context<N>, terms: &mut Terms<N>) {
        terms.width_of_cut += self.size;
    }
}
