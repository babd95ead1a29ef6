//! A chuck of three jaws is stiffer over a jaw than between two.

use crate::catalogue::{CatalogueEntry, rises};
use crate::{Context, Search, Terms};
use toolroom_process::{Number, Record, record};

record! {
    /// Clamping stiffness `c (1 + size cos 3 theta)` over the angle of the work: three lobes on
    /// the part, and parametric vibration where three times the spindle's frequency is twice the
    /// natural one or equal to it.
    ///
    /// # Source
    /// Zakovorotny, Pham Dinh Tung, Pham Thu Huong, "Parametrical phenomena under on-machine
    /// process control", eq. (1).
    pub struct ChuckStiffness {
        /// Relative amplitude of the stiffness, mu.
        size: Real = 0.0, 0.0..=0.9;
    }
}

pub(crate) const ENTRY: CatalogueEntry = CatalogueEntry {
    id: "chuck_stiffness",
    title: "the chuck is stiffer over a jaw than between two",
    size: &ChuckStiffness::<f64>::FIELDS[0],
    channels: &[rises("vibration_rms")],
    regime: "three times a revolution; speeds of 2/3 and 1/3 of the natural frequency",
    confounder: "regenerative chatter",
    separating_test: "change the speed by 10 %: parametric regions are a few percent wide; clamp in a collet",
    source: "Zakovorotny et al., eq. (1)",
    processes: &[(
        "turning",
        Search::Untried("it makes the cut vibrate; a nominal model of records predicts no vibration"),
    )],
};

impl<N: Number> ChuckStiffness<N> {
    pub(crate) fn act(&self, _context: &Context<N>, terms: &mut Terms<N>) {
        terms.chuck_modulation += self.size;
    }
}
