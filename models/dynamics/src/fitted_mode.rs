//! A fitted mode with its uncertainty.

/// A value with its standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// Its standard deviation.
    pub sd: f64,
}

/// A mode with its uncertainty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FittedMode {
    /// Direction of the motion at the point of cut, of unit length.
    pub direction: [f64; 2],
    /// Standard deviation of the direction (rad), of a measurement in both directions.
    pub direction_sd: Option<f64>,
    /// Undamped natural frequency (Hz).
    pub natural_frequency: Estimate,
    /// Share of critical damping.
    pub damping_ratio: Estimate,
    /// Modal stiffness at the point of cut (N/m).
    pub stiffness: Estimate,
}
