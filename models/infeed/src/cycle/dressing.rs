//! After how many parts to dress.

use super::caps::{depth_at_loads, depth_at_temperature};
use super::{CycleError, CycleLimits};
use crate::{Infeed, Input, State};
use toolroom_process::{ModelError, Record, record};

record! {
    /// How the wheel is dressed.
    ///
    /// # Source
    /// Assumption.
    pub struct DressingPlan {
        /// Time that a dressing takes.
        dressing_time: Real["s" => "s"] = 90.0, 0.0..=1e5;
        /// Most parts between dressings that are considered.
        most_parts: Integer = 500.0, 1.0..=1e5;
        /// Greatest finish infeed of the estimate.
        finish_infeed: Real["m" => "um"] = 1e-6, 1e-9..=1e-3;
        /// Lead of the dresser per revolution of the wheel, s_d.
        lead: Real["m" => "mm"] = 0.1e-3, 1e-7..=1e-2;
        /// Depth of a pass of the dresser, a_d.
        depth: Real["m" => "um"] = 20e-6, 1e-8..=1e-3;
        /// Width of the tip of the dresser that cuts, b_d.
        tip_width: Real["m" => "mm"] = 0.5e-3, 1e-7..=1e-1;
        /// Passes of a dressing.
        passes: Integer = 1.0, 1.0..=1e3;
        /// Diameter at which the wheel is replaced; 0 where nothing is asked about that.
        least_wheel_diameter: Real["m" => "mm"] = 0.0, 0.0..=3.0;
    }
}

/// Overlaps between which a dressing counts as usual (Malkin, Grinding Technology, recalled).
const USUAL_OVERLAP: std::ops::RangeInclusive<f64> = 2.0..=10.0;

impl DressingPlan {
    /// How often the dresser goes over each place, U = b_d/s_d.
    ///
    /// ```
    /// let plan = toolroom_infeed::DressingPlan::default(); // 0.5 mm over 0.1 mm
    /// assert!((plan.overlap() - 5.0f64).abs() < 1e-12);
    /// ```
    pub fn overlap(&self) -> f64 {
        self.tip_width / self.lead
    }

    /// What is unusual about the overlap: a thread is left on the wheel, or the wheel is blunted.
    pub fn warning(&self) -> Option<String> {
        let overlap = self.overlap();
        if USUAL_OVERLAP.contains(&overlap) {
            return None;
        }
        let what = if overlap < *USUAL_OVERLAP.start() {
            "the dresser leaves a thread on the wheel: choose a smaller lead"
        } else {
            "the dresser blunts the wheel: choose a greater lead"
        };
        let (from, to) = (USUAL_OVERLAP.start(), USUAL_OVERLAP.end());
        Some(format!("the overlap tip_width/lead is {overlap:.2}, usual is {from} to {to}; {what}"))
    }

    /// What a wheel of `grinding` is good for with `parts` of `stock` (m of radius) between dressings; none where
    /// `least_wheel_diameter` asks for nothing or is not below the diameter of the wheel.
    ///
    /// A dressing takes the depth of its passes off the radius, beside what the parts have worn.
    pub fn wheel_life(&self, grinding: &Infeed, parts: u32, stock: f64) -> Option<WheelLife> {
        let p = &grinding.parameters;
        let radius = 0.5 * (p.wheel_diameter - self.least_wheel_diameter);
        if self.least_wheel_diameter <= 0.0 || radius <= 0.0 {
            return None;
        }
        let worn = p.wheel_wear_ratio * p.work_diameter / p.wheel_diameter * stock * f64::from(parts);
        let lost = self.depth * self.passes + worn;
        let dressings = (radius / lost * (1.0 + 1e-12)).floor();
        let last = grinding.with_worn_wheel(lost * dressings);
        Some(WheelLife {
            lost,
            dressings,
            parts: dressings * f64::from(parts),
            diameter: last.parameters.wheel_diameter,
            wheel_speed: last.parameters.wheel_speed,
        })
    }
}

/// What a wheel is good for until it is too small.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WheelLife {
    /// Radius lost by a dressing and by the parts before it, m.
    pub lost: f64,
    /// Dressings until the wheel is replaced.
    pub dressings: f64,
    /// Parts that are ground with it.
    pub parts: f64,
    /// Diameter after the last dressing, m.
    pub diameter: f64,
    /// Wheel speed at that diameter, m/s: the wheel rotates as before.
    pub wheel_speed: f64,
}

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
    cycle_time: impl FnMut(f64) -> Result<f64, CycleError>,
    volume_per_part: f64,
    dressing_time: f64,
    most_parts: u32,
) -> Result<DressingInterval, CycleError> {
    interval(cycle_time, volume_per_part, dressing_time, most_parts, true)
}

/// [`dressing_interval`]; unless it shall be `whole`, the course ends some way behind the best interval.
pub(super) fn interval(
    mut cycle_time: impl FnMut(f64) -> Result<f64, CycleError>,
    volume_per_part: f64,
    dressing_time: f64,
    most_parts: u32,
    whole: bool,
) -> Result<DressingInterval, CycleError> {
    let mut sum = dressing_time;
    let (mut course, mut cycle_times) = (Vec::new(), Vec::new());
    let mut least = (0, f64::INFINITY);
    for part in 0..most_parts {
        if !whole && part > 2 * least.0 + 20 {
            break;
        }
        let time = match cycle_time(f64::from(part) * volume_per_part) {
            Ok(time) => time,
            Err(error) if part == 0 => return Err(error),
            Err(_) => break,
        };
        sum += time;
        cycle_times.push(time);
        let mean = sum / f64::from(part + 1);
        if mean < least.1 {
            least = (part, mean);
        }
        course.push(mean);
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
    let (loads, _) = depth_at_loads(grinding, wheel, input, limits)?;
    let rough = depth("rough_temperature_rise", limits.rough_temperature_rise)?.min(loads);
    let finish = depth("finish_temperature_rise", limits.finish_temperature_rise)?.min(finish_infeed).min(loads);
    let lag = grinding.output_in_cut(wheel, input).lag;
    let spark_out = ((limits.last_depth / finish).ln() / lag.ln()).max(0.0);
    let revolutions = (limits.stock - limits.finish_stock).max(0.0) / rough + limits.finish_stock / finish + spark_out;
    Ok(revolutions * std::f64::consts::TAU / input.work_rotation_speed)
}
