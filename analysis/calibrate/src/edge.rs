//! What was measured of one edge, and the density of it with the edge's own level integrated out.

use crate::curve::Curve;
use crate::normal::{HALF_LN_TAU, ln_below, ln_between, ln_density, ln_sum};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// A stretch of cutting at one condition, with what was read at its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// Index of the condition.
    pub condition: usize,
    /// Cutting time of the stretch, min.
    pub time: f64,
    /// Flank wear read at its end, mm; none where it was not read.
    pub wear: Option<f64>,
    /// Where `wear` stands for several readings, what else they say.
    pub block: Option<Block>,
}

impl Stretch {
    /// A stretch with a reading at its end.
    pub fn read(condition: usize, time: f64, wear: f64) -> Self {
        Self { condition, time, wear: Some(wear), block: None }
    }

    /// A stretch at whose end nothing was read.
    pub fn unread(condition: usize, time: f64) -> Self {
        Self { condition, time, wear: None, block: None }
    }
}

/// Neighbouring readings that their mean stands for, at the mean of their times. Over so short a time wear rises evenly, so
/// that the sums below hold all that the readings say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block {
    /// Number of readings.
    pub count: f64,
    /// Sum of the squares of their deviations from the mean, mm².
    pub squares: f64,
    /// Sum of the products of the deviations of wear and time, mm·min.
    pub mixed: f64,
    /// Sum of the squares of the deviations of time, min².
    pub times: f64,
}

/// A single reading as a block.
const SINGLE: Block = Block { count: 1.0, squares: 0.0, mixed: 0.0, times: 0.0 };

/// A life of an edge in min, at one condition.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Life {
    /// The edge was worn out then.
    Exact(f64),
    /// The edge was still good then.
    Censored(f64),
    /// Good at the first, worn out at the second time.
    Between(f64, f64),
}

/// An edge with its data.
#[derive(Clone, Debug, PartialEq)]
pub struct Edge {
    /// Its name in the records.
    pub name: String,
    /// Cutting in order, with readings.
    pub stretches: Vec<Stretch>,
    /// A life without readings, with the index of its condition.
    pub life: Option<(usize, Life)>,
    /// Flank wear in mm that was read when the record began, where the edge was not new then; none for a new edge. Nothing is
    /// supposed of the time before.
    pub begun: Option<f64>,
}

impl Edge {
    /// Number of readings of flank wear.
    pub fn readings(&self) -> usize {
        self.stretches.iter().filter(|stretch| stretch.wear.is_some()).count()
    }
}

/// Noise of the wear rate within a life: an Ornstein–Uhlenbeck process.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InLife {
    /// Standard deviation of the logarithm of the rate.
    pub deviation: f64,
    /// Correlation time, min of cutting.
    pub correlation: f64,
}

impl InLife {
    /// Covariance in min² of the two integrals of the noise from 0 to `s` and to `t`, both in min.
    ///
    /// # Examples
    /// ```
    /// let noise = toolroom_calibrate::InLife { deviation: 0.1, correlation: 5.0 };
    /// assert!((noise.covariance(8.0, 20.0) - 0.582_373_5).abs() < 1e-7);
    /// ```
    pub fn covariance(&self, s: f64, t: f64) -> f64 {
        let l = self.correlation;
        let fades = (-s / l).exp() + (-t / l).exp() - 1.0 - (-(t - s).abs() / l).exp();
        self.deviation * self.deviation * l * (2.0 * s.min(t) + l * fades)
    }
}

/// What every edge of a set shares.
#[derive(Clone, Copy, Debug)]
pub struct Common<'a> {
    /// Curves of the conditions.
    pub curves: &'a [Curve],
    /// Standard deviation of the logarithm of an edge's wear rate, τ.
    pub scatter: f64,
    /// Standard deviation of a reading, mm.
    pub noise: f64,
    /// Noise within a life.
    pub in_life: Option<InLife>,
    /// Flank wear at which an edge is worn out, mm.
    pub limit: f64,
}

/// Nodes and weights of 9-point Gauss–Hermite quadrature for the weight exp(-x²), positive half (Abramowitz and Stegun,
/// table 25.10).
const HERMITE: [(f64, f64); 5] = [
    (0.0, 7.202_352_156_060_51e-1),
    (0.723_551_018_752_837_6, 4.326_515_590_025_558e-1),
    (1.468_553_289_216_668, 8.847_452_739_437_657e-2),
    (2.266_580_584_531_843, 4.943_624_275_536_947e-3),
    (3.190_993_201_781_527_6, 3.960_697_726_326_438e-5),
];
/// Nodes in standard deviations and weights of the 5-point rule for a normal distribution (Abramowitz and Stegun, table 25.10).
const FEW_NODES: [(f64, f64); 5] = [
    (-2.856_970_013_872_806, 1.125_741_132_772_069e-2),
    (-1.355_626_179_974_266, 2.220_759_220_056_126e-1),
    (0.0, 5.333_333_333_333_333e-1),
    (1.355_626_179_974_266, 2.220_759_220_056_126e-1),
    (2.856_970_013_872_806, 1.125_741_132_772_069e-2),
];
/// Least flank wear of an edge that was not new, mm.
const LEAST_BEGIN: f64 = 1e-4;
/// The level of an edge is looked for from nine starts over three deviations either side: from its mean alone the search
/// fails for edges that are far off.
const STARTS: usize = 9;
/// Starts for edges with very many readings: the density then falls evenly to both sides, and the search finds its way.
const FEW_STARTS: usize = 3;
/// Farthest start, in standard deviations of the level.
const FARTHEST: f64 = 3.0;
/// Readings by which the starts are compared (assumption): which of them is nearest shows already in a few readings spread
/// over the life, and an edge of a recorded shop has hundreds.
const COMPARED: usize = 16;

/// Readings of an edge as a model sees them at one level.
#[derive(Default)]
pub(crate) struct Predicted {
    /// Wear at the readings, mm.
    pub wear: Vec<f64>,
    /// Its derivative by the logarithm of the level, mm.
    pub slope: Vec<f64>,
    /// `level · rate` at the readings, mm/min.
    pace: Vec<f64>,
}

impl Common<'_> {
    /// What would be read of an edge that begins at a flank wear of `begin` mm and wears by `level` faster, at the last of every
    /// `stride` readings.
    pub(crate) fn predict(&self, edge: &Edge, begin: f64, level: f64, stride: usize, into: &mut Predicted) {
        into.wear.clear();
        into.slope.clear();
        into.pace.clear();
        let (mut wear, mut slope) = (begin, 0.0);
        // Condition and place on its curve.
        let (mut at, mut cell) = (usize::MAX, 0);
        // Time on the present curve, and its derivative by the logarithm of the level.
        let (mut time, mut stretch_of_time) = (0.0, 0.0);
        let mut reading = 0;
        for (index, stretch) in edge.stretches.iter().enumerate() {
            let curve = &self.curves[stretch.condition];
            if stretch.condition != at {
                let before = self.curves.get(at);
                (at, cell) = (stretch.condition, 0);
                if let Some(slower) = before.and_then(|before| curve.slower_than(before)) {
                    // The curves are one but for their pace.
                    time *= slower;
                    stretch_of_time *= slower;
                } else if wear > 0.0 {
                    time = curve.time(wear);
                    stretch_of_time = slope / curve.wear(time, &mut cell).1;
                }
            }
            time += level * stretch.time;
            stretch_of_time += level * stretch.time;
            reading += usize::from(stretch.wear.is_some());
            let read = stretch.wear.is_some() && reading % stride == 0;
            let next = edge.stretches.get(index + 1).filter(|next| next.condition != at);
            if read || next.is_some_and(|next| self.curves[next.condition].slower_than(curve).is_none()) {
                let rate;
                (wear, rate) = match stretch.block {
                    // The mean of a curve is not the curve at the mean, but nearly that at one deviation of time either side.
                    Some(block) if read => {
                        let apart = level * (block.times / block.count).sqrt();
                        let (before, after) =
                            (curve.wear(time - apart, &mut cell), curve.wear(time + apart, &mut cell));
                        (0.5 * (before.0 + after.0), 0.5 * (before.1 + after.1))
                    }
                    Some(_) | None => curve.wear(time, &mut cell),
                };
                slope = rate * stretch_of_time;
                if read {
                    into.wear.push(wear);
                    into.slope.push(slope);
                    into.pace.push(level * rate);
                }
            }
        }
    }

    /// Log density of all data of an edge, its level integrated out.
    pub fn ln_density(&self, edge: &Edge) -> f64 {
        let life = edge.life.map_or(0.0, |(condition, life)| {
            let mean = self.curves[condition].time(self.limit).ln();
            let z = |time: f64| (time.ln() - mean) / self.scatter;
            match life {
                Life::Exact(time) => ln_density(time.ln(), mean, self.scatter),
                Life::Censored(time) => ln_below(-z(time)),
                Life::Between(from, to) => ln_between(z(from), z(to)),
            }
        });
        if edge.readings() == 0 { life } else { life + self.ln_readings(edge) }
    }

    fn ln_readings(&self, edge: &Edge) -> f64 {
        let read = readings(edge);
        let times = self.in_life.map(|_| reading_times(edge));
        let mut predicted = Predicted::default();
        let mut from = |begin: f64| {
            let mut at =
                |z: f64, stride: usize| self.ln_joint(edge, begin, &read, times.as_deref(), z, stride, &mut predicted);
            if read.iter().any(|(_, block)| block.count > 1.0) {
                ln_integral_of_many(&mut at, read.len())
            } else {
                ln_integral(&mut at, read.len())
            }
        };
        let Some(begun) = edge.begun else { return from(0.0) };
        // The reading at the beginning has the error of any other; every wear before is as good as another.
        let terms = FEW_NODES.map(|(node, weight)| from(self.begin(begun, node)) + weight.ln());
        ln_sum(&terms)
    }

    /// Flank wear of an edge whose reading at the beginning is off by `error` deviations.
    fn begin(&self, begun: f64, error: f64) -> f64 {
        (begun - error * self.noise).max(LEAST_BEGIN)
    }

    /// The level at which the readings of an edge are most probable together with the level itself.
    pub(crate) fn level(&self, edge: &Edge) -> f64 {
        let read = readings(edge);
        let times = self.in_life.map(|_| reading_times(edge));
        let mut predicted = Predicted::default();
        let begin = edge.begun.map_or(0.0, |begun| self.begin(begun, 0.0));
        let mut at =
            |z: f64, stride: usize| self.ln_joint(edge, begin, &read, times.as_deref(), z, stride, &mut predicted);
        let (z, _) = mode(&mut at, read.len(), STARTS);
        (self.scatter * z).exp()
    }

    /// Readings of another edge that is cut and read as this one; of a block their mean.
    pub fn replicate(&self, edge: &Edge, random: &mut ChaCha8Rng) -> Vec<f64> {
        if edge.readings() == 0 {
            return Vec::new();
        }
        let mut normal = || -> f64 { StandardNormal.sample(&mut *random) };
        let mut predicted = Predicted::default();
        let begin = edge.begun.map_or(0.0, |begun| self.begin(begun, normal()));
        self.predict(edge, begin, (self.scatter * normal()).exp(), 1, &mut predicted);
        let blocks = edge.stretches.iter().filter(|stretch| stretch.wear.is_some());
        let counts = blocks.map(|stretch| stretch.block.unwrap_or(SINGLE).count);
        let mut readings: Vec<f64> = predicted
            .wear
            .iter()
            .zip(counts)
            .map(|(wear, count)| wear + self.noise / count.sqrt() * normal())
            .collect();
        if let Some(noise) = &self.in_life {
            let times = reading_times(edge);
            let count = times.len();
            let rate = DMatrix::from_fn(count, count, |i, j| {
                let diagonal = if i == j { 1e-12 } else { 0.0 };
                noise.covariance(times[i], times[j]) + diagonal
            });
            if let Some(factor) = Cholesky::new(rate) {
                let off = factor.l() * DVector::from_fn(count, |_, _| normal());
                readings
                    .iter_mut()
                    .zip(&predicted.pace)
                    .zip(off.iter())
                    .for_each(|((reading, pace), off)| *reading += pace * off);
            }
        }
        readings
    }

    /// Log density of every `stride`-th reading and the standardised level `z`, its derivative by `z` and the Gauss–Newton
    /// curvature. Readings that noise within the life joins are never thinned.
    #[allow(clippy::too_many_arguments)] // the state of one edge
    fn ln_joint(
        &self,
        edge: &Edge,
        begin: f64,
        read: &[(f64, Block)],
        times: Option<&[f64]>,
        z: f64,
        stride: usize,
        predicted: &mut Predicted,
    ) -> Joint {
        let stride = if times.is_some() { 1 } else { stride };
        self.predict(edge, begin, (self.scatter * z).exp(), stride, predicted);
        let prior = -0.5 * z * z - HALF_LN_TAU;
        if let (Some(noise), Some(times)) = (&self.in_life, times) {
            let covariance = self.covariance(noise, read, times, &predicted.pace);
            let Some(factor) = Cholesky::new(covariance) else { return (f64::NEG_INFINITY, 0.0, 1.0) };
            let off =
                DVector::from_iterator(read.len(), read.iter().zip(&predicted.wear).map(|(read, wear)| read.0 - wear));
            let slope = DVector::from_iterator(read.len(), predicted.slope.iter().map(|slope| slope * self.scatter));
            let solved = factor.solve(&slope);
            let density = prior + ln_normal(&factor, &off) + self.within(read, &predicted.pace);
            return (density, solved.dot(&off) - z, 1.0 + solved.dot(&slope));
        }
        let weight = 1.0 / (self.noise * self.noise);
        let (mut squares, mut gradient, mut curvature, mut count) = (0.0, 0.0, 0.0, 0.0);
        let compared = read.iter().skip(stride - 1).step_by(stride);
        for (place, (read, block)) in compared.enumerate() {
            let (off, slope) = (read - predicted.wear[place], predicted.slope[place] * self.scatter);
            let pace = predicted.pace[place];
            squares += block.count * off * off + block.squares + pace * (pace * block.times - 2.0 * block.mixed);
            // Within a block the level acts on the pace, to first order in proportion.
            let turn = pace * self.scatter;
            gradient += block.count * off * slope + turn * (block.mixed - pace * block.times);
            curvature += block.count * slope * slope + turn * turn * block.times;
            count += block.count;
        }
        let density = prior - 0.5 * weight * squares - count * (self.noise.ln() + HALF_LN_TAU);
        (density, weight * gradient - z, 1.0 + weight * curvature)
    }

    /// What the readings of blocks say beyond their means.
    fn within(&self, read: &[(f64, Block)], pace: &[f64]) -> f64 {
        let one = |((_, block), pace): (&(f64, Block), &f64)| {
            if block.count <= 1.0 {
                return 0.0;
            }
            let squares = block.squares + pace * (pace * block.times - 2.0 * block.mixed);
            let others = (block.count - 1.0) * (self.noise.ln() + HALF_LN_TAU);
            -0.5 * squares / (self.noise * self.noise) - others - 0.5 * block.count.ln()
        };
        read.iter().zip(pace).map(one).sum()
    }

    fn covariance(&self, noise: &InLife, read: &[(f64, Block)], times: &[f64], pace: &[f64]) -> DMatrix<f64> {
        DMatrix::from_fn(times.len(), times.len(), |i, j| {
            let reading = if i == j { self.noise * self.noise / read[i].1.count } else { 0.0 };
            reading + pace[i] * pace[j] * noise.covariance(times[i], times[j])
        })
    }
}

/// Log density, its derivative and its Gauss–Newton curvature at a standardised level.
pub(crate) type Joint = (f64, f64, f64);

/// Logarithm of the integral of a density over the standardised level, by adaptive Gauss–Hermite quadrature. `at` takes the
/// level and which of the `readings` are looked at: one is all of them, `n` every nth.
pub(crate) fn ln_integral(at: &mut dyn FnMut(f64, usize) -> Joint, readings: usize) -> f64 {
    let (z, (density, _, curvature)) = mode(at, readings, STARTS);
    let width = std::f64::consts::SQRT_2 / curvature.sqrt();
    let mut terms = [0.0; 9];
    for (index, (node, weight)) in HERMITE.iter().enumerate() {
        let term = |density: f64| density + node * node + weight.ln();
        terms[index] = term(if index == 0 { density } else { at(z + width * node, 1).0 });
        if index > 0 {
            terms[4 + index] = term(at(z - width * node, 1).0);
        }
    }
    width.ln() + ln_sum(&terms)
}

/// The same of an edge with so many readings that its level is all but known: three nodes do, and fewer starts.
fn ln_integral_of_many(at: &mut dyn FnMut(f64, usize) -> Joint, readings: usize) -> f64 {
    let (z, (density, _, curvature)) = mode(at, readings, FEW_STARTS);
    let width = std::f64::consts::SQRT_2 / curvature.sqrt();
    // Abramowitz and Stegun, table 25.10.
    let (node, middle, side): (f64, f64, f64) = (1.224_744_871_391_589, 1.181_635_900_603_677, 0.295_408_975_150_919_4);
    let mut far = |z: f64| at(z, 1).0 + node * node + side.ln();
    width.ln() + ln_sum(&[density + middle.ln(), far(z - width * node), far(z + width * node)])
}

/// The most probable standardised level of an edge, and the density there.
fn mode(at: &mut dyn FnMut(f64, usize) -> Joint, readings: usize, starts: usize) -> (f64, Joint) {
    let last = (starts - 1) as f64;
    let reach = if starts == STARTS { FARTHEST } else { 0.5 * FARTHEST };
    let starts = (0..starts).map(|start| reach * (2.0 * start as f64 / last - 1.0));
    let stride = readings.div_ceil(COMPARED).max(1);
    let mut best = (0.0, (f64::NEG_INFINITY, 0.0, 1.0));
    for z in starts {
        let there = at(z, stride);
        if there.0 > best.1.0 {
            best = (z, there);
        }
    }
    if stride > 1 {
        best.1 = at(best.0, 1);
    }
    let (mut z, mut here) = best;
    for _ in 0..20 {
        let mut step = here.1 / here.2;
        let mut moved = false;
        for _ in 0..12 {
            let next = at(z + step, 1);
            if next.0.is_finite() && next.0 >= here.0 {
                z += step;
                here = next;
                moved = true;
                break;
            }
            step *= 0.5;
        }
        if !moved || step.abs() * here.2.sqrt() < 1e-4 {
            break;
        }
    }
    (z, here)
}

fn ln_normal(factor: &Cholesky<f64, Dyn>, off: &DVector<f64>) -> f64 {
    let white = factor.l().solve_lower_triangular(off).map_or(f64::INFINITY, |white| white.norm_squared());
    -0.5 * white - factor.l().diagonal().map(f64::ln).sum() - off.len() as f64 * HALF_LN_TAU
}

/// Readings of an edge with the blocks that they stand for.
fn readings(edge: &Edge) -> Vec<(f64, Block)> {
    let read = |stretch: &Stretch| Some((stretch.wear?, stretch.block.unwrap_or(SINGLE)));
    edge.stretches.iter().filter_map(read).collect()
}

/// Cutting time of the edge at each reading, min.
pub(crate) fn reading_times(edge: &Edge) -> Vec<f64> {
    let mut time = 0.0;
    let passed = edge.stretches.iter().map(|stretch| {
        time += stretch.time;
        (time, stretch.wear.is_some())
    });
    passed.filter(|(_, read)| *read).map(|(time, _)| time).collect()
}
