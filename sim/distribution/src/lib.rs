//! Random times of a shop: families, each drawn by inversion of exactly one uniform number, so that long and short times
//! meet the same jobs when a parameter changes.

#![deny(clippy::wildcard_enum_match_arm)]
#![cfg_attr(test, allow(clippy::wildcard_enum_match_arm))]

use rand::RngExt;
use statrs::function::beta::beta_reg;
use statrs::function::erf::{erf_inv, erfc, erfc_inv};
use statrs::function::gamma::{gamma, gamma_lr};
use std::f64::consts::{FRAC_1_SQRT_2, PI, SQRT_2};
use std::sync::Arc;
use toolroom_kernel::Stream;
use toolroom_numerics::{beta_quantile, gamma_quantile};

/// A random time, s, 0 or longer.
#[derive(Clone, Debug, PartialEq)]
pub enum Distribution {
    /// Always the same.
    Constant(f64),
    /// Exponential with this mean.
    Exponential {
        /// Mean, s.
        mean: f64,
    },
    /// Erlang: the sum of `phases` equal exponential times.
    Erlang {
        /// Mean of the sum, s.
        mean: f64,
        /// Number of phases.
        phases: u32,
    },
    /// Gamma by mean and coefficient of variation.
    Gamma {
        /// Mean, s.
        mean: f64,
        /// Standard deviation over mean.
        cv: f64,
    },
    /// Lognormal by mean and coefficient of variation.
    Lognormal {
        /// Mean, s.
        mean: f64,
        /// Standard deviation over mean.
        cv: f64,
    },
    /// Weibull by mean and shape.
    Weibull {
        /// Mean, s.
        mean: f64,
        /// Shape, 1.
        shape: f64,
    },
    /// Triangular.
    Triangular {
        /// Least, s.
        low: f64,
        /// Most likely, s.
        mode: f64,
        /// Greatest, s.
        high: f64,
    },
    /// Beta by three points, as estimated in PERT: its mean is (low + 4 mode + high)/6.
    Beta {
        /// Least, s.
        low: f64,
        /// Most likely, s.
        mode: f64,
        /// Greatest, s.
        high: f64,
    },
    /// Normal, of which only what lies between two ends is drawn. Its mean is not `mean`.
    Normal {
        /// Mean of the whole normal distribution, s.
        mean: f64,
        /// Standard deviation of the whole normal distribution, s.
        sd: f64,
        /// Least, s.
        low: f64,
        /// Greatest, s; infinite where nothing is cut off.
        high: f64,
    },
    /// Uniform.
    Uniform {
        /// Least, s.
        low: f64,
        /// Greatest, s.
        high: f64,
    },
    /// Equally likely times at equal distances.
    DiscreteUniform {
        /// Least, s.
        low: f64,
        /// Distance of neighbours, s.
        step: f64,
        /// Number of times.
        count: u32,
    },
    /// Observed times, each with its share.
    Empirical(Arc<Empirical>),
}

/// Times and how often they occur.
#[derive(Clone, Debug, PartialEq)]
pub struct Empirical {
    /// Times in ascending order, s, each with the share of all that are at most as long.
    steps: Vec<(f64, f64)>,
    mean: f64,
    /// Whether times between two neighbours occur, too.
    continuous: bool,
}

impl Empirical {
    /// Times (s) with weights (0 or more, not all 0), in any order.
    ///
    /// # Examples
    /// ```
    /// use toolroom_distribution::{Distribution, Empirical};
    /// let times = Empirical::new(&[(30.0, 0.3), (5.0, 0.7)]);
    /// assert_eq!(times.mean(), 12.5);
    /// assert_eq!(Distribution::Empirical(times.into()).quantile(0.69), 5.0);
    /// ```
    pub fn new(weighted: &[(f64, f64)]) -> Self {
        let mut sorted = weighted.to_vec();
        sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
        let total: f64 = sorted.iter().map(|(_, weight)| weight).sum();
        let mean = sorted.iter().map(|(time, weight)| time * weight).sum::<f64>() / total;
        let mut below = 0.0;
        let cumulated = |(time, weight): (f64, f64)| {
            below += weight / total;
            (time, below)
        };
        let steps = sorted.into_iter().filter(|(_, weight)| *weight > 0.0).map(cumulated).collect();
        Self { steps, mean, continuous: false }
    }

    /// Observed times (s, at least one), in any order, between which others occur as well: the distribution is linear between
    /// neighbouring ones, and nothing is shorter than the shortest or longer than the longest.
    ///
    /// # Source
    /// A. M. Law, Simulation Modeling and Analysis, 5th ed. (2015), section 6.2.4: F(X₍ᵢ₎) = (i − 1)/(n − 1).
    ///
    /// # Examples
    /// ```
    /// use toolroom_distribution::{Distribution, Empirical};
    /// let times = Empirical::observed(&[8.0, 2.0, 4.0]);
    /// assert_eq!(times.mean(), 4.5); // (2 + 4)/2 and (4 + 8)/2, each in half of all cases
    /// let times = Distribution::Empirical(times.into());
    /// assert_eq!([0.0, 0.25, 0.5, 0.75].map(|u| times.quantile(u)), [2.0, 3.0, 4.0, 6.0]);
    /// ```
    pub fn observed(times: &[f64]) -> Self {
        let mut sorted = times.to_vec();
        sorted.sort_by(f64::total_cmp);
        let intervals = (sorted.len().max(2) - 1) as f64;
        let steps: Vec<(f64, f64)> = sorted.iter().enumerate().map(|(i, time)| (*time, i as f64 / intervals)).collect();
        let mean = match sorted.as_slice() {
            [only] => *only,
            several => several.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).sum::<f64>() / intervals,
        };
        Self { steps, mean, continuous: true }
    }

    /// Mean, s.
    pub fn mean(&self) -> f64 {
        self.mean
    }

    fn share_below(&self, time: f64) -> f64 {
        let shorter = self.steps.partition_point(|(each, _)| *each < time);
        let equal = self.steps.partition_point(|(each, _)| *each <= time);
        if self.continuous {
            return self.share_between(shorter, equal, time);
        }
        let share = |at: usize| at.checked_sub(1).map_or(0.0, |last| self.steps[last].1);
        0.5 * (share(shorter) + share(equal))
    }

    /// The same where times between neighbours occur: `shorter` of them are shorter, `equal` are at most as long. Equal
    /// times are a step of the distribution, of which half counts.
    fn share_between(&self, shorter: usize, equal: usize, time: f64) -> f64 {
        let last = self.steps.len() - 1;
        if equal > shorter {
            let from = if shorter == 0 { 0.0 } else { self.steps[shorter].1 };
            let to = if last == 0 { 1.0 } else { self.steps[equal - 1].1 };
            return 0.5 * (from + to);
        }
        match shorter {
            0 => 0.0,
            above if above > last => 1.0,
            above => {
                let ((low, from), (high, to)) = (self.steps[above - 1], self.steps[above]);
                from + (to - from) * (time - low) / (high - low)
            }
        }
    }

    fn quantile(&self, u: f64) -> f64 {
        if self.continuous {
            let last = self.steps.len() - 1;
            let place = u * last as f64;
            let below = (place as usize).min(last.saturating_sub(1));
            let (low, high) = (self.steps[below].0, self.steps[(below + 1).min(last)].0);
            return low + (place - below as f64) * (high - low);
        }
        let step = self.steps.partition_point(|(_, below)| *below <= u);
        // Rounding may leave the last share a little below 1.
        self.steps.get(step).or(self.steps.last()).map_or(f64::NAN, |(time, _)| *time)
    }
}

/// Exponents of the beta distribution of three points.
///
/// # Source
/// D. G. Malcolm et al., Operations Research 7 (1959) 646, with the weight 4 of the mode.
fn beta_exponents(low: f64, mode: f64, high: f64) -> (f64, f64) {
    (1.0 + 4.0 * (mode - low) / (high - low), 1.0 + 4.0 * (high - mode) / (high - low))
}

/// Probability above `z` in a standard normal distribution.
fn normal_above(z: f64) -> f64 {
    0.5 * erfc(z * FRAC_1_SQRT_2)
}

impl Distribution {
    /// The distribution of `factor` (above 0) times such a time.
    ///
    /// # Examples
    /// ```
    /// use toolroom_distribution::Distribution;
    /// let law = Distribution::Triangular { low: 1.0, mode: 2.0, high: 6.0 };
    /// assert_eq!(law.scaled(2.0).quantile(0.3), 2.0 * law.quantile(0.3));
    /// ```
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        match *self {
            Self::Constant(value) => Self::Constant(factor * value),
            Self::Exponential { mean } => Self::Exponential { mean: factor * mean },
            Self::Erlang { mean, phases } => Self::Erlang { mean: factor * mean, phases },
            Self::Gamma { mean, cv } => Self::Gamma { mean: factor * mean, cv },
            Self::Lognormal { mean, cv } => Self::Lognormal { mean: factor * mean, cv },
            Self::Weibull { mean, shape } => Self::Weibull { mean: factor * mean, shape },
            Self::Triangular { low, mode, high } => {
                Self::Triangular { low: factor * low, mode: factor * mode, high: factor * high }
            }
            Self::Beta { low, mode, high } => {
                Self::Beta { low: factor * low, mode: factor * mode, high: factor * high }
            }
            Self::Normal { mean, sd, low, high } => {
                Self::Normal { mean: factor * mean, sd: factor * sd, low: factor * low, high: factor * high }
            }
            Self::Uniform { low, high } => Self::Uniform { low: factor * low, high: factor * high },
            Self::DiscreteUniform { low, step, count } => {
                Self::DiscreteUniform { low: factor * low, step: factor * step, count }
            }
            Self::Empirical(ref times) => {
                let steps = times.steps.iter().map(|(time, share)| (factor * time, *share)).collect();
                let (mean, continuous) = (factor * times.mean, times.continuous);
                Self::Empirical(Arc::new(Empirical { steps, mean, continuous }))
            }
        }
    }

    /// Mean, s.
    pub fn mean(&self) -> f64 {
        match *self {
            Self::Constant(value) => value,
            Self::Exponential { mean }
            | Self::Erlang { mean, .. }
            | Self::Gamma { mean, .. }
            | Self::Lognormal { mean, .. }
            | Self::Weibull { mean, .. } => mean,
            Self::Triangular { low, mode, high } => (low + mode + high) / 3.0,
            Self::Beta { low, mode, high } => (low + 4.0 * mode + high) / 6.0,
            Self::Normal { mean, sd, low, high } => {
                let (from, to) = ((low - mean) / sd, (high - mean) / sd);
                let density = |z: f64| (-0.5 * z * z).exp() / (2.0 * PI).sqrt();
                mean + sd * (density(from) - density(to)) / (normal_above(from) - normal_above(to))
            }
            Self::Uniform { low, high } => 0.5 * (low + high),
            Self::DiscreteUniform { low, step, count } => low + 0.5 * step * f64::from(count - 1),
            Self::Empirical(ref times) => times.mean(),
        }
    }

    /// Whether every draw gives the same time.
    pub fn is_constant(&self) -> bool {
        matches!(self, Self::Constant(_))
    }

    /// Variance, s², summed over `shares` equal shares of the probability (1 and more): of a wide tail, what lies beyond the
    /// middle of the outermost share is left out.
    ///
    /// # Examples
    /// ```
    /// use toolroom_distribution::Distribution;
    /// let repair = Distribution::Uniform { low: 600.0, high: 1200.0 };
    /// assert!((repair.variance(1000) / (600.0 * 600.0 / 12.0) - 1.0).abs() < 1e-5);
    /// ```
    pub fn variance(&self, shares: usize) -> f64 {
        let mean = self.mean();
        let times = (0..shares).map(|i| self.quantile((i as f64 + 0.5) / shares as f64));
        times.map(|time| (time - mean).powi(2)).sum::<f64>() / shares as f64
    }

    /// The time below which a share `u` (0 to below 1) of all times lies.
    ///
    /// # Examples
    /// ```
    /// use toolroom_distribution::Distribution;
    /// let repair = Distribution::Uniform { low: 10.0, high: 20.0 };
    /// assert_eq!(repair.quantile(0.25), 12.5);
    /// ```
    pub fn quantile(&self, u: f64) -> f64 {
        let exponential = || -(-u).ln_1p();
        match *self {
            Self::Constant(value) => value,
            Self::Exponential { mean } => mean * exponential(),
            Self::Erlang { mean, phases: 1 } => mean * exponential(),
            Self::Erlang { mean, phases } => mean / f64::from(phases) * gamma_quantile(f64::from(phases), u),
            Self::Gamma { mean, cv } => mean * cv * cv * gamma_quantile((cv * cv).recip(), u),
            Self::Lognormal { mean, cv } => {
                let variance = (cv * cv).ln_1p();
                // Half a step of the generator above zero, whose quantile is finite.
                let z = SQRT_2 * erf_inv(2.0 * u.max(HALF_STEP) - 1.0);
                mean * (variance.sqrt() * z - 0.5 * variance).exp()
            }
            Self::Weibull { mean, shape } => mean / gamma(1.0 + 1.0 / shape) * exponential().powf(1.0 / shape),
            Self::Triangular { low, mode, high } => {
                let (below, above, width) = (mode - low, high - mode, high - low);
                if u * width < below {
                    low + (u * width * below).sqrt()
                } else {
                    high - ((1.0 - u) * width * above).sqrt()
                }
            }
            Self::Beta { low, mode, high } => {
                let (a, b) = beta_exponents(low, mode, high);
                low + (high - low) * beta_quantile(a, b, u)
            }
            Self::Normal { mean, sd, low, high } => {
                let (from, to) = (normal_above((low - mean) / sd), normal_above((high - mean) / sd));
                let z = SQRT_2 * erfc_inv(2.0 * (from - u * (from - to)));
                (mean + sd * z).clamp(low, high)
            }
            Self::Uniform { low, high } => low + u * (high - low),
            Self::DiscreteUniform { low, step, count } => {
                low + step * (u * f64::from(count)).floor().min(f64::from(count - 1))
            }
            Self::Empirical(ref times) => times.quantile(u),
        }
    }

    /// Share of all times that are shorter than `time` (s), those of exactly this length counted half.
    ///
    /// # Examples
    /// ```
    /// use toolroom_distribution::Distribution;
    /// let repair = Distribution::Uniform { low: 10.0, high: 20.0 };
    /// assert_eq!(repair.share_below(12.5), 0.25);
    /// ```
    pub fn share_below(&self, time: f64) -> f64 {
        let half = |equal: bool| if equal { 0.5 } else { 0.0 };
        let gamma_below = |shape: f64, mean: f64| gamma_lr(shape, (time * shape / mean).max(f64::MIN_POSITIVE));
        match *self {
            Self::Constant(value) => f64::from(u8::from(time > value)) + half(time == value),
            Self::Exponential { mean } => -(-time / mean).exp_m1(),
            Self::Erlang { mean, phases } => gamma_below(f64::from(phases), mean),
            Self::Gamma { mean, cv } => gamma_below((cv * cv).recip(), mean),
            Self::Lognormal { mean, cv } => {
                let variance = (cv * cv).ln_1p();
                normal_above(-((time / mean).ln() + 0.5 * variance) / variance.sqrt())
            }
            Self::Weibull { mean, shape } => -(-(time / mean * gamma(1.0 + 1.0 / shape)).powf(shape)).exp_m1(),
            Self::Triangular { low, mode, high } => {
                if time <= low {
                    0.0
                } else if time < mode {
                    (time - low).powi(2) / ((high - low) * (mode - low))
                } else if time < high {
                    1.0 - (high - time).powi(2) / ((high - low) * (high - mode))
                } else {
                    1.0
                }
            }
            Self::Beta { low, mode, high } => {
                let (a, b) = beta_exponents(low, mode, high);
                beta_reg(a, b, ((time - low) / (high - low)).clamp(0.0, 1.0))
            }
            Self::Normal { mean, sd, low, high } => {
                let above = |time: f64| normal_above((time - mean) / sd);
                (above(low) - above(time.clamp(low, high))) / (above(low) - above(high))
            }
            Self::Uniform { low, high } => (time - low) / (high - low),
            Self::DiscreteUniform { low, step, count } => {
                let grid_place = (time - low) / step;
                let below = (grid_place.ceil().max(0.0) + half(grid_place >= 0.0 && grid_place.fract() == 0.0))
                    / f64::from(count);
                below.min(1.0)
            }
            Self::Empirical(ref times) => times.share_below(time),
        }
    }

    /// Draws a time from `stream`: always one number of it, so that equal ranks meet under
    /// different distributions and later draws are the same.
    ///
    /// # Examples
    /// ```
    /// use toolroom_distribution::Distribution;
    /// use toolroom_kernel::{Entity, Purpose, Streams};
    /// let mut stream = Streams::new(1, 0).open(Entity::named("lathe"), Purpose::Repair);
    /// assert_eq!(Distribution::Constant(5.0).sample(&mut stream), 5.0);
    /// ```
    pub fn sample(&self, stream: &mut Stream) -> f64 {
        self.quantile(stream.random())
    }
}

/// Half the step of a random number in 0 to 1.
const HALF_STEP: f64 = 0.5 / (1u64 << 53) as f64;

#[cfg(test)]
mod tests {
    use super::*;
    use toolroom_kernel::{Entity, Purpose, Streams};

    #[test]
    fn sample_means_and_spreads_are_those_asked_for() {
        let cases = [
            (Distribution::Exponential { mean: 3.0 }, 3.0),
            (Distribution::Lognormal { mean: 3.0, cv: 0.5 }, 1.5),
            // Weibull of shape 2: cv = sqrt(4/pi - 1).
            (Distribution::Weibull { mean: 3.0, shape: 2.0 }, 3.0 * (4.0 / PI - 1.0).sqrt()),
            // Triangular variance (a² + b² + c² - ab - ac - bc)/18.
            (Distribution::Triangular { low: 1.0, mode: 2.0, high: 6.0 }, (21.0f64 / 18.0).sqrt()),
            (Distribution::Uniform { low: 2.0, high: 4.0 }, (4.0f64 / 12.0).sqrt()),
            (Distribution::Erlang { mean: 3.0, phases: 4 }, 1.5),
            (Distribution::Gamma { mean: 3.0, cv: 1.5 }, 4.5),
            // PERT: alpha 1.8, beta 4.2; variance width² alpha beta/((alpha + beta)² (alpha + beta + 1)).
            (Distribution::Beta { low: 1.0, mode: 2.0, high: 6.0 }, (25.0 * 1.8 * 4.2 / (36.0f64 * 7.0)).sqrt()),
            // Half a normal distribution: deviation sd sqrt(1 - 2/pi).
            (Distribution::Normal { mean: 5.0, sd: 2.0, low: 5.0, high: f64::INFINITY }, 2.0 * (1.0 - 2.0 / PI).sqrt()),
            // Whole numbers 1 to 49: variance (49² - 1)/12.
            (Distribution::DiscreteUniform { low: 1.0, step: 1.0, count: 49 }, 200.0f64.sqrt()),
            (Distribution::Empirical(Arc::new(Empirical::new(&[(30.0, 3.0), (5.0, 7.0)]))), 25.0 * 0.21f64.sqrt()),
        ];
        for (distribution, deviation) in cases {
            let mut stream = Streams::new(5, 0).open(Entity::named("test"), Purpose::Processing);
            let n = 200_000;
            let (mut sum, mut squares) = (0.0, 0.0);
            for _ in 0..n {
                let value = distribution.sample(&mut stream);
                assert!(value >= 0.0);
                sum += value;
                squares += value * value;
            }
            let mean = sum / f64::from(n);
            let spread = (squares / f64::from(n) - mean * mean).sqrt();
            assert!((mean / distribution.mean() - 1.0).abs() < 0.01, "{distribution:?}: mean {mean}");
            assert!((spread / deviation - 1.0).abs() < 0.02, "{distribution:?}: deviation {spread}");
        }
    }

    #[test]
    fn quantiles_are_those_computed_independently() {
        // scipy.stats: erlang of mean 12 in three phases, gamma of mean 10 and cv 0.5, normal of 10 and 4
        // cut off below 0, whose mean is 10.0705513.
        let normal = Distribution::Normal { mean: 10.0, sd: 4.0, low: 0.0, high: f64::INFINITY };
        assert!((normal.mean() / 10.070_551_3 - 1.0).abs() < 1e-8);
        let cases = [
            (
                Distribution::Erlang { mean: 12.0, phases: 3 },
                [1.744_180_66, 4.408_261_313, 10.696_241_25, 21.289_281_35, 33.623_787_66],
            ),
            (
                Distribution::Gamma { mean: 10.0, cv: 0.5 },
                [2.058_121_716, 4.361_923_907, 9.180_151_872, 16.701_957_67, 25.112_793_79],
            ),
            (normal, [1.437_046_269, 4.998_662_186, 10.031_130_96, 15.140_391_7, 19.314_736_43]),
        ];
        for (distribution, expected) in cases {
            for (u, expected) in [0.01, 0.1, 0.5, 0.9, 0.99].into_iter().zip(expected) {
                let value = distribution.quantile(u);
                assert!((value / expected - 1.0).abs() < 2e-9, "{distribution:?} at {u}: {value}");
            }
        }
    }

    #[test]
    fn shares_and_quantiles_undo_each_other() {
        let cases = [
            Distribution::Exponential { mean: 3.0 },
            Distribution::Erlang { mean: 3.0, phases: 2 },
            Distribution::Gamma { mean: 3.0, cv: 0.7 },
            Distribution::Lognormal { mean: 3.0, cv: 0.7 },
            Distribution::Weibull { mean: 3.0, shape: 1.7 },
            Distribution::Triangular { low: 1.0, mode: 2.0, high: 6.0 },
            Distribution::Beta { low: 1.0, mode: 2.0, high: 6.0 },
            Distribution::Normal { mean: 3.0, sd: 2.0, low: 1.0, high: 9.0 },
            Distribution::Uniform { low: 2.0, high: 4.0 },
        ];
        for distribution in cases {
            for share in [0.001, 0.2, 0.5, 0.8, 0.999] {
                let back = distribution.share_below(distribution.quantile(share));
                assert!((back - share).abs() < 1e-10, "{distribution:?} at {share}: {back}");
            }
        }
        let two = Distribution::Empirical(Arc::new(Empirical::new(&[(30.0, 0.25), (5.0, 0.75)])));
        assert_eq!([4.0, 5.0, 6.0, 30.0, 31.0].map(|time| two.share_below(time)), [0.0, 0.375, 0.75, 0.875, 1.0]);
        let four = Distribution::DiscreteUniform { low: 1.0, step: 1.0, count: 4 };
        assert_eq!([0.5, 1.0, 1.5, 4.0, 4.5].map(|time| four.share_below(time)), [0.0, 0.125, 0.25, 0.875, 1.0]);
    }

    #[test]
    fn observed_times_are_joined_by_lines() {
        let times = |values: &[f64]| Distribution::Empirical(Arc::new(Empirical::observed(values)));
        let law = times(&[10.0, 2.0, 4.0, 4.0, 20.0]);
        // Five order statistics are at 0, 1/4, 1/2, 3/4 and 1.
        assert_eq!([0.0, 0.125, 0.25, 0.4, 0.625, 0.875].map(|u| law.quantile(u)), [2.0, 3.0, 4.0, 4.0, 7.0, 15.0]);
        assert_eq!(law.mean(), (3.0 + 4.0 + 7.0 + 15.0) / 4.0);
        assert_eq!([1.0, 3.0, 4.0, 7.0, 21.0].map(|time| law.share_below(time)), [0.0, 0.125, 0.375, 0.625, 1.0]);
        assert_eq!(law.scaled(2.0).quantile(0.625), 14.0);
        let one = times(&[5.0]);
        assert_eq!((one.mean(), one.quantile(0.7), one.share_below(5.0)), (5.0, 5.0, 0.5));
    }

    #[test]
    fn quantiles_rise_and_stay_between_the_ends() {
        let cases = [
            (Distribution::Beta { low: 2.0, mode: 2.0, high: 3.0 }, 2.0, 3.0),
            (Distribution::Normal { mean: 10.0, sd: 1.0, low: 9.0, high: 10.5 }, 9.0, 10.5),
            (Distribution::Gamma { mean: 1.0, cv: 3.0 }, 0.0, f64::INFINITY),
            (Distribution::DiscreteUniform { low: 60.0, step: 60.0, count: 49 }, 60.0, 2940.0),
        ];
        for (distribution, low, high) in cases {
            let mut last = low;
            for i in 0..1000 {
                let value = distribution.quantile(f64::from(i) / 1000.0);
                assert!(value >= last && value <= high, "{distribution:?} at {i}/1000: {value}");
                last = value;
            }
            assert!(distribution.quantile(1.0 - HALF_STEP).is_finite());
        }
    }
}
