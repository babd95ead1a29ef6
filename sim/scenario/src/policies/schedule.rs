//! Speed against the path that the edge has cut: adaptive without sensors.

use super::{BelievedModel, Conditions, Observation};
use toolroom_wear::SpeedSchedule;

/// Entries of a table.
const ENTRIES: usize = 60;

/// Tabulates the speed of least wear on the believed model, times `factor`.
pub(super) fn tabulate(believed: &BelievedModel, factor: f64) -> SpeedSchedule {
    let pair = &believed.pair;
    let speed = |flank_wear: f64| {
        let least_wear = factor * pair.minimum_wear_speed(&believed.cut, flank_wear);
        pair.limits.clip(least_wear).min(believed.safe_speed(|_| flank_wear))
    };
    SpeedSchedule::tabulate(pair, speed, &believed.cut, ENTRIES)
}

/// Speed at the path of the edge now and after the pass.
pub(super) fn conditions(schedule: &SpeedSchedule, observation: &Observation<'_>) -> Conditions {
    Conditions::ramp(
        schedule.speed_at(observation.edge_path),
        schedule.speed_at(observation.edge_path + observation.path),
    )
}
