//! Evenly spaced values of an axis of a chart.

use crate::error::{ChatterError, finite};

/// Evenly spaced values from `start` to `end`, both included.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Axis {
    /// First value.
    pub start: f64,
    /// Last value.
    pub end: f64,
    /// How many.
    pub points: usize,
}

impl Axis {
    /// The values.
    ///
    /// # Errors
    /// Fewer than two points; ends that are no numbers or do not ascend.
    ///
    /// ```
    /// use toolroom_chatter::Axis;
    /// assert_eq!(Axis { start: 0.0, end: 1.0, points: 3 }.values("depth").unwrap(), [0.0, 0.5, 1.0]);
    /// assert!(Axis { start: 0.0, end: 1.0, points: 1 }.values("depth").is_err());
    /// ```
    pub fn values(&self, quantity: &'static str) -> Result<Vec<f64>, ChatterError> {
        let (start, end) = (finite(quantity, self.start)?, finite(quantity, self.end)?);
        if self.points < 2 {
            return Err(ChatterError::TooFewPoints { quantity, points: self.points });
        }
        if start >= end {
            return Err(ChatterError::EmptyRange { quantity, start, end });
        }
        let last = (self.points - 1) as f64;
        Ok((0..self.points).map(|i| start + (end - start) * i as f64 / last).collect())
    }
}
