//! The spindle drive loses power.

use crate::catalogue::{CatalogueEntry, rises};
use crate::{Context, Search, Terms};
use toolroom_process::{Number, Record, record};

record! {
    /// The spindle drive loses power: it takes `+ size · (cutting_speed / reference_speed)²` beside the
    /// cut.
    ///
    /// # Source
    /// Viscous loss of bearings and drive, in proportion to the square of speed; assumption.
    pub struct SpindleLoss {
        /// Power lost at the reference speed.
        size: Real["W" => "kW"] = 0.0, 0.0..=1e5;
        /// Cutting speed to which the size refers; assumption.
        reference_speed: Real["m/s" => "m/min"] = 200.0 / 60.0, 0.01..=50.0;
    }
}

pub(crate) const ENTRY: CatalogueEntry = CatalogueEntry {
    id: "spindle_loss",
    title: "the spindle drive loses power",
    size: &SpindleLoss::<f64>::FIELDS[0],
    channels: &[rises("spindle_power")],
    regime: "cutting_speed",
    confounder: "efficiency of the drive",
    separating_test: "run the spindle in air at the speeds of the programme",
    source: "assumption: square of speed",
    processes: &[
        ("turning", Search::ShareOfMedian { column: "spindle_power", share: 0.1 }),
        ("milling", Search::ShareOfMedian { column: "spindle_power", share: 0.1 }),
    ],
};

impl<N: Number> SpindleLoss<N> {
    pub(crate) fn act(&self, context: &Context<N>, terms: &mut Terms<N>) {
        let ratio = context.cutting_speed / self.reference_speed;
        terms.spindle_loss += self.size * ratio * ratio;
    }
}
