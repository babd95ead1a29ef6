//! Scatter of trials: Student's t, bootstrap, jackknife.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use statrs::distribution::{ContinuousCDF, StudentsT};
use toolroom_numerics::order_quantile;

/// Mean and scatter of a number over trials.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scatter {
    /// Mean.
    pub mean: f64,
    /// Median.
    pub median: f64,
    /// Huber's robust mean: trials beyond 1.345 robust standard deviations count less the farther they are.
    pub huber: f64,
    /// Standard deviation of one trial; none for a single trial.
    pub sd: Option<f64>,
    /// 95 % interval of the mean, `mean ± t sd/√n`.
    pub ci95: Option<[f64; 2]>,
    /// 95 % interval in which one further trial would fall, `mean ± t sd √(1 + 1/n)`.
    pub prediction95: Option<[f64; 2]>,
}

/// Two-sided 95 % quantile of Student's t.
pub(super) fn student(freedom: usize) -> f64 {
    StudentsT::new(0.0, 1.0, freedom as f64).map_or(f64::NAN, |t| t.inverse_cdf(0.975))
}

impl Scatter {
    /// Scatter of `values`, of which there must be at least one.
    ///
    /// ```
    /// let scatter = toolroom_infeed::Scatter::of(&[1.0, 2.0, 3.0]);
    /// assert_eq!((scatter.mean, scatter.sd), (2.0, Some(1.0)));
    /// ```
    pub fn of(values: &[f64]) -> Self {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        let median = order_quantile(&sorted, 0.5);
        let huber = huber(values, median);
        if values.len() < 2 {
            return Self { mean, median, huber, sd: None, ci95: None, prediction95: None };
        }
        let sd = (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt();
        let about_mean = |half: f64| Some([mean - half, mean + half]);
        let t = student(values.len() - 1);
        let ci95 = about_mean(t * sd / n.sqrt());
        Self { mean, median, huber, sd: Some(sd), ci95, prediction95: about_mean(t * sd * (1.0 + 1.0 / n).sqrt()) }
    }
}

/// Huber's mean, by weights anew from the median on; the scale is the median distance from the median.
///
/// # Source
/// Huber, Robust estimation of a location parameter (1964): 1.345 keeps 95 % of the efficiency at a normal distribution.
fn huber(values: &[f64], median: f64) -> f64 {
    let mut distances: Vec<f64> = values.iter().map(|value| (value - median).abs()).collect();
    distances.sort_by(f64::total_cmp);
    let reach = 1.345 * 1.4826 * order_quantile(&distances, 0.5);
    if reach <= 0.0 {
        return median;
    }
    let mut centre = median;
    for _ in 0..100 {
        let (mut sum, mut weights) = (0.0, 0.0);
        for value in values {
            let weight = (reach / (value - centre).abs()).min(1.0);
            (sum, weights) = (sum + weight * value, weights + weight);
        }
        let next = sum / weights;
        if (next - centre).abs() <= 1e-14 * centre.abs() {
            return next;
        }
        centre = next;
    }
    centre
}

/// Quantiles of the mean over trials drawn with replacement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bootstrap {
    /// The 2.5 % and the 97.5 % quantile.
    pub ci95: [f64; 2],
    /// Median.
    pub median: f64,
    /// Number of resamples.
    pub resamples: usize,
    /// Whether these are all that there are.
    pub exact: bool,
}

/// Trials up to which all n^n resamples are enumerated.
const ENUMERATED: usize = 6;

/// Bootstrap of the mean: every resample of up to six values, else `resamples` random ones.
pub(super) fn bootstrap(values: &[f64], resamples: usize, seed: u64) -> Option<Bootstrap> {
    let n = values.len();
    let exact = n <= ENUMERATED;
    if n < 2 || (!exact && resamples == 0) {
        return None;
    }
    let mut means = Vec::new();
    if exact {
        // Every resample is a number of n digits to the base n.
        let all = n.pow(n as u32);
        means.extend((0..all).map(|resample| {
            let digits = std::iter::successors(Some(resample), |rest| Some(rest / n)).take(n);
            digits.map(|rest| values[rest % n]).sum::<f64>() / n as f64
        }));
    } else {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        means.extend((0..resamples).map(|_| (0..n).map(|_| values[random.random_range(0..n)]).sum::<f64>() / n as f64));
    }
    means.sort_by(f64::total_cmp);
    let ci95 = [order_quantile(&means, 0.025), order_quantile(&means, 0.975)];
    Some(Bootstrap { ci95, median: order_quantile(&means, 0.5), resamples: means.len(), exact })
}

/// Mean without each value in turn.
pub(super) fn jackknife(values: &[f64]) -> Vec<f64> {
    if values.len() < 2 {
        return Vec::new();
    }
    let sum: f64 = values.iter().sum();
    values.iter().map(|value| (sum - value) / (values.len() - 1) as f64).collect()
}
