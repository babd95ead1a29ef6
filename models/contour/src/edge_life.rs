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

/// Gear before the first section.
const NO_GEAR: usize = usize::MAX;

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
    /// The plan is that of complete enumeration while no gear needs more than `edge.levels` states.
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
            gear: NO_GEAR,
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
            let before: Vec<Label> =
                layers[step].iter().enumerate().map(|(from, label)| Label { from, changed: false, ..*label }).collect();
            // Coming from another gear costs the same whichever it is.
            let front = efficient(before.clone(), usize::MAX, weights.edge());
            let mut layer = Vec::new();
            for (gear, candidates) in by_wall[self.wall_of(i)].iter().enumerate() {
                let stays = |label: &&Label| label.gear == gear || label.gear == NO_GEAR;
                let mut entered: Vec<Label> = before.iter().filter(stays).copied().collect();
                entered.extend(
                    front
                        .iter()
                        .filter(|label| !stays(label))
                        .map(|label| Label { value: label.value + switch, ..*label }),
                );
                // Behind a change only what was paid counts, the edge thrown away included.
                let paid = |label: &Label| label.value + weights.edge() * label.left;
                let fresh = entered.iter().min_by(|a, b| paid(a).total_cmp(&paid(b))).map(|label| Label {
                    value: paid(label) + change,
                    left: 1.0,
                    wasted: label.wasted + label.left,
                    changed: true,
                    ..*label
                });
                entered.extend(fresh);
                let cut = |label: &Label, candidate: &Candidate| Label {
                    value: label.value + weights.value(candidate) * length,
                    left: label.left - candidate.life * length,
                    gear,
                    feed: candidate.feed,
                    ..*label
                };
                let all =
                    entered.iter().flat_map(|label| candidates.iter().map(move |candidate| cut(label, candidate)));
                let within: Vec<Label> = all.filter(|label| label.left >= -1e-12).collect();
                layer.extend(efficient(within, edge.levels.max(1), weights.edge()));
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

/// Labels that no other beats: in value and life left, for an edge that stays, or in what was
/// paid for work and edge together and life left, for an edge that will be changed. Of more than
/// `levels` of either kind, the best of every share of the life left.
fn efficient(labels: Vec<Label>, levels: usize, edge: f64) -> Vec<Label> {
    let mut kept = front(&labels, levels, |label| label.value);
    kept.extend(front(&labels, levels, |label| label.value + edge * label.left));
    kept.sort_unstable();
    kept.dedup();
    kept.into_iter().map(|i| labels[i]).collect()
}

/// Indices of the labels that no other beats in both `value` and life left.
fn front(labels: &[Label], levels: usize, value: impl Fn(&Label) -> f64) -> Vec<usize> {
    let mut order: Vec<usize> = (0..labels.len()).collect();
    order.sort_by(|a, b| {
        let (a, b) = (&labels[*a], &labels[*b]);
        value(a).total_cmp(&value(b)).then(b.left.total_cmp(&a.left))
    });
    let mut kept: Vec<usize> = Vec::new();
    for i in order {
        if kept.last().is_none_or(|last| labels[i].left > labels[*last].left) {
            kept.push(i);
        }
    }
    if kept.len() > levels {
        let (least, greatest) = (labels[kept[0]].left, labels[kept[kept.len() - 1]].left);
        let share = |i: usize| ((labels[i].left - least) / (greatest - least) * levels as f64).floor();
        kept.dedup_by(|later, earlier| share(*later) == share(*earlier));
    }
    kept
}
