//! Lives of edges against simulated ones.

use crate::count::{LEVEL, POWER};
use crate::fact::{Fact, Quantity};
use crate::told::FactDetail;
use statrs::distribution::{ContinuousCDF, Normal};
use statrs::function::erf::erfc;

/// Fewest ended lives on either side (assumption).
const FEWEST: usize = 8;
/// Half-width and steps of the profile over the level of lives, in prior standard deviations.
const REACH: f64 = 3.0;
const STEPS: usize = 61;

/// A life: how long it lasted, s, and whether it ended then; else it was only observed so far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Life {
    /// Time, s.
    pub time: f64,
    /// Whether it ended.
    pub ended: bool,
}

/// Standardised log-rank difference of `own` from `other`, positive where `own` ends sooner; 0 where nothing ends.
///
/// # Source
/// N. Mantel, Cancer Chemotherapy Reports 50 (1966) 163; variance hypergeometric.
pub fn log_rank(lives: &[Life], other: &[Life]) -> f64 {
    let mut all: Vec<(f64, bool, bool)> = lives.iter().map(|life| (life.time, life.ended, true)).collect();
    all.extend(other.iter().map(|life| (life.time, life.ended, false)));
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut at_risk, mut own_at_risk) = (all.len() as f64, lives.len() as f64);
    let (mut difference, mut variance) = (0.0, 0.0);
    let mut first = 0;
    while first < all.len() {
        let last = first + all[first..].iter().take_while(|life| life.0 == all[first].0).count();
        let tied = &all[first..last];
        let ended = tied.iter().filter(|life| life.1).count() as f64;
        let own_ended = tied.iter().filter(|life| life.1 && life.2).count() as f64;
        let share = own_at_risk / at_risk;
        difference += own_ended - ended * share;
        if at_risk > 1.0 {
            variance += ended * share * (1.0 - share) * (at_risk - ended) / (at_risk - 1.0);
        }
        at_risk -= tied.len() as f64;
        own_at_risk -= tied.iter().filter(|life| life.2).count() as f64;
        first = last;
    }
    if variance > 0.0 { difference / variance.sqrt() } else { 0.0 }
}

/// Lives of the edges of `place` against `simulated` ones, whose level is known to a relative `prior` (above 0):
/// the log-rank score is taken at the level that agrees best, and the way there is paid for. `None` for fewer than
/// eight ended lives on either side.
pub fn lives(place: &str, recorded: &[Life], simulated: &[Life], prior: f64) -> Option<Fact> {
    let ended = |lives: &[Life]| lives.iter().filter(|life| life.ended && life.time > 0.0).count();
    if ended(recorded) < FEWEST || ended(simulated) < FEWEST {
        return None;
    }
    let scaled = |factor: f64| -> Vec<Life> {
        simulated.iter().map(|life| Life { time: factor * life.time, ..*life }).collect()
    };
    let at = |step: usize| REACH * (2.0 * step as f64 / (STEPS - 1) as f64 - 1.0);
    let cost = |x: f64| log_rank(recorded, &scaled((prior * x).exp())).powi(2) + x * x;
    let square = (0..STEPS).map(|step| cost(at(step))).fold(f64::INFINITY, f64::min);
    let p = erfc((0.5 * square).sqrt());
    // The level at which the score changes its sign, and those at which it is 1.645 either way.
    let level = |score: f64| {
        let (mut low, mut high) = (1e-3_f64.ln(), 1e3_f64.ln());
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            // Simulated lives made longer let the recorded ones end sooner.
            if log_rank(recorded, &scaled(middle.exp())) < score { low = middle } else { high = middle }
        }
        (0.5 * (low + high)).exp()
    };
    let model = mean(simulated);
    let normal = Normal::standard();
    let [low, estimate, high] = [-1.645, 0.0, 1.645].map(level);
    let error = 0.5 * (high / low).ln() / 1.645;
    let reach = (normal.inverse_cdf(1.0 - 0.5 * LEVEL) + normal.inverse_cdf(POWER)) * error.hypot(prior);
    Some(Fact {
        quantity: Quantity::EdgeLife,
        place: place.to_owned(),
        pooled: false,
        told: FactDetail::default(),
        count: ended(recorded) as u64,
        expected: ended(recorded) as f64,
        p,
        tests: vec![("level", p)],
        model,
        estimate: model * estimate,
        ci90: [model * low, model * high],
        least_seen: [(-reach).exp(), reach.exp()],
    })
}

/// Mean life, those that did not end counted as exposure: exponential estimate, s.
fn mean(lives: &[Life]) -> f64 {
    let ended = lives.iter().filter(|life| life.ended).count() as f64;
    lives.iter().map(|life| life.time).sum::<f64>() / ended
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use toolroom_scenario::Distribution;

    #[test]
    fn the_log_rank_of_a_published_trial() {
        // Freireich et al. 1963: remission of leukaemia under 6-MP and placebo, weeks; log-rank χ² = 16.79.
        let drug = [
            (6.0, true),
            (6.0, true),
            (6.0, true),
            (6.0, false),
            (7.0, true),
            (9.0, false),
            (10.0, true),
            (10.0, false),
            (11.0, false),
            (13.0, true),
            (16.0, true),
            (17.0, false),
            (19.0, false),
            (20.0, false),
            (22.0, true),
            (23.0, true),
            (25.0, false),
            (32.0, false),
            (32.0, false),
            (34.0, false),
            (35.0, false),
        ];
        let placebo = [1, 1, 2, 2, 3, 4, 4, 5, 5, 8, 8, 8, 8, 11, 11, 12, 12, 15, 17, 22, 23];
        let drug: Vec<Life> = drug.iter().map(|(time, ended)| Life { time: *time, ended: *ended }).collect();
        let placebo: Vec<Life> = placebo.iter().map(|time| Life { time: f64::from(*time), ended: true }).collect();
        let z = log_rank(&drug, &placebo);
        assert!(z < 0.0 && (z * z - 16.79).abs() < 0.01, "{}", z * z);
    }

    #[test]
    fn lives_of_the_law_agree_and_shorter_ones_do_not() {
        let law = Distribution::Lognormal { mean: 1800.0, cv: 0.25 };
        let drawn = |count: usize, factor: f64, seed: u64| -> Vec<Life> {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            let mut life =
                |i: usize| Life { time: factor * law.quantile(random.random()), ended: !i.is_multiple_of(10) };
            (0..count).map(&mut life).collect()
        };
        let simulated = drawn(200, 1.0, 99);
        let rejected = (0..100)
            .filter(|seed| lives("L1", &drawn(60, 1.0, *seed), &simulated, 0.05).is_some_and(|fact| fact.p < 0.05));
        let rejected = rejected.count();
        assert!(rejected <= 7, "{rejected}");
        let short = lives("L1", &drawn(60, 0.6, 7), &simulated, 0.05).expect("lives");
        assert!(short.p < 1e-6 && (short.factor() - 0.6).abs() < 0.06, "{short:?}");
        assert!(lives("L1", &drawn(5, 1.0, 7), &simulated, 0.05).is_none());
    }
}
