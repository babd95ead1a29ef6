//! The evolutionary wear law: mechanical wear by path, thermal wear by time at temperature.

use crate::temperature::power;
use crate::{Cut, run_in, wear::Wear};
use toolroom_process::{Number, record};

record! {
    /// Flank wear by two functionals, one of force and path, one of temperature and time.
    ///
    /// `d flank_wear / d time = v·A + B`, with
    ///
    /// | symbol | equation |
    /// |---|---|
    /// | A | `mechanical_wear_per_path · hardness^n_A · g_m(h) · phi(theta) · (1 + damage_gain·damage)` |
    /// | B | `thermal_wear_rate · g_t(h) · psi(theta)` |
    /// | phi | `1/(1/phi_c + (1 - 1/phi_c)·exp(-E_m/R·(1/theta - 1/theta_r)))`, 1 at theta_r, phi_c when cold |
    /// | psi | `exp(-E_t/R·(1/theta - 1/theta_r))` |
    /// | g_m | `1 + h_r/(h + h_e)`, run-in: pressure falls as the land grows |
    /// | g_t | `1 + (h/h_t)²`, deeper heated layer under a wider land |
    ///
    /// Wear per path `J = A + B/v` has a minimum over speed where `w_M·A = w_T·B/v`
    /// ([`EnergyBalance::weights`]): the paper's "difference of the functionals" is exactly
    /// `-∂J/∂ln v`.
    ///
    /// # Source
    /// Postnov & Shafikov, eq. (10), read as a split between path and time (an energy difference
    /// taken literally is unusable: its terms differ by nine orders of magnitude); the split is
    /// that of Takeyama & Murata (recalled) and of Zanger & Schulze as coded by ETH-IWF. The
    /// functions of temperature and land are assumptions. Defaults are the set `ni_vk6om`.
    pub struct EnergyBalance {
        /// Mechanical wear per path at the reference temperature, A0.
        mechanical_wear_per_path: Real["1" => "um/m"] = 0.18333e-6, 0.0..=1e-3;
        /// Activation energy of the loss of mechanical wear with temperature, E_m.
        mechanical_activation_energy: Real["J/mol" => "kJ/mol"] = 173.4e3, 0.0..=1e6;
        /// Ratio of cold mechanical wear to that at the reference temperature, phi_c.
        cold_plateau: Real = 6.0, 1.0..=1000.0;
        /// Thermal wear rate at the reference temperature, B0.
        thermal_wear_rate: Real["m/s" => "um/min"] = 9e-6 / 60.0, 0.0..=1e-3;
        /// Activation energy of thermal wear, E_t.
        thermal_activation_energy: Real["J/mol" => "kJ/mol"] = 173.4e3, 0.0..=1e6;
        /// Reference temperature, theta_r.
        reference_temperature: Real["K" => "K"] = 1028.9, 300.0..=5000.0;
        /// Strength of the run-in, h_r.
        run_in_land: Real["m" => "mm"] = 0.08e-3, 0.0..=10e-3;
        /// Land at which the run-in fades, h_e.
        run_in_offset: Real["m" => "mm"] = 0.02e-3, 1e-7..=10e-3;
        /// Land at which thermal wear has doubled, h_t.
        heated_layer_land: Real["m" => "mm"] = 0.6e-3, 1e-6..=1e6;
        /// Exponent of hardness in mechanical wear, n_A.
        hardness_exponent: Real = 1.0, 0.0..=5.0;
        /// Rate of thermal damage at the reference temperature, k_D.
        damage_rate: Real["1/s" => "1/min"] = 0.0, 0.0..=10.0;
        /// Growth of mechanical wear by full damage, kap_D; 0 switches heredity off.
        damage_gain: Real = 0.0, 0.0..=100.0;
        /// Wear that removes the damaged layer, del_D.
        damage_wear_depth: Real["m" => "mm"] = 0.03e-3, 1e-7..=10e-3;
        /// Molar gas constant, R.
        gas_constant: Real["J/mol K" => "J/mol K"] = 8.314462618, 1e-3..=1e3;
    }
}

impl<N: Number> EnergyBalance<N> {
    /// Wear at reference temperature and wide land under `cut`.
    pub(crate) fn level(&self, cut: &Cut<N>) -> Wear<N> {
        Wear {
            mechanical_per_path: self.mechanical_wear_per_path
                * cut.mechanical_factor
                * power(cut.hardness, self.hardness_exponent)
                * cut.wear_factor,
            thermal_rate: self.thermal_wear_rate * cut.thermal_factor * cut.wear_factor,
        }
    }

    /// `level` brought to land, temperature and damage.
    #[inline]
    pub(crate) fn wear(&self, level: Wear<N>, flank_wear: N, temperature: N, damage: N, damage_gain: N) -> Wear<N> {
        let run_in = run_in(flank_wear, self.run_in_land, self.run_in_offset);
        let layer = flank_wear / self.heated_layer_land;
        let hot = self.arrhenius(self.mechanical_activation_energy, temperature);
        // Several sets have one energy for both: an exponential less, the same to the bit.
        let same = N::NDERIV == 0 && self.mechanical_activation_energy.re() == self.thermal_activation_energy.re();
        let activation = if same { hot } else { self.activation(temperature) };
        Wear {
            mechanical_per_path: level.mechanical_per_path * run_in * self.softened(hot) * (damage_gain * damage + 1.0),
            thermal_rate: level.thermal_rate * (layer * layer + 1.0) * activation,
        }
    }

    /// `exp(-energy/R·(1/temperature - 1/reference_temperature))`
    #[inline]
    fn arrhenius(&self, energy: N, temperature: N) -> N {
        (-(energy / self.gas_constant) * (temperature.recip() - self.reference_temperature.recip())).exp()
    }

    /// Mechanical wear against that at the reference temperature, phi.
    #[inline]
    pub fn softening(&self, temperature: N) -> N {
        self.softened(self.arrhenius(self.mechanical_activation_energy, temperature))
    }

    /// The same of the Arrhenius factor of mechanical wear.
    #[inline]
    fn softened(&self, hot: N) -> N {
        let plateau = self.cold_plateau.recip();
        (plateau + (-plateau + 1.0) * hot).recip()
    }

    /// Thermal wear against that at the reference temperature, psi.
    #[inline]
    pub fn activation(&self, temperature: N) -> N {
        self.arrhenius(self.thermal_activation_energy, temperature)
    }

    /// Weights (w_M, w_T) of the balance `-∂J/∂ln v = w_M·A - w_T·B/v`;
    /// `speed_sensitivity` is `∂ ln theta / ∂ ln v`.
    ///
    /// `w_M = E_m/(R·theta)·(1 - phi/phi_c)·χ`, `w_T = E_t/(R·theta)·χ - 1`.
    pub fn weights(&self, temperature: N, speed_sensitivity: N) -> (N, N) {
        let thermal = self.gas_constant * temperature;
        let fall = -(self.softening(temperature) / self.cold_plateau) + 1.0;
        (
            self.mechanical_activation_energy / thermal * fall * speed_sensitivity,
            self.thermal_activation_energy / thermal * speed_sensitivity - 1.0,
        )
    }
}
