//! Corrections of channels that need no simulation.

use super::Role;

/// A correction `deviation · x · feature` of one channel (of its logarithm, or relative), needing
/// no simulation; x counts in prior standard deviations.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// Name.
    pub name: String,
    /// Channels that it moves.
    pub channels: Vec<usize>,
    /// One number a row.
    pub feature: Vec<f64>,
    /// Prior standard deviation.
    pub deviation: f64,
    /// What it stands for.
    pub role: Role,
    /// Whether the feature is in SI units of the channel instead of relative to its value.
    pub absolute: bool,
}
