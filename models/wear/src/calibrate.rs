//! Setting the wear law from what is known at one cut.

use crate::{Cut, EnergyBalance, Pair, WearLaw};

/// What is known of wear at one speed and state of wear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WearTarget {
    /// Wear per path J there, 1.
    pub wear_intensity: f64,
    /// Fall of mechanical wear per path with speed, p = -∂ln A/∂ln v.
    pub mechanical_slope: f64,
    /// Rise of thermal wear per path with speed, q = ∂ln(B/v)/∂ln v.
    pub thermal_slope: f64,
}

impl Pair {
    /// The same pair with an energy balance that shows `target` at `cut` and `flank_wear`, its
    /// minimum over speed there. Run-in, layer and plateau are kept from the present energy
    /// balance, or from the default where the law is another one.
    ///
    /// `E_t = (q + 1)·R·theta/χ`, `E_m = p·R·theta/(χ·(1 - 1/phi_c))`,
    /// `A = J·q/(p + q)`, `B/v = J·p/(p + q)`.
    ///
    /// # Examples
    /// ```
    /// use toolroom_wear::{Pair, WearTarget};
    /// let pair = Pair::default();
    /// let target = WearTarget { wear_intensity: 0.5e-6, mechanical_slope: 5.0, thermal_slope: 5.0 };
    /// let cut = pair.reference_cut();
    /// let again = pair.calibrated(&cut, 0.2e-3, target);
    /// assert!((again.minimum_wear_speed(&cut, 0.2e-3) / cut.cutting_speed - 1.0).abs() < 1e-12);
    /// ```
    pub fn calibrated(&self, cut: &Cut, flank_wear: f64, target: WearTarget) -> Self {
        let law = match self.law {
            WearLaw::EnergyBalance(law) => law,
            WearLaw::ExtendedTaylor(_) | WearLaw::TakeyamaMurata(_) | WearLaw::Usui(_) => EnergyBalance::default(),
        };
        let contact = self.contact(cut);
        let theta = contact.steady_temperature(flank_wear);
        let thermal = law.gas_constant * theta / contact.speed_sensitivity(flank_wear, theta);
        let WearTarget { wear_intensity, mechanical_slope: p, thermal_slope: q } = target;
        let run_in = 1.0 + law.run_in_land / (flank_wear + law.run_in_offset);
        let layer = 1.0 + (flank_wear / law.heated_layer_land).powi(2);
        let law = EnergyBalance {
            reference_temperature: theta,
            thermal_activation_energy: (q + 1.0) * thermal,
            mechanical_activation_energy: p * thermal / (1.0 - law.cold_plateau.recip()),
            mechanical_wear_per_path: wear_intensity * q / (p + q) / run_in,
            thermal_wear_rate: wear_intensity * p * cut.cutting_speed / (p + q) / layer,
            ..law
        };
        Self { law: WearLaw::EnergyBalance(law), ..self.clone() }
    }
}
