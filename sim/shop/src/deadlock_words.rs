//! The circle of a deadlock in which fixtures travel, in words.

use super::recorder::Recorder;
use super::{Shop, ShopError};
use std::collections::BTreeSet;
use toolroom_scenario::{Blocking, Deadlock};

/// What a job that can never move waits for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Want {
    /// A fixture, by index.
    Fixture(usize),
    /// The place on a machine.
    Machine(usize),
    /// A place before a machine.
    Buffer(usize),
}

impl<R: Recorder> Shop<'_, R> {
    /// Names the circle of jobs that can never move, or lets them change places where they only need each other's machines.
    pub(super) fn resolve_with_fixtures(&mut self, stuck: &BTreeSet<u32>) -> Result<bool, ShopError> {
        let circle = self.circle_of_wants(stuck);
        let machine = |want: Want| match want {
            Want::Machine(machine) => Some(machine),
            Want::Fixture(_) | Want::Buffer(_) => None,
        };
        // Each stands at the machine that the one before it wants.
        let before = circle.iter().cycle().skip(circle.len().saturating_sub(1));
        let standing = circle.iter().zip(before).map(|((slot, _), (_, want))| machine(*want).map(|at| (at, *slot)));
        if self.scenario.deadlock == Deadlock::Swap
            && let Some(places) = standing.collect::<Option<Vec<_>>>()
        {
            self.swap(&places);
            return Ok(true);
        }
        let name = |want: Want| match want {
            Want::Fixture(index) => format!("\"{}\"", self.scenario.shared.fixtures[index].name),
            Want::Machine(machine) => self.scenario.machines[machine].name.clone(),
            Want::Buffer(machine) => format!("a place before {}", self.scenario.machines[machine].name),
        };
        let before = circle.iter().cycle().skip(circle.len().saturating_sub(1));
        let words = circle.iter().zip(before).map(|((slot, wants), (_, holds))| {
            format!("{} holds {} and wants {}", self.label(*slot), name(*holds), name(*wants))
        });
        let circle = words.collect::<Vec<_>>().join("; ");
        Err(ShopError::FixtureDeadlock { time: self.now().seconds(), circle })
    }

    /// Jobs that can never move, each with what it wants, which the next one holds.
    fn circle_of_wants(&self, stuck: &BTreeSet<u32>) -> Vec<(u32, Want)> {
        let mut walk: Vec<(u32, Want)> = Vec::new();
        let mut slot = *stuck.first().expect("a deadlock has jobs");
        loop {
            let (want, next) = self.wanted_in_vain(slot, stuck).expect("a job that can never move waits for another");
            walk.push((slot, want));
            if let Some(first) = walk.iter().position(|(known, _)| *known == next) {
                return walk.split_off(first);
            }
            slot = next;
        }
    }

    /// What a job that can never move waits for, and one that holds it.
    fn wanted_in_vain(&self, slot: u32, stuck: &BTreeSet<u32>) -> Option<(Want, u32)> {
        if let Some((fixture, holder)) = self.needs_in_vain(slot, stuck) {
            return Some((Want::Fixture(fixture), holder));
        }
        let job = self.world.jobs.at(slot);
        let ahead = usize::from(self.scenario.blocking == Blocking::BeforeService);
        let operations = &self.scenario.parts[job.row.part as usize].operations;
        let machines = &operations.get(job.operation as usize + ahead)?.machines;
        machines.iter().find_map(|&machine| {
            let on_it = self.world.machines[machine].blocked.filter(|other| *other != slot && stuck.contains(other));
            let before = self.input(machine).map(|buffer| &self.world.flow.buffers[buffer]);
            let before = before.and_then(|standing| standing.iter().find(|other| stuck.contains(other)));
            let of_machine = on_it.map(|other| (Want::Machine(machine), other));
            of_machine.or(before.map(|other| (Want::Buffer(machine), *other)))
        })
    }
}
