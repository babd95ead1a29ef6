//! The choice of wear law.

use crate::{Cut, EnergyBalance, ExtendedTaylor, TakeyamaMurata, Usui, Wear, wear_curve};
use toolroom_process::{AnyRecord, ModelError, Number};

/// How fast the flank wears.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WearLaw<N: Copy = f64> {
    /// Two functionals whose balance depends on the state of wear; the default.
    EnergyBalance(EnergyBalance<N>),
    /// Taylor's law with a separable wear curve.
    ExtendedTaylor(ExtendedTaylor<N>),
    /// Abrasion by path plus diffusion by time at temperature.
    TakeyamaMurata(TakeyamaMurata<N>),
    /// Adhesion by path, pressure and temperature.
    Usui(Usui<N>),
}

impl Default for WearLaw {
    fn default() -> Self {
        Self::EnergyBalance(EnergyBalance::default())
    }
}

impl<N: Number> WearLaw<N> {
    /// Rate of flank wear dh/dt at constant conditions, m/s: an edge in cut with the land
    /// `flank_wear` (m) at the contact temperature `temperature` (K), without thermal damage.
    ///
    /// The number type may be a dual number, so that the slopes by the parameters of the law, by
    /// the land, the temperature or the cut are exact. The temperature that belongs to a cut and a
    /// land is [`Contact::steady_temperature`](crate::Contact::steady_temperature).
    ///
    /// # Examples
    /// ```
    /// use toolroom_process::num_dual::{Dual64, first_derivative};
    /// use toolroom_wear::{Cut, ExtendedTaylor, WearLaw};
    /// let cut = Cut::nominal(222.0 / 60.0, 0.3e-3, 1.5e-3);
    /// let rate = |life: Dual64| {
    ///     let law = ExtendedTaylor { reference_life: life, ..ExtendedTaylor::default().map(Dual64::from) };
    ///     WearLaw::ExtendedTaylor(law).rate(&cut.map(Dual64::from), 0.1e-3.into(), 1140.8.into())
    /// };
    /// let (rate, slope) = first_derivative(rate, 3600.0);
    /// assert!((slope + rate / 3600.0).abs() < 1e-12 * rate);
    /// ```
    pub fn rate(&self, cut: &Cut<N>, flank_wear: N, temperature: N) -> N {
        let none = N::from(0.0);
        self.wear(self.level(cut), flank_wear, temperature, none, none).rate(cut.cutting_speed)
    }

    /// Width of the run-in over wear, m, where the law has one.
    pub fn run_in_width(&self) -> Option<N> {
        let (land, offset) = match self {
            Self::EnergyBalance(law) => (law.run_in_land, law.run_in_offset),
            Self::TakeyamaMurata(law) => (law.run_in_land, law.run_in_offset),
            Self::Usui(law) => (law.run_in_land, law.run_in_offset),
            Self::ExtendedTaylor(_) => return None,
        };
        (land.re() > 0.0).then_some(offset)
    }

    /// The part of wear that only the cut decides.
    pub(crate) fn level(&self, cut: &Cut<N>) -> Wear<N> {
        match self {
            Self::EnergyBalance(law) => law.level(cut),
            Self::ExtendedTaylor(law) => law.level(cut),
            Self::TakeyamaMurata(law) => law.level(cut),
            Self::Usui(law) => law.level(cut),
        }
    }

    /// `level`, made for another speed, brought to that of `cut`.
    #[inline]
    pub(crate) fn level_at_speed(&self, level: Wear<N>, cut: &Cut<N>) -> Wear<N> {
        match self {
            Self::ExtendedTaylor(law) => law.level(cut),
            Self::EnergyBalance(_) | Self::TakeyamaMurata(_) | Self::Usui(_) => level,
        }
    }

    /// `level` brought to the state of the edge.
    #[inline]
    pub(crate) fn wear(&self, level: Wear<N>, flank_wear: N, temperature: N, damage: N, damage_gain: N) -> Wear<N> {
        match self {
            Self::EnergyBalance(law) => law.wear(level, flank_wear, temperature, damage, damage_gain),
            Self::ExtendedTaylor(law) => law.wear(level, flank_wear),
            Self::TakeyamaMurata(law) => law.wear(level, flank_wear, temperature),
            Self::Usui(law) => law.wear(level, flank_wear, temperature),
        }
    }

    /// Weights (w_M, w_T) with `-∂J/∂ln v = w_M·A - w_T·B/v`; `speed_sensitivity` is
    /// `∂ ln theta / ∂ ln v`.
    pub(crate) fn weights(&self, temperature: N, speed_sensitivity: N) -> (N, N) {
        match self {
            Self::EnergyBalance(law) => law.weights(temperature, speed_sensitivity),
            Self::ExtendedTaylor(law) => law.weights(),
            Self::TakeyamaMurata(law) => law.weights(temperature, speed_sensitivity),
            Self::Usui(law) => law.weights(temperature, speed_sensitivity),
        }
    }

    /// The same law over another number type.
    pub fn map<M: Copy>(self, convert: impl FnMut(N) -> M) -> WearLaw<M> {
        match self {
            Self::EnergyBalance(law) => WearLaw::EnergyBalance(law.map(convert)),
            Self::ExtendedTaylor(law) => WearLaw::ExtendedTaylor(law.map(convert)),
            Self::TakeyamaMurata(law) => WearLaw::TakeyamaMurata(law.map(convert)),
            Self::Usui(law) => WearLaw::Usui(law.map(convert)),
        }
    }
}

impl WearLaw {
    /// Name of the law's group in parameter files.
    pub fn group(&self) -> &'static str {
        match self {
            Self::EnergyBalance(_) => "energy_balance",
            Self::ExtendedTaylor(_) => "extended_taylor",
            Self::TakeyamaMurata(_) => "takeyama_murata",
            Self::Usui(_) => "usui",
        }
    }

    /// The law of a group, with default parameters.
    pub(crate) fn of_group(group: &str) -> Option<Self> {
        match group {
            "energy_balance" => Some(Self::default()),
            "extended_taylor" => Some(Self::ExtendedTaylor(ExtendedTaylor::default())),
            "takeyama_murata" => Some(Self::TakeyamaMurata(TakeyamaMurata::default())),
            "usui" => Some(Self::Usui(Usui::default())),
            _ => None,
        }
    }

    /// Whether its parameters, each in its range, fit together.
    ///
    /// # Errors
    /// [`ModelError::Contradiction`] where the stage tilt is too large for the stage contrast.
    pub fn check(&self) -> Result<(), ModelError> {
        match self {
            Self::ExtendedTaylor(law) => wear_curve::check_tilt(law.stage_contrast, law.stage_tilt),
            Self::EnergyBalance(_) | Self::TakeyamaMurata(_) | Self::Usui(_) => Ok(()),
        }
    }

    /// The law's parameters.
    pub fn record_mut(&mut self) -> &mut dyn AnyRecord {
        match self {
            Self::EnergyBalance(law) => law,
            Self::ExtendedTaylor(law) => law,
            Self::TakeyamaMurata(law) => law,
            Self::Usui(law) => law,
        }
    }
}
