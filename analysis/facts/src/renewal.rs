//! Counts of events whose intervals have any distribution.

use crate::count::{LEVEL, POWER, mid_p, poisson_tails};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use toolroom_numerics::gamma_quantile;
use toolroom_scenario::Distribution;

/// Replicated histories of a law that is not exponential.
const HISTORIES: usize = 4000;
/// So many times the expected number of events is replicated, so that rates up to this factor have a power.
const REACH: f64 = 6.0;
/// Most events of one history; laws that expect more are taken as they are up to here.
const MOST: usize = 20_000;
/// Steps of a bisection of factors on a rate: sixty halvings leave nothing of the accuracy of a number.
const HALVINGS: usize = 60;

/// The law of the number of events within an exposure, in mean intervals of the file. The clock starts anew
/// with the exposure (assumption: exact where intervals are exponential, and for a run from its start).
#[derive(Clone, Debug, PartialEq)]
pub enum Renewal {
    /// Exponential intervals.
    Poisson,
    /// Times of the first, second … event of replicated histories, in mean intervals.
    Replicated(Vec<Vec<f64>>),
}

impl Renewal {
    /// The law of intervals of `distribution` (positive mean), for exposures of about `expected` (above 0)
    /// mean intervals. The same `seed` gives the same histories.
    pub fn new(distribution: &Distribution, expected: f64, seed: u64) -> Self {
        if matches!(distribution, Distribution::Exponential { .. }) {
            return Self::Poisson;
        }
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let (mean, end) = (distribution.mean(), REACH * expected.max(3.0));
        let history = |_| {
            let (mut now, mut times) = (0.0, Vec::new());
            while now <= end && times.len() < MOST {
                now += distribution.quantile(random.random()) / mean;
                times.push(now);
            }
            times
        };
        Self::Replicated((0..HISTORIES).map(history).collect())
    }

    /// Probabilities of fewer, exactly as many and more events than `count` within `exposure` mean
    /// intervals (above 0).
    pub fn tails(&self, count: u64, exposure: f64) -> [f64; 3] {
        match self {
            Self::Poisson => poisson_tails(count, exposure),
            Self::Replicated(histories) => {
                let mut tails = [0.0; 3];
                for history in histories {
                    let events = history.partition_point(|time| *time <= exposure) as u64;
                    let place = match events.cmp(&count) {
                        std::cmp::Ordering::Less => 0,
                        std::cmp::Ordering::Equal => 1,
                        std::cmp::Ordering::Greater => 2,
                    };
                    tails[place] += 1.0 / histories.len() as f64;
                }
                tails
            }
        }
    }

    /// Two-sided mid-p of `count` events within `exposure` mean intervals (above 0).
    pub fn p(&self, count: u64, exposure: f64) -> f64 {
        let [below, equal, above] = self.tails(count, exposure);
        mid_p(below, equal, above)
    }

    /// Exposures, in true mean intervals, at the ends of the 90 % interval of what `count` events say; the
    /// lower one is 0 without events.
    pub fn ends(&self, count: u64) -> [f64; 2] {
        let quantile = |events: u64, share: f64| match self {
            Self::Poisson => gamma_quantile(events as f64, share),
            Self::Replicated(histories) => {
                let at = |history: &Vec<f64>| history.get(events as usize - 1).copied().unwrap_or(f64::INFINITY);
                let mut times: Vec<f64> = histories.iter().map(at).collect();
                times.sort_by(f64::total_cmp);
                times[((times.len() as f64 * share) as usize).min(times.len() - 1)]
            }
        };
        [if count == 0 { 0.0 } else { quantile(count, 0.05) }, quantile(count + 1, 0.95)]
    }

    /// Least factors on the rate that would have been seen: below the first and above the second the test
    /// at `level` rejects with the probability [`POWER`], where `expected` (above 0) events are expected.
    /// Where no factor does the first is 0, where none within six does the second is infinite.
    ///
    /// # Examples
    /// ```
    /// use toolroom_facts::{count::LEVEL, renewal::Renewal};
    /// let [low, high] = Renewal::Poisson.least_seen(10.0, LEVEL);
    /// assert!((low - 0.11021).abs() < 1e-5 && (high - 2.59025).abs() < 1e-5);
    /// ```
    pub fn least_seen(&self, expected: f64, level: f64) -> [f64; 2] {
        let accepted = |count: u64| self.p(count, expected) >= level;
        let middle = expected.floor() as u64;
        let low = (0..=middle).find(|count| accepted(*count));
        let high = (middle..).find(|count| !accepted(*count + 1) || *count > middle + 100_000);
        let (Some(low), Some(high)) = (low, high) else { return [0.0, f64::INFINITY] };
        let power = |factor: f64| {
            let below = self.tails(low, factor * expected)[0];
            below + self.tails(high, factor * expected)[2]
        };
        let bisect = |mut weak: f64, mut strong: f64| {
            if power(strong) < POWER {
                return strong;
            }
            for _ in 0..HALVINGS {
                let middle = 0.5 * (weak + strong);
                if power(middle) < POWER { weak = middle } else { strong = middle }
            }
            strong
        };
        let least = bisect(1.0, 1e-9);
        let greatest = bisect(1.0, REACH);
        [if least <= 1e-9 { 0.0 } else { least }, if greatest >= REACH { f64::INFINITY } else { greatest }]
    }
}

/// [`Renewal::least_seen`] of a single Poisson count at [`LEVEL`].
pub fn least_seen_of_poisson(expected: f64) -> [f64; 2] {
    Renewal::Poisson.least_seen(expected, LEVEL)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn least_factors_on_a_rate_are_those_computed_independently() {
        for (expected, factors) in [(10.0, [0.11021, 2.59025]), (50.0, [0.517_705, 1.618_27])] {
            let seen = least_seen_of_poisson(expected);
            for (found, reference) in seen.iter().zip(factors) {
                // As many digits as the reference has.
                assert!((found / reference - 1.0).abs() < 5e-5, "{seen:?}");
            }
        }
    }

    #[test]
    fn replicated_exponential_intervals_count_as_a_poisson_law_does() {
        // Weibull of shape 1 is the exponential law, by the other way.
        let replicated = Renewal::new(&Distribution::Weibull { mean: 8.0, shape: 1.0 }, 20.0, 1);
        for count in [10, 15, 20, 30] {
            let (found, exact) = (replicated.p(count, 20.0), Renewal::Poisson.p(count, 20.0));
            // Four standard errors of a share of 4000.
            assert!((found - exact).abs() < 8.0 * (exact.max(0.001) * 0.5 / 4000.0).sqrt(), "{count}: {found} {exact}");
        }
        let (found, exact) = (replicated.ends(10), Renewal::Poisson.ends(10));
        assert!(
            found.iter().zip(exact).all(|(found, exact)| (found / exact - 1.0).abs() < 0.03),
            "{found:?} {exact:?}"
        );
    }

    #[test]
    fn regular_events_need_a_smaller_change_of_their_rate() {
        let regular = Renewal::new(&Distribution::Weibull { mean: 1.0, shape: 3.0 }, 10.0, 1);
        let (least, poisson) = (regular.least_seen(10.0, LEVEL), least_seen_of_poisson(10.0));
        assert!(least[0] > 2.0 * poisson[0] && least[1] < 0.8 * poisson[1], "{least:?}");
        let constant = Renewal::new(&Distribution::Constant(2.0), 10.0, 1);
        assert!(constant.p(10, 10.5) > 0.999_999 && constant.p(9, 10.5) < 1e-6);
    }
}
