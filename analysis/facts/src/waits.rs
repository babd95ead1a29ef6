//! Waits in queues against replicated ones.

use crate::count::{LEVEL, POWER};
use crate::fact::{Fact, Quantity};
use crate::told::FactDetail;
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};
use toolroom_statistics::{Moments, student};

/// Fewest replications whose own scores give a level (assumption).
const FEWEST: u64 = 10;

/// Waits before a pool, recorded and replicated.
#[derive(Clone, Copy, Debug)]
pub struct Waits<'a> {
    /// Recorded ones.
    pub count: u64,
    /// Their sum by day, s, with the mean of that of the replications, s.
    pub days: &'a [(f64, f64)],
    /// Mean normal score over days of the recorded waits over its standard error.
    pub score: f64,
    /// The same of each replication among the others.
    pub scores: &'a [f64],
}

/// Waits before `place` against replications. Days are no independent samples of a queue, so the scatter of the score is read off
/// the replications; the interval is that of the mean wait, by the scatter of days about the ratio of both. `None` for fewer
/// than ten replications or two days.
pub fn waits(place: &str, waits: &Waits<'_>) -> Option<Fact> {
    let Waits { count, days, score, scores } = *waits;
    let null: Moments = scores.iter().copied().filter(|score| score.is_finite()).collect();
    if null.count() < FEWEST || !score.is_finite() || days.len() < 2 {
        return None;
    }
    let replications = null.count() as f64;
    let t = (score - null.mean()) / (null.standard_deviation() * (1.0 + 1.0 / replications).sqrt());
    let law = StudentsT::new(0.0, 1.0, replications - 1.0);
    let p = law.map_or(f64::NAN, |law| (2.0 * law.sf(t.abs())).min(1.0));
    let mean = |of: fn(&(f64, f64)) -> f64| days.iter().map(of).sum::<f64>() / count as f64;
    let (recorded, model) = (mean(|day| day.0), mean(|day| day.1));
    let error = ratio_error(days);
    let half = student(0.9, days.len() as f64 - 1.0) * error;
    let normal = Normal::standard();
    let reach = (normal.inverse_cdf(1.0 - 0.5 * LEVEL) + normal.inverse_cdf(POWER)) * error;
    Some(Fact {
        quantity: Quantity::QueueWait,
        place: place.to_owned(),
        pooled: false,
        told: FactDetail::default(),
        count,
        expected: count as f64,
        p,
        tests: vec![("level", p)],
        model,
        estimate: recorded,
        ci90: [recorded * (-half).exp(), recorded * half.exp()],
        least_seen: [(-reach).exp(), reach.exp()],
    })
}

/// Standard error of the logarithm of the ratio of two sums, by the scatter of its parts.
///
/// # Source
/// Cochran, Sampling Techniques (1977), section 6.4: variance of a ratio estimate.
fn ratio_error(parts: &[(f64, f64)]) -> f64 {
    let (first, second): (f64, f64) = (parts.iter().map(|part| part.0).sum(), parts.iter().map(|part| part.1).sum());
    let count = parts.len() as f64;
    let square: f64 = parts.iter().map(|part| (part.0 - first / second * part.1).powi(2)).sum();
    (count / (count - 1.0) * square).sqrt() / first
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wait_is_judged_by_the_scatter_of_replicated_waits() {
        let scores: Vec<f64> = (0..40).map(|i| 2.0 * ((f64::from(i) * 0.618).fract() - 0.5) * 3.0).collect();
        let days = |ratio: f64| (0..10).map(|i| (ratio * 4600.0 + 90.0 * f64::from(i % 3), 4600.0)).collect::<Vec<_>>();
        let waits_of = |score, ratio: f64, scores: &[f64]| {
            waits("M1, M2", &Waits { count: 100, days: &days(ratio), score, scores })
        };
        let near = waits_of(3.0, 1.0, &scores).expect("replications");
        assert!(near.p > 0.05 && near.ci90[0] < near.estimate && near.ci90[1] > near.estimate, "{near:?}");
        assert!(waits_of(231.0, 6.0, &scores).expect("replications").is_rejected(1e-4));
        assert!(waits_of(1.0, 1.0, &scores[..5]).is_none());
    }

    #[test]
    fn nine_of_ten_intervals_hold_the_ratio_of_the_means() {
        use rand::{RngExt, SeedableRng};
        let held = (0..400_u64).filter(|seed| {
            let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(*seed);
            // Days of very different load, of which the recorded one is the model times 1.2 and a scatter of its own.
            let mut day = || {
                let load = 200.0 * (1.0 + 4.0 * random.random::<f64>().powi(2));
                (1.2 * load * (0.6 + 0.8 * random.random::<f64>()), load)
            };
            let days: Vec<(f64, f64)> = (0..10).map(|_| day()).collect();
            let scores: Vec<f64> = (0..40).map(|i| f64::from(i) * 0.05 - 1.0).collect();
            let fact = waits("M1", &Waits { count: 500, days: &days, score: 0.3, scores: &scores }).expect("days");
            let [low, high] = fact.ci90.map(|end| end / fact.model);
            low <= 1.2 && high >= 1.2
        });
        let held = held.count();
        assert!((336..=380).contains(&held), "{held} of 400");
    }
}
