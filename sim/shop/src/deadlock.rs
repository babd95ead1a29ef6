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
use crate::runlog::LogEvent;
use std::collections::BTreeSet;
use toolroom_scenario::Blocking;

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
        self.name_circle(&stuck)
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
        let opens = |buffer: usize| self.would_fit(buffer, slot, |standing| stuck.contains(&standing));
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
            self.log_event(LogEvent::Swap, Some(machine), Some(self.world.jobs.at(slot).number), None);
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
