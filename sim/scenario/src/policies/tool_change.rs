//! When an edge is changed between passes.

use super::{BelievedModel, Conditions, Controller, Observation, Observer};
use toolroom_wear::Cut;

/// A tool change rule with its limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ChangeRule {
    /// When the flank wear read after a pass reaches this, m.
    WearLimit(f64),
    /// After so many parts.
    PartCount(u32),
    /// Before the cutting time passes this, s.
    CuttingTime(f64),
    /// Before the next pass brings the estimated wear past this, m.
    Predicted(f64),
}

impl Controller {
    /// Whether the edge is changed before the pass that was just planned and takes `duration`
    /// seconds. [`ChangeRule::WearLimit`] is decided by the reading after a pass.
    pub fn change_due(&self, observation: &Observation<'_>, planned: &Conditions, duration: f64) -> bool {
        match self.change {
            ChangeRule::WearLimit(_) => false,
            ChangeRule::PartCount(parts) => observation.edge_parts >= parts,
            ChangeRule::CuttingTime(time) => observation.edge_time + duration > time,
            ChangeRule::Predicted(limit) => {
                let (Some(believed), Some(flank_wear)) = (&self.believed, observation.flank_wear()) else {
                    return false;
                };
                let factor = observation.observer.map_or(1.0, Observer::wear_factor);
                wear_after(believed, &observation.cut(&believed.cut), flank_wear, factor, observation.path, planned)
                    > limit
            }
        }
    }
}

/// Flank wear after a planned pass of `cut` on the believed model, m; `factor` is that of the edge.
pub(super) fn wear_after(
    believed: &BelievedModel,
    cut: &Cut,
    flank_wear: f64,
    factor: f64,
    path: f64,
    planned: &Conditions,
) -> f64 {
    // Layers follow one another at the same speeds.
    let path = path * f64::from(planned.layers);
    believed.pair.wear_after_pass(cut, flank_wear, factor, path, (planned.start_speed, planned.end_speed))
}
