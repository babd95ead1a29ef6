//! Scatter of times whose middle is known by other means.

use crate::clock::clock_error;
use crate::count::{LEVEL, POWER};
use crate::fact::{Fact, Quantity};
use crate::told::FactDetail;
use statrs::distribution::{ContinuousCDF, Normal};
use statrs::function::erf::erfc;

/// Fewest times that say something about a scatter (count; assumption).
const FEWEST: usize = 20;

/// Variance of logarithms below which times do not scatter (1). Derivation: a part in a million is beyond any clock.
const NONE: f64 = 1e-12;

/// Share of the times that is left out at either end (1): where a row of a log is lost, the time between two others holds a
/// whole operation, and says nothing about the scatter of handling. Assumption: fewer than one row in twenty is lost. Those of
/// the file are left out alike.
const ENDS: f64 = 0.05;

/// Variance of a standard normal between its 5 and 95 % points (1): `1 − 2 z φ(z)/0.9` with z = 1.6449.
const INNER: f64 = 0.623_0;

/// Blocks that are left out in turn for the standard error (count; assumption: as many as the fewest times).
const BLOCKS: usize = FEWEST;

/// Rounded differences in a time of handling (count): of loading and of unloading.
const DIFFERENCES: usize = 2;

/// Logarithms about the mean of their own group, stretched by what the mean of few takes from them.
fn about_their_means(groups: &[Vec<f64>]) -> Vec<f64> {
    let mut all = Vec::new();
    for group in groups.iter().filter(|group| group.len() > 1) {
        let logarithms: Vec<f64> = group.iter().map(|time| time.max(1e-9).ln()).collect();
        let count = logarithms.len() as f64;
        let mean = logarithms.iter().sum::<f64>() / count;
        let stretch = (count / (count - 1.0)).sqrt();
        all.extend(logarithms.into_iter().map(|logarithm| stretch * (logarithm - mean)));
    }
    all
}

/// Variance by what is left without [`ENDS`] at either end, right where the values are normal.
fn trimmed_variance(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let count = values.len();
    // A value at an end counts as far as it lies within: the share that is left out is the same for any number of values.
    let ends = ENDS * count as f64;
    let weight = |i: usize| ((i.min(count - 1 - i) + 1) as f64 - ends).clamp(0.0, 1.0);
    let sum = |of: &dyn Fn(f64) -> f64| -> f64 { values.iter().enumerate().map(|(i, x)| weight(i) * of(*x)).sum() };
    let whole = sum(&|_| 1.0);
    let mean = sum(&|x| x) / whole;
    sum(&|x| (x - mean).powi(2)) / whole / INNER
}

/// Deviation of the logarithms about the mean of their own group without the ends, and the standard error of its logarithm by
/// leaving out blocks in turn.
fn deviation(groups: &[Vec<f64>]) -> Option<(f64, f64, u64)> {
    let all = about_their_means(groups);
    if all.len() < FEWEST {
        return None;
    }
    let variance = trimmed_variance(all.clone());
    if variance <= NONE {
        return None;
    }
    let without = |block: usize| {
        let rest = all.iter().enumerate().filter(|(i, _)| i * BLOCKS / all.len() != block).map(|(_, value)| *value);
        0.5 * trimmed_variance(rest.collect()).max(NONE).ln()
    };
    let logarithms: Vec<f64> = (0..BLOCKS).map(without).collect();
    let mean = logarithms.iter().sum::<f64>() / BLOCKS as f64;
    let squares: f64 = logarithms.iter().map(|value| (value - mean).powi(2)).sum();
    let error = (squares * (BLOCKS as f64 - 1.0) / BLOCKS as f64).sqrt();
    Some((variance.sqrt(), error, all.len() as u64))
}

/// The scatter of recorded times (s; those of one middle in one group) against that of `drawn` times of the file.
/// `None` with fewer than twenty times, and where the file's times do not scatter.
///
/// # Source
/// Trimmed scale and its error by a jackknife of blocks: Shao & Wu 1989, A general theory for jackknife variance estimation,
/// Annals of Statistics 17.
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
    fn the_scatter_is_that_of_the_law_for_few_times_and_for_small_groups() {
        let law = Distribution::Lognormal { mean: 60.0, cv: 0.2 };
        let exact = (1.0_f64 + 0.04).ln().sqrt();
        for (groups, size) in [(1, 20), (1, 21), (1, 41), (7, 3), (70, 3), (50, 4), (100, 2)] {
            let mut random = ChaCha8Rng::seed_from_u64(7);
            let mut drawn = |_| -> Vec<f64> { (0..size).map(|_| law.quantile(random.random())).collect() };
            let mut one = || deviation(&(0..groups).map(&mut drawn).collect::<Vec<_>>()).expect("twenty times").0;
            let mean = (0..400).map(|_| one()).sum::<f64>() / 400.0;
            // A mean of 400 deviations is within a per cent or two; few times lack a little of their tails.
            assert!((mean / exact - 1.0).abs() < 0.06, "{groups} of {size}: {mean} for {exact}");
        }
    }

    #[test]
    fn a_lost_row_in_fifty_hardly_moves_the_scatter() {
        let mut log = recorded(0.2, 3);
        let before = deviation(&log).expect("times").0;
        // Two operations and a cut of 86 s between two others.
        log.iter_mut().for_each(|group| group.iter_mut().step_by(50).for_each(|time| *time = 2.0 * *time + 86.0));
        let after = deviation(&log).expect("times").0;
        assert!((after / before - 1.0).abs() < 0.08, "{before} {after}");
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
