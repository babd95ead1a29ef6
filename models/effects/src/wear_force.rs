//! Forces grow with flank wear.

use crate::catalogue::{CatalogueEntry, rises};
use crate::{Context, Search, Terms};
use toolroom_process::{Number, Record, record};

record! {
    /// Forces grow with the flank wear land: `cutting_force × (1 + size · VB / reference_wear)`.
    ///
    /// The worn land presses and rubs. The feed force, which carries the land's normal
    /// pressure, may grow `feed_force_ratio` times as fast.
    ///
    /// # Source
    /// Proportionality: measured in turning, for example F_c = 510 N + 446 N/mm VB (R² = 0.84)
    /// and F_f = 243 N + 1507 N/mm VB (R² = 0.88) over 13 tools of the Vicomtech set (CC BY-SA
    /// 4.0), which is size 0.26 and feed_force_ratio 7.1.
    pub struct WearForce {
        /// Share by which the cutting force has grown at the reference wear.
        size: Real = 0.0, 0.0..=20.0;
        /// Wear to which the size refers; ISO 3685 wear limit.
        reference_wear: Real["m" => "mm"] = 0.3e-3, 1e-6..=5e-3;
        /// Relative growth of the feed force over that of the cutting force; assumption.
        feed_force_ratio: Real = 1.0, 0.0..=50.0;
    }
}

pub(crate) const ENTRY: CatalogueEntry = CatalogueEntry {
    id: "wear_force",
    title: "forces grow with flank wear",
    size: &WearForce::<f64>::FIELDS[0],
    channels: &[rises("cutting_force"), rises("feed_force"), rises("spindle_power"), rises("vibration_rms")],
    regime: "flank_wear",
    confounder: "force_drift",
    separating_test: "change the edge: wear starts anew, a drifting sensor does not; compare spindle power",
    source: "Vicomtech turning set: 13 tools, forces linear in flank wear",
    processes: &[("turning", Search::Size(0.2)), ("milling", Search::Size(0.2))],
};

impl<N: Number> WearForce<N> {
    pub(crate) fn act(&self, context: &Context<N>, terms: &mut Terms<N>) {
        let rise = self.size * (context.flank_wear / self.reference_wear);
        terms.cutting_force *= rise + 1.0;
        terms.feed_force *= rise * self.feed_force_ratio + 1.0;
    }
}
