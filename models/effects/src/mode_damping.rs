//! The structure damps more or less than it was tapped.

use crate::catalogue::{CatalogueEntry, falls};
use crate::{Context, Search, Terms};
use toolroom_process::{Number, Record, record};

record! {
    /// Damping ratios `× (1 + size)`: a collet that has come loose damps, a joint that was tightened does not. The depth of the
    /// limit between lobes goes nearly with damping times stiffness, so that cuts alone do not tell this from `mode_stiffness` or
    /// from a force coefficient that is off.
    ///
    /// # Source
    /// Assumption: one factor for all modes of the machine, tool or workpiece that the scope of the effect names.
    pub struct ModeDamping {
        /// Relative change, either way; a ratio above 0.99 counts as 0.99.
        size: Real = 0.0, -0.9..=9.0;
    }
}

/// Who looks for it in the place of a search of its own.
const BY_STIFFNESS: Search = Search::Untried(
    "`dynamics_drift` asks for the stiffness, from which cuts that chattered do not tell the damping; no other channel of a cut reads it",
);

pub(crate) const ENTRY: CatalogueEntry = CatalogueEntry {
    id: "mode_damping",
    title: "damping ratios are not those that were tapped",
    size: &ModeDamping::<f64>::FIELDS[0],
    channels: &[falls("vibration_rms"), falls("roughness_ra")],
    regime: "depths near the stability limit, at all speeds",
    confounder: "mode_stiffness",
    separating_test: "tap the machine: the width of the resonance is the damping; the force of a cut is the coefficient",
    source: "assumption: one factor for all modes",
    processes: &[("turning", BY_STIFFNESS), ("milling", BY_STIFFNESS)],
};

impl<N: Number> ModeDamping<N> {
    pub(crate) fn act(&self, _context: &Context<N>, terms: &mut Terms<N>) {
        terms.mode_damping *= self.size + 1.0;
    }
}
