//! System (6): one mode with modulated stiffness under a lagged cutting force.

use super::{KGF_PER_MM, Preset, magnus::monodromy};
use crate::error::{ChatterError, finite, positive, within};
use crate::verdict::{ChatterKind, StabilityVerdict};
use nalgebra::{Complex, DMatrix, SMatrix};
use std::f64::consts::TAU;
use toolroom_spectral::dense_eigenvalues;

/// Workpiece in a chuck as one mode:
/// `m x'' + h x' + c (1 + mu sin(w t)) x = −c_p y`, `T y' + y = x`.
///
/// | symbol | field | unit | range |
/// |---|---|---|---|
/// | m | `mass` | kg | > 0 |
/// | h | `damping` | N s/m | > 0 |
/// | c | `stiffness` | N/m | > 0 |
/// | c_p | `cutting_stiffness` | N/m | ≥ 0 |
/// | T | `lag` | s | ≥ 0; zero switches to two states |
///
/// # Source
/// Zakovorotny et al., equation (6). The ratio `eta = w/w0` is taken to `w0² = (c + c_p)/m`.
///
/// # Examples
/// ```
/// use toolroom_chatter::paper::{Preset, Reduced};
/// let chuck = Reduced::from_preset(Preset::F0_120Hz, 0.4e-4);
/// let threshold = chuck.critical_modulation(1.0, 1.2).unwrap().unwrap();
/// assert!((threshold - 0.417262).abs() < 1e-5);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Reduced {
    /// Modal mass (kg).
    pub mass: f64,
    /// Damping coefficient [N·s/m].
    pub damping: f64,
    /// Mean stiffness of the clamping (N/m).
    pub stiffness: f64,
    /// Stiffness of the cutting process (N/m).
    pub cutting_stiffness: f64,
    /// Chip-formation lag (s).
    pub lag: f64,
}

impl Reduced {
    /// The paper's constants in one of their readings (c = 400 and c_p = 200 kgf/mm) with `lag` (s).
    pub fn from_preset(preset: Preset, lag: f64) -> Self {
        let (mass, damping) = preset.mass_and_damping();
        Self {
            mass: mass * KGF_PER_MM,
            damping: damping * KGF_PER_MM,
            stiffness: 400.0 * KGF_PER_MM,
            cutting_stiffness: 200.0 * KGF_PER_MM,
            lag,
        }
    }

    fn check(&self) -> Result<(), ChatterError> {
        positive("mass", self.mass)?;
        positive("damping", self.damping)?;
        positive("stiffness", self.stiffness)?;
        within("cutting_stiffness", self.cutting_stiffness, 0.0, f64::MAX)?;
        within("lag", self.lag, 0.0, f64::MAX)?;
        Ok(())
    }

    /// `w0 = sqrt((c + c_p)/m)` (rad/s), the scale of the speed ratio.
    pub fn natural_frequency(&self) -> f64 {
        ((self.stiffness + self.cutting_stiffness) / self.mass).sqrt()
    }

    /// Damping ratio with the lag as negative damping: `(h − c_p T)/(2 sqrt(m (c + c_p)))`.
    ///
    /// # Validity
    /// First order in `w0 T`.
    pub fn effective_damping_ratio(&self) -> f64 {
        (self.damping - self.cutting_stiffness * self.lag)
            / (2.0 * (self.mass * (self.stiffness + self.cutting_stiffness)).sqrt())
    }

    /// Greatest cutting stiffness that is stable without modulation (N/m), by Routh's criterion:
    /// `c_p < h/T + h²/m + h c T/m`; infinite without lag.
    ///
    /// # Source
    /// Exact for the characteristic polynomial of (6) at mu = 0; the paper's `c_p T < h` is its
    /// limit for a short lag.
    ///
    /// # Examples
    /// ```
    /// use toolroom_chatter::paper::{Preset, Reduced};
    /// let limit = Reduced::from_preset(Preset::Table2Literal, 0.8e-4).cutting_stiffness_limit();
    /// assert!((limit / 9806.65 - 198.76858).abs() < 1e-5); // kgf/mm: 200 is just outside
    /// ```
    pub fn cutting_stiffness_limit(&self) -> f64 {
        let Self { mass, damping, stiffness, lag, .. } = *self;
        if lag == 0.0 {
            return f64::INFINITY;
        }
        damping / lag + damping * damping / mass + damping * stiffness * lag / mass
    }

    /// The lag with the least limit, `sqrt(m/c)` (s), and that limit,
    /// `2 h sqrt(c/m) + h²/m` (N/m).
    pub fn least_limit(&self) -> (f64, f64) {
        let w = (self.stiffness / self.mass).sqrt();
        (1.0 / w, 2.0 * self.damping * w + self.damping * self.damping / self.mass)
    }

    /// Frequency of the vibration at the Routh limit, `sqrt((h + c T)/(m T))` (rad/s).
    pub fn limit_frequency(&self) -> f64 {
        ((self.damping + self.stiffness * self.lag) / (self.mass * self.lag)).sqrt()
    }

    /// Floquet multipliers over one period of the modulation `mu` at speed ratio `eta`, the
    /// greatest first. The state is (x, x'/w0, y), or (x, x'/w0) without lag.
    ///
    /// # Errors
    /// Constants that are no structure, modulation below 0, speed ratio below 0.001; a vibration that outgrows all
    /// numbers within the period.
    ///
    /// # Source
    /// Fourth-order Magnus, 40 steps to a natural cycle and at least 64, good to 1e-6.
    pub fn multipliers(&self, modulation: f64, speed_ratio: f64) -> Result<Vec<Complex<f64>>, ChatterError> {
        self.check()?;
        within("modulation", modulation, 0.0, f64::MAX)?;
        positive("speed_ratio", speed_ratio)?;
        within("speed_ratio", speed_ratio, 1.0 / super::MOST_CYCLES, f64::MAX)?;
        Ok(dense_eigenvalues(if self.lag == 0.0 {
            let map = self.period_map_without_lag(modulation, speed_ratio);
            DMatrix::from_iterator(2, 2, map.iter().copied())
        } else {
            DMatrix::from_iterator(3, 3, self.period_map(modulation, speed_ratio).iter().copied())
        })?)
    }

    /// Period map with lag, in time scaled by w0.
    fn period_map(&self, modulation: f64, speed_ratio: f64) -> SMatrix<f64, 3, 3> {
        let w0 = self.natural_frequency();
        let (share, damping, lag) = (self.share(), self.damping / (self.mass * w0), self.lag * w0);
        let coefficients = |s: f64| {
            let spring = share * (1.0 + modulation * (speed_ratio * s).sin());
            SMatrix::<f64, 3, 3>::new(
                0.0,
                1.0,
                0.0, //
                -spring,
                -damping,
                share - 1.0, //
                1.0 / lag,
                0.0,
                -1.0 / lag,
            )
        };
        monodromy(coefficients, TAU / speed_ratio, steps(speed_ratio))
    }

    /// Period map without lag (y = x), in time scaled by w0.
    fn period_map_without_lag(&self, modulation: f64, speed_ratio: f64) -> SMatrix<f64, 2, 2> {
        let (share, damping) = (self.share(), self.damping / (self.mass * self.natural_frequency()));
        let coefficients = |s: f64| {
            let spring = share * (1.0 + modulation * (speed_ratio * s).sin()) + 1.0 - share;
            SMatrix::<f64, 2, 2>::new(0.0, 1.0, -spring, -damping)
        };
        monodromy(coefficients, TAU / speed_ratio, steps(speed_ratio))
    }

    /// c/(c + c_p).
    fn share(&self) -> f64 {
        self.stiffness / (self.stiffness + self.cutting_stiffness)
    }

    /// Determinant of the period map and its exact value `exp(−P (h/m + 1/T))` (Liouville), a
    /// check of the integration.
    ///
    /// # Errors
    /// As [`Reduced::multipliers`]; a lag of zero, which has no third state.
    pub fn liouville(&self, modulation: f64, speed_ratio: f64) -> Result<(f64, f64), ChatterError> {
        self.check()?;
        positive("lag", self.lag)?;
        positive("speed_ratio", speed_ratio)?;
        let period = TAU / (speed_ratio * self.natural_frequency());
        let exact = (-period * (self.damping / self.mass + 1.0 / self.lag)).exp();
        Ok((self.period_map(modulation, speed_ratio).determinant(), exact))
    }

    /// Verdict for modulation `mu` at speed ratio `eta`: spectral radius over one period of the
    /// modulation, margin `1 − c_p/limit` at mu = 0.
    ///
    /// # Errors
    /// As [`Reduced::multipliers`].
    pub fn verdict(&self, modulation: f64, speed_ratio: f64) -> Result<StabilityVerdict, ChatterError> {
        let dominant = self.multipliers(modulation, speed_ratio)?[0];
        let period = TAU / (speed_ratio * self.natural_frequency());
        let margin = 1.0 - self.cutting_stiffness / self.cutting_stiffness_limit();
        let mut verdict = StabilityVerdict::from_multiplier(dominant, period, 0.0);
        verdict.margin = Some(margin);
        if !verdict.stable && margin > 0.0 {
            verdict.kind = ChatterKind::Parametric;
        }
        Ok(verdict)
    }

    /// Least modulation at which (6) loses stability at speed ratio `eta`, searched up to
    /// `greatest`; `Some(0)` where the cut is unstable without modulation, `None` where it stays
    /// stable.
    ///
    /// # Errors
    /// As [`Reduced::multipliers`].
    pub fn critical_modulation(&self, speed_ratio: f64, greatest: f64) -> Result<Option<f64>, ChatterError> {
        positive("modulation", greatest)?;
        super::first_unstable(greatest, 60, |mu| Ok(self.multipliers(mu, speed_ratio)?[0].norm() - 1.0))
    }

    /// Spindle speed (rad/s) at speed ratio `eta` in a chuck of three jaws: `eta w0/3`.
    ///
    /// # Errors
    /// A speed ratio that is no number.
    pub fn spindle_speed(&self, speed_ratio: f64) -> Result<f64, ChatterError> {
        Ok(finite("speed_ratio", speed_ratio)? * self.natural_frequency() / 3.0)
    }
}

/// Steps to a period: 40 to a natural cycle, at least 64.
fn steps(speed_ratio: f64) -> usize {
    ((40.0 / speed_ratio).ceil() as usize).max(64)
}
