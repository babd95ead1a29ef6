//! Rules that plan each pass on the believed model at the wear known: the paper's mode 1 and its
//! literal form, the productivity rule, and the oracle.

use super::{Believed, Conditions, Observation};
use toolroom_wear::{Pair, RampLimits, SpeedTable};

/// Greatest change of speed from pass to pass, share of the pair's reference speed.
/// Postnov & Shafikov restrict it; the size is an assumption.
const LARGEST_STEP: f64 = 0.15;
/// Greatest acceleration within a pass, share of the pair's reference speed per second:
/// 20 m/min per minute at 40 m/min (assumption).
const LARGEST_ACCELERATION: f64 = 0.5 / 60.0;

/// One law for all passes.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Planned {
    /// Speed against flank wear on the believed model.
    pub law: SpeedTable,
}

impl Planned {
    pub fn conditions(&self, believed: &Believed, seen: &Observation<'_>) -> Conditions {
        plan(believed, seen, |flank_wear| (self.law.speed_at(flank_wear), true))
    }
}

/// Plans one pass at the wear known; an edge of which nothing is known counts as new. A new edge
/// starts within one step of the programmed speed: the speed of least wear of a perfectly sharp
/// edge is far above it, and an edge of more than average wear would not survive it.
pub(super) fn plan(believed: &Believed, seen: &Observation<'_>, speed_at: impl Fn(f64) -> (f64, bool)) -> Conditions {
    let Believed { pair, cut, .. } = believed;
    let flank_wear = seen.flank_wear().unwrap_or(0.0);
    let last_speed = Some(seen.last_speed.unwrap_or(cut.cutting_speed));
    let plan = pair.plan_pass_along(cut, flank_wear, seen.path, &ramp_limits(pair), last_speed, speed_at);
    Conditions::ramp(plan.start_speed, plan.end_speed)
}

/// How fast a policy may change the speed of a pair, in passes of shops and of tool-life studies alike.
pub fn ramp_limits(pair: &Pair) -> RampLimits {
    let reference = pair.limits.reference_speed;
    RampLimits { largest_acceleration: LARGEST_ACCELERATION * reference, largest_step: LARGEST_STEP * reference }
}
