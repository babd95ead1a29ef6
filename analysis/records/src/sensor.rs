//! Errors of sensors, with those that the records contract takes for granted.

/// Errors of one sensor, SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensor {
    /// Standard deviation that does not depend on the value.
    pub absolute: f64,
    /// Standard deviation relative to the value.
    pub relative: f64,
    /// Least step of a reading.
    pub resolution: f64,
}

impl Sensor {
    /// Standard deviation of a reading of `value`; a step counts with its rectangular spread.
    ///
    /// ```
    /// let sensor = toolroom_records::Sensor { absolute: 3.0, relative: 0.04, resolution: 0.0 };
    /// assert_eq!(sensor.deviation(100.0), 5.0);
    /// ```
    pub fn deviation(&self, value: f64) -> f64 {
        (self.absolute * self.absolute + (self.relative * value).powi(2) + self.resolution * self.resolution / 12.0)
            .sqrt()
    }

    /// The sensor that a channel of the records usually has. The values are assumptions.
    pub fn usual(channel: &str) -> Self {
        let sensor = |absolute, relative, resolution| Self { absolute, relative, resolution };
        match channel {
            "cutting_force" | "normal_force" | "tangential_force" => sensor(0.0, 0.02, 0.0),
            "feed_force" | "passive_force" => sensor(0.0, 0.03, 0.0),
            "spindle_power" | "spindle_torque" => sensor(0.0, 0.02, 0.0),
            "force_after_spark_out" => sensor(1.0, 0.02, 0.0),
            "temperature" => sensor(3.0, 0.015, 0.0),
            "thermo_emf" => sensor(0.0, 0.015, 0.0),
            // Scatter of the rate within a life shows as a few per cent of the land.
            "flank_wear" => sensor(5e-6, 0.02, 10e-6),
            "stock_removed" => sensor(0.5e-6, 0.0, 0.0),
            "rise_revolutions" => sensor(0.1, 0.0, 0.0),
            "cycle_time" => sensor(0.5, 0.0, 0.0),
            "form_error" => sensor(0.5e-6, 0.0, 0.0),
            "roughness_ra" => sensor(0.0, 0.05, 0.0),
            // Assumption: lines of the spectrum of a second of sound.
            "chatter_frequency" => sensor(1.0, 0.0, 1.0),
            _ => sensor(0.0, 0.05, 0.0),
        }
    }
}
