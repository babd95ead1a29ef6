//! Lives by the block, in parallel.

use super::edge::{Draws, LEVELS, Outcome};
use super::points::Points;
use super::tally::{Digest, Sketch, Sums};
use super::{Cell, End, Study};
use serde::{Deserialize, Serialize};
use std::sync::atomic::{AtomicU64, Ordering};

/// Lives that a thread takes at a time: a few milliseconds at most, so that threads end together.
const BLOCK: u64 = 8;
/// Lives of a cell whose wear curves are kept, from the first.
pub const CURVES: u64 = 20_000;

/// Time that stands for none in a sketch of times, s.
const SOONEST: f64 = 1e-3;

/// What is kept of the lives of one cell.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Tally {
    /// Lives, s.
    pub life: Sums,
    /// Cutting paths, m.
    pub path: Sums,
    /// Lives of each end, in the order of [`End::ALL`].
    pub ends: Vec<Sketch>,
    /// Paths.
    pub paths: Sketch,
    /// First passages of the wear levels, s, of the first [`CURVES`] lives.
    pub passages: Vec<Sketch>,
    /// Cycles of replacement at each level, of the same lives.
    pub cycles: Vec<WearCycles>,
    /// Lives and squared weights, for importance sampling.
    pub weights: Sums,
    /// Weight of edges that failed before the early age of the study, and 0 for the others.
    pub early: Sums,
    /// Hash of all lives.
    pub digest: Digest,
}

/// Cycles of edges that are replaced when their wear passes a level.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WearCycles {
    /// One where the edge failed before.
    pub failed: Sums,
    /// Time in cut until then.
    pub length: Sums,
}

impl Tally {
    /// Adds a life.
    pub fn push(&mut self, index: u64, outcome: &Outcome, study: &Study) {
        if self.ends.is_empty() {
            self.ends = vec![Sketch::default(); End::ALL.len()];
            self.passages = vec![Sketch::default(); LEVELS];
            self.cycles = vec![WearCycles::default(); LEVELS];
        }
        let weight = outcome.weight;
        self.life.push(outcome.life, weight);
        self.path.push(outcome.path, weight);
        self.weights.push(weight, 1.0);
        self.paths.push(outcome.path, weight);
        let fails_early = outcome.life < study.early && !outcome.end.censored();
        self.early.push(if fails_early { weight } else { 0.0 }, 1.0);
        let end = End::ALL.iter().position(|end| *end == outcome.end).unwrap_or(0);
        self.ends[end].push(outcome.life, weight);
        let words = [index, outcome.life.to_bits(), outcome.path.to_bits(), end as u64];
        self.digest.push(&words);
        if index < CURVES {
            for ((passage, sketch), cycles) in outcome.passages.iter().zip(&mut self.passages).zip(&mut self.cycles) {
                if passage.is_finite() {
                    // An edge that was mounted with more wear passed the level at once.
                    sketch.push(passage.max(SOONEST), weight);
                }
                // An edge that reaches the level at its very end is spent, not replaced.
                let in_time = *passage < outcome.life;
                let failed = !in_time && study.ends.failure.is_failure(outcome.end);
                cycles.failed.push(f64::from(u8::from(failed)), weight);
                cycles.length.push(passage.min(outcome.life), weight);
            }
        }
    }

    /// Adds the lives of another part.
    pub fn merge(&mut self, other: &Self) {
        if self.ends.is_empty() {
            *self = other.clone();
            return;
        }
        if other.ends.is_empty() {
            return;
        }
        self.life.merge(&other.life);
        self.path.merge(&other.path);
        self.weights.merge(&other.weights);
        self.paths.merge(&other.paths);
        self.early.merge(&other.early);
        self.digest.merge(&other.digest);
        let sketches = [(&mut self.ends, &other.ends), (&mut self.passages, &other.passages)];
        for (merged, others) in sketches {
            merged.iter_mut().zip(others).for_each(|(merged, other)| merged.merge(other));
        }
        for (cycle, other) in self.cycles.iter_mut().zip(&other.cycles) {
            cycle.failed.merge(&other.failed);
            cycle.length.merge(&other.length);
        }
    }

    /// Time at which a share of all edges has passed a level of wear, s; NaN where fewer do.
    pub fn passage(&self, level: usize, share: f64) -> f64 {
        let (Some(passed), Some(cycles)) = (self.passages.get(level), self.cycles.get(level)) else { return f64::NAN };
        let all = cycles.length.weight();
        if passed.weight() < share * all { f64::NAN } else { passed.quantile(share * all / passed.weight()) }
    }

    /// Standard error of the mean life, s.
    pub fn standard_error(&self) -> f64 {
        (self.life.variance() / self.effective()).sqrt()
    }

    /// Effective number of lives under weights, (Σw)²/Σw².
    pub fn effective(&self) -> f64 {
        let (mean, n) = (self.weights.mean(), self.weights.count() as f64);
        let squares = self.weights.variance() * (n - 1.0) / n + mean * mean;
        n * mean * mean / squares
    }
}

/// Lives `from..to` of a cell; the outcomes in the order of their numbers, if they are wanted.
///
/// Every thread takes the next block that nobody has, and keeps one tally: tallies merge to the same
/// bits whoever lived which edge.
pub fn lives(study: &Study, cell: &Cell, from: u64, to: u64, keep: bool) -> (Tally, Vec<Outcome>) {
    let next = AtomicU64::new(from);
    let take = || Some(next.fetch_add(BLOCK, Ordering::Relaxed)).filter(|start| *start < to);
    let parts = rayon::broadcast(|_| {
        let points = Points::new(study.sampling, study.seed, study.lives);
        let mut point = vec![0.0; study.dimensions()];
        let (mut tally, mut blocks) = (Tally::default(), Vec::new());
        while let Some(start) = take() {
            let mut outcomes = Vec::new();
            for index in start..to.min(start + BLOCK) {
                points.at(index, &mut point);
                if let Some(copula) = &study.copula {
                    copula.apply(&mut point);
                }
                let outcome = study.live(cell, index, &point, &mut Draws::of(study.seed, index));
                tally.push(index, &outcome, study);
                if keep {
                    outcomes.push(outcome);
                }
            }
            if keep {
                blocks.push((start, outcomes));
            }
        }
        (tally, blocks)
    });
    let mut tally = Tally::default();
    let mut blocks = Vec::new();
    for (part, rows) in parts {
        tally.merge(&part);
        blocks.extend(rows);
    }
    blocks.sort_unstable_by_key(|(start, _)| *start);
    (tally, blocks.into_iter().flat_map(|(_, outcomes)| outcomes).collect())
}

/// Lives of the pilot from which the number of lives for a precision is reckoned (assumption).
const PILOT: u64 = 2000;
/// Two-sided 95 % quantile of the normal law.
const Z: f64 = 1.959_964;

/// Lives that bring the half-width of every mean life to the share `relative` of it, by the scatter of a pilot; at
/// most those of the study.
///
/// # Source
/// C. Stein, Annals of Mathematical Statistics 16 (1945) 243.
pub fn enough(study: &Study, relative: f64) -> u64 {
    let pilot = PILOT.min(study.lives);
    let needed = study.cells.iter().map(|cell| {
        let cv = lives(study, cell, 0, pilot, false).0.life.variation();
        (Z * cv / relative).powi(2).ceil() as u64
    });
    needed.max().unwrap_or(pilot).clamp(pilot, study.lives)
}

#[cfg(test)]
mod tests;
