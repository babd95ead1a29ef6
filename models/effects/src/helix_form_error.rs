//! The helix bends the wall along the axis.

use crate::catalogue::{CatalogueEntry, rises};
use crate::{Context, Search, Terms};
use toolroom_process::{Number, Record, record};

record! {
    /// The helix bends the wall along the axis: form error `+ size · helical_deviation`, the deviation
    /// of the helical profile from its mean at the height that is gauged.
    ///
    /// # Source
    /// Kline, DeVor & Shareef, J. Eng. Ind. 104 (1982) 272: surface error along the axis of a helical cutter.
    pub struct HelixFormError {
        /// Share of the helical profile that the nominal model leaves out.
        size: Real = 0.0, 0.0..=3.0;
    }
}

pub(crate) const ENTRY: CatalogueEntry = CatalogueEntry {
    id: "helix_form_error",
    title: "the helix bends the wall along the axis",
    size: &HelixFormError::<f64>::FIELDS[0],
    channels: &[rises("form_error")],
    regime: "height at which the wall is gauged",
    confounder: "tilted spindle",
    separating_test: "gauge the wall at five heights",
    source: "Kline, DeVor & Shareef 1982",
    processes: &[("milling", Search::Size(0.5))],
};

impl<N: Number> HelixFormError<N> {
    pub(crate) fn act(&self, context: &Context<N>, terms: &mut Terms<N>) {
        terms.form_error += self.size * context.helical_deviation;
    }
}
