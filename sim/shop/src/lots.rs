//! How orders of which several jobs are in the shop move on, and which machines are kept for them.

use super::Shop;
use super::job::Origin;
use super::lot::{KeptMachine, Lot, LotStep};
use super::queue_change::QueueChange;
use super::recorder::Recorder;
use super::world::World;

impl World {
    fn lot_mut(&mut self, order: u32) -> Option<&mut Lot> {
        self.lots[order as usize].as_mut()
    }

    fn step_mut(&mut self, (order, operation): (u32, u32)) -> Option<&mut LotStep> {
        self.lot_mut(order)?.steps.get_mut(operation as usize)
    }

    /// The jobs of an order, where several are in the shop, have passed all operations before `operation`, and `passed`
    /// of them that one, for which `machine` is kept.
    pub(super) fn set_lot(&mut self, order: u32, operation: u32, passed: u32, machine: Option<u32>) {
        let Some(lot) = self.lot_mut(order) else { return };
        let index = operation as usize;
        lot.steps[..index].iter_mut().for_each(|step| step.left = 0);
        lot.steps[index].left -= passed;
        lot.steps[index].divided = machine.is_some();
        lot.steps[index].machines = machine.into_iter().map(KeptMachine::new).collect();
        if let Some(machine) = machine {
            let state = &mut self.machines[machine as usize];
            (state.kept_for, state.set_up) = (Some((order, operation)), true);
        }
    }

    /// One more job of an order has to pass the operations from `start` on, where several are in the shop.
    pub(super) fn join_lot(&mut self, order: u32, start: u32) {
        let Some(lot) = self.lot_mut(order) else { return };
        lot.steps.iter_mut().skip(start as usize).for_each(|step| step.left += 1);
    }

    /// Pieces of an order begin anew: one more job has to pass all operations, where several are in the shop. Machines are not
    /// kept while it is on its way.
    pub(super) fn join_anew(&mut self, order: u32) {
        self.join_lot(order, 0);
        if let Some(lot) = self.lot_mut(order) {
            lot.returned = true;
        }
    }

    /// A job of an order has to pass the operations `end` to `start` once more, where several are in the shop.
    pub(super) fn repeat_in_lot(&mut self, order: u32, end: u32, start: u32) {
        let Some(lot) = self.lot_mut(order) else { return };
        lot.returned = true;
        lot.steps[end as usize..=start as usize].iter_mut().for_each(|step| step.left += 1);
    }

    /// The job that [`World::next_of_lot`] would take.
    pub(super) fn peek_of_lot(&self, order: u32, operation: u32, machine: usize) -> Option<u32> {
        let step = self.lots[order as usize].as_ref()?.steps.get(operation as usize)?;
        let done = step.machines.iter().any(|kept| kept.machine as usize == machine && kept.is_done());
        step.line.front().copied().filter(|_| !done)
    }

    /// The next job of an order at a machine that is kept for it.
    pub(super) fn next_of_lot(&mut self, order: u32, operation: u32, machine: usize) -> Option<u32> {
        let step = self.step_mut((order, operation))?;
        if step.kept(machine).is_some_and(|kept| kept.is_done()) {
            return None;
        }
        step.line.pop_front()
    }

    /// Machines that an order may still have at an operation.
    pub(super) fn machines_wanted(&self, (order, operation): (u32, u32)) -> usize {
        let lot = self.lots[order as usize].as_ref();
        lot.map_or(0, |lot| lot.split.saturating_sub(lot.steps[operation as usize].machines.len()))
    }

    /// Whether jobs of an order will come to an operation at which none has been yet.
    pub(super) fn awaits_first(&self, (order, operation): (u32, u32)) -> bool {
        let step = self.lots[order as usize].as_ref().map(|lot| &lot.steps[operation as usize]);
        step.is_some_and(|step| {
            step.left > 0 && !step.divided && step.machines.is_empty() && step.queued.is_none() && step.line.is_empty()
        })
    }

    /// A machine is kept for an order whose jobs are on their way.
    pub(super) fn keep_ahead(&mut self, (order, operation): (u32, u32), kept_machine: KeptMachine) {
        if let Some(step) = self.step_mut((order, operation)) {
            step.machines.push(kept_machine);
        }
        let state = &mut self.machines[kept_machine.machine as usize];
        (state.kept_for, state.set_up) = (Some((order, operation)), true);
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
        let (split, moving) = (lot.split, lot.moving);
        let step = &mut lot.steps[operation as usize];
        if step.gathered.len() < moving && still_to_come > 0 && !first || step.gathered.is_empty() {
            return;
        }
        let moving = std::mem::take(&mut step.gathered);
        if apart {
            // No machine is kept for an order where jobs of several are worked on together.
            moving.into_iter().for_each(|slot| self.wait(slot));
            return;
        }
        step.line.extend(&moving);
        let divided = step.divided;
        let machines: Vec<usize> = step.machines.iter().map(|kept| kept.machine as usize).collect();
        moving.iter().for_each(|slot| self.weigh(*slot, QueueChange::Comes));
        self.world.setups_ahead.retain(|wanted| *wanted != (order, operation));
        if machines.is_empty() {
            self.offer(order, operation);
            return;
        }
        if !divided {
            // Machines were set up before it came; others may join them now.
            if machines.len() < split {
                self.offer(order, operation);
            }
            self.world.dividing.push((order, operation));
        }
        machines.into_iter().for_each(|machine| self.may_choose(machine));
    }

    /// Puts one of the jobs that may be worked on into the queues, for all of them.
    fn offer(&mut self, order: u32, operation: u32) {
        let Some(step) = self.world.step_mut((order, operation)) else { return };
        if step.queued.is_some() {
            return;
        }
        step.queued = step.line.pop_front();
        if let Some(slot) = step.queued {
            self.queue_up(slot);
        }
    }

    /// A machine that takes a job of an order of which several are in the shop is kept for them.
    pub(super) fn keep(&mut self, machine: usize, slot: u32) {
        let job = self.world.jobs.at(slot);
        let (Origin::Order(order), operation) = (job.origin, job.operation) else { return };
        let Some(lot) = self.world.lot_mut(order) else { return };
        let split = lot.split;
        let step = &mut lot.steps[operation as usize];
        if step.queued == Some(slot) {
            step.queued = None;
        }
        if let Some(kept) = step.kept(machine) {
            kept.taken += 1;
            return;
        }
        let first = step.machines.is_empty();
        step.machines.push(KeptMachine { taken: 1, ..KeptMachine::new(machine as u32) });
        let more = !step.divided && step.machines.len() < split;
        if split == 1 {
            step.divided = true;
        } else if first {
            self.world.dividing.push((order, operation));
        }
        let state = &mut self.world.machines[machine];
        (state.kept_for, state.set_up) = (Some((order, operation)), false);
        if more {
            self.offer(order, operation);
        }
    }

    /// The machines of orders that were begun in this instant are settled: each gets an equal share of the jobs, the first
    /// ones one more where that does not come out even.
    pub(super) fn divide_lots(&mut self) {
        for (order, operation) in std::mem::take(&mut self.world.dividing) {
            let Some(step) = self.world.step_mut((order, operation)) else { continue };
            if step.divided || step.machines.is_empty() {
                continue;
            }
            step.divided = true;
            let (count, jobs) = (step.machines.len() as u32, step.left);
            if count > 1 {
                for (place, kept) in (0..).zip(&mut step.machines) {
                    kept.share = Some(jobs / count + u32::from(place < jobs % count));
                }
            }
            let machines: Vec<usize> = step.machines.iter().map(|kept| kept.machine as usize).collect();
            if let Some(slot) = step.queued.take() {
                step.line.push_front(slot);
                self.stop_waiting(slot, None);
                machines.into_iter().for_each(|machine| self.may_choose(machine));
            }
            self.release_done(order, operation);
        }
    }

    /// Machines that have done their share of an order are free; jobs that came in addition find another.
    fn release_done(&mut self, order: u32, operation: u32) {
        let Some(step) = self.world.step_mut((order, operation)) else { return };
        let done: Vec<usize> =
            step.machines.iter().filter(|kept| kept.is_done()).map(|kept| kept.machine as usize).collect();
        for machine in done {
            if self.world.machines[machine].task.is_some() {
                continue; // it still has its last one
            }
            if let Some(step) = self.world.step_mut((order, operation)) {
                step.machines.retain(|kept| kept.machine as usize != machine);
            }
            self.set_free(machine);
        }
        if self.world.step_mut((order, operation)).is_some_and(|step| step.machines.is_empty()) {
            self.offer(order, operation);
        }
    }

    /// A machine is kept for nobody any more.
    fn set_free(&mut self, machine: usize) {
        let state = &mut self.world.machines[machine];
        (state.kept_for, state.set_up) = (None, false);
        self.show_state(machine);
        self.may_choose(machine);
    }

    /// A machine that is kept for an order has none of its jobs. Where some were sent back, it is kept no longer: they may need
    /// this very machine before they come again.
    pub(super) fn starves(&mut self, machine: usize, (order, operation): (u32, u32)) {
        let Some(lot) = self.world.lot_mut(order).filter(|lot| lot.returned) else { return };
        lot.steps[operation as usize].machines.retain(|kept| kept.machine as usize != machine);
        self.set_free(machine);
    }

    /// Jobs of an order have been sent back: machines that are kept for what comes after look again.
    pub(super) fn look_again(&mut self, order: u32) {
        let Some(lot) = self.world.lot_mut(order) else { return };
        let machines: Vec<usize> =
            lot.steps.iter().flat_map(|step| &step.machines).map(|kept| kept.machine as usize).collect();
        machines.into_iter().for_each(|machine| self.may_choose(machine));
    }

    /// A machine has ended work on a job of the order for which it is kept.
    pub(super) fn took_out(&mut self, machine: usize) {
        if let Some((order, operation)) = self.world.machines[machine].kept_for {
            self.release_done(order, operation);
        }
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
        let Some(step) = self.world.step_mut((order, operation)) else { return };
        step.left -= 1;
        if step.left > 0 {
            return;
        }
        let machines = std::mem::take(&mut step.machines);
        self.world.setups_ahead.retain(|wanted| *wanted != (order, operation));
        machines.into_iter().for_each(|kept| self.set_free(kept.machine as usize));
        if self.world.lot_mut(order).is_some_and(|lot| operation as usize + 1 == lot.steps.len()) {
            self.world.lots[order as usize] = None; // all are through
        }
    }
}
