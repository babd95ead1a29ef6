//! Plans whose feeds can be reached: the state is the gear and the feed.

use crate::plan::Extras;
use crate::wall::Candidate;
use crate::{ContourError, Objective, Plan, Planner};

/// A state behind a section: value so far, and the state before.
#[derive(Clone, Copy)]
struct State {
    gear: usize,
    candidate: Candidate,
    feed: f64,
    value: f64,
    /// Time lost in ramps so far, s.
    ramps: f64,
    from: usize,
}

impl Planner<'_> {
    /// The best plan with limited acceleration: between sections the feed changes in a ramp
    /// within half of the faster one, a change of spindle speed happens at rest.
    ///
    /// The ramp from V_l to V_h loses `(V_h − V_l)²/(2·a·V_h)` against an instantaneous change.
    /// At a sharp corner the move around it takes the ramps.
    ///
    /// # Errors
    /// As [`Planner::optimal`], and [`ContourError::NoRamp`] where sections are too short for any
    /// ramp to an admissible feed.
    pub fn optimal_with_ramps(&self, objective: Objective) -> Result<Plan, ContourError> {
        let weights = objective.weights(self);
        let machine = &self.parameters.machine;
        let teeth = self.parameters.cutter.teeth;
        let second = weights.second();
        let by_wall: Vec<Vec<Vec<Candidate>>> = (0..self.wall_count())
            .map(|wall| (0..self.speeds.len()).map(|gear| self.admissible(wall, gear)).collect())
            .collect();
        let mut layers: Vec<Vec<State>> = Vec::with_capacity(self.len());
        for i in 0..self.len() {
            let length = self.centre_length(i);
            let corner = i > 0 && self.contour.corners.iter().any(|corner| corner.after == i - 1);
            let mut layer: Vec<State> = Vec::new();
            for (gear, candidates) in by_wall[self.wall_of(i)].iter().enumerate() {
                for candidate in candidates {
                    let feed = self.setting(gear, candidate.feed).feed(teeth);
                    let here = weights.value(candidate) * length;
                    layer.push(State { gear, candidate: *candidate, feed, value: here, ramps: 0.0, from: usize::MAX });
                }
            }
            if layer.is_empty() {
                return Err(self.empty_set(i));
            }
            if let Some(before) = layers.last() {
                let room = 0.5 * self.centre_length(i - 1);
                // Coming to rest does not depend on what follows: its best predecessor is one.
                let mut rest: Option<(f64, usize, f64)> = None;
                for (from, state) in before.iter().enumerate() {
                    let ramp = if corner { 0.0 } else { machine.ramp_time(state.feed, 0.0) };
                    let value = state.value + second * (ramp + machine.speed_change_time);
                    let fits = corner || machine.ramp_length(state.feed, 0.0) <= room;
                    if fits && rest.is_none_or(|(least, ..)| value < least) {
                        rest = Some((value, from, ramp));
                    }
                }
                layer.retain_mut(|state| {
                    let mut best: Option<(f64, usize, f64)> = None;
                    for (from, prior) in before.iter().enumerate().filter(|(_, prior)| prior.gear == state.gear) {
                        let ramp = if corner { 0.0 } else { machine.ramp_time(prior.feed, state.feed) };
                        let space = if prior.feed > state.feed { room } else { 0.5 * length };
                        let fits = corner || machine.ramp_length(prior.feed, state.feed) <= space;
                        let value = prior.value + second * ramp;
                        if fits && best.is_none_or(|(least, ..)| value < least) {
                            best = Some((value, from, ramp));
                        }
                    }
                    let start = if corner { 0.0 } else { machine.ramp_time(state.feed, 0.0) };
                    if let Some((value, from, ramp)) = rest
                        && before[from].gear != state.gear
                        && (corner || machine.ramp_length(state.feed, 0.0) <= 0.5 * length)
                        && best.is_none_or(|(least, ..)| value + second * start < least)
                    {
                        best = Some((value + second * start, from, ramp + start));
                    }
                    let Some((value, from, ramp)) = best else { return false };
                    *state = State { value: state.value + value, ramps: before[from].ramps + ramp, from, ..*state };
                    true
                });
                if layer.is_empty() {
                    return Err(ContourError::NoRamp { section: self.pieces()[i].section });
                }
            }
            layers.push(layer);
        }
        let mut best = 0;
        let last = &layers[layers.len() - 1];
        for (i, state) in last.iter().enumerate() {
            if state.value < last[best].value {
                best = i;
            }
        }
        let ramp_time = last[best].ramps;
        let mut settings = Vec::with_capacity(self.len());
        for layer in layers.iter().rev() {
            let state = layer[best];
            settings.push(self.setting(state.gear, state.candidate.feed));
            best = state.from;
        }
        settings.reverse();
        Ok(self.assemble(&settings, Extras { ramp_time, ..Extras::default() }))
    }
}
