//! The normal distribution in its tails.

use statrs::distribution::{ContinuousCDF, Normal};
use statrs::function::erf::erfc;
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// Beyond this many deviations the complementary error function underflows.
const FAR: f64 = 35.0;

/// Probability below `z`.
pub(super) fn below(z: f64) -> f64 {
    0.5 * erfc(-z * FRAC_1_SQRT_2)
}

/// Logarithm of the probability below `z`; in the far tail by the asymptotic series
/// (Abramowitz and Stegun 26.2.12).
pub(super) fn ln_below(z: f64) -> f64 {
    if z > -FAR {
        return below(z).ln();
    }
    let square = z * z;
    -0.5 * square - (-z).ln() - 0.5 * (2.0 * PI).ln() + (-1.0 / square + 3.0 / (square * square)).ln_1p()
}

/// Logarithm of the density at `z`.
pub(super) fn ln_density(z: f64) -> f64 {
    -0.5 * (z * z + (2.0 * PI).ln())
}

/// The `z` below which a share `p` lies.
pub(super) fn quantile(p: f64) -> f64 {
    Normal::standard().inverse_cdf(p)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_far_tail_continues_the_near_one() {
        // scipy.stats.norm.logcdf
        for (z, expected) in [(-10.0, -53.231_285_150_5), (-34.0, -582.446_162_246_9), (-40.0, -804.608_442_013_8)] {
            assert!((ln_below(z) / expected - 1.0).abs() < 1e-9, "{z}: {}", ln_below(z));
        }
        assert!((below(quantile(0.1)) - 0.1).abs() < 1e-10);
    }
}
