//! Spindle-speed variation.

use crate::error::{ChatterError, finite, within};
use std::f64::consts::TAU;

/// Sinusoidal variation of the spindle speed:
/// `Omega(t) = Omega0 (1 + RVA cos(RVF Omega0 t))`.
///
/// | symbol | field | unit | range |
/// |---|---|---|---|
/// | RVA | `amplitude` | 1 | 0 … 0.9 |
/// | 1/RVF | `revolutions` | 1 | 2 … 200 |
/// | psi | `phase` | rad | any, or none |
///
/// In milling it matters which part of the cut meets the greatest speed: `phase` is the angle of tooth 0, from the normal
/// of the feed, at that moment. Without one the worst phase counts. Turning does not depend on it. The modulation lasts a whole number of mean revolutions, so that cut and speed repeat together;
/// RVF 0.2 is 5 revolutions.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct SpeedVariation {
    /// Ratio of amplitude to mean speed (RVA).
    pub amplitude: f64,
    /// Mean revolutions in one period of the variation (1/RVF).
    pub revolutions: u32,
    /// Angle of tooth 0 where the speed is greatest (rad), of milling; none: the worst of all.
    #[serde(default)]
    pub phase: Option<f64>,
}

/// Greatest number of oscillations of the fastest mode in a period of the variation (assumption: a search for a limit with as
/// many takes ten seconds or so).
const GREATEST_OSCILLATIONS: f64 = 1000.0;
/// The same where the worst phase is searched, which asks for some hundred multipliers more (assumption: as long in all).
const GREATEST_WITH_PHASES: f64 = 500.0;

impl SpeedVariation {
    /// Refuses a variation about `spindle_speed` (rad/s) in whose period the fastest of `modes` swings too often; where the
    /// phase `counts` and is not given, all have to be tried.
    pub(crate) fn check_oscillations(
        &self,
        modes: &[crate::Mode],
        spindle_speed: f64,
        counts: bool,
    ) -> Result<(), ChatterError> {
        let fastest = modes.iter().map(|mode| mode.natural_frequency).fold(0.0, f64::max);
        let at_one_rpm = fastest * 60.0 * f64::from(self.revolutions);
        let rpm = spindle_speed / TAU * 60.0;
        let waves = at_one_rpm / rpm;
        let greatest = if counts && self.phase.is_none() { GREATEST_WITH_PHASES } else { GREATEST_OSCILLATIONS };
        if waves > greatest {
            return Err(ChatterError::TooManyOscillations { waves, greatest, least_rpm: at_one_rpm / greatest });
        }
        Ok(())
    }

    pub(crate) fn check(&self) -> Result<(), ChatterError> {
        within("amplitude", self.amplitude, 0.0, 0.9)?;
        within("revolutions", f64::from(self.revolutions), 2.0, 200.0)?;
        if let Some(phase) = self.phase {
            finite("phase", phase)?;
        }
        Ok(())
    }

    /// Angle turned at `time` from mean `speed`, both from the greatest speed on.
    fn angle_at(&self, speed: f64, time: f64) -> f64 {
        let revolutions = f64::from(self.revolutions);
        let phase = speed * time / revolutions;
        speed * time + self.amplitude * revolutions * phase.sin()
    }

    /// Speed at `time` from the greatest one on.
    fn speed_at(&self, speed: f64, time: f64) -> f64 {
        speed * (1.0 + self.amplitude * (speed * time / f64::from(self.revolutions)).cos())
    }

    /// Time at which `angle` has been turned from the greatest speed on; Newton's method on a monotone function.
    fn time_at(&self, speed: f64, angle: f64) -> f64 {
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

/// A variation that is on its way as a period begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Started {
    pub variation: SpeedVariation,
    /// Angle turned since the greatest speed as the period begins (rad).
    turned: f64,
    /// Mean spindle angle that took as long (rad).
    elapsed: f64,
}

impl Started {
    /// A variation with its greatest speed `ahead` (rad) of the beginning of the period.
    pub fn new(variation: SpeedVariation, ahead: f64) -> Self {
        let turned = -ahead;
        Self { variation, turned, elapsed: variation.time_at(1.0, turned) }
    }

    /// Angle turned at `time` from mean `speed`.
    pub fn angle_at(&self, speed: f64, time: f64) -> f64 {
        self.variation.angle_at(speed, time + self.elapsed / speed) - self.turned
    }

    /// Speed at `time`.
    pub fn speed_at(&self, speed: f64, time: f64) -> f64 {
        self.variation.speed_at(speed, time + self.elapsed / speed)
    }

    /// Time at which `angle` has been turned.
    pub fn time_at(&self, speed: f64, angle: f64) -> f64 {
        self.variation.time_at(speed, angle + self.turned) - self.elapsed / speed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_inverts_angle() {
        let variation = SpeedVariation { amplitude: 0.3, revolutions: 5, phase: None };
        for ahead in [0.0, 1.0, -2.5, 40.0] {
            let started = Started::new(variation, ahead);
            for step in 0..100 {
                let time = 0.01 * f64::from(step);
                let angle = started.angle_at(157.0, time);
                assert!((started.time_at(157.0, angle) - time).abs() < 1e-13);
            }
            // The greatest speed comes after the angle that was told.
            let greatest = started.speed_at(157.0, started.time_at(157.0, ahead));
            assert!((greatest / (157.0 * 1.3) - 1.0).abs() < 1e-12, "{ahead}");
        }
    }
}
