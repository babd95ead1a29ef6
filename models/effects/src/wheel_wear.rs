//! The grinding wheel wears.

use crate::catalogue::{CatalogueEntry, falls};
use crate::{Context, Search, Terms};
use toolroom_process::{Number, Record, record};

record! {
    /// The grinding wheel wears by `size` volume per volume ground, 1/G.
    ///
    /// # Source
    /// Grinding ratio G (King & Hahn, Handbook of Modern Grinding Technology, 1986).
    pub struct WheelWear {
        /// Wheel volume worn per work volume ground, 1/G.
        size: Real = 0.0, 0.0..=10.0;
    }
}

pub(crate) const ENTRY: CatalogueEntry = CatalogueEntry {
    id: "wheel_wear",
    title: "the grinding wheel wears",
    size: &WheelWear::<f64>::FIELDS[0],
    channels: &[
        falls("stock_removed"),
        falls("normal_force"),
        falls("tangential_force"),
        falls("force_after_spark_out"),
    ],
    regime: "commanded infeed and work diameter",
    confounder: "an infeed scale error",
    separating_test: "measure the wheel before and after ten parts",
    source: "King & Hahn 1986, grinding ratio",
    processes: &[("infeed", Search::WheelPosition { each_part: 0.1, since_dressing: 0.01 })],
};

impl<N: Number> WheelWear<N> {
    pub(crate) fn act(&self, _context: &Context<N>, terms: &mut Terms<N>) {
        terms.wheel_wear_ratio += self.size;
    }
}
