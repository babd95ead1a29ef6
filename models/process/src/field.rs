//! What is known about one number: name, units, range, meaning.

use crate::{ModelError, unit};

/// How a field's number is to be read; in memory every field is an `f64`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A physical quantity or a ratio.
    Real,
    /// 0 is false, 1 is true.
    Boolean,
    /// A whole number.
    Integer,
}

/// The description of one quantity, from which rustdoc, scenario keys, table headers, FMI
/// variables and diagnosis channels are all made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Field {
    /// The standard term, the same in code, files and FMU (`cutting_speed`).
    pub name: &'static str,
    /// SI unit of the value in memory; `1` for a ratio.
    pub unit: &'static str,
    /// Unit of tables and files that people read (`m/min`, `mm`, `um`).
    pub display: &'static str,
    /// How the number is to be read.
    pub kind: Kind,
    /// Number of elements: 1 for a scalar, more for a ring or a profile.
    pub len: usize,
    /// Default value, SI.
    pub start: f64,
    /// Least admissible value, SI.
    pub min: f64,
    /// Greatest admissible value, SI.
    pub max: f64,
    /// Meaning, symbol and source.
    pub doc: &'static str,
}

impl Field {
    /// The SI `value` in the field's display unit.
    ///
    /// ```
    /// use toolroom_process::{Record, record};
    /// record! {
    ///     /// A cut.
    ///     pub struct Cut {
    ///         /// Cutting speed.
    ///         cutting_speed: Real["m/s" => "m/min"] = 1.0, 0.0..=50.0;
    ///     }
    /// }
    /// assert_eq!(Cut::<f64>::FIELDS[0].to_display(0.5), 30.0);
    /// ```
    pub fn to_display(&self, value: f64) -> f64 {
        unit::convert(value, self.unit, self.display)
    }

    /// The display-unit `value` in SI.
    pub fn from_display(&self, value: f64) -> f64 {
        unit::convert(value, self.display, self.unit)
    }

    /// Table header, `name [display unit]`; the bare name for a ratio, a count or a flag.
    pub fn header(&self) -> String {
        if self.display == "1" { self.name.to_owned() } else { format!("{} [{}]", self.name, self.display) }
    }

    /// Whether `value` (SI) may stand in this field.
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`] where it is not finite or outside `min..=max`.
    pub fn check(&self, value: f64) -> Result<(), ModelError> {
        if value >= self.min && value <= self.max {
            return Ok(());
        }
        Err(ModelError::OutOfRange {
            field: self.name,
            value: self.to_display(value),
            min: without_rounding_error(self.to_display(self.min)),
            max: without_rounding_error(self.to_display(self.max)),
            unit: self.display,
        })
    }
}

/// A bound as it was meant: 0.36 per hour, not 0.36000000000000004.
fn without_rounding_error(bound: f64) -> f64 {
    format!("{bound:.12e}").parse().unwrap_or(bound)
}
