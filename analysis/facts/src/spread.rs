//! Scatter of times whose middle is known by other means.

use crate::clock::clock_error;
use crate::count::{LEVEL, POWER};
use crate::fact::{Fact, Quantity};
use crate::told::FactDetail;
use statrs::distribution::{ContinuousCDF, Normal};
use statrs::function::erf::erfc;
use toolroom_statistics::median;

/// Fewest times that say something about a scatter (count; assumption).
const FEWEST: usize = 20;

/// Variance of logarithms below which times do not scatter (1). Derivation: a part in a million is beyond any clock.
const NONE: f64 = 1e-12;

/// Times that many times as long or as short as the middle one of their group stand apart (1): they have another cause than the
/// scatter of the rest (assumption, as for readings that stand apart in a closure). Those of the file are left out alike.
const APART: f64 = 5.0;

/// Rounded differences in a time of handling (count): of loading and of unloading.
const DIFFERENCES: usize = 2;

/// Standard deviation of the logarithms about their own group, and the standard error of its logarithm.
///
/// The error is that of a variance from `n` values of kurtosis κ, `√((κ − 1)/(4 n))`: heavy tails count.
fn deviation(groups: &[Vec<f64>]) -> Option<(f64, f64, u64)> {
    let (mut squares, mut fourth, mut freedom, mut count) = (0.0, 0.0, 0.0, 0);
    for group in groups.iter().filter(|group| group.len() > 1) {
        let middle = median(&mut group.clone());
        let beside = group.iter().filter(|time| (middle / APART..=middle * APART).contains(*time));
        let logarithms: Vec<f64> = beside.map(|time| time.max(1e-9).ln()).collect();
        let mean = logarithms.iter().sum::<f64>() / logarithms.len() as f64;
        for off in logarithms.iter().map(|value| (value - mean).powi(2)) {
            squares += off;
            fourth += off * off;
        }
        freedom += logarithms.len() as f64 - 1.0;
        count += logarithms.len() as u64;
    }
    let variance = squares / freedom;
    let kurtosis = fourth / count as f64 / (squares / count as f64).powi(2);
    let error = ((kurtosis - 1.0).max(0.0) / (4.0 * freedom)).sqrt();
    (count >= FEWEST as u64 && variance > NONE).then(|| (variance.sqrt(), error, count))
}

/// The scatter of recorded times (s; those of one middle in one group) against that of `drawn` times of the file.
/// `None` with fewer than twenty times, and where the file's times do not scatter.
///
/// # Source
/// Standard error of a sample variance: Cramér 1946, section 27.4; of its logarithm by the delta method.
pub fn spread(quantity: Quantity, place: &str, recorded: &[Vec<f64>], drawn: &[f64]) -> Option<Fact> {
    let (model, model_error, _) = deviation(&[drawn.to_vec()])?;
    let (estimate, own_error, count) = deviation(recorded)?;
    let error = model_error.hypot(own_error);
    // The clock may have added to what is recorded, and need not have.
    let clock = clock_error(recorded.iter().flatten(), DIFFERENCES);
    let times = || recorded.iter().flatten();
    let rounded = (times().map(|time| (clock / time).powi(2)).sum::<f64>() / times().count() as f64).sqrt();
    let expected = estimate.clamp(model, model.hypot(rounded));
    let p = erfc((estimate / expected).ln().abs() / error / std::f64::consts::SQRT_2);
    let normal = Normal::standard();
    let half = normal.inverse_cdf(0.95) * error;
    let reach = (normal.inverse_cdf(1.0 - 0.5 * LEVEL) + normal.inverse_cdf(POWER)) * error;
    Some(Fact {
        quantity,
        place: place.to_owned(),
        pooled: false,
        told: FactDetail::default(),
        count,
        expected: count as f64,
        p,
        tests: vec![("level", p)],
        model,
        estimate,
        ci90: [estimate * (-half).exp(), estimate * half.exp()],
        least_seen: [(-reach).exp(), reach.exp()],
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use toolroom_scenario::Distribution;

    fn sums(cv: f64, count: usize, seed: u64) -> Vec<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let law = |mean| Distribution::Lognormal { mean, cv };
        let mut one = || law(40.0).quantile(random.random()) + law(20.0).quantile(random.random());
        (0..count).map(|_| one()).collect()
    }

    /// Two groups whose middles differ by half.
    fn recorded(cv: f64, seed: u64) -> Vec<Vec<f64>> {
        let all = sums(cv, 200, seed);
        vec![all[..90].to_vec(), all[90..].iter().map(|time| 1.5 * time).collect()]
    }

    #[test]
    fn a_true_file_is_rejected_as_often_as_the_level_says() {
        for cv in [0.2, 1.2] {
            let p = |seed| spread(Quantity::HandlingScatter, "L1", &recorded(cv, seed), &sums(cv, 1000, seed + 5000));
            let rejected = (0..400).filter(|seed| p(*seed).expect("two hundred times").p < 0.05).count();
            // Of 400 at 5 %: 20 with a standard deviation of 4.4.
            assert!((7..=34).contains(&rejected), "{cv}: {rejected}");
        }
    }

    #[test]
    fn times_that_scatter_more_than_their_file_are_seen_whatever_their_middle() {
        let fact = spread(Quantity::HandlingScatter, "L1", &recorded(0.4, 1), &sums(0.2, 1000, 2)).expect("times");
        assert!(fact.p < 1e-9 && (1.7..2.3).contains(&fact.factor()), "{fact:?}");
        // By hand: a lognormal sum of 40 s and 20 s with a coefficient of 0.2 has one of 0.2 √5/3.
        assert!((fact.model / (0.2_f64 * 5.0_f64.sqrt() / 3.0) - 1.0).abs() < 0.06, "{}", fact.model);
        assert!(spread(Quantity::HandlingScatter, "L1", &[vec![60.0; 19]], &sums(0.2, 1000, 2)).is_none());
        assert!(spread(Quantity::HandlingScatter, "L1", &recorded(0.2, 1), &[60.0; 1000]).is_none());
    }

    #[test]
    fn the_unit_of_the_times_does_not_matter() {
        let (seconds, file) = (recorded(0.3, 4), sums(0.2, 1000, 2));
        let minutes: Vec<Vec<f64>> = seconds.iter().map(|own| own.iter().map(|time| time / 60.0).collect()).collect();
        let spread_of =
            |recorded: &[Vec<f64>]| spread(Quantity::HandlingScatter, "L1", recorded, &file).expect("times");
        assert!((spread_of(&seconds).estimate - spread_of(&minutes).estimate).abs() < 1e-12);
    }
}
