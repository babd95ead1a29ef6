//! What short stops do to the times of a program, by replication with common random numbers.

use super::super::noise::median;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use statrs::function::erf::erf_inv;
use toolroom_sim::scenario::MICRO_STOP;

/// Operations that are replicated.
const REPLICATIONS: usize = 1500;
/// Stops of one operation that are followed.
const MOST: usize = 12;
/// Normal score beyond which an operation counts as an outlier.
pub const FAR: f64 = 1.64;
/// Scores count up to this far.
pub const FARTHEST: f64 = 4.0;

/// What a block of operations of one program looks like.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shape {
    /// Logarithm of the median over the time without stops.
    pub location: f64,
    /// Share of outliers that are too long, less that of those too short.
    pub tail: f64,
    /// Logarithm of mean over median.
    pub excess: f64,
    /// Standard deviation of bounded scores.
    pub spread: f64,
}

impl Shape {
    /// Of operations with times `logarithms` (of time over anything), whose scatter is `deviation`.
    pub fn of(logarithms: &mut [f64], deviation: f64) -> Self {
        let count = logarithms.len() as f64;
        let middle = median(logarithms);
        let scores: Vec<f64> = logarithms.iter().map(|y| (y - middle) / deviation).collect();
        let share = |far: &dyn Fn(f64) -> bool| scores.iter().filter(|z| far(**z)).count() as f64 / count;
        let bounded: Vec<f64> = scores.iter().map(|z| z.clamp(-FARTHEST, FARTHEST)).collect();
        let mean = bounded.iter().sum::<f64>() / count;
        let variance = bounded.iter().map(|z| (z - mean).powi(2)).sum::<f64>() / (count - 1.0).max(1.0);
        Self {
            location: middle,
            tail: share(&|z| z > FAR) - share(&|z| z < -FAR),
            excess: (logarithms.iter().map(|y| (y - middle).exp()).sum::<f64>() / count).ln(),
            spread: variance.sqrt(),
        }
    }
}

/// Scatter of times by the half below their middle, which stops leave alone; `below` are distances
/// to the middle.
pub fn lower_deviation(below: &mut [f64]) -> f64 {
    1.4826 * median(below)
}

/// Random numbers of the replications.
#[derive(Clone, Debug)]
pub struct Stops {
    /// Normal scores of the scatter without stops.
    scores: Vec<f64>,
    /// Exponential times to the next stop, in mean times between stops, one after the other.
    arrivals: Vec<[f64; MOST]>,
    /// Exponential durations, in means.
    durations: Vec<[f64; MOST]>,
}

impl Default for Stops {
    fn default() -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(0);
        let count = REPLICATIONS as f64;
        let mut scores: Vec<f64> = (0..REPLICATIONS)
            .map(|i| std::f64::consts::SQRT_2 * erf_inv(2.0 * (i as f64 + 0.5) / count - 1.0))
            .collect();
        // Scatter and stops have nothing to do with each other.
        for i in (1..scores.len()).rev() {
            scores.swap(i, random.random_range(0..=i));
        }
        let exponential = |random: &mut ChaCha8Rng| -> f64 { -(-random.random::<f64>()).ln_1p() };
        let mut table =
            || (0..REPLICATIONS).map(|_| std::array::from_fn(|_| exponential(&mut random))).collect::<Vec<_>>();
        Self { scores, arrivals: table(), durations: table() }
    }
}

impl Stops {
    /// The shape under `rate` stops per running time, 1/s, of a program of `time` s whose measured
    /// scatter is `deviation` of the logarithm; less the shape without stops.
    pub fn shape(&self, rate: f64, time: f64, deviation: f64) -> Shape {
        let replicated = |scatter: f64, rate: f64| -> Vec<f64> {
            let each = |i: usize| {
                let (mut at, mut stopped) = (0.0, 0.0);
                for (arrival, duration) in self.arrivals[i].iter().zip(&self.durations[i]) {
                    at += arrival;
                    if at > rate * time {
                        break;
                    }
                    stopped += MICRO_STOP * duration;
                }
                ((scatter * self.scores[i]).exp() + stopped / time).ln()
            };
            (0..REPLICATIONS).map(each).collect()
        };
        // The measured scatter has the stops in it already.
        let measured = |logarithms: &[f64]| {
            let middle = median(&mut logarithms.to_vec());
            lower_deviation(&mut logarithms.iter().map(|y| middle - y).filter(|d| *d > 0.0).collect::<Vec<f64>>())
        };
        let mut scatter = deviation;
        for _ in 0..2 {
            scatter *= deviation / measured(&replicated(scatter, rate));
        }
        let with = Shape::of(&mut replicated(scatter, rate), deviation);
        let without = Shape::of(&mut replicated(deviation, 0.0), deviation);
        Shape {
            location: with.location - without.location,
            tail: with.tail - without.tail,
            excess: with.excess - without.excess,
            spread: (with.spread / without.spread).ln(),
        }
    }
}
