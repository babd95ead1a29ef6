//! The normal distribution in its tails.

use statrs::function::erf::erfc;
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// `½ ln 2π`.
pub const HALF_LN_TAU: f64 = 0.918_938_533_204_672_7;
/// Beyond this many deviations the complementary error function underflows.
const FAR: f64 = 35.0;

/// Logarithm of the probability below `z`; in the far tail by the asymptotic series (Abramowitz and Stegun 26.2.12).
pub fn ln_below(z: f64) -> f64 {
    if z > -FAR {
        return (0.5 * erfc(-z * FRAC_1_SQRT_2)).ln();
    }
    let square = z * z;
    -0.5 * square - (-z).ln() - 0.5 * (2.0 * PI).ln() + (-1.0 / square + 3.0 / (square * square)).ln_1p()
}

/// Logarithm of the probability between `low` and `high`.
pub fn ln_between(low: f64, high: f64) -> f64 {
    // In the upper tail the difference of two numbers near 1 would lose every digit.
    let (low, high) = if low > 0.0 { (-high, -low) } else { (low, high) };
    let (below, above) = (ln_below(low), ln_below(high));
    above + (-(below - above).exp()).ln_1p()
}

/// Logarithm of the density of a normal distribution.
pub fn ln_density(value: f64, mean: f64, deviation: f64) -> f64 {
    let z = (value - mean) / deviation;
    -0.5 * z * z - deviation.ln() - HALF_LN_TAU
}

/// Logarithm of a sum of exponentials.
pub fn ln_sum(terms: &[f64]) -> f64 {
    let greatest = terms.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if !greatest.is_finite() {
        return greatest;
    }
    greatest + terms.iter().map(|term| (term - greatest).exp()).sum::<f64>().ln()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_far_interval_keeps_its_digits() {
        // scipy: log(norm.sf(10) - norm.sf(11))
        assert!((ln_between(10.0, 11.0) + 53.231_310_2).abs() < 2e-4, "{}", ln_between(10.0, 11.0));
        assert!((ln_between(-1.0, 1.0).exp() - 0.682_689_492).abs() < 1e-8);
        assert!((ln_sum(&[-1000.0, -1000.0]) + 1000.0 - 2f64.ln()).abs() < 1e-12);
    }
}
