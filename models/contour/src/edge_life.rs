//! Plans on an edge that is partly used: the state is the gear and the life left.

use crate::plan::Extras;
use crate::planner::Candidate;
use crate::{ContourError, Objective, Plan, Planner};

/// The edge that starts the contour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeLife {
    /// Share of its life that is left, 0 to 1.
    pub remaining: f64,
    /// Most states kept a gear; up to that many the plan is exact, beyond it the best of every
    /// share of the life left.
    pub levels: usize,
}

impl Default for EdgeLife {
    /// A fresh edge, 256 levels.
    fn default() -> Self {
        Self { remaining: 1.0, levels: 256 }
    }
}

/// A partial plan: value so far, life left, and the choice that led here.
#[derive(Clone, Copy)]
struct Label {
    value: f64,
    left: f64,
    wasted: f64,
    gear: usize,
    feed: usize,
    changed: bool,
    from: usize,
}

impl Planner<'_> {
    /// The best plan that never cuts with an edge beyond its life: before a section the edge may
    /// be changed, which takes the time of a change and throws the life left away.
    ///
    /// A partial plan is kept while no other of the same gear is better in both value and life
    /// left.
    ///
    /// # Errors
    /// As [`Planner::optimal`], and [`ContourError::EdgeTooShort`] where a section uses up more
    /// than a fresh edge.
    pub fn optimal_with_edge(&self, objective: Objective, edge: EdgeLife) -> Result<Plan, ContourError> {
        let weights = objective.weights(self);
        let machine = &self.parameters.machine;
        let switch = weights.second() * machine.speed_change_time;
        // The price of an edge contains the time of its change: only the clock sees it besides.
        let change = weights.time_only() * self.parameters.economics.edge_change_time;
        let by_wall: Vec<Vec<Vec<Candidate>>> = (0..self.wall_count())
            .map(|wall| (0..self.speeds.len()).map(|gear| self.efficient(wall, gear)).collect())
            .collect();
        let start = Label {
            value: 0.0,
            left: edge.remaining.clamp(0.0, 1.0),
            wasted: 0.0,
            gear: usize::MAX,
            feed: 0,
            changed: false,
            from: 0,
        };
        // Edges wear in the order of travel.
        let mut travel: Vec<usize> = (0..self.len()).collect();
        if self.backwards() {
            travel.reverse();
        }
        let mut layers: Vec<Vec<Label>> = vec![vec![start]];
        for (step, i) in travel.iter().copied().enumerate() {
            let length = self.centre_length(i);
            let before = &layers[step];
            let mut layer = Vec::new();
            for (gear, candidates) in by_wall[self.wall_of(i)].iter().enumerate() {
                let mut labels = Vec::new();
                for (from, prior) in before.iter().enumerate() {
                    let same = prior.gear == gear || prior.gear == usize::MAX;
                    let arrived = prior.value + if same { 0.0 } else { switch };
                    for candidate in candidates {
                        let used = candidate.life * length;
                        let value = arrived + weights.value(candidate) * length;
                        let kept = Label {
                            value,
                            left: prior.left - used,
                            gear,
                            feed: candidate.feed,
                            changed: false,
                            from,
                            ..*prior
                        };
                        let fresh = Label {
                            value: value + change + weights.edge() * prior.left,
                            left: 1.0 - used,
                            wasted: prior.wasted + prior.left,
                            changed: true,
                            ..kept
                        };
                        labels.extend([kept, fresh].into_iter().filter(|label| label.left >= -1e-12));
                    }
                }
                layer.extend(efficient(labels, edge.levels.max(1)));
            }
            if layer.is_empty() {
                let nothing = by_wall[self.wall_of(i)].iter().all(Vec::is_empty);
                return Err(if nothing { self.empty_set(i) } else { ContourError::EdgeTooShort { section: i } });
            }
            layers.push(layer);
        }
        let last = &layers[self.len()];
        let mut at = 0;
        for (i, label) in last.iter().enumerate() {
            if label.value < last[at].value {
                at = i;
            }
        }
        let wasted_life = last[at].wasted;
        let mut settings = vec![self.setting(0, 0); self.len()];
        let mut edge_changes = Vec::new();
        for (layer, i) in layers[1..].iter().zip(&travel).rev() {
            let label = layer[at];
            settings[*i] = self.setting(label.gear, label.feed);
            if label.changed {
                edge_changes.push(*i);
            }
            at = label.from;
        }
        edge_changes.reverse();
        Ok(self.assemble(&settings, Extras { edge_changes, wasted_life, ..Extras::default() }))
    }
}

/// Labels that no other beats in both value and life left; of more than `levels`, the best of
/// every share of the life left.
fn efficient(mut labels: Vec<Label>, levels: usize) -> Vec<Label> {
    labels.sort_by(|a, b| a.value.total_cmp(&b.value).then(b.left.total_cmp(&a.left)));
    let mut kept: Vec<Label> = Vec::new();
    for label in labels {
        if kept.last().is_none_or(|last| label.left > last.left) {
            kept.push(label);
        }
    }
    if kept.len() > levels {
        let (least, greatest) = (kept[0].left, kept[kept.len() - 1].left);
        let share = |label: &Label| ((label.left - least) / (greatest - least) * levels as f64).floor();
        kept.dedup_by(|later, earlier| share(later) == share(earlier));
    }
    kept
}
