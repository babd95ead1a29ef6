//! The grinding wheel dulls between dressings.

use crate::catalogue::{CatalogueEntry, falls, rises};
use crate::{Context, Search, Terms};
use toolroom_process::{Number, Record, record};

record! {
    /// The grinding wheel dulls: `process_stiffness × (1 + size · V' / reference_volume)` with
    /// V' the volume removed per wheel width since dressing.
    ///
    /// # Source
    /// Assumption: flats grow in proportion to the material removed.
    pub struct WheelDulling {
        /// Share by which the process stiffness has grown at the reference volume.
        size: Real = 0.0, 0.0..=20.0;
        /// Removed volume per width to which the size refers; assumption.
        reference_volume: Real["m2" => "mm3/mm"] = 1.5e-3, 1e-6..=1.0;
    }
}

pub(crate) const ENTRY: CatalogueEntry = CatalogueEntry {
    id: "wheel_dulling",
    title: "the grinding wheel dulls between dressings",
    size: &WheelDulling::<f64>::FIELDS[0],
    channels: &[
        rises("normal_force"),
        rises("tangential_force"),
        rises("force_after_spark_out"),
        rises("rise_revolutions"),
        falls("stock_removed"),
    ],
    regime: "volume removed since dressing, part_in_cycle",
    confounder: "stiffness_drift",
    separating_test: "redress: the force falls back, a softer machine does not harden",
    source: "assumption: linear in removed volume, 1500 mm3/mm",
    processes: &[("infeed", Search::Size(0.3))],
};

impl<N: Number> WheelDulling<N> {
    pub(crate) fn act(&self, context: &Context<N>, terms: &mut Terms<N>) {
        terms.process_stiffness *= self.size * (context.removed_volume / self.reference_volume) + 1.0;
    }
}
