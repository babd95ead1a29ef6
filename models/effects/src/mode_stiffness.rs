//! The structure is stiffer or softer than it was tapped.

use crate::catalogue::{BY_CUTS_THAT_CHATTERED, CatalogueEntry, falls};
use crate::{Context, Terms};
use toolroom_process::{Number, Record, record};

record! {
    /// Modal stiffnesses `× (1 + size)` at the same natural frequencies and damping ratios: the depth of the limit goes with this factor
    /// at every speed, lobes and frequencies stay. Static deflection is that of the parameter set and does not change. Cuts alone do not
    /// tell this from `mode_damping` or from a force coefficient that is off.
    ///
    /// # Source
    /// Assumption: one factor for all modes of the machine, tool or workpiece that the scope of the effect names.
    pub struct ModeStiffness {
        /// Relative change, either way; the depth of the limit has the same factor.
        size: Real = 0.0, -0.9..=9.0;
    }
}

pub(crate) const ENTRY: CatalogueEntry = CatalogueEntry {
    id: "mode_stiffness",
    title: "modes are stiffer or softer than they were tapped",
    size: &ModeStiffness::<f64>::FIELDS[0],
    channels: &[falls("vibration_rms"), falls("roughness_ra")],
    regime: "depths near the stability limit, at all speeds",
    confounder: "mode_damping",
    separating_test: "tap the machine: the height of the resonance is stiffness times damping, its width the damping",
    source: "assumption: one factor for all modes",
    processes: &[("turning", BY_CUTS_THAT_CHATTERED), ("milling", BY_CUTS_THAT_CHATTERED)],
};

impl<N: Number> ModeStiffness<N> {
    pub(crate) fn act(&self, _context: &Context<N>, terms: &mut Terms<N>) {
        terms.mode_stiffness *= self.size + 1.0;
    }
}
