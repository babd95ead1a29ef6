//! Noise of the wear rate within a life, and readings that it joins.

use crate::normal::HALF_LN_TAU;

/// Noise of the wear rate within a life: an Ornstein–Uhlenbeck process.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InLife {
    /// Standard deviation of the logarithm of the rate.
    pub deviation: f64,
    /// Correlation time, min of cutting.
    pub correlation: f64,
}

impl InLife {
    /// Covariance in min² of the two integrals of the noise from 0 to `s` and to `t`, both in min.
    ///
    /// # Examples
    /// ```
    /// let noise = toolroom_calibrate::InLife { deviation: 0.1, correlation: 5.0 };
    /// assert!((noise.covariance(8.0, 20.0) - 0.582_373_5).abs() < 1e-7);
    /// ```
    pub fn covariance(&self, s: f64, t: f64) -> f64 {
        let l = self.correlation;
        let fades = (-s / l).exp() + (-t / l).exp() - 1.0 - (-(t - s).abs() / l).exp();
        self.deviation * self.deviation * l * (2.0 * s.min(t) + l * fades)
    }

    /// How the noise goes on between rising times in min, the first of them counted from zero.
    pub(crate) fn steps(&self, times: impl Iterator<Item = f64>) -> Vec<Step> {
        let mut before = 0.0;
        let step = |time: f64| {
            let d = (time - before) / self.correlation;
            before = time;
            Step::over(d, self.correlation)
        };
        times.map(step).collect()
    }

    /// Log density of readings that this noise joins, and the whitened products of a Gauss–Newton step.
    ///
    /// The noise and its integral are a Markov process, so that a Kalman filter with two states gives the density of the
    /// joint normal distribution with [`InLife::covariance`] in a time in proportion to the readings (A. C. Harvey,
    /// Forecasting, Structural Time Series Models and the Kalman Filter, Cambridge 1989, section 3.4).
    pub(crate) fn filter(&self, steps: &[Step], readings: impl Iterator<Item = Noisy>) -> Filtered {
        // Mean of the integral and the noise given the readings so far, for the deviations and for the slopes.
        let (mut off, mut slope) = ([0.0; 2], [0.0; 2]);
        let mut joined = Joined::new(self);
        let mut found = Filtered::default();
        for (step, reading) in steps.iter().zip(readings) {
            for mean in [&mut off, &mut slope] {
                *mean = step.mean(*mean);
            }
            let pace = reading.pace;
            let (gain, precision) = joined.read(step, pace, reading.variance);
            let (missed, turned) = (reading.off - pace * off[0], reading.slope - pace * slope[0]);
            for (mean, news) in [(&mut off, missed), (&mut slope, turned)] {
                *mean = [mean[0] + gain[0] * news, mean[1] + gain[1] * news];
            }
            found.density -= 0.5 * missed * missed * precision;
            found.gradient += missed * turned * precision;
            found.curvature += turned * turned * precision;
        }
        found.density += joined.ln_scale();
        found
    }

    /// Log densities of `N` sets of deviations of the same readings from what is expected without noise. How the noise joins
    /// them does not depend on the deviations and is worked out once for all sets. Of each reading come its rate in mm/min, the
    /// variance of its error in mm², and its deviations in mm.
    pub(crate) fn densities<const N: usize>(
        &self,
        steps: &[Step],
        readings: impl Iterator<Item = (f64, f64, [f64; N])>,
    ) -> [f64; N] {
        let (mut integral, mut noise, mut squares) = ([0.0; N], [0.0; N], [0.0; N]);
        let mut joined = Joined::new(self);
        for (step, (pace, variance, off)) in steps.iter().zip(readings) {
            let (gain, precision) = joined.read(step, pace, variance);
            for set in 0..N {
                let [before, now] = step.mean([integral[set], noise[set]]);
                let missed = off[set] - pace * before;
                (integral[set], noise[set]) = (before + gain[0] * missed, now + gain[1] * missed);
                squares[set] += missed * missed * precision;
            }
        }
        let scale = joined.ln_scale();
        squares.map(|squares| scale - 0.5 * squares)
    }

    /// The integral of the noise at the ends of steps, min; `normal` draws standard normal numbers.
    pub(crate) fn integrals(&self, steps: &[Step], mut normal: impl FnMut() -> f64) -> Vec<f64> {
        let (mut integral, mut noise) = (0.0, normal());
        let at = |step: &Step| {
            let (first, second) = (normal(), normal());
            let root = step.noise.sqrt();
            let share = if root > 0.0 { step.mixed / root } else { 0.0 };
            integral += step.reach * noise + share * first + (step.integral - share * share).max(0.0).sqrt() * second;
            noise = step.kept * noise + root * first;
            self.deviation * integral
        };
        steps.iter().map(at).collect()
    }
}

/// The covariance of the integral of the noise and of the noise itself, given the readings so far.
struct Joined {
    /// Variance of the noise, 1.
    variance: f64,
    /// Variance of the integral, min².
    xx: f64,
    /// Covariance of both, min.
    xo: f64,
    /// Variance of the noise, 1.
    oo: f64,
    /// Of the variances of the readings, whose logarithms are asked for only when it would leave the range of numbers.
    product: f64,
    /// Logarithm of the factor of the density that does not depend on the readings.
    ln_scale: f64,
}

impl Joined {
    fn new(noise: &InLife) -> Self {
        let variance = noise.deviation * noise.deviation;
        Self { variance, xx: 0.0, xo: 0.0, oo: variance, product: 1.0, ln_scale: 0.0 }
    }

    /// A step, and a reading at its end: how much of its surprise goes to the integral and to the noise, and the precision of
    /// the reading.
    fn read(&mut self, step: &Step, pace: f64, error: f64) -> ([f64; 2], f64) {
        let Step { kept, reach, integral, mixed, noise } = *step;
        self.xx += reach * (2.0 * self.xo + reach * self.oo) + self.variance * integral;
        self.xo = kept * (self.xo + reach * self.oo) + self.variance * mixed;
        self.oo = kept * kept * self.oo + self.variance * noise;
        let variance = pace * pace * self.xx + error;
        let precision = 1.0 / variance;
        let gain = [pace * self.xx * precision, pace * self.xo * precision];
        self.oo -= gain[1] * pace * self.xo;
        self.xo -= gain[0] * pace * self.xo;
        self.xx -= gain[0] * pace * self.xx;
        self.product *= variance;
        if !PRODUCTS.contains(&self.product) {
            self.ln_scale -= 0.5 * self.product.ln();
            self.product = 1.0;
        }
        self.ln_scale -= HALF_LN_TAU;
        (gain, precision)
    }

    /// Logarithm of the factor of the density that does not depend on the readings.
    fn ln_scale(&self) -> f64 {
        self.ln_scale - 0.5 * self.product.ln()
    }
}

/// Products of variances that are far from the ends of the range of numbers.
const PRODUCTS: std::ops::Range<f64> = 1e-200..1e200;

/// A step of noise of unit variance and its integral.
#[derive(Clone, Copy)]
pub(crate) struct Step {
    /// Share of the noise that is left.
    kept: f64,
    /// What the noise at the beginning adds to the integral, min.
    reach: f64,
    /// Variance that the integral gains, min².
    integral: f64,
    /// Covariance that both gain, min.
    mixed: f64,
    /// Variance that the noise gains.
    noise: f64,
}

impl Step {
    /// Mean of the integral and of the noise after this step, from those before it.
    fn mean(&self, [integral, noise]: [f64; 2]) -> [f64; 2] {
        [integral + self.reach * noise, self.kept * noise]
    }

    /// A step of `d` correlation times of `l` min.
    fn over(d: f64, l: f64) -> Self {
        let kept = (-d).exp();
        // The difference below cancels where the time is short.
        let grown = if d < 0.03 {
            d * d * d * (2.0 / 3.0 - d * (0.5 - d * (7.0 / 30.0 - d / 12.0)))
        } else {
            2.0 * d - 3.0 + kept * (4.0 - kept)
        };
        Self {
            kept,
            reach: l * (1.0 - kept),
            integral: l * l * grown,
            mixed: l * (1.0 - kept).powi(2),
            noise: 1.0 - kept * kept,
        }
    }
}

/// A reading under noise of the rate.
pub(crate) struct Noisy {
    /// Wear rate, mm/min.
    pub pace: f64,
    /// Variance of the error of the reading, mm².
    pub variance: f64,
    /// How far it is from what is expected without noise, mm.
    pub off: f64,
    /// Derivative of what is expected by the level, mm.
    pub slope: f64,
}

/// What a filter tells of readings.
#[derive(Default)]
pub(crate) struct Filtered {
    /// Log density.
    pub density: f64,
    /// Derivative of the log density by the level, the covariance held.
    pub gradient: f64,
    /// Minus its second derivative.
    pub curvature: f64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Cholesky, DMatrix, DVector};

    #[test]
    fn the_filter_gives_the_joint_density_and_the_integrals_their_covariance() {
        let noise = InLife { deviation: 0.1, correlation: 5.0 };
        let times = [0.02, 2.0, 8.0, 20.0, 20.1];
        let pace = [0.05, 0.02, 0.01, 0.012, 0.02];
        let (off, slope) = ([0.01, -0.02, 0.03, 0.0, -0.01], [0.01, 0.03, 0.06, 0.08, 0.09]);
        let variance = |i: usize| 1e-4 / (i + 1) as f64;
        let readings = (0..5).map(|i| Noisy { pace: pace[i], variance: variance(i), off: off[i], slope: slope[i] });
        let steps = noise.steps(times.into_iter());
        let found = noise.filter(&steps, readings);
        let covariance = DMatrix::from_fn(5, 5, |i, j| {
            let diagonal = if i == j { variance(i) } else { 0.0 };
            diagonal + pace[i] * pace[j] * noise.covariance(times[i], times[j])
        });
        let factor = Cholesky::new(covariance).expect("positive");
        let (off, slope) = (DVector::from_row_slice(&off), DVector::from_row_slice(&slope));
        let density =
            -0.5 * off.dot(&factor.solve(&off)) - factor.l().diagonal().map(f64::ln).sum() - 5.0 * HALF_LN_TAU;
        assert!((found.density - density).abs() < 1e-9, "{} against {density}", found.density);
        assert!((found.gradient - slope.dot(&factor.solve(&off))).abs() < 1e-9);
        assert!((found.curvature - slope.dot(&factor.solve(&slope))).abs() < 1e-9);

        // Each integral is linear in the numbers that are drawn: their products give the covariance.
        let size = 1 + 2 * times.len();
        let weights = DMatrix::from_fn(times.len(), size, |i, j| {
            let mut place = 0;
            let unit = || {
                place += 1;
                if place == j + 1 { 1.0 } else { 0.0 }
            };
            noise.integrals(&steps, unit)[i]
        });
        let drawn = &weights * weights.transpose();
        for (i, s) in times.iter().enumerate() {
            for (j, t) in times.iter().enumerate() {
                assert!((drawn[(i, j)] - noise.covariance(*s, *t)).abs() < 1e-9, "{s} {t}");
            }
        }
    }
}
