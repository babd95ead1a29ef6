//! Parts that wait for each other's places.
//!
//! Of all jobs that hold a place and wait, those are struck out again and again of which some wanted place is
//! free, or is held by one that is struck out or still active: at work, or with a machine that is down or off
//! shift. Those that are left (the greatest fixed point) can never move. A search for a circle alone would be
//! wrong where a job may choose among several machines or places.

use super::recorder::Recorder;
use super::{Shop, ShopError};
use std::collections::BTreeSet;
use toolroom_scenario::{Blocking, Deadlock};

impl<R: Recorder> Shop<'_, R> {
    /// Looks for parts that can never move, where any was held up since the last look; true where some have
    /// changed places.
    pub(super) fn resolve_deadlock(&mut self) -> Result<bool, ShopError> {
        if !std::mem::take(&mut self.world.flow.suspect) {
            return Ok(false);
        }
        let mut stuck = self.candidates();
        loop {
            let kept: BTreeSet<u32> = stuck.iter().copied().filter(|slot| !self.may_move(*slot, &stuck)).collect();
            if kept.len() == stuck.len() {
                break;
            }
            stuck = kept;
        }
        if stuck.is_empty() {
            return Ok(false);
        }
        if self.has_fixtures() {
            return self.resolve_with_fixtures(&stuck);
        }
        let circle = self.circle(&stuck);
        match self.scenario.deadlock {
            Deadlock::Stop => {
                let holds = |(place, slot): (usize, u32), wants: usize| {
                    let name = |machine: usize| &self.scenario.machines[machine].name;
                    format!("{} holds {} that wants {}", name(place), self.label(slot), name(wants))
                };
                let after = circle.iter().cycle().skip(1);
                let words: Vec<String> = circle.iter().zip(after).map(|(own, next)| holds(*own, next.0)).collect();
                Err(ShopError::Deadlock { time: self.now().seconds(), circle: words.join("; ") })
            }
            Deadlock::Swap => {
                self.swap(&circle);
                Ok(true)
            }
        }
    }

    /// Jobs that wait in a place which others may want.
    fn candidates(&self) -> BTreeSet<u32> {
        let flow = &self.world.flow;
        let waiting = |slot: &u32| self.world.jobs.at(*slot).waiting;
        let standing = flow.buffers.iter().flatten().copied().filter(waiting);
        let up = |machine: u32| self.world.machines[machine as usize].is_up();
        let held = flow.held.iter().filter(|held| held.output.is_some() || up(held.machine)).map(|held| held.slot);
        standing.chain(held).chain(self.travelling()).collect()
    }

    /// Whether some place that a job wants is free, or held by one that may move.
    fn may_move(&self, slot: u32, stuck: &BTreeSet<u32>) -> bool {
        let flow = &self.world.flow;
        let opens = |buffer: usize| {
            self.has_room(buffer) || flow.buffers[buffer].iter().any(|standing| !stuck.contains(standing))
        };
        let job = self.world.jobs.at(slot);
        let equipped = self.needs_in_vain(slot, stuck).is_none();
        if self.scenario.blocking == Blocking::BeforeService {
            if !equipped {
                return false;
            }
            let operations = &self.scenario.parts[job.row.part as usize].operations;
            let Some(next) = operations.get(job.operation as usize + 1) else { return true };
            return next.machines.iter().any(|&machine| self.input(machine).is_none_or(opens));
        }
        let frees = |machine: usize| {
            let state = &self.world.machines[machine];
            !state.is_up() || state.blocked.is_none_or(|own| own == slot || !stuck.contains(&own))
        };
        if job.waiting {
            return equipped
                && self.next_machines(slot).iter().any(|&machine| self.input(machine) == job.buffer && frees(machine));
        }
        let behind = flow.held.iter().find(|held| held.slot == slot && held.output.is_none());
        let output = behind.and_then(|held| self.scenario.machines[held.machine as usize].output_buffer);
        output.is_some_and(opens)
            || self
                .next_machines(slot)
                .iter()
                .any(|&machine| self.input(machine).is_none_or(opens) || equipped && frees(machine))
    }

    /// Jobs that cannot move, each with the machine at which it stands; each wants the place of the next one.
    fn circle(&self, stuck: &BTreeSet<u32>) -> Vec<(usize, u32)> {
        let before = self.scenario.blocking == Blocking::BeforeService;
        let next = |(_, slot): (usize, u32)| {
            if before {
                let job = self.world.jobs.at(slot);
                let operations = &self.scenario.parts[job.row.part as usize].operations;
                let machine = operations[job.operation as usize + 1].machines[0];
                let buffer = self.input(machine).expect("only limited places are wanted in vain");
                (machine, self.world.flow.buffers[buffer][0])
            } else {
                let machine = self.next_machines(slot)[0];
                (machine, self.world.machines[machine].blocked.expect("a machine that is wanted in vain is blocked"))
            }
        };
        let start = *stuck.first().expect("a deadlock has jobs");
        // From whatever job it begins, the walk comes to the circle.
        let mut walk = vec![next((0, start))];
        loop {
            let further = next(walk[walk.len() - 1]);
            if let Some(first) = walk.iter().position(|(_, slot)| *slot == further.1) {
                let mut circle = walk.split_off(first);
                circle[0] = further;
                let least = circle.iter().map(|(machine, _)| *machine).min();
                let begin = circle.iter().position(|(machine, _)| Some(*machine) == least).unwrap_or(0);
                circle.rotate_left(begin);
                return circle;
            }
            walk.push(further);
        }
    }

    /// What people call a job.
    pub(super) fn label(&self, slot: u32) -> String {
        let job = self.world.jobs.at(slot);
        let part = &self.scenario.parts[job.row.part as usize].name;
        match job.row.order {
            Some(order) => self.scenario.orders[order as usize].id.clone(),
            None => format!("{part} {}", job.number),
        }
    }

    /// The parts of a circle change places in no time.
    pub(super) fn swap(&mut self, circle: &[(usize, u32)]) {
        self.world.flow.swaps += 1;
        for &(machine, slot) in circle {
            self.log_event("swap", Some(machine), Some(self.world.jobs.at(slot).number), None);
        }
        let of_circle = |slot: u32| circle.iter().any(|(_, own)| *own == slot);
        let (moving, rest): (Vec<_>, Vec<_>) =
            std::mem::take(&mut self.world.flow.held).into_iter().partition(|held| of_circle(held.slot));
        self.world.flow.held = rest;
        moving.iter().for_each(|held| self.let_go(*held));
        for &(_, slot) in circle {
            self.enter_swapped(slot);
        }
    }
}
