//! Another coolant lubricates better or worse.

use crate::catalogue::{CatalogueEntry, falls, rises};
use crate::{Context, Search, Terms};
use toolroom_process::{Number, Record, record};

record! {
    /// Another coolant lubricates better or worse: with it the process stiffness of grinding is
    /// × (1 − size).
    ///
    /// # Source
    /// Assumption: the lubricant acts on the normal force per depth of cut as a whole.
    pub struct CoolantChange {
        /// Share by which the other coolant lowers the process stiffness; below zero it raises it.
        size: Real = 0.0, -5.0..=0.95;
    }
}

pub(crate) const ENTRY: CatalogueEntry = CatalogueEntry {
    id: "coolant_change",
    title: "another coolant lubricates better or worse",
    size: &CoolantChange::<f64>::FIELDS[0],
    channels: &[
        falls("normal_force"),
        falls("tangential_force"),
        falls("force_after_spark_out"),
        falls("rise_revolutions"),
        rises("stock_removed"),
    ],
    regime: "coolant_id",
    confounder: "wheel_dulling, calendar drift",
    separating_test: "both coolants on one day with one freshly dressed wheel",
    source: "assumption: factor on the normal force per depth of cut",
    processes: &[("infeed", Search::CoolantStiffness(0.1))],
};

impl<N: Number> CoolantChange<N> {
    pub(crate) fn act(&self, context: &Context<N>, terms: &mut Terms<N>) {
        terms.process_stiffness *= -(self.size * context.coolant_changed) + 1.0;
    }
}
