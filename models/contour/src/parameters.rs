//! Constants of machine, cutter, force, life and money; shipped sets.

use crate::{EdgeForce, MillLife};
use std::f64::consts::{PI, TAU};
use toolroom_form::{UnknownSet, shipped_set};
use toolroom_process::parameters::{ParameterError, ParameterFile};
use toolroom_process::{AnyRecord, record};

/// Shipped parameter sets: name and file.
pub const PARAMETER_SETS: &[(&str, &str)] =
    &[("mill_t15k6_d32", include_str!("../../../scenarios/parameters/contour/mill_t15k6_d32.toml"))];

record! {
    /// Milling machine with feed drives. Defaults: a knee-type machine of the 6R13F3 class,
    /// typical numbers (assumption).
    pub struct Machine {
        /// Lowest spindle speed of the gear series.
        lowest_spindle_speed: Real["rad/s" => "rpm"] = 40.0 / 60.0 * TAU, 1e-3..=1e5;
        /// Highest spindle speed of the gear series.
        highest_spindle_speed: Real["rad/s" => "rpm"] = 2000.0 / 60.0 * TAU, 1e-3..=1e5;
        /// Speeds a decade: 5, 10 or 20, the preferred numbers R5, R10, R20 of ISO 3.
        speeds_per_decade: Integer = 10.0, 5.0..=20.0;
        /// Lowest path feed, V_min.
        lowest_feed: Real["m/s" => "mm/min"] = 60.0 / 60e3, 1e-9..=10.0;
        /// Highest path feed, V_max.
        highest_feed: Real["m/s" => "mm/min"] = 1120.0 / 60e3, 1e-9..=10.0;
        /// Power of the spindle motor, N_дв.
        power: Real["W" => "kW"] = 7.5e3, 1.0..=1e6;
        /// Efficiency of the spindle drive, η.
        efficiency: Real = 0.8, 0.01..=1.0;
        /// Greatest force of the feed mechanism, Q.
        feed_force: Real["N" => "N"] = 10e3, 1.0..=1e7;
        /// Position gain of the feed drives, K_v.
        position_gain: Real["1/s" => "1/s"] = 16.667, 0.1..=1e4;
        /// Greatest acceleration along the path.
        highest_acceleration: Real["m/s2" => "m/s2"] = 0.5, 1e-3..=1e3;
        /// Heaviest moving mass.
        moving_mass: Real["kg" => "kg"] = 300.0, 0.1..=1e6;
        /// Stiffness of machine between table and spindle.
        structural_stiffness: Real["N/m" => "N/um"] = 200e6, 1e4..=1e12;
        /// Time lost by a change of spindle speed, τ.
        speed_change_time: Real["s" => "s"] = 2.0, 0.0..=1e4;
    }
}

/// R20 of ISO 3: preferred numbers from 1 to 10.
const R20: [f64; 20] = [
    1.00, 1.12, 1.25, 1.40, 1.60, 1.80, 2.00, 2.24, 2.50, 2.80, 3.15, 3.55, 4.00, 4.50, 5.00, 5.60, 6.30, 7.10, 8.00,
    9.00,
];

impl Machine {
    /// Spindle speeds, rad/s, ascending: the preferred numbers in rpm from lowest to highest.
    ///
    /// # Examples
    /// ```
    /// let speeds = toolroom_contour::Machine::default().spindle_speeds();
    /// assert_eq!(speeds.len(), 18);
    /// assert!((speeds[14] * 60.0 / std::f64::consts::TAU - 1000.0).abs() < 1e-9);
    /// ```
    pub fn spindle_speeds(&self) -> Vec<f64> {
        let rpm = 60.0 / TAU;
        let every = (20.0 / self.speeds_per_decade.clamp(5.0, 20.0)).floor() as usize;
        let (low, high) = (self.lowest_spindle_speed * rpm, self.highest_spindle_speed * rpm);
        let decades = low.log10().floor() as i32..=high.log10().floor() as i32;
        (decades.flat_map(|decade| R20.iter().step_by(every).map(move |number| number * 10f64.powi(decade))))
            // Limits read from a file carry rounding of the conversion.
            .filter(|speed| *speed >= low * (1.0 - 1e-9) && *speed <= high * (1.0 + 1e-9))
            .map(|speed| speed / rpm)
            .collect()
    }
}

record! {
    /// End mill with its strength and stiffness. Defaults are the set `mill_t15k6_d32`;
    /// strengths, roughness floor and chip packing are assumptions.
    pub struct Cutter {
        /// Diameter, D.
        diameter: Real["m" => "mm"] = 32e-3, 1e-4..=1.0;
        /// Number of teeth, z.
        teeth: Integer = 4.0, 1.0..=50.0;
        /// Overhang from the holder, l.
        overhang: Real["m" => "mm"] = 75e-3, 1e-4..=1.0;
        /// Helix angle, ω.
        helix: Real["rad" => "deg"] = 35.0 * PI / 180.0, 0.0..=1.4;
        /// Elastic modulus of the shank.
        elastic_modulus: Real["Pa" => "GPa"] = 2.1e11, 1e9..=1e12;
        /// Diameter that bends over the nominal one (Kops & Vo, recalled).
        bending_diameter_ratio: Real = 0.8, 0.1..=1.0;
        /// Stiffness of holder and spindle.
        holder_stiffness: Real["N/m" => "N/um"] = 25e6, 1e4..=1e12;
        /// Height of a tooth, h_з.
        tooth_height: Real["m" => "mm"] = 5e-3, 1e-5..=0.1;
        /// Thickness of a tooth at its root, b_з.
        tooth_thickness: Real["m" => "mm"] = 4.5e-3, 1e-5..=0.1;
        /// Admissible bending stress of a tooth.
        tooth_strength: Real["Pa" => "MPa"] = 500e6, 1e6..=1e10;
        /// Admissible equivalent stress of the body.
        body_strength: Real["Pa" => "MPa"] = 350e6, 1e6..=1e10;
        /// Section modulus over cutter radius cubed (eq. (4к): a core of 0.64 D).
        section_modulus_ratio: Real = 0.208, 0.01..=0.8;
        /// Volume of loose chips over that of the material.
        chip_packing: Real = 6.0, 1.0..=50.0;
        /// Share of D² that the chips of a tooth may fill (eq. (4л)).
        chip_space_ratio: Real = 0.04, 1e-3..=1.0;
        /// Roughness Rz at vanishing feed.
        roughness_floor: Real["m" => "um"] = 3e-6, 0.0..=1e-3;
    }
}

impl Cutter {
    /// R_f, m.
    pub fn radius(&self) -> f64 {
        0.5 * self.diameter
    }

    /// Stiffness of the tool tip, N/m: shank `3·E·π·(bending_diameter)⁴/64/overhang³` in series
    /// with holder and spindle.
    ///
    /// # Examples
    /// ```
    /// let stiffness = toolroom_contour::Cutter::default().stiffness();
    /// assert!((stiffness / 13.9349e6 - 1.0).abs() < 1e-5);
    /// ```
    pub fn stiffness(&self) -> f64 {
        1.0 / (1.0 / self.shank_stiffness() + 1.0 / self.holder_stiffness)
    }

    /// Stiffness of the shank alone, N/m.
    pub fn shank_stiffness(&self) -> f64 {
        let bending_diameter = self.bending_diameter_ratio * self.diameter;
        3.0 * self.elastic_modulus * PI * bending_diameter.powi(4) / 64.0 / self.overhang.powi(3)
    }

    /// Angle by which the edge lags per height, `tan(helix)/radius`, rad/m.
    pub fn helix_lag(&self) -> f64 {
        self.helix.tan() / self.radius()
    }
}

record! {
    /// What time and edges cost; the currency is the reader's, EUR by name.
    pub struct Economics {
        /// Rate of machine and operator, c_min.
        machine_rate: Real["EUR/s" => "EUR/h"] = 30.0 / 3600.0, 1e-6..=10.0;
        /// Time of an edge change, t_ch.
        edge_change_time: Real["s" => "min"] = 300.0, 0.0..=1e5;
        /// Cost of an edge life, c_tool.
        edge_cost: Real["EUR" => "EUR"] = 8.0, 0.0..=1e6;
    }
}

impl Economics {
    /// Cost of using an edge up: its price and the time of its change.
    pub fn edge_price(&self) -> f64 {
        self.machine_rate * self.edge_change_time + self.edge_cost
    }
}

/// A parameter set.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameters {
    /// Name by which contour files call it.
    pub name: String,
    /// One line for people.
    pub title: String,
    /// Machine.
    pub machine: Machine,
    /// Cutter.
    pub cutter: Cutter,
    /// Force coefficients.
    pub force: EdgeForce,
    /// Tool life.
    pub life: MillLife,
    /// Money.
    pub economics: Economics,
}

impl Default for Parameters {
    /// The record defaults, which are the set `mill_t15k6_d32`.
    fn default() -> Self {
        Self {
            name: "mill_t15k6_d32".to_owned(),
            title: "Steel 45, T15K6 end mill of 32 mm with 4 teeth, 7.5 kW machine".to_owned(),
            machine: Machine::default(),
            cutter: Cutter::default(),
            force: EdgeForce::default(),
            life: MillLife::default(),
            economics: Economics::default(),
        }
    }
}

/// Why a parameter set was not loaded.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SetError {
    /// No shipped set has this name.
    #[error(transparent)]
    Unknown(#[from] UnknownSet),
    /// A group that contour milling does not have.
    #[error("unknown group [parameters.{group}]; there are machine, cutter, force, life, economics")]
    UnknownGroup {
        /// What was read.
        group: String,
    },
    /// A faulty entry.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
}

impl Parameters {
    /// A shipped set.
    ///
    /// # Errors
    /// [`SetError::Unknown`] with the nearest name.
    ///
    /// # Examples
    /// ```
    /// use toolroom_contour::Parameters;
    /// assert_eq!(Parameters::named("mill_t15k6_d32").unwrap().cutter.teeth, 4.0);
    /// ```
    pub fn named(name: &str) -> Result<Self, SetError> {
        Self::read(shipped_set("contour milling", PARAMETER_SETS, name)?)
    }

    /// Reads a parameter file.
    ///
    /// # Errors
    /// [`SetError`], with the line where the file is at fault.
    pub fn read(text: &str) -> Result<Self, SetError> {
        let file = ParameterFile::read(text)?;
        let mut set = Self { name: file.name.clone(), title: file.title.clone(), ..Self::default() };
        let mut groups = set.parameters_mut();
        if let Some(group) = file.groups.keys().find(|group| groups.iter().all(|(known, _)| known != group)) {
            return Err(SetError::UnknownGroup { group: group.clone() });
        }
        for (group, record) in &mut groups {
            file.fill(text, group, *record)?;
        }
        Ok(set)
    }

    /// Parameter groups by name.
    pub fn parameters_mut(&mut self) -> Vec<(&'static str, &mut dyn AnyRecord)> {
        vec![
            ("machine", &mut self.machine),
            ("cutter", &mut self.cutter),
            ("force", &mut self.force),
            ("life", &mut self.life),
            ("economics", &mut self.economics),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shipped_set_is_the_defaults() {
        let (mut read, mut built) = (Parameters::named("mill_t15k6_d32").unwrap(), Parameters::default());
        assert_eq!(read.title, built.title);
        for ((group, a), (_, b)) in read.parameters_mut().into_iter().zip(built.parameters_mut()) {
            for (i, field) in a.fields().iter().enumerate() {
                let (a, b) = (a.value(i).unwrap(), b.value(i).unwrap());
                assert!((a - b).abs() <= 1e-12 * b.abs(), "{group}.{}: {a} {b}", field.name);
            }
        }
    }

    #[test]
    fn the_gear_series_is_that_of_the_machine() {
        let rpm: Vec<f64> = Machine::default().spindle_speeds().iter().map(|w| w * 60.0 / TAU).collect();
        let series = [40, 50, 63, 80, 100, 125, 160, 200, 250, 315, 400, 500, 630, 800, 1000, 1250, 1600, 2000];
        assert!(rpm.iter().zip(series).all(|(a, b)| (a - f64::from(b)).abs() < 1e-9), "{rpm:?}");
        let fine = Machine { speeds_per_decade: 20.0, ..Machine::default() };
        assert_eq!(fine.spindle_speeds().len(), 35);
    }

    #[test]
    fn an_unknown_set_offers_the_nearest() {
        let error = Parameters::named("mill_t15k6").unwrap_err();
        assert!(error.to_string().contains("did you mean `mill_t15k6_d32`"));
    }
}
