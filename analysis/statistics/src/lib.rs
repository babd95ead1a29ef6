//! Means, intervals and differences of replications.
//!
//! A value that is not defined in a replication (a cost per part without parts) is NaN there and
//! leaves the sample; [`Interval::count`] says how many values are left.

#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

mod select;
mod steady;

pub use select::{FIRST_STAGE, Selected, Selection};
pub use steady::{BATCHES, BatchMeans, Batched, MSER_BATCH, MSER_LEAST, Truncation, batch_means, mser};

use statrs::distribution::{Beta, ContinuousCDF, Normal, StudentsT};

/// Confidence of every interval that the product reports.
pub const CONFIDENCE: f64 = 0.95;

/// Count, mean and sum of squared deviations, gathered one value at a time (Welford) and merged
/// exactly (Chan, Golub, LeVeque).
///
/// # Source
/// B. P. Welford, Technometrics 4 (1962) 419; T. F. Chan, G. H. Golub, R. J. LeVeque,
/// The American Statistician 37 (1983) 242.
///
/// # Examples
/// ```
/// use toolroom_statistics::Moments;
/// let all: Moments = [2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0].into_iter().collect();
/// assert_eq!((all.mean(), all.variance()), (5.0, 32.0 / 7.0));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    count: u64,
    mean: f64,
    squares: f64,
}

impl Moments {
    /// Adds a value.
    pub fn push(&mut self, value: f64) {
        self.count += 1;
        let deviation = value - self.mean;
        self.mean += deviation / self.count as f64;
        self.squares += deviation * (value - self.mean);
    }

    /// Adds all values of another sample.
    pub fn merge(&mut self, other: &Self) {
        if other.count == 0 {
            return;
        }
        let (here, there) = (self.count as f64, other.count as f64);
        let total = here + there;
        let shift = other.mean - self.mean;
        self.mean += shift * there / total;
        self.squares += other.squares + shift * shift * here * there / total;
        self.count += other.count;
    }

    /// Number of values.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Mean; NaN without values.
    pub fn mean(&self) -> f64 {
        if self.count == 0 { f64::NAN } else { self.mean }
    }

    /// Unbiased variance; NaN with fewer than two values.
    pub fn variance(&self) -> f64 {
        if self.count < 2 { f64::NAN } else { self.squares / (self.count - 1) as f64 }
    }

    /// Standard deviation.
    pub fn standard_deviation(&self) -> f64 {
        self.variance().sqrt()
    }

    /// Standard error of the mean.
    pub fn standard_error(&self) -> f64 {
        (self.variance() / self.count as f64).sqrt()
    }
}

impl FromIterator<f64> for Moments {
    fn from_iter<I: IntoIterator<Item = f64>>(values: I) -> Self {
        let mut moments = Self::default();
        values.into_iter().for_each(|value| moments.push(value));
        moments
    }
}

/// A mean with its confidence interval `mean ± half_width`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Mean.
    pub mean: f64,
    /// Half the width of the interval; NaN with fewer than two values.
    pub half_width: f64,
    /// Values that were defined.
    pub count: u64,
}

impl Interval {
    /// Lower end.
    pub fn low(&self) -> f64 {
        self.mean - self.half_width
    }

    /// Upper end.
    pub fn high(&self) -> f64 {
        self.mean + self.half_width
    }

    /// Whether the interval does not contain `value`; false where it is not defined.
    pub fn excludes(&self, value: f64) -> bool {
        self.low() > value || self.high() < value
    }

    /// Whether the half-width is at most `relative` of the mean's size.
    pub fn within(&self, relative: f64) -> bool {
        self.half_width <= relative * self.mean.abs()
    }

    /// The interval in other units, `factor` of them in one.
    pub fn scaled(&self, factor: f64) -> Self {
        Self { mean: self.mean * factor, half_width: self.half_width * factor.abs(), count: self.count }
    }
}

/// Quantile of Student's t that leaves `(1 − confidence)/2` above it; NaN below one degree of
/// freedom or outside `0 < confidence < 1`.
///
/// # Examples
/// ```
/// let t = toolroom_statistics::student(0.95, 19.0);
/// assert!((t - 2.093_024).abs() < 1e-6);
/// ```
pub fn student(confidence: f64, degrees_of_freedom: f64) -> f64 {
    if degrees_of_freedom < 1.0 || confidence <= 0.0 || confidence >= 1.0 {
        return f64::NAN;
    }
    let probability = 0.5 + 0.5 * confidence;
    if degrees_of_freedom > 1e4 {
        // The incomplete beta function loses its digits here; the next term of the expansion in
        // 1/degrees is below 1e-8 (Abramowitz and Stegun 26.7.5).
        let z = Normal::standard().inverse_cdf(probability);
        return z + (z.powi(3) + z) / (4.0 * degrees_of_freedom);
    }
    StudentsT::new(0.0, 1.0, degrees_of_freedom).map_or(f64::NAN, |t| t.inverse_cdf(probability))
}

/// Mean and t interval of the defined values.
///
/// # Examples
/// ```
/// let interval = toolroom_statistics::t_interval(&[1.0, 2.0, 3.0, 4.0, 5.0], 0.95);
/// assert!((interval.half_width - 1.963_243).abs() < 1e-6);
/// ```
pub fn t_interval(values: &[f64], confidence: f64) -> Interval {
    let moments: Moments = values.iter().copied().filter(|value| value.is_finite()).collect();
    from_moments(&moments, confidence)
}

fn from_moments(moments: &Moments, confidence: f64) -> Interval {
    let count = moments.count();
    let half_width = student(confidence, count as f64 - 1.0) * moments.standard_error();
    Interval { mean: moments.mean(), half_width, count }
}

/// A difference of two policies on common random numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paired {
    /// Mean of `value − baseline` over the replications in which both are defined.
    pub difference: Interval,
    /// Variance of the difference of independent runs over that of the paired ones: so many times
    /// fewer replications do. NaN where nothing varies.
    pub variance_reduction: f64,
}

/// Paired t interval of `values − baseline`, replication by replication.
///
/// # Examples
/// ```
/// use toolroom_statistics::paired;
/// let pair = paired(&[11.0, 21.0, 31.5], &[10.0, 20.0, 30.0], 0.95);
/// assert!((pair.difference.mean - 3.5 / 3.0).abs() < 1e-12 && pair.variance_reduction > 1000.0);
/// ```
pub fn paired(values: &[f64], baseline: &[f64], confidence: f64) -> Paired {
    let (mut sample, mut base, mut difference) = (Moments::default(), Moments::default(), Moments::default());
    for (&value, &reference) in values.iter().zip(baseline) {
        if value.is_finite() && reference.is_finite() {
            sample.push(value);
            base.push(reference);
            difference.push(value - reference);
        }
    }
    let variance_reduction = (sample.variance() + base.variance()) / difference.variance();
    Paired { difference: from_moments(&difference, confidence), variance_reduction }
}

/// Interval of `mean(values) − mean(baseline)` of independent samples, whose variances may differ; the
/// count is that of both.
///
/// # Source
/// B. L. Welch, Biometrika 34 (1947) 28; degrees of freedom by F. E. Satterthwaite, Biometrics
/// Bulletin 2 (1946) 110.
///
/// # Examples
/// ```
/// let interval = toolroom_statistics::welch(&[1.0, 2.0, 3.0, 4.0, 5.0], &[2.0, 4.0, 6.0], 0.95);
/// assert!((interval.mean + 1.0).abs() < 1e-15 && interval.count == 8);
/// ```
pub fn welch(values: &[f64], baseline: &[f64], confidence: f64) -> Interval {
    let moments = |values: &[f64]| values.iter().copied().filter(|value| value.is_finite()).collect::<Moments>();
    let (sample, base) = (moments(values), moments(baseline));
    let (a, b) = (sample.standard_error().powi(2), base.standard_error().powi(2));
    let mean = sample.mean() - base.mean();
    let count = sample.count() + base.count();
    if a + b == 0.0 {
        return Interval { mean, half_width: 0.0, count };
    }
    let freedom = (a + b).powi(2) / (a * a / (sample.count() as f64 - 1.0) + b * b / (base.count() as f64 - 1.0));
    Interval { mean, half_width: student(confidence, freedom) * (a + b).sqrt(), count }
}

/// Ratio of means `mean(values)/mean(baseline)` of paired replications, its interval by
/// linearisation: the residuals `value − ratio · baseline`, in units of the baseline's mean, take
/// the place of the values.
///
/// # Source
/// W. G. Cochran, Sampling Techniques, 3rd ed. (1977), §6.3 (ratio estimator).
///
/// # Examples
/// ```
/// let ratio = toolroom_statistics::ratio(&[2.0, 4.0, 6.0], &[1.0, 2.0, 3.0], 0.95);
/// assert!((ratio.mean - 2.0).abs() < 1e-15 && ratio.half_width < 1e-14);
/// ```
pub fn ratio(values: &[f64], baseline: &[f64], confidence: f64) -> Interval {
    let pairs = || {
        let defined = |(value, reference): &(&f64, &f64)| value.is_finite() && reference.is_finite();
        values.iter().zip(baseline).filter(defined).map(|(&value, &reference)| (value, reference))
    };
    let sample: Moments = pairs().map(|pair| pair.0).collect();
    let base: Moments = pairs().map(|pair| pair.1).collect();
    let mean = sample.mean() / base.mean();
    let residuals: Moments = pairs().map(|(value, reference)| (value - mean * reference) / base.mean()).collect();
    Interval { mean, ..from_moments(&residuals, confidence) }
}

/// Bounds of a rate of which `count` of `total` were seen, exact at `level` (two-sided).
///
/// # Source
/// Clopper & Pearson 1934.
///
/// # Examples
/// ```
/// let [low, high] = toolroom_statistics::clopper_pearson(0, 100, 0.95);
/// assert_eq!(low, 0.0);
/// assert!((high - (1.0 - 0.025_f64.powf(0.01))).abs() < 1e-9);
/// ```
pub fn clopper_pearson(count: usize, total: usize, level: f64) -> [f64; 2] {
    let tail = 0.5 * (1.0 - level);
    let quantile = |alpha: usize, beta: usize, share: f64| {
        Beta::new(alpha as f64, beta as f64).map_or(f64::NAN, |law| law.inverse_cdf(share))
    };
    let low = if count == 0 { 0.0 } else { quantile(count, total - count + 1, tail) };
    let high = if count >= total { 1.0 } else { quantile(count + 1, total - count, 1.0 - tail) };
    [low, high]
}

/// Bounds of a rate of which `count` of `total` were seen, by the score test at `level` (two-sided).
///
/// # Source
/// E. B. Wilson, Journal of the American Statistical Association 22 (1927) 209.
///
/// # Examples
/// ```
/// let [low, high] = toolroom_statistics::wilson(17, 20, 0.95);
/// assert!((low - 0.6396).abs() < 5e-5 && (high - 0.9476).abs() < 5e-5);
/// ```
pub fn wilson(count: usize, total: usize, level: f64) -> [f64; 2] {
    let z = Normal::standard().inverse_cdf(0.5 * (1.0 + level));
    let (share, total) = (count as f64 / total as f64, total as f64);
    let middle = share + z * z / (2.0 * total);
    let half = z * (share * (1.0 - share) / total + z * z / (4.0 * total * total)).sqrt();
    let scale = 1.0 + z * z / total;
    // Rounding may leave an end a little outside.
    [((middle - half) / scale).max(0.0), ((middle + half) / scale).min(1.0)]
}

/// Median; sorts `values`. NaN without values.
pub fn median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return f64::NAN;
    }
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    if values.len() % 2 == 1 { values[middle] } else { 0.5 * (values[middle - 1] + values[middle]) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Hull–Dobell congruential numbers, good enough for a coverage test and the same everywhere.
    struct Congruential(u64);

    impl Congruential {
        fn uniform(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((self.0 >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
        }

        fn normal(&mut self) -> f64 {
            let radius = (-2.0 * self.uniform().ln()).sqrt();
            radius * (std::f64::consts::TAU * self.uniform()).cos()
        }
    }

    #[test]
    fn quantiles_are_those_of_the_tables() {
        // Two-sided 95 % points of Student's t, Abramowitz and Stegun, table 26.10.
        for (freedom, expected) in [(1.0, 12.706), (2.0, 4.303), (9.0, 2.262), (19.0, 2.093), (120.0, 1.980)] {
            assert!((student(0.95, freedom) - expected).abs() < 5e-4, "{freedom}: {}", student(0.95, freedom));
        }
        // scipy.stats.t.ppf(0.975, ·): on both sides of the change of method.
        assert!((student(0.95, 9e3) - 1.960_227_605).abs() < 1e-8);
        assert!((student(0.95, 1e5) - 1.959_987_707_5).abs() < 1e-8);
        assert!((student(0.90, 10.0) - 1.812_461).abs() < 1e-6);
        assert!(student(0.95, 0.0).is_nan() && student(1.0, 5.0).is_nan());
    }

    #[test]
    fn student_sleep_data_give_the_published_paired_interval() {
        // Student, Biometrika 6 (1908) 1: extra sleep, 10 patients, two drugs. R's t.test(paired):
        // mean 1.58, 95 % interval 0.7001142 to 2.4598858.
        let first = [0.7, -1.6, -0.2, -1.2, -0.1, 3.4, 3.7, 0.8, 0.0, 2.0];
        let second = [1.9, 0.8, 1.1, 0.1, -0.1, 4.4, 5.5, 1.6, 4.6, 3.4];
        let pair = paired(&second, &first, 0.95);
        assert!((pair.difference.mean - 1.58).abs() < 1e-12);
        assert!((pair.difference.low() - 0.700_114_2).abs() < 1e-6);
        assert!((pair.difference.high() - 2.459_885_8).abs() < 1e-6);
    }

    #[test]
    fn welchs_interval_of_the_sleep_data_is_the_published_one() {
        // R's t.test(second, first), not paired: 1.58, 95 % interval −0.2054832 to 3.3654832, 17.776
        // degrees of freedom.
        let first = [0.7, -1.6, -0.2, -1.2, -0.1, 3.4, 3.7, 0.8, 0.0, 2.0];
        let second = [1.9, 0.8, 1.1, 0.1, -0.1, 4.4, 5.5, 1.6, 4.6, 3.4];
        let interval = welch(&second, &first, 0.95);
        assert!((interval.mean - 1.58).abs() < 1e-12 && interval.count == 20);
        assert!((interval.low() + 0.205_483_2).abs() < 1e-6 && (interval.high() - 3.365_483_2).abs() < 1e-6);
        assert!(welch(&[1.0], &[2.0, 3.0], 0.95).half_width.is_nan());
        assert_eq!(welch(&[1.0, 1.0], &[2.0, 2.0], 0.95).half_width, 0.0);
    }

    #[test]
    fn intervals_cover_the_truth_as_often_as_they_say() {
        let mut random = Congruential(7);
        let (studies, size) = (4000, 10);
        let mut covered = [0; 3];
        for _ in 0..studies {
            let shared: Vec<f64> = (0..size).map(|_| random.normal()).collect();
            let a: Vec<f64> = shared.iter().map(|z| 10.0 + z + 0.5 * random.normal()).collect();
            let b: Vec<f64> = shared.iter().map(|z| 12.0 + z + 0.5 * random.normal()).collect();
            covered[0] += u32::from(!t_interval(&a, 0.95).excludes(10.0));
            covered[1] += u32::from(!paired(&b, &a, 0.95).difference.excludes(2.0));
            covered[2] += u32::from(!ratio(&b, &a, 0.95).excludes(1.2));
        }
        // Three standard errors of a share of 0.95 in 4000 studies are 0.0103; the ratio is only
        // asymptotically exact.
        for (share, slack) in covered.map(|n| f64::from(n) / f64::from(studies)).into_iter().zip([0.0103, 0.0103, 0.02])
        {
            assert!((share - 0.95).abs() < slack, "coverage {share}");
        }
    }

    #[test]
    fn common_noise_is_reported_as_variance_reduction() {
        let mut random = Congruential(3);
        let shared: Vec<f64> = (0..5000).map(|_| random.normal()).collect();
        let a: Vec<f64> = shared.iter().map(|z| 2.0 * z + random.normal()).collect();
        let b: Vec<f64> = shared.iter().map(|z| 2.0 * z + random.normal()).collect();
        // (5 + 5) / (1 + 1) = 5.
        assert!((paired(&b, &a, 0.95).variance_reduction - 5.0).abs() < 0.3);
    }

    #[test]
    fn undefined_values_leave_the_sample() {
        let interval = t_interval(&[1.0, f64::NAN, 3.0], 0.95);
        assert_eq!((interval.mean, interval.count), (2.0, 2));
        let pair = paired(&[1.0, f64::NAN, 5.0, 4.0], &[0.0, 1.0, f64::NAN, 3.0], 0.95);
        assert_eq!((pair.difference.mean, pair.difference.count), (1.0, 2));
        assert!(t_interval(&[], 0.95).mean.is_nan());
        assert!(!t_interval(&[2.0], 0.95).within(0.5) && !t_interval(&[2.0], 0.95).excludes(0.0));
    }

    proptest! {
        #[test]
        fn merging_is_the_same_as_pushing(values in prop::collection::vec(-1e3..1e3f64, 2..40), at in 0..40_usize) {
            let at = at.min(values.len());
            let mut left: Moments = values[..at].iter().copied().collect();
            let right: Moments = values[at..].iter().copied().collect();
            left.merge(&right);
            let all: Moments = values.iter().copied().collect();
            prop_assert_eq!(left.count(), all.count());
            prop_assert!((left.mean() - all.mean()).abs() < 1e-9);
            prop_assert!((left.variance() - all.variance()).abs() < 1e-6 * (1.0 + all.variance()));
        }
    }
}
