//! An edge that crawls rubs and wears.

use crate::catalogue::{CatalogueEntry, rises};
use crate::{Context, Search, Terms};
use toolroom_process::{Number, Record, record};

record! {
    /// An edge that crawls rubs and wears: while the feed override is below `threshold`, the wear rate
    /// is `× (1 + size)`.
    ///
    /// # Source
    /// Assumption: at a few per cent of the programmed feed the chip is thinner than the edge is round.
    pub struct CrawlWear {
        /// Share by which the wear rate is higher.
        size: Real = 0.0, 0.0..=50.0;
        /// Feed override below which the edge crawls; assumption.
        threshold: Real = 0.3, 0.01..=1.0;
    }
}

pub(crate) const ENTRY: CatalogueEntry = CatalogueEntry {
    id: "crawl_wear",
    title: "an edge that crawls rubs and wears",
    size: &CrawlWear::<f64>::FIELDS[0],
    channels: &[rises("flank_wear")],
    regime: "feed_override below 30 %",
    confounder: "lot_hardness, operator",
    separating_test: "one edge at 20 % override, one at 100 %, the same path",
    source: "assumption: step at 30 %",
    processes: &[
        ("turning", Search::Below { column: "feed_override", bound: 0.3, size: 1.0 }),
        ("milling", Search::Below { column: "feed_override", bound: 0.3, size: 1.0 }),
    ],
};

impl<N: Number> CrawlWear<N> {
    pub(crate) fn act(&self, context: &Context<N>, terms: &mut Terms<N>) {
        if context.feed_override.re() < self.threshold.re() {
            terms.wear_rate *= self.size + 1.0;
        }
    }
}
