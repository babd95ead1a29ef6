//! What short stops do to the times of a program, by replication with common random numbers.

use crate::constants::{HUBER, MAD};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use statrs::function::erf::erf_inv;
use toolroom_facts::normal_scale::NormalScale;
use toolroom_scenario::MICRO_STOP;
use toolroom_statistics::median;

/// Operations that are replicated.
const REPLICATIONS: usize = 2400;
/// Step of the additive recurrence that covers the unit interval most evenly, (√5 − 1)/2.
const GOLDEN: f64 = 0.618_033_988_749_894_9;
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
    /// Of normally distributed logarithms with a small scatter.
    pub const SYMMETRIC: Self = Self { location: 0.0, tail: 0.0, excess: 0.0, spread: 1.0 };

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
    MAD * median(below)
}

/// Number of [`OPERATIONS`].
pub const SIZES: usize = 11;
/// Sizes of blocks that are told apart.
const OPERATIONS: [usize; SIZES] = [2, 4, 6, 8, 11, 15, 20, 27, 36, 60, 120];

/// Class of a block of `count` operations.
pub fn class(count: usize) -> usize {
    OPERATIONS.iter().position(|size| count <= *size).unwrap_or(SIZES - 1)
}

/// A program as its operations were timed.
#[derive(Clone, Copy, Debug)]
pub struct Timed<'a> {
    /// Programmed time, s.
    pub time: f64,
    /// Measured scatter of the logarithm.
    pub deviation: f64,
    /// Whether times have no scatter of their own.
    pub exact: bool,
    /// The pools about whose middles that scatter was measured.
    pub pools: &'a [Pool],
    /// Where its times are normal, if that is elsewhere.
    pub scale: Option<&'a NormalScale>,
}

/// Operations of one program about whose middle scatter was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pool {
    /// How many.
    pub size: usize,
    /// Stops that come to them, 1/s of running time.
    pub rate: f64,
}

/// Scatter of the logarithm of single operations that gives the measured one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Intrinsic {
    /// Without any stops.
    pub planned: f64,
    /// Beside the stops of the pools.
    pub stopped: f64,
}

/// Random numbers of the replications: each column is a Latin hypercube, so that the share of
/// operations with a stop is right and not only near it. The sooner the first stop of a replication comes,
/// the earlier it stands in an additive recurrence of the golden ratio, which gives its duration: the few
/// replications that are stopped at all last as long in the mean as they should, at any rate.
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
        let mut table = || (0..MOST).map(|_| column(&exponential)).collect::<Vec<_>>();
        let (arrivals, mut durations) = (table(), table());
        let mut soonest: Vec<usize> = (0..REPLICATIONS).collect();
        soonest.sort_by(|a, b| arrivals[0][*a].total_cmp(&arrivals[0][*b]));
        for (place, replication) in soonest.into_iter().enumerate() {
            durations[0][replication] = exponential((0.5 + place as f64 * GOLDEN).fract());
        }
        Self { scores, arrivals, durations }
    }
}

impl Stops {
    /// Logarithms of the times of operations of a program under `rate` stops per running time, 1/s, over its time, where
    /// they are normal without stops.
    fn replicated(&self, rate: f64, program: Timed<'_>, scatter: f64) -> Vec<f64> {
        let Timed { time, scale, .. } = program;
        let drawn = |i: usize| {
            let (mut programmed, mut stopped) = (0.0, 0.0);
            for (arrivals, durations) in self.arrivals.iter().zip(&self.durations) {
                programmed += arrivals[i];
                if programmed > rate * time {
                    break;
                }
                stopped += MICRO_STOP * durations[i];
            }
            let normal = scatter * self.scores[i];
            match scale {
                // What is not stopped stays to the bit where it is.
                Some(_) if stopped == 0.0 => normal,
                Some(scale) => scale.normal((scale.logarithm(normal).exp() + stopped / time).ln()),
                None => (normal.exp() + stopped / time).ln(),
            }
        };
        (0..REPLICATIONS).map(drawn).collect()
    }

    /// The scatter of single operations that stands behind the measured one, which has the stops in it already. Stops
    /// of some of the pools widen only these: taken for stops of all of them they would leave too little scatter, which
    /// makes the middles of stopped operations move too little.
    pub fn intrinsic(&self, program: Timed<'_>) -> Intrinsic {
        let Timed { deviation, exact, pools, .. } = program;
        if exact {
            return Intrinsic { planned: 0.0, stopped: 0.0 };
        }
        let unstopped: Vec<Pool> = pools.iter().map(|pool| Pool { rate: 0.0, ..*pool }).collect();
        // Of blocks whose own middles are taken the scatter comes out low.
        let planned = deviation / self.pooled(Timed { scale: None, ..program }, 1.0, &unstopped);
        let mut stopped = planned;
        for _ in 0..2 {
            stopped *= deviation / self.pooled(program, stopped, pools);
        }
        Intrinsic { planned, stopped }
    }

    /// What stops add to the shape of blocks of every class of `classes`: means over replicated
    /// blocks of that size, since the middle of a small block lies elsewhere than that of all. Blocks without stops
    /// change too where others of their program have them: these have a share in the measured scatter.
    pub fn shapes(&self, rate: f64, program: Timed<'_>, scatter: Intrinsic, classes: &[bool]) -> Vec<Shape> {
        let deviation = program.deviation;
        let with = self.replicated(rate, program, scatter.stopped);
        let without = self.replicated(0.0, program, scatter.planned);
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

    /// Shapes of blocks of every class of `classes` without any stops.
    pub fn unstopped(&self, program: Timed<'_>, classes: &[bool]) -> Vec<Shape> {
        let times = self.replicated(0.0, program, self.intrinsic(program).planned);
        let of = |(size, wanted): (&usize, &bool)| {
            if *wanted { mean_shape(&times, *size, program.deviation) } else { Shape::SYMMETRIC }
        };
        OPERATIONS.iter().zip(classes).map(of).collect()
    }

    /// Scatter that is measured in pools of operations that scatter by `scatter` themselves.
    fn pooled(&self, program: Timed<'_>, scatter: f64, pools: &[Pool]) -> f64 {
        let mut rates: Vec<f64> = pools.iter().map(|pool| pool.rate).collect();
        rates.sort_by(f64::total_cmp);
        rates.dedup();
        if rates.is_empty() {
            rates.push(0.0);
        }
        let mut below: Vec<(f64, f64)> = Vec::with_capacity(REPLICATIONS);
        for rate in &rates {
            let sizes: Vec<usize> = pools.iter().filter(|pool| pool.rate == *rate).map(|pool| pool.size).collect();
            let distances = below_middles(&self.replicated(*rate, program, scatter), &sizes);
            // As much of it as there are operations in these pools.
            let weight = sizes.iter().sum::<usize>().max(1) as f64;
            below.extend(distances.into_iter().map(|distance| (distance, weight)));
        }
        MAD * weighted_median(below)
    }
}

/// Distances to the middles of pools of these sizes, one after the other, of what lies below; to that of all where
/// there are none.
fn below_middles(logarithms: &[f64], pools: &[usize]) -> Vec<f64> {
    let mut below: Vec<f64> = Vec::with_capacity(logarithms.len() / 2);
    let mut sizes = pools.iter().copied().filter(|size| *size > 0).cycle();
    let mut left = logarithms;
    while !left.is_empty() {
        let (pool, others) = left.split_at(sizes.next().unwrap_or(left.len()).min(left.len()));
        let middle = median(&mut pool.to_vec());
        below.extend(pool.iter().map(|y| middle - y).filter(|d| *d > 0.0));
        left = others;
    }
    below
}

/// The value below which half of the weight of `(value, weight)` lies; zero of nothing.
fn weighted_median(mut values: Vec<(f64, f64)>) -> f64 {
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = 0.5 * values.iter().map(|(_, weight)| weight).sum::<f64>();
    let mut sum = 0.0;
    for (value, weight) in &values {
        sum += weight;
        if sum >= half {
            return *value;
        }
    }
    0.0
}

fn mean_shape(logarithms: &[f64], size: usize, deviation: f64) -> Shape {
    let blocks = logarithms.chunks_exact(size).map(|block| Shape::of(&mut block.to_vec(), deviation));
    let blocks: Vec<Shape> = blocks.collect();
    let mean = |value: &dyn Fn(&Shape) -> f64| blocks.iter().map(value).sum::<f64>() / blocks.len() as f64;
    Shape {
        location: bounded_mean(blocks.iter().map(|block| block.location).collect()),
        tail: mean(&|block| block.tail),
        excess: mean(&|block| block.excess),
        spread: mean(&|block| block.spread.max(LEAST_SPREAD).ln()).exp(),
    }
}

/// Mean of middles, none of which counts as further from their middle than the fit lets it: that of two
/// operations of which one was stopped is far out, and weighs little.
fn bounded_mean(middles: Vec<f64>) -> f64 {
    let middle = median(&mut middles.clone());
    let distances: Vec<f64> = middles.iter().map(|own| own - middle).collect();
    let far = HUBER * MAD * median(&mut distances.iter().map(|distance| distance.abs()).collect::<Vec<f64>>());
    middle + distances.iter().map(|distance| distance.clamp(-far, far)).sum::<f64>() / distances.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of blocks of all sizes at one rate.
    fn shapes(rate: f64, program: Timed<'_>) -> Vec<Shape> {
        let stops = Stops::default();
        stops.shapes(rate, program, stops.intrinsic(program), &[true; SIZES])
    }

    #[test]
    fn stops_of_some_pools_leave_the_scatter_of_operations_what_it_is() {
        // Operations of 480 s that scatter by 1 %, every second pool with three stops an hour.
        let (stops, rate, scatter) = (Stops::default(), 3.0 / 3600.0, 0.01);
        let pools = [0.0, rate].map(|rate| Pool { size: 20, rate });
        let of = |deviation: f64, pools| Timed { time: 480.0, deviation, exact: false, pools, scale: None };
        let deviation = stops.pooled(of(scatter, &pools), scatter, &pools);
        let found = stops.intrinsic(of(deviation, &pools));
        assert!((found.stopped / scatter - 1.0).abs() < 0.02, "{found:?}");
        // Without any stops a seventh more would have to stand behind the measured scatter.
        assert!((1.1..1.2).contains(&(found.planned / scatter)), "{found:?}");
        // Taken for stops of all pools they would leave about a tenth less.
        let everywhere = stops.intrinsic(of(deviation, &[Pool { size: 20, rate }]));
        assert!(everywhere.stopped < 0.95 * scatter, "{everywhere:?}");
    }

    #[test]
    fn as_many_operations_are_stopped_as_the_rate_says() {
        let rate = 2.0 / 3600.0;
        let program =
            Timed { time: 360.0, deviation: 0.002, exact: true, pools: &[Pool { size: 15, rate }], scale: None };
        let shape = shapes(rate, program)[class(120)];
        // All but stops of less than 1.64 scatters, exp(−1.18 s/20 s), and the mean of all.
        let stopped = (1.0 - (-rate * 360.0).exp()) * (-FAR * 0.002 * 360.0 / 20.0_f64).exp();
        assert!((shape.tail / stopped - 1.0).abs() < 0.03, "{shape:?} {stopped}");
        assert!((shape.excess / (20.0 * rate).ln_1p() - 1.0).abs() < 0.03, "{shape:?}");
    }

    #[test]
    fn a_few_stops_last_as_long_in_the_mean_as_many() {
        // Of 2400 operations of 150 s half a stop an hour stops 50, three stops an hour 280.
        let stops_at = |hourly: f64| {
            let rate = hourly / 3600.0;
            let program =
                Timed { time: 150.0, deviation: 0.005, exact: false, pools: &[Pool { size: 18, rate }], scale: None };
            let shape = shapes(rate, program)[class(20)];
            (shape.excess + shape.location).exp_m1() / (hourly * MICRO_STOP / 3600.0)
        };
        for hourly in [0.5, 1.0, 1.5, 3.0] {
            assert!((stops_at(hourly) - 1.0).abs() < 0.06, "{hourly} 1/h: {}", stops_at(hourly));
        }
    }

    #[test]
    fn the_scatter_of_small_pools_is_low_and_that_of_the_pools_that_were_measured() {
        let program = Timed { time: 100.0, deviation: 1e-3, exact: false, pools: &[], scale: None };
        let normal = Stops::default().replicated(0.0, program, 1e-3);
        let deviation_of = |pools: &[usize]| lower_deviation(&mut below_middles(&normal, pools)) / 1e-3;
        let [small, both, large, whole] =
            [deviation_of(&[4]), deviation_of(&[4, 30]), deviation_of(&[30]), deviation_of(&[])];
        assert!(small < 0.9 && small < both && both < large && large <= whole * 1.01, "{small} {both} {large} {whole}");
        assert!((whole - 1.0).abs() < 0.02, "{whole}");
    }

    #[test]
    fn the_middle_of_a_few_operations_moves_hardly_further_than_that_of_many() {
        // One stopped operation of two moves their middle by ten seconds; the fit takes that for an outlier.
        let rate = 1.5 / 3600.0;
        let program =
            Timed { time: 480.0, deviation: 0.0048, exact: false, pools: &[Pool { size: 9, rate }], scale: None };
        let shapes = shapes(rate, program);
        let [few, many] = [2, 20].map(|count| shapes[class(count)].location);
        assert!(0.0 < many && many < few && few < 3.5 * many, "{few} {many}");
        assert!(shapes[class(4)].location < 2.0 * many, "{shapes:?}");
    }
}
