//! What was measured of one edge, and the density of it with the edge's own level integrated out.

use crate::curve::Curve;
use crate::in_life::{InLife, Noisy, Step};
use crate::level::{Joint, Nodes, SIDES, Start, ln_integral, mode, settled};
use crate::normal::{HALF_LN_TAU, ln_below, ln_between, ln_density, ln_sum};
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

    /// Whether it has so many readings that they all but tell its level.
    pub(crate) fn well_read(&self) -> bool {
        self.stretches.iter().any(|stretch| stretch.block.is_some_and(|block| block.count > 1.0))
            || self.readings() >= WELL_READ
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
/// Weight of the chord over one deviation either side in the slope of the straight line that fits a curve of third order best
/// over evenly spaced times.
const CHORD: f64 = 0.6;
/// Readings of an edge from which on its level is all but known (assumption).
const WELL_READ: usize = 25;

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
    pub(crate) fn predict(&self, edge: &Edge, begin: f64, level: f64, stride: usize, predicted: &mut Predicted) {
        predicted.wear.clear();
        predicted.slope.clear();
        predicted.pace.clear();
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
                at = stretch.condition;
                if let Some(slower) = before.and_then(|before| curve.slower_than(before)) {
                    // The curves are one but for their pace.
                    time *= slower;
                    stretch_of_time *= slower;
                } else if wear > 0.0 {
                    let rate;
                    (time, rate, cell) = curve.place(wear);
                    stretch_of_time = slope / rate;
                }
            }
            time += level * stretch.time;
            stretch_of_time += level * stretch.time;
            reading += usize::from(stretch.wear.is_some());
            let read = stretch.wear.is_some() && reading % stride == 0;
            let next = edge.stretches.get(index + 1).filter(|next| next.condition != at);
            if read || next.is_some_and(|next| self.curves[next.condition].slower_than(curve).is_none()) {
                let rate;
                (wear, rate) = match stretch.block.filter(|block| block.count > 1.0) {
                    // The mean of a curve is not the curve at the mean, but nearly that at one deviation of time either side; the
                    // slope of a straight line through it is that mixture of the slopes there and of the chord between them.
                    Some(block) if read => {
                        let apart = level * (block.times / block.count).sqrt();
                        let (before, after) =
                            (curve.wear(time - apart, &mut cell), curve.wear(time + apart, &mut cell));
                        let slopes = 0.5 * (before.1 + after.1);
                        let chord = (after.0 - before.0) / (2.0 * apart);
                        let slope = if apart > 0.0 { CHORD * chord + (1.0 - CHORD) * slopes } else { slopes };
                        (0.5 * (before.0 + after.0), slope)
                    }
                    Some(_) | None => curve.wear(time, &mut cell),
                };
                slope = rate * stretch_of_time;
                if read {
                    predicted.wear.push(wear);
                    predicted.slope.push(slope);
                    predicted.pace.push(level * rate);
                }
            }
        }
    }

    /// Log density of all data of an edge, its level integrated out.
    pub fn ln_density(&self, edge: &Edge) -> f64 {
        self.ln_density_near(edge, None)
    }

    /// The same of an edge whose level has this logarithm nearly, where it is known.
    pub(crate) fn ln_density_near(&self, edge: &Edge, ln_level: Option<f64>) -> f64 {
        let life = edge.life.map_or(0.0, |(condition, life)| {
            let mean = self.curves[condition].time(self.limit).ln();
            let z = |time: f64| (time.ln() - mean) / self.scatter;
            match life {
                Life::Exact(time) => ln_density(time.ln(), mean, self.scatter),
                Life::Censored(time) => ln_below(-z(time)),
                Life::Between(from, to) => ln_between(z(from), z(to)),
            }
        });
        if edge.readings() == 0 { life } else { life + self.ln_readings(edge, ln_level) }
    }

    fn ln_readings(&self, edge: &Edge, ln_level: Option<f64>) -> f64 {
        let (read, well_read) = (readings(edge), edge.well_read());
        let steps = self.steps(edge);
        let (mut predicted, mut at_mode, mut sets) = (Predicted::default(), Predicted::default(), Vec::new());
        let start = match ln_level {
            Some(level) => Start::At(level / self.scatter),
            None if well_read => Start::Few,
            None => Start::Many,
        };
        let nodes = if well_read { Nodes::Three } else { Nodes::Nine };
        let mut from = |begin: f64| {
            let mut joint =
                |z: f64, stride: usize| self.ln_joint(edge, begin, &read, steps.as_deref(), z, stride, &mut predicted);
            let Some((noise, steps)) = self.in_life.as_ref().zip(steps.as_deref()) else {
                let top = mode(&mut joint, read.len(), start);
                return ln_integral(nodes, top, |levels| levels.iter_mut().for_each(|z| *z = joint(*z, 1).0));
            };
            // What the noise makes of the readings is held as it is at the most probable level.
            let top = settled(&mut joint, read.len(), start);
            self.predict(edge, begin, (self.scatter * top.0).exp(), 1, &mut at_mode);
            ln_integral(nodes, top, |levels| {
                let mut beside = [0.0; SIDES];
                sets.clear();
                sets.resize(read.len(), [0.0; SIDES]);
                for (set, z) in levels.iter().enumerate() {
                    self.predict(edge, begin, (self.scatter * z).exp(), 1, &mut predicted);
                    let off = read.iter().zip(&predicted.wear).map(|((wear, _), expected)| wear - expected);
                    sets.iter_mut().zip(off).for_each(|(sets, off)| sets[set] = off);
                    beside[set] = self.ln_level(*z) + self.within(&read, &predicted.pace);
                }
                let held = || read.iter().zip(&at_mode.pace).map(|((_, block), pace)| (*pace, self.error(block)));
                let with = |((pace, error), sets): ((f64, f64), &[f64; SIDES])| (pace, error, *sets);
                let densities = match nodes {
                    Nodes::Nine => noise.densities(steps, held().zip(&sets).map(with)),
                    Nodes::Three => {
                        let few = |(pace, error, [a, b, ..]): (f64, f64, [f64; SIDES])| (pace, error, [a, b]);
                        let [a, b] = noise.densities(steps, held().zip(&sets).map(with).map(few));
                        [a, b, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
                    }
                };
                levels.iter_mut().zip(densities).zip(beside).for_each(|((z, density), own)| *z = density + own);
            })
        };
        let Some(begun) = edge.begun else { return from(0.0) };
        // The reading at the beginning has the error of any other; every wear before is as good as another.
        let terms = FEW_NODES.map(|(node, weight)| from(self.begin(begun, node)) + weight.ln());
        ln_sum(&terms)
    }

    /// How noise within the life goes on from reading to reading; none without it.
    fn steps(&self, edge: &Edge) -> Option<Vec<Step>> {
        self.in_life.map(|noise| noise.steps(reading_times(edge).into_iter()))
    }

    /// Flank wear of an edge whose reading at the beginning is off by `error` deviations.
    fn begin(&self, begun: f64, error: f64) -> f64 {
        (begun - error * self.noise).max(LEAST_BEGIN)
    }

    /// The level at which the readings of an edge are most probable together with the level itself.
    pub(crate) fn level(&self, edge: &Edge) -> f64 {
        let read = readings(edge);
        let steps = self.steps(edge);
        let mut predicted = Predicted::default();
        let begin = edge.begun.map_or(0.0, |begun| self.begin(begun, 0.0));
        let mut at =
            |z: f64, stride: usize| self.ln_joint(edge, begin, &read, steps.as_deref(), z, stride, &mut predicted);
        let (z, _) = match &steps {
            Some(_) => settled(&mut at, read.len(), Start::Many),
            None => mode(&mut at, read.len(), Start::Many),
        };
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
            let off = noise.integrals(&noise.steps(reading_times(edge).into_iter()), normal);
            readings
                .iter_mut()
                .zip(&predicted.pace)
                .zip(&off)
                .for_each(|((reading, pace), off)| *reading += pace * off);
        }
        readings
    }

    /// Log density of every `stride`-th reading and the standardised level `z`, its derivative by `z` and the Gauss–Newton
    /// curvature. Where readings are thinned, which is to compare starts, no noise joins them.
    #[allow(clippy::too_many_arguments)] // the state of one edge
    fn ln_joint(
        &self,
        edge: &Edge,
        begin: f64,
        read: &[(f64, Block)],
        steps: Option<&[Step]>,
        z: f64,
        stride: usize,
        predicted: &mut Predicted,
    ) -> Joint {
        self.predict(edge, begin, (self.scatter * z).exp(), stride, predicted);
        let prior = self.ln_level(z);
        if let (Some(noise), Some(steps), 1) = (&self.in_life, steps, stride) {
            let noisy = read.iter().enumerate().map(|(i, (wear, block))| Noisy {
                pace: predicted.pace[i],
                variance: self.error(block),
                off: wear - predicted.wear[i],
                slope: predicted.slope[i] * self.scatter,
            });
            let found = noise.filter(steps, noisy);
            let density = prior + found.density + self.within(read, &predicted.pace);
            return (density, found.gradient - z, 1.0 + found.curvature);
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

    /// Log density of a standardised level.
    fn ln_level(&self, z: f64) -> f64 {
        -0.5 * z * z - HALF_LN_TAU
    }

    /// Variance of the error of the mean of a block of readings, mm².
    fn error(&self, block: &Block) -> f64 {
        self.noise * self.noise / block.count
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

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    #[test]
    fn the_level_of_an_edge_with_joined_readings_is_integrated_out() {
        let noise = |deviation: f64| Some(InLife { deviation, correlation: 5.0 });
        for (contrast, scatter, reading, deviation) in
            [(0.5, 0.15, 0.008, 0.1), (0.2, 0.4, 0.004, 0.2), (0.8, 0.1, 0.015, 0.05), (0.5, 0.3, 0.002, 0.1)]
        {
            let rate = |wear: f64| 0.3 / toolroom_wear::wear_stage(wear / 0.3, contrast, 0.0);
            let curves = [Curve::bent(0.6, 0.3, rate).faster(1.0 / 40.0)];
            let common = Common { curves: &curves, scatter, noise: reading, in_life: noise(deviation), limit: 0.3 };
            for seed in 0..6 {
                let stretches = vec![Stretch::read(0, 4.0, 0.0); 10];
                let mut edge = Edge { name: String::new(), stretches, life: None, begun: None };
                let read = common.replicate(&edge, &mut ChaCha8Rng::seed_from_u64(seed));
                edge.stretches.iter_mut().zip(read).for_each(|(stretch, wear)| stretch.wear = Some(wear));
                let (read, steps, mut predicted) = (readings(&edge), common.steps(&edge), Predicted::default());
                let (noise, steps) = (common.in_life.expect("noise"), steps.expect("steps"));
                let level = common.level(&edge);
                common.predict(&edge, 0.0, level, 1, &mut predicted);
                let held = predicted.pace.clone();
                let step = 0.01;
                let fine = (-700..=700).map(|place: i32| {
                    let z = level.ln() / scatter + step * f64::from(place);
                    common.predict(&edge, 0.0, (scatter * z).exp(), 1, &mut predicted);
                    let one = |i: usize| Noisy {
                        pace: held[i],
                        variance: reading * reading,
                        off: read[i].0 - predicted.wear[i],
                        slope: 0.0,
                    };
                    let joined = noise.filter(&steps, (0..read.len()).map(one)).density;
                    joined - 0.5 * z * z - HALF_LN_TAU + step.ln()
                });
                let (fine, found) = (ln_sum(&fine.collect::<Vec<f64>>()), common.ln_density(&edge));
                // Nine nodes; beyond a great contrast the wear curve has a sharp bend.
                let bound = if contrast > 0.6 { 0.05 } else { 0.01 };
                assert!((fine - found).abs() < bound, "{contrast} {scatter} {reading} {seed}: {found} against {fine}");
            }
        }
    }
}
