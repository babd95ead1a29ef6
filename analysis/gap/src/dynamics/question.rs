//! Three hypotheses about a structure over a grid of frequency, damping and depth, and what cuts say of them.

use crate::NominalModel;
use crate::drift::{DriftExplanation, DynamicsDrift, StructureChange};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;
use statrs::distribution::{ContinuousCDF, Normal};
use std::collections::BTreeMap;
use toolroom_facts::{Fact, FactDetail, Quantity};
use toolroom_nominal::{HeardCut, StructurePrior};
use toolroom_records::{CHATTER_FREQUENCY_DEVIATION, WRONG_CHATTER_RECORD};

/// Half width of the logarithm of frequencies that may have drifted, and of depths (assumptions: a collet, a bearing or
/// another holder moves frequencies by less than a fifth, the limit by less than a factor of 2.5).
const WIDE: [f64; 2] = [0.2, 0.92];
/// Nodes over that width, and over what is known.
const NODES: [usize; 2] = [31, 9];
/// Standard deviations that the nodes of what is known span on either side.
const SPAN: f64 = 2.5;
/// Weight below which a node of the prior is left out, of the greatest.
const FAINT: f64 = 0.02;
/// Steps of the logarithms of speed, land (m) and depth in which cuts count as alike, and how many conditions there may be at
/// most; with more the first two steps grow.
const STEPS: [f64; 3] = [0.003, 20e-6, 0.03];
const CONDITIONS: usize = 40;
/// Scatter that such a step stands for, in the logarithm of the depth.
const ROUNDED: f64 = 0.02;
/// Drawn data sets: first, and where the answer is not clear with these.
const DRAWN: [usize; 2] = [400, 4000];
/// Standard deviations by which a frequency is off where no limit was found.
const NO_LIMIT: f64 = 3.0;

/// Nodes with the logarithms of their weights under two priors: as known, and anywhere.
struct Axis {
    nodes: Vec<f64>,
    known: Vec<f64>,
    wide: Vec<f64>,
}

impl Axis {
    fn new(deviation: f64, wide: f64) -> Self {
        let wide = wide.max(SPAN * deviation);
        let [many, few] = NODES;
        let spread = |half: f64, count: usize| {
            (0..count).map(move |i| half * (2.0 * i as f64 / (count - 1) as f64 - 1.0)).collect::<Vec<f64>>()
        };
        let mut nodes = [spread(wide, many), spread(SPAN * deviation, few)].concat();
        nodes.sort_by(f64::total_cmp);
        nodes.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
        let cell = |i: usize| {
            let before = nodes[i.saturating_sub(1)];
            let after = nodes[(i + 1).min(nodes.len() - 1)];
            0.5 * (after - before)
        };
        let cells: Vec<f64> = (0..nodes.len()).map(cell).collect();
        let known = nodes.iter().zip(&cells).map(|(x, cell)| (-0.5 * (x / deviation).powi(2)).exp() * cell).collect();
        Self { known: logarithms(known), wide: logarithms(cells.clone()), nodes }
    }
}

/// Logarithms of weights over their sum; faint ones count as none.
fn logarithms(weights: Vec<f64>) -> Vec<f64> {
    let greatest = weights.iter().copied().fold(0.0, f64::max);
    let kept: Vec<f64> = weights.iter().map(|w| if *w < FAINT * greatest { 0.0 } else { *w }).collect();
    let sum: f64 = kept.iter().sum();
    kept.iter().map(|weight| (weight / sum).ln()).collect()
}

/// Cuts of one speed, land, width and place.
struct Condition {
    like: HeardCut,
    /// Number of its first depth among those of all conditions, and depths (logarithms).
    first: usize,
    depths: Vec<f64>,
    /// Mean logarithm of the frequencies that were read.
    frequency: Option<f64>,
}

/// The cuts of a machine, and what every node of the grid says of them.
pub(super) struct Question {
    conditions: Vec<Condition>,
    /// Condition and depth of each cut.
    places: Vec<(usize, usize)>,
    /// Piece and lot of each cut, by consecutive numbers.
    shared: Vec<[usize; 2]>,
    chatter: Vec<bool>,
    prior: StructurePrior,
    axes: [Axis; 2],
    points: Vec<[usize; 3]>,
    /// Logarithms of the weights of every point under the three hypotheses.
    weights: [Vec<f64>; 3],
    /// Logarithms of limit and chatter frequency, by condition, then frequency, then damping.
    limits: Vec<[f64; 2]>,
    /// Logarithms of the probability of chatter and of none, by point, then depth of a condition.
    chances: Vec<[f64; 2]>,
    depths: usize,
}

/// Gauss–Hermite nodes and weights of a normal law.
const DAMPING: [(f64, f64); 3] =
    [(-1.732_050_807_568_877, 1.0 / 6.0), (0.0, 2.0 / 3.0), (1.732_050_807_568_877, 1.0 / 6.0)];

fn alike(cut: &HeardCut, [speed, land, depth]: [f64; 3]) -> ([i64; 6], i64) {
    let step = |value: f64, step: f64| (value / step).round() as i64;
    let logarithm = |value: f64| if value > 0.0 { step(value.ln(), 0.01) } else { 0 };
    let key = [
        step(cut.cutting_speed.ln(), speed),
        step(cut.flank_wear, land),
        logarithm(cut.width),
        logarithm(cut.diameter),
        step(cut.places[0], 1e-3),
        logarithm(cut.feed),
    ];
    (key, step(cut.depth.ln(), depth))
}

impl Question {
    pub fn new(model: &NominalModel, cuts: &[&HeardCut], prior: StructurePrior) -> Self {
        let mut steps = STEPS;
        let grouped = loop {
            let mut groups: BTreeMap<[i64; 6], Vec<usize>> = BTreeMap::new();
            for (i, cut) in cuts.iter().enumerate() {
                groups.entry(alike(cut, steps).0).or_default().push(i);
            }
            // Conditions that differ in width, diameter or place do not merge, however great the steps of speed and land are.
            if groups.len() <= CONDITIONS || steps[0] > 0.05 {
                break groups;
            }
            steps[0] *= 1.5;
            steps[1] *= 1.5;
        };
        let (mut conditions, mut places) = (Vec::new(), vec![(0, 0); cuts.len()]);
        let mut total = 0;
        for members in grouped.into_values() {
            let mean =
                |of: fn(&HeardCut) -> f64| members.iter().map(|i| of(cuts[*i])).sum::<f64>() / members.len() as f64;
            let mut like = cuts[members[0]].clone();
            (like.cutting_speed, like.flank_wear) = (mean(|cut| cut.cutting_speed), mean(|cut| cut.flank_wear));
            (like.diameter, like.width) = (mean(|cut| cut.diameter), mean(|cut| cut.width));
            like.depth = members.iter().map(|i| cuts[*i].depth).fold(0.0, f64::max);
            let mut depths: Vec<(i64, Vec<f64>)> = Vec::new();
            for i in &members {
                let (key, depth) = (alike(cuts[*i], steps).1, cuts[*i].depth.ln());
                let place = depths.iter().position(|own| own.0 == key).unwrap_or_else(|| {
                    depths.push((key, Vec::new()));
                    depths.len() - 1
                });
                depths[place].1.push(depth);
                places[*i] = (conditions.len(), total + place);
            }
            let read: Vec<f64> = members.iter().filter_map(|i| cuts[*i].frequency).map(f64::ln).collect();
            let depths: Vec<f64> = depths.iter().map(|(_, own)| own.iter().sum::<f64>() / own.len() as f64).collect();
            let count = depths.len();
            let frequency = (!read.is_empty()).then(|| read.iter().sum::<f64>() / read.len() as f64);
            conditions.push(Condition { like, first: total, depths, frequency });
            total += count;
        }
        let axes = [Axis::new(prior.natural_frequency, WIDE[0]), Axis::new(prior.depth, WIDE[1])];
        let frequencies = axes[0].nodes.len();
        let all: Vec<(usize, usize, usize)> = (0..conditions.len())
            .flat_map(|c| (0..frequencies).flat_map(move |f| (0..DAMPING.len()).map(move |z| (c, f, z))))
            .collect();
        let judged = |(c, f, z): &(usize, usize, usize)| {
            let damping = (prior.damping_ratio * DAMPING[*z].0).exp();
            let (limit, frequency) = model.stability_limit(&conditions[*c].like, axes[0].nodes[*f].exp(), damping);
            [limit.max(1e-9).ln(), frequency.ln()]
        };
        let limits: Vec<[f64; 2]> = all.par_iter().map(judged).collect();
        let mut question = Self {
            conditions,
            places,
            shared: consecutive(cuts),
            chatter: cuts.iter().map(|cut| cut.chatter).collect(),
            prior,
            axes,
            points: Vec::new(),
            weights: Default::default(),
            limits,
            chances: Vec::new(),
            depths: total,
        };
        question.place();
        question
    }

    /// Points of the grid with their weights and chances.
    fn place(&mut self) {
        let [f, k] = &self.axes;
        for (i, _) in f.nodes.iter().enumerate() {
            for (z, (_, weight)) in DAMPING.iter().enumerate() {
                for (j, _) in k.nodes.iter().enumerate() {
                    let weights = [f.known[i] + k.known[j], f.wide[i] + k.known[j], f.known[i] + k.wide[j]];
                    if weights.iter().any(|weight| weight.is_finite()) {
                        self.points.push([i, z, j]);
                        self.weights.iter_mut().zip(weights).for_each(|(all, own)| all.push(own + weight.ln()));
                    }
                }
            }
        }
        let scatter = self.prior.hardness[0].hypot(self.prior.hardness[1]).hypot(ROUNDED);
        let standard = Normal::standard();
        let of_point = |point: &[usize; 3]| {
            let mut chances = Vec::with_capacity(self.depths);
            for (c, condition) in self.conditions.iter().enumerate() {
                let limit = self.limit(c, point)[0];
                for depth in &condition.depths {
                    let beyond = if limit.is_finite() { standard.cdf((depth - limit) / scatter) } else { 0.0 };
                    let chance = WRONG_CHATTER_RECORD + (1.0 - 2.0 * WRONG_CHATTER_RECORD) * beyond;
                    chances.push([chance.ln(), (1.0 - chance).ln()]);
                }
            }
            chances
        };
        let chances: Vec<Vec<[f64; 2]>> = self.points.par_iter().map(of_point).collect();
        self.chances = chances.concat();
    }

    /// Logarithms of limit and frequency of a condition at a point.
    fn limit(&self, condition: usize, [f, z, k]: &[usize; 3]) -> [f64; 2] {
        let [limit, frequency] = self.limits[(condition * self.axes[0].nodes.len() + f) * DAMPING.len() + z];
        [limit + self.axes[1].nodes[*k], frequency]
    }

    /// Log likelihood of every point: of records of chatter, and of the mean frequency of each condition where one was read.
    fn likelihoods(&self, chatter: &[bool], frequencies: &[Option<f64>]) -> Vec<f64> {
        let mut counts = vec![[0.0; 2]; self.depths];
        for ((_, depth), chatter) in self.places.iter().zip(chatter) {
            counts[*depth][usize::from(!*chatter)] += 1.0;
        }
        let seen: Vec<usize> = (0..self.depths).filter(|depth| counts[*depth] != [0.0; 2]).collect();
        let read: Vec<(usize, f64)> =
            frequencies.iter().enumerate().filter_map(|(c, frequency)| Some((c, (*frequency)?))).collect();
        let of_point = |(p, point): (usize, &[usize; 3])| {
            let chances = &self.chances[p * self.depths..][..self.depths];
            let heard: f64 = seen.iter().map(|d| counts[*d][0] * chances[*d][0] + counts[*d][1] * chances[*d][1]).sum();
            // What all frequencies of a machine share is off once, not once a condition.
            let apart = |(c, frequency): &(usize, f64)| {
                let expected = self.limit(*c, point)[1];
                if expected.is_finite() { (frequency - expected) / CHATTER_FREQUENCY_DEVIATION } else { NO_LIMIT }
            };
            let mean = read.iter().map(apart).sum::<f64>() / read.len().max(1) as f64;
            heard - 0.5 * mean * mean
        };
        self.points.iter().enumerate().map(of_point).collect()
    }

    /// Log evidence of the three hypotheses.
    fn evidence(&self, likelihoods: &[f64]) -> [f64; 3] {
        [0, 1, 2].map(|h| log_sum(likelihoods.iter().zip(&self.weights[h]).map(|(l, w)| l + w)))
    }

    /// Records that the structure as it is known draws, with how many cuts chatter.
    fn drawn(&self, seed: u64) -> (Vec<bool>, Vec<Option<f64>>) {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut share: f64 = random.random();
        let known = self.points.iter().zip(&self.weights[0]);
        let chosen = known.filter(|(_, weight)| weight.is_finite());
        let mut point = &self.points[0];
        for (own, weight) in chosen {
            point = own;
            share -= weight.exp();
            if share < 0.0 {
                break;
            }
        }
        let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
        let count = |kind: usize| self.shared.iter().map(|own| own[kind] + 1).max().unwrap_or(0);
        let [lot, piece] = self.prior.hardness;
        let pieces: Vec<f64> = (0..count(0)).map(|_| piece * normal()).collect();
        let lots: Vec<f64> = (0..count(1)).map(|_| lot * normal()).collect();
        let off = CHATTER_FREQUENCY_DEVIATION * normal();
        let limits: Vec<[f64; 2]> = (0..self.conditions.len()).map(|c| self.limit(c, point)).collect();
        let chatter: Vec<bool> = self
            .places
            .iter()
            .zip(&self.shared)
            .map(|((c, d), [piece, lot])| {
                let condition = &self.conditions[*c];
                let beyond = condition.depths[d - condition.first] + pieces[*piece] + lots[*lot] > limits[*c][0];
                beyond != (random.random::<f64>() < WRONG_CHATTER_RECORD)
            })
            .collect();
        let reads = self.conditions.iter().any(|condition| condition.frequency.is_some());
        let mut frequencies = vec![None; self.conditions.len()];
        for ((c, _), chatter) in self.places.iter().zip(&chatter) {
            if reads && *chatter && limits[*c][1].is_finite() {
                frequencies[*c] = Some(limits[*c][1] + off);
            }
        }
        (chatter, frequencies)
    }

    pub fn answered(&self, machine: &str, seed: u64) -> DynamicsDrift {
        let frequencies: Vec<Option<f64>> = self.conditions.iter().map(|condition| condition.frequency).collect();
        let likelihoods = self.likelihoods(&self.chatter, &frequencies);
        let gain = |evidence: [f64; 3]| evidence[1].max(evidence[2]) - evidence[0];
        let evidence = self.evidence(&likelihoods);
        let observed = gain(evidence);
        // Counts of chatter, and whether the gain is as great by chance.
        let draw = |i: usize| {
            let (chatter, frequencies) = self.drawn(seed ^ (0xD1F7 + ((i as u64) << 16)));
            let count = chatter.iter().filter(|chatter| **chatter).count();
            (count, gain(self.evidence(&self.likelihoods(&chatter, &frequencies))) >= observed)
        };
        let mut drawn: Vec<(usize, bool)> = (0..DRAWN[0]).into_par_iter().map(draw).collect();
        let as_great = |drawn: &[(usize, bool)]| drawn.iter().filter(|own| own.1).count();
        if as_great(&drawn) <= 8 {
            drawn.extend((DRAWN[0]..DRAWN[1]).into_par_iter().map(draw).collect::<Vec<_>>());
        }
        let changes = [(1, 0, StructureChange::ModeFrequency), (2, 1, StructureChange::ModeStiffness)];
        let mut explanations = changes.map(|(hypothesis, axis, change)| {
            let (factor, ci90) = self.posterior(&likelihoods, hypothesis, axis);
            DriftExplanation { change, factor, ci90, gain: evidence[hypothesis] - evidence[0] }
        });
        explanations.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        DynamicsDrift {
            machine: machine.to_owned(),
            cuts: self.chatter.len(),
            chattered: self.chatter.iter().filter(|chatter| **chatter).count(),
            expected: drawn.iter().map(|own| own.0 as f64).sum::<f64>() / drawn.len() as f64,
            p: (1.0 + as_great(&drawn) as f64) / (1.0 + drawn.len() as f64),
            explanations,
            drift: false,
        }
    }

    /// Mean and 90 % interval of a factor under a hypothesis.
    fn posterior(&self, likelihoods: &[f64], hypothesis: usize, axis: usize) -> (f64, [f64; 2]) {
        let nodes = &self.axes[axis].nodes;
        let mut of_node = vec![Vec::new(); nodes.len()];
        for ((point, likelihood), weight) in self.points.iter().zip(likelihoods).zip(&self.weights[hypothesis]) {
            of_node[point[2 * axis]].push(likelihood + weight);
        }
        let logs: Vec<f64> = of_node.into_iter().map(|own| log_sum(own.into_iter())).collect();
        let all = log_sum(logs.iter().copied());
        let shares: Vec<f64> = logs.iter().map(|log| (log - all).exp()).collect();
        let mean: f64 = nodes.iter().zip(&shares).map(|(node, share)| node * share).sum();
        let quantile = |level: f64| {
            let mut below = 0.0;
            for (i, (node, share)) in nodes.iter().zip(&shares).enumerate() {
                if below + share >= level {
                    // A node stands for all up to the middle between it and its neighbours.
                    let half = |other: usize| 0.5 * (nodes[other.min(nodes.len() - 1)] + node);
                    let (from, to) = (half(i.saturating_sub(1)), half(i + 1));
                    return from + (to - from) * (level - below) / share;
                }
                below += share;
            }
            nodes[nodes.len() - 1]
        };
        (mean.exp(), [quantile(0.05).exp(), quantile(0.95).exp()])
    }

    /// The drift as a constant of the file: the frequency of the mode that chatters, or the limit of the commonest condition.
    pub fn fact(&self, model: &NominalModel, drift: &DynamicsDrift) -> Fact {
        let [best, _] = &drift.explanations;
        let cuts = |c: usize| self.places.iter().filter(|place| place.0 == c).count();
        let commonest = (0..self.conditions.len()).max_by_key(|c| cuts(*c)).unwrap_or(0);
        let like = &self.conditions[commonest].like;
        let (limit, frequency) = model.stability_limit(like, 1.0, 1.0);
        let (quantity, value) = match best.change {
            StructureChange::ModeFrequency => {
                (Quantity::NaturalFrequency, model.nearest_mode(like, frequency).unwrap_or(frequency))
            }
            StructureChange::ModeStiffness => (Quantity::StabilityLimit, limit),
        };
        Fact {
            quantity,
            place: drift.machine.clone(),
            pooled: false,
            told: FactDetail::default(),
            count: drift.chattered as u64,
            expected: drift.expected,
            p: drift.p,
            tests: vec![("chatter", drift.p)],
            model: value,
            estimate: value * best.factor,
            ci90: best.ci90.map(|factor| value * factor),
            least_seen: [f64::NAN; 2],
        }
    }
}

/// Piece and lot of each cut, numbered without gaps.
fn consecutive(cuts: &[&HeardCut]) -> Vec<[usize; 2]> {
    let mut known: [BTreeMap<usize, usize>; 2] = Default::default();
    let mut number = |kind: usize, id: usize| {
        let next = known[kind].len();
        *known[kind].entry(id).or_insert(next)
    };
    cuts.iter().map(|cut| [number(0, cut.piece), number(1, cut.lot)]).collect()
}

fn log_sum(logs: impl Iterator<Item = f64> + Clone) -> f64 {
    let greatest = logs.clone().fold(f64::NEG_INFINITY, f64::max);
    if greatest == f64::NEG_INFINITY {
        return greatest;
    }
    greatest + logs.map(|log| (log - greatest).exp()).sum::<f64>().ln()
}
