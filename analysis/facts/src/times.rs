//! Times of what machines and people do, against their distribution.

use crate::count::{LEVEL, POWER};
use crate::fact::{Fact, Quantity};
use crate::told::FactDetail;
use statrs::distribution::{ContinuousCDF, Normal};
use statrs::function::erf::{erf, erfc};
use statrs::function::gamma::{gamma_lr, gamma_ur};
use toolroom_scenario::Distribution;
use toolroom_statistics::{Moments, student};

/// Fewest times that are tested (assumption).
const FEWEST: usize = 3;
/// Normal scores are followed this far; what lies beyond is impossible under the file.
const FARTHEST: f64 = 8.0;
/// Points of the quantile function by which a logarithm is averaged.
const POINTS: usize = 2000;

/// Middle and scatter of normal scores, which are standard normal where the file is right.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MiddleAndScatter {
    /// Standardised mean.
    pub z: f64,
    /// Two-sided probability of the mean.
    pub middle: f64,
    /// Doubled smaller tail of the variance.
    pub scatter: f64,
    /// Both together (Fisher).
    pub combined: f64,
}

impl MiddleAndScatter {
    /// Of `count` (2 or more) scores of mean `mean` and standard deviation `deviation`, where the file's own middle
    /// is known to `prior` score units (0: exactly).
    ///
    /// # Examples
    /// ```
    /// use toolroom_facts::times::MiddleAndScatter;
    /// let variance = (0.4_f64 * 0.4).ln_1p();
    /// let mean = (3.6 - (25.0_f64.ln() - 0.5 * variance)) / variance.sqrt();
    /// let test = MiddleAndScatter::from_count(20, mean, 0.52 / variance.sqrt(), 0.0);
    /// assert!((test.z - 5.28566).abs() < 1e-5 && (test.combined / 7.924e-8 - 1.0).abs() < 1e-3);
    /// ```
    pub fn from_count(count: u64, mean: f64, deviation: f64, prior: f64) -> Self {
        let n = count as f64;
        let z = mean / (1.0 / n + prior * prior).sqrt();
        let middle = erfc(z.abs() / std::f64::consts::SQRT_2);
        let (freedom, square) = (0.5 * (n - 1.0), 0.5 * (n - 1.0) * deviation * deviation);
        let tail = if square > 0.0 { gamma_lr(freedom, square).min(gamma_ur(freedom, square)) } else { 0.0 };
        let scatter = (2.0 * tail).min(1.0);
        Self { z, middle, scatter, combined: fisher(middle, scatter) }
    }
}

/// Two independent probabilities combined: the chance of a product as small, `P(1 − ln P)`.
///
/// # Source
/// R. A. Fisher, Statistical Methods for Research Workers, 4th ed. (1932).
pub fn fisher(first: f64, second: f64) -> f64 {
    let product = first * second;
    if product > 0.0 { product * (1.0 - product.ln()) } else { 0.0 }
}

/// Normal score of a `time` (s) under `law`; bounded by ±8.
pub fn score(law: &Distribution, time: f64) -> f64 {
    let time_at = |share: f64| {
        Normal::standard().inverse_cdf(share.clamp(f64::MIN_POSITIVE, 1.0 - f64::EPSILON)).clamp(-FARTHEST, FARTHEST)
    };
    match *law {
        Distribution::Lognormal { mean, cv } => {
            let variance = (cv * cv).ln_1p();
            ((time / mean).ln() + 0.5 * variance) / variance.sqrt()
        }
        Distribution::Exponential { .. }
        | Distribution::Erlang { .. }
        | Distribution::Gamma { .. }
        | Distribution::Weibull { .. }
        | Distribution::Triangular { .. }
        | Distribution::Beta { .. }
        | Distribution::Normal { .. }
        | Distribution::Uniform { .. }
        | Distribution::DiscreteUniform { .. }
        | Distribution::Empirical(_) => time_at(law.share_below(time)),
        Distribution::Constant(value) => (time - value) / value.max(f64::MIN_POSITIVE),
    }
}

/// Share of the times of `law` that lie above `time` (s).
pub fn share_above(law: &Distribution, time: f64) -> f64 {
    if law.is_constant() {
        return f64::from(u8::from(law.mean() > time));
    }
    0.5 * (1.0 - erf(score(law, time) / std::f64::consts::SQRT_2))
}

/// Mean and standard deviation of the logarithm of the times of `law`.
fn logarithm(law: &Distribution) -> (f64, f64) {
    let at = |i: usize| law.quantile((i as f64 + 0.5) / POINTS as f64).max(1e-9).ln();
    let moments: Moments = (0..POINTS).map(at).collect();
    (moments.mean(), moments.standard_deviation())
}

/// Recorded `times` (s, above 0) of `place` against `law`, whose middle is known to a relative `prior` (0: as
/// the file says). Only times above `least` (s) are seen at all, as of repairs that are told from short stops by
/// their length. `None` for fewer than three times, and for constants, which have no scatter to compare with.
pub fn times(
    quantity: Quantity,
    place: &str,
    times: &[f64],
    law: &Distribution,
    prior: f64,
    least: f64,
) -> Option<Fact> {
    if times.len() < FEWEST || law.is_constant() {
        return None;
    }
    let visible = share_above(law, least);
    let score_of = |time: &f64| {
        let score_here = score(law, *time);
        if visible > 1.0 - 1e-9 {
            return score_here;
        }
        // Within what can be seen; counted from above, where small shares keep their digits.
        let above = (share_above(law, *time) / visible).clamp(f64::MIN_POSITIVE, 1.0 - f64::EPSILON);
        (-Normal::standard().inverse_cdf(above)).clamp(-FARTHEST, FARTHEST)
    };
    let scores: Moments = times.iter().map(score_of).collect();
    let logarithms: Moments = times.iter().map(|time| time.max(1e-9).ln()).collect();
    let (middle, scatter) = logarithm(law);
    let known = if prior > 0.0 { prior / scatter } else { 0.0 };
    let test = MiddleAndScatter::from_count(scores.count(), scores.mean(), scores.standard_deviation(), known);
    let count = times.len() as f64;
    let factor = (logarithms.mean() - middle).exp();
    let half = student(0.9, count - 1.0) * logarithms.standard_error();
    let normal = Normal::standard();
    let reach = (normal.inverse_cdf(1.0 - 0.5 * LEVEL) + normal.inverse_cdf(POWER))
        * (scatter * scatter / count + prior * prior).sqrt();
    Some(Fact {
        quantity,
        place: place.to_owned(),
        pooled: false,
        told: FactDetail::default(),
        count: times.len() as u64,
        expected: count,
        p: test.combined,
        tests: vec![("middle", test.middle), ("scatter", test.scatter)],
        model: law.mean(),
        estimate: law.mean() * factor,
        ci90: [law.mean() * factor * (-half).exp(), law.mean() * factor * half.exp()],
        least_seen: [(-reach).exp(), reach.exp()],
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    #[test]
    fn repairs_that_last_longer_and_scatter_more_have_the_probabilities_computed_independently() {
        let variance = (0.4_f64 * 0.4).ln_1p();
        let mean = (3.6 - (25.0_f64.ln() - 0.5 * variance)) / variance.sqrt();
        let test = MiddleAndScatter::from_count(20, mean, 0.52 / variance.sqrt(), 0.0);
        for (found, reference) in
            [(test.z, 5.285_66), (test.middle, 1.2525e-7), (test.scatter, 0.031_065_4), (test.combined, 7.924e-8)]
        {
            // As many digits as the reference has.
            assert!((found / reference - 1.0).abs() < 1e-4, "{found} {reference}");
        }
    }

    #[test]
    fn times_of_every_law_are_rejected_as_often_as_the_level_says() {
        let laws = [
            Distribution::Lognormal { mean: 1500.0, cv: 0.4 },
            Distribution::Exponential { mean: 1500.0 },
            Distribution::Weibull { mean: 1500.0, shape: 2.0 },
            Distribution::Uniform { low: 900.0, high: 2100.0 },
            Distribution::Triangular { low: 400.0, mode: 1500.0, high: 3000.0 },
        ];
        for law in laws {
            for least in [0.0, 600.0] {
                let rejected = (0..400_u64).filter(|seed| {
                    let mut random = ChaCha8Rng::seed_from_u64(*seed);
                    let mut draw = || law.quantile(random.random());
                    let drawn: Vec<f64> = (0..60).map(|_| draw()).filter(|time| *time > least).take(20).collect();
                    let fact = times(Quantity::TimeToRepair, "L1", &drawn, &law, 0.0, least);
                    fact.expect("twenty times").p < 0.05
                });
                // Of 400 at 5 %: 20 with a standard deviation of 4.4.
                let rejected = rejected.count();
                assert!((7..=34).contains(&rejected), "{law:?} {least}: {rejected}");
            }
        }
    }

    #[test]
    fn a_file_that_is_known_to_a_tenth_is_not_contradicted_by_a_twentieth() {
        let law = Distribution::Lognormal { mean: 60.0, cv: 0.2 };
        let drawn: Vec<f64> = (0..400).map(|i| 1.05 * law.quantile((i as f64 + 0.5) / 400.0)).collect();
        let p_under = |prior| times(Quantity::HandlingTime, "L1", &drawn, &law, prior, 0.0).expect("times").p;
        assert!(p_under(0.0) < 1e-4 && p_under(0.1) > 0.1);
    }
}
