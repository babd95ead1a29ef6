//! Effects of empirical responses: catalogue rows beside those of the processes and of the shop.

use toolroom_effects::{CatalogueEntry, Search, Sign, Touched};
use toolroom_process::{Record, record};

record! {
    /// Sizes of the effects of empirical responses.
    pub struct EmpiricalSizes {
        /// Exponent of the condition that the nominal response does not know.
        condition_response: Real = 0.0, 0.0..=10.0;
    }
}

/// Effects of empirical responses beside those of processes and shop.
pub const EMPIRICAL_EFFECTS: &[CatalogueEntry] = &[CatalogueEntry {
    id: "condition_response",
    title: "a channel responds to a recorded condition that the model leaves out",
    size: &EmpiricalSizes::<f64>::FIELDS[0],
    channels: &[
        Touched { channel: "flank_wear", sign: Sign::Rises },
        Touched { channel: "cutting_force", sign: Sign::Rises },
        Touched { channel: "feed_force", sign: Sign::Rises },
        Touched { channel: "spindle_power", sign: Sign::Rises },
    ],
    regime: "the condition",
    confounder: "lot_hardness",
    separating_test: "vary the condition on one edge and one lot",
    source: "power law of the response, as in handbooks",
    processes: &[("empirical", Search::Shaped)],
}];
