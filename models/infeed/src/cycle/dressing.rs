//! After how many parts to dress.

use super::CycleLimits;
use super::design::{CycleError, depth_at_temperature};
use crate::{Infeed, Input, State};
use toolroom_process::{ModelError, Record};

/// Parts between dressings at which a part takes the least time on average.
#[derive(Clone, Debug, PartialEq)]
pub struct DressingInterval {
    /// Parts.
    pub parts: u32,
    /// Mean time of a part with its share of the dressing, s.
    pub time_per_part: f64,
    /// Mean time of a part for 1, 2, … parts between dressings, s.
    pub course: Vec<f64>,
    /// Cycle time of the 1st, 2nd, … part, s.
    pub cycle_times: Vec<f64>,
}

/// The dressing interval of least mean time, `(dressing_time + Σ cycle_time)/parts`.
///
/// `cycle_time` tells the cycle of a part on a wheel that has removed so much volume per width;
/// each part adds `volume_per_part`. Where a part cannot be ground any more, the intervals end.
///
/// # Errors
/// That of `cycle_time` on the dressed wheel; [`ModelError::OutOfRange`] for no parts at all.
///
/// ```
/// use toolroom_infeed::{CycleError, dressing_interval};
/// let blunter = |volume: f64| Ok::<_, CycleError>(5.0 * (1.0 + volume));
/// assert_eq!(dressing_interval(blunter, 0.1, 25.0, 100).unwrap().parts, 10);
/// ```
pub fn dressing_interval(
    mut cycle_time: impl FnMut(f64) -> Result<f64, CycleError>,
    volume_per_part: f64,
    dressing_time: f64,
    most_parts: u32,
) -> Result<DressingInterval, CycleError> {
    let mut sum = dressing_time;
    let (mut course, mut cycle_times) = (Vec::new(), Vec::new());
    for part in 0..most_parts {
        let time = match cycle_time(f64::from(part) * volume_per_part) {
            Ok(time) => time,
            Err(error) if part == 0 => return Err(error),
            Err(_) => break,
        };
        sum += time;
        cycle_times.push(time);
        course.push(sum / f64::from(part + 1));
    }
    let best = (1..).zip(&course).min_by(|a, b| a.1.total_cmp(b.1));
    let Some((parts, time_per_part)) = best.map(|(parts, time)| (parts, *time)) else {
        let reason = "at least one part must be allowed between dressings";
        return Err(ModelError::NoSolution { quantity: "dressing interval", reason }.into());
    };
    Ok(DressingInterval { parts, time_per_part, course, cycle_times })
}

/// Duration of a cycle with broken numbers of revolutions, s, for comparisons:
/// `T ((Z − Z_f)/h_rough + Z_f/S_f + ln(h_last/S_f)/ln K)`, where the finish infeed `S_f` is the
/// finish depth limit, at most `finish_infeed`.
///
/// # Errors
/// [`CycleError::TooHotAtAnyDepth`].
pub fn cycle_time_estimate(
    grinding: &Infeed,
    wheel: &State,
    input: &Input,
    limits: &CycleLimits,
    finish_infeed: f64,
) -> Result<f64, CycleError> {
    input.check()?;
    limits.check()?;
    let depth = |limit: &'static str, allowed: f64| {
        depth_at_temperature(grinding, wheel, input, allowed, limits.greatest_infeed)
            .map_err(|least| CycleError::TooHotAtAnyDepth { limit, allowed, least })
    };
    let rough = depth("rough_temperature_rise", limits.rough_temperature_rise)?;
    let finish = depth("finish_temperature_rise", limits.finish_temperature_rise)?.min(finish_infeed);
    let lag = grinding.output_in_cut(wheel, input).lag;
    let spark_out = ((limits.last_depth / finish).ln() / lag.ln()).max(0.0);
    let revolutions = (limits.stock - limits.finish_stock).max(0.0) / rough + limits.finish_stock / finish + spark_out;
    Ok(revolutions * std::f64::consts::TAU / input.work_rotation_speed)
}
