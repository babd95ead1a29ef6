//! Time-domain simulation with loss of contact and multiple regeneration.

use crate::discretised::integrals;
use crate::error::{ChatterError, positive, within};
use crate::response::Modal;
use crate::{Milling, Turning};
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

    /// Displacement by the present state.
    fn displacement(&self) -> [f64; 2] {
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

    /// Displacement if the step ended with `force`.
    fn trial(&self, force: [f64; 2]) -> [f64; 2] {
        self.modes.iter().zip(&self.state).fold([0.0; 2], |u, (mode, z)| {
            let q = z[0] + mode.end[0] * mode.force(force);
            [u[0] + mode.modal.output[0] * q, u[1] + mode.modal.output[1] * q]
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

/// Runs a step loop: `cut(step, u)` is the force at a step, `leave` moves the surface on.
fn run(
    stepper: &mut Stepper,
    settings: &SimulationSettings,
    dt: f64,
    mut force_at: impl FnMut(usize, [f64; 2]) -> [f64; 2],
    mut leave: impl FnMut(usize, [f64; 2]) -> (u32, u32),
) -> Simulation {
    let total = settings.steps * settings.periods;
    let first = settings.steps * (settings.periods - settings.observed);
    let mut result = Simulation {
        time_step: dt,
        displacement: Vec::with_capacity(total - first),
        force: Vec::with_capacity(total - first),
        air_fraction: 0.0,
    };
    let (mut engaged, mut in_air) = (0u64, 0u64);
    let mut force = force_at(0, stepper.displacement());
    leave(0, stepper.displacement());
    for step in 1..total {
        stepper.begin(force);
        // Predict with the force held, correct once.
        let predicted = force_at(step, stepper.trial(force));
        force = force_at(step, stepper.trial(predicted));
        stepper.finish(force);
        let u = stepper.displacement();
        let (teeth, air) = leave(step, u);
        if step >= first {
            result.displacement.push(u);
            result.force.push(force);
            engaged += u64::from(teeth);
            in_air += u64::from(air);
        }
    }
    result.air_fraction = if engaged > 0 { in_air as f64 / engaged as f64 } else { 0.0 };
    result
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
    /// there is no force in the air.
    ///
    /// # Errors
    /// A cut that is none or has process damping, which this simulation does not know; settings out
    /// of range.
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
        self.check()?;
        positive("spindle_speed", spindle_speed)?;
        positive("width", width)?;
        positive("feed_per_rev", feed_per_rev)?;
        within("process_damping", self.process_damping, 0.0, 0.0)?;
        check(settings)?;
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
        let force = |step: usize, u: [f64; 2]| {
            let h = chip(step, u);
            let force = if h > 0.0 { static_force * (h / feed_per_rev).powf(self.chip_exponent) } else { 0.0 };
            [force, 0.0]
        };
        let leave = |step: usize, u: [f64; 2]| {
            let cuts = chip(step, u) > 0.0;
            let at = &mut surface.borrow_mut()[step % settings.steps];
            *at = if cuts { u[0] } else { *at + feed_per_rev };
            (1, u32::from(!cuts))
        };
        Ok(run(&mut stepper, settings, dt, force, leave))
    }
}

impl Milling {
    /// Simulates milling at `spindle_speed` (rad/s) and `depth` (m). Each tooth's chip is what lies
    /// between it and the surface that earlier teeth have left, runout included; there is no force
    /// in the air. A helix is cut in axial slices.
    ///
    /// # Errors
    /// A cut that is none, has unequal pitch or process damping, which this simulation does not
    /// know; settings out of range.
    ///
    /// # Source
    /// Surface memory after Tlusty and Ismail (1981). Second order in the step.
    pub fn simulate(
        &self,
        spindle_speed: f64,
        depth: f64,
        settings: &SimulationSettings,
    ) -> Result<Simulation, ChatterError> {
        self.check()?;
        positive("spindle_speed", spindle_speed)?;
        positive("depth", depth)?;
        positive("feed_per_tooth", self.feed_per_tooth)?;
        within("process_damping", self.force.process_damping, 0.0, 0.0)?;
        let teeth = self.cutter.teeth;
        let equal = TAU / teeth as f64;
        for pitch in &self.cutter.pitch {
            within("pitch", *pitch, equal * (1.0 - 1e-9), equal * (1.0 + 1e-9))?;
        }
        check(settings)?;
        let k = settings.steps;
        let step_angle = equal / k as f64;
        let dt = step_angle / spindle_speed;
        // Axial slices, each lagging the one below it by one step of angle.
        let lag = self.cutter.lag_angle(depth) / step_angle;
        let slices = lag.ceil().max(1.0) as usize;
        let slice_lag = |slice: usize| ((slice as f64 + 0.5) * lag / slices as f64).floor() as usize;
        let bins: Vec<Bin> = self.bins(step_angle);
        let radius: Vec<f64> = (0..teeth).map(|j| self.cutter.extra_radius(j)).collect();
        let mut stepper = Stepper::new(self.modes.iter().map(|m| m.modal(m.unit(), m.unit())), dt);
        for (SteppedMode { modal: m, .. }, z) in stepper.modes.iter().zip(&mut stepper.state) {
            z[0] = settings.kick * self.feed_per_tooth * (m.output[0] + m.output[1]);
        }
        let surface = std::cell::RefCell::new(vec![vec![0.0; bins.len()]; slices]);
        // Teeth in the engagement: (slice, bin, tooth). Tooth 0 enters at step 0, tooth j one pitch
        // after tooth j − 1.
        let revolution = teeth * k;
        let visit = |step: usize, found: &mut dyn FnMut(usize, usize, usize)| {
            for slice in 0..slices {
                for j in 0..teeth {
                    let bin = (step + revolution * slices.max(2) - j * k - slice_lag(slice) % revolution) % revolution;
                    if bin < bins.len() {
                        found(slice, bin, j);
                    }
                }
            }
        };
        let chip = |slice: usize, bin: usize, j: usize, u: [f64; 2]| {
            let Bin { sine, cosine, .. } = bins[bin];
            let position = sine * u[0] + cosine * u[1] + radius[j];
            (self.feed_per_tooth * sine + position - surface.borrow()[slice][bin], position)
        };
        let width = depth / slices as f64;
        let force = |step: usize, u: [f64; 2]| {
            let mut force = [0.0; 2];
            visit(step, &mut |slice, bin, j| {
                let h = chip(slice, bin, j, u).0;
                if h > 0.0 {
                    let Bin { share, sine, cosine } = bins[bin];
                    let (t, n) = (self.force.tangential, self.force.radial);
                    force[0] -= share * width * h * (t * cosine + n * sine);
                    force[1] -= share * width * h * (n * cosine - t * sine);
                }
            });
            force
        };
        let leave = |step: usize, u: [f64; 2]| {
            let (mut engaged, mut air) = (0, 0);
            visit(step, &mut |slice, bin, j| {
                let (h, position) = chip(slice, bin, j, u);
                let at = &mut surface.borrow_mut()[slice][bin];
                *at = if h > 0.0 { position } else { *at - self.feed_per_tooth * bins[bin].sine };
                engaged += 1;
                air += u32::from(h <= 0.0);
            });
            (engaged, air)
        };
        Ok(run(&mut stepper, settings, dt, force, leave))
    }

    /// The steps of angle within the engagement, from its entry.
    fn bins(&self, step_angle: f64) -> Vec<Bin> {
        let arc = self.engagement.exit - self.engagement.entry;
        let count = (arc / step_angle + 0.5).floor() as usize + 1;
        (0..count)
            .map(|i| {
                let (sine, cosine) = (self.engagement.entry + step_angle * i as f64).sin_cos();
                // Cells of one step about each angle, cut off at the ends of the engagement.
                let from = (i as f64 - 0.5).max(0.0);
                let to = (i as f64 + 0.5).min(arc / step_angle);
                Bin { share: (to - from).max(0.0), sine, cosine }
            })
            .collect()
    }
}

/// A step of angle within the engagement.
#[derive(Clone, Copy)]
struct Bin {
    /// Share of the step that lies inside.
    share: f64,
    sine: f64,
    cosine: f64,
}
