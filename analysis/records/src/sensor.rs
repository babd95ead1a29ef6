//! Errors of sensors.

use super::RecordKind;

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

    /// The sensor of a channel of which nothing else is known (assumption).
    pub const ORDINARY: Self = Self { absolute: 0.0, relative: 0.05, resolution: 0.0 };

    /// The sensor that a column of the records usually has, by its name; the table of columns says it.
    pub fn usual(column: &str) -> Self {
        RecordKind::ALL.iter().find_map(|kind| kind.column(column)).map_or(Self::ORDINARY, |column| column.sensor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::RecordKind;

    #[test]
    fn a_column_has_one_sensor_in_every_kind_of_records() {
        for kind in RecordKind::ALL {
            for column in kind.columns() {
                assert_eq!(Sensor::usual(column.name), column.sensor, "{}", column.name);
            }
        }
        assert_eq!(Sensor::usual("temperature").deviation(0.0), 3.0);
        assert_eq!(Sensor::usual("no such column"), Sensor::ORDINARY);
    }
}
