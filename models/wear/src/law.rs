//! The choice of wear law.

use crate::{Cut, EnergyBalance, ExtendedTaylor, TakeyamaMurata};
use toolroom_process::{AnyRecord, Number};

/// Wear of one instant, split by what drives it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wear<N = f64> {
    /// Wear per cutting path (A), 1 (m of land per m of path).
    pub mechanical_per_path: N,
    /// Wear per time (B), m/s.
    pub thermal_rate: N,
}

impl<N: Number> Wear<N> {
    /// Wear per path J = A + B/v, 1; infinite at rest.
    pub fn intensity(&self, cutting_speed: N) -> N {
        self.mechanical_per_path + self.thermal_rate / cutting_speed
    }

    /// Wear per time v·A + B, m/s.
    #[inline]
    pub fn rate(&self, cutting_speed: N) -> N {
        cutting_speed * self.mechanical_per_path + self.thermal_rate
    }
}

/// How fast the flank wears.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WearLaw<N: Copy = f64> {
    /// Two functionals whose balance depends on the state of wear; the default.
    EnergyBalance(EnergyBalance<N>),
    /// Taylor's law with a separable wear curve.
    ExtendedTaylor(ExtendedTaylor<N>),
    /// Abrasion by path plus diffusion by time, no dependence on the land but by temperature.
    TakeyamaMurata(TakeyamaMurata<N>),
}

impl Default for WearLaw {
    fn default() -> Self {
        Self::EnergyBalance(EnergyBalance::default())
    }
}

impl<N: Number> WearLaw<N> {
    /// The part of wear that only the cut decides.
    pub(crate) fn level(&self, cut: &Cut<N>) -> Wear<N> {
        match self {
            Self::EnergyBalance(law) => law.level(cut),
            Self::ExtendedTaylor(law) => law.level(cut),
            Self::TakeyamaMurata(law) => law.level(cut),
        }
    }

    /// `level`, made for another speed, brought to that of `cut`.
    #[inline]
    pub(crate) fn level_at_speed(&self, level: Wear<N>, cut: &Cut<N>) -> Wear<N> {
        match self {
            Self::ExtendedTaylor(law) => law.level(cut),
            Self::EnergyBalance(_) | Self::TakeyamaMurata(_) => level,
        }
    }

    /// `level` brought to the state of the edge.
    #[inline]
    pub(crate) fn wear(&self, level: Wear<N>, flank_wear: N, temperature: N, damage: N, damage_gain: N) -> Wear<N> {
        match self {
            Self::EnergyBalance(law) => law.wear(level, flank_wear, temperature, damage, damage_gain),
            Self::ExtendedTaylor(law) => law.wear(level, flank_wear),
            Self::TakeyamaMurata(law) => law.wear(level, temperature),
        }
    }

    /// Weights (w_M, w_T) with `-∂J/∂ln v = w_M·A - w_T·B/v`; `speed_sensitivity` is
    /// `∂ ln theta / ∂ ln v`.
    pub(crate) fn weights(&self, temperature: N, speed_sensitivity: N) -> (N, N) {
        match self {
            Self::EnergyBalance(law) => law.weights(temperature, speed_sensitivity),
            Self::ExtendedTaylor(law) => law.weights(),
            Self::TakeyamaMurata(law) => law.weights(temperature, speed_sensitivity),
        }
    }

    /// The same law over another number type.
    pub fn map<M: Copy>(self, convert: impl FnMut(N) -> M) -> WearLaw<M> {
        match self {
            Self::EnergyBalance(law) => WearLaw::EnergyBalance(law.map(convert)),
            Self::ExtendedTaylor(law) => WearLaw::ExtendedTaylor(law.map(convert)),
            Self::TakeyamaMurata(law) => WearLaw::TakeyamaMurata(law.map(convert)),
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
        }
    }

    /// The law of a group, with default parameters.
    pub(crate) fn of_group(group: &str) -> Option<Self> {
        match group {
            "energy_balance" => Some(Self::default()),
            "extended_taylor" => Some(Self::ExtendedTaylor(ExtendedTaylor::default())),
            "takeyama_murata" => Some(Self::TakeyamaMurata(TakeyamaMurata::default())),
            _ => None,
        }
    }

    /// The law's parameters.
    pub fn record_mut(&mut self) -> &mut dyn AnyRecord {
        match self {
            Self::EnergyBalance(law) => law,
            Self::ExtendedTaylor(law) => law,
            Self::TakeyamaMurata(law) => law,
        }
    }
}
