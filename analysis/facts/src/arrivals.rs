//! Arrivals of a source against the law of its file.

use crate::count::{LEVEL, POWER, garwood, mid_p, poisson_mid_p};
use crate::fact::{Fact, Quantity};
use crate::failures::{History, time_between};
use crate::renewal::Renewal;
use crate::times::fisher;
use crate::told::FactDetail;
use statrs::distribution::{ContinuousCDF, Normal};
use statrs::function::gamma::{gamma_lr, gamma_ur};
use toolroom_scenario::Distribution;

/// Arrivals that are expected in a period in which they are counted (1). Assumption: with ten the distances of counts from
/// their mean follow chi-square well, and level and dispersion hardly hang together.
const IN_A_PERIOD: f64 = 10.0;
/// Most periods of a log (assumption).
const PERIODS: f64 = 60.0;
/// Arrivals of a law that is not exponential from which on their number is normal (1). Assumption: the skewness of a sum of a
/// hundred intervals is a tenth of that of one.
const NORMAL_FROM: f64 = 100.0;
/// Quantiles by which the scatter of an interval is summed (assumption: of a lognormal law as wide as its mean two hundredths
/// of the variance lie beyond them).
const QUANTILES: usize = 4000;

/// Level and dispersion of counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LevelAndDispersion {
    /// Exact two-sided mid-p of the total.
    pub level: f64,
    /// Sum of squared distances from the expected count over it.
    pub chi_square: f64,
    /// Doubled smaller tail: arrivals that are too regular are a gap, too.
    pub dispersion: f64,
    /// Both together (Fisher).
    pub combined: f64,
}

impl LevelAndDispersion {
    /// Of the `counts` of equal periods in each of which `mean` (above 0) arrivals are expected.
    ///
    /// # Examples
    /// ```
    /// use toolroom_facts::arrivals::LevelAndDispersion;
    /// let test = LevelAndDispersion::from_counts(&[6, 9, 2, 11, 5, 3, 8, 1, 13, 6, 4, 7], 6.0);
    /// assert!((test.chi_square - 23.8333).abs() < 1e-4 && (test.dispersion - 0.042_857_9).abs() < 1e-6);
    /// ```
    pub fn from_counts(counts: &[u64], mean: f64) -> Self {
        let periods = counts.len() as f64;
        let level = poisson_mid_p(counts.iter().sum(), mean * periods);
        let chi_square = counts.iter().map(|count| (*count as f64 - mean).powi(2) / mean).sum::<f64>();
        let tail = if chi_square > 0.0 {
            gamma_lr(0.5 * periods, 0.5 * chi_square).min(gamma_ur(0.5 * periods, 0.5 * chi_square))
        } else {
            0.0
        };
        let dispersion = (2.0 * tail).min(1.0);
        Self { level, chi_square, dispersion, combined: fisher(level, dispersion) }
    }
}

/// Arrivals of the Poisson source `place` in equal periods of `period` (s) against the mean `interval` (s) of the
/// file. `None` without periods.
pub fn arrivals(place: &str, counts: &[u64], period: f64, interval: f64) -> Option<Fact> {
    let mean = period / interval;
    if counts.is_empty() || !(mean > 0.0 && mean.is_finite()) {
        return None;
    }
    let test = LevelAndDispersion::from_counts(counts, mean);
    let (total, time) = (counts.iter().sum::<u64>(), period * counts.len() as f64);
    let [low, high] = garwood(total, 0.9);
    Some(Fact {
        quantity: Quantity::ArrivalInterval,
        place: place.to_owned(),
        pooled: false,
        told: FactDetail::default(),
        count: total,
        expected: mean * counts.len() as f64,
        p: test.combined,
        tests: vec![("level", test.level), ("dispersion", test.dispersion)],
        model: interval,
        estimate: time / total as f64,
        ci90: [time / high, time / low],
        least_seen: Renewal::Poisson.least_seen(mean * counts.len() as f64, LEVEL),
    })
}

/// Arrivals at `times` (s) after the first end of `span` (s) and up to the other one, at the source `place`, whose file has
/// intervals of the law `law` (s): of a Poisson source level and dispersion, of any other one the level. The same `seed` gives
/// the same histories of a law that has to be replicated. `None` where nothing is expected, or where a hundred and more are and
/// the law has no scatter.
///
/// # Examples
/// ```
/// use toolroom_facts::arrivals::arrivals_of;
/// use toolroom_scenario::Distribution;
/// let times: Vec<f64> = (1..=300).map(|i| 600.0 * f64::from(i)).collect();
/// let law = Distribution::Exponential { mean: 750.0 };
/// let fact = arrivals_of("shaft", &times, [0.0, 180_000.0], &law, 1).unwrap();
/// assert!(fact.is_rejected(0.01) && (fact.estimate - 600.0).abs() < 1e-9);
/// ```
pub fn arrivals_of(place: &str, times: &[f64], span: [f64; 2], law: &Distribution, seed: u64) -> Option<Fact> {
    let [start, end] = span;
    // A log begins with its first job as a rule, which is no count of what came since.
    let within: Vec<f64> = times.iter().copied().filter(|time| *time > start && *time <= end).collect();
    let expected = (end - start) / law.mean();
    let periods = (expected / IN_A_PERIOD).floor().min(PERIODS);
    if matches!(law, Distribution::Exponential { .. }) && periods >= 2.0 {
        let period = (end - start) / periods;
        let mut counts = vec![0_u64; periods as usize];
        for time in within {
            let last = counts.len() - 1;
            counts[(((time - start) / period) as usize).min(last)] += 1;
        }
        return arrivals(place, &counts, period, law.mean());
    }
    if !matches!(law, Distribution::Exponential { .. }) && expected >= NORMAL_FROM {
        return many(place, within.len() as u64, end - start, law);
    }
    let history =
        History { place: place.to_owned(), failures: within.len() as u64, exposure: end - start, ..History::default() };
    Some(Fact { quantity: Quantity::ArrivalInterval, ..time_between(&history, law, 1.0, seed)? })
}

/// So many arrivals in `exposure` (s) that the time until each of them is normal: fewer than N have come where the Nth comes
/// later. `None` where an interval has no scatter.
///
/// # Source
/// W. Feller, Transactions of the American Mathematical Society 67 (1949) 98 (renewal counts).
fn many(place: &str, count: u64, exposure: f64, law: &Distribution) -> Option<Fact> {
    let (mean, seen) = (law.mean(), count as f64);
    let variation = law.variance(QUANTILES).sqrt() / mean;
    let expected = exposure / mean;
    let normal = Normal::standard();
    if !(variation > 0.0 && variation.is_finite()) {
        return None;
    }
    let by_now = |number: f64| normal.cdf((expected - number) / (variation * number.sqrt()));
    let below = if count == 0 { 0.0 } else { 1.0 - by_now(seen) };
    let above = by_now(seen + 1.0);
    let p = mid_p(below, (1.0 - below - above).max(0.0), above);
    let half = normal.inverse_cdf(0.95) * variation * seen.max(1.0).sqrt();
    let least = (normal.inverse_cdf(1.0 - 0.5 * LEVEL) + normal.inverse_cdf(POWER)) * variation / expected.sqrt();
    Some(Fact {
        quantity: Quantity::ArrivalInterval,
        place: place.to_owned(),
        pooled: false,
        told: FactDetail::default(),
        count,
        expected,
        p,
        tests: vec![("level", p)],
        model: mean,
        estimate: exposure / seen,
        ci90: [exposure / (seen + half), exposure / (seen - half).max(0.0)],
        least_seen: [(1.0 - least).max(0.0), 1.0 + least],
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    #[test]
    fn a_right_source_is_contradicted_as_often_as_the_level_says() {
        let even = |cv: f64| Distribution::Gamma { mean: 600.0, cv };
        let laws = [Distribution::Exponential { mean: 600.0 }, even(0.5), even(0.05)];
        for law in laws {
            let mut random = ChaCha8Rng::seed_from_u64(3);
            let mut log = |factor: f64| {
                let (mut now, mut times) = (0.0, Vec::new());
                while now < 200_000.0 {
                    now += factor * law.quantile(random.random());
                    times.push(now);
                }
                arrivals_of("shaft", &times, [0.0, 200_000.0], &law, 1).expect("a fact")
            };
            let below = (0..400).filter(|_| log(1.0).p < 0.05).count();
            // 20 are expected; the standard deviation of such a count is 4.4. Counts of an even law are few whole numbers.
            assert!((1..=35).contains(&below), "{below} of 400 below 5 %: {law:?}");
            let found = (0..40).filter(|_| log(0.75).is_rejected(0.01)).count();
            assert!(found >= 36, "{found} of 40 sources that bring a third more: {law:?}");
        }
    }

    #[test]
    fn many_arrivals_have_the_probability_of_replicated_histories() {
        let law = Distribution::Gamma { mean: 600.0, cv: 0.5 };
        for count in [92, 95, 100, 106] {
            let normal = many("shaft", count, 60_000.0, &law).expect("a fact").p;
            let replicated = Renewal::new(&law, 100.0, 1).p(count, 100.0);
            // The standard error of a share of 4000 histories is 0.008 at most, and the probability is twice one.
            assert!((normal - replicated).abs() < 0.05, "{count}: {normal} and {replicated}");
        }
    }

    #[test]
    fn a_source_of_which_little_is_expected_has_a_level_alone() {
        let law = Distribution::Exponential { mean: 600.0 };
        let fact = arrivals_of("shaft", &[100.0, 700.0], [0.0, 3600.0], &law, 1).expect("a fact");
        assert_eq!((fact.count, fact.tests.len(), fact.quantity), (2, 1, Quantity::ArrivalInterval));
        assert!(arrivals_of("shaft", &[], [0.0, 0.0], &law, 1).is_none());
        let even = Distribution::Gamma { mean: 600.0, cv: 0.5 };
        let fact = arrivals_of("shaft", &[100.0, 700.0], [0.0, 3600.0], &even, 1).expect("a fact");
        assert!((0.0005..0.01).contains(&fact.p), "two where six come evenly: {}", fact.p);
    }

    #[test]
    fn level_and_dispersion_are_those_computed_independently() {
        let test = LevelAndDispersion::from_counts(&[6, 9, 2, 11, 5, 3, 8, 1, 13, 6, 4, 7], 6.0);
        for (found, reference) in
            [(test.level, 0.711_391), (test.chi_square, 143.0 / 6.0), (test.dispersion, 0.042_857_9)]
        {
            assert!((found / reference - 1.0).abs() < 1e-6, "{test:?}");
        }
    }

    #[test]
    fn arrivals_that_are_too_regular_are_a_gap() {
        let fact = arrivals("shafts", &[6; 30], 3600.0, 600.0).expect("periods");
        assert!(fact.p < 1e-6 && fact.tests[0].1 > 0.9, "{fact:?}");
        assert!(fact.is_rejected(0.01), "{fact:?}");
        assert!(arrivals("shafts", &[], 3600.0, 600.0).is_none());
    }
}
