//! What short stops do to the times of a program, by replication with common random numbers.

use super::super::noise::median;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use statrs::function::erf::erf_inv;
use toolroom_sim::scenario::MICRO_STOP;

/// Operations that are replicated.
const REPLICATIONS: usize = 2400;
/// Stops of one operation that are followed.
const MOST: usize = 12;
/// Normal score beyond which an operation counts as an outlier.
pub const FAR: f64 = 1.64;
/// Scores count up to this far.
const FARTHEST: f64 = 4.0;
/// Least spread of the scores of a block.
const LEAST_SPREAD: f64 = 0.05;

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

/// Number of [`OPERATIONS`].
pub const SIZES: usize = 10;
/// Sizes of blocks that are told apart.
const OPERATIONS: [usize; SIZES] = [4, 6, 8, 11, 15, 20, 27, 36, 60, 120];

/// Class of a block of `count` operations.
pub fn class(count: usize) -> usize {
    OPERATIONS.iter().position(|size| count <= *size).unwrap_or(SIZES - 1)
}

/// A program as its operations were timed.
#[derive(Clone, Copy, Debug)]
pub struct Timed {
    /// Programmed time, s.
    pub time: f64,
    /// Measured scatter of the logarithm.
    pub deviation: f64,
    /// Whether times have no scatter of their own.
    pub exact: bool,
    /// Class of its ordinary block.
    pub class: usize,
}

/// Random numbers of the replications: each column is a Latin hypercube, so that the share of
/// operations with a stop is right and not only near it.
#[derive(Clone, Debug)]
pub struct Stops {
    /// Normal scores of the scatter without stops.
    scores: Vec<f64>,
    /// Exponential times to the next stop, in mean times between stops, one after the other.
    arrivals: Vec<Vec<f64>>,
    /// Exponential durations, in means.
    durations: Vec<Vec<f64>>,
}

impl Default for Stops {
    fn default() -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(0);
        let mut column = |quantile: &dyn Fn(f64) -> f64| -> Vec<f64> {
            let count = REPLICATIONS as f64;
            let mut column: Vec<f64> = (0..REPLICATIONS).map(|i| quantile((i as f64 + 0.5) / count)).collect();
            for i in (1..column.len()).rev() {
                column.swap(i, random.random_range(0..=i));
            }
            column
        };
        let exponential = |u: f64| -(-u).ln_1p();
        let scores = column(&|u| std::f64::consts::SQRT_2 * erf_inv(2.0 * u - 1.0));
        let mut table = || (0..MOST).map(|_| column(&exponential)).collect();
        Self { scores, arrivals: table(), durations: table() }
    }
}

impl Stops {
    /// Logarithms of the times of operations under `rate` stops per running time, 1/s, of a program
    /// of `time` s, over that time.
    fn replicated(&self, rate: f64, time: f64, scatter: f64) -> Vec<f64> {
        let each = |i: usize| {
            let (mut at, mut stopped) = (0.0, 0.0);
            for (arrivals, durations) in self.arrivals.iter().zip(&self.durations) {
                at += arrivals[i];
                if at > rate * time {
                    break;
                }
                stopped += MICRO_STOP * durations[i];
            }
            ((scatter * self.scores[i]).exp() + stopped / time).ln()
        };
        (0..REPLICATIONS).map(each).collect()
    }

    /// What stops add to the shape of blocks of every class of `classes`: means over replicated
    /// blocks of that size, since the middle of a small block lies elsewhere than that of all.
    pub fn shapes(&self, rate: f64, program: Timed, classes: &[bool]) -> Vec<Shape> {
        let Timed { time, deviation, exact, class } = program;
        let pooled = |logarithms: &[f64]| pooled_deviation(logarithms, OPERATIONS[class]);
        // Of blocks whose own middles are taken the scatter comes out low.
        let alone = if exact { 0.0 } else { deviation / pooled(&self.replicated(0.0, time, 1.0)) };
        // The measured scatter has the stops in it already.
        let mut scatter = alone;
        for _ in 0..2 {
            if scatter > 0.0 {
                scatter *= deviation / pooled(&self.replicated(rate, time, scatter));
            }
        }
        let (with, without) = (self.replicated(rate, time, scatter), self.replicated(0.0, time, alone));
        let added = |size: usize| {
            let (with, without) = (mean_shape(&with, size, deviation), mean_shape(&without, size, deviation));
            Shape {
                location: with.location - without.location,
                tail: with.tail - without.tail,
                excess: with.excess - without.excess,
                spread: if without.spread > 0.0 { (with.spread / without.spread).ln() } else { 0.0 },
            }
        };
        let wanted = OPERATIONS.iter().zip(classes);
        wanted.map(|(size, wanted)| if *wanted { added(*size) } else { Shape::default() }).collect()
    }
}

/// Scatter by the half below the middles of blocks.
fn pooled_deviation(logarithms: &[f64], size: usize) -> f64 {
    let mut below: Vec<f64> = Vec::with_capacity(logarithms.len() / 2);
    for block in logarithms.chunks_exact(size) {
        let middle = median(&mut block.to_vec());
        below.extend(block.iter().map(|y| middle - y).filter(|d| *d > 0.0));
    }
    lower_deviation(&mut below)
}

fn mean_shape(logarithms: &[f64], size: usize, deviation: f64) -> Shape {
    let mut sum = Shape::default();
    let blocks = logarithms.len() / size;
    for block in logarithms.chunks_exact(size) {
        let own = Shape::of(&mut block.to_vec(), deviation);
        sum.location += own.location / blocks as f64;
        sum.tail += own.tail / blocks as f64;
        sum.excess += own.excess / blocks as f64;
        sum.spread += own.spread.max(LEAST_SPREAD).ln() / blocks as f64;
    }
    sum.spread = sum.spread.exp();
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn as_many_operations_are_stopped_as_the_rate_says() {
        let program = Timed { time: 360.0, deviation: 0.002, exact: true, class: class(15) };
        let rate = 2.0 / 3600.0;
        let shape = Stops::default().shapes(rate, program, &[true; SIZES])[class(120)];
        // All but stops of less than 1.64 scatters, exp(−1.18 s/20 s), and the mean of all.
        let stopped = (1.0 - (-rate * 360.0).exp()) * (-FAR * 0.002 * 360.0 / 20.0_f64).exp();
        assert!((shape.tail / stopped - 1.0).abs() < 0.03, "{shape:?} {stopped}");
        assert!((shape.excess / (20.0 * rate).ln_1p() - 1.0).abs() < 0.03, "{shape:?}");
    }
}
