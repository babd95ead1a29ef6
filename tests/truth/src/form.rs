//! Equations that are off by a smooth function of the cut and of the land: ridges that no polynomial is.

use crate::Case;
use crate::noise::Chance;
use crate::steel::Cut;

/// Factors on forces, temperature and the rate of wear.
pub(crate) struct FormError {
    main: Ridge,
    along: Ridge,
    temperature: Ridge,
    wear_rate: Ridge,
}

/// Share by which the rate of wear is off over that by which forces are: wear laws are known less well.
const OF_WEAR: f64 = 3.0;
/// Stream of random numbers that no generator uses.
const STREAM: u64 = 90;
/// Spreads of the logarithms of speed, feed and depth over the part types, and of the land, mm.
const SPREAD: [f64; 4] = [0.11, 0.23, 0.24, 0.12];
/// Middle of speed (m/min), feed (mm), depth (mm) and land (mm).
const MIDDLE: [f64; 4] = [195.0, 0.28, 1.4, 0.18];

impl FormError {
    /// The form error of a shop: what a shop is does not change with its edges.
    pub fn new(case: &Case) -> Self {
        let mut chance = Chance::new(case.seed, STREAM);
        let mut ridge = |scale: f64| Ridge::new(scale * case.form, &mut chance);
        Self { main: ridge(1.0), along: ridge(1.0), temperature: ridge(1.0), wear_rate: ridge(OF_WEAR) }
    }

    /// Main and feed force.
    pub fn forces(&self, cut: Cut, wear: f64, [main, along]: [f64; 2]) -> [f64; 2] {
        let place = place(cut, wear);
        [main * self.main.factor(&place), along * self.along.factor(&place)]
    }

    /// Factor on the rise of temperature.
    pub fn temperature(&self, cut: Cut, wear: f64) -> f64 {
        self.temperature.factor(&place(cut, wear))
    }

    /// Factor on the rate of wear.
    pub fn wear_rate(&self, cut: Cut, wear: f64) -> f64 {
        self.wear_rate.factor(&place(cut, wear))
    }
}

/// A cut and a land in units of their spreads.
fn place(cut: Cut, wear: f64) -> [f64; 4] {
    let logarithms = [cut.speed, cut.feed, cut.depth].map(f64::ln);
    let condition = |i: usize| (logarithms[i] - MIDDLE[i].ln()) / SPREAD[i];
    [condition(0), condition(1), condition(2), (wear - MIDDLE[3]) / SPREAD[3]]
}

/// The hyperbolic tangent of a random direction, of unit root mean square before it is scaled.
struct Ridge {
    scale: f64,
    direction: [f64; 4],
    offset: f64,
}

/// Root mean square of the hyperbolic tangent of a standard normal number that was stretched by 1.6 and moved by
/// half a standard deviation (numerically).
const OF_TANH: f64 = 0.72;

impl Ridge {
    fn new(scale: f64, chance: &mut Chance) -> Self {
        let drawn: [f64; 4] = std::array::from_fn(|_| chance.normal());
        let length = drawn.iter().map(|x| x * x).sum::<f64>().sqrt();
        Self { scale: scale / OF_TANH, direction: drawn.map(|x| 1.6 * x / length), offset: 0.5 * chance.normal() }
    }

    fn factor(&self, place: &[f64; 4]) -> f64 {
        let along: f64 = self.direction.iter().zip(place).map(|(a, x)| a * x).sum();
        1.0 + self.scale * (along + self.offset).tanh()
    }
}
