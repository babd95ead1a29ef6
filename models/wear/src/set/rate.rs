//! A whole rate of wear that is another one, in the parameters of a set.

use super::{Origin, ParameterSet};

/// Levels of all wear laws, by group and name, and whether the rate of wear grows with them; a life falls as the rate grows.
const LEVELS: [(&str, &str, bool); 7] = [
    ("energy_balance", "mechanical_wear_per_path", true),
    ("energy_balance", "thermal_wear_rate", true),
    ("takeyama_murata", "abrasive_wear", true),
    ("takeyama_murata", "diffusion_wear_at_reference", true),
    ("usui", "wear_at_reference", true),
    ("extended_taylor", "reference_life", false),
    ("life", "reference_life", false),
];

impl ParameterSet {
    /// Multiplies the rate of wear by `factor` (above 0) under every law whose values the set holds. Returns the keys of the values
    /// of its own law that moved; their sources say `moved`.
    ///
    /// # Examples
    /// ```
    /// use toolroom_wear::{ParameterSet, TURNING_SETS};
    /// let mut set = ParameterSet::load("c45_t15k6", std::path::Path::new("."), &TURNING_SETS)?;
    /// let moved = set.scale_wear_rate(1.25, "measured");
    /// assert_eq!(moved, ["energy_balance.mechanical_wear_per_path", "energy_balance.thermal_wear_rate"]);
    /// # Ok::<(), toolroom_wear::SetError>(())
    /// ```
    pub fn scale_wear_rate(&mut self, factor: f64, moved: &str) -> Vec<String> {
        let mut keys = Vec::new();
        let own = self.values.len();
        for (place, value) in self.values.iter_mut().chain(&mut self.unused).enumerate() {
            let level = LEVELS.iter().find(|(group, name, _)| *group == value.group && *name == value.field.name);
            let Some((_, _, grows)) = level else { continue };
            value.value *= if *grows { factor } else { factor.recip() };
            value.origin = Origin::Given;
            value.source = format!("{}; {moved}", value.source);
            if place < own {
                keys.push(value.key());
            }
        }
        keys
    }
}
