//! Plans with ramps on an edge that is partly used: the state is gear, feed and life left.

use crate::edge_life::{Label, efficient};
use crate::wall::Candidate;
use crate::{ContourError, EdgeLife, Objective, Plan, Planner};

impl Planner<'_> {
    /// The best plan with limited acceleration that never cuts with an edge beyond its life: the
    /// ramps of [`Planner::optimal_with_ramps`], the edge changes of
    /// [`Planner::optimal_with_edge`]. A change of edge happens at rest, like a change of spindle
    /// speed.
    ///
    /// The plan is that of complete enumeration while no gear and feed need more than
    /// `edge.levels` states. An edge that outlasts the contour at any setting needs none, and the
    /// plan is that with ramps; else twenty sections take seconds, because the states are gears
    /// times feeds times levels.
    ///
    /// # Errors
    /// As both.
    pub fn optimal_with_ramps_and_edge(&self, objective: Objective, edge: EdgeLife) -> Result<Plan, ContourError> {
        let weights = objective.weights(self);
        let (machine, teeth) = (&self.parameters.machine, self.parameters.cutter.teeth);
        let (second, price) = (weights.second(), weights.edge());
        let switch = second * machine.speed_change_time;
        let change = weights.time_only() * self.parameters.economics.edge_change_time;
        let by_wall: Vec<Vec<Vec<Candidate>>> = (0..self.wall_count())
            .map(|wall| (0..self.speeds.len()).map(|gear| self.admissible(wall, gear)).collect())
            .collect();
        let most_used: f64 = (0..self.len())
            .map(|i| {
                let lives = by_wall[self.wall_of(i)].iter().flatten().map(|candidate| candidate.life);
                lives.fold(0.0, f64::max) * self.centre_length(i)
            })
            .sum();
        if most_used <= edge.remaining {
            return self.optimal_with_ramps(objective);
        }
        let feed_of = |gear: usize, feed: usize| self.setting(gear, feed).feed(teeth);
        let lost = |label: &Label, time: f64| Label {
            value: label.value + second * time,
            ramps: label.ramps + time,
            ..*label
        };
        let travel = self.travel();
        let mut layers: Vec<Vec<Label>> = vec![vec![Label::start(edge)]];
        for (step, i) in travel.iter().copied().enumerate() {
            let length = self.centre_length(i);
            let before: Vec<Label> =
                layers[step].iter().enumerate().map(|(from, label)| Label { from, changed: false, ..*label }).collect();
            // The contour begins and ends without ramps; at a sharp corner the move around it
            // takes them.
            let first = step == 0;
            let free = first || {
                let joint = travel[step - 1].min(i);
                self.contour.corners.iter().any(|corner| corner.after == joint)
            };
            let room = if first { 0.0 } else { 0.5 * self.centre_length(travel[step - 1]) };
            let ramp = |from: f64, to: f64| if free { 0.0 } else { machine.ramp_time(from, to) };
            let fits = |from: f64, to: f64| {
                let space = if from > to { room } else { 0.5 * length };
                free || machine.ramp_length(from, to) <= space
            };
            let speed_before = |label: &Label| if first { 0.0 } else { feed_of(label.gear, label.feed) };
            let stopped: Vec<Label> = before
                .iter()
                .filter(|label| fits(speed_before(label), 0.0))
                .map(|label| lost(label, ramp(speed_before(label), 0.0)))
                .collect();
            // Whoever could have stayed in gear need not come to rest: the best of all will do.
            let front = efficient(stopped.clone(), usize::MAX, price);
            let mut layer = Vec::new();
            for (gear, candidates) in by_wall[self.wall_of(i)].iter().enumerate() {
                let same: Vec<&Label> = before.iter().filter(|label| first || label.gear == gear).collect();
                let switched = |label: &Label| Label { value: label.value + switch, ..*label };
                let in_gear = |label: &Label| if first || label.gear == gear { *label } else { switched(label) };
                let paid = |label: &Label| label.paid(price);
                let fresh = stopped.iter().map(in_gear).min_by(|a, b| paid(a).total_cmp(&paid(b))).map(|label| {
                    let fresh = label.renewed(price);
                    Label { value: fresh.value + change, ..fresh }
                });
                let from_rest: Vec<Label> =
                    front.iter().filter(|label| !first && label.gear != gear).map(switched).chain(fresh).collect();
                for candidate in candidates {
                    let feed = feed_of(gear, candidate.feed);
                    let running = same.iter().filter(|label| fits(speed_before(label), feed));
                    let mut entered: Vec<Label> =
                        running.map(|label| lost(label, ramp(speed_before(label), feed))).collect();
                    if fits(0.0, feed) {
                        entered.extend(from_rest.iter().map(|label| lost(label, ramp(0.0, feed))));
                    }
                    let cut = entered.iter().map(|label| label.cut(candidate, gear, length, &weights));
                    let within: Vec<Label> = cut.filter(Label::lasted).collect();
                    layer.extend(efficient(within, edge.levels.max(1), price));
                }
            }
            if layer.is_empty() {
                let candidates = || by_wall[self.wall_of(i)].iter().flatten();
                return Err(if candidates().next().is_none() {
                    self.empty_set(i)
                } else if candidates().all(|candidate| candidate.life * length > 1.0) {
                    ContourError::EdgeTooShort { section: self.pieces()[i].section }
                } else {
                    ContourError::NoRamp { section: self.pieces()[i].section }
                });
            }
            layers.push(layer);
        }
        Ok(self.traced_back(&layers, &travel))
    }
}
