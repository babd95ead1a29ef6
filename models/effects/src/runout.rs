//! Tool or blank runs out of true.

use crate::catalogue::{CatalogueEntry, rises};
use crate::{Context, Search, Terms};
use toolroom_process::{Number, Record, record};

record! {
    /// Tool or blank runs out of true by the radial offset `size`.
    ///
    /// A milling tooth then takes up to 2 · size · sin(π / teeth) more than the nominal chip,
    /// a turning edge once per revolution up to `size` more depth. The offset is what is
    /// measured as half of the dial gauge reading.
    ///
    /// # Source
    /// Kline & DeVor, The effect of runout on cutting geometry and forces in end milling,
    /// Int. J. Mach. Tool Des. Res. 23 (1983), parallel offset.
    pub struct Runout {
        /// Radial offset of the axes.
        size: Real["m" => "um"] = 0.0, 0.0..=1e-3;
    }
}

pub(crate) const ENTRY: CatalogueEntry = CatalogueEntry {
    id: "runout",
    title: "tool or blank runs out of true",
    size: &Runout::<f64>::FIELDS[0],
    channels: &[rises("vibration_rms"), rises("roughness_ra"), rises("flank_wear")],
    regime: "once per revolution",
    confounder: "unequal wear of the teeth",
    separating_test: "dial gauge on the tool or blank",
    source: "Kline & DeVor 1983, parallel offset",
    processes: &[("turning", Search::Size(10e-6)), ("milling", Search::Size(10e-6))],
};

impl<N: Number> Runout<N> {
    pub(crate) fn act(&self, _context: &Context<N>, terms: &mut Terms<N>) {
        terms.runout += self.size;
    }
}
