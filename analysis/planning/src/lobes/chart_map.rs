//! Quantities over a chart.

use toolroom_chatter::ChatterError;
use toolroom_form::vocabulary;

vocabulary! {
    /// A quantity that can be shown over the chart.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum MapKind {
        /// `1 − depth/limit`.
        Margin = "margin",
        /// Probability of stability under uncertain constants.
        PStable = "p_stable",
        /// Error of the surface location of a stable cut.
        Sle = "sle",
        /// Roughness Ra of the wall of a stable cut.
        Ra = "ra",
        /// Greatest resultant force of a stable cut.
        Force = "force",
        /// Mean torque at the spindle.
        Torque = "torque",
        /// Mean power at the spindle.
        Power = "power",
        /// Material removed per time.
        Mrr = "mrr",
    }
}

impl MapKind {
    /// Words and unit for an axis, and what an SI value is multiplied by.
    pub(super) fn quantity(self) -> (&'static str, &'static str, f64) {
        match self {
            Self::Margin => ("Margin, 1 − depth/limit", "", 1.0),
            Self::PStable => ("Probability of stability", "", 1.0),
            Self::Sle => ("Surface location error", "um", 1e6),
            Self::Ra => ("Roughness Ra of the wall", "um", 1e6),
            Self::Force => ("Greatest force", "N", 1.0),
            Self::Torque => ("Mean torque", "N m", 1.0),
            Self::Power => ("Mean power", "kW", 1e-3),
            Self::Mrr => ("Removal rate", "cm3/min", 6e7),
        }
    }

    /// Name of its column, with the unit.
    pub fn column(self) -> String {
        let unit = self.quantity().1;
        if unit.is_empty() { self.word().to_owned() } else { format!("{} [{unit}]", self.word()) }
    }

    /// What a point without a value is called.
    pub(super) fn missing(self) -> &'static str {
        match self {
            Self::Margin => "no limit on the chart",
            Self::Sle | Self::Ra | Self::Force => "unstable",
            Self::PStable | Self::Torque | Self::Power | Self::Mrr => "no value",
        }
    }

    pub(super) fn needs_feed(self) -> bool {
        match self {
            Self::Margin | Self::PStable => false,
            Self::Sle | Self::Ra | Self::Force | Self::Torque | Self::Power | Self::Mrr => true,
        }
    }
}

/// Why a map cannot be drawn.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MapError {
    /// The cut has no such quantity.
    #[error("a map of {map} is drawn of {of}")]
    Process {
        /// The map.
        map: &'static str,
        /// Of what it is drawn.
        of: &'static str,
    },
    /// Loads need a feed.
    #[error("a map of {map} needs the feed: {key}")]
    NoFeed {
        /// The map.
        map: &'static str,
        /// The key that is missing.
        key: &'static str,
    },
    /// The model refused a value.
    #[error(transparent)]
    Refused(#[from] ChatterError),
}

/// A quantity over the chart.
#[derive(Clone, Debug)]
pub struct ChartMap {
    /// What is shown.
    pub kind: MapKind,
    /// Spindle speeds (rad/s).
    pub speeds: Vec<f64>,
    /// Depths (m).
    pub depths: Vec<f64>,
    /// Values, all depths of the first speed first, in the unit that is shown; not a number where there is none.
    pub values: Vec<f64>,
}
