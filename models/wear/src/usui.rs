//! The wear law of Usui, Hirota and Masuko.

use crate::temperature::power;
use crate::{Cut, run_in, wear::Wear};
use toolroom_process::{Number, record};

record! {
    /// Adhesive wear by path, pressure and temperature:
    /// `d flank_wear / d time = wear_at_reference · (σ/σ_r) · g_m(h) · v · exp(-Q·(1/theta - 1/theta_r))`.
    ///
    /// σ is the flank pressure of the force group and σ_r its nominal value, so that the ratio is
    /// the cut's factor on the flank pressure; `g_m` is the run-in ([`run_in`](crate::run_in)).
    /// Wear per path has no minimum over speed: it rises with temperature, and the slowest speed
    /// gives the longest path. All of the wear counts as mechanical.
    ///
    /// # Validity
    /// Temperatures within one wear mechanism. Usui found two for steel and carbide, with a change
    /// near 1150 K; one activation temperature holds one of them.
    ///
    /// # Source
    /// Usui, Hirota & Masuko 1978, form recalled; activation temperature 21.95 kK of carbide on
    /// steel above that change, recalled. The level is an assumption: with the run-in and the
    /// temperatures of the set `c45_t15k6` it gives a life of some tens of minutes at 180 m/min.
    pub struct Usui {
        /// Wear per path at the reference temperature and nominal pressure on a wide land, K_r.
        wear_at_reference: Real["1" => "um/m"] = 0.02e-6, 0.0..=1e-3;
        /// Activation temperature Q, activation energy over gas constant.
        activation_temperature: Real["K" => "K"] = 21950.0, 0.0..=1e5;
        /// Reference temperature, theta_r.
        reference_temperature: Real["K" => "K"] = 1140.8, 300.0..=5000.0;
        /// Strength of the run-in, h_r.
        run_in_land: Real["m" => "mm"] = 0.08e-3, 0.0..=10e-3;
        /// Land at which the run-in fades, h_e.
        run_in_offset: Real["m" => "mm"] = 0.02e-3, 1e-7..=10e-3;
        /// Exponent of hardness.
        hardness_exponent: Real = 1.0, 0.0..=5.0;
    }
}

impl<N: Number> Usui<N> {
    pub(crate) fn level(&self, cut: &Cut<N>) -> Wear<N> {
        let mechanical_per_path = self.wear_at_reference
            * cut.flank_pressure_factor
            * cut.mechanical_factor
            * power(cut.hardness, self.hardness_exponent)
            * cut.wear_factor;
        Wear { mechanical_per_path, thermal_rate: N::from(0.0) }
    }

    #[inline]
    pub(crate) fn wear(&self, level: Wear<N>, flank_wear: N, temperature: N) -> Wear<N> {
        let exponent = -self.activation_temperature * (temperature.recip() - self.reference_temperature.recip());
        let run_in = run_in(flank_wear, self.run_in_land, self.run_in_offset);
        Wear { mechanical_per_path: level.mechanical_per_path * run_in * exponent.exp(), ..level }
    }

    /// `∂J/∂ln v = J·Q/theta·χ`: wear per path only rises with speed.
    pub(crate) fn weights(&self, temperature: N, speed_sensitivity: N) -> (N, N) {
        (-(self.activation_temperature / temperature * speed_sensitivity), N::from(0.0))
    }
}
