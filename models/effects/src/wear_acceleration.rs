//! Wear feeds itself.

use crate::catalogue::{CatalogueEntry, rises};
use crate::{Context, Search, Terms};
use toolroom_process::{Number, Record, record};

record! {
    /// Wear feeds itself: `wear_rate × (1 + size · (VB / reference_wear)²)`.
    ///
    /// The damage already done raises the intensity of further damage, the technological
    /// heredity of the evolutionary wear model; it makes the third, accelerated stage of the
    /// wear curve.
    ///
    /// # Source
    /// Postnov & Shafikov, equations (6) and (7), structure; the square is an assumption.
    pub struct WearAcceleration {
        /// Share by which the wear rate has grown at the reference wear.
        size: Real = 0.0, 0.0..=50.0;
        /// Wear to which the size refers; ISO 3685 wear limit.
        reference_wear: Real["m" => "mm"] = 0.3e-3, 1e-6..=5e-3;
    }
}

pub(crate) const ENTRY: CatalogueEntry = CatalogueEntry {
    id: "wear_acceleration",
    title: "wear feeds itself",
    size: &WearAcceleration::<f64>::FIELDS[0],
    channels: &[rises("flank_wear")],
    regime: "flank_wear",
    confounder: "wear_temperature",
    separating_test: "temperature of a worn and of a new insert in the same cut",
    source: "Postnov & Shafikov, eqs. (6), (7); the square is an assumption",
    processes: &[("turning", Search::Size(1.0)), ("milling", Search::Size(1.0))],
};

impl<N: Number> WearAcceleration<N> {
    pub(crate) fn act(&self, context: &Context<N>, terms: &mut Terms<N>) {
        let ratio = context.flank_wear / self.reference_wear;
        terms.wear_rate *= self.size * ratio * ratio + 1.0;
    }
}
