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
}

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
/// The level of an edge is looked for from nine starts over three deviations either side: from its mean alone the search
/// fails for edges that are far off.
const STARTS: usize = 9;
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
    /// What would be read of an edge that wears by `level` faster, at the last of every `stride` readings.
    pub(crate) fn predict(&self, edge: &Edge, level: f64, stride: usize, into: &mut Predicted) {
        into.wear.clear();
        into.slope.clear();
        into.pace.clear();
        let (mut wear, mut slope) = (0.0, 0.0);
        // Condition and place on its curve.
        let (mut at, mut cell) = (usize::MAX, 0);
        // Time on the present curve, and its derivative by the logarithm of the level.
        let (mut time, mut stretch_of_time) = (0.0, 0.0);
        let mut reading = 0;
        for (index, stretch) in edge.stretches.iter().enumerate() {
            let curve = &self.curves[stretch.condition];
            if stretch.condition != at {
                (at, cell) = (stretch.condition, 0);
                if wear > 0.0 {
                    time = curve.time(wear);
                    stretch_of_time = slope / curve.wear(time, &mut cell).1;
                }
            }
            time += level * stretch.time;
            stretch_of_time += level * stretch.time;
            reading += usize::from(stretch.wear.is_some());
            let read = stretch.wear.is_some() && reading % stride == 0;
            if read || edge.stretches.get(index + 1).is_some_and(|next| next.condition != at) {
                let rate;
                (wear, rate) = curve.wear(time, &mut cell);
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
        let read: Vec<f64> = edge.stretches.iter().filter_map(|stretch| stretch.wear).collect();
        let times = self.in_life.map(|_| reading_times(edge));
        let mut predicted = Predicted::default();
        let mut at = |z: f64, stride: usize| self.ln_joint(edge, &read, times.as_deref(), z, stride, &mut predicted);
        ln_integral(&mut at, read.len())
    }

    /// The level at which the readings of an edge are most probable together with the level itself.
    pub(crate) fn level(&self, edge: &Edge) -> f64 {
        let read: Vec<f64> = edge.stretches.iter().filter_map(|stretch| stretch.wear).collect();
        let times = self.in_life.map(|_| reading_times(edge));
        let mut predicted = Predicted::default();
        let mut at = |z: f64, stride: usize| self.ln_joint(edge, &read, times.as_deref(), z, stride, &mut predicted);
        let (z, _) = mode(&mut at, read.len());
        (self.scatter * z).exp()
    }

    /// Readings of another edge that is cut and read as this one.
    pub fn replicate(&self, edge: &Edge, random: &mut ChaCha8Rng) -> Vec<f64> {
        if edge.readings() == 0 {
            return Vec::new();
        }
        let mut normal = || -> f64 { StandardNormal.sample(&mut *random) };
        let mut predicted = Predicted::default();
        self.predict(edge, (self.scatter * normal()).exp(), 1, &mut predicted);
        let mut readings: Vec<f64> = predicted.wear.iter().map(|wear| wear + self.noise * normal()).collect();
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
    fn ln_joint(
        &self,
        edge: &Edge,
        read: &[f64],
        times: Option<&[f64]>,
        z: f64,
        stride: usize,
        predicted: &mut Predicted,
    ) -> Joint {
        let stride = if times.is_some() { 1 } else { stride };
        self.predict(edge, (self.scatter * z).exp(), stride, predicted);
        let prior = -0.5 * z * z - HALF_LN_TAU;
        if let (Some(noise), Some(times)) = (&self.in_life, times) {
            let covariance = self.covariance(noise, times, &predicted.pace);
            let Some(factor) = Cholesky::new(covariance) else { return (f64::NEG_INFINITY, 0.0, 1.0) };
            let off =
                DVector::from_iterator(read.len(), read.iter().zip(&predicted.wear).map(|(read, wear)| read - wear));
            let slope = DVector::from_iterator(read.len(), predicted.slope.iter().map(|slope| slope * self.scatter));
            let solved = factor.solve(&slope);
            let density = prior + ln_normal(&factor, &off);
            return (density, solved.dot(&off) - z, 1.0 + solved.dot(&slope));
        }
        let weight = 1.0 / (self.noise * self.noise);
        let (mut squares, mut gradient, mut curvature) = (0.0, 0.0, 0.0);
        let compared = read.iter().skip(stride - 1).step_by(stride);
        for ((read, wear), slope) in compared.zip(&predicted.wear).zip(&predicted.slope) {
            let off = read - wear;
            let slope = slope * self.scatter;
            squares += off * off;
            gradient += off * slope;
            curvature += slope * slope;
        }
        let density = prior - 0.5 * weight * squares - predicted.wear.len() as f64 * (self.noise.ln() + HALF_LN_TAU);
        (density, weight * gradient - z, 1.0 + weight * curvature)
    }

    fn covariance(&self, noise: &InLife, times: &[f64], pace: &[f64]) -> DMatrix<f64> {
        DMatrix::from_fn(times.len(), times.len(), |i, j| {
            let reading = if i == j { self.noise * self.noise } else { 0.0 };
            reading + pace[i] * pace[j] * noise.covariance(times[i], times[j])
        })
    }
}

/// Log density, its derivative and its Gauss–Newton curvature at a standardised level.
pub(crate) type Joint = (f64, f64, f64);

/// Logarithm of the integral of a density over the standardised level, by adaptive Gauss–Hermite quadrature. `at` takes the
/// level and which of the `readings` are looked at: one is all of them, `n` every nth.
pub(crate) fn ln_integral(at: &mut dyn FnMut(f64, usize) -> Joint, readings: usize) -> f64 {
    let (z, (density, _, curvature)) = mode(at, readings);
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

/// The most probable standardised level of an edge, and the density there.
fn mode(at: &mut dyn FnMut(f64, usize) -> Joint, readings: usize) -> (f64, Joint) {
    let starts = (0..STARTS).map(|start| FARTHEST * (2.0 * start as f64 / (STARTS - 1) as f64 - 1.0));
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

/// Cutting time of the edge at each reading, min.
pub(crate) fn reading_times(edge: &Edge) -> Vec<f64> {
    let mut time = 0.0;
    let passed = edge.stretches.iter().map(|stretch| {
        time += stretch.time;
        (time, stretch.wear.is_some())
    });
    passed.filter(|(_, read)| *read).map(|(time, _)| time).collect()
}
