//! The zeroth-order approximation: a preview of the limit, never a verdict.

use super::{Milling, tooth_period_gain};
use crate::error::{ChatterError, positive};
use crate::structure::Mode;
use nalgebra::{Complex, Matrix2};
use std::f64::consts::TAU;

impl Milling {
    /// Limit of depth (m) at `spindle_speed` (rad/s) with the directional matrix averaged over the
    /// tooth period, in closed form; a preview.
    ///
    /// # Validity
    /// Within some 15 % on the Hopf lobes of wide cuts. At low immersion it misses the flip lobes
    /// and is unsafe by a factor of two.
    ///
    /// # Errors
    /// A cut that is none; a speed that is not positive; [`ChatterError::NoLimit`] if every depth
    /// is stable on average.
    ///
    /// # Source
    /// Altintas and Budak (1995).
    pub fn zeroth_order_limit(&self, spindle_speed: f64) -> Result<f64, ChatterError> {
        if self.by_speed.is_some() {
            return self.at_spindle_speed(spindle_speed)?.zeroth_order_limit(spindle_speed);
        }
        if self.along_path.is_some() {
            let limit = |(_, cut): (_, Self)| cut.zeroth_order_limit(spindle_speed);
            let least = self.places().into_iter().map(limit).try_fold(f64::INFINITY, |least, limit| match limit {
                Err(ChatterError::NoLimit { .. }) => Ok::<_, ChatterError>(least),
                limit => Ok(least.min(limit?)),
            })?;
            return if least.is_finite() { Ok(least) } else { Err(ChatterError::NoLimit { searched: f64::INFINITY }) };
        }
        self.check()?;
        self.only_cylinder()?;
        positive("spindle_speed", spindle_speed)?;
        let [xx, xy, yx, yy] = tooth_period_gain(self, 0.0, 1.0);
        let mean = Matrix2::new(xx, xy, yx, yy).map(|g| Complex::new(g, 0.0));
        let tau = TAU / (self.cutter.teeth as f64 * spindle_speed);
        let neutral = |w: f64| {
            let response = self.frequency_response(w / TAU);
            // det(I + depth (1 − e^(−i w tau)) mean G) = 0: depth (1 − e^..) = −1/eigenvalue.
            eigenvalues(&(mean * response)).map(|eigenvalue| {
                let z = -1.0 / eigenvalue;
                let depth = 0.5 * z.re * (1.0 + (z.im / z.re).powi(2));
                let phase = -(Complex::new(1.0, 0.0) - z / depth).arg();
                (depth, ((w * tau - phase) / TAU).rem_euclid(1.0))
            })
        };
        let mut least = f64::INFINITY;
        let mut last: Option<[(f64, f64); 2]> = None;
        for w in frequencies(&self.modes, tau) {
            let here = neutral(w);
            if let Some(last) = last {
                for (depth, misfit) in here {
                    // The same branch at the last frequency is the nearer one.
                    let Some((earlier, before)) =
                        last.into_iter().min_by(|a, b| (a.0 - depth).abs().total_cmp(&(b.0 - depth).abs()))
                    else {
                        continue;
                    };
                    let wraps = before > 0.75 && misfit < 0.25;
                    if wraps && depth > 0.0 && earlier > 0.0 {
                        let share = (1.0 - before) / (1.0 - before + misfit);
                        least = least.min(earlier + (depth - earlier) * share);
                    }
                }
            }
            last = Some(here);
        }
        if least.is_finite() { Ok(least) } else { Err(ChatterError::NoLimit { searched: f64::INFINITY }) }
    }

    /// Frequency response of the relative displacement at `frequency` (Hz), rows of (x, y).
    pub(crate) fn frequency_response(&self, frequency: f64) -> Matrix2<Complex<f64>> {
        self.modes.iter().fold(Matrix2::zeros(), |sum, mode| {
            let [x, y] = mode.unit();
            let dyad = Matrix2::new(x * x, x * y, x * y, y * y);
            sum + dyad.map(|d| mode.compliance(frequency) * d)
        })
    }
}

/// Frequencies (rad/s) that resolve the resonances and the waves of one tooth period.
fn frequencies(modes: &[Mode], tau: f64) -> Vec<f64> {
    let fastest = modes.iter().map(Mode::angular_frequency).fold(0.0, f64::max);
    let narrowest = modes.iter().map(|m| m.angular_frequency() * m.damping_ratio).fold(f64::INFINITY, f64::min);
    let step = (narrowest / 40.0).min(TAU / tau / 40.0).max(fastest / 1e5);
    let count = (3.0 * fastest / step) as usize;
    (1..=count).map(|i| i as f64 * step).collect()
}

/// Eigenvalues of a complex 2 × 2 matrix.
fn eigenvalues(m: &Matrix2<Complex<f64>>) -> [Complex<f64>; 2] {
    let half = (m[(0, 0)] + m[(1, 1)]) * 0.5;
    let root = (half * half - (m[(0, 0)] * m[(1, 1)] - m[(0, 1)] * m[(1, 0)])).sqrt();
    [half + root, half - root]
}
