//! The machine grows softer.

use crate::catalogue::{CatalogueEntry, falls, rises};
use crate::{Context, Search, Terms};
use toolroom_process::{Number, Record, record};

record! {
    /// The machine grows softer: system stiffness `× (1 - size · machine_time)`.
    ///
    /// # Source
    /// Assumption: linear in time (bearings, centres warming up).
    pub struct StiffnessDrift {
        /// Share by which the stiffness falls per time.
        size: Real["1/s" => "1/h"] = 0.0, 0.0..=1e-4;
    }
}

pub(crate) const ENTRY: CatalogueEntry = CatalogueEntry {
    id: "stiffness_drift",
    title: "the machine grows softer",
    size: &StiffnessDrift::<f64>::FIELDS[0],
    channels: &[
        falls("normal_force"),
        falls("tangential_force"),
        rises("force_after_spark_out"),
        falls("stock_removed"),
        rises("rise_revolutions"),
    ],
    regime: "calendar time",
    confounder: "wheel_dulling",
    separating_test: "probe the stiffness with the wheel at rest; redress the wheel",
    source: "assumption: linear in time",
    processes: &[("infeed", Search::AtGreatest { quantity: "machine_time", change: 0.1, most: 0.9 })],
};

impl<N: Number> StiffnessDrift<N> {
    pub(crate) fn act(&self, context: &Context<N>, terms: &mut Terms<N>) {
        terms.system_stiffness *= -(self.size * context.machine_time) + 1.0;
    }
}
