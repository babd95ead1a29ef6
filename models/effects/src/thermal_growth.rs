//! The part is gauged warm.

use crate::catalogue::{CatalogueEntry, falls};
use crate::{Context, Search, Terms};
use toolroom_process::{Number, Record, record};

record! {
    /// The part is gauged warm: the stock reads
    /// `- size · normal_force · revolutions · exp(-wait_time / time_constant)`.
    ///
    /// # Source
    /// Heat into the part in proportion to force and time of grinding, cooling by Newton's law;
    /// assumption. 60 s is an assumption.
    pub struct ThermalGrowth {
        /// Radial growth per force and revolution, gauged without waiting.
        size: Real["m/N" => "um/N"] = 0.0, 0.0..=1e-6;
        /// Time constant of cooling; assumption.
        time_constant: Real["s" => "s"] = 60.0, 1.0..=36000.0;
    }
}

pub(crate) const ENTRY: CatalogueEntry = CatalogueEntry {
    id: "thermal_growth",
    title: "the part is gauged warm",
    size: &ThermalGrowth::<f64>::FIELDS[0],
    channels: &[falls("stock_removed")],
    regime: "force × revolutions, short wait_time",
    confounder: "start_offset",
    separating_test: "gauge the same part at once and after a long wait",
    source: "assumption: heat by force and time, Newton cooling",
    processes: &[(
        "infeed",
        Search::Values {
            parameter: "time_constant",
            values: &[15.0, 60.0, 240.0],
            told_by: Some(("wait_time", 60.0)),
            size: 5e-10,
        },
    )],
};

impl<N: Number> ThermalGrowth<N> {
    pub(crate) fn act(&self, context: &Context<N>, terms: &mut Terms<N>) {
        terms.thermal_growth += self.size * (-context.wait_time / self.time_constant).exp();
    }
}
