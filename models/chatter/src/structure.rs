//! Modes of tool and workpiece.

use crate::error::{ChatterError, finite, positive};
use nalgebra::Complex;
use std::f64::consts::TAU;

/// One vibration mode, of the tool or of the workpiece, at the point of cut.
///
/// `q'' + 2 zeta w q' + w² q = w²/stiffness · direction·F`, displacement `direction · q`; both
/// sides of the cut enter the relative displacement in the same way.
///
/// | symbol | field | unit | range |
/// |---|---|---|---|
/// | d | `direction` | 1 | not zero; only its direction counts |
/// | f | `natural_frequency` | Hz | > 0 |
/// | zeta | `damping_ratio` | 1 | 0 … 1, both excluded |
/// | k | `stiffness` | N/m | > 0 |
///
/// In milling the directions are (feed, normal to it); in turning (chip thickness, cutting speed).
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Mode {
    /// Direction of the motion in the plane of the cut.
    pub direction: [f64; 2],
    /// Undamped natural frequency (Hz).
    pub natural_frequency: f64,
    /// Share of critical damping.
    pub damping_ratio: f64,
    /// Modal stiffness at the point of cut (N/m).
    pub stiffness: f64,
}

impl Mode {
    /// The mode with modal `mass` (kg) instead of a stiffness.
    ///
    /// ```
    /// let mode = toolroom_chatter::Mode::from_mass([1.0, 0.0], 922.0, 0.011, 0.03993);
    /// assert!((mode.stiffness - 1.340050e6).abs() < 10.0);
    /// ```
    pub fn from_mass(direction: [f64; 2], natural_frequency: f64, damping_ratio: f64, mass: f64) -> Self {
        let w = TAU * natural_frequency;
        Self { direction, natural_frequency, damping_ratio, stiffness: mass * w * w }
    }

    /// `w = 2 pi f` (rad/s).
    pub fn angular_frequency(&self) -> f64 {
        TAU * self.natural_frequency
    }

    /// Modal mass `k/w²` (kg).
    pub fn mass(&self) -> f64 {
        self.stiffness / self.angular_frequency().powi(2)
    }

    /// Compliance of the modal coordinate at `frequency` (Hz): `1/(k (1 − r² + 2 i zeta r))` (m/N).
    pub fn compliance(&self, frequency: f64) -> Complex<f64> {
        let r = frequency / self.natural_frequency;
        1.0 / (Complex::new(1.0 - r * r, 2.0 * self.damping_ratio * r) * self.stiffness)
    }

    /// Rate of the free vibration (1/s): `−zeta w + i w sqrt(1 − zeta²)`.
    pub(crate) fn pole(&self) -> Complex<f64> {
        let (w, zeta) = (self.angular_frequency(), self.damping_ratio);
        Complex::new(-zeta, (1.0 - zeta * zeta).sqrt()) * w
    }

    /// `direction` at unit length.
    pub(crate) fn unit(&self) -> [f64; 2] {
        let length = self.direction[0].hypot(self.direction[1]);
        self.direction.map(|d| d / length)
    }

    /// The mode with given ways in for the force and out for the displacement.
    pub(crate) fn modal(&self, input: [f64; 2], output: [f64; 2]) -> crate::response::Modal {
        crate::response::Modal {
            frequency: self.angular_frequency(),
            damping_ratio: self.damping_ratio,
            stiffness: self.stiffness,
            output,
            input,
        }
    }

    pub(crate) fn check(&self) -> Result<(), ChatterError> {
        positive("natural_frequency", self.natural_frequency)?;
        positive("stiffness", self.stiffness)?;
        finite("damping_ratio", self.damping_ratio)?;
        if self.damping_ratio <= 0.0 {
            return Err(ChatterError::UnstableStructure { damping_ratio: self.damping_ratio });
        }
        if self.damping_ratio >= 1.0 {
            let (value, min, max) = (self.damping_ratio, 0.0, 1.0);
            return Err(ChatterError::OutOfRange { quantity: "damping_ratio", value, min, max });
        }
        positive("length of direction", finite("direction", self.direction[0].hypot(self.direction[1]))?)?;
        Ok(())
    }
}

/// Every mode is one, and there is one.
pub(crate) fn check_modes(modes: &[Mode]) -> Result<(), ChatterError> {
    if modes.is_empty() {
        return Err(ChatterError::NoModes);
    }
    modes.iter().try_for_each(Mode::check)
}

/// Rate (1/s) of the free vibration that decays last: without cutting it is the rightmost root.
pub(crate) fn last_to_decay<'a>(modes: impl IntoIterator<Item = &'a Mode>) -> Complex<f64> {
    let rates = modes.into_iter().map(Mode::pole);
    rates.max_by(|a, b| a.re.total_cmp(&b.re)).unwrap_or(Complex::new(f64::NEG_INFINITY, 0.0))
}
