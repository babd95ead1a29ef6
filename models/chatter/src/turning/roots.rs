//! The rightmost characteristic root of a turning cut at constant speed.

use super::Turning;
use super::crossings::{Crossings, NeutralVibration};
use super::line::LoopGain;
use super::oriented::Oriented;
use crate::error::{ChatterError, within};
use crate::structure::last_to_decay;
use nalgebra::Complex;
use std::borrow::Cow;
use std::f64::consts::TAU;

/// Chains of roots are left out where the cut cannot make a multiplier greater than this: there
/// `|exp(s tau)| ≈ b K_f |G|`.
const LEAST_MULTIPLIER: f64 = 0.02;
/// How far beyond the greatest width neutral vibrations are searched.
const BEYOND: f64 = 1.25;
/// Width over that of a stiff cut up to which the structure alone answers: a billionth of its stiffness.
const NEGLIGIBLE: f64 = 1e-12;
/// Steps in which a root is followed from a neutral vibration to the width.
const FOLLOWED: u32 = 64;
/// Logarithm of the spectral radius that rounding can make of a neutral vibration: the accuracy of a root times some
/// hundred waves in a revolution.
const NEUTRAL: f64 = 1e-9;
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

/// The rightmost of the roots that were found.
#[derive(Default)]
struct Candidates {
    best: Option<Root>,
    /// Greatest residual so far, the reason if none is good enough.
    worst: f64,
}

impl Candidates {
    fn keep(&mut self, root: Root) {
        self.worst = self.worst.max(root.residual.min(f64::MAX));
        if root.residual <= 1e3 * ACCURACY && self.best.is_none_or(|best| root.rate.re > best.rate.re) {
            self.best = Some(root);
        }
    }
}

/// A turning cut at one speed, ready for verdicts at many widths.
pub(crate) struct TurningAtSpeed<'a> {
    /// With the modes of this speed.
    cut: Cow<'a, Turning>,
    structure: Oriented,
    pub(super) spindle_speed: f64,
    stiff_width: f64,
    vibrations: Vec<NeutralVibration>,
}

impl<'a> TurningAtSpeed<'a> {
    /// For widths up to `greatest` (m) at `spindle_speed` (rad/s).
    ///
    /// # Errors
    /// A cut that is none; a speed that is not positive; a width that is negative or makes the cut more than a thousand
    /// times as stiff as the structure.
    pub fn new(cut: Cow<'a, Turning>, spindle_speed: f64, greatest: f64) -> Result<Self, ChatterError> {
        let line = LoopGain::new(&cut, spindle_speed)?;
        let other = match cut.at_spindle_speed(spindle_speed)? {
            Cow::Owned(other) => Some(other),
            Cow::Borrowed(_) => None,
        };
        let cut = other.map_or(cut, Cow::Owned);
        // Beyond, the vibrations that a cut could have are without number.
        within("width", greatest, 0.0, line.stiff_width())?;
        // Somewhat beyond, where the vibration lies that a stable cut is nearest to.
        let vibrations = Crossings::new(&line).up_to(greatest * BEYOND);
        Ok(Self { structure: Oriented::new(&cut), cut, spindle_speed, stiff_width: line.stiff_width(), vibrations })
    }

    /// Number of unstable roots at `width` (m).
    pub fn unstable_roots(&self, width: f64) -> i32 {
        self.vibrations.iter().take_while(|vibration| vibration.width <= width).map(|vibration| vibration.change).sum()
    }

    /// The rightmost zero of `1 + b [K_f (1 − exp(−s tau)) + s C_i/V] G(s)` at `width` (m).
    ///
    /// At constant speed the cut repeats in every instant, not only after a revolution; its
    /// multipliers are `exp(s tau)`. They lie in chains, one root to a whole number of waves in a
    /// revolution, so that Newton's method starts once a wave, from `exp(−s tau) = 1 + 1/(b K_f G)`, at the
    /// structure's own poles and at the neutral vibrations next to the width. The root must lie on the side of the
    /// imaginary axis that the number of unstable roots says; otherwise it is followed from the neutral vibrations
    /// below the width.
    pub(super) fn rightmost_root(&self, width: f64) -> Result<Root, ChatterError> {
        let cut = &*self.cut;
        if width <= NEGLIGIBLE * self.stiff_width {
            // Nothing feeds the vibration back: the roots are the poles of the structure.
            let rate = last_to_decay(cut.modes.iter().filter(|mode| cut.orientation(mode) != 0.0));
            return Ok(Root { rate, residual: 0.0 });
        }
        let tau = TAU / self.spindle_speed;
        let structure = &self.structure;
        let damping = cut.damping_slope(self.spindle_speed);
        let gain = width * cut.force_slope();
        let polished = |start, width: f64| newton(structure, start, tau, [width * cut.force_slope(), width * damping]);
        let mut candidates = Candidates::default();
        for mode in &structure.0 {
            let decay = 0.5 * mode.damping;
            let damped = (mode.frequency * mode.frequency - decay * decay).sqrt();
            candidates.keep(polished(Complex::new(-decay, damped * (1.0 + 1e-9)), width));
        }
        let below = self.vibrations.partition_point(|vibration| vibration.width <= width);
        let beside = below.saturating_sub(2)..(below + 2).min(self.vibrations.len());
        for vibration in &self.vibrations[beside] {
            candidates.keep(polished(Complex::new(0.0, vibration.frequency), width));
        }
        // The cut stiffens the structure: its frequencies lie below sqrt(1 + b K/k) of the modes'.
        let fastest = cut.modes.iter().map(|mode| mode.angular_frequency()).fold(0.0, f64::max);
        let softest = cut.modes.iter().map(|mode| mode.stiffness).fold(f64::INFINITY, f64::min);
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
            candidates.keep(polished(s, width));
        }
        let unstable = self.unstable_roots(width) > 0;
        if unstable && candidates.best.is_none_or(|best| best.rate.re <= 0.0) {
            for vibration in self.vibrations[..below].iter().rev() {
                let mut s = Complex::new(0.0, vibration.frequency);
                for step in 1..=FOLLOWED {
                    let share = f64::from(step) / f64::from(FOLLOWED);
                    let root = polished(s, vibration.width * (width / vibration.width).powf(share));
                    s = root.rate;
                    if step == FOLLOWED {
                        candidates.keep(root);
                    }
                }
            }
        }
        let mut best = candidates.best.ok_or(ChatterError::NotConverged { residual: candidates.worst })?;
        if (best.rate.re > 0.0) != unstable {
            // At a neutral vibration rounding decides; anywhere else a root is missing.
            if best.rate.re.abs() * tau > NEUTRAL {
                return Err(ChatterError::NotConverged { residual: best.rate.re.abs() * tau });
            }
            best.rate.re = if unstable { f64::MIN_POSITIVE } else { 0.0 };
        }
        Ok(best)
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
