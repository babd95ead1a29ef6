//! What a setting does on a section, and what a plan should be warned of.

use crate::{Engagement, Forces, Ratios};
use std::f64::consts::TAU;

/// Spindle speed and feed of a section: what a plan chooses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// Spindle speed, rad/s.
    pub spindle_speed: f64,
    /// Feed per tooth, m.
    pub feed_per_tooth: f64,
}

impl Setting {
    /// Feed of the cutter centre, m/s.
    pub fn feed(&self, teeth: f64) -> f64 {
        self.spindle_speed / TAU * self.feed_per_tooth * teeth
    }
}

/// What a setting does on a section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evaluation {
    /// Feed of the cutter centre, m/s.
    pub feed: f64,
    /// Cutting speed, m/s.
    pub cutting_speed: f64,
    /// Engagement with the stock.
    pub engagement: Engagement,
    /// Forces averaged over a revolution.
    pub forces: Forces,
    /// Cutting power, W.
    pub power: f64,
    /// Deflection of the cutter off the wall as the accuracy constraint sees it, m.
    pub deflection: f64,
    /// Error of the drives, m, positive where material is left.
    pub path_error: f64,
    /// Roughness Rz, m.
    pub roughness: f64,
    /// Tool life, s.
    pub tool_life: f64,
    /// Every constraint's value over its limit.
    pub ratios: Ratios,
}

impl Evaluation {
    /// Signed error of the wall, m, positive where material is left: deflection and path error
    /// with their directions. The accuracy constraint adds their magnitudes.
    pub fn wall_error(&self) -> f64 {
        self.deflection + self.path_error
    }
}

/// What a plan should be warned of.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Warning {
    /// The path error is one of the calculation.
    #[error("the path error is the truncation error of explicit Euler at {:.3} ms: halving the step halves it; no machine behaves so", step * 1e3)]
    ExplicitEuler {
        /// Time step, s.
        step: f64,
    },
    /// The path error is empirical.
    #[error("the empirical path error has the size of a truncation error; the servo law is the physical one")]
    EmpiricalPathError,
    /// A cutter outside the recommended range.
    #[error("cutter radius over smallest concave radius is {ratio:.3}; 0.70 to 0.75 is recommended")]
    CutterRadius {
        /// Cutter radius over smallest concave radius.
        ratio: f64,
    },
    /// The average force hides the form over the height.
    #[error("the average force hides the form over the height, up to {:.1} um more on this contour", excess * 1e6)]
    MeanForce {
        /// Greatest additional error, m, at the plan's settings.
        excess: f64,
    },
}
