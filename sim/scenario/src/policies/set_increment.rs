//! The paper's mode 2: the edge is to last for a set path.

use super::planned::plan;
use super::{BelievedModel, Conditions, Observation};

/// The wear left is shared out evenly over the path left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SetIncrement {
    /// Cutting path over the life of an edge, m.
    pub path_per_edge: f64,
    /// Factor on the speed.
    pub factor: f64,
}

impl SetIncrement {
    pub fn conditions(&self, believed: &BelievedModel, observation: &Observation<'_>) -> Conditions {
        let wear_left = (believed.pair.limits.wear_limit - observation.flank_wear().unwrap_or(0.0)).max(0.0);
        let path_left = (self.path_per_edge - observation.edge_path).max(observation.path);
        let pair = &believed.pair;
        plan(believed, observation, |cut, flank_wear| {
            pair.intensity_speed(cut, flank_wear, wear_left / path_left, self.factor)
        })
    }
}
