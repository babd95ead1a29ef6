//! Shipped cutters.

use super::{Cutter, CutterLife, EdgeForce, Milling};
use std::path::Path;
use toolroom_process::{Field, Record};
use toolroom_wear::{Catalogue, Chipping, Group, ParameterSet, SetError, TURNING_SETS, check_tilt};

/// Shipped milling parameter sets: name and file.
pub const MILLING_SETS: &[(&str, &str)] = &[
    ("c45_endmill_d12", include_str!("../../../../scenarios/parameters/milling/c45_endmill_d12.toml")),
    ("mill_t15k6_d32", include_str!("../../../../scenarios/parameters/milling/mill_t15k6_d32.toml")),
];

const fn group(name: &'static str, fields: &'static [Field], assumed: &'static [&'static str]) -> Group {
    Group { name, fields, law: false, assumed }
}

/// Parameter sets of milling: shipped ones, and what a set holds.
pub static MILLING_CATALOGUE: Catalogue = Catalogue {
    process: "milling",
    sets: MILLING_SETS,
    groups: &[
        group("cutter", Cutter::<f64>::FIELDS, &[]),
        group("force", EdgeForce::<f64>::FIELDS, &[]),
        group("life", CutterLife::<f64>::FIELDS, &["stage_tilt"]),
        group("chipping", Chipping::<f64>::FIELDS, &[]),
    ],
};

/// The process of the shipped set of this name, `turning` or `milling`; `None` where there is none. Who looks for a set of
/// one process and finds none may have named one of the other.
///
/// ```
/// assert_eq!(toolroom_cutting::process_of_set("c45_endmill_d12"), Some("milling"));
/// assert_eq!(toolroom_cutting::process_of_set("c45_endmill"), None);
/// ```
pub fn process_of_set(name: &str) -> Option<&'static str> {
    let has = |catalogue: &&&Catalogue| catalogue.sets.iter().any(|(known, _)| *known == name);
    [&TURNING_SETS, &MILLING_CATALOGUE].iter().find(has).map(|catalogue| catalogue.process)
}

impl Milling {
    /// Milling with a shipped parameter set and no effects.
    ///
    /// # Errors
    /// [`SetError::Unknown`] with the nearest name.
    ///
    /// # Examples
    /// ```
    /// use toolroom_cutting::Milling;
    /// assert_eq!(Milling::named("mill_t15k6_d32").unwrap().cutter.diameter, 0.032);
    /// assert!(Milling::named("c45_endmill_d10").unwrap_err().to_string().contains("did you mean `c45_endmill_d12`"));
    /// ```
    pub fn named(set: &str) -> Result<Self, SetError> {
        Self::load(set, Path::new(""))
    }

    /// Milling with the set of a shipped name, or of a parameter set file whose path counts from `folder`.
    ///
    /// # Errors
    /// [`SetError`].
    pub fn load(reference: &str, folder: &Path) -> Result<Self, SetError> {
        let set = ParameterSet::load(reference, folder, &MILLING_CATALOGUE);
        Self::of_set(&set.map_err(|error| error.told_apart("milling", process_of_set))?)
    }

    /// Reads the text of a parameter set.
    ///
    /// # Errors
    /// [`SetError`], with the lines where the text is at fault.
    pub fn read(text: &str) -> Result<Self, SetError> {
        Self::of_set(&ParameterSet::parse("the parameter set", text, &MILLING_CATALOGUE)?)
    }

    /// Milling as a parameter set describes it, with no effects.
    ///
    /// # Errors
    /// [`SetError::Model`] where values contradict each other.
    pub fn of_set(set: &ParameterSet) -> Result<Self, SetError> {
        let mut milling = Self::default();
        set.fill("cutter", &mut milling.cutter);
        set.fill("force", &mut milling.force);
        set.fill("life", &mut milling.life);
        set.fill("chipping", &mut milling.chipping);
        check_tilt(milling.life.stage_contrast, milling.life.stage_tilt)?;
        Ok(milling)
    }
}
