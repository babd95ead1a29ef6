//! Refits to resampled lives: bands without asymptotic theory.

use super::fit::{Fit, refit};
use super::law::Law;
use super::sample::Sample;
use rand::RngExt;
use rayon::prelude::*;
use toolroom_kernel::{Entity, Purpose, Streams};

/// A value over age with its band.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Banded {
    /// Age.
    pub age: f64,
    /// Value of the fitted law.
    pub value: f64,
    /// Lower end of the band.
    pub low: f64,
    /// Upper end of the band.
    pub high: f64,
}

/// Laws fitted to `count` samples drawn from the lives with replacement. Samples that determine
/// no law (all drawn lives censored) are left out. Weights are numbers of equal lives: above a
/// total of 10 000 their resampling is normal instead of multinomial.
///
/// # Source
/// B. Efron, Annals of Statistics 7 (1979) 1; censored lives: B. Efron, J. Am. Stat. Assoc. 76
/// (1981) 312.
pub fn laws(sample: &Sample, fitted: &Fit, count: u32, seed: u64) -> Vec<Law> {
    let streams = Streams::new(seed, 0);
    let one = |i: u32| {
        let mut stream = streams.at(Entity::named("bootstrap"), Purpose::Measurement, u64::from(i));
        let drawn = resampled(sample, || stream.random())?;
        Some(refit(&drawn, fitted)?.law)
    };
    (0..count).into_par_iter().map(one).collect::<Vec<_>>().into_iter().flatten().collect()
}

/// A size above which counts of resampled lives are drawn as normal numbers.
const LARGE: f64 = 1e4;

fn resampled(sample: &Sample, mut uniform: impl FnMut() -> f64) -> Option<Sample> {
    let lives = sample.lives();
    let size = sample.size();
    let mut counts = vec![0.0; lives.len()];
    if size > LARGE {
        for (count, (_, weight)) in counts.iter_mut().zip(lives) {
            let share = weight / size;
            let z = super::normal::quantile(uniform().max(1e-17));
            *count = (weight + (weight * (1.0 - share)).sqrt() * z).max(0.0);
        }
    } else {
        let mut cumulative: Vec<f64> = Vec::with_capacity(lives.len());
        for (_, weight) in lives {
            cumulative.push(cumulative.last().unwrap_or(&0.0) + weight);
        }
        for _ in 0..size.round() as usize {
            let point = uniform() * size;
            counts[cumulative.partition_point(|sum| *sum <= point).min(lives.len() - 1)] += 1.0;
        }
    }
    Sample::weighted(lives.iter().zip(counts).map(|((life, _), count)| (*life, count))).ok()
}

/// The middle `confidence` of a quantity over the laws.
///
/// # Examples
/// ```
/// use toolroom_life::bootstrap::interval;
/// use toolroom_life::law::Law;
/// let laws: Vec<Law> = (1..=99).map(|i| Law::Normal { mean: f64::from(i), deviation: 1.0 }).collect();
/// let (low, high) = interval(&laws, 0.9, |law| law.mean());
/// assert!((low - 5.0).abs() < 1e-9 && (high - 95.0).abs() < 1e-9);
/// ```
pub fn interval(laws: &[Law], confidence: f64, quantity: impl Fn(&Law) -> f64) -> (f64, f64) {
    quantiles(laws.iter().map(quantity).collect(), confidence)
}

/// The middle `confidence` of some values; NaN without any.
pub(super) fn quantiles(mut values: Vec<f64>, confidence: f64) -> (f64, f64) {
    values.retain(|value| !value.is_nan());
    if values.is_empty() {
        return (f64::NAN, f64::NAN);
    }
    values.sort_by(f64::total_cmp);
    let tail = 0.5 * (1.0 - confidence);
    // Value number k of n estimates the quantile k/(n + 1).
    let quantile = |share: f64| {
        let position = share * (values.len() + 1) as f64;
        let below = (position.floor() as usize).clamp(1, values.len());
        let above = (below + 1).min(values.len());
        let part = (position - below as f64).clamp(0.0, 1.0);
        let (low, high) = (values[below - 1], values[above - 1]);
        if part < 1e-9 || low == high { low } else { low + part * (high - low) }
    };
    (quantile(tail), quantile(1.0 - tail))
}

/// A curve over ascending ages with the band of the refitted laws; `curve_of` works it out for a law.
pub fn band(
    fitted: &Law,
    laws: &[Law],
    ages: &[f64],
    confidence: f64,
    curve_of: impl Fn(&Law, &[f64]) -> Vec<f64> + Sync,
) -> Vec<Banded> {
    let curves: Vec<Vec<f64>> = laws.par_iter().map(|law| curve_of(law, ages)).collect();
    let curve = curve_of(fitted, ages);
    let banded = |(i, age): (usize, &f64)| {
        let (low, high) = quantiles(curves.iter().map(|curve| curve[i]).collect(), confidence);
        Banded { age: *age, value: curve[i], low, high }
    };
    ages.iter().enumerate().map(banded).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::fit;
    use crate::law::Family;
    use crate::sample::Observation::Failed;

    #[test]
    fn the_band_of_the_median_is_that_of_the_geometric_mean() {
        let law = Law::Lognormal { median: 20.0, sigma: 0.3 };
        let n = 80;
        let ages = (0..n).map(|i| law.quantile((f64::from(i) + 0.5) / f64::from(n)));
        let sample = Sample::new(ages.map(Failed)).unwrap();
        let fitted = fit(&sample, Family::Lognormal).unwrap();
        let laws = laws(&sample, &fitted, 400, 3);
        assert_eq!(laws.len(), 400);
        let (low, high) = interval(&laws, 0.9, |law| law.quantile(0.5));
        let expected = 1.645 * 0.3 / f64::from(n).sqrt();
        // 400 refits know an end of the interval to 6 % of a standard error of the median.
        assert!(((high / 20.0).ln() / expected - 1.0).abs() < 0.15, "{high}");
        assert!(((20.0 / low).ln() / expected - 1.0).abs() < 0.15, "{low}");
    }

    #[test]
    fn large_samples_are_resampled_by_their_counts() {
        let lives = (1..=50).map(|i| (Failed(f64::from(i)), 1000.0));
        let sample = Sample::weighted(lives).unwrap();
        let fitted = fit(&sample, Family::Normal).unwrap();
        let laws = laws(&sample, &fitted, 200, 4);
        let (low, high) = interval(&laws, 0.9, Law::mean);
        let expected = 1.645 * (2499.0f64 / 12.0 / 50_000.0).sqrt();
        assert!(((high - low) / (2.0 * expected) - 1.0).abs() < 0.2, "{low} {high} {expected}");
    }
}
