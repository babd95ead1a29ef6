//! Contact begins late.

use crate::catalogue::{CatalogueEntry, falls, rises};
use crate::{Context, Search, Terms};
use toolroom_process::{Number, Record, record};

record! {
    /// Contact begins late: `size` of the commanded infeed goes into air.
    ///
    /// # Source
    /// Assumption: constant per plunge.
    pub struct StartOffset {
        /// Infeed that is commanded before contact.
        size: Real["m" => "um"] = 0.0, 0.0..=1e-3;
    }
}

pub(crate) const ENTRY: CatalogueEntry = CatalogueEntry {
    id: "start_offset",
    title: "contact begins late",
    size: &StartOffset::<f64>::FIELDS[0],
    channels: &[falls("stock_removed"), rises("rise_revolutions")],
    regime: "the same at every infeed",
    confounder: "K, thermal_growth",
    separating_test: "vary the infeed per revolution: an offset stays, a lag grows",
    source: "assumption: constant per plunge",
    processes: &[("infeed", Search::Size(3e-6))],
};

impl<N: Number> StartOffset<N> {
    pub(crate) fn act(&self, _context: &Context<N>, terms: &mut Terms<N>) {
        terms.start_offset += self.size;
    }
}
