//! Fixtures and pallets: an operation begins only when its machine, its fixtures and the person for its first step are
//! there together.
//!
//! A job that finds no fixture stays in its queue and holds nothing; its machine takes another job that can be done, or
//! waits. A fixture is held until the operation is over, or travels with its job until a later one is. When a
//! fixture or a person becomes free, machines with work that found none choose again, in the order of the scenario.
//!
//! Jobs that travel with fixtures may wait for each other: each holds what the other needs. [`resolve_deadlock`] counts
//! fixtures among the places.
//!
//! [`resolve_deadlock`]: super::Shop::resolve_deadlock

use super::readiness::Lack;
use super::recorder::Recorder;
use super::{Shop, ShopError};
use std::collections::BTreeSet;
use toolroom_scenario::{Fixture, Hold};

/// Who has a fixture.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FixtureState {
    /// Jobs that hold one, with the first operation that needs it.
    pub(super) holders: Vec<Holder>,
}

/// A job that holds a fixture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Holder {
    pub slot: u32,
    /// [`Hold::from`].
    from: usize,
}

impl FixtureState {
    /// How many are in use.
    pub fn in_use(&self) -> usize {
        self.holders.len()
    }
}

/// Machines with work that lacks a fixture or a person.
#[derive(Clone, Debug, Default)]
pub struct Shortages {
    /// Those machines.
    machines: Vec<u32>,
    /// Whether something has become free since they chose.
    released: bool,
}

/// The hold of a fixture by an operation of a part.
fn hold_of(fixture: &Fixture, part: usize, operation: usize) -> Option<&Hold> {
    fixture.holds.iter().find(|hold| hold.contains(part, operation))
}

impl<R: Recorder> Shop<'_, R> {
    /// Whether the shop has fixtures.
    #[inline]
    pub(super) fn has_fixtures(&self) -> bool {
        !self.scenario.shared.fixtures.is_empty()
    }

    fn place_of(&self, slot: u32) -> (usize, usize) {
        let job = self.world.jobs.at(slot);
        (job.row.part as usize, job.operation as usize)
    }

    /// Whether a job needs any fixture for its operation.
    fn needs_fixture(&self, slot: u32) -> bool {
        let (part, operation) = self.place_of(slot);
        self.scenario.shared.fixtures.iter().any(|fixture| hold_of(fixture, part, operation).is_some())
    }

    /// Fixtures that a job needs for its operation and does not hold.
    fn lacks_of(&self, slot: u32) -> impl Iterator<Item = (usize, Hold)> + '_ {
        let (part, operation) = self.place_of(slot);
        self.scenario.shared.fixtures.iter().zip(&self.world.fixtures).enumerate().filter_map(
            move |(index, (fixture, state))| {
                let hold = hold_of(fixture, part, operation)?;
                let held = state.holders.iter().any(|own| own.slot == slot && own.from == hold.from);
                (!held).then_some((index, *hold))
            },
        )
    }

    /// Whether the fixtures that a job needs are there, those included which `leaving` gives back when it leaves its
    /// machine.
    pub(super) fn finds_fixtures(&self, slot: u32, leaving: Option<u32>) -> bool {
        self.lacks_of(slot).all(|(index, _)| {
            let (fixture, state) = (&self.scenario.shared.fixtures[index], &self.world.fixtures[index]);
            let back = leaving.map_or(0, |leaving| {
                let (part, _) = self.place_of(leaving);
                let stays = |from: usize| hold_of(fixture, part, from).is_some_and(Hold::travels);
                state.holders.iter().filter(|own| own.slot == leaving && !stays(own.from)).count()
            });
            state.holders.len() < fixture.count as usize + back
        })
    }

    /// What a job lacks to be begun in a machine: a fixture, or the person for its first step where it needs fixtures.
    pub(super) fn lack_of(&self, machine: usize, slot: u32) -> Option<Lack> {
        if !self.has_fixtures() || !self.needs_fixture(slot) {
            return None; // others wait for people in their machine
        }
        if !self.finds_fixtures(slot, None) {
            return Some(Lack::Fixture);
        }
        let (skill, share) = self.first_skill(machine, slot)?;
        self.free_operator(skill, share).is_none().then_some(Lack::Operator)
    }

    /// The skill that the first step of an operation needs which takes time, and the share of a person.
    fn first_skill(&self, machine: usize, slot: u32) -> Option<(usize, f64)> {
        let (part, index) = self.place_of(slot);
        let attendance = self.scenario.parts[part].operations[index].attendance;
        if self.setup_of_next(machine, slot).is_some_and(|time| time > 0.0) {
            attendance.setup.map(|skill| (skill, 1.0))
        } else if self.scenario.machines[machine].load_time.mean() > 0.0 {
            attendance.load.map(|skill| (skill, 1.0))
        } else {
            attendance.run.map(|skill| (skill, attendance.presence.share()))
        }
    }

    /// A job takes the fixtures of its operation.
    pub(super) fn clamp(&mut self, slot: u32) {
        if !self.has_fixtures() {
            return;
        }
        let lacks: Vec<(usize, Hold)> = self.lacks_of(slot).collect();
        for (index, hold) in lacks {
            self.world.fixtures[index].holders.push(Holder { slot, from: hold.from });
        }
    }

    /// A job that is where it is at the start holds what travels with it there.
    pub(super) fn clamp_at_start_of_run(&mut self, slot: u32, in_machine: bool) {
        if !self.has_fixtures() {
            return;
        }
        let (_, operation) = self.place_of(slot);
        let lacks: Vec<(usize, Hold)> = self.lacks_of(slot).collect();
        for (index, hold) in lacks.into_iter().filter(|(_, hold)| in_machine || operation > hold.from) {
            self.world.fixtures[index].holders.push(Holder { slot, from: hold.from });
        }
    }

    /// The operation number `done` of a job is over, or given up: fixtures that do not go with it to its next one are free.
    pub(super) fn unclamp(&mut self, slot: u32, done: usize, over: bool) {
        if !self.has_fixtures() {
            return;
        }
        let (part, next) = self.place_of(slot);
        let fixtures = &self.scenario.shared.fixtures;
        self.free_fixtures(|index, holder| {
            let stays = |hold: &Hold| {
                let on_the_way = hold.contains(part, next) && hold.travels();
                on_the_way && !(over && done == hold.until)
            };
            holder.slot != slot || hold_of(&fixtures[index], part, holder.from).is_some_and(stays)
        });
    }

    /// A job leaves the shop: whatever it holds is free.
    pub(super) fn unclamp_all(&mut self, slot: u32) {
        if self.has_fixtures() {
            self.free_fixtures(|_, holder| holder.slot != slot);
        }
    }

    fn free_fixtures(&mut self, keep: impl Fn(usize, &Holder) -> bool) {
        for (index, state) in self.world.fixtures.iter_mut().enumerate() {
            let before = state.holders.len();
            state.holders.retain(|holder| keep(index, holder));
            self.world.lacking.released |= state.holders.len() < before;
        }
    }

    /// A person is free: machines with work that waits for one choose again.
    #[inline]
    pub(super) fn person_is_free(&mut self) {
        self.world.lacking.released = true;
    }

    /// A machine has work for which something is lacking, or has none such.
    pub(super) fn set_lack(&mut self, machine: usize, lack: Option<Lack>) {
        if lack.is_some() {
            if !self.world.lacking.machines.contains(&(machine as u32)) {
                self.world.lacking.machines.push(machine as u32);
            }
            self.world.flow.suspect |= self.layout.travels || self.world.flow.is_limited();
        }
        if std::mem::replace(&mut self.world.machines[machine].lacks, lack) != lack {
            self.show_state(machine);
        }
    }

    /// Lets machines whose work lacked something choose again, where something has become free.
    pub(super) fn offer_again(&mut self) {
        if std::mem::take(&mut self.world.lacking.released) {
            for machine in std::mem::take(&mut self.world.lacking.machines) {
                self.may_choose(machine as usize);
            }
        }
    }

    /// A job is begun: machines that waited for what it lacked may have nothing to wait for any more.
    pub(super) fn look_at_lacking(&mut self, slot: u32) {
        if self.world.lacking.machines.is_empty() {
            return;
        }
        let mut machines = std::mem::take(&mut self.world.lacking.machines);
        machines.retain(|machine| {
            let other = self.next_machines(slot).contains(&(*machine as usize));
            if other {
                self.may_choose(*machine as usize);
            }
            !other
        });
        self.world.lacking.machines = machines;
    }

    /// Whether an urgent job finds what it needs when the job in a machine gives way.
    pub(super) fn may_take_over(&self, machine: usize, slot: u32) -> bool {
        let Some(task) = self.world.machines[machine].task.as_ref().filter(|_| self.has_fixtures()) else {
            return true;
        };
        if !self.needs_fixture(slot) {
            return true;
        }
        let able = |operator: u32, skill| self.scenario.operators[operator as usize].skills.contains(&skill);
        let attended = |(skill, share): (usize, f64)| {
            self.free_operator(skill, share).is_some() || task.operator.is_some_and(|operator| able(operator, skill))
        };
        self.finds_fixtures(slot, Some(task.slot)) && self.first_skill(machine, slot).is_none_or(attended)
    }

    /// Serves steps that wait for people before a machine looks for people who are free.
    pub(super) fn serve_first(&mut self) -> Result<(), ShopError> {
        if self.has_fixtures() { self.assign_operators() } else { Ok(()) }
    }

    /// Jobs in queues that hold something that travels.
    pub(super) fn travelling(&self) -> impl Iterator<Item = u32> + '_ {
        let slots = self.world.fixtures.iter().flat_map(|state| &state.holders).map(|holder| holder.slot);
        slots.filter(|slot| self.world.jobs.at(*slot).waiting)
    }

    /// A fixture that a job needs, all of which are held by jobs that can never move, and one of these.
    pub(super) fn needs_in_vain(&self, slot: u32, stuck: &BTreeSet<u32>) -> Option<(usize, u32)> {
        self.lacks_of(slot).find_map(|(index, _)| {
            let holders = &self.world.fixtures[index].holders;
            let none = holders.len() >= self.scenario.shared.fixtures[index].count as usize;
            let vain = none && holders.iter().all(|holder| stuck.contains(&holder.slot));
            vain.then(|| holders.first().map(|holder| (index, holder.slot))).flatten()
        })
    }
}
