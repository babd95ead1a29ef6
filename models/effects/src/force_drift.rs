//! The force reading drifts.

use crate::catalogue::{CatalogueEntry, rises};
use crate::{Context, Search, Terms};
use toolroom_process::{Number, Record, record};

record! {
    /// The force reading drifts: both force channels read `× (1 + size · sensor_time)`, with the time
    /// since the sensor was zeroed. Power does not follow.
    ///
    /// # Source
    /// Assumption: linear in time.
    pub struct ForceDrift {
        /// Share by which the reading grows per time.
        size: Real["1/s" => "1/h"] = 0.0, -1e-3..=1e-3;
    }
}

pub(crate) const ENTRY: CatalogueEntry = CatalogueEntry {
    id: "force_drift",
    title: "the force reading drifts",
    size: &ForceDrift::<f64>::FIELDS[0],
    channels: &[rises("cutting_force"), rises("feed_force")],
    regime: "calendar time",
    confounder: "wear_force",
    separating_test: "re-zero the sensor; compare spindle power, which does not drift",
    source: "assumption: linear in time",
    processes: &[
        ("turning", Search::AtGreatest { quantity: "sensor_time", change: 0.1, most: f64::INFINITY }),
        ("milling", Search::AtGreatest { quantity: "sensor_time", change: 0.1, most: f64::INFINITY }),
    ],
};

impl<N: Number> ForceDrift<N> {
    pub(crate) fn act(&self, context: &Context<N>, terms: &mut Terms<N>) {
        let factor = self.size * context.sensor_time + 1.0;
        terms.force_reading *= factor;
    }
}
