//! The flank rubs on the waves that the cut leaves.

use crate::catalogue::{CatalogueEntry, falls};
use crate::{Context, Search, Terms};
use toolroom_process::{Number, Record, record};

record! {
    /// Force against the vibration, `size · width / v_c · x'`, on top of the cut's own: the
    /// flank indents the slopes of the waves. It makes slow cuts stable that a model without it
    /// calls unstable, and changes nothing in a cut that does not vibrate.
    ///
    /// # Source
    /// Form of Altintas, Eynian and Onozuka, CIRP Annals 57 (2008), who measured 6.11e5 N/m in
    /// carbon steel.
    pub struct ProcessDamping {
        /// Indentation coefficient C_i.
        size: Real["N/m" => "N/m"] = 0.0, 0.0..=1e8;
    }
}

pub(crate) const ENTRY: CatalogueEntry = CatalogueEntry {
    id: "process_damping",
    title: "the flank rubs on the waves of the surface",
    size: &ProcessDamping::<f64>::FIELDS[0],
    channels: &[falls("vibration_rms"), falls("roughness_ra")],
    regime: "low cutting speed, worn edge",
    confounder: "damping of the structure",
    separating_test: "slow down: damping by the cut grows, that of the structure stays",
    source: "Altintas, Eynian and Onozuka 2008",
    processes: &[
        (
            "turning",
            Search::Untried("it moves the limit of stability; a nominal model of records predicts no vibration"),
        ),
        (
            "milling",
            Search::Untried("it moves the limit of stability; a nominal model of records predicts no vibration"),
        ),
    ],
};

impl<N: Number> ProcessDamping<N> {
    pub(crate) fn act(&self, _context: &Context<N>, terms: &mut Terms<N>) {
        terms.process_damping += self.size;
    }
}
