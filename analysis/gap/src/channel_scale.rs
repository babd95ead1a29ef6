//! What is much of a channel: its level, and what a single reading of it shows.

use super::constants::{MATTERING_SENSORS, MATTERING_SHARE};
use super::{Measured, Noise, Transform};

/// Level and sensor of a channel, both in the unit in which its residuals are compared.
#[derive(Clone, Copy, Debug)]
pub(super) struct ChannelScale {
    /// Middle of its predictions; 1 where logarithms are compared.
    pub level: f64,
    /// Middle standard deviation of a single reading.
    pub sensor: f64,
}

impl ChannelScale {
    /// Of the observations `places` (at least one) of a `channel`, whose predictions are among `raw`.
    pub fn new(measured: &Measured, noise: &Noise, raw: &[f64], channel: usize, places: &[usize]) -> Self {
        let median = |value: &dyn Fn(usize) -> f64| {
            toolroom_statistics::median(&mut places.iter().map(|i| value(*i)).collect::<Vec<f64>>())
        };
        let relative = measured.channels[channel].transform == Transform::Log;
        Self {
            level: if relative { 1.0 } else { median(&|i| raw[i].abs()) },
            // A noise that was read off the records is what a single reading shows.
            sensor: median(&|i| measured.observations[i].deviation) * noise.scale[channel],
        }
    }

    /// Whether a deviation of this size matters.
    pub fn matters(self, size: f64) -> bool {
        size > (MATTERING_SHARE * self.level).max(MATTERING_SENSORS * self.sensor)
    }
}
