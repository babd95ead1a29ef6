//! What a revolution asks of wheel and spindle, and how far it is from burn.

use crate::law::{REFERENCE_DEPTH, depth_of_chip};
use crate::{Infeed, Input, State};

/// Loads of a revolution, of a wheel in contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load {
    /// Normal force F_n, N.
    pub normal_force: f64,
    /// Tangential force F_t = μ F_n, N.
    pub tangential_force: f64,
    /// Power of the wheel spindle, P = F_t v_s, W.
    pub power: f64,
    /// Specific removal rate Q'_w = v_w h, m²/s.
    pub removal_rate: f64,
    /// Specific energy u = P/(Q'_w b), J/m³; 0 where nothing is cut.
    pub specific_energy: f64,
    /// Equivalent chip thickness h_eq = Q'_w/v_s, m.
    pub equivalent_chip_thickness: f64,
    /// Geometric contact length l_c = √(h d_e), m.
    pub contact_length: f64,
    /// Temperature rise of the grinding zone, K.
    pub temperature_rise: f64,
    /// Distance to burn by the temperature, 1 − temperature rise / burn limit.
    pub burn_margin: f64,
    /// Specific energy at which the surface burns at this depth, u*, J/m³; none below the depth whose force is the
    /// threshold force, where the contact is not that of the depth.
    pub burn_energy: Option<f64>,
}

impl Load {
    /// Distance to burn by Malkin's specific energy, 1 − u/u*; none where that is not asked.
    pub fn energy_margin(&self) -> Option<f64> {
        self.burn_energy.map(|energy| 1.0 - self.specific_energy / energy)
    }

    /// The lesser of both distances to burn: the one that binds.
    pub fn least_margin(&self) -> f64 {
        self.energy_margin().map_or(self.burn_margin, |margin| margin.min(self.burn_margin))
    }
}

impl Infeed {
    /// Loads of the last revolution of `x`.
    ///
    /// Malkin's burn limit `u* = u0 + B d_e^(1/4) h^(-3/4) v_w^(-1/2)` has `u0` as the share of the chip formation energy
    /// that leaves with the chips, and `B = θ_b √(k ρ c) √π/2` by the constants of the work and its burn temperature rise
    /// θ_b, 7.17 in J, mm, s for the shipped set.
    ///
    /// # Source
    /// Malkin, Grinding Technology (recalled; 7.2 for steels).
    ///
    /// ```
    /// use toolroom_infeed::{Infeed, Input, State};
    /// let cut = State { depth_of_cut: 4.43e-6, ..State::default() };
    /// let load = Infeed::default().load(&cut, &Input::default());
    /// assert!((load.burn_energy.unwrap() * 1e-9 - 45.2).abs() < 0.01); // J/mm³, of which it takes 41.3
    /// ```
    pub fn load(&self, x: &State, u: &Input) -> Load {
        let p = &self.parameters;
        let output = self.output_in_cut(x, u);
        let work_speed = 0.5 * u.work_rotation_speed * p.work_diameter;
        let removal_rate = x.depth_of_cut * work_speed;
        let contact_length = (x.depth_of_cut * p.equivalent_diameter()).sqrt();
        let [compliance, _, threshold] = self.shares(x, u);
        let rubbed = depth_of_chip(threshold / compliance, p.force_exponent, REFERENCE_DEPTH);
        let burn_energy = (removal_rate > 0.0 && x.depth_of_cut >= rubbed).then(|| {
            let conducted = (p.conductivity * p.density * p.heat_capacity * contact_length / work_speed).sqrt();
            let scale = p.burn_temperature_rise / std::f64::consts::FRAC_2_SQRT_PI;
            p.chip_heat_share * p.chip_formation_energy + scale * conducted / x.depth_of_cut
        });
        Load {
            normal_force: output.normal_force,
            tangential_force: output.tangential_force,
            power: output.spindle_power,
            removal_rate,
            specific_energy: output.specific_energy,
            equivalent_chip_thickness: removal_rate / p.wheel_speed,
            contact_length,
            temperature_rise: output.temperature_rise,
            burn_margin: output.burn_margin,
            burn_energy,
        }
    }

    /// The same machine with a wheel that has lost `loss` (m) of its radius, at the same rotation: the wheel speed follows
    /// the diameter.
    ///
    /// ```
    /// use toolroom_infeed::Infeed;
    /// let small = Infeed::default().with_worn_wheel(50e-3);
    /// assert!((small.parameters.wheel_diameter - 0.3).abs() < 1e-12);
    /// assert!((small.parameters.wheel_speed - 26.25).abs() < 1e-12);
    /// ```
    pub fn with_worn_wheel(&self, loss: f64) -> Self {
        let mut worn = self.clone();
        let wheel = &mut worn.parameters;
        let diameter = wheel.wheel_diameter - 2.0 * loss;
        wheel.wheel_speed *= diameter / wheel.wheel_diameter;
        wheel.wheel_diameter = diameter;
        worn
    }
}
