//! Setting up before the first piece is there.
//!
//! An order may want that: as soon as one of its operations has begun, a machine of the next one that is free and has no
//! job to take is set up for it, and then kept for it as if its first piece had come. An operation begins with its setup, so
//! that along a line the machine after that is set up as well. A machine that stands ready for it already is left alone. While the machine is set up, a stand-in has the place of the job: it has the number of a job of
//! the order, and nobody sees it in the log but as the one for whom the machine is set up.

use super::job::{Job, Origin};
use super::lot::KeptMachine;
use super::recorder::Recorder;
use super::task::{Content, Step, Task};
use super::{Shop, ShopError};
use crate::runlog::LogEvent;
use toolroom_kernel::Entity;
use toolroom_scenario::ShopConstant;

impl<R: Recorder> Shop<'_, R> {
    /// A machine has begun an operation of a job, or its setup: where its order wants that, machines of the next one may be set up.
    pub(super) fn look_ahead(&mut self, slot: u32) {
        let job = self.world.jobs.at(slot);
        let Origin::Order(order) = job.origin else { return };
        let ordered = &self.scenario.orders[order as usize];
        let next = job.operation + 1;
        if !ordered.setup_ahead || next as usize >= self.scenario.parts[ordered.part].operations.len() {
            return;
        }
        let operation = &self.scenario.parts[ordered.part].operations[next as usize];
        let batch = operation.machines.iter().any(|machine| self.scenario.machines[*machine].batch.is_some());
        let awaited = self.world.awaits_first((order, next));
        if awaited && !batch && !self.world.setups_ahead.contains(&(order, next)) {
            self.world.setups_ahead.push((order, next));
        }
    }

    /// Machines that are free and have no job to take are set up for orders that are on their way.
    pub(super) fn set_up_ahead(&mut self) -> Result<(), ShopError> {
        let mut place = 0;
        while let Some(&(order, operation)) = self.world.setups_ahead.get(place) {
            if self.world.machines_wanted((order, operation)) == 0 {
                self.world.setups_ahead.remove(place);
                continue;
            }
            let ordered = &self.scenario.orders[order as usize];
            let (part, pieces) = (ordered.part, f64::from(ordered.pieces()));
            let found = self.idle_for((part, operation as usize), pieces, (None, self.order_entity(order)));
            match found.and_then(|machine| Some((machine, self.setup_for(machine, part, operation as usize)?))) {
                Some((machine, setup)) => self.begin_ahead(machine, (order, operation), setup)?,
                None => place += 1,
            }
        }
        Ok(())
    }

    fn order_entity(&self, order: u32) -> Entity {
        Entity::named(&format!("order {}", self.scenario.orders[order as usize].id))
    }

    /// A machine is set up for an order and kept for it.
    fn begin_ahead(&mut self, machine: usize, (order, operation): (u32, u32), setup: f64) -> Result<(), ShopError> {
        let origin = Origin::Order(order);
        let Some(of) = self.world.jobs.find(|job| job.origin == origin && !job.stand_in) else {
            self.world.setups_ahead.retain(|wanted| wanted.0 != order); // none of its jobs is in the shop
            return Ok(());
        };
        let now = self.now();
        let job = self.world.jobs.at(of);
        let number = job.number;
        let stand_in = Job { operation, waiting: false, queued: now, handling: None, stand_in: true, ..job.clone() };
        let slot = self.world.jobs.insert_beside(stand_in, of);
        self.world.keep_ahead((order, operation), KeptMachine::new(machine as u32));
        let scoped = self.scoped_operation(machine, slot);
        let setup = self.drawn_setup(machine, slot, setup);
        let left = scoped.calibrated(self.scenario, ShopConstant::SetupTime, setup);
        self.world.machines[machine].task = Some(Task {
            slot,
            begun: now,
            step: Step::Setup,
            left,
            since: now,
            end: None,
            operator: None,
            presence: 0.0,
            waits: false,
            load_time: 0.0,
            unload_time: 0.0,
            content: Content::Plain(0.0),
            before: 0.0,
            riders: Vec::new(),
            tending: None,
        });
        self.log_event(LogEvent::Setup, Some(machine), Some(number), None);
        self.look_ahead(slot);
        self.start_clocks(machine)?;
        self.drive(machine, true)
    }

    /// A machine is set up for an order that is on its way.
    pub(super) fn end_ahead(&mut self, machine: usize) {
        self.stop_clocks(machine);
        self.release_operator(machine);
        let state = &mut self.world.machines[machine];
        let task = state.task.take();
        if std::mem::take(&mut state.leaving) {
            state.off_shift = true;
        }
        if let Some(task) = task {
            self.world.jobs.remove(task.slot);
        }
        self.show_state(machine);
        self.may_choose(machine);
    }
}
