//! Constants of the machine, the wheel and the work.

use toolroom_form::{UnknownSet, shipped_set};
use toolroom_process::parameters::{ParameterError, ParameterFile};
use toolroom_process::{Number, record};

/// Shipped parameter sets: name and file.
pub const PARAMETER_SETS: &[(&str, &str)] =
    &[("zb153u_40kh", include_str!("../../../scenarios/parameters/infeed/zb153u_40kh.toml"))];

/// Fields that a set may leave out: name, value, what that value means.
const LATER: &[(&str, f64, &str)] = &[
    ("internal", 0.0, "outside where not given"),
    ("force_exponent", 1.0, "force in proportion to depth where not given"),
];

record! {
    /// Machine, wheel and work of plunge grinding.
    ///
    /// | symbol | field |
    /// |---|---|
    /// | Cp | `process_stiffness` |
    /// | J | `system_stiffness` |
    /// | F0 | `threshold_force` |
    /// | 1/G | `wheel_wear_ratio` |
    /// | μ | `friction` |
    /// | d_s, d_w, b | `wheel_diameter`, `work_diameter`, `width` |
    /// | v_s | `wheel_speed` |
    /// | k, ρ, c | `conductivity`, `density`, `heat_capacity` |
    /// | u_ch | `chip_formation_energy` |
    /// | 1/V0 | `dulling_rate` |
    /// | m | `force_exponent` |
    ///
    /// The normal force is `F_n = F0 + Cp h0 (h/h0)^m` at the depth h, `h0 = 1 um`; for m = 1 it is `F0 + Cp h`. An
    /// exponent below one is the size effect: thin chips take more force per depth.
    ///
    /// Wheel wear and dulling are given by their inverses, so that zero means none.
    pub struct Parameters {
        /// Normal force per depth of cut; with a force exponent other than 1 at a depth of 1 um.
        process_stiffness: Real["N/m" => "N/um"] = 38.3747e6, 1e4..=1e10;
        /// Exponent of the normal force in the depth of cut; 1 is force in proportion to depth.
        force_exponent: Real = 1.0, 0.5..=1.0;
        /// Stiffness of wheel head, work and supports in series.
        system_stiffness: Real["N/m" => "N/um"] = 31.019e6, 1e4..=1e11;
        /// Normal force below which the wheel rubs without cutting.
        threshold_force: Real["N" => "N"] = 0.0, 0.0..=1e5;
        /// Wheel volume worn per work volume ground, the inverse of the grinding ratio G.
        wheel_wear_ratio: Real = 0.0, 0.0..=10.0;
        /// Force ratio F_t/F_n.
        friction: Real = 0.4706, 0.01..=2.0;
        /// Wheel diameter.
        wheel_diameter: Real["m" => "mm"] = 0.4, 1e-3..=3.0;
        /// Work diameter.
        work_diameter: Real["m" => "mm"] = 0.05, 1e-4..=5.0;
        /// 1 where the wheel grinds a bore of the work diameter, which must exceed its own; 0 outside.
        internal: Real = 0.0, 0.0..=1.0;
        /// Ground width.
        width: Real["m" => "mm"] = 0.02, 1e-4..=2.0;
        /// Peripheral speed of the wheel.
        wheel_speed: Real["m/s" => "m/s"] = 35.0, 0.1..=500.0;
        /// Heat conductivity of the work.
        conductivity: Real["W/m K" => "W/m K"] = 42.0, 0.1..=1000.0;
        /// Density of the work.
        density: Real["kg/m3" => "kg/m3"] = 7850.0, 100.0..=30000.0;
        /// Specific heat of the work.
        heat_capacity: Real["J/kg K" => "J/kg K"] = 470.0, 10.0..=10000.0;
        /// Energy that forms the chips, per volume.
        chip_formation_energy: Real["J/m3" => "J/mm3"] = 13.8e9, 0.0..=1e12;
        /// Share of the chip formation energy that leaves with the chips.
        chip_heat_share: Real = 0.45, 0.0..=1.0;
        /// Ambient temperature.
        ambient_temperature: Real["K" => "K"] = 293.15, 200.0..=400.0;
        /// Temperature rise at which the surface burns.
        burn_temperature_rise: Real["K" => "K"] = 650.0, 10.0..=3000.0;
        /// Relative growth of the process stiffness per volume removed per width, 1/V0.
        dulling_rate: Real["1/m2" => "mm/mm3"] = 0.0, 0.0..=1e6;
        /// Volume removed per width at which the wheel must be dressed.
        dressing_limit: Real["m2" => "mm3/mm"] = 0.72e-3, 1e-9..=1e4;
    }
}

/// Why a parameter set was not loaded.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SetError {
    /// No shipped set has this name.
    #[error(transparent)]
    Unknown(#[from] UnknownSet),
    /// A group that plunge grinding does not have.
    #[error("unknown group [parameters.{group}]; plunge grinding has [parameters.infeed]")]
    UnknownGroup {
        /// What was read.
        group: String,
    },
    /// A faulty entry.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
}

impl<N: Number> Parameters<N> {
    /// Equivalent diameter of wheel and work, m: `d_w d_s/(d_w + d_s)`, in a bore `d_w d_s/(d_w − d_s)`.
    ///
    /// ```
    /// use toolroom_infeed::Parameters;
    /// let bore = Parameters { wheel_diameter: 0.04, internal: 1.0, ..Parameters::default() };
    /// assert!((bore.equivalent_diameter() - 0.2).abs() < 1e-12);
    /// ```
    pub fn equivalent_diameter(&self) -> N {
        let (work, wheel) = (self.work_diameter, self.wheel_diameter);
        let sum = if self.internal.re() >= 0.5 { work - wheel } else { work + wheel };
        work * wheel / sum
    }
}

impl Parameters {
    /// A shipped set.
    ///
    /// # Errors
    /// [`SetError::Unknown`] with the nearest name.
    ///
    /// ```
    /// use toolroom_infeed::Parameters;
    /// assert_eq!(Parameters::named("zb153u_40kh").unwrap().width, 0.02);
    /// ```
    pub fn named(name: &str) -> Result<Self, SetError> {
        Self::read(shipped_set("plunge grinding", PARAMETER_SETS, name)?)
    }

    /// Reads a parameter file with the group `[parameters.infeed]`.
    ///
    /// # Errors
    /// [`SetError`], with the line where the file is at fault.
    pub fn read(text: &str) -> Result<Self, SetError> {
        let file = ParameterFile::read(text)?;
        if let Some(group) = file.groups.keys().find(|group| *group != "infeed") {
            return Err(SetError::UnknownGroup { group: group.clone() });
        }
        let mut parameters = Self::default();
        // Sets from before a field was known do not give it.
        let group = file.groups.get("infeed");
        let lacks = |name: &str| group.is_some_and(|group| !group.contains_key(name));
        let added: String = LATER
            .iter()
            .filter(|(name, ..)| lacks(name))
            .map(|(name, value, source)| {
                format!("\n[parameters.infeed.{name}]\nvalue = {value:?}\nsource = \"{source}\"\n")
            })
            .collect();
        if !added.is_empty() {
            let whole = format!("{text}{added}");
            ParameterFile::read(&whole)?.fill(&whole, "infeed", &mut parameters)?;
            return Ok(parameters);
        }
        file.fill(text, "infeed", &mut parameters)?;
        Ok(parameters)
    }
}
