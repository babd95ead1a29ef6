//! The drives cut corners.

use crate::catalogue::{CatalogueEntry, rises};
use crate::{Context, Search, Terms};
use toolroom_process::{Number, Record, record};

record! {
    /// The drives cut corners: form error `+ size · feed_rate² · path_curvature / (2 Kv²)`, with the
    /// position loop gain Kv.
    ///
    /// # Source
    /// Radial contraction on a circle of a first-order position loop; Koren, Computer Control of Manufacturing Systems (1983).
    pub struct ServoLag {
        /// Share of the contraction that the nominal model leaves out.
        size: Real = 0.0, 0.0..=10.0;
        /// Gain of the position loop, Kv; assumption.
        loop_gain: Real["1/s" => "1/s"] = 30.0, 1.0..=1000.0;
    }
}

pub(crate) const ENTRY: CatalogueEntry = CatalogueEntry {
    id: "servo_lag",
    title: "the drives cut corners",
    size: &ServoLag::<f64>::FIELDS[0],
    channels: &[rises("form_error")],
    regime: "feed_rate² × curvature",
    confounder: "deflection of the cutter",
    separating_test: "mill one circle at half and at full feed rate",
    source: "Koren 1983, first-order position loop; gain is an assumption",
    processes: &[("milling", Search::Size(0.5))],
};

impl<N: Number> ServoLag<N> {
    pub(crate) fn act(&self, context: &Context<N>, terms: &mut Terms<N>) {
        let contraction = context.feed_rate * context.feed_rate * context.path_curvature;
        terms.form_error += self.size * contraction / (self.loop_gain * self.loop_gain * 2.0);
    }
}
