//! The temperature reading lags behind in short cuts.

use crate::catalogue::{CatalogueEntry, falls};
use crate::{Context, Search, Terms};
use toolroom_process::{Number, Record, record};

record! {
    /// The temperature reading lags behind: it reads `- size · exp(-pass_time / time_constant)`.
    ///
    /// # Source
    /// First-order sensor; 60 s is an assumption.
    pub struct TemperatureLag {
        /// What the reading lacks at the start of the cut.
        size: Real["K" => "K"] = 0.0, 0.0..=1500.0;
        /// Time constant of the sensor; assumption.
        time_constant: Real["s" => "s"] = 60.0, 0.1..=3600.0;
    }
}

pub(crate) const ENTRY: CatalogueEntry = CatalogueEntry {
    id: "temperature_lag",
    title: "the temperature reading lags behind in short cuts",
    size: &TemperatureLag::<f64>::FIELDS[0],
    channels: &[falls("temperature")],
    regime: "cutting_time of the operation",
    confounder: "the temperature law's dependence on conditions",
    separating_test: "sweep the length of the cut at constant conditions",
    source: "first-order sensor; time constant is an assumption",
    processes: &[(
        "turning",
        Search::Values { parameter: "time_constant", values: &[30.0, 60.0, 120.0, 240.0], told_by: None, size: 50.0 },
    )],
};

impl<N: Number> TemperatureLag<N> {
    pub(crate) fn act(&self, context: &Context<N>, terms: &mut Terms<N>) {
        terms.temperature_offset -= self.size * (-context.pass_time / self.time_constant).exp();
    }
}
