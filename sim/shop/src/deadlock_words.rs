//! The circle of a deadlock in words: who holds what, and wants what the next one holds.

use super::recorder::Recorder;
use super::{Shop, ShopError};
use std::collections::BTreeSet;
use toolroom_scenario::{Blocking, Deadlock};

/// What a job that can never move waits for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Want {
    /// The place on a machine.
    Machine(usize),
    /// A place before a machine.
    Buffer(usize),
    /// A card of a loop, by index.
    Card(usize),
    /// A fixture, by index.
    Fixture(usize),
}

/// A job of a circle: what it holds, and what it wants.
struct Stuck {
    slot: u32,
    holds: Want,
    wants: Want,
}

impl<R: Recorder> Shop<'_, R> {
    /// Names a circle of jobs that can never move, or lets them change places where they only need each other's places.
    pub(super) fn name_circle(&mut self, stuck: &BTreeSet<u32>) -> Result<bool, ShopError> {
        let circle = self.circle_of_wants(stuck);
        // A place before a machine is one on it where machines begin only with a place reserved.
        let reserves = self.scenario.blocking == Blocking::BeforeService;
        let place = |own: &Stuck| match own.holds {
            Want::Machine(machine) => Some((machine, own.slot)),
            Want::Buffer(machine) => Some((machine, own.slot)).filter(|_| reserves),
            Want::Fixture(_) | Want::Card(_) => None,
        };
        if self.scenario.deadlock == Deadlock::Swap
            && let Some(places) = circle.iter().map(place).collect::<Option<Vec<_>>>()
        {
            self.swap(&places);
            return Ok(true);
        }
        let (time, words) = (self.now().seconds(), circle.iter().map(|own| self.words_of(own)));
        let words = words.collect::<Vec<_>>().join("; ");
        let any = |of: fn(Want) -> bool| circle.iter().any(|own| of(own.wants));
        Err(if any(|want| matches!(want, Want::Fixture(_))) {
            ShopError::FixtureDeadlock { time, circle: words }
        } else if any(|want| matches!(want, Want::Card(_))) {
            ShopError::CardDeadlock { time, circle: words }
        } else {
            ShopError::Deadlock { time, circle: words }
        })
    }

    fn words_of(&self, own: &Stuck) -> String {
        let machine = |index: usize| self.scenario.machines[index].name.as_str();
        // Where machines begin only with a place reserved, that before a machine is named as the machine.
        let reserves = self.scenario.blocking == Blocking::BeforeService;
        let place = |want: Want| match want {
            Want::Buffer(index) if reserves => Want::Machine(index),
            Want::Buffer(_) | Want::Machine(_) | Want::Card(_) | Want::Fixture(_) => want,
        };
        let wants = match place(own.wants) {
            Want::Machine(index) => machine(index).to_owned(),
            Want::Buffer(index) => format!("a place before {}", machine(index)),
            Want::Card(index) => format!("a card of \"{}\"", self.scenario.control.loops[index].name),
            Want::Fixture(index) => format!("\"{}\"", self.scenario.shared.fixtures[index].name),
        };
        let label = self.label(own.slot);
        match place(own.holds) {
            Want::Machine(index) => format!("{} holds {label} that wants {wants}", machine(index)),
            Want::Buffer(index) => format!("{label} holds a place before {} and wants {wants}", machine(index)),
            Want::Card(index) => {
                format!("{label} has a card of \"{}\" and wants {wants}", self.scenario.control.loops[index].name)
            }
            Want::Fixture(index) => {
                format!("{label} holds \"{}\" and wants {wants}", self.scenario.shared.fixtures[index].name)
            }
        }
    }

    /// Jobs that can never move, each with what it wants, which the next one holds; what stands first in the file is named
    /// first.
    fn circle_of_wants(&self, stuck: &BTreeSet<u32>) -> Vec<Stuck> {
        let mut walk: Vec<(u32, Want)> = Vec::new();
        let mut slot = *stuck.first().expect("a deadlock has jobs");
        // From whatever job it begins, the walk comes to the circle.
        let circle = loop {
            let (want, next) = self.wanted_in_vain(slot, stuck).expect("a job that can never move waits for another");
            walk.push((slot, want));
            if let Some(first) = walk.iter().position(|(known, _)| *known == next) {
                break walk.split_off(first);
            }
            slot = next;
        };
        let before = circle.iter().cycle().skip(circle.len() - 1);
        let mut circle: Vec<Stuck> =
            circle.iter().zip(before).map(|(&(slot, wants), &(_, holds))| Stuck { slot, holds, wants }).collect();
        let first = (0..circle.len()).min_by_key(|&each| circle[each].holds).unwrap_or(0);
        circle.rotate_left(first);
        circle
    }

    /// What a job that can never move waits for, and one that holds it.
    fn wanted_in_vain(&self, slot: u32, stuck: &BTreeSet<u32>) -> Option<(Want, u32)> {
        if let Some((index, holder)) = self.card_in_vain(slot, stuck) {
            return Some((Want::Card(index), holder));
        }
        if let Some((fixture, holder)) = self.needs_in_vain(slot, stuck) {
            return Some((Want::Fixture(fixture), holder));
        }
        let job = self.world.jobs.at(slot);
        let operations = &self.scenario.parts[job.row.part as usize].operations;
        let ahead = self.scenario.blocking == Blocking::BeforeService;
        let index = if ahead { job.next_operation(operations.len()) } else { job.operation as usize };
        let machines = &operations.get(index)?.machines;
        machines.iter().find_map(|&machine| {
            let on_it = self.world.machines[machine].blocked.filter(|other| *other != slot && stuck.contains(other));
            let before = self.input(machine).map(|buffer| &self.world.flow.buffers[buffer]);
            let before = before.and_then(|standing| standing.iter().find(|other| stuck.contains(other)));
            let of_machine = on_it.map(|other| (Want::Machine(machine), other));
            of_machine.or(before.map(|other| (Want::Buffer(machine), *other)))
        })
    }
}
