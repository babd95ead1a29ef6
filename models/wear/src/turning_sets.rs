//! Parameter sets of turning: shipped ones, and what a set holds.

use crate::{
    Catalogue, Chipping, Emf, EnergyBalance, ExtendedTaylor, Force, Group, Limits, TakeyamaMurata, Temperature, Usui,
};
use toolroom_process::{Field, Record};

/// Shipped parameter sets: name and file.
pub const PARAMETER_SETS: &[(&str, &str)] = &[
    ("ni_vk6om", include_str!("../../../scenarios/parameters/turning/ni_vk6om.toml")),
    ("ni_vk8", include_str!("../../../scenarios/parameters/turning/ni_vk8.toml")),
    ("ni_vk6om_hb", include_str!("../../../scenarios/parameters/turning/ni_vk6om_hb.toml")),
    ("c45_t15k6", include_str!("../../../scenarios/parameters/turning/c45_t15k6.toml")),
    ("ti_vk6", include_str!("../../../scenarios/parameters/turning/ti_vk6.toml")),
];

const fn group(name: &'static str, fields: &'static [Field]) -> Group {
    Group { name, fields, law: false, assumed: &[] }
}

const fn law(name: &'static str, fields: &'static [Field], assumed: &'static [&'static str]) -> Group {
    Group { name, fields, law: true, assumed }
}

/// Parameter sets of turning: shipped ones, and what a set holds.
pub static TURNING_SETS: Catalogue = Catalogue {
    process: "turning",
    sets: PARAMETER_SETS,
    groups: &[
        group("temperature", Temperature::<f64>::FIELDS),
        law("energy_balance", EnergyBalance::<f64>::FIELDS, &[]),
        law("extended_taylor", ExtendedTaylor::<f64>::FIELDS, &["hardness_exponent", "stage_contrast", "stage_tilt"]),
        law(
            "takeyama_murata",
            TakeyamaMurata::<f64>::FIELDS,
            &["run_in_land", "run_in_offset", "hardness_exponent", "gas_constant"],
        ),
        law("usui", Usui::<f64>::FIELDS, &["hardness_exponent"]),
        group("force", Force::<f64>::FIELDS),
        group("emf", Emf::<f64>::FIELDS),
        group("chipping", Chipping::<f64>::FIELDS),
        group("limits", Limits::<f64>::FIELDS),
    ],
};
