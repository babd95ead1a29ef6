//! The rightmost characteristic root of a turning cut at constant speed.

use super::Turning;
use super::oriented::Oriented;
use crate::error::ChatterError;
use crate::structure::last_to_decay;
use nalgebra::Complex;
use std::f64::consts::TAU;

/// Chains of roots are left out where the cut cannot make a multiplier greater than this: there
/// `|exp(s tau)| ≈ b K_f |G|`.
const LEAST_MULTIPLIER: f64 = 0.02;
/// Newton steps; from the starts below five to eight do.
const STEPS: u32 = 40;
/// Relative accuracy of a root.
const ACCURACY: f64 = 1e-13;

/// A zero `s` of the characteristic function; `exp(s tau)` is a Floquet multiplier.
#[derive(Clone, Copy, Debug)]
pub(super) struct Root {
    /// Growth rate (1/s) and angular frequency (rad/s), the latter not negative.
    pub rate: Complex<f64>,
    /// Last step of Newton's method, as a share of the multiplier.
    pub residual: f64,
}

impl Turning {
    /// The rightmost zero of `1 + b [K_f (1 − exp(−s tau)) + s C_i/V] G(s)`.
    ///
    /// At constant speed the cut repeats in every instant, not only after a revolution; its
    /// multipliers are `exp(s tau)`. They lie in chains, one root to a whole number of waves in a
    /// revolution, so one start a wave, from `exp(−s tau) = 1 + 1/(b K_f G)`, finds them all
    /// where the structure answers; the structure's own poles complete the starts.
    pub(super) fn rightmost_root(&self, spindle_speed: f64, width: f64) -> Result<Root, ChatterError> {
        if width == 0.0 {
            // Nothing feeds the vibration back: the roots are the poles of the structure.
            let rate = last_to_decay(self.modes.iter().filter(|mode| self.orientation(mode) != 0.0));
            return Ok(Root { rate, residual: 0.0 });
        }
        let tau = TAU / spindle_speed;
        let gain = width * self.force_slope();
        let structure = Oriented::new(self);
        let fastest = self.modes.iter().map(|mode| mode.angular_frequency()).fold(0.0, f64::max);
        let mut best: Option<Root> = None;
        let mut worst = 0f64;
        let mut polish = |start: Complex<f64>| {
            let root = newton(&structure, start, tau, [gain, width * self.damping_slope(spindle_speed)]);
            worst = worst.max(root.residual.min(f64::MAX));
            if root.residual <= 1e3 * ACCURACY && best.is_none_or(|best| root.rate.re > best.rate.re) {
                best = Some(root);
            }
        };
        for mode in &structure.0 {
            let decay = 0.5 * mode.damping;
            let damped = (mode.frequency * mode.frequency - decay * decay).sqrt();
            polish(Complex::new(-decay, damped * (1.0 + 1e-9)));
        }
        // The cut stiffens the structure: its frequencies lie below sqrt(1 + b K/k) of the modes'.
        let softest = self.modes.iter().map(|mode| mode.stiffness).fold(f64::INFINITY, f64::min);
        let highest = 1.5 * fastest * (1.0 + gain / softest).sqrt();
        let waves = (highest * tau / TAU).ceil() as u32;
        for wave in 0..=waves {
            let mut s = Complex::new(0.0, TAU * (f64::from(wave) + 0.5) / tau);
            if 2.0 * gain * structure.response(s).norm() < LEAST_MULTIPLIER {
                continue;
            }
            for _ in 0..2 {
                let z = 1.0 + 1.0 / (gain * structure.response(s));
                let angle = (-z.arg()).rem_euclid(TAU);
                s = Complex::new(-z.norm().ln(), TAU * f64::from(wave) + angle) / tau;
            }
            polish(s);
        }
        best.ok_or(ChatterError::NotConverged { residual: worst })
    }
}

/// Newton's method on the characteristic function times the modes' polynomials, which has no
/// poles: the step is `1/(f'/f + sum p'/p)`. `slope` is the force by chip thickness (N/m) and
/// `damping` by its rate (N s/m).
fn newton(structure: &Oriented, start: Complex<f64>, tau: f64, [slope, damping]: [f64; 2]) -> Root {
    let zero = Complex::new(0.0, 0.0);
    let mut s = start;
    let mut residual = f64::INFINITY;
    for _ in 0..STEPS {
        let (mut response, mut by_s, mut poles) = (zero, zero, zero);
        for mode in &structure.0 {
            let polynomial = mode.polynomial(s);
            let by_polynomial = (2.0 * s + mode.damping) / polynomial;
            let compliance = mode.inertance / polynomial;
            response += compliance;
            by_s -= compliance * by_polynomial;
            poles += by_polynomial;
        }
        let delayed = (-s * tau).exp();
        let force = slope * (1.0 - delayed) + damping * s;
        let force_by_s = slope * tau * delayed + damping;
        let f = 1.0 + force * response;
        let f_by_s = force_by_s * response + force * by_s;
        let step = 1.0 / (f_by_s / f + poles);
        if !(step.re.is_finite() && step.im.is_finite()) {
            // On a zero or a pole: nothing is left to correct, or nothing can be.
            if f.norm() == 0.0 {
                residual = 0.0;
            }
            break;
        }
        s -= step;
        residual = step.norm() * tau;
        if step.norm() <= ACCURACY * s.norm() {
            residual = residual.min(step.norm() / s.norm());
            break;
        }
    }
    Root { rate: Complex::new(s.re, s.im.abs()), residual }
}
