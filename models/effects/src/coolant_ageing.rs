//! Old coolant cools less.

use crate::catalogue::{CatalogueEntry, rises};
use crate::{Context, Search, Terms};
use toolroom_process::{Number, Record, record};

record! {
    /// Old coolant cools less: `temperature_rise × (1 + size · coolant_age)`.
    ///
    /// # Source
    /// Assumption: linear in age.
    pub struct CoolantAgeing {
        /// Share by which the temperature rise grows per time of coolant age.
        size: Real["1/s" => "1/h"] = 0.0, 0.0..=1e-3;
    }
}

pub(crate) const ENTRY: CatalogueEntry = CatalogueEntry {
    id: "coolant_ageing",
    title: "old coolant cools less",
    size: &CoolantAgeing::<f64>::FIELDS[0],
    channels: &[rises("temperature"), rises("thermo_emf"), rises("flank_wear")],
    regime: "coolant_age",
    confounder: "calendar drift, lot",
    separating_test: "old and fresh coolant on one day",
    source: "assumption: linear in age",
    processes: &[
        ("turning", Search::AtGreatest { quantity: "coolant_age", change: 0.1, most: f64::INFINITY }),
        ("infeed", Search::Untried("it warms the contact, and records of grinding hold no temperature")),
    ],
};

impl<N: Number> CoolantAgeing<N> {
    pub(crate) fn act(&self, context: &Context<N>, terms: &mut Terms<N>) {
        terms.temperature_rise *= self.size * context.coolant_age + 1.0;
    }
}
