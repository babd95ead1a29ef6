//! The point of greatest removal rate, as it was found.

use super::load::Limited;
use toolroom_chatter::{CuttingLoad, Probability, Scatter};

/// The point of greatest removal rate.
#[derive(Clone, Debug, PartialEq)]
pub struct Best {
    /// Spindle speed (rad/s).
    pub speed: f64,
    /// Depth of cut (m).
    pub depth: f64,
    /// Probability that it is stable, of samples that it was not chosen by.
    pub probability: Probability,
    /// The probability that was requested.
    pub required: f64,
    /// How well the constants are known.
    pub scatter: Scatter,
    /// Load there.
    pub load: CuttingLoad,
    /// What is left on the wall (m), of milling.
    pub surface_error: Option<f64>,
    /// What forbids a deeper cut at this speed: a limit of the file, else stability or the range of the chart.
    pub bound: Bound,
    /// First operating point of the file and its removal rate (m³/s).
    pub today: Option<(String, f64)>,
}

/// What forbids a deeper cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bound {
    /// The probability of stability.
    Stability,
    /// A limit of the file.
    Limit(Limited),
    /// The greatest depth of the chart.
    Chart,
}

impl Bound {
    /// The bound in a word.
    pub fn word(self) -> &'static str {
        match self {
            Self::Stability => "stability",
            Self::Limit(limited) => limited.word(),
            Self::Chart => "chart",
        }
    }
}
