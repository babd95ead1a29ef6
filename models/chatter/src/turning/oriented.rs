//! The structure as the cut sees it: one direction of force, one of chip thickness.

use super::Turning;
use crate::structure::Mode;
use nalgebra::Complex;

/// A mode that moves the chip thickness when the cutting force acts.
#[derive(Clone, Copy, Debug)]
pub(super) struct OrientedMode {
    /// Undamped angular frequency w (rad/s).
    pub frequency: f64,
    /// `2 zeta w` (1/s).
    pub damping: f64,
    /// Acceleration of the chip thickness by the force: share of the direction times `w²/k` (1/kg).
    pub inertance: f64,
}

impl OrientedMode {
    /// `s² + 2 zeta w s + w²`, whose zeros are the poles of the mode.
    pub fn polynomial(&self, s: Complex<f64>) -> Complex<f64> {
        s * s + self.damping * s + self.frequency * self.frequency
    }
}

/// The modes that take part, ready for many frequencies.
#[derive(Clone, Debug)]
pub(super) struct Oriented(pub Vec<OrientedMode>);

impl Oriented {
    pub fn new(cut: &Turning) -> Self {
        let oriented = |mode: &Mode| {
            let frequency = mode.angular_frequency();
            OrientedMode {
                frequency,
                damping: 2.0 * mode.damping_ratio * frequency,
                inertance: cut.orientation(mode) * frequency * frequency / mode.stiffness,
            }
        };
        Self(cut.modes.iter().map(oriented).filter(|mode| mode.inertance != 0.0).collect())
    }

    /// Oriented frequency response (m/N) at the complex rate `s` (1/s).
    pub fn response(&self, s: Complex<f64>) -> Complex<f64> {
        self.0.iter().map(|mode| mode.inertance / mode.polynomial(s)).sum()
    }
}
