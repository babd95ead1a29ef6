//! What a factor on all times of a distribution does to their shape, where they are taken on their normal scale.

use super::stops::Shape;
use statrs::distribution::{ContinuousCDF, Normal};
use toolroom_facts::normal_scale::NormalScale;
use toolroom_scenario::Distribution;

/// Factors on all times of which the shape is known, as logarithms: from this far below to this far above (assumption).
const REACH: f64 = 1.0;
/// Steps of that, between which a shape is taken as straight (count; assumption).
const SHIFTS: usize = 20;
/// Times of the distribution behind a shape (count; assumption).
const TIMES: usize = 1000;

/// A normal scale with the shapes that times have on it when all of them take longer.
#[derive(Clone, Debug, PartialEq)]
pub struct Scaled {
    /// The scale.
    pub scale: NormalScale,
    /// By the logarithm of the factor, at equal distances.
    shapes: Vec<Shape>,
}

impl Scaled {
    /// Of a distribution; `None` where that has no scale.
    pub fn of(law: &Distribution) -> Option<Self> {
        let scale = NormalScale::of(law)?;
        let normal = Normal::standard();
        let score = |i: usize| normal.inverse_cdf((i as f64 + 0.5) / TIMES as f64) * scale.deviation();
        let scores: Vec<f64> = (0..TIMES).map(score).collect();
        let longer = |shift: f64| {
            let mut times: Vec<f64> = scores.iter().map(|y| scale.normal(scale.logarithm(*y) + shift)).collect();
            Shape::of(&mut times, scale.deviation())
        };
        let as_they_are = longer(0.0);
        let beside = |shift: f64| {
            let with = longer(shift);
            Shape {
                location: 0.0,
                tail: with.tail - as_they_are.tail,
                excess: with.excess - as_they_are.excess,
                spread: (with.spread / as_they_are.spread).ln(),
            }
        };
        let shapes = (0..=SHIFTS).map(|step| beside(REACH * (2.0 * step as f64 / SHIFTS as f64 - 1.0))).collect();
        Some(Self { scale, shapes })
    }

    /// What a factor of this logarithm on all times does to their shape; their middle is left out.
    pub fn shifted(&self, logarithm: f64) -> Shape {
        let place = (logarithm.clamp(-REACH, REACH) / REACH + 1.0) * 0.5 * SHIFTS as f64;
        let below = (place as usize).min(SHIFTS - 1);
        let share = place - below as f64;
        let [from, to] = [self.shapes[below], self.shapes[below + 1]];
        let between = |of: &dyn Fn(&Shape) -> f64| of(&from) + share * (of(&to) - of(&from));
        Shape {
            location: 0.0,
            tail: between(&|shape| shape.tail),
            excess: between(&|shape| shape.excess),
            spread: between(&|shape| shape.spread),
        }
    }
}
