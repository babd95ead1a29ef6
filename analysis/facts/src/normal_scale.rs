//! Times of plain work where they are normal.
//!
//! The distribution of plain work may be skewed. The median of a few exponential times lies elsewhere on average than that of
//! the distribution, and their logarithms scatter further below it than above. A comparison that takes logarithms of times as
//! normal is biased by both. A time that a share `u` of its distribution does not reach is therefore replaced by the time that
//! the same share of a lognormal distribution does not reach, which has the same median and the same distance of its quartiles.
//! Times keep their order, so the median of some times is replaced by the median of what replaces them.
//!
//! # Source
//! Probability integral transform: Rosenblatt 1952; normal scores of it: Dunn & Smyth 1996.

use statrs::distribution::{ContinuousCDF, Normal};
use toolroom_scenario::Distribution;

/// Scores up to this far have their place by the distribution; what lies further keeps its distance from there in the
/// logarithm, since the shares of a distribution say little of one in a thousand times (assumption).
const FARTHEST: f64 = 3.0;
/// Steps from the least of these scores to the greatest (count): between them the logarithm is taken as straight. Assumption: the
/// logarithm of exponential times bends by less than 1e-3 within one.
const STEPS: usize = 120;
/// Normal score of the upper quartile.
const QUARTILE: f64 = 0.674_489_750_196_081_7;
/// Factors on all times that a scale has to keep: constants are fitted on it and are written as factors on times (assumption).
const FACTORS: [f64; 6] = [0.8, 0.9, 0.95, 1.05, 1.1, 1.25];
/// Share by which the logarithm of such a factor may be another one on the scale (assumption).
const KEPT: f64 = 0.1;

/// Where times of a distribution would lie if their logarithms were normal.
#[derive(Clone, Debug, PartialEq)]
pub struct NormalScale {
    /// Logarithms of the quantiles over the median, at scores at equal distances.
    logarithms: Vec<f64>,
    /// Scatter of the logarithm that has the same quartiles.
    deviation: f64,
}

impl NormalScale {
    /// The scale of a distribution; `None` where times are no numbers above zero that differ, as of constant ones and of a few
    /// possible ones, and where a factor on all times would be quite another one on the scale, as where they have a least and a
    /// greatest value near to each other. The middle of a few of these is hardly biased.
    pub fn of(law: &Distribution) -> Option<Self> {
        let normal = Normal::standard();
        let time = |score: f64| law.quantile(normal.cdf(score));
        let middle = time(0.0);
        let logarithms: Vec<f64> = (0..=STEPS).map(|step| (time(score_at(step)) / middle).ln()).collect();
        let apart = logarithms.windows(2).all(|pair| pair[0].is_finite() && pair[1].is_finite() && pair[0] < pair[1]);
        if !apart {
            return None;
        }
        let deviation = (time(QUARTILE) / time(-QUARTILE)).ln() / (2.0 * QUARTILE);
        let scale = Self { logarithms, deviation };
        let kept = |factor: f64| (scale.normal(factor.ln()) / factor.ln() - 1.0).abs() <= KEPT;
        FACTORS.into_iter().all(kept).then_some(scale)
    }

    /// Scatter of the logarithm of times on this scale.
    pub fn deviation(&self) -> f64 {
        self.deviation
    }

    /// The logarithm of a time over the median, as it would be if it were normal.
    pub fn normal(&self, logarithm: f64) -> f64 {
        let ends = [self.logarithms[0], self.logarithms[STEPS]];
        if logarithm <= ends[0] {
            return logarithm - ends[0] - self.deviation * FARTHEST;
        }
        if logarithm >= ends[1] {
            return logarithm - ends[1] + self.deviation * FARTHEST;
        }
        let above = self.logarithms.partition_point(|own| *own < logarithm).max(1);
        let [from, to] = [self.logarithms[above - 1], self.logarithms[above]];
        let share = (logarithm - from) / (to - from);
        self.deviation * (score_at(above - 1) + share * step_width())
    }

    /// The logarithm of a time over the median, from what it would be if it were normal.
    pub fn logarithm(&self, normal: f64) -> f64 {
        let score = normal / self.deviation;
        if score.abs() >= FARTHEST {
            let end = if score < 0.0 { self.logarithms[0] } else { self.logarithms[STEPS] };
            return end + normal - self.deviation * FARTHEST.copysign(score);
        }
        let place = (score + FARTHEST) / step_width();
        let below = (place as usize).min(STEPS - 1);
        let [from, to] = [self.logarithms[below], self.logarithms[below + 1]];
        from + (place - below as f64) * (to - from)
    }
}

/// From −1 to 1.
fn place_of(step: usize, steps: usize) -> f64 {
    2.0 * step as f64 / steps as f64 - 1.0
}

fn score_at(step: usize) -> f64 {
    FARTHEST * place_of(step, STEPS)
}

fn step_width() -> f64 {
    2.0 * FARTHEST / STEPS as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use toolroom_statistics::median;

    fn exponential() -> NormalScale {
        NormalScale::of(&Distribution::Exponential { mean: 300.0 }).unwrap()
    }

    #[test]
    fn lognormal_times_stay_where_they_are_and_those_of_a_few_values_have_no_scale() {
        let scale = NormalScale::of(&Distribution::Lognormal { mean: 100.0, cv: 0.3 }).unwrap();
        let deviation = (0.09_f64).ln_1p().sqrt();
        assert!((scale.deviation() - deviation).abs() < 1e-9);
        for y in [-2.0, -0.7, -0.1, 0.0, 0.3, 1.5] {
            assert!((scale.normal(y) - y).abs() < 1e-6, "{y}: {}", scale.normal(y));
        }
        for law in [Distribution::Constant(5.0), Distribution::DiscreteUniform { low: 1.0, step: 1.0, count: 6 }] {
            assert_eq!(NormalScale::of(&law), None);
        }
    }

    /// A tenth more of 9 to 11 min would be a quarter more on the scale.
    #[test]
    fn narrow_bounds_have_no_scale_and_a_factor_on_exponential_times_is_kept() {
        let law = |low: f64, high: f64| NormalScale::of(&Distribution::Uniform { low, high });
        assert_eq!(law(540.0, 660.0), None);
        let scale = exponential();
        assert!((scale.normal(1.1_f64.ln()) / 1.1_f64.ln() - 1.0).abs() < 0.05);
    }

    #[test]
    fn there_and_back_is_the_same_within_the_distribution_and_beyond() {
        let scale = exponential();
        for y in [-9.0, -6.0, -2.0, -0.01, 0.0, 0.5, 1.5, 2.4, 4.0] {
            assert!((scale.logarithm(scale.normal(y)) - y).abs() < 1e-9, "{y}");
        }
        assert!(scale.normal(0.0).abs() < 1e-12);
    }

    #[test]
    fn middles_of_a_few_exponential_times_are_fair_on_the_scale_and_biased_without_it() {
        let scale = exponential();
        let normal = Normal::standard();
        // All blocks of three of 45 times that cover the distribution.
        let times: Vec<f64> = (0..45).map(|i| normal.inverse_cdf((i as f64 + 0.5) / 45.0)).collect();
        let (mut bare, mut scaled, mut count) = (0.0, 0.0, 0.0);
        for a in 0..45 {
            for b in 0..a {
                for c in 0..b {
                    let mut block = [a, b, c].map(|at| scale.logarithm(scale.deviation() * times[at]));
                    let middle = median(&mut block);
                    bare += middle;
                    scaled += scale.normal(middle);
                    count += 1.0;
                }
            }
        }
        assert!((scaled / count).abs() < 1e-9, "{}", scaled / count);
        assert!(bare / count < -0.05, "{}", bare / count);
    }
}
