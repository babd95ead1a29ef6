//! Times of plain work where they are normal.
//!
//! The file gives plain work a distribution that may be as skewed as it likes: a few exponential times have their middle
//! elsewhere than their distribution, one of three lies below half of it, and the scatter of their logarithm is longer towards
//! the short ones. Blocks are compared as if logarithms were normal. A time of the share `u` of its distribution is therefore
//! taken for the one of the same share of a lognormal distribution with the same median and quartiles, at the same distance.
//! What a model says of a middle is taken there in the same way, which is exact: the middle of times goes where the times go.
//!
//! # Source
//! Probability integral transform: Rosenblatt 1952; normal scores of it: Dunn & Smyth 1996.

use super::stops::Shape;
use statrs::distribution::{ContinuousCDF, Normal};
use toolroom_scenario::Distribution;

/// Scores up to this far have their place by the distribution; what lies further keeps its distance from there in the
/// logarithm, since the shares of a distribution say little of one in a thousand times (assumption).
const FARTHEST: f64 = 3.0;
/// Steps from the least of these scores to the greatest (count): between them the logarithm is taken as straight.
const STEPS: usize = 120;
/// Normal score of the upper quartile.
const QUARTILE: f64 = 0.674_489_750_196_081_7;
/// Factors on all times of which the shape is known, as logarithms: from this far below to this far above (assumption).
const REACH: f64 = 1.0;
/// Steps of that (count).
const SHIFTS: usize = 20;
/// Times of the distribution behind such a shape (count).
const TIMES: usize = 1000;

/// Where times of a distribution would lie if their logarithms were normal.
#[derive(Clone, Debug, PartialEq)]
pub struct NormalScale {
    /// Logarithms of the quantiles over the median, at scores at equal distances.
    logarithms: Vec<f64>,
    /// Scatter of the logarithm that has the same quartiles.
    deviation: f64,
    /// What a common factor on all times does to the shape, by the logarithm of the factor at equal distances.
    shifted: Vec<Shape>,
}

impl NormalScale {
    /// The scale of a distribution; `None` where times are no numbers above zero that differ, as of constant ones and of a few
    /// possible ones.
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
        let mut scale = Self { logarithms, deviation, shifted: Vec::new() };
        scale.shifted = (0..=SHIFTS).map(|step| scale.shape_at(REACH * place_of(step, SHIFTS))).collect();
        Some(scale)
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

    /// What a factor on all times does to the shape of times on this scale; their middle is left out.
    pub fn shifted(&self, logarithm: f64) -> Shape {
        let place = (logarithm.clamp(-REACH, REACH) / REACH + 1.0) * 0.5 * SHIFTS as f64;
        let below = (place as usize).min(SHIFTS - 1);
        let share = place - below as f64;
        let [from, to] = [self.shifted[below], self.shifted[below + 1]];
        let between = |of: &dyn Fn(&Shape) -> f64| of(&from) + share * (of(&to) - of(&from));
        Shape {
            location: 0.0,
            tail: between(&|shape| shape.tail),
            excess: between(&|shape| shape.excess),
            spread: between(&|shape| shape.spread),
        }
    }

    /// What is between the shape of all times, each longer by this, and that of the times as they are.
    fn shape_at(&self, shift: f64) -> Shape {
        let normal = Normal::standard();
        let scores: Vec<f64> =
            (0..TIMES).map(|i| normal.inverse_cdf((i as f64 + 0.5) / TIMES as f64) * self.deviation).collect();
        let moved = |shift: f64| -> Shape {
            let mut times: Vec<f64> = scores.iter().map(|y| self.normal(self.logarithm(*y) + shift)).collect();
            Shape::of(&mut times, self.deviation)
        };
        let (with, without) = (moved(shift), moved(0.0));
        Shape {
            location: 0.0,
            tail: with.tail - without.tail,
            excess: with.excess - without.excess,
            spread: (with.spread / without.spread).ln(),
        }
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
            assert!(scale.shifted(y).tail.abs() < 1e-9 && scale.shifted(y).spread.abs() < 1e-9);
        }
        for law in [Distribution::Constant(5.0), Distribution::DiscreteUniform { low: 1.0, step: 1.0, count: 6 }] {
            assert_eq!(NormalScale::of(&law), None);
        }
    }

    #[test]
    fn there_and_back_is_the_same_within_the_distribution_and_beyond() {
        let scale = exponential();
        for y in [-9.0, -6.0, -2.0, -0.01, 0.0, 0.5, 1.5, 2.4, 4.0] {
            assert!((scale.logarithm(scale.normal(y)) - y).abs() < 1e-9, "{y}");
        }
        assert_eq!(scale.normal(0.0), 0.0);
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
        assert!(bare / count < -0.1, "{}", bare / count);
    }
}
