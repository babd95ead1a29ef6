//! Edges chip.

use crate::catalogue::{CatalogueEntry, rises};
use crate::{Context, Search, Terms};
use toolroom_process::{Number, Record, record};

record! {
    /// Edges chip: a Weibull hazard per path on top of the tool's own, with the rate `size`.
    ///
    /// # Source
    /// Weibull hazard of brittle edges (Ramalingam & Watson 1977, recalled).
    pub struct ChippingHazard {
        /// Rate: the inverse of the characteristic path.
        size: Real["1/m" => "1/km"] = 0.0, 0.0..=1e-2;
    }
}

pub(crate) const ENTRY: CatalogueEntry = CatalogueEntry {
    id: "chipping",
    title: "edges chip",
    size: &ChippingHazard::<f64>::FIELDS[0],
    channels: &[rises("stop_count")],
    regime: "edges that end before the wear limit",
    confounder: "a wear limit that is not kept",
    separating_test: "photograph every edge that ends early",
    source: "Ramalingam & Watson 1977, recalled",
    processes: &[
        ("turning", Search::Untried("it decides when an edge ends, which no channel of a cut reads")),
        ("milling", Search::Untried("it decides when an edge ends, which no channel of a cut reads")),
    ],
};

impl<N: Number> ChippingHazard<N> {
    pub(crate) fn act(&self, _context: &Context<N>, terms: &mut Terms<N>) {
        terms.chipping_rate += self.size;
    }
}
