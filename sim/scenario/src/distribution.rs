//! Distributions of times.

use rand::RngExt;
use statrs::function::erf::erf_inv;
use statrs::function::gamma::gamma;
use toolroom_kernel::Stream;

/// A positive random time, s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Distribution {
    /// Always the same.
    Constant(f64),
    /// Exponential with this mean.
    Exponential {
        /// Mean, s.
        mean: f64,
    },
    /// Lognormal by mean and coefficient of variation.
    Lognormal {
        /// Mean, s.
        mean: f64,
        /// Standard deviation over mean.
        cv: f64,
    },
    /// Weibull by mean and shape.
    Weibull {
        /// Mean, s.
        mean: f64,
        /// Shape, 1.
        shape: f64,
    },
    /// Triangular.
    Triangular {
        /// Least, s.
        low: f64,
        /// Most likely, s.
        mode: f64,
        /// Greatest, s.
        high: f64,
    },
    /// Uniform.
    Uniform {
        /// Least, s.
        low: f64,
        /// Greatest, s.
        high: f64,
    },
}

impl Distribution {
    /// Mean, s.
    pub fn mean(&self) -> f64 {
        match *self {
            Self::Constant(value) => value,
            Self::Exponential { mean } | Self::Lognormal { mean, .. } | Self::Weibull { mean, .. } => mean,
            Self::Triangular { low, mode, high } => (low + mode + high) / 3.0,
            Self::Uniform { low, high } => 0.5 * (low + high),
        }
    }

    /// Whether every draw gives the same time.
    pub fn is_constant(&self) -> bool {
        matches!(self, Self::Constant(_))
    }

    /// The time below which a share `u` (0 to below 1) of all times lies.
    ///
    /// # Examples
    /// ```
    /// use toolroom_scenario::Distribution;
    /// let repair = Distribution::Uniform { low: 10.0, high: 20.0 };
    /// assert_eq!(repair.quantile(0.25), 12.5);
    /// ```
    pub fn quantile(&self, u: f64) -> f64 {
        let exponential = || -(-u).ln_1p();
        match *self {
            Self::Constant(value) => value,
            Self::Exponential { mean } => mean * exponential(),
            Self::Lognormal { mean, cv } => {
                let variance = (cv * cv).ln_1p();
                // Half a step of the generator above zero, whose quantile is finite.
                let z = std::f64::consts::SQRT_2 * erf_inv(2.0 * u.max(HALF_STEP) - 1.0);
                mean * (variance.sqrt() * z - 0.5 * variance).exp()
            }
            Self::Weibull { mean, shape } => mean / gamma(1.0 + 1.0 / shape) * exponential().powf(1.0 / shape),
            Self::Triangular { low, mode, high } => {
                let (below, above, width) = (mode - low, high - mode, high - low);
                if u * width < below {
                    low + (u * width * below).sqrt()
                } else {
                    high - ((1.0 - u) * width * above).sqrt()
                }
            }
            Self::Uniform { low, high } => low + u * (high - low),
        }
    }

    /// Draws a time from `stream`: always one number of it, so that equal ranks meet under
    /// different distributions and later draws are the same.
    ///
    /// # Examples
    /// ```
    /// use toolroom_scenario::Distribution;
    /// use toolroom_kernel::{Entity, Purpose, Streams};
    /// let mut stream = Streams::new(1, 0).open(Entity::named("lathe"), Purpose::Repair);
    /// assert_eq!(Distribution::Constant(5.0).sample(&mut stream), 5.0);
    /// ```
    pub fn sample(&self, stream: &mut Stream) -> f64 {
        self.quantile(stream.random())
    }
}

/// Half the step of a random number in 0 to 1.
const HALF_STEP: f64 = 0.5 / (1u64 << 53) as f64;

#[cfg(test)]
mod tests {
    use super::*;
    use toolroom_kernel::{Entity, Purpose, Streams};

    #[test]
    fn sample_means_and_spreads_are_those_asked_for() {
        let cases = [
            (Distribution::Exponential { mean: 3.0 }, 3.0),
            (Distribution::Lognormal { mean: 3.0, cv: 0.5 }, 1.5),
            // Weibull of shape 2: cv = sqrt(4/pi - 1).
            (Distribution::Weibull { mean: 3.0, shape: 2.0 }, 3.0 * (4.0 / std::f64::consts::PI - 1.0).sqrt()),
            // Triangular variance (a² + b² + c² - ab - ac - bc)/18.
            (Distribution::Triangular { low: 1.0, mode: 2.0, high: 6.0 }, (21.0f64 / 18.0).sqrt()),
            (Distribution::Uniform { low: 2.0, high: 4.0 }, (4.0f64 / 12.0).sqrt()),
        ];
        for (distribution, deviation) in cases {
            let mut stream = Streams::new(5, 0).open(Entity::named("test"), Purpose::Processing);
            let n = 200_000;
            let (mut sum, mut squares) = (0.0, 0.0);
            for _ in 0..n {
                let value = distribution.sample(&mut stream);
                assert!(value >= 0.0);
                sum += value;
                squares += value * value;
            }
            let mean = sum / f64::from(n);
            let spread = (squares / f64::from(n) - mean * mean).sqrt();
            assert!((mean / distribution.mean() - 1.0).abs() < 0.01, "{distribution:?}: mean {mean}");
            assert!((spread / deviation - 1.0).abs() < 0.02, "{distribution:?}: deviation {spread}");
        }
    }
}
