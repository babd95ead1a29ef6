//! Distributions of inputs and their correlation.

use super::super::normal;
use nalgebra::DMatrix;
use statrs::distribution::{Beta, ContinuousCDF, Gamma};

/// How a number varies from edge to edge.
#[derive(Clone, Debug, PartialEq)]
pub enum Spread {
    /// Normal by mean and standard deviation.
    Normal {
        /// Mean.
        mean: f64,
        /// Standard deviation.
        deviation: f64,
    },
    /// Lognormal by median and standard deviation of the logarithm.
    Lognormal {
        /// Median.
        median: f64,
        /// Standard deviation of the logarithm.
        sigma: f64,
    },
    /// Weibull.
    Weibull {
        /// Scale.
        scale: f64,
        /// Shape.
        shape: f64,
    },
    /// Gamma.
    Gamma {
        /// Scale.
        scale: f64,
        /// Shape.
        shape: f64,
    },
    /// Triangular.
    Triangular {
        /// Least.
        low: f64,
        /// Most likely.
        mode: f64,
        /// Greatest.
        high: f64,
    },
    /// Uniform.
    Uniform {
        /// Least.
        low: f64,
        /// Greatest.
        high: f64,
    },
    /// Beta between two bounds.
    Beta {
        /// Least.
        low: f64,
        /// Greatest.
        high: f64,
        /// First shape.
        alpha: f64,
        /// Second shape.
        beta: f64,
    },
    /// Observed values, each as likely as the others, straight lines between them.
    Empirical(Vec<f64>),
    /// Another spread between two bounds.
    Truncated {
        /// What is cut off.
        spread: Box<Spread>,
        /// Share of it below the lower bound.
        below: f64,
        /// Share of it below the upper bound.
        above: f64,
    },
}

impl Spread {
    /// `spread` between two bounds; `None` where next to nothing of it lies there.
    pub fn truncated(spread: Self, low: f64, high: f64) -> Option<Self> {
        let share = |bound: f64| {
            // The quantile is all that every spread has: its inverse by bisection.
            let (mut a, mut b) = (0.0, 1.0);
            for _ in 0..60 {
                let middle = 0.5 * (a + b);
                *(if spread.quantile(middle) < bound { &mut a } else { &mut b }) = middle;
            }
            0.5 * (a + b)
        };
        let (below, above) = (share(low), share(high));
        (above - below > 1e-6).then(|| Self::Truncated { spread: Box::new(spread), below, above })
    }

    /// The value below which a share `u` of all lie.
    ///
    /// # Examples
    /// ```
    /// use toolroom_life::study::spread::Spread;
    /// let spread = Spread::Uniform { low: 2.0, high: 4.0 };
    /// assert_eq!(Spread::truncated(spread, 3.0, 9.0).unwrap().quantile(0.5), 3.5);
    /// ```
    pub fn quantile(&self, u: f64) -> f64 {
        let u = u.clamp(1e-16, 1.0 - 1e-16);
        match self {
            Self::Normal { mean, deviation } => mean + deviation * normal::quantile(u),
            Self::Lognormal { median, sigma } => median * (sigma * normal::quantile(u)).exp(),
            Self::Weibull { scale, shape } => scale * (-(-u).ln_1p()).powf(shape.recip()),
            Self::Gamma { scale, shape } => Gamma::new(*shape, 1.0).map_or(f64::NAN, |law| scale * law.inverse_cdf(u)),
            Self::Triangular { low, mode, high } => {
                let width = high - low;
                if u * width < mode - low {
                    low + (u * width * (mode - low)).sqrt()
                } else {
                    high - ((1.0 - u) * width * (high - mode)).sqrt()
                }
            }
            Self::Uniform { low, high } => low + u * (high - low),
            Self::Beta { low, high, alpha, beta } => {
                Beta::new(*alpha, *beta).map_or(f64::NAN, |law| low + (high - low) * law.inverse_cdf(u))
            }
            Self::Empirical(values) => {
                let position = u * values.len() as f64 - 0.5;
                let last = values.len() - 1;
                let below = (position.max(0.0) as usize).min(last);
                let part = (position - below as f64).clamp(0.0, 1.0);
                values[below] + part * (values[(below + 1).min(last)] - values[below])
            }
            Self::Truncated { spread, below, above } => spread.quantile(below + u * (above - below)),
        }
    }
}

/// A Gaussian copula: correlated ranks whatever the distributions.
#[derive(Clone, Debug, PartialEq)]
pub struct Copula {
    /// Lower triangle of the Cholesky factor.
    factor: DMatrix<f64>,
}

impl Copula {
    /// From a correlation matrix of normal scores; `None` where it is not positive definite.
    pub fn new(correlation: DMatrix<f64>) -> Option<Self> {
        correlation.cholesky().map(|factor| Self { factor: factor.l() })
    }

    /// Of `dimensions` inputs with the correlations (first, second, value); the others are 0.
    pub fn from_dimensions(dimensions: usize, correlations: &[(usize, usize, f64)]) -> Option<Self> {
        let mut matrix = DMatrix::identity(dimensions, dimensions);
        for &(i, j, value) in correlations {
            (matrix[(i, j)], matrix[(j, i)]) = (value, value);
        }
        Self::new(matrix)
    }

    /// Correlates independent shares in place.
    pub fn apply(&self, shares: &mut [f64]) {
        let scores: Vec<f64> = shares.iter().map(|u| normal::quantile(u.clamp(1e-16, 1.0 - 1e-16))).collect();
        for (i, share) in shares.iter_mut().enumerate() {
            *share = normal::below((0..=i).map(|j| self.factor[(i, j)] * scores[j]).sum());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_scipy() {
        // scipy.stats: ppf(0.2) of norm(3, 2), lognorm(0.4, scale=5), weibull_min(1.5, scale=4),
        // gamma(2.5, scale=3), triang(0.25, loc=1, scale=4), beta(2, 3, loc=1, scale=2),
        // truncnorm of norm(3, 2) on 2 to 6.
        let normal = Spread::Normal { mean: 3.0, deviation: 2.0 };
        let cases = [
            (normal.clone(), 1.316_757_532_9),
            (Spread::Lognormal { median: 5.0, sigma: 0.4 }, 3.570_799_138_7),
            (Spread::Weibull { scale: 4.0, shape: 1.5 }, 1.471_576_639_6),
            (Spread::Gamma { scale: 3.0, shape: 2.5 }, 3.513_801_458_9),
            (Spread::Triangular { low: 1.0, mode: 2.0, high: 5.0 }, 1.894_427_191_0),
            (Spread::Beta { low: 1.0, high: 3.0, alpha: 2.0, beta: 3.0 }, 1.424_634_256_6),
            (Spread::truncated(normal, 2.0, 6.0).unwrap(), 2.664_899_675_3),
        ];
        for (spread, expected) in cases {
            assert!((spread.quantile(0.2) - expected).abs() < 1e-7, "{spread:?}: {}", spread.quantile(0.2));
        }
        let observed = Spread::Empirical(vec![1.0, 2.0, 4.0]);
        assert_eq!([observed.quantile(0.5), observed.quantile(0.01), observed.quantile(0.99)], [2.0, 1.0, 4.0]);
    }

    #[test]
    fn a_copula_correlates_ranks_and_refuses_what_is_no_correlation() {
        let bad = DMatrix::from_row_slice(3, 3, &[1.0, 0.9, -0.9, 0.9, 1.0, 0.9, -0.9, 0.9, 1.0]);
        assert_eq!(Copula::new(bad), None);
        let copula = Copula::new(DMatrix::from_row_slice(2, 2, &[1.0, 0.8, 0.8, 1.0])).unwrap();
        let mut shares = [normal::below(1.0), 0.5];
        copula.apply(&mut shares);
        assert!((normal::quantile(shares[1]) - 0.8).abs() < 1e-9);
    }
}
