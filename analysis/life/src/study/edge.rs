//! One edge: how it differs from nominal, and its life under a policy.

mod chips;
mod cubic;
mod noise;
mod passes;
mod rehearsal;
mod steady;

use super::policy::Policy;
use super::{End, Study, Tilt};
use crate::normal;
use passes::Machining;
use rand::RngExt;
pub use rehearsal::rehearsed;
use std::sync::LazyLock;
use toolroom_kernel::{Entity, Purpose, Stream, Streams};
use toolroom_wear::{Contact, Cut, Pair, Scatter};

/// Coordinates of a point that every study has, in their order.
pub const COORDINATES: [&str; 9] = [
    "common wear",
    "mechanical wear",
    "thermal wear",
    "batch hardness",
    "flank shear",
    "flank pressure",
    "emf gain",
    "initial wear",
    "chipping resistance",
];

/// Wear levels whose first passage is noted, as shares of the wear limit.
pub const LEVELS: usize = 16;
/// What became of an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// Time in cut, s.
    pub life: f64,
    /// Cutting path, m.
    pub path: f64,
    /// Flank wear at the end, m.
    pub flank_wear: f64,
    /// What ended it.
    pub end: End,
    /// Weight of the edge, 1 but in importance sampling.
    pub weight: f64,
    /// Time in cut at which wear passed each of the [`LEVELS`], s; infinite where it did not.
    pub passages: [f64; LEVELS],
}

/// An edge with everything that is drawn once for it.
pub struct Edge {
    cut: Cut,
    initial_wear: f64,
    emf_gain: f64,
    resistance: f64,
    batch_hardness: f64,
    weight: f64,
}

impl Edge {
    /// The edge of a point; `pair` and `cut` carry the fields that the point has changed.
    pub fn of(study: &Study, cut: &Cut, point: &[f64], stream: &mut Stream) -> Self {
        let scatter = &study.scatter;
        let z = |i: usize| normal::quantile(point[i]);
        let (mut common, mut resistance, mut weight) = (z(0), -(-point[8]).ln_1p(), 1.0);
        let Tilt { wear_shift, chipping_rate } = study.tilt;
        let [worn, weak] = study.tilt.shares();
        if worn + weak > 0.0 {
            // Some edges are drawn with more wear, some with less resistance, and all of them weigh by
            // the mixture: no weight is above 2 (T. Hesterberg, Technometrics 37 (1995) 185).
            let u: f64 = stream.random();
            if u < worn {
                common += wear_shift;
            } else if u < worn + weak {
                resistance /= chipping_rate;
            }
            let shifted = (wear_shift * common - 0.5 * wear_shift * wear_shift).exp();
            let weaker = chipping_rate * ((1.0 - chipping_rate) * resistance).exp();
            weight = 1.0 / (1.0 - worn - weak + worn * shifted + weak * weaker);
        }
        let clip = |hardness: f64| hardness.clamp(1.0 - scatter.hardness_clip, 1.0 + scatter.hardness_clip);
        let batch_hardness = clip(1.0 + scatter.batch_hardness * z(3));
        Self {
            cut: Cut {
                wear_factor: cut.wear_factor * (scatter.common_wear * common).exp(),
                mechanical_factor: cut.mechanical_factor * (scatter.mechanical_wear * z(1)).exp(),
                thermal_factor: cut.thermal_factor * (scatter.thermal_wear * z(2)).exp(),
                flank_shear_factor: cut.flank_shear_factor * (scatter.flank_stress * z(4)).exp(),
                flank_pressure_factor: cut.flank_pressure_factor * (scatter.flank_stress * z(5)).exp(),
                ..*cut
            },
            emf_gain: 1.0 + scatter.emf_gain * z(6),
            initial_wear: scatter.initial_wear * (scatter.initial_wear_scatter * z(7)).exp(),
            resistance,
            batch_hardness,
            weight,
        }
    }

    /// Its cut but for what differs from pass to pass.
    fn mean_cut(&self) -> Cut {
        Cut { hardness: self.cut.hardness * self.batch_hardness, ..self.cut }
    }

    /// The cut of a pass: hardness of the piece and depth of the allowance.
    fn cut_of_pass(&self, scatter: &Scatter, varies: bool, stream: &mut Stream) -> Cut {
        if !varies {
            return self.mean_cut();
        }
        let hardness = scatter.sample_piece_hardness(self.batch_hardness, stream);
        let depth_of_cut = scatter.sample_depth(self.cut.depth_of_cut, stream);
        Cut { hardness: self.cut.hardness * hardness, depth_of_cut, ..self.cut }
    }
}

/// Random numbers of the life of one edge, apart from those of its point: a stream a purpose, so that
/// no draw depends on when the others are due. Wear, pieces and sensors vary alike under every policy.
#[derive(Clone, Debug)]
pub struct Draws {
    /// Noise on the rate of wear, and whether the edge is tilted.
    pub(super) wear: Stream,
    /// Hardness and allowance of the pieces.
    pub(super) pieces: Stream,
    /// Noise of the sensors.
    pub(super) sensors: Stream,
}

impl Draws {
    /// Those of edge `index`.
    pub fn of(seed: u64, index: u64) -> Self {
        let open = |purpose| Streams::new(seed, 1).at(Entity::named("life"), purpose, index);
        Self { wear: open(Purpose::Tool), pieces: open(Purpose::Workpiece), sensors: open(Purpose::Measurement) }
    }
}

/// Lives an edge under a policy; every life is within 1e-4 of the exact one for its noise, under `set_increment` within 2e-4
/// (tested).
pub fn live(study: &Study, pair: &Pair, cut: &Cut, policy: &Policy, point: &[f64], draws: &mut Draws) -> Outcome {
    live_in_parts(study, pair, cut, policy, point, draws, 1)
}

/// The same with every step and every panel of quadrature cut into `parts`.
fn live_in_parts(
    study: &Study,
    pair: &Pair,
    cut: &Cut,
    policy: &Policy,
    point: &[f64],
    draws: &mut Draws,
    parts: u32,
) -> Outcome {
    let edge = Edge::of(study, cut, point, &mut draws.wear);
    match policy.constant() {
        Some(speed) if study.steady() => steady::life(study, pair, &edge, speed, &mut draws.wear, parts),
        _ => Machining::new(study, pair, &edge, policy, draws, parts).run(|_, _| ()),
    }
}

/// The wear between `start` and `end` at which the contact is as hot as the edge bears.
fn collapse(contact: &Contact<'_>, temperature: f64, mut start: f64, mut end: f64) -> f64 {
    for _ in 0..40 {
        let middle = 0.5 * (start + end);
        *(if contact.steady_temperature(middle) > temperature { &mut end } else { &mut start }) = middle;
    }
    start
}

/// Share of the limit at a level: evenly spaced in the variable in which run-in is as wide as the
/// rest of the life.
pub fn level_share(level: usize) -> f64 {
    SHARES[level]
}

/// The wear limit over the land that counts as run-in.
const STRETCH: f64 = 30.0;

static SHARES: LazyLock<[f64; LEVELS]> = LazyLock::new(|| {
    std::array::from_fn(|level| ((1.0 + STRETCH).powf((level + 1) as f64 / LEVELS as f64) - 1.0) / STRETCH)
});

#[cfg(test)]
mod tests;
