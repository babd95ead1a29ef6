//! Arrivals by period against a Poisson source.

use crate::count::{LEVEL, garwood, poisson_mid_p};
use crate::fact::{Fact, Quantity};
use crate::renewal::Renewal;
use crate::times::fisher;
use crate::told::FactDetail;
use statrs::function::gamma::{gamma_lr, gamma_ur};

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

#[cfg(test)]
mod tests {
    use super::*;

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
