//! Rows of the catalogues of effects: of processes, of the shop and of empirical responses.

use super::EMPIRICAL_EFFECTS;
use toolroom_effects::{CatalogueEntry, Effect};
use toolroom_scenario::effects::SHOP_EFFECTS;

/// Catalogue row of an id.
pub(crate) fn entry(id: &str) -> Option<&'static CatalogueEntry> {
    Effect::CATALOGUE.iter().chain(SHOP_EFFECTS).chain(EMPIRICAL_EFFECTS).find(|entry| entry.id == id)
}

/// Factor from SI to the display unit of an effect's size, and the unit.
pub fn report_units(id: &str) -> (f64, &'static str) {
    entry(id).map_or((1.0, "1"), |entry| (entry.size.to_display(1.0), entry.size.display))
}
