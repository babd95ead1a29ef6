//! Hot work material cuts more easily.

use crate::catalogue::{CatalogueEntry, falls};
use crate::{Context, Search, Terms};
use toolroom_process::{Number, Record, record};

record! {
    /// Hot work material cuts more easily: the specific cutting force is
    /// `× (1 - size · temperature_rise / reference_rise)`. The process applies the fall per kelvin to
    /// its own contact temperature.
    ///
    /// # Source
    /// Johnson & Cook (1983) take flow stress as falling with homologous temperature; the linear form
    /// and 500 K are assumptions.
    pub struct ThermalSoftening {
        /// Share by which the specific cutting force has fallen at the reference rise.
        size: Real = 0.0, 0.0..=0.6;
        /// Temperature rise to which the size refers; assumption.
        reference_rise: Real["K" => "K"] = 500.0, 1.0..=2000.0;
    }
}

pub(crate) const ENTRY: CatalogueEntry = CatalogueEntry {
    id: "thermal_softening",
    title: "hot work material cuts more easily",
    size: &ThermalSoftening::<f64>::FIELDS[0],
    channels: &[falls("cutting_force"), falls("feed_force"), falls("spindle_power")],
    regime: "temperature, that is cutting_speed and feed",
    confounder: "the force law's dependence on speed",
    separating_test: "alternate dry and wet at constant speed, three edges",
    source: "Johnson & Cook 1983, structure; linear form is an assumption",
    processes: &[("turning", Search::Size(0.15))],
};

impl<N: Number> ThermalSoftening<N> {
    pub(crate) fn act(&self, _context: &Context<N>, terms: &mut Terms<N>) {
        terms.thermal_softening += self.size / self.reference_rise;
    }
}
