//! The structure vibrates faster or slower than it was tapped.

use crate::catalogue::{BY_CUTS_THAT_CHATTERED, CatalogueEntry, rises};
use crate::{Context, Terms};
use toolroom_process::{Number, Record, record};

record! {
    /// Natural frequencies `× (1 + size)` at the same stiffness and damping ratio, as a warm spindle or another mounting has them:
    /// stability lobes move along the spindle speed by the same share, and so does the frequency of chatter. Depths of the limit
    /// stay. Where the modal masses stay and the stiffness changes, `mode_stiffness` goes with the square of this factor.
    ///
    /// # Source
    /// Assumption: one factor for all modes of the machine, tool or workpiece that the scope of the effect names.
    pub struct ModeFrequency {
        /// Relative change, either way; the frequencies are factors 0.5 to 2 of those of the structure.
        size: Real = 0.0, -0.5..=1.0;
    }
}

pub(crate) const ENTRY: CatalogueEntry = CatalogueEntry {
    id: "mode_frequency",
    title: "natural frequencies are not those that were tapped",
    size: &ModeFrequency::<f64>::FIELDS[0],
    channels: &[rises("dominant_frequency")],
    regime: "cuts near a lobe: which spindle speeds chatter",
    confounder: "mode_stiffness",
    separating_test: "read the frequency of chatter, or tap the machine warm; one speed alone does not tell it from a softer structure",
    source: "assumption: one factor for all modes",
    processes: &[("turning", BY_CUTS_THAT_CHATTERED), ("milling", BY_CUTS_THAT_CHATTERED)],
};

impl<N: Number> ModeFrequency<N> {
    pub(crate) fn act(&self, _context: &Context<N>, terms: &mut Terms<N>) {
        terms.mode_frequency *= self.size + 1.0;
    }
}
