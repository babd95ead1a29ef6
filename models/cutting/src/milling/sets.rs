//! Shipped cutters.

use super::Milling;
use toolroom_process::parameters::ParameterFile;
use toolroom_wear::PairError;

/// Shipped milling parameter sets: name and file.
pub const MILLING_SETS: &[(&str, &str)] = &[
    ("c45_endmill_d12", include_str!("../../../../scenarios/parameters/milling/c45_endmill_d12.toml")),
    ("mill_t15k6_d32", include_str!("../../../../scenarios/parameters/milling/mill_t15k6_d32.toml")),
];

/// Groups of a milling parameter file.
const GROUPS: [&str; 4] = ["cutter", "force", "life", "chipping"];

impl Milling {
    /// Milling with a shipped parameter set and no effects.
    ///
    /// # Errors
    /// [`PairError::UnknownSet`] with the nearest name.
    ///
    /// # Examples
    /// ```
    /// use toolroom_cutting::Milling;
    /// assert_eq!(Milling::named("mill_t15k6_d32").unwrap().cutter.diameter, 0.032);
    /// assert!(Milling::named("c45").unwrap_err().to_string().contains("did you mean `c45_endmill_d12`"));
    /// ```
    pub fn named(set: &str) -> Result<Self, PairError> {
        match MILLING_SETS.iter().find(|(known, _)| *known == set) {
            Some((_, text)) => Self::read(text),
            None => {
                let known: Vec<&str> = MILLING_SETS.iter().map(|(known, _)| *known).collect();
                Err(PairError::UnknownSet {
                    name: set.to_owned(),
                    nearest: nearest(set, &known),
                    known: known.join(", "),
                })
            }
        }
    }

    /// Reads a parameter file.
    ///
    /// # Errors
    /// [`PairError`], with the line where the file is at fault.
    pub fn read(text: &str) -> Result<Self, PairError> {
        let file = ParameterFile::read(text)?;
        if let Some(group) = file.groups.keys().find(|group| !GROUPS.contains(&group.as_str())) {
            return Err(PairError::UnknownGroup { group: group.clone(), nearest: nearest(group, &GROUPS) });
        }
        let mut milling = Self::default();
        file.fill(text, "cutter", &mut milling.cutter)?;
        file.fill(text, "force", &mut milling.force)?;
        file.fill_beside(text, "life", &mut milling.life, &["stage_tilt"])?;
        toolroom_wear::check_tilt(milling.life.stage_contrast, milling.life.stage_tilt)?;
        file.fill(text, "chipping", &mut milling.chipping)?;
        Ok(milling)
    }
}

fn nearest(name: &str, known: &[&'static str]) -> &'static str {
    let likeness = |each: &str| strsim::jaro_winkler(each, name);
    known.iter().max_by(|a, b| likeness(a).total_cmp(&likeness(b))).copied().unwrap_or_default()
}
