//! The period map of a regenerative cut, by spectral collocation of the stretches in cut and the
//! exact response in free flight.

use crate::response::{Modes, Response};
use std::sync::Arc;
use toolroom_spectral::{Factors, LinearMap, dot, subtract, subtract_columns};

/// Force of some teeth in cut: `−depth gain(t) (u(t) − u(past))`.
#[derive(Clone, Debug)]
pub(crate) struct Term {
    /// Block (a, b) of channels at node j: `gain[(a · channels + b) · nodes + j]`.
    pub gain: Vec<f64>,
    pub past: EarlierCut,
}

/// Where the displacement of the earlier cut is found.
#[derive(Clone, Debug)]
pub(crate) enum EarlierCut {
    /// At the same nodes one period ago.
    OnePeriodAgo,
    /// At a time of its own for every node.
    At(Vec<PastSample>),
}

/// An interpolated earlier displacement.
#[derive(Clone, Debug)]
pub(crate) struct PastSample {
    /// Element that holds it, counted among the elements of a period.
    pub element: usize,
    /// Whether it lies in the present period rather than in the one before.
    pub present: bool,
    /// Weights of the element's nodes.
    pub weights: Vec<f64>,
}

/// A stretch in cut.
#[derive(Clone, Debug)]
pub(crate) struct Element {
    pub response: Arc<Response>,
    pub terms: Vec<Term>,
    /// Damping by the cut per depth, laid out like a gain; empty without.
    pub damping: Vec<f64>,
}

/// What follows what in a period.
#[derive(Clone, Debug)]
pub(crate) enum Stretch {
    /// No tooth in cut: transition of every mode.
    Free(Vec<[f64; 4]>),
    /// The next element.
    Cut,
}

/// One period of a cut, ready for any depth.
#[derive(Clone, Debug)]
pub(crate) struct Period {
    pub modes: Modes,
    pub stretches: Vec<Stretch>,
    pub elements: Vec<Element>,
    /// Where each element's samples start in the vector of all samples.
    pub offsets: Vec<usize>,
}

impl Period {
    pub fn new(modes: Modes, stretches: Vec<Stretch>, elements: Vec<Element>) -> Self {
        let mut offsets = vec![0];
        for element in &elements {
            offsets.push(offsets[offsets.len() - 1] + element.response.samples);
        }
        Self { modes, stretches, elements, offsets }
    }

    fn samples(&self) -> usize {
        self.offsets[self.elements.len()]
    }
}

/// Storage for a period map, kept between depths.
#[derive(Default)]
pub(crate) struct MapStorage {
    factors: Vec<Factors>,
    force: Vec<f64>,
    /// The force with the other sign.
    against: Vec<f64>,
    rate: Vec<f64>,
    state: Vec<f64>,
}

/// The period map at one depth: samples of the last period and state at its end to those of the
/// next.
pub(crate) struct PeriodMap<'a> {
    period: &'a Period,
    depth: f64,
    storage: &'a mut MapStorage,
}

impl<'a> PeriodMap<'a> {
    pub fn new(period: &'a Period, depth: f64, storage: &'a mut MapStorage) -> Self {
        storage.factors.resize(period.elements.len(), Factors::default());
        for (element, factors) in period.elements.iter().zip(&mut storage.factors) {
            element.factorise(depth, period.modes.channels, factors);
        }
        Self { period, depth, storage }
    }
}

impl Element {
    /// Factors of `I + depth (K G + C G')`, the equation of the forces at the nodes.
    fn factorise(&self, depth: f64, channels: usize, factors: &mut Factors) {
        let Response { nodes, samples, displacement, rate, .. } = &*self.response;
        let (n, size) = (*nodes, *samples);
        let matrix = factors.begin(size);
        matrix.fill(0.0);
        let mut strength = Vec::new();
        let mut add = |gain: &[f64], response: &[f64]| {
            strength.clear();
            strength.extend(gain.iter().map(|gain| depth * gain));
            for (target, source) in matrix.chunks_exact_mut(size).zip(response.chunks_exact(size)) {
                for a in 0..channels {
                    for b in 0..channels {
                        let block = &strength[(a * channels + b) * n..][..n];
                        for ((t, g), s) in target[a * n..][..n].iter_mut().zip(block).zip(&source[b * n..][..n]) {
                            *t += g * s;
                        }
                    }
                }
            }
        };
        for term in &self.terms {
            add(&term.gain, displacement);
        }
        if !self.damping.is_empty() {
            add(&self.damping, rate);
        }
        for diagonal in 0..size {
            matrix[diagonal * (size + 1)] += 1.0;
        }
        factors.factorise();
    }
}

impl LinearMap for PeriodMap<'_> {
    fn size(&self) -> usize {
        self.period.samples() + self.period.modes.states()
    }

    fn apply(&mut self, x: &[f64], y: &mut [f64]) {
        let Self { period, depth, storage } = self;
        let MapStorage { factors, force, against, rate, state } = &mut **storage;
        let (past, start) = x.split_at(period.samples());
        let (present, end) = y.split_at_mut(period.samples());
        let channels = period.modes.channels;
        state.clear();
        state.extend_from_slice(start);
        let mut index = 0;
        for stretch in &period.stretches {
            if let Stretch::Free(transitions) = stretch {
                advance(state, transitions);
                continue;
            }
            let element = &period.elements[index];
            let response = &*element.response;
            let n = response.nodes;
            let (before, rest) = present.split_at_mut(period.offsets[index]);
            let here = &mut rest[..response.samples];
            here.fill(0.0);
            for (value, column) in state.iter().zip(response.free_displacement.chunks_exact(response.samples)) {
                subtract(here, -value, column);
            }
            force.clear();
            force.resize(response.samples, 0.0);
            let same = &past[period.offsets[index]..][..response.samples];
            for term in &element.terms {
                for b in 0..channels {
                    for j in 0..n {
                        let earlier = match &term.past {
                            EarlierCut::OnePeriodAgo => same[b * n + j],
                            EarlierCut::At(samples) => {
                                let sample = &samples[j];
                                let nodes = sample.weights.len();
                                let history: &[f64] = if sample.present { before } else { past };
                                let start = period.offsets[sample.element] + b * nodes;
                                dot(&sample.weights, &history[start..start + nodes])
                            }
                        };
                        let difference = *depth * (earlier - here[b * n + j]);
                        for a in 0..channels {
                            force[a * n + j] += term.gain[(a * channels + b) * n + j] * difference;
                        }
                    }
                }
            }
            if !element.damping.is_empty() {
                rate.clear();
                rate.resize(response.samples, 0.0);
                for (value, column) in state.iter().zip(response.free_rate.chunks_exact(response.samples)) {
                    subtract(rate, -value, column);
                }
                for a in 0..channels {
                    for b in 0..channels {
                        for j in 0..n {
                            let damping = element.damping[(a * channels + b) * n + j];
                            force[a * n + j] -= *depth * damping * rate[b * n + j];
                        }
                    }
                }
            }
            factors[index].solve(force);
            // Negated once, so that `here − (−value) column` is what it was.
            against.clear();
            against.extend(force.iter().map(|value| -value));
            subtract_columns(here, against, &response.displacement);
            advance(state, &response.end_free);
            for (value, row) in state.iter_mut().zip(response.end_forced.chunks_exact(response.samples)) {
                *value += dot(row, force);
            }
            index += 1;
        }
        end.copy_from_slice(state);
    }
}

/// Moves every mode's (q, q'/w) on without force.
fn advance(state: &mut [f64], transitions: &[[f64; 4]]) {
    for (pair, [a, b, c, d]) in state.chunks_exact_mut(2).zip(transitions) {
        (pair[0], pair[1]) = (a * pair[0] + b * pair[1], c * pair[0] + d * pair[1]);
    }
}
