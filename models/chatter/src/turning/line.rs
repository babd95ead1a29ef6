//! The loop gain of a turning cut on the imaginary axis, with bounds on its derivatives.

use super::Turning;
use super::oriented::Oriented;
use crate::error::{ChatterError, positive, within};
use nalgebra::Complex;
use std::f64::consts::TAU;

/// Greatest ratio of the process damping to the cutting force at the fastest mode, `w C_i/(V K_f)`. Assumption: a cut
/// that is damped that much more than it is excited is none, and the frequencies of its neutral vibrations, which go
/// with the ratio, stay far from the end of the numbers.
const GREATEST_DAMPING: f64 = 1e15;

/// The loop gain per width, `L(i w) = G(i w) [K_f (1 − exp(−i w tau)) + i w C_i/V]` (1/m): the cut has a neutral
/// vibration of frequency w at the width b where `1 + b L = 0`.
pub(super) struct LoopGain {
    modes: Vec<Pole>,
    /// K_f (N/m²).
    slope: f64,
    /// C_i/V (N s/m²).
    damping: f64,
    /// Time of a revolution (s).
    tau: f64,
}

/// A mode by its pole `−decay ± i damped`.
struct Pole {
    inertance: f64,
    decay: f64,
    damped: f64,
    frequency: f64,
}

/// The loop gain at a frequency, with its derivative by the frequency.
#[derive(Clone, Copy)]
pub(super) struct Value {
    pub gain: Complex<f64>,
    pub slope: Complex<f64>,
    response: Complex<f64>,
}

/// What holds everywhere in an interval of frequencies.
pub(super) struct Bounds {
    /// Greatest `1/b` of a neutral vibration, whatever its phase.
    pub greatest_inverse_width: f64,
    /// Whether the damping of the cut leaves no phase at which a vibration is neutral.
    pub damped: bool,
    /// Greatest modulus of the first and of the second derivative of the loop gain.
    pub slope: f64,
    pub curvature: f64,
}

impl LoopGain {
    /// # Errors
    /// A cut that is none; a speed that is not positive, or so low that process damping is all that there is.
    pub fn new(cut: &Turning, spindle_speed: f64) -> Result<Self, ChatterError> {
        cut.check()?;
        positive("spindle_speed", spindle_speed)?;
        let cut = &*cut.at_spindle_speed(spindle_speed)?;
        let damping_ratio = cut.always_stable_below() / spindle_speed;
        within("process damping over the cutting force", damping_ratio, 0.0, GREATEST_DAMPING)?;
        let pole = |mode: &super::oriented::OrientedMode| {
            let decay = 0.5 * mode.damping;
            let damped = (mode.frequency * mode.frequency - decay * decay).sqrt();
            Pole { inertance: mode.inertance, decay, damped, frequency: mode.frequency }
        };
        Ok(Self {
            modes: Oriented::new(cut).0.iter().map(pole).collect(),
            slope: cut.force_slope(),
            damping: cut.damping_slope(spindle_speed),
            tau: TAU / spindle_speed,
        })
    }

    /// Resonances (rad/s), ascending.
    pub fn resonances(&self) -> Vec<f64> {
        let mut resonances: Vec<f64> = self.modes.iter().map(|mode| mode.damped).collect();
        resonances.sort_by(f64::total_cmp);
        resonances
    }

    /// A width (m) so great that the cut is a thousand times as stiff as the structure.
    pub fn stiff_width(&self) -> f64 {
        let compliance: f64 = self.modes.iter().map(|mode| mode.inertance.abs() / mode.frequency.powi(2)).sum();
        1e3 / (self.slope * compliance)
    }

    /// A frequency (rad/s) beyond which `|b L| < 1` for good at every width up to `greatest`.
    pub fn highest_frequency(&self, greatest: f64) -> f64 {
        let fastest = self.modes.iter().map(|mode| mode.frequency).fold(0.0, f64::max);
        let mut w = 2.0 * fastest;
        loop {
            // Each term falls with the frequency beyond the mode.
            let response = self.modes.iter().map(|mode| mode.inertance.abs() / (w * w - mode.frequency.powi(2)));
            if greatest * response.sum::<f64>() * (2.0 * self.slope + w * self.damping) < 1.0 {
                return w;
            }
            w *= 1.5;
        }
    }

    /// The loop gain at `w` (rad/s).
    pub fn at(&self, w: f64) -> Value {
        let zero = Complex::new(0.0, 0.0);
        let (mut response, mut by_w) = (zero, zero);
        for mode in &self.modes {
            let polynomial = Complex::new(mode.frequency * mode.frequency - w * w, 2.0 * mode.decay * w);
            let compliance = mode.inertance / polynomial;
            response += compliance;
            by_w -= compliance * Complex::new(-2.0 * w, 2.0 * mode.decay) / polynomial;
        }
        let (sin, cos) = (w * self.tau).sin_cos();
        let force = Complex::new(self.slope * (1.0 - cos), self.slope * sin + w * self.damping);
        let force_by_w = Complex::new(self.slope * self.tau * sin, self.slope * self.tau * cos + self.damping);
        Value { gain: response * force, slope: by_w * force + response * force_by_w, response }
    }

    /// Bounds over the interval of half width `half` about `middle`, where the loop gain is `value`.
    ///
    /// A mode is `a/((s − p)(s − p*))`, so that distances from the poles bound it and its derivatives. For a neutral
    /// vibration `1/(b G) + K_f (1 − z) + i w C = 0` with `|z| = 1`, a quadratic in 1/b whose greater root is at most
    /// `−2 K_f Re G + 2 w C Im G` and which has real roots only if `|K_f Re G − w C Im G| ≥ |G| w C`.
    pub fn bounds(&self, middle: f64, half: f64, value: &Value) -> Bounds {
        let (mut g0, mut g1, mut g2) = (0.0, 0.0, 0.0);
        for mode in &self.modes {
            let near = ((middle - mode.damped).abs() - half).max(0.0);
            let far = middle - half + mode.damped;
            let near = 1.0 / (mode.decay * mode.decay + near * near).sqrt();
            let far = 1.0 / (mode.decay * mode.decay + far * far).sqrt();
            let size = mode.inertance.abs() * near * far;
            g0 += size;
            g1 += size * (near + far);
            g2 += 2.0 * size * (near * near + near * far + far * far);
        }
        let response = value.response;
        // Bounds need no care for the last digit, which `norm` takes.
        let modulus = response.norm_sqr().sqrt();
        let g0 = g0.min(modulus + half * g1);
        let (k, tau, highest) = (self.slope, self.tau, middle + half);
        let c = highest * self.damping;
        let force = 2.0 * k + c;
        let turn = k * tau + self.damping;
        let slope = g1 * force + g0 * turn;
        // Of the neutral vibrations, whatever the phase.
        let middle_c = middle * self.damping;
        let envelope = -2.0 * k * response.re
            + 2.0 * middle_c * response.im
            + 2.0 * half * (g1 * (k * k + c * c).sqrt() + self.damping * g0);
        let real =
            (k * response.re - middle_c * response.im).abs() + half * (g1 * (k * k + c * c).sqrt() + self.damping * g0);
        let least_damping = (middle - half) * self.damping * (modulus - half * g1);
        let size = (g0 * force).min(value.gain.norm_sqr().sqrt() + half * slope);
        Bounds {
            greatest_inverse_width: envelope.min(size),
            damped: least_damping > 0.0 && least_damping > real,
            slope,
            curvature: g2 * force + 2.0 * g1 * turn + g0 * k * tau * tau,
        }
    }
}
