//! Parts that wait for each other's places.
//!
//! Of all jobs that hold a place and wait, those are struck out again and again of which some wanted place is
//! free, or is held by one that is struck out or still active: at work, or with a machine that is down or off
//! shift. Those that are left (the greatest fixed point) can never move. A search for a circle alone would be
//! wrong where a job may choose among several machines or places. A card of a loop is a place in this sense: a job that
//! waits for one can move when a card is there or may come back, which needs all jobs that share it to move.

use super::cards::loops_in;
use super::recorder::Recorder;
use super::{Shop, ShopError};
use std::collections::BTreeSet;
use toolroom_scenario::{Blocking, Deadlock};

/// What a job holds and others want.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Holder {
    /// A machine, or the place before it.
    Machine(usize),
    /// A card of a loop.
    Loop(usize),
}

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
        let machines: Option<Vec<(usize, u32)>> = circle
            .iter()
            .map(|(place, slot)| match place {
                Holder::Machine(machine) => Some((*machine, *slot)),
                Holder::Loop(_) => None,
            })
            .collect();
        if let (Deadlock::Swap, Some(machines)) = (self.scenario.deadlock, &machines) {
            self.swap(machines);
            return Ok(true);
        }
        let holds = |(place, slot): (Holder, u32), wants: Holder| {
            let name = |holder: Holder| match holder {
                Holder::Machine(machine) => self.scenario.machines[machine].name.clone(),
                Holder::Loop(index) => format!("a card of \"{}\"", self.scenario.control.loops[index].name),
            };
            let verb = match place {
                Holder::Machine(_) => format!("{} holds {}", name(place), self.label(slot)),
                Holder::Loop(_) => format!("{} has {}", self.label(slot), name(place)),
            };
            match place {
                Holder::Machine(_) => format!("{verb} that wants {}", name(wants)),
                Holder::Loop(_) => format!("{verb} and wants {}", name(wants)),
            }
        };
        let after = circle.iter().cycle().skip(1);
        let words: Vec<String> = circle.iter().zip(after).map(|(own, next)| holds(*own, next.0)).collect();
        let (time, circle) = (self.now().seconds(), words.join("; "));
        Err(if machines.is_some() {
            ShopError::Deadlock { time, circle }
        } else {
            ShopError::CardDeadlock { time, circle }
        })
    }

    /// Jobs that wait in a place which others may want.
    fn candidates(&self) -> BTreeSet<u32> {
        let flow = &self.world.flow;
        let waiting = |slot: &u32| self.world.jobs.at(*slot).waiting;
        let standing = flow.buffers.iter().flatten().copied().filter(waiting);
        let up = |machine: u32| self.world.machines[machine as usize].is_up();
        let held = flow.held.iter().filter(|held| held.output.is_some() || up(held.machine)).map(|held| held.slot);
        // Those who wait for a card, and those who may have one, wherever they stand.
        let carded = (0..self.world.jobs.places()).filter(|_| self.has_cards());
        let carded = carded.filter(|slot| self.world.jobs.get(*slot).is_some_and(|job| job.parked || job.waiting));
        standing.chain(held).chain(carded).chain(self.travelling()).collect()
    }

    /// Whether some place that a job wants is free, or held by one that may move.
    fn may_move(&self, slot: u32, stuck: &BTreeSet<u32>) -> bool {
        if self.world.jobs.at(slot).parked {
            return loops_in(self.needs(slot)).all(|index| self.has_card(index) || self.returns(index, stuck));
        }
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
            let Some(next) = operations.get(job.next_operation(operations.len())) else { return true };
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

    /// Whether a card of a loop may come back: all jobs that have it together may move.
    fn returns(&self, index: usize, stuck: &BTreeSet<u32>) -> bool {
        self.holders(index).any(|members| members.iter().all(|slot| !stuck.contains(slot)))
    }

    /// Jobs that have a card of a loop, those with one card together.
    fn holders(&self, index: usize) -> impl Iterator<Item = &[u32]> {
        let tickets = self.world.cards.tickets.iter();
        tickets.filter(move |own| own.held >> index & 1 == 1).map(|own| own.members.as_slice())
    }

    /// The loop of whose cards none comes back to a job that waits for one, and a job that has one of them.
    pub(super) fn card_in_vain(&self, slot: u32, stuck: &BTreeSet<u32>) -> Option<(usize, u32)> {
        if !self.world.jobs.at(slot).parked {
            return None;
        }
        let gone = |index: &usize| !self.has_card(*index) && !self.returns(*index, stuck);
        let index = loops_in(self.needs(slot)).find(gone)?;
        let member = self.holders(index).flatten().find(|slot| stuck.contains(slot))?;
        Some((index, *member))
    }

    /// Jobs that cannot move, each with what it holds; each wants that of the next one.
    fn circle(&self, stuck: &BTreeSet<u32>) -> Vec<(Holder, u32)> {
        let before = self.scenario.blocking == Blocking::BeforeService;
        let next = |(_, slot): (Holder, u32)| {
            if let Some((index, member)) = self.card_in_vain(slot, stuck) {
                return (Holder::Loop(index), member);
            }
            let (machine, slot) = if before {
                let job = self.world.jobs.at(slot);
                let operations = &self.scenario.parts[job.row.part as usize].operations;
                let machine = operations[job.next_operation(operations.len())].machines[0];
                let buffer = self.input(machine).expect("only limited places are wanted in vain");
                (machine, self.world.flow.buffers[buffer][0])
            } else {
                let machine = self.next_machines(slot)[0];
                (machine, self.world.machines[machine].blocked.expect("a machine that is wanted in vain is blocked"))
            };
            (Holder::Machine(machine), slot)
        };
        let start = *stuck.first().expect("a deadlock has jobs");
        // From whatever job it begins, the walk comes to the circle.
        let mut walk = vec![next((Holder::Machine(0), start))];
        loop {
            let further = next(walk[walk.len() - 1]);
            if let Some(first) = walk.iter().position(|(_, slot)| *slot == further.1) {
                let mut circle = walk.split_off(first);
                circle[0] = further;
                let least = circle.iter().map(|(place, _)| *place).min();
                let begin = circle.iter().position(|(place, _)| Some(*place) == least).unwrap_or(0);
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
