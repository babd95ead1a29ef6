//! The wear law of Takeyama and Murata.

use crate::temperature::power;
use crate::{Cut, law::Wear};
use toolroom_process::{Number, record};

record! {
    /// Abrasion by path plus diffusion by time at temperature:
    /// `d flank_wear / d time = abrasive_wear·v + diffusion_wear·exp(-activation_energy/(R·theta))`.
    ///
    /// # Source
    /// Takeyama & Murata 1963, form recalled. Defaults are an assumption: at 1000 K both terms
    /// are of the size that a nickel alloy shows at 40 m/min.
    pub struct TakeyamaMurata {
        /// Abrasive wear per path, G.
        abrasive_wear: Real["1" => "um/m"] = 0.25e-6, 0.0..=1e-3;
        /// Diffusion wear rate at infinite temperature, D.
        diffusion_wear: Real["m/s" => "um/min"] = 100.0, 0.0..=1e15;
        /// Activation energy, E.
        activation_energy: Real["J/mol" => "kJ/mol"] = 173.4e3, 0.0..=1e6;
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
            thermal_rate: self.diffusion_wear * cut.thermal_factor * cut.wear_factor,
        }
    }

    pub(crate) fn wear(&self, level: Wear<N>, temperature: N) -> Wear<N> {
        let exponent = -(self.activation_energy / (self.gas_constant * temperature));
        Wear { thermal_rate: level.thermal_rate * exponent.exp(), ..level }
    }

    pub(crate) fn weights(&self, temperature: N, speed_sensitivity: N) -> (N, N) {
        (N::from(0.0), self.activation_energy / (self.gas_constant * temperature) * speed_sensitivity - 1.0)
    }
}
