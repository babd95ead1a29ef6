//! Spindle-speed variation.

use crate::error::{ChatterError, within};
use std::f64::consts::TAU;

/// Sinusoidal variation of the spindle speed:
/// `Omega(t) = Omega0 (1 + RVA cos(RVF Omega0 t))`.
///
/// | symbol | field | unit | range |
/// |---|---|---|---|
/// | RVA | `amplitude` | 1 | 0 … 0.9 |
/// | 1/RVF | `revolutions` | 1 | 2 … 200 |
///
/// The modulation lasts a whole number of mean revolutions, so that cut and speed repeat together;
/// RVF 0.2 is 5 revolutions.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct SpeedVariation {
    /// Ratio of amplitude to mean speed (RVA).
    pub amplitude: f64,
    /// Mean revolutions in one period of the variation (1/RVF).
    pub revolutions: u32,
}

impl SpeedVariation {
    pub(crate) fn check(&self) -> Result<(), ChatterError> {
        within("amplitude", self.amplitude, 0.0, 0.9)?;
        within("revolutions", f64::from(self.revolutions), 2.0, 200.0)?;
        Ok(())
    }

    /// Angle turned at `time` from mean `speed`.
    pub(crate) fn angle_at(&self, speed: f64, time: f64) -> f64 {
        let revolutions = f64::from(self.revolutions);
        let phase = speed * time / revolutions;
        speed * time + self.amplitude * revolutions * phase.sin()
    }

    /// Speed at `time`.
    pub(crate) fn speed_at(&self, speed: f64, time: f64) -> f64 {
        speed * (1.0 + self.amplitude * (speed * time / f64::from(self.revolutions)).cos())
    }

    /// Time at which `angle` has been turned; Newton's method on a monotone function.
    pub(crate) fn time_at(&self, speed: f64, angle: f64) -> f64 {
        let period = TAU * f64::from(self.revolutions);
        let whole = (angle / period).floor();
        let rest = angle - whole * period;
        let mut time = rest / speed;
        for _ in 0..60 {
            let step = (self.angle_at(speed, time) - rest) / self.speed_at(speed, time);
            time -= step;
            if step.abs() <= 1e-16 * period / speed {
                break;
            }
        }
        time + whole * period / speed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_inverts_angle() {
        let variation = SpeedVariation { amplitude: 0.3, revolutions: 5 };
        for step in 0..100 {
            let time = 0.01 * f64::from(step);
            let angle = variation.angle_at(157.0, time);
            assert!((variation.time_at(157.0, angle) - time).abs() < 1e-13);
        }
    }
}
