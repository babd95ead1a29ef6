//! Quantiles of distributions: a distribution function inverted.

use statrs::function::beta::{beta_reg, ln_beta};
use statrs::function::erf::erf_inv;
use statrs::function::gamma::{gamma_lr, ln_gamma};
use std::f64::consts::SQRT_2;

/// Relative width of the bracket, or relative step, at which a search ends: a few steps of a number.
const ACCURACY: f64 = 1e-15;

/// Most steps of a search. Bisection alone needs fewer than 1100 from the least to the greatest
/// number; with steps of Newton's method some five are usual.
const MOST_STEPS: u32 = 1200;

/// The argument in `[low, high]` at which a distribution function reaches `share`.
///
/// `law` gives the function and its slope, the density. Newton's method from `start`; a step that
/// would leave the bracket known so far is replaced by bisection, so that it always ends.
///
/// # Examples
/// ```
/// use toolroom_numerics::inverse;
/// let median = inverse(0.5, [0.0, 100.0], 1.0, |x| (-(-x).exp_m1(), (-x).exp()));
/// assert!((median - 2.0_f64.ln()).abs() < 1e-14);
/// ```
pub fn inverse(share: f64, [mut low, mut high]: [f64; 2], start: f64, law: impl Fn(f64) -> (f64, f64)) -> f64 {
    let mut x = start.clamp(low, high);
    for _ in 0..MOST_STEPS {
        let (below, density) = law(x);
        let error = below - share;
        if error == 0.0 {
            return x;
        }
        if error < 0.0 {
            low = x;
        } else {
            high = x;
        }
        let newton = x - error / density;
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        if (next - x).abs() <= ACCURACY * x.abs() || next <= low && next >= high {
            return next;
        }
        x = next;
    }
    x
}

/// The value below which a `share` (0 to below 1) of a gamma distribution of scale 1 and of this
/// `shape` (above 0) lies.
///
/// # Source
/// Start of the search: E. B. Wilson, M. M. Hilferty, PNAS 17 (1931) 684; for shapes below 1 and small
/// shares the leading term of the series, `(share · Γ(shape + 1))^(1/shape)`.
///
/// # Examples
/// ```
/// // An Erlang distribution of three phases with mean 3.
/// assert!((toolroom_numerics::gamma_quantile(3.0, 0.5) / 2.674_060_313_7 - 1.0).abs() < 1e-10);
/// ```
pub fn gamma_quantile(shape: f64, share: f64) -> f64 {
    if share <= 0.0 {
        return 0.0;
    }
    let ln_gamma_shape = ln_gamma(shape);
    let z = SQRT_2 * erf_inv(2.0 * share - 1.0);
    let cube = (1.0 - 1.0 / (9.0 * shape) + z / (3.0 * shape.sqrt())).powi(3);
    let series = ((share.ln() + ln_gamma_shape + shape.ln()) / shape).exp();
    let start = if shape < 1.0 || cube <= 0.0 || share < 1e-3 { series } else { shape * cube };
    // Beyond this nothing is left of any share that a number can hold.
    let mut most = shape + 60.0 * shape.sqrt() + 800.0;
    while gamma_lr(shape, most) < share && most < f64::MAX / 4.0 {
        most *= 2.0;
    }
    let density = |x: f64| ((shape - 1.0) * x.ln() - x - ln_gamma_shape).exp();
    inverse(share, [f64::MIN_POSITIVE, most], start, |x| (gamma_lr(shape, x), density(x)))
}

/// The value (0 to 1) below which a `share` (0 to below 1) of a beta distribution with the exponents
/// `a` and `b` (above 0) lies.
///
/// # Examples
/// ```
/// let median = toolroom_numerics::beta_quantile(2.0, 2.0, 0.5);
/// assert!((median - 0.5).abs() < 1e-14);
/// ```
pub fn beta_quantile(a: f64, b: f64, share: f64) -> f64 {
    if share <= 0.0 {
        return 0.0;
    }
    let ln_beta = ln_beta(a, b);
    let density = |x: f64| ((a - 1.0) * x.ln() + (b - 1.0) * (-x).ln_1p() - ln_beta).exp();
    inverse(share, [f64::MIN_POSITIVE, 1.0 - f64::EPSILON], a / (a + b), |x| (beta_reg(a, b, x), density(x)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn gamma_quantiles_are_those_of_the_tables() {
        // Computed independently with scipy.stats.gamma.ppf: mean 12 in three phases, and mean 10 with
        // a coefficient of variation of 0.5.
        let erlang = [
            (0.01, 1.744_180_66),
            (0.1, 4.408_261_313),
            (0.5, 10.696_241_25),
            (0.9, 21.289_281_35),
            (0.99, 33.623_787_66),
        ];
        for (share, expected) in erlang {
            assert!((4.0 * gamma_quantile(3.0, share) / expected - 1.0).abs() < 2e-9, "{share}");
        }
        let gamma = [
            (0.01, 2.058_121_716),
            (0.1, 4.361_923_907),
            (0.5, 9.180_151_872),
            (0.9, 16.701_957_67),
            (0.99, 25.112_793_79),
        ];
        for (share, expected) in gamma {
            assert!((2.5 * gamma_quantile(4.0, share) / expected - 1.0).abs() < 2e-9, "{share}");
        }
    }

    proptest! {
        #[test]
        fn a_gamma_quantile_undoes_the_distribution(shape in 0.05..300.0f64, share in 1e-9..0.999_999f64) {
            let x = gamma_quantile(shape, share);
            prop_assert!((gamma_lr(shape, x) - share).abs() < 1e-11, "{shape} {share}: {x}");
        }

        #[test]
        fn a_beta_quantile_undoes_the_distribution(a in 1.0..5.0f64, share in 1e-9..0.999_999f64) {
            let x = beta_quantile(a, 6.0 - a, share);
            prop_assert!((beta_reg(a, 6.0 - a, x) - share).abs() < 1e-11, "{a} {share}: {x}");
        }
    }
}
