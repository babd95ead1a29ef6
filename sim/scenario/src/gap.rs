//! Priors and sensors of a gap diagnosis, as a scenario file gives them.

/// The section `[gap]`.
#[derive(Clone, Debug, PartialEq)]
pub struct GapSection {
    /// Process that is diagnosed; that of the first tool, if none.
    pub process: Option<String>,
    /// Standard deviation of the logarithm of force coefficients.
    pub force: f64,
    /// Of temperature coefficients.
    pub temperature: f64,
    /// Of the level of the wear rate.
    pub wear_level: f64,
    /// Of stiffnesses of grinding.
    pub stiffness: f64,
    /// Scale of the scatter of wear from edge to edge.
    pub edge_wear: f64,
    /// Scatter of force from edge to edge.
    pub edge_force: f64,
    /// Columns that an empirical model knows; every recorded condition, if none.
    pub conditions: Option<Vec<String>>,
    /// Channels that an empirical model answers for; all, if empty.
    pub channels: Vec<String>,
    /// Whether an empirical model wears its edges at a constant rate.
    pub constant_rate: bool,
    /// Sensors that differ from the usual sheet.
    pub sensors: Vec<SensorErrors>,
    /// Hashes of the records that the calibration of the file has seen.
    pub seen: Vec<String>,
}

/// Errors of one sensor; quantities as written, since their unit is the channel's.
#[derive(Clone, Debug, PartialEq)]
pub struct SensorErrors {
    /// Column of the records.
    pub channel: String,
    /// Standard deviation, relative.
    pub relative: f64,
    /// Standard deviation with its unit.
    pub absolute: Option<String>,
    /// Least step with its unit.
    pub resolution: Option<String>,
}
