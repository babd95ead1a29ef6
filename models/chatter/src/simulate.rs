//! Time-domain simulation with loss of contact and multiple regeneration.

mod settled;

pub(crate) use settled::{Patience, settling, steps_for};
pub use settled::{SETTLED, Settled};

use crate::discretised::integrals;
use crate::error::{ChatterError, positive, within};
use crate::milling::{SLICES, Slice, slices};
use crate::response::Modal;
use crate::{Engagement, Milling, MillingForce, Turning};
use nalgebra::DMatrix;
use std::f64::consts::TAU;

/// How a simulation is run.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct SimulationSettings {
    /// Steps in a tooth period (milling) or revolution (turning).
    pub steps: usize,
    /// Periods that are simulated.
    pub periods: usize,
    /// Periods at the end over which the result is taken.
    pub observed: usize,
    /// Displacement at the start, in chip thicknesses, to set chatter off.
    pub kick: f64,
}

impl Default for SimulationSettings {
    fn default() -> Self {
        Self { steps: 200, periods: 600, observed: 100, kick: 0.1 }
    }
}

/// What a simulation showed over its observed end.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Simulation {
    /// Time step (s).
    pub time_step: f64,
    /// Relative displacement in both directions (m), one entry a step; in turning the first is
    /// along the chip thickness.
    pub displacement: Vec<[f64; 2]>,
    /// Cutting force in the same directions (N); in turning the first is the whole force.
    pub force: Vec<[f64; 2]>,
    /// Share of the time in engagement without contact.
    pub air_fraction: f64,
}

impl Simulation {
    /// Peak-to-peak displacement in `direction` 0 or 1 (m).
    pub fn peak_to_peak(&self, direction: usize) -> f64 {
        let values = self.displacement.iter().map(|u| u[direction]);
        values.clone().fold(f64::MIN, f64::max) - values.fold(f64::MAX, f64::min)
    }

    /// Greatest magnitude of the force in `direction` 0 or 1 (N).
    pub fn greatest_force(&self, direction: usize) -> f64 {
        self.force.iter().map(|f| f[direction].abs()).fold(0.0, f64::max)
    }

    /// Mean of the force's magnitude to the power `p` in `direction` 0 or 1 [N^p].
    pub fn mean_force_power(&self, direction: usize, p: i32) -> f64 {
        self.force.iter().map(|f| f[direction].abs().powi(p)).sum::<f64>() / self.force.len() as f64
    }
}

/// Modes driven by a force that is linear over a step: an exact propagator.
struct Stepper {
    modes: Vec<SteppedMode>,
    /// (q, q'/w) of every mode.
    state: Vec<[f64; 2]>,
}

/// Relative displacement (m) and its velocity (m/s) in both directions.
#[derive(Clone, Copy, Default)]
struct Moving {
    at: [f64; 2],
    velocity: [f64; 2],
}

/// A mode over one step.
struct SteppedMode {
    modal: Modal,
    /// Without force.
    transition: [f64; 4],
    /// By modal force at the start and at the end of the step.
    start: [f64; 2],
    end: [f64; 2],
}

impl SteppedMode {
    fn force(&self, force: [f64; 2]) -> f64 {
        self.modal.input[0] * force[0] + self.modal.input[1] * force[1]
    }
}

impl Stepper {
    fn new(modal: impl Iterator<Item = Modal>, dt: f64) -> Self {
        let modes: Vec<_> = modal
            .map(|m| {
                let w = m.frequency;
                let free = DMatrix::from_row_slice(2, 2, &[0.0, w, -w, -2.0 * m.damping_ratio * w]);
                let [_, whole, ramp, _] = integrals(&free, dt);
                // A unit modal force enters the scaled rate by w/k.
                let gain = w / m.stiffness;
                let end = [ramp[(0, 1)] / dt * gain, ramp[(1, 1)] / dt * gain];
                let start = [whole[(0, 1)] * gain - end[0], whole[(1, 1)] * gain - end[1]];
                SteppedMode { modal: m, transition: m.transition(dt), start, end }
            })
            .collect();
        Self { state: vec![[0.0; 2]; modes.len()], modes }
    }

    /// Motion by the present state.
    fn motion(&self) -> Moving {
        self.trial([0.0; 2])
    }

    /// Moves on under `force`, without the part that the force at the end adds.
    fn begin(&mut self, force: [f64; 2]) {
        for (mode, z) in self.modes.iter().zip(&mut self.state) {
            let f = mode.force(force);
            let [a, b, c, d] = mode.transition;
            *z = [a * z[0] + b * z[1] + mode.start[0] * f, c * z[0] + d * z[1] + mode.start[1] * f];
        }
    }

    /// Motion if the step ended with `force`.
    fn trial(&self, force: [f64; 2]) -> Moving {
        self.modes.iter().zip(&self.state).fold(Moving::default(), |Moving { at: u, velocity: v }, (mode, z)| {
            let (q, rate) = (z[0] + mode.end[0] * mode.force(force), z[1] + mode.end[1] * mode.force(force));
            let speed = mode.modal.frequency * rate;
            let [x, y] = mode.modal.output;
            Moving { at: [u[0] + x * q, u[1] + y * q], velocity: [v[0] + x * speed, v[1] + y * speed] }
        })
    }

    /// Completes the step with `force` at its end.
    fn finish(&mut self, force: [f64; 2]) {
        for (mode, z) in self.modes.iter().zip(&mut self.state) {
            let f = mode.force(force);
            *z = [z[0] + mode.end[0] * f, z[1] + mode.end[1] * f];
        }
    }
}

/// Whether a simulation that has reached the end of its periods, here their number, is to go on for as many again.
pub(crate) type GoOn<'a> = &'a mut dyn FnMut(&Simulation, usize) -> bool;

/// Runs a step loop: `force_at` is the force at a step, `leave` moves the surface on. A displacement beyond `farthest` (m) is
/// refused. What is observed are the last periods before each end.
fn run(
    stepper: &mut Stepper,
    settings: &SimulationSettings,
    (dt, farthest): (f64, f64),
    mut force_at: impl FnMut(usize, Moving) -> [f64; 2],
    mut leave: impl FnMut(usize, [f64; 2]) -> (u32, u32),
    go_on: GoOn<'_>,
) -> Result<Simulation, ChatterError> {
    let SimulationSettings { steps, mut periods, observed, .. } = *settings;
    let mut result = Simulation {
        time_step: dt,
        displacement: Vec::with_capacity(steps * observed),
        force: Vec::with_capacity(steps * observed),
        air_fraction: 0.0,
    };
    let mut force = force_at(0, stepper.motion());
    leave(0, stepper.motion().at);
    let mut step = 1;
    loop {
        let (first, end) = (steps * (periods - observed), steps * periods);
        let (mut engaged, mut in_air) = (0u64, 0u64);
        while step < end {
            stepper.begin(force);
            // Predict with the force held, correct once.
            let predicted = force_at(step, stepper.trial(force));
            force = force_at(step, stepper.trial(predicted));
            stepper.finish(force);
            let u = stepper.motion().at;
            // The sum of both is the greater and costs less.
            let most = u[0].abs() + u[1].abs();
            if most > farthest || most.is_nan() {
                within("displacement", u[0].hypot(u[1]), 0.0, farthest)?;
            }
            let (teeth, air) = leave(step, u);
            if step >= first {
                result.displacement.push(u);
                result.force.push(force);
                engaged += u64::from(teeth);
                in_air += u64::from(air);
            }
            step += 1;
        }
        result.air_fraction = if engaged > 0 { in_air as f64 / engaged as f64 } else { 0.0 };
        if !go_on(&result, periods) {
            return Ok(result);
        }
        periods *= 2;
        result.displacement.clear();
        result.force.clear();
    }
}

fn check(settings: &SimulationSettings) -> Result<(), ChatterError> {
    within("steps", settings.steps as f64, 8.0, 1e5)?;
    within("periods", settings.periods as f64, 1.0, 1e6)?;
    within("observed", settings.observed as f64, 1.0, settings.periods as f64)?;
    within("kick", settings.kick, -1e3, 1e3)?;
    Ok(())
}

impl Turning {
    /// Simulates turning at `spindle_speed` (rad/s) with `width` and mean chip `feed_per_rev` (m).
    /// The chip is what lies between the tool and the surface that earlier revolutions have left;
    /// there is no force in the air. Process damping acts in contact alone and does not pull.
    ///
    /// # Errors
    /// A cut that is none; settings out of range.
    ///
    /// # Source
    /// Surface memory after Tlusty and Ismail (1981). Second order in the step.
    pub fn simulate(
        &self,
        spindle_speed: f64,
        width: f64,
        feed_per_rev: f64,
        settings: &SimulationSettings,
    ) -> Result<Simulation, ChatterError> {
        self.simulate_on(spindle_speed, width, feed_per_rev, settings, &mut |_, _| false)
    }

    /// [`Turning::simulate`] that goes on as long as `go_on` says so.
    fn simulate_on(
        &self,
        spindle_speed: f64,
        width: f64,
        feed_per_rev: f64,
        settings: &SimulationSettings,
        go_on: GoOn<'_>,
    ) -> Result<Simulation, ChatterError> {
        if self.by_speed.is_some() {
            return self.at_spindle_speed(spindle_speed)?.simulate_on(
                spindle_speed,
                width,
                feed_per_rev,
                settings,
                go_on,
            );
        }
        if self.along_path.is_some() {
            let worst = self.at_worst_place(spindle_speed, width)?;
            return worst.simulate_on(spindle_speed, width, feed_per_rev, settings, go_on);
        }
        self.check()?;
        positive("spindle_speed", spindle_speed)?;
        positive("width", width)?;
        positive("feed_per_rev", feed_per_rev)?;
        check(settings)?;
        let damping = width * self.damping_slope(spindle_speed);
        let dt = TAU / spindle_speed / settings.steps as f64;
        let mut stepper = Stepper::new(self.oriented(), dt);
        // The static deflection under the mean chip, then the kick.
        let static_force = width * self.cutting_coefficient * feed_per_rev;
        for (SteppedMode { modal: m, .. }, z) in stepper.modes.iter().zip(&mut stepper.state) {
            z[0] = (m.input[0] * static_force + settings.kick * feed_per_rev * m.stiffness) / m.stiffness;
        }
        let compliance = |mode: &SteppedMode| mode.modal.output[0] * mode.modal.input[0] / mode.modal.stiffness;
        let rest = static_force * stepper.modes.iter().map(compliance).sum::<f64>();
        let surface = std::cell::RefCell::new(vec![rest; settings.steps]);
        let chip = |step: usize, u: [f64; 2]| feed_per_rev + surface.borrow()[step % settings.steps] - u[0];
        let force = |step: usize, Moving { at: u, velocity }: Moving| {
            let h = chip(step, u);
            if h <= 0.0 {
                return [0.0; 2];
            }
            let force = static_force * (h / feed_per_rev).powf(self.chip_exponent);
            // Without damping the force is what it was, to the last bit.
            [if damping > 0.0 { (force - damping * velocity[0]).max(0.0) } else { force }, 0.0]
        };
        let leave = |step: usize, u: [f64; 2]| {
            let cuts = chip(step, u) > 0.0;
            let left_surface = &mut surface.borrow_mut()[step % settings.steps];
            *left_surface = if cuts { u[0] } else { *left_surface + feed_per_rev };
            (1, u32::from(!cuts))
        };
        run(&mut stepper, settings, (dt, f64::MAX), force, leave, go_on)
    }
}

impl Milling {
    /// Simulates milling at `spindle_speed` (rad/s) and `depth` (m). Each tooth's chip is what lies
    /// between it and the surface that earlier teeth have left, runout included; there is no force
    /// in the air. A helix is cut in axial slices. Process damping acts along the radius, in contact alone, and does not
    /// pull.
    ///
    /// # Errors
    /// A cut that is none or has unequal pitch, which this simulation does not know; settings out of range; a cutter that is
    /// displaced by its diameter, as where the force pulls a soft one into the work.
    ///
    /// # Source
    /// Surface memory after Tlusty and Ismail (1981). Second order in the step.
    pub fn simulate(
        &self,
        spindle_speed: f64,
        depth: f64,
        settings: &SimulationSettings,
    ) -> Result<Simulation, ChatterError> {
        self.simulate_on(spindle_speed, depth, settings, &mut |_, _| false)
    }

    /// [`Milling::simulate`] that goes on as long as `go_on` says so.
    pub(crate) fn simulate_on(
        &self,
        spindle_speed: f64,
        depth: f64,
        settings: &SimulationSettings,
        go_on: GoOn<'_>,
    ) -> Result<Simulation, ChatterError> {
        if self.by_speed.is_some() {
            return self.at_spindle_speed(spindle_speed)?.simulate_on(spindle_speed, depth, settings, go_on);
        }
        if self.along_path.is_some() {
            return self.at_worst_place(spindle_speed, depth)?.simulate_on(spindle_speed, depth, settings, go_on);
        }
        self.check()?;
        positive("spindle_speed", spindle_speed)?;
        positive("depth", depth)?;
        positive("feed_per_tooth", self.feed_per_tooth)?;
        let damping = self.force.process_damping / (spindle_speed * self.cutter.diameter / 2.0);
        let teeth = self.cutter.teeth;
        let equal = TAU / teeth as f64;
        for pitch in &self.cutter.pitch {
            within("pitch", *pitch, equal * (1.0 - 1e-9), equal * (1.0 + 1e-9))?;
        }
        check(settings)?;
        let k = settings.steps;
        let step_angle = equal / k as f64;
        let dt = step_angle / spindle_speed;
        let slices = self.axial_slices(depth, step_angle);
        let radius: Vec<f64> = (0..teeth).map(|j| self.cutter.extra_radius(j)).collect();
        let mut stepper = Stepper::new(self.modes.iter().map(|m| m.modal(m.unit(), m.unit())), dt);
        for (SteppedMode { modal: m, .. }, z) in stepper.modes.iter().zip(&mut stepper.state) {
            z[0] = settings.kick * self.feed_per_tooth * (m.output[0] + m.output[1]);
        }
        let surface =
            std::cell::RefCell::new(slices.iter().map(|slice| vec![0.0; slice.bins.len()]).collect::<Vec<_>>());
        // Teeth in the engagement: (slice, bin, tooth). Tooth 0 enters at step 0, tooth j one pitch
        // after tooth j − 1.
        let revolution = teeth * k;
        let ways = (0..slices.len()).flat_map(|slice| (0..teeth).map(move |j| (slice, j)));
        let behind: Vec<(usize, usize, usize)> = ways
            .map(|(slice, j)| {
                let AxialSlice { lag, first, .. } = slices[slice];
                (slice, j, ((j * k + lag) as i64 + first).rem_euclid(revolution as i64) as usize)
            })
            .collect();
        let visit = |step: usize, found: &mut dyn FnMut(usize, usize, usize)| {
            let ahead = step % revolution;
            for &(slice, j, behind) in &behind {
                let bin = if ahead >= behind { ahead - behind } else { ahead + revolution - behind };
                if bin < slices[slice].bins.len() {
                    found(slice, bin, j);
                }
            }
        };
        let chip = |slice: usize, bin: usize, j: usize, u: [f64; 2]| {
            let Bin { sine, cosine, .. } = slices[slice].bins[bin];
            let position = sine * u[0] + cosine * u[1] + radius[j];
            (self.feed_per_tooth * sine + position - surface.borrow()[slice][bin], position)
        };
        let force = |step: usize, Moving { at: u, velocity }: Moving| {
            let mut force = [0.0; 2];
            visit(step, &mut |slice, bin, j| {
                let h = chip(slice, bin, j, u).0;
                if h > 0.0 {
                    let AxialSlice { width, force: of, edge, dyad, ref bins, .. } = slices[slice];
                    let Bin { share, sine, cosine } = bins[bin];
                    let t = of.tangential * h + edge[0];
                    let mut n = of.radial * h + edge[1];
                    if damping > 0.0 {
                        n = (n + dyad * damping * (sine * velocity[0] + cosine * velocity[1])).max(0.0);
                    }
                    force[0] -= share * width * (t * cosine + n * sine);
                    force[1] -= share * width * (n * cosine - t * sine);
                }
            });
            force
        };
        let leave = |step: usize, u: [f64; 2]| {
            let (mut engaged, mut air) = (0, 0);
            visit(step, &mut |slice, bin, j| {
                let (h, position) = chip(slice, bin, j, u);
                let left_surface = &mut surface.borrow_mut()[slice][bin];
                *left_surface =
                    if h > 0.0 { position } else { *left_surface - self.feed_per_tooth * slices[slice].bins[bin].sine };
                engaged += 1;
                air += u32::from(h <= 0.0);
            });
            (engaged, air)
        };
        run(&mut stepper, settings, (dt, self.cutter.diameter), force, leave, go_on)
    }

    /// The cut in axial slices: of a cylinder each lags the one below it by one step of angle, of a cutter with a corner
    /// radius each has its own engagement, coefficients and lag.
    fn axial_slices(&self, depth: f64, step_angle: f64) -> Vec<AxialSlice> {
        let Engagement { entry, exit } = self.engagement;
        let edge = [self.force.edge_tangential, self.force.edge_radial];
        let lag = self.cutter.lag_angle(depth) / step_angle;
        let count = lag.ceil().max(1.0) as usize;
        if self.cutter.is_cylinder() {
            let (first, bins) = bins(entry, (entry, exit), step_angle);
            let slice = |number: usize| AxialSlice {
                width: depth / count as f64,
                lag: ((number as f64 + 0.5) * lag / count as f64).floor() as usize,
                first,
                bins: bins.clone(),
                force: self.force,
                edge,
                dyad: 1.0,
            };
            return (0..count).map(slice).collect();
        }
        let full = 0.5 * self.cutter.diameter;
        let slice = |slice: &Slice| {
            let engaged = slice.engagement(full, entry, exit);
            let (first, bins) = bins(entry, engaged, step_angle);
            AxialSlice {
                width: depth * slice.share,
                lag: (self.cutter.lag_angle(slice.height) / step_angle).round() as usize,
                first,
                bins,
                force: slice.force(&self.force),
                edge: [edge[0] * slice.edge, edge[1]],
                dyad: slice.sine,
            }
        };
        slices(self, depth, count.max(SLICES)).iter().map(slice).collect()
    }
}

/// Steps of angle, counted from `origin`, that an engagement (rad) covers, the first of them and what lies within it: cells of
/// one step about each angle, cut off at the ends of the engagement.
fn bins(origin: f64, (from, to): (f64, f64), step_angle: f64) -> (i64, Vec<Bin>) {
    let (start, end) = ((from - origin) / step_angle, (to - origin) / step_angle);
    if end <= start {
        return (0, Vec::new());
    }
    let (first, last) = ((start + 0.5).floor() as i64, (end + 0.5).floor() as i64);
    let bin = |i: i64| {
        let (sine, cosine) = (origin + step_angle * i as f64).sin_cos();
        let within = (i as f64 + 0.5).min(end) - (i as f64 - 0.5).max(start);
        Bin { share: within.max(0.0), sine, cosine }
    };
    (first, (first..=last).map(bin).collect())
}

/// A part of the depth in which every tooth has one angle.
struct AxialSlice {
    /// Part of the depth (m).
    width: f64,
    /// Steps by which it lags behind the tip.
    lag: usize,
    /// Step, from the entry at full diameter, of its first bin.
    first: i64,
    bins: Vec<Bin>,
    /// Coefficients in the plane, per height, and edge forces (N/m).
    force: MillingForce,
    edge: [f64; 2],
    /// Damping by the cut, over that of a straight cutter.
    dyad: f64,
}

/// A step of angle within the engagement.
#[derive(Clone, Copy)]
struct Bin {
    /// Share of the step that lies inside.
    share: f64,
    sine: f64,
    cosine: f64,
}
