//! Plans on an edge that is partly used: the state is the gear and the life left.

use crate::plan::Extras;
use crate::search::Weights;
use crate::wall::Candidate;
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
pub(crate) struct Label {
    pub value: f64,
    pub left: f64,
    pub wasted: f64,
    /// Time lost in ramps so far, s; 0 where ramps are not planned.
    pub ramps: f64,
    pub gear: usize,
    pub feed: usize,
    pub changed: bool,
    pub from: usize,
}

impl Label {
    /// Nothing cut yet.
    pub fn start(edge: EdgeLife) -> Self {
        let left = edge.remaining.clamp(0.0, 1.0);
        Self { value: 0.0, left, wasted: 0.0, ramps: 0.0, gear: NO_GEAR, feed: 0, changed: false, from: 0 }
    }

    /// What was paid if the edge is thrown away now, at a price of `edge`.
    pub fn paid(&self, edge: f64) -> f64 {
        self.value + edge * self.left
    }

    /// The same with a fresh edge.
    pub fn renewed(&self, edge: f64) -> Self {
        Self { value: self.paid(edge), left: 1.0, wasted: self.wasted + self.left, changed: true, ..*self }
    }

    /// A section of `length` cut with `candidate`.
    pub fn cut(&self, candidate: &Candidate, gear: usize, length: f64, weights: &Weights) -> Self {
        Self {
            value: self.value + weights.value(candidate) * length,
            left: self.left - candidate.life * length,
            gear,
            feed: candidate.feed,
            ..*self
        }
    }

    /// Whether the edge lasted.
    pub fn lasted(&self) -> bool {
        self.left >= -1e-12
    }
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
        let travel = self.travel();
        let mut layers: Vec<Vec<Label>> = vec![vec![Label::start(edge)]];
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
                let paid = |label: &&Label| label.paid(weights.edge());
                let fresh = entered.iter().min_by(|a, b| paid(a).total_cmp(&paid(b))).map(|label| {
                    let fresh = label.renewed(weights.edge());
                    Label { value: fresh.value + change, ..fresh }
                });
                entered.extend(fresh);
                let cut = |label: &Label, candidate: &Candidate| label.cut(candidate, gear, length, &weights);
                let all =
                    entered.iter().flat_map(|label| candidates.iter().map(move |candidate| cut(label, candidate)));
                let within: Vec<Label> = all.filter(Label::lasted).collect();
                layer.extend(efficient(within, edge.levels.max(1), weights.edge()));
            }
            if layer.is_empty() {
                let nothing = by_wall[self.wall_of(i)].iter().all(Vec::is_empty);
                return Err(if nothing {
                    self.empty_set(i)
                } else {
                    ContourError::EdgeTooShort { section: self.pieces()[i].section }
                });
            }
            layers.push(layer);
        }
        Ok(self.traced_back(&layers, &travel))
    }

    /// Sections in the order of travel, in which edges wear.
    pub(crate) fn travel(&self) -> Vec<usize> {
        let mut travel: Vec<usize> = (0..self.len()).collect();
        if self.backwards() {
            travel.reverse();
        }
        travel
    }

    /// The plan that ends in the best label of the last layer; the first layer is the start.
    pub(crate) fn traced_back(&self, layers: &[Vec<Label>], travel: &[usize]) -> Plan {
        let last = &layers[self.len()];
        let mut best_label = 0;
        for (i, label) in last.iter().enumerate() {
            if label.value < last[best_label].value {
                best_label = i;
            }
        }
        let (wasted_life, ramp_time) = (last[best_label].wasted, last[best_label].ramps);
        let mut settings = vec![self.setting(0, 0); self.len()];
        let mut edge_changes = Vec::new();
        for (layer, i) in layers[1..].iter().zip(travel).rev() {
            let label = layer[best_label];
            settings[*i] = self.setting(label.gear, label.feed);
            if label.changed {
                edge_changes.push(*i);
            }
            best_label = label.from;
        }
        edge_changes.reverse();
        self.assemble(&settings, Extras { edge_changes, wasted_life, ramp_time })
    }
}

/// Labels that no other beats: in value and life left, for an edge that stays, or in what was
/// paid for work and edge together and life left, for an edge that will be changed. Of more than
/// `levels` of either kind, the best of every share of the life left.
pub(crate) fn efficient(labels: Vec<Label>, levels: usize, edge: f64) -> Vec<Label> {
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
