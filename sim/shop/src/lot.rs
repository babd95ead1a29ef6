//! Orders of which several jobs are in the shop: pieces, or as many as are transferred at a time.
//!
//! The jobs of an order wait for each other before an operation until as many are there as move on
//! together. The machine that takes the first of them is kept for the order until the last is through, so
//! that it is set up once; where the next one is not there yet, it starves.

use super::Shop;
use super::dispatch::Weighing;
use super::job::Origin;
use super::recorder::Recorder;
use super::world::World;
use std::collections::VecDeque;

/// Several jobs of one order.
#[derive(Clone, Debug)]
pub struct Lot {
    /// Jobs that move on together.
    pub moving: usize,
    /// By operation.
    pub steps: Vec<LotStep>,
}

/// The jobs of an order at an operation.
#[derive(Clone, Debug, Default)]
pub struct LotStep {
    /// Jobs that have not passed the operation yet.
    pub left: u32,
    /// Places of jobs that wait for others of their order.
    pub gathered: Vec<u32>,
    /// Places of jobs that may be worked on, but are in no queue: one of them is in the queue for all.
    pub line: VecDeque<u32>,
    /// Whether one of them is in the queue.
    pub queued: bool,
    /// The machine that is kept for the order.
    pub machine: Option<u32>,
}

impl Lot {
    pub(super) fn new(jobs: u32, moving: u32, operations: usize) -> Self {
        let step = LotStep { left: jobs, ..LotStep::default() };
        Self { moving: moving as usize, steps: vec![step; operations] }
    }
}

impl World {
    fn lot_mut(&mut self, order: u32) -> Option<&mut Lot> {
        self.lots[order as usize].as_mut()
    }

    /// The jobs of an order, where several are in the shop, have passed all operations before `operation`, and `passed`
    /// of them that one, for which `machine` is kept.
    pub(super) fn set_lot(&mut self, order: u32, operation: u32, passed: u32, machine: Option<u32>) {
        let Some(lot) = self.lot_mut(order) else { return };
        let index = operation as usize;
        lot.steps[..index].iter_mut().for_each(|step| step.left = 0);
        lot.steps[index].left -= passed;
        lot.steps[index].machine = machine;
        if let Some(machine) = machine {
            self.machines[machine as usize].kept_for = Some((order, operation));
        }
    }

    /// One more job of an order has to pass the operations from `from` on, where several are in the shop.
    pub(super) fn join_lot(&mut self, order: u32, from: u32) {
        let Some(lot) = self.lot_mut(order) else { return };
        lot.steps.iter_mut().skip(from as usize).for_each(|step| step.left += 1);
    }

    /// A job of an order has to pass the operations `to` to `from` once more, where several are in the shop.
    pub(super) fn repeat_in_lot(&mut self, order: u32, to: u32, from: u32) {
        let Some(lot) = self.lot_mut(order) else { return };
        lot.steps[to as usize..=from as usize].iter_mut().for_each(|step| step.left += 1);
    }

    /// The next job of an order at the machine that is kept for it.
    pub(super) fn next_of_lot(&mut self, order: u32, operation: u32) -> Option<u32> {
        self.lot_mut(order)?.steps[operation as usize].line.pop_front()
    }
}

impl<R: Recorder> Shop<'_, R> {
    /// A job of an order comes to its next operation.
    pub(super) fn gather(&mut self, order: u32, slot: u32) {
        let operation = self.world.jobs.at(slot).operation;
        if let Some(lot) = self.world.lot_mut(order) {
            lot.steps[operation as usize].gathered.push(slot);
        }
        self.move_on(order, operation);
    }

    /// Lets the jobs that are gathered be worked on, where enough of them are there or no more will come.
    fn move_on(&mut self, order: u32, operation: u32) {
        let part = self.scenario.orders[order as usize].part;
        let machine = self.scenario.parts[part].operations[operation as usize].machines[0];
        let apart = self.scenario.machines[machine].batch.is_some();
        let Some(lot) = self.world.lot_mut(order) else { return };
        // Before the first operation all jobs come in one instant.
        let still_to_come = operation.checked_sub(1).map_or(0, |before| lot.steps[before as usize].left);
        let first = operation == 0;
        let step = &mut lot.steps[operation as usize];
        if step.gathered.len() < lot.moving && still_to_come > 0 && !first || step.gathered.is_empty() {
            return;
        }
        let (moving, machine) = (std::mem::take(&mut step.gathered), step.machine);
        if apart {
            // No machine is kept for an order where jobs of several are worked on together.
            moving.into_iter().for_each(|slot| self.wait(slot));
            return;
        }
        let lead = if machine.is_none() && !step.queued { moving.first().copied() } else { None };
        step.queued |= lead.is_some();
        step.line.extend(moving.iter().filter(|slot| Some(**slot) != lead));
        for slot in moving {
            if Some(slot) == lead {
                self.wait(slot);
            } else {
                self.weigh(slot, Weighing::Comes);
            }
        }
        if let Some(machine) = machine {
            self.may_choose(machine as usize);
        }
    }

    /// A machine that takes the first of several jobs of an order is kept for them.
    pub(super) fn keep(&mut self, machine: usize, slot: u32) {
        let job = self.world.jobs.at(slot);
        let (Origin::Order(order), operation) = (job.origin, job.operation) else { return };
        let Some(lot) = self.world.lot_mut(order) else { return };
        let step = &mut lot.steps[operation as usize];
        step.queued = false;
        step.machine = Some(machine as u32);
        self.world.machines[machine].kept_for = Some((order, operation));
    }

    /// A job has passed an operation: the machine is free where it was the last of its order.
    pub(super) fn passed(&mut self, slot: u32, operation: u32) {
        if let Origin::Order(order) = self.world.jobs.at(slot).origin {
            self.count_down(order, operation);
        }
    }

    /// A job of an order has left the shop before its operation number `operation` (all of them: it is
    /// finished): those that it will not come to wait for it no longer.
    pub(super) fn left_lot(&mut self, order: u32, operation: u32) {
        let operations = self.world.lot_mut(order).map_or(0, |lot| lot.steps.len() as u32);
        (operation..operations).for_each(|later| self.count_down(order, later));
        (operation..operations).for_each(|later| self.move_on(order, later));
    }

    /// One job less has to pass an operation.
    fn count_down(&mut self, order: u32, operation: u32) {
        let Some(lot) = self.world.lot_mut(order) else { return };
        let step = &mut lot.steps[operation as usize];
        step.left -= 1;
        if step.left > 0 {
            return;
        }
        if let Some(machine) = step.machine.take() {
            self.world.machines[machine as usize].kept_for = None;
            self.show_state(machine as usize);
            self.may_choose(machine as usize);
        }
        if self.world.lot_mut(order).is_some_and(|lot| operation as usize + 1 == lot.steps.len()) {
            self.world.lots[order as usize] = None; // all are through
        }
    }
}
