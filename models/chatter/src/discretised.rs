//! Time-domain discretisations of milling, kept as independent checks of the collocation, and the
//! collocation with a chosen number of nodes: how each converges.
//!
//! The discretisations are of second order in the step; [`Milling::verdict`] chooses its nodes by
//! itself and should be used for results. `cargo run --release -p toolroom-chatter --example
//! convergence` prints the errors of all three.

use crate::error::{ChatterError, positive, within};
use crate::milling::{Milling, tooth_period_gain};
use nalgebra::{DMatrix, DVector, Vector2};
use std::f64::consts::TAU;
use toolroom_spectral::{Krylov, LinearMap, MAX_NODES};

/// Which discretisation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Discretisation {
    /// Piecewise constant coefficients and delayed term (Insperger and Stépán 2004).
    Semi,
    /// Linear interpolation of coefficients, state and delayed term (Ding et al. 2010).
    Full,
}

/// Spectral radius over one tooth period with `steps` steps.
///
/// # Errors
/// A cut with helix, unequal pitch, runout or process damping, which this check does not know; as
/// [`Milling::verdict`] otherwise.
pub fn spectral_radius(
    cut: &Milling,
    spindle_speed: f64,
    depth: f64,
    steps: usize,
    method: Discretisation,
) -> Result<f64, ChatterError> {
    cut.check()?;
    positive("spindle_speed", spindle_speed)?;
    within("depth", depth, 0.0, f64::MAX)?;
    within("steps", steps as f64, 4.0, 1e5)?;
    within("helix_angle", cut.cutter.helix_angle, 0.0, 0.0)?;
    cut.only_cylinder()?;
    within("process_damping", cut.force.process_damping, 0.0, 0.0)?;
    within("irregularity of the teeth", f64::from(u8::from(!cut.cutter.is_regular())), 0.0, 0.0)?;
    let mut map = Steps::new(cut, spindle_speed, depth, steps, method);
    Ok(Krylov::default().dominant(&mut map, 1e-9)?.value.norm())
}

/// Spectral radius over one tooth period by collocation at `nodes` Gauss–Legendre nodes in each
/// stretch in cut, as in every verdict of this crate, however many oscillations it holds.
///
/// # Errors
/// Fewer than 4 or more than 64 nodes; as [`Milling::verdict`] otherwise.
///
/// # Examples
/// ```
/// use std::f64::consts::TAU;
/// use toolroom_chatter::discretised::collocated_radius;
/// use toolroom_chatter::{Cutter, Direction, Engagement, Milling, MillingForce, Mode};
/// let modes = vec![Mode::from_mass([1.0, 0.0], 922.0, 0.011, 0.03993)];
/// let (cutter, engagement) = (Cutter::straight(2, 0.02), Engagement::new(1.0, Direction::Down).unwrap());
/// let slot = Milling { modes, cutter, engagement, force: MillingForce::new(6e8, 2e8), feed_per_tooth: 1e-4, by_speed: None, along_path: None };
/// let radius = collocated_radius(&slot, 5000.0 / 60.0 * TAU, 0.5e-3, 40).unwrap();
/// assert!((radius - 1.073975587).abs() < 1e-8);
/// ```
pub fn collocated_radius(cut: &Milling, spindle_speed: f64, depth: f64, nodes: usize) -> Result<f64, ChatterError> {
    within("nodes", nodes as f64, 4.0, MAX_NODES as f64)?;
    within("depth", depth, 0.0, f64::MAX)?;
    cut.at_speed(spindle_speed)?.collocated(depth, nodes)
}

/// One step `z+ = now z + old u_old + new u_old+ (+ next state implied)`, solved for `z+`.
struct Step {
    /// Of the state.
    now: DMatrix<f64>,
    /// Of the displacement one period before the start of the step.
    old: DMatrix<f64>,
    /// Of the displacement one period before its end.
    new: DMatrix<f64>,
}

struct Steps {
    steps: Vec<Step>,
    /// Displacement of a state.
    observe: DMatrix<f64>,
}

impl Steps {
    fn new(cut: &Milling, spindle_speed: f64, depth: f64, count: usize, method: Discretisation) -> Self {
        let modes = cut.modes.len();
        let dt = TAU / (cut.cutter.teeth as f64 * spindle_speed) / count as f64;
        let mut free = DMatrix::zeros(2 * modes, 2 * modes);
        let mut input = DMatrix::zeros(2 * modes, 2);
        let mut observe = DMatrix::zeros(2, 2 * modes);
        for (i, mode) in cut.modes.iter().enumerate() {
            let (w, d) = (mode.angular_frequency(), mode.unit());
            // State (q, q'/w), as everywhere.
            free[(2 * i, 2 * i + 1)] = w;
            free[(2 * i + 1, 2 * i)] = -w;
            free[(2 * i + 1, 2 * i + 1)] = -2.0 * mode.damping_ratio * w;
            for axis in 0..2 {
                input[(2 * i + 1, axis)] = w / mode.stiffness * d[axis];
                observe[(axis, 2 * i)] = d[axis];
            }
        }
        let gain = |from: f64, to: f64| -> DMatrix<f64> {
            let sum = tooth_period_gain(cut, from / count as f64, to / count as f64);
            DMatrix::from_row_slice(2, 2, &sum) * -depth
        };
        let steps = (0..count).map(|i| {
            let i = i as f64;
            match method {
                Discretisation::Semi => {
                    let force = gain(i, i + 1.0);
                    let closed = &free + &input * &force * &observe;
                    let [now, once, ..] = integrals(&closed, dt);
                    let delayed = once * &input * &force * -0.5;
                    Step { now, old: delayed.clone(), new: delayed }
                }
                Discretisation::Full => full_step(&free, &input, &observe, &gain(i, i), &gain(i + 1.0, i + 1.0), dt),
            }
        });
        Self { steps: steps.collect(), observe }
    }
}

/// Step of the full discretisation: with `s` the share of the step, the force is
/// `(K0 + (K1 − K0) s)(r0 + (r1 − r0) s)`, `r` the difference of present and delayed displacement.
fn full_step(
    free: &DMatrix<f64>,
    input: &DMatrix<f64>,
    observe: &DMatrix<f64>,
    k0: &DMatrix<f64>,
    k1: &DMatrix<f64>,
    dt: f64,
) -> Step {
    let [transition, one, first, second] = integrals(free, dt);
    let (one, first, second): (DMatrix<f64>, _, _) = (one * input, first * input / dt, second * input / (dt * dt));
    let slope = k1 - k0;
    let at_end = &first * k0 + &second * &slope;
    let at_start = &one * k0 + &first * (&slope - k0) - &second * slope;
    let size = free.nrows();
    let implicit = DMatrix::identity(size, size) - &at_end * observe;
    let now = transition + &at_start * observe;
    // The implicit matrix is close to the identity at any sensible step.
    let solve = |right: DMatrix<f64>| implicit.clone().lu().solve(&right).unwrap_or_else(|| right.map(|_| f64::NAN));
    Step { now: solve(now), old: solve(-at_start), new: solve(-at_end) }
}

/// `exp(a t)` and the integrals of `exp(a (t − s)) s^k ds` over `0 … t` for k = 0, 1, 2.
pub(crate) fn integrals(a: &DMatrix<f64>, t: f64) -> [DMatrix<f64>; 4] {
    let n = a.nrows();
    let mut block = DMatrix::zeros(4 * n, 4 * n);
    block.view_mut((0, 0), (n, n)).copy_from(&(a * t));
    for k in 0..3 {
        // Powers of t are put back below, so that the blocks are of one size.
        block.view_mut((k * n, (k + 1) * n), (n, n)).fill_with_identity();
    }
    let exponential = block.exp();
    let part = |k: usize, scale: f64| exponential.view((0, k * n), (n, n)).into_owned() * scale;
    [part(0, 1.0), part(1, t), part(2, t * t), part(3, 2.0 * t * t * t)]
}

impl LinearMap for Steps {
    fn size(&self) -> usize {
        // Displacements at the starts of the last period's steps, then the state at its end.
        2 * self.steps.len() + self.observe.ncols()
    }

    fn apply(&mut self, x: &[f64], y: &mut [f64]) {
        let count = self.steps.len();
        let mut state = DVector::from_column_slice(&x[2 * count..]);
        let end = &self.observe * &state;
        let past =
            |i: usize| if i < count { Vector2::new(x[2 * i], x[2 * i + 1]) } else { Vector2::new(end[0], end[1]) };
        for (i, step) in self.steps.iter().enumerate() {
            let shown = &self.observe * &state;
            y[2 * i..2 * i + 2].copy_from_slice(shown.as_slice());
            state = &step.now * &state + &step.old * past(i) + &step.new * past(i + 1);
        }
        y[2 * count..].copy_from_slice(state.as_slice());
    }
}
