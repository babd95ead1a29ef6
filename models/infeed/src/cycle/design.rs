//! Cycles, and the fastest of them.

use super::candidate::Task;
use super::law::Law;
use super::search::Search;
use super::surface::Roughness;
use super::{CycleError, CycleLimits, DressingPlan, Surface};
use crate::load::Load;
use crate::{Infeed, Input, State};
use toolroom_process::{ModelError, Process, Record};

/// A part of a cycle with constant infeed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CyclePhase {
    /// Infeed per revolution, m; 0 in spark-out.
    pub infeed_per_rev: f64,
    /// Revolutions.
    pub revolutions: u32,
}

/// One end of a revolution in a cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CyclePoint {
    /// Time since first contact, s.
    pub time: f64,
    /// Infeed commanded so far, m.
    pub commanded_infeed: f64,
    /// Stock removed, m.
    pub stock_removed: f64,
    /// Depth of this revolution, m.
    pub depth_of_cut: f64,
    /// Radius left above what is commanded, m.
    pub size_error: f64,
    /// Forces, power, heat and burn of this revolution.
    pub load: Load,
    /// Volume that the wheel has removed per width since dressing, m².
    pub removed_volume: f64,
    /// Share of a waviness of the part that this revolution leaves.
    pub decay: f64,
}

/// A cycle and what it leaves.
#[derive(Clone, Debug, PartialEq)]
pub struct Cycle {
    /// Rough, finish and spark-out, as far as they have revolutions.
    pub phases: Vec<CyclePhase>,
    /// Revolutions of all phases.
    pub revolutions: u32,
    /// Duration, s.
    pub time: f64,
    /// Depth of the last revolution, m.
    pub last_depth: f64,
    /// Radius left above the commanded size, m.
    pub size_error: f64,
    /// Last step and what is left of the blank's out-of-roundness, m.
    pub roundness_error: f64,
    /// Stock removed after the rough phase, m.
    pub finish_stock: f64,
    /// Greatest temperature rise, K.
    pub peak_temperature_rise: f64,
    /// Greatest power of the wheel spindle, W.
    pub peak_power: f64,
    /// Greatest normal force, N.
    pub peak_normal_force: f64,
    /// Greatest specific removal rate, m²/s.
    pub peak_removal_rate: f64,
    /// Least distance to burn by the temperature.
    pub least_burn_margin: f64,
    /// Least distance to burn by Malkin's specific energy; none where every depth is below that of the threshold force.
    pub least_energy_margin: Option<f64>,
    /// Roughness Ra at the end, m; none without a measured one.
    pub roughness: Option<f64>,
    /// Greatest depth that the limits of the rough phase allow at its start, m.
    pub rough_depth_limit: f64,
    /// Greatest depth that the limits of the finish phase allow at the start of the part, m.
    pub finish_depth_limit: f64,
    /// The cycle revolution by revolution, from first contact.
    pub course: Vec<CyclePoint>,
}

/// Runs a cycle through the process, revolution by revolution, with contact at the start.
///
/// # Errors
/// Those of [`Process::advance`].
pub fn grind_cycle(
    grinding: &Infeed,
    wheel: &State,
    input: &Input,
    phases: &[CyclePhase],
) -> Result<(State, Vec<CyclePoint>), ModelError> {
    // Contact is found anew on each part: earlier wear of the wheel does not enter its size.
    let mut part = State { wheel_wear: 0.0, ..grinding.new_part(wheel) };
    let rotation_period = std::f64::consts::TAU / input.work_rotation_speed;
    let point = |part: &State, sharp: f64, input: &Input| {
        let output = grinding.output(part, input);
        CyclePoint {
            time: part.revolutions * rotation_period,
            commanded_infeed: part.commanded_infeed,
            stock_removed: output.stock_removed,
            depth_of_cut: output.depth_of_cut,
            size_error: output.size_error,
            // The force is that of the wheel that has cut, not of the blunter one that it has become.
            load: grinding.load(&State { removed_volume: sharp, ..*part }, input),
            removed_volume: part.removed_volume,
            decay: grinding.decay(part, input),
        }
    };
    let start = point(&part, part.removed_volume, &Input { engaged: 1.0, ..*input });
    let mut course = vec![CyclePoint { decay: 1.0, ..start }];
    for phase in phases {
        let input = Input { infeed_per_rev: phase.infeed_per_rev, engaged: 1.0, ..*input };
        input.check()?;
        for _ in 0..phase.revolutions {
            part.commanded_infeed += phase.infeed_per_rev;
            let sharp = part.removed_volume;
            part = grinding.revolution(&part, &input);
            course.push(point(&part, sharp, &input));
        }
    }
    Ok((part, course))
}

/// The cycle of fewest revolutions that removes the stock within the limits: `rough_revolutions`
/// of one infeed, `finish_revolutions` of an infeed on the grid of the machine, spark-out; the
/// commanded infeed adds up to the stock. Among equally fast cycles, the one of least last depth.
///
/// The search is exact: it visits every finish infeed and every number of finish and rough
/// revolutions that could beat the best cycle so far, each with its least spark-out. It takes the
/// process stiffness as it is at the start of the part ([`fastest_cycle_while_dulling`] does not); the numbers of the
/// cycle found are those of the process itself, with dulling within the part. `wheel` says how blunt the wheel is. With a
/// force exponent below 1 both functions are one.
///
/// # Errors
/// [`CycleError`] names the limits that conflict.
///
/// ```
/// use toolroom_infeed::{CycleLimits, Infeed, Input, State, fastest_cycle};
/// let (grinding, limits) = (Infeed::default(), CycleLimits::default());
/// let cycle = fastest_cycle(&grinding, &State::default(), &Input::default(), &limits).unwrap();
/// assert_eq!(cycle.revolutions, 27);
/// ```
pub fn fastest_cycle(
    grinding: &Infeed,
    wheel: &State,
    input: &Input,
    limits: &CycleLimits,
) -> Result<Cycle, CycleError> {
    fastest_cycle_of_steady_wheel(grinding, wheel, input, limits, None)
}

/// [`fastest_cycle`] with the process stiffness of every revolution: each limit holds at the end of each revolution, on the
/// wheel that has become blunter within the part. Candidates are run through the process itself. A measured `surface` tells
/// the roughness after the dressing that `dressing` describes, which `limits` may hold down.
///
/// # Errors
/// As [`fastest_cycle`].
///
/// ```
/// use toolroom_infeed::{CycleLimits, Infeed, Input, State, fastest_cycle_while_dulling};
/// let mut grinding = Infeed::default();
/// grinding.parameters.dulling_rate = 1.0 / 300e-6; // 300 mm³/mm double the process stiffness
/// let (wheel, input, limits) = (State::default(), Input::default(), CycleLimits::default());
/// let found = fastest_cycle_while_dulling(&grinding, &wheel, &input, &limits, None).unwrap();
/// assert_eq!(found.revolutions, 28);
/// assert!(found.peak_temperature_rise < 650.0);
/// ```
pub fn fastest_cycle_while_dulling(
    grinding: &Infeed,
    wheel: &State,
    input: &Input,
    limits: &CycleLimits,
    surface: Option<(&Surface, &DressingPlan, f64)>,
) -> Result<Cycle, CycleError> {
    let roughness = surface.map(Roughness::from_dressing);
    let ground = std::f64::consts::PI * grinding.parameters.work_diameter * limits.stock;
    let end = State { removed_volume: wheel.removed_volume + ground, ..*wheel };
    let dulls = grinding.shares(wheel, input) != grinding.shares(&end, input);
    let bent = grinding.parameters.force_exponent != 1.0;
    designed(Task { grinding, wheel, input, limits, roughness: roughness.as_ref() }, dulls || bent)
}

/// The fastest cycle on a wheel that keeps the process stiffness which it has at the start of the part, as studies of many
/// parts take it: dulling within one part is far less than that between dressings.
pub(super) fn fastest_cycle_of_steady_wheel(
    grinding: &Infeed,
    wheel: &State,
    input: &Input,
    limits: &CycleLimits,
    surface: Option<(&Surface, &DressingPlan, f64)>,
) -> Result<Cycle, CycleError> {
    let roughness = surface.map(Roughness::from_dressing);
    let bent = grinding.parameters.force_exponent != 1.0;
    designed(Task { grinding, wheel, input, limits, roughness: roughness.as_ref() }, bent)
}

/// The fastest cycle, in closed form or by runs of the process.
fn designed(task: Task<'_>, running: bool) -> Result<Cycle, CycleError> {
    let Task { grinding, wheel, input, limits, roughness } = task;
    input.check()?;
    limits.check()?;
    if input.work_rotation_speed == 0.0 {
        return Err(ModelError::NoSolution { quantity: "cycle", reason: "the work does not rotate" }.into());
    }
    // The machine may be slower than the setting of its infeed.
    let per_second = input.work_rotation_speed / std::f64::consts::TAU;
    let greatest_infeed = limits.greatest_infeed.min(limits.infeed_speed / per_second);
    let limits = &CycleLimits { greatest_infeed, ..*limits };
    let task = Task { limits, ..task };
    let law = Law::of(grinding, wheel, input);
    let search = if running { Search::running(task)? } else { Search::new(task, law)? };
    let found = search.best()?;
    let phases: Vec<CyclePhase> =
        [(found.rough_infeed, found.rough), (found.finish_infeed, found.finish), (0.0, found.spark_out)]
            .into_iter()
            .filter(|(_, revolutions)| *revolutions > 0)
            .map(|(infeed_per_rev, revolutions)| CyclePhase { infeed_per_rev, revolutions })
            .collect();
    let (_, course) = grind_cycle(grinding, wheel, input, &phases)?;
    let (Some(first), Some(last)) = (course.first(), course.last()) else {
        return Err(ModelError::NoSolution { quantity: "cycle", reason: "it has no revolution" }.into());
    };
    let peak = |of: fn(&Load) -> f64| course.iter().map(|point| of(&point.load)).fold(of(&first.load), f64::max);
    let revolutions = found.revolutions();
    let blank =
        if running { course.iter().map(|point| point.decay).product() } else { law.decay.powf(revolutions.into()) };
    let infed = (found.rough + found.finish) as usize;
    let end_roughness = roughness.map(|roughness| {
        let left = course[infed + 1..].iter().map(|point| point.decay).product();
        roughness.in_spark_out(task.roughness_under(course[infed].depth_of_cut), left)
    });
    Ok(Cycle {
        phases,
        revolutions,
        time: last.time,
        last_depth: last.depth_of_cut,
        size_error: last.size_error,
        roundness_error: last.depth_of_cut + limits.blank_roundness_error * blank,
        finish_stock: last.stock_removed - course[found.rough as usize].stock_removed,
        peak_temperature_rise: peak(|load| load.temperature_rise),
        peak_power: peak(|load| load.power),
        peak_normal_force: peak(|load| load.normal_force),
        peak_removal_rate: peak(|load| load.removal_rate),
        least_burn_margin: course.iter().map(|point| point.load.burn_margin).fold(1.0, f64::min),
        least_energy_margin: course.iter().filter_map(|point| point.load.energy_margin()).reduce(f64::min),
        roughness: end_roughness,
        rough_depth_limit: search.rough_depth,
        finish_depth_limit: search.finish_depth,
        course,
    })
}
