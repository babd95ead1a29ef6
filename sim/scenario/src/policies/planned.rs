//! Rules that plan each pass on the believed model at the wear known: the paper's mode 1 and its
//! literal form, the productivity rule, and what they would do if they knew more.

use super::{BelievedModel, Conditions, Observation};
use toolroom_wear::{Cut, SpeedLaw, SpeedTable, ramp_limits};

/// One law for all passes.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Planned {
    pub law: SpeedLaw,
    /// Factor on the speed of the law.
    pub factor: f64,
    /// Its speed for nominal edges.
    table: SpeedTable,
}

impl Planned {
    pub fn new(believed: &BelievedModel, law: SpeedLaw, factor: f64) -> Self {
        let speed = |flank_wear: f64| believed.pair.law_speed(&believed.cut, law, factor, flank_wear);
        Self { law, factor, table: SpeedTable::tabulate(believed.pair.limits.wear_limit, speed) }
    }

    pub fn conditions(&self, believed: &BelievedModel, observation: &Observation<'_>) -> Conditions {
        if observation.true_edge.is_none() {
            return plan(believed, observation, |_, flank_wear| (self.table.speed_at(flank_wear), true));
        }
        plan(believed, observation, |cut, flank_wear| {
            (believed.pair.law_speed(cut, self.law, self.factor, flank_wear), true)
        })
    }
}

/// Plans one pass at the wear known; an edge of which nothing is known counts as new. A new edge
/// starts within one step of the programmed speed: the speed of least wear of a perfectly sharp
/// edge is far above it, and an edge of more than average wear would not survive it.
///
/// `speed_at` gives the speed (m/s) for the cut as this edge meets it and a flank wear (m), and whether it meets the demand.
pub(super) fn plan(
    believed: &BelievedModel,
    observation: &Observation<'_>,
    speed_at: impl Fn(&Cut, f64) -> (f64, bool),
) -> Conditions {
    let pair = &believed.pair;
    let cut = observation.cut(&believed.cut);
    let flank_wear = observation.flank_wear().unwrap_or(0.0);
    let last_speed = Some(observation.last_speed.unwrap_or(cut.cutting_speed));
    let law = |flank_wear: f64| speed_at(&cut, flank_wear);
    let plan = pair.plan_pass_along(&cut, flank_wear, observation.path, &ramp_limits(pair), last_speed, law);
    Conditions::ramp(plan.start_speed, plan.end_speed)
}
