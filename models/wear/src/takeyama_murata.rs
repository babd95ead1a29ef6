//! The wear law of Takeyama and Murata.

use crate::temperature::power;
use crate::{Cut, run_in, wear::Wear};
use toolroom_process::{Number, record};

record! {
    /// Abrasion by path plus diffusion by time at temperature:
    /// `d flank_wear / d time = abrasive_wear·g_m(h)·v + D_r·exp(-(E/R)·(1/theta - 1/theta_r))`
    /// with the run-in `g_m` ([`run_in`](crate::run_in)), which is off by default.
    ///
    /// The diffusion term is stated at a reference temperature. The classic coefficient at
    /// infinite temperature, `diffusion_wear = D_r·exp(E/(R·theta_r))`, changes by orders of
    /// magnitude with the activation energy and can not be estimated apart from it.
    ///
    /// # Source
    /// Takeyama & Murata 1963, form recalled. Defaults are an assumption: at 1000 K both terms
    /// are of the size that a nickel alloy shows at 40 m/min.
    pub struct TakeyamaMurata {
        /// Abrasive wear per path on a wide land, G.
        abrasive_wear: Real["1" => "um/m"] = 0.25e-6, 0.0..=1e-3;
        /// Diffusion wear rate at the reference temperature, D_r.
        diffusion_wear_at_reference: Real["m/s" => "um/min"] = 5.26e-6 / 60.0, 0.0..=1e-3;
        /// Activation energy, E.
        activation_energy: Real["J/mol" => "kJ/mol"] = 173.4e3, 0.0..=1e6;
        /// Reference temperature, theta_r.
        reference_temperature: Real["K" => "K"] = 1000.0, 300.0..=5000.0;
        /// Strength of the run-in, h_r; 0 is none.
        run_in_land: Real["m" => "mm"] = 0.0, 0.0..=10e-3;
        /// Land at which the run-in fades, h_e.
        run_in_offset: Real["m" => "mm"] = 0.02e-3, 1e-7..=10e-3;
        /// Exponent of hardness in abrasion.
        hardness_exponent: Real = 1.0, 0.0..=5.0;
        /// Molar gas constant, R.
        gas_constant: Real["J/mol K" => "J/mol K"] = 8.314462618, 1e-3..=1e3;
    }
}

impl<N: Number> TakeyamaMurata<N> {
    pub(crate) fn level(&self, cut: &Cut<N>) -> Wear<N> {
        Wear {
            mechanical_per_path: self.abrasive_wear
                * cut.mechanical_factor
                * power(cut.hardness, self.hardness_exponent)
                * cut.wear_factor,
            thermal_rate: self.diffusion_wear_at_reference * cut.thermal_factor * cut.wear_factor,
        }
    }

    #[inline]
    pub(crate) fn wear(&self, level: Wear<N>, flank_wear: N, temperature: N) -> Wear<N> {
        let difference = temperature.recip() - self.reference_temperature.recip();
        let exponent = -(self.activation_energy / self.gas_constant) * difference;
        Wear {
            mechanical_per_path: level.mechanical_per_path * run_in(flank_wear, self.run_in_land, self.run_in_offset),
            thermal_rate: level.thermal_rate * exponent.exp(),
        }
    }

    pub(crate) fn weights(&self, temperature: N, speed_sensitivity: N) -> (N, N) {
        (N::from(0.0), self.activation_energy / (self.gas_constant * temperature) * speed_sensitivity - 1.0)
    }
}
