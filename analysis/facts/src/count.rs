//! Exact tests of counts.

use statrs::distribution::{Binomial, Discrete};
use statrs::function::beta::beta_reg;
use statrs::function::gamma::{gamma_lr, gamma_ur, ln_gamma};
use toolroom_numerics::gamma_quantile;

/// Level of the tests of all facts together, as a probability (1). Assumption: one in a hundred logs of a
/// shop that is as its file says shows a fact by chance.
pub const LEVEL: f64 = 0.01;
/// Probability with which the least sizes that are printed would have been seen (1; assumption).
pub const POWER: f64 = 0.9;

/// Two-sided mid-p of a count: twice the smaller of the tails `P(X < n)` and `P(X > n)`, each with half of
/// `P(X = n)`; at most 1. All arguments are probabilities.
///
/// # Source
/// H. O. Lancaster, Journal of the American Statistical Association 56 (1961) 223.
pub fn mid_p(below: f64, equal: f64, above: f64) -> f64 {
    (2.0 * (below + 0.5 * equal).min(above + 0.5 * equal)).min(1.0)
}

/// Probabilities of fewer, exactly as many and more events than `count` under a Poisson law of `mean`
/// (above 0; 1).
pub(crate) fn poisson_tails(count: u64, mean: f64) -> [f64; 3] {
    let n = count as f64;
    let below = if count == 0 { 0.0 } else { gamma_ur(n, mean) };
    [below, (n * mean.ln() - mean - ln_gamma(n + 1.0)).exp(), gamma_lr(n + 1.0, mean)]
}

/// Exact two-sided mid-p of `count` events where `mean` (above 0) are expected.
///
/// # Examples
/// ```
/// use toolroom_facts::count::poisson_mid_p;
/// assert!((poisson_mid_p(10, 20.0) / 0.015_807 - 1.0).abs() < 1e-4);
/// ```
pub fn poisson_mid_p(count: u64, mean: f64) -> f64 {
    let [below, equal, above] = poisson_tails(count, mean);
    mid_p(below, equal, above)
}

/// Exact ends of the interval of a Poisson mean of which `count` events were seen, at the two-sided
/// `level` (0 to 1); the lower end is 0 without events.
///
/// # Source
/// F. Garwood, Biometrika 28 (1936) 437.
///
/// # Examples
/// ```
/// let [low, high] = toolroom_facts::count::garwood(10, 0.9);
/// assert!((160.0 / high - 9.4327).abs() < 1e-4 && (160.0 / low - 29.4909).abs() < 1e-4);
/// ```
pub fn garwood(count: u64, level: f64) -> [f64; 2] {
    let tail = 0.5 * (1.0 - level);
    let low = if count == 0 { 0.0 } else { gamma_quantile(count as f64, tail) };
    [low, gamma_quantile(count as f64 + 1.0, 1.0 - tail)]
}

/// Exact two-sided mid-p of `count` (at most `of`) where each of `of` happens with probability `share`
/// (0 to 1). A share of 0 or 1 leaves no chance: 1 where the count agrees, else 0.
///
/// # Examples
/// ```
/// use toolroom_facts::count::binomial_mid_p;
/// assert!((binomial_mid_p(9, 400, 0.01) / 0.028_572_1 - 1.0).abs() < 1e-5);
/// ```
pub fn binomial_mid_p(count: u64, total: u64, share: f64) -> f64 {
    if share <= 0.0 || share >= 1.0 {
        let certain = if share <= 0.0 { 0 } else { total };
        return f64::from(u8::from(count == certain));
    }
    let (k, n) = (count as f64, total as f64);
    let equal = Binomial::new(share, total).map_or(f64::NAN, |law| law.pmf(count));
    let below = if count == 0 { 0.0 } else { beta_reg(n - k + 1.0, k, 1.0 - share) };
    let above = if count >= total { 0.0 } else { beta_reg(k + 1.0, n - k, share) };
    mid_p(below, equal, above)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn counts_of_failures_have_the_probabilities_computed_independently() {
        assert!((poisson_mid_p(10, 20.0) / 0.015_807 - 1.0).abs() < 1e-4);
        assert!((poisson_mid_p(0, 5.0) / (-5.0_f64).exp() - 1.0).abs() < 1e-9);
        assert!((binomial_mid_p(9, 400, 0.01) / 0.028_572_1 - 1.0).abs() < 2e-6);
        assert!((poisson_mid_p(75, 72.0) / 0.711_391 - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_share_without_chance_is_met_or_not() {
        assert_eq!([binomial_mid_p(0, 9, 0.0), binomial_mid_p(1, 9, 0.0), binomial_mid_p(9, 9, 1.0)], [1.0, 0.0, 1.0]);
    }

    proptest! {
        #[test]
        fn the_three_probabilities_of_a_count_sum_to_one(count in 0..400_u64, mean in 0.01..300.0_f64) {
            let tails = poisson_tails(count, mean);
            prop_assert!((tails.iter().sum::<f64>() - 1.0).abs() < 1e-9, "{tails:?}");
            let p = poisson_mid_p(count, mean);
            prop_assert!((0.0..=1.0).contains(&p));
        }

        #[test]
        fn the_ends_of_a_rate_are_where_the_tails_hold_a_twentieth(count in 1..300_u64) {
            let [low, high] = garwood(count, 0.9);
            prop_assert!((gamma_lr(count as f64, low) - 0.05).abs() < 1e-9);
            prop_assert!((gamma_ur(count as f64 + 1.0, high) - 0.05).abs() < 1e-9);
        }
    }
}
