//! The D-curve: vibrations that neither grow nor decay.

use super::Turning;
use super::oriented::Oriented;
use nalgebra::Complex;
use std::f64::consts::TAU;

/// The curve of neutral vibrations of a cut at one speed.
pub(super) struct NeutralCurve {
    structure: Oriented,
    force_slope: f64,
    damping_slope: f64,
}

/// A width of cut at which a vibration neither grows nor decays.
#[derive(Clone, Copy, Debug)]
pub(super) struct Neutral {
    /// Width of cut (m).
    pub width: f64,
    /// Angle by which the vibration advances over a revolution, less whole turns (rad).
    pub phase: f64,
}

impl NeutralCurve {
    /// The curve of `cut` at `spindle_speed` (rad/s).
    pub fn new(cut: &Turning, spindle_speed: f64) -> Self {
        Self {
            structure: Oriented::new(cut),
            force_slope: cut.force_slope(),
            damping_slope: cut.damping_slope(spindle_speed),
        }
    }

    /// The neutral vibrations of frequency `w` (rad/s), the smaller width first: from
    /// `1/(b G) = −K_f (1 − e^(−i w tau)) − i w C_i/V`, whose real part is `−K_f (1 − cos)`. The
    /// second is there with process damping only.
    pub fn at(&self, w: f64) -> [Option<Neutral>; 2] {
        let flexibility = 1.0 / self.structure.response(Complex::new(0.0, w));
        // z = (1 − e^(−i phase)) satisfies 1/G/b + Kf z + i damping = 0 and |1 − z| = 1.
        // With B = 1/b: (1 + B Re/Kf)² + ((B Im + damping)/Kf)² = 1, quadratic in B.
        let (re, im) = (flexibility.re / self.force_slope, flexibility.im / self.force_slope);
        let d = w * self.damping_slope / self.force_slope;
        let (a, half, c) = (re * re + im * im, re + im * d, d * d);
        let discriminant = half * half - a * c;
        if discriminant < 0.0 {
            return [None; 2];
        }
        let neutral = |inverse: f64| {
            (inverse > 0.0 && inverse.is_finite()).then(|| {
                let z = -(Complex::new(re, im) * inverse + Complex::new(0.0, d));
                let phase = -(Complex::new(1.0, 0.0) - z).arg();
                Neutral { width: 1.0 / inverse, phase: phase.rem_euclid(TAU) }
            })
        };
        // The greater B is the smaller width.
        let first = neutral((-half + discriminant.sqrt()) / a);
        let second = if d > 0.0 && first.is_some() { neutral((-half - discriminant.sqrt()) / a) } else { None };
        [first, second]
    }
}
