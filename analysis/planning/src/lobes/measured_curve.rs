//! Limits of a measured response over the speeds of a chart.

/// Limits of the measured response over the speeds of a chart.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredCurve {
    /// Spindle speed (rad/s) and least unstable depth (m) up to that of the chart; not a number where there is none.
    pub limits: Vec<(f64, f64)>,
    /// Limit of the modes over that of the measured response, less one: greatest of either sign, and its speed (rad/s).
    pub greatest: Option<(f64, f64)>,
    /// Median of the magnitude of these differences.
    pub median: Option<f64>,
}
