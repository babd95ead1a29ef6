//! Distributions of times.

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
