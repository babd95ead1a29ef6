//! The grinding wheel rubs before it cuts.

use crate::catalogue::{CatalogueEntry, falls, rises};
use crate::{Context, Search, Terms};
use toolroom_process::{Number, Record, record};

record! {
    /// The grinding wheel rubs before it cuts: no material is removed below the normal force
    /// `size`, and above it `normal_force = size + Cp · depth`.
    ///
    /// # Source
    /// Hahn & King, threshold force of the wheel–work pair (King & Hahn, Handbook of Modern
    /// Grinding Technology, 1986).
    pub struct ThresholdForce {
        /// Normal force below which the wheel only rubs, F0.
        size: Real["N" => "N"] = 0.0, 0.0..=5000.0;
    }
}

pub(crate) const ENTRY: CatalogueEntry = CatalogueEntry {
    id: "threshold_force",
    title: "the grinding wheel rubs before it cuts",
    size: &ThresholdForce::<f64>::FIELDS[0],
    channels: &[
        rises("normal_force"),
        rises("tangential_force"),
        rises("force_after_spark_out"),
        falls("stock_removed"),
    ],
    regime: "low infeed, spark-out",
    confounder: "force exponent below one",
    separating_test: "low infeed and a long spark-out: the force keeps a floor",
    source: "King & Hahn 1986, threshold force",
    processes: &[("infeed", Search::Size(15.0))],
};

impl<N: Number> ThresholdForce<N> {
    pub(crate) fn act(&self, _context: &Context<N>, terms: &mut Terms<N>) {
        terms.threshold_force += self.size;
    }
}
