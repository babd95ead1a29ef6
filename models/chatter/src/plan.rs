//! From the geometry of a cut and the motion of the spindle to a [`Period`].

use crate::period::{EarlierCut, Element, PastSample, Period, Stretch, Term};
use crate::response::{Modes, Response, nodes_for, parts_for};
use crate::speed_variation::Started;
use std::f64::consts::TAU;
use std::sync::Arc;
use toolroom_spectral::Rule;

/// How the spindle turns.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Motion {
    /// At a constant speed (rad/s).
    Constant(f64),
    /// About a mean speed (rad/s).
    Varying(f64, Started),
}

impl Motion {
    /// Time at which the spindle has turned by `angle` (s).
    fn time_at(self, angle: f64) -> f64 {
        match self {
            Self::Constant(speed) => angle / speed,
            Self::Varying(speed, variation) => variation.time_at(speed, angle),
        }
    }

    /// Angle at `time` (rad).
    fn angle_at(self, time: f64) -> f64 {
        match self {
            Self::Constant(speed) => speed * time,
            Self::Varying(speed, variation) => variation.angle_at(speed, time),
        }
    }

    /// Greatest speed (rad/s).
    fn greatest(self) -> f64 {
        match self {
            Self::Constant(speed) => speed,
            Self::Varying(speed, started) => speed * (1.0 + started.variation.amplitude),
        }
    }

    /// Speed at `time` (rad/s).
    fn speed_at(self, time: f64) -> f64 {
        match self {
            Self::Constant(speed) => speed,
            Self::Varying(speed, variation) => variation.speed_at(speed, time),
        }
    }
}

/// Teeth that cut the same earlier surface, `delay` (rad) behind it.
pub(crate) struct PlannedTerm<K> {
    pub delay: f64,
    pub teeth: Vec<K>,
}

/// A stretch of spindle angle in which the same teeth cut; none is free flight.
pub(crate) struct PlannedStretch<K> {
    pub from: f64,
    pub to: f64,
    pub terms: Vec<PlannedTerm<K>>,
}

/// What the teeth do: matrices in (x, y) per depth as functions of spindle angle.
pub(crate) trait Cut {
    /// What names a tooth in cut.
    type Tooth;
    /// Force by displacement.
    fn gain(&self, tooth: &Self::Tooth, angle: f64) -> [f64; 4];
    /// Force by rate of displacement at spindle `speed`, if the cut damps at all.
    fn damping(&self, tooth: &Self::Tooth, angle: f64, speed: f64) -> Option<[f64; 4]>;
}

/// Relative directions of the modes: displacement in the plane, or along one line.
pub(crate) struct Frame {
    pub modes: Modes,
    /// The line, if there is only one.
    line: Option<[f64; 2]>,
}

impl Frame {
    /// Modes whose inputs and outputs are their directions.
    pub fn new(modes: &[crate::Mode]) -> Self {
        let first = modes[0].unit();
        let parallel = modes.iter().all(|mode| {
            let d = mode.unit();
            (d[0] * first[1] - d[1] * first[0]).abs() < 1e-12
        });
        let modal = modes.iter().map(|mode| {
            let d = mode.unit();
            let d = if parallel { [d[0] * first[0] + d[1] * first[1], 0.0] } else { d };
            mode.modal(d, d)
        });
        let channels = if parallel { 1 } else { 2 };
        Self { modes: Modes { modal: modal.collect(), channels }, line: parallel.then_some(first) }
    }

    /// One direction of displacement that is already resolved in the modes' inputs and outputs.
    pub fn resolved(modes: Modes) -> Self {
        Self { modes, line: Some([1.0, 0.0]) }
    }

    /// A matrix of the plane in the channels of this frame.
    pub fn project(&self, m: [f64; 4]) -> [f64; 4] {
        match self.line {
            None => m,
            Some([x, y]) => [x * (m[0] * x + m[1] * y) + y * (m[2] * x + m[3] * y), 0.0, 0.0, 0.0],
        }
    }
}

/// A stretch of time in cut before its response is computed.
struct Slot {
    start: f64,
    end: f64,
    stretch: usize,
    nodes: usize,
}

/// How finely a stretch in cut is resolved.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Resolution {
    /// Nodes on top of what the oscillations need.
    pub extra: usize,
    /// Factor by which the cut quickens the oscillations.
    pub stiffening: f64,
    /// Cycles in a part of a stretch that is split, at most.
    pub most_cycles: f64,
}

/// Builds the period that the stretches describe; they follow each other without gaps and the
/// cut repeats after the last. `resolution` is how finely each stretch in cut is resolved.
pub(crate) fn assemble<C: Cut>(
    cut: &C,
    frame: &Frame,
    motion: Motion,
    stretches: &[PlannedStretch<C::Tooth>],
    resolution: Resolution,
) -> Period {
    let modes = &frame.modes;
    let origin = stretches.first().map_or(0.0, |s| s.from);
    let turn = stretches.last().map_or(TAU, |s| s.to) - origin;
    let period = motion.time_at(turn);
    let mut plan = Vec::new();
    let mut slots: Vec<Slot> = Vec::new();
    for (index, stretch) in stretches.iter().enumerate() {
        let (start, end) = (motion.time_at(stretch.from - origin), motion.time_at(stretch.to - origin));
        if stretch.terms.is_empty() {
            plan.push(Stretch::Free(modes.modal.iter().map(|m| m.transition(end - start)).collect()));
            continue;
        }
        let cycles = modes.fastest() * resolution.stiffening * (end - start) / TAU;
        // An earlier surface must lie in an earlier stretch.
        let shortest = stretch.terms.iter().map(|t| t.delay).fold(f64::INFINITY, f64::min);
        let delays = (end - start) * motion.greatest() / shortest;
        let parts = parts_for(cycles, resolution.most_cycles).max((delays - 1e-9).ceil() as usize);
        let length = (end - start) / parts as f64;
        for part in 0..parts {
            let start = start + length * part as f64;
            slots.push(Slot {
                start,
                end: start + length,
                stretch: index,
                nodes: nodes_for(cycles / parts as f64, resolution.extra),
            });
            plan.push(Stretch::Cut);
        }
    }
    let mut responses: Vec<Arc<Response>> = Vec::new();
    let mut elements = Vec::with_capacity(slots.len());
    for (index, slot) in slots.iter().enumerate() {
        let duration = slot.end - slot.start;
        let rule = Rule::of(slot.nodes);
        let n = rule.nodes.len();
        let times: Vec<f64> = rule.nodes.iter().map(|node| slot.start + node * duration).collect();
        let angles: Vec<f64> = times.iter().map(|t| origin + motion.angle_at(*t)).collect();
        let stretch = &stretches[slot.stretch];
        let terms = stretch.terms.iter().map(|term| {
            let steady = matches!(motion, Motion::Constant(_)) && (term.delay - turn).abs() < 1e-9 * turn;
            let past = if steady {
                EarlierCut::OnePeriodAgo
            } else {
                let at = |angle: &f64| motion.time_at_wrapped(angle - origin - term.delay, turn, period);
                EarlierCut::At(angles.iter().map(|angle| locate(&slots, index, at(angle), period)).collect())
            };
            let teeth = &term.teeth;
            Term { gain: sample(frame, n, |j| sum(teeth.iter().map(|tooth| cut.gain(tooth, angles[j])))), past }
        });
        let terms: Vec<Term> = terms.collect();
        let teeth = || stretch.terms.iter().flat_map(|term| &term.teeth);
        let damps = teeth().next().is_some_and(|tooth| cut.damping(tooth, angles[0], motion.speed_at(0.0)).is_some());
        let damping = if damps {
            sample(frame, n, |j| sum(teeth().filter_map(|t| cut.damping(t, angles[j], motion.speed_at(times[j])))))
        } else {
            Vec::new()
        };
        let known = responses.iter().find(|r| r.nodes == n && (r.duration - duration).abs() <= 1e-13 * duration);
        let response = known.cloned().unwrap_or_else(|| {
            let response = Arc::new(Response::new(modes, duration, n, damps));
            responses.push(response.clone());
            response
        });
        elements.push(Element { response, terms, damping });
    }
    Period::new(modes.clone(), plan, elements)
}

impl Motion {
    /// Like [`Motion::time_at`] for an angle that may lie before the period that starts at 0.
    fn time_at_wrapped(self, angle: f64, turn: f64, period: f64) -> f64 {
        if angle < 0.0 { self.time_at(angle + turn) - period } else { self.time_at(angle) }
    }
}

/// Sum of matrices.
fn sum(matrices: impl Iterator<Item = [f64; 4]>) -> [f64; 4] {
    matrices.fold([0.0; 4], |a, b| [a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]])
}

/// Samples a matrix at the nodes, in the layout of a [`Term`].
fn sample(frame: &Frame, nodes: usize, matrix: impl Fn(usize) -> [f64; 4]) -> Vec<f64> {
    let blocks = frame.modes.channels * frame.modes.channels;
    let mut samples = vec![0.0; blocks * nodes];
    for j in 0..nodes {
        let projected = frame.project(matrix(j));
        for block in 0..blocks {
            samples[block * nodes + j] = projected[block];
        }
    }
    samples
}

/// Where the displacement at `time` (before the slot `reader`, possibly in the period before) is.
fn locate(slots: &[Slot], reader: usize, time: f64, period: f64) -> PastSample {
    let present = time >= 0.0;
    let (time, candidates) = if present { (time, &slots[..reader]) } else { (time + period, slots) };
    let outside = |slot: &Slot| (slot.start - time).max(time - slot.end).max(0.0);
    let nearest = |(_, a): &(usize, &Slot), (_, b): &(usize, &Slot)| outside(a).total_cmp(&outside(b));
    let (element, slot) = match candidates.iter().enumerate().min_by(nearest) {
        Some(found) => found,
        // Rounding at the very start: the surface is the end of the period before.
        None => return locate(slots, reader, time - period, period),
    };
    let local = ((time - slot.start) / (slot.end - slot.start)).clamp(0.0, 1.0);
    PastSample { element, present, weights: Rule::of(slot.nodes).interpolation(local) }
}
