//! Overheating leaves the tool material weaker.

use crate::catalogue::{CatalogueEntry, rises};
use crate::{Context, Search, Terms};
use toolroom_process::{Number, Record, record};

record! {
    /// Overheating leaves the tool material weaker: mechanical wear × (1 + size · D), D being
    /// the thermal damage that the process carries as a state.
    ///
    /// The rate at which damage builds up (0.5/min at the reference temperature) and the wear
    /// that takes the damaged layer away are parameters of the process, because the memory is.
    ///
    /// # Source
    /// Postnov & Shafikov, inherited damage of equation (6), structure; linear coupling is an
    /// assumption.
    pub struct ThermalHeredity {
        /// Coupling kap_D: share by which fully damaged material wears faster.
        size: Real = 0.0, 0.0..=50.0;
    }
}

pub(crate) const ENTRY: CatalogueEntry = CatalogueEntry {
    id: "thermal_heredity",
    title: "overheating leaves the tool material weaker",
    size: &ThermalHeredity::<f64>::FIELDS[0],
    channels: &[rises("flank_wear")],
    regime: "after hot cuts",
    confounder: "wear_acceleration",
    separating_test: "the same cut after a hot and after a cool cut, at equal flank wear",
    source: "Postnov & Shafikov, eq. (6), structure; linear coupling is an assumption",
    processes: &[("turning", Search::Size(1.0))],
};

impl<N: Number> ThermalHeredity<N> {
    pub(crate) fn act(&self, _context: &Context<N>, terms: &mut Terms<N>) {
        terms.thermal_damage_coupling += self.size;
    }
}
