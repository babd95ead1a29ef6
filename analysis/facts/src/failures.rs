//! Times between failures.

use crate::count::LEVEL;
use crate::fact::{Fact, Quantity};
use crate::renewal::Renewal;
use crate::told::FactDetail;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use toolroom_scenario::Distribution;

/// Fewest complete intervals that have a shape (assumption).
const SHAPED: usize = 8;
/// Replicated sets of intervals.
const SETS: usize = 4000;

/// What a log says about the failures of one machine or of several with one law.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct History {
    /// Name of the machine or pool.
    pub place: String,
    /// Whether it is a pool of several machines.
    pub pooled: bool,
    /// Failures.
    pub failures: u64,
    /// Time on the clock of the failures that was observed, s; what ran since the last failure included.
    pub exposure: f64,
    /// Complete intervals between two failures, s.
    pub intervals: Vec<f64>,
}

/// Time between failures against `law`, of whose failures the share `visible` (above 0, at most 1) is told from
/// a short stop by the length of the repair. `None` without exposure.
///
/// # Examples
/// ```
/// use toolroom_facts::failures::{History, time_between};
/// use toolroom_scenario::Distribution;
/// let history = History { place: "L1".into(), pooled: false, failures: 10, exposure: 160.0 * 3600.0, intervals: Vec::new() };
/// let fact = time_between(&history, &Distribution::Exponential { mean: 8.0 * 3600.0 }, 1.0, 1).unwrap();
/// assert!((fact.p - 0.015_807).abs() < 1e-6 && (fact.ci90[1] / 3600.0 - 29.4909).abs() < 1e-4);
/// ```
pub fn time_between(history: &History, law: &Distribution, visible: f64, seed: u64) -> Option<Fact> {
    let expected = history.exposure / law.mean() * visible;
    if !(expected > 0.0 && expected.is_finite()) {
        return None;
    }
    let renewal = Renewal::new(law, expected, seed);
    let p = renewal.p(history.failures, expected);
    let seen_exposure = history.exposure * visible;
    let [low, high] = renewal.ends(history.failures);
    Some(Fact {
        quantity: Quantity::TimeBetweenFailures,
        place: history.place.clone(),
        pooled: history.pooled,
        told: FactDetail::default(),
        count: history.failures,
        expected,
        p,
        tests: vec![("level", p)],
        model: law.mean(),
        estimate: seen_exposure / history.failures as f64,
        ci90: [seen_exposure / high, seen_exposure / low],
        least_seen: renewal.least_seen(expected, LEVEL),
    })
}

/// Weibull shape of the intervals against that of an exponential (1) or Weibull `law`: their logarithms scatter
/// by π/(√6 shape), whatever their mean. `None` for other laws and with fewer than eight intervals.
pub fn shape(history: &History, law: &Distribution, seed: u64) -> Option<Fact> {
    let file = match law {
        Distribution::Exponential { .. } => 1.0,
        Distribution::Weibull { shape, .. } => *shape,
        Distribution::Constant(_)
        | Distribution::Erlang { .. }
        | Distribution::Gamma { .. }
        | Distribution::Lognormal { .. }
        | Distribution::Triangular { .. }
        | Distribution::Beta { .. }
        | Distribution::Normal { .. }
        | Distribution::Uniform { .. }
        | Distribution::DiscreteUniform { .. }
        | Distribution::Empirical(_) => return None,
    };
    let count = history.intervals.len();
    if count < SHAPED {
        return None;
    }
    let logarithms: Vec<f64> = history.intervals.iter().map(|time| time.max(1.0).ln()).collect();
    let spread = deviation(&logarithms);
    // Of a law of shape 1; the deviation is in inverse proportion to the shape, so that the ratio is a pivot.
    let unit = Distribution::Exponential { mean: 1.0 };
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut set = || -> f64 {
        let draws: Vec<f64> = (0..count).map(|_| unit.quantile(random.random()).max(1e-12).ln()).collect();
        deviation(&draws)
    };
    let mut replicated: Vec<f64> = (0..SETS).map(|_| set()).collect();
    replicated.sort_by(f64::total_cmp);
    let below = replicated.partition_point(|other| *other < spread * file) as f64 / SETS as f64;
    let quantile = |share: f64| replicated[(share * SETS as f64) as usize];
    // Never below what so many replications can tell.
    let p = (2.0 * below.min(1.0 - below)).max(1.0 / SETS as f64);
    let (low, high) = (quantile(0.5 * LEVEL), quantile(1.0 - 0.5 * LEVEL));
    Some(Fact {
        quantity: Quantity::FailureShape,
        place: history.place.clone(),
        pooled: history.pooled,
        told: FactDetail::default(),
        count: count as u64,
        expected: count as f64,
        p,
        tests: vec![("level", p)],
        model: file,
        estimate: quantile(0.5) / spread,
        ci90: [quantile(0.05) / spread, quantile(0.95) / spread],
        // A factor that moves nine tenths of the law beyond the bounds of the test.
        least_seen: [quantile(0.1) / high, quantile(0.9) / low],
    })
}

/// Standard deviation.
fn deviation(values: &[f64]) -> f64 {
    values.iter().copied().collect::<toolroom_statistics::Moments>().standard_deviation()
}

#[cfg(test)]
mod tests {
    use super::*;

    const HOUR: f64 = 3600.0;
    const LAW: Distribution = Distribution::Exponential { mean: 8.0 * HOUR };

    #[test]
    fn no_failure_at_all_bounds_the_mean_from_below() {
        let history =
            History { place: "L1".into(), pooled: false, failures: 0, exposure: 40.0 * HOUR, intervals: Vec::new() };
        let fact = time_between(&history, &LAW, 1.0, 1).expect("exposure");
        assert!((fact.p / 0.006_737_9 - 1.0).abs() < 1e-5 && fact.estimate.is_infinite());
        assert!((fact.ci90[0] / HOUR / 13.3523 - 1.0).abs() < 1e-5 && fact.ci90[1].is_infinite());
        assert!(time_between(&History::default(), &LAW, 1.0, 1).is_none());
    }

    #[test]
    fn intervals_of_the_law_have_its_shape_and_regular_ones_have_not() {
        let shape_of = |law: Distribution, seed: u64| {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            let intervals = (0..30).map(|_| law.quantile(random.random())).collect();
            let history =
                History { place: "L1".into(), pooled: false, failures: 30, exposure: 240.0 * HOUR, intervals };
            shape(&history, &LAW, 1).expect("enough intervals")
        };
        let rejected = (0..200).filter(|seed| shape_of(LAW, *seed).p < 0.05).count();
        // Of 200 at 5 %: 10 with a standard deviation of 3.1.
        assert!((1..=21).contains(&rejected), "{rejected}");
        let regular = shape_of(Distribution::Weibull { mean: 8.0 * HOUR, shape: 3.0 }, 7);
        assert!(regular.p < 1e-3 && (regular.ci90[0]..regular.ci90[1]).contains(&3.0), "{regular:?}");
    }

    #[test]
    fn logs_of_the_law_are_rejected_as_often_as_the_level_says() {
        for law in [LAW, Distribution::Weibull { mean: 8.0 * HOUR, shape: 2.0 }] {
            let renewal = Renewal::new(&law, 20.0, 1);
            let rejected = (0..400_u64).filter(|seed| {
                let mut random = ChaCha8Rng::seed_from_u64(1000 + seed);
                let (mut now, mut failures) = (0.0, 0);
                loop {
                    now += law.quantile(random.random());
                    if now > 160.0 * HOUR {
                        break;
                    }
                    failures += 1;
                }
                renewal.p(failures, 20.0) < 0.05
            });
            // Of 400 at 5 %: 20 with a standard deviation of 4.4.
            let rejected = rejected.count();
            assert!((7..=34).contains(&rejected), "{law:?}: {rejected}");
        }
    }
}
