//! What is much of a channel: its level, and what a single reading of it shows.

use super::constants::{MATTERING_SENSORS, MATTERING_SHARE, MATTERING_STEPS};
use super::{Measured, Noise, Transform};

/// Level and sensor of a channel, in the unit in which its residuals are compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChannelScale {
    /// Middle of its predictions; 1 where logarithms are compared.
    pub level: f64,
    /// Middle standard deviation of a single reading; of the scatter that was read off the records where nobody states it.
    pub sensor: f64,
    /// Least step of a reading; 0 where it has none.
    pub step: f64,
}

impl ChannelScale {
    /// Of the observations `places` (at least one) of a `channel`, whose predictions are among `raw`.
    pub(super) fn new(measured: &Measured, noise: &Noise, raw: &[f64], channel: usize, places: &[usize]) -> Self {
        let median = |value: &dyn Fn(usize) -> f64| {
            toolroom_statistics::median(&mut places.iter().map(|i| value(*i)).collect::<Vec<f64>>())
        };
        let relative = measured.channels[channel].transform == Transform::Log;
        let step = measured.channels[channel].sensor.resolution;
        Self {
            level: if relative { 1.0 } else { median(&|i| raw[i].abs()) },
            // A noise that was read off the records is what a single reading shows.
            sensor: median(&|i| measured.observations[i].deviation) * noise.scale[channel],
            step: if relative { step / median(&|i| raw[i].abs()) } else { step },
        }
    }

    /// Whether a deviation of this size matters.
    pub(super) fn matters(self, size: f64) -> bool {
        size > (MATTERING_SHARE * self.level).max(MATTERING_SENSORS * self.sensor).max(MATTERING_STEPS * self.step)
    }
}
