//! Thermal collapse under a law that knows no heat.

use super::{Origin, ParameterValue};

/// Puts the temperature of collapse out of reach where the law of the set knows no heat and the temperatures are those of a set
/// with another law: its tool collapses where that one does, which says nothing of lives that were measured or read from a
/// handbook. What the file itself states stays.
pub(super) fn of_another_law(
    values: &mut [ParameterValue],
    law: Option<&'static str>,
    law_of_base: Option<&'static str>,
) {
    if law != Some(FREE_OF_HEAT) || law_of_base == Some(FREE_OF_HEAT) {
        return;
    }
    let inherited = |value: &&mut ParameterValue| {
        value.field.name == "collapse_temperature" && matches!(value.origin, Origin::Based(_) | Origin::Assumed)
    };
    for value in values.iter_mut().filter(inherited) {
        let source =
            format!("assumption: no edge ends by heat under this law; {} belongs to another tool", value.shown());
        (value.value, value.origin, value.source) = (value.field.max, Origin::Assumed, source);
    }
}

/// The law of lives in which no temperature stands.
const FREE_OF_HEAT: &str = "extended_taylor";
