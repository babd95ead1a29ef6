//! Rows of the catalogues of effects: of processes, of the shop, of empirical responses, and of a user.

use super::{EMPIRICAL_EFFECTS, Frame};
use toolroom_effects::{CatalogueEntry, Effect};
use toolroom_scenario::effects::{PROGRAM_EFFECTS, SHOP_EFFECTS};

/// Row of an id in the catalogues.
pub(crate) fn catalogued(id: &str) -> Option<&'static CatalogueEntry> {
    Effect::CATALOGUE
        .iter()
        .chain(SHOP_EFFECTS)
        .chain(PROGRAM_EFFECTS)
        .chain(EMPIRICAL_EFFECTS)
        .find(|entry| entry.id == id)
}

/// Catalogue row of an id: of the catalogues, or of an effect that a user has defined for the model of `frame`.
pub(crate) fn entry(frame: &Frame, id: &str) -> Option<&'static CatalogueEntry> {
    let own = || frame.defined.iter().map(|own| own.entry()).find(|entry| entry.id == id);
    catalogued(id).or_else(own)
}

/// Factor from SI to the display unit of an effect's size, and the unit.
pub fn report_units(frame: &Frame, id: &str) -> (f64, &'static str) {
    entry(frame, id).map_or((1.0, "1"), |entry| (entry.size.to_display(1.0), entry.size.display))
}
