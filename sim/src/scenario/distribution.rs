//! Distributions of times.

use crate::Stream;
use rand::RngExt;
use rand_distr::{Distribution as _, StandardNormal};
use statrs::function::gamma::gamma;

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

    /// The value below which a share `u` of all times lies; lognormal times take `z`, the
    /// standard normal number of the same rank, instead.
    ///
    /// One number of a stream a draw, so that two policies that draw the same rank get the same
    /// or a proportional time.
    fn quantile(&self, u: f64, z: impl FnOnce() -> f64) -> f64 {
        let exponential = || -(-u).ln_1p();
        match *self {
            Self::Constant(value) => value,
            Self::Exponential { mean } => mean * exponential(),
            Self::Lognormal { mean, cv } => {
                let variance = (cv * cv).ln_1p();
                mean * (variance.sqrt() * z() - 0.5 * variance).exp()
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

    /// Draws a time from `stream`.
    ///
    /// # Examples
    /// ```
    /// use toolroom_sim::scenario::Distribution;
    /// use toolroom_sim::{Entity, Purpose, Streams};
    /// let mut stream = Streams::new(1, 0).open(Entity::named("lathe"), Purpose::Repair);
    /// assert_eq!(Distribution::Constant(5.0).sample(&mut stream), 5.0);
    /// ```
    pub fn sample(&self, stream: &mut Stream) -> f64 {
        match self {
            Self::Constant(value) => *value,
            Self::Lognormal { .. } => self.quantile(0.5, || StandardNormal.sample(stream)),
            _ => self.quantile(stream.random(), || 0.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Entity, Purpose, Streams};

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
