//! Simulations that are run until their vibration repeats.

use super::{GoOn, Simulation, SimulationSettings};
use crate::error::{ChatterError, positive};
use crate::{Milling, Turning};
use std::f64::consts::TAU;

/// A simulation that has been run until its vibration repeats.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Settled {
    /// The vibration at the end.
    pub simulation: Simulation,
    /// Periods that were simulated.
    pub periods: usize,
    /// Greatest relative change of a peak-to-peak displacement between the two halves of the observed end; of a vibration
    /// at two frequencies it does not vanish.
    pub change: f64,
    /// Whether it is below [`SETTLED`].
    pub settled: bool,
    /// Least and greatest of the greater peak-to-peak displacement (m) over windows of a long run, where the vibration does not
    /// repeat or depends on its start: chaos has no amplitude, but a range. `simulation` is then the window in the middle.
    pub range: Option<[f64; 2]>,
    /// Error of the greater peak-to-peak displacement, relative: three quarters of the difference to a run of half the steps
    /// from ten times the displacement, which a method of second order makes four thirds of its own error, and all of it
    /// beyond 4 %; the change; and 4 % for what two windows do not show. Just beyond its limit a cut may have two vibrations to
    /// settle to, and one between them that it leaves slowly: another start tells them.
    /// Of 600 random milling cuts at 1.02 to 3 times their limit, half of them with period doubling, 98.7 % lay within it of a
    /// run of four times the steps over 2400 periods (`examples/amplitudes.rs`).
    pub band: f64,
}

/// Relative change of a peak-to-peak displacement from one window to the next below which a vibration is called settled.
pub const SETTLED: f64 = 0.02;
/// Part of the error of a vibration that neither steps nor windows show: beats longer than a window and chaos. With it, not
/// with less, 95 % of random cuts lie within their band.
const SAMPLED: f64 = 0.04;

/// Displacement, in chip thicknesses, from which the second run starts: where it differs from the first by more than their
/// errors, the start decides (assumption: more than ten chips no cut begins with).
const OTHER_START: f64 = 10.0;

/// How long a vibration is given to settle.
#[derive(Clone, Copy)]
pub(crate) struct Patience {
    /// Periods of the first run, which is doubled up to the last.
    pub periods: [usize; 2],
    /// Periods in each of the two windows at the end that are compared.
    pub window: usize,
}

/// For a vibration that is requested: windows that hold the beats of two frequencies, and what chaos reaches now and then.
const PATIENT: Patience = Patience { periods: [320, 2560], window: 80 };

/// Greatest difference of two lists of peak-to-peak displacements, relative to the greatest of them: a direction that hardly
/// moves beside the other decides nothing.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    let greatest = a.iter().chain(b).copied().fold(f64::MIN_POSITIVE, f64::max);
    a.iter().zip(b).map(|(a, b)| (a - b).abs() / greatest).fold(0.0, f64::max)
}

/// Peak-to-peak displacement of `part` in each of `directions` (m).
fn ranges(part: &[[f64; 2]], directions: &[usize]) -> Vec<f64> {
    directions
        .iter()
        .map(|direction| {
            let values = part.iter().map(|u| u[*direction]);
            values.clone().fold(f64::MIN, f64::max) - values.fold(f64::MAX, f64::min)
        })
        .collect()
}

/// Runs `simulate` with `steps` on and on until two windows at its end agree: the run, its periods, and the relative change
/// from window to window.
pub(crate) fn settling(
    steps: usize,
    Patience { periods: [first, last], window }: Patience,
    directions: &[usize],
    simulate: &impl Fn(&SimulationSettings, GoOn<'_>) -> Result<Simulation, ChatterError>,
) -> Result<(Simulation, usize, f64), ChatterError> {
    let (mut reached, mut change) = (first, f64::INFINITY);
    let mut unsettled = |run: &Simulation, periods: usize| {
        let (before, after) = run.displacement.split_at(run.displacement.len() / 2);
        (reached, change) = (periods, apart(&ranges(before, directions), &ranges(after, directions)));
        change >= SETTLED && periods < last
    };
    let settings = SimulationSettings { steps, periods: first, observed: 2 * window, kick: 1.0 };
    let run = simulate(&settings, &mut unsettled)?;
    Ok((run, reached, change))
}

/// Runs `simulate` until its vibration has settled, and at half the steps from another start for the error; for longer where
/// the two differ.
fn settle(
    steps: usize,
    directions: &[usize],
    simulate: impl Fn(&SimulationSettings, GoOn<'_>) -> Result<Simulation, ChatterError>,
) -> Result<Settled, ChatterError> {
    let (mut run, mut periods, mut change) = settling(steps, PATIENT, directions, &simulate)?;
    let from_above = |periods: usize| {
        let steps = (steps / 2).max(8);
        simulate(
            &SimulationSettings { steps, periods, observed: 2 * PATIENT.window, kick: OTHER_START },
            &mut |_, _| false,
        )
    };
    let difference = |one: &Simulation, other: &Simulation| {
        apart(&ranges(&one.displacement, directions), &ranges(&other.displacement, directions))
    };
    let mut by_step = difference(&run, &from_above(periods)?);
    let [_, last] = PATIENT.periods;
    if by_step > SAMPLED && periods < last {
        // Either has lingered on its way, or they have come to rest in two places: as long as there is patience decides it.
        let for_long = Patience { periods: [last, last], ..PATIENT };
        (run, periods, change) = settling(steps, for_long, directions, &simulate)?;
        by_step = difference(&run, &from_above(periods)?);
    }
    // More than either knows of itself is the start, of which all counts.
    let of_second_order = if by_step > SAMPLED { 1.0 } else { 0.75 };
    let mut band = of_second_order * by_step + change + SAMPLED;
    let mut range = None;
    if change >= SETTLED || by_step > SAMPLED {
        let windows = windows(steps, directions, &simulate)?;
        let middle = windows.len() / 2;
        let [least, greatest] = [windows[0].0, windows[windows.len() - 1].0];
        let median = windows[middle].0;
        let farthest = (greatest / median - 1.0).max(1.0 - least / median);
        band = band.max(farthest + SAMPLED);
        (periods, range) = (last, Some([least, greatest]));
        run = windows.into_iter().nth(middle).map_or(run, |(_, middle)| middle);
    }
    Ok(Settled { simulation: run, periods, change, settled: change < SETTLED, range, band })
}

/// Samples of a long run that are kept at most, and its windows (assumptions: some 130 MB; more tell the range no better).
const MOST_SAMPLES: usize = 4_000_000;
const WINDOWS: [usize; 2] = [4, 12];

/// The windows at the end of a run of the greatest length, by ascending peak-to-peak displacement (m) of the greater direction.
fn windows(
    steps: usize,
    directions: &[usize],
    simulate: &impl Fn(&SimulationSettings, GoOn<'_>) -> Result<Simulation, ChatterError>,
) -> Result<Vec<(f64, Simulation)>, ChatterError> {
    let [least, most] = WINDOWS;
    let (observed, [_, periods]) = (2 * PATIENT.window, PATIENT.periods);
    let count = (MOST_SAMPLES / (observed * steps)).clamp(least, most);
    let settings = SimulationSettings { steps, periods, observed: count * observed, kick: 1.0 };
    let run = simulate(&settings, &mut |_, _| false)?;
    let length = run.displacement.len() / count;
    let part = |(displacement, force): (&[[f64; 2]], &[[f64; 2]])| {
        let greatest = ranges(displacement, directions).into_iter().fold(0.0, f64::max);
        let (displacement, force) = (displacement.to_vec(), force.to_vec());
        let Simulation { time_step, air_fraction, .. } = run;
        (greatest, Simulation { time_step, displacement, force, air_fraction })
    };
    let mut found: Vec<(f64, Simulation)> =
        run.displacement.chunks_exact(length).zip(run.force.chunks_exact(length)).map(part).collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    Ok(found)
}

/// Steps in a period of `length` (s): `least`, and `each` to an oscillation of the highest mode.
pub(crate) fn steps_for(modes: &[crate::Mode], length: f64, [least, each]: [f64; 2]) -> usize {
    let highest = modes.iter().map(|mode| mode.natural_frequency).fold(0.0, f64::max);
    (each * highest * length).clamp(least, 5000.0).ceil() as usize
}

/// Least steps in a period, and steps in an oscillation of the highest mode, of a vibration that is requested.
const FINE: [f64; 2] = [200.0, 40.0];

impl Turning {
    /// The vibration that turning at `spindle_speed` (rad/s) with `width` and mean chip `feed_per_rev` (m) settles to, set off
    /// by a chip thickness.
    ///
    /// # Errors
    /// As [`Turning::simulate`].
    pub fn settled(&self, spindle_speed: f64, width: f64, feed_per_rev: f64) -> Result<Settled, ChatterError> {
        if self.by_speed.is_some() {
            return self.at_spindle_speed(spindle_speed)?.settled(spindle_speed, width, feed_per_rev);
        }
        if self.along_path.is_some() {
            return self.at_worst_place(spindle_speed, width)?.settled(spindle_speed, width, feed_per_rev);
        }
        let steps = 2 * steps_for(&self.modes, TAU / positive("spindle_speed", spindle_speed)?, FINE);
        settle(steps, &[0], |settings, go_on| self.simulate_on(spindle_speed, width, feed_per_rev, settings, go_on))
    }
}

impl Milling {
    /// The vibration that milling at `spindle_speed` (rad/s) and `depth` (m) settles to, set off by a chip thickness.
    ///
    /// # Errors
    /// As [`Milling::simulate`].
    pub fn settled(&self, spindle_speed: f64, depth: f64) -> Result<Settled, ChatterError> {
        if self.by_speed.is_some() {
            return self.at_spindle_speed(spindle_speed)?.settled(spindle_speed, depth);
        }
        if self.along_path.is_some() {
            return self.at_worst_place(spindle_speed, depth)?.settled(spindle_speed, depth);
        }
        let pitch = TAU / (self.cutter.teeth as f64 * positive("spindle_speed", spindle_speed)?);
        let steps = steps_for(&self.modes, pitch, FINE);
        settle(steps, &[0, 1], |settings, go_on| self.simulate_on(spindle_speed, depth, settings, go_on))
    }
}
