//! The contact grows hotter with flank wear.

use crate::catalogue::{CatalogueEntry, rises};
use crate::{Context, Search, Terms};
use toolroom_process::{Number, Record, record};

record! {
    /// The contact grows hotter with the flank wear land:
    /// `temperature_rise × (1 + size · VB / reference_wear)`.
    ///
    /// Comes on top of the flank friction heat that a model may already have.
    ///
    /// # Source
    /// Assumption: the first-order form of flank friction heating.
    pub struct WearTemperature {
        /// Share by which the temperature rise has grown at the reference wear.
        size: Real = 0.0, 0.0..=5.0;
        /// Wear to which the size refers; ISO 3685 wear limit.
        reference_wear: Real["m" => "mm"] = 0.3e-3, 1e-6..=5e-3;
    }
}

pub(crate) const ENTRY: CatalogueEntry = CatalogueEntry {
    id: "wear_temperature",
    title: "the contact grows hotter with flank wear",
    size: &WearTemperature::<f64>::FIELDS[0],
    channels: &[rises("temperature"), rises("thermo_emf"), rises("flank_wear")],
    regime: "flank_wear",
    confounder: "wear_acceleration",
    separating_test: "temperature of a worn and of a new insert in the same cut",
    source: "assumption: first-order form of flank friction heating",
    processes: &[("turning", Search::Size(0.1))],
};

impl<N: Number> WearTemperature<N> {
    pub(crate) fn act(&self, context: &Context<N>, terms: &mut Terms<N>) {
        terms.temperature_rise *= self.size * (context.flank_wear / self.reference_wear) + 1.0;
    }
}
