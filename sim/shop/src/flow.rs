//! Places: a part that is done moves on only where there is room for it.
//!
//! A job that waits for an operation stands in a buffer, or in the unlimited space before machines without
//! one. Whatever cannot move on is *held*: on its machine, which is then blocked, behind it in an output
//! buffer, or, where it has just come to the shop, at the door. Nothing moves while the events of an instant
//! are settled. Then, until nothing changes: held jobs go where there is a place, in the order in which they
//! were held up; idle machines take work, which frees places; a job goes through a full buffer directly to an
//! idle machine, which takes one job out in the same instant.
//!
//! With blocking before service the places of a buffer and of its machines are counted together, and a
//! machine begins only when its job has reserved one of the next operation.

use super::recorder::Recorder;
use super::{Shop, ShopError};
use std::collections::VecDeque;
use toolroom_scenario::{BatchUnit, Blocking, Buffer, Scenario};

/// Who stands where.
#[derive(Clone, Debug, Default)]
pub struct Flow {
    /// Places of jobs in every buffer, as in the scenario: those that stand in it and, with blocking before
    /// service, those on its machines and those that have reserved a place.
    pub buffers: Vec<Vec<u32>>,
    /// Jobs that are done on a machine and cannot move on, in the order in which they were held up.
    pub(super) held: Vec<BlockedJob>,
    /// Jobs that have not found room in the shop yet, in the order of their release, by part.
    pub(super) doors: Vec<VecDeque<(u64, u32)>>,
    /// Machines with work for which no place can be reserved, with blocking before service.
    pub(super) held_up: Vec<u32>,
    /// Jobs held up so far.
    count: u64,
    /// Whether a job was held up, or a machine came back with one, since a deadlock was looked for.
    pub(super) suspect: bool,
    /// Circles of parts that changed places.
    pub swaps: u64,
}

/// Where a job may stand before its operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// In the unlimited space before machines without buffer, or outside the shop.
    Space,
    /// In a buffer, by index.
    Buffer(usize),
}

/// A job that cannot move on.
#[derive(Clone, Copy, Debug)]
pub(super) struct BlockedJob {
    /// Number among all that were held up.
    pub order: u64,
    pub slot: u32,
    /// The machine on which it was worked on.
    pub machine: u32,
    /// The output buffer in which it stands; `None`: on the machine.
    pub output: Option<usize>,
}

/// Where a job goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Move {
    /// From `held`, by position, to the place before its operation.
    On(usize, Place),
    /// From its machine into an output buffer.
    Behind(usize, usize),
    /// From the door of a part.
    In(usize, Place),
}

impl Flow {
    pub(super) fn of(scenario: &Scenario) -> Self {
        if scenario.buffers.is_empty() {
            return Self::default();
        }
        let doors = vec![VecDeque::new(); scenario.parts.len()];
        Self { buffers: vec![Vec::new(); scenario.buffers.len()], doors, ..Self::default() }
    }

    /// Whether any place is limited.
    #[inline]
    pub(super) fn is_limited(&self) -> bool {
        !self.buffers.is_empty()
    }

    fn remove(&mut self, buffer: usize, slot: u32) {
        let standing = &mut self.buffers[buffer];
        let place = standing.iter().position(|each| *each == slot).expect("a job stands where it was put");
        standing.remove(place);
    }
}

/// Jobs that have room in a buffer, its machines included where they count.
pub(super) fn capacity(buffer: &Buffer, blocking: Blocking) -> usize {
    let on_machines = match blocking {
        Blocking::AfterService => 0,
        Blocking::BeforeService => buffer.machines.len(),
    };
    buffer.places as usize + on_machines
}

impl<R: Recorder> Shop<'_, R> {
    /// Whether a buffer has room for a job.
    pub(super) fn has_room(&self, buffer: usize, slot: u32) -> bool {
        self.would_fit(buffer, slot, |_| true)
    }

    /// Whether a buffer would have room for a job if only those stood in it of which `stays` says so.
    pub(super) fn would_fit(&self, buffer: usize, slot: u32, stays: impl Fn(u32) -> bool) -> bool {
        let own = &self.scenario.buffers[buffer];
        let most = capacity(own, self.scenario.blocking);
        let standing = self.world.flow.buffers[buffer].iter().copied();
        match own.unit {
            BatchUnit::Lots => standing.filter(|other| stays(*other)).count() < most,
            BatchUnit::Pieces => {
                let pieces = |slot: u32| self.world.jobs.at(slot).row.quantity as usize;
                standing.filter(|other| stays(*other)).map(pieces).sum::<usize>() + pieces(slot) <= most
            }
        }
    }

    /// Machines of the operation for which a job waits or will wait.
    pub(super) fn next_machines(&self, slot: u32) -> &[usize] {
        let job = self.world.jobs.at(slot);
        if job.waiting && job.assigned.is_some() {
            return job.assigned.as_slice();
        }
        &self.scenario.parts[job.row.part as usize].operations[job.operation as usize].machines
    }

    /// A job that comes to its next operation looks for a place: at once where none is limited.
    pub(super) fn look_for_place(&mut self, slot: u32, machine: Option<usize>) {
        let flow = &mut self.world.flow;
        flow.count += 1;
        let order = flow.count;
        match machine {
            Some(machine) => {
                flow.held.push(BlockedJob { order, slot, machine: machine as u32, output: None });
                flow.suspect = true;
                self.world.machines[machine].blocked = Some(slot);
                self.show_state(machine);
            }
            None => {
                let part = self.world.jobs.at(slot).row.part as usize;
                self.world.flow.doors[part].push_back((order, slot));
            }
        }
    }

    /// Lets everything move and every idle machine choose, until nothing changes.
    pub(super) fn settle_places(&mut self) -> Result<(), ShopError> {
        loop {
            self.give_cards()?;
            while let Some(next) = self.next_move(false) {
                self.make(next);
            }
            for machine in std::mem::take(&mut self.world.flow.held_up) {
                self.may_choose(machine as usize);
            }
            self.dispatch()?;
            if let Some(next) = self.next_move(true) {
                self.make(next);
            } else if !self.world.cards.changed && self.next_move(false).is_none() && !self.resolve_deadlock()? {
                break;
            }
        }
        Ok(())
    }

    /// The first job that can move; `through`: also through a full buffer to an idle machine.
    fn next_move(&self, through: bool) -> Option<Move> {
        let flow = &self.world.flow;
        let on = |(place, held): (usize, &BlockedJob)| {
            if let Some(to) = self.place_for(held.slot, through) {
                return Some((held.order, Move::On(place, to)));
            }
            let behind = self.scenario.machines[held.machine as usize].output_buffer;
            let behind = behind.filter(|buffer| held.output.is_none() && self.has_room(*buffer, held.slot))?;
            Some((held.order, Move::Behind(place, behind)))
        };
        let held = flow.held.iter().enumerate().find_map(on);
        let inside = flow.doors.iter().enumerate().filter_map(|(part, door)| {
            let &(order, slot) = door.front()?;
            self.place_for(slot, through).map(|to| (order, Move::In(part, to)))
        });
        held.into_iter().chain(inside).min_by_key(|(order, _)| *order).map(|(_, next)| next)
    }

    /// Where a job has room before its operation.
    fn place_for(&self, slot: u32, through: bool) -> Option<Place> {
        if self.world.jobs.at(slot).parked {
            return None; // it waits for a card
        }
        if let Some(reserved) = self.world.jobs.at(slot).reserved {
            return Some(reserved);
        }
        let takes = |machine: usize| {
            let state = &self.world.machines[machine];
            let empty = state.task.is_none() && state.blocked.is_none_or(|own| own == slot);
            let ready = through && empty && state.is_up() && state.kept_for.is_none();
            ready && self.lack_of(machine, slot).is_none() && self.fits(machine, slot)
        };
        let after = self.scenario.blocking == Blocking::AfterService;
        self.next_machines(slot).iter().find_map(|&machine| match self.input(machine) {
            None => Some(Place::Space),
            Some(buffer) => {
                let room = self.has_room(buffer, slot) || after && takes(machine);
                room.then_some(Place::Buffer(buffer))
            }
        })
    }

    /// The buffer before a machine.
    pub(super) fn input(&self, machine: usize) -> Option<usize> {
        self.scenario.machines[machine].input_buffer
    }

    /// A job moves.
    fn make(&mut self, next: Move) {
        match next {
            Move::On(place, to) => {
                let held = self.world.flow.held.remove(place);
                self.let_go(held);
                self.enter(held.slot, to);
            }
            Move::Behind(place, buffer) => {
                let held = self.world.flow.held[place];
                self.let_go(held);
                self.world.flow.held[place].output = Some(buffer);
                self.world.flow.buffers[buffer].push(held.slot);
            }
            Move::In(part, to) => {
                if let Some((_, slot)) = self.world.flow.doors[part].pop_front() {
                    self.enter(slot, to);
                }
            }
        }
    }

    /// The place that a held job leaves is free.
    pub(super) fn let_go(&mut self, held: BlockedJob) {
        match held.output {
            Some(buffer) => self.world.flow.remove(buffer, held.slot),
            None => {
                let machine = held.machine as usize;
                self.world.machines[machine].blocked = None;
                self.show_state(machine);
                self.may_choose(machine);
            }
        }
    }

    /// A job takes its place before its operation and waits there.
    fn enter(&mut self, slot: u32, place: Place) {
        let now = self.now();
        let job = self.world.jobs.at_mut(slot);
        job.queued = now;
        let reserved = job.reserved.take().is_some();
        if let Place::Buffer(buffer) = place {
            job.buffer = Some(buffer);
            if !reserved {
                self.world.flow.buffers[buffer].push(slot);
            }
        }
        if self.has_cards() {
            self.return_cards(slot);
        }
        self.wait(slot);
    }

    /// A job of a circle goes to the place that the next one has left, through the buffer if there is one.
    pub(super) fn enter_swapped(&mut self, slot: u32) {
        let to = self.input(self.next_machines(slot)[0]).map_or(Place::Space, Place::Buffer);
        self.enter(slot, to);
    }

    /// A machine begins with a job, whose place in the buffer is free where it does not count with the
    /// machine's own.
    pub(super) fn leave_buffer(&mut self, slot: u32) {
        if self.scenario.blocking == Blocking::AfterService {
            self.free_place(slot);
        }
    }

    /// The place in which a job stands is free.
    pub(super) fn free_place(&mut self, slot: u32) {
        if let Some(buffer) = self.world.jobs.at_mut(slot).buffer.take() {
            self.world.flow.remove(buffer, slot);
        }
    }

    /// A job leaves the shop, with whatever it holds.
    pub(super) fn free_places(&mut self, slot: u32) {
        self.free_place(slot);
        if let Some(Place::Buffer(buffer)) = self.world.jobs.at_mut(slot).reserved.take() {
            self.world.flow.remove(buffer, slot);
        }
    }

    /// Reserves a place for the operation after that which a job is about to begin; false where there is none.
    pub(super) fn reserve(&mut self, slot: u32) -> bool {
        let Some(place) = self.reservable(slot) else { return false };
        if let Place::Buffer(buffer) = place {
            self.world.flow.buffers[buffer].push(slot);
        }
        self.world.jobs.at_mut(slot).reserved = Some(place);
        true
    }

    /// What [`Shop::reserve`] would reserve.
    fn reservable(&self, slot: u32) -> Option<Place> {
        let job = self.world.jobs.at(slot);
        let operations = &self.scenario.parts[job.row.part as usize].operations;
        let Some(next) = operations.get(job.next_operation(operations.len())) else { return Some(Place::Space) };
        next.machines.iter().find_map(|&machine| match self.input(machine) {
            None => Some(Place::Space),
            Some(buffer) => self.has_room(buffer, slot).then_some(Place::Buffer(buffer)),
        })
    }
}
