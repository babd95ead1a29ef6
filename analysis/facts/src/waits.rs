//! Waits in queues against replicated ones.

use crate::count::{LEVEL, POWER};
use crate::fact::{Fact, Quantity};
use crate::told::FactDetail;
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};
use toolroom_statistics::Moments;

/// Fewest replications whose own scores give a level (assumption).
const FEWEST: u64 = 10;

/// Waits before `place`: `count` recorded ones of `recorded` s in the mean against replications of `replicated`
/// s in the mean each. `score` is the mean normal score over days of the recorded waits over its standard error,
/// `scores` the same of each replication among the others: days are no independent samples of a queue, so its scatter is
/// read off the replications. `None` for fewer than ten of them.
pub fn waits(place: &str, count: u64, recorded: f64, replicated: &[f64], score: f64, scores: &[f64]) -> Option<Fact> {
    let null: Moments = scores.iter().copied().filter(|score| score.is_finite()).collect();
    if null.count() < FEWEST || !score.is_finite() {
        return None;
    }
    let replications = null.count() as f64;
    let t = (score - null.mean()) / (null.standard_deviation() * (1.0 + 1.0 / replications).sqrt());
    let law = StudentsT::new(0.0, 1.0, replications - 1.0);
    let p = law.map_or(f64::NAN, |law| (2.0 * law.sf(t.abs())).min(1.0));
    let means: Moments = replicated.iter().copied().collect();
    let scatter = means.standard_deviation() / means.mean();
    let normal = Normal::standard();
    let half = 1.645 * scatter;
    let reach = (normal.inverse_cdf(1.0 - 0.5 * LEVEL) + normal.inverse_cdf(POWER)) * scatter;
    Some(Fact {
        quantity: Quantity::QueueWait,
        place: place.to_owned(),
        pooled: false,
        told: FactDetail::default(),
        count,
        expected: count as f64,
        p,
        tests: vec![("level", p)],
        model: means.mean(),
        estimate: recorded,
        ci90: [recorded * (-half).exp(), recorded * half.exp()],
        least_seen: [(-reach).exp(), reach.exp()],
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wait_is_judged_by_the_scatter_of_replicated_waits() {
        let scores: Vec<f64> = (0..40).map(|i| 2.0 * ((f64::from(i) * 0.618).fract() - 0.5) * 3.0).collect();
        let means: Vec<f64> = (0..40).map(|i| 460.0 + 20.0 * (f64::from(i) * 0.41).fract()).collect();
        let waits_of = |score, recorded| waits("M1, M2", 500, recorded, &means, score, &scores).expect("replications");
        assert!(waits_of(3.0, 480.0).p > 0.05 && waits_of(231.0, 2732.0).is_rejected(1e-4));
        assert!(waits("M1", 500, 480.0, &means[..5], 1.0, &scores[..5]).is_none());
    }
}
