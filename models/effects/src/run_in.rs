//! A fresh edge wears faster.

use crate::catalogue::{CatalogueEntry, rises};
use crate::{Context, Search, Terms};
use toolroom_process::{Number, Record, record};

record! {
    /// A fresh edge wears faster: `wear_rate × (1 + size · exp(−t / time_constant))` with t the
    /// time that the edge has been in cut.
    ///
    /// # Source
    /// The first stage of every wear curve; the exponential is an assumption.
    pub struct RunIn {
        /// Share by which a new edge wears faster.
        size: Real = 0.0, 0.0..=50.0;
        /// Time in cut after which the excess has fallen to 1/e; assumption.
        time_constant: Real["s" => "min"] = 240.0, 1.0..=36000.0;
    }
}

pub(crate) const ENTRY: CatalogueEntry = CatalogueEntry {
    id: "run_in",
    title: "a fresh edge wears faster",
    size: &RunIn::<f64>::FIELDS[0],
    channels: &[rises("flank_wear")],
    regime: "cutting_time of the edge",
    confounder: "sharp-edge geometry",
    separating_test: "read the wear early and often on new edges",
    source: "first stage of the wear curve (ISO 3685); exponential form and 4 min are assumptions",
    processes: &[("turning", Search::Size(1.5)), ("milling", Search::Size(1.5))],
};

impl<N: Number> RunIn<N> {
    pub(crate) fn act(&self, context: &Context<N>, terms: &mut Terms<N>) {
        terms.wear_rate *= self.size * (-context.cutting_time / self.time_constant).exp() + 1.0;
    }
}
