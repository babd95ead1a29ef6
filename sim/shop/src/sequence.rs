//! Machines that follow a schedule: each takes its operations in the order that is given, and waits for the next one.

use super::event::Event;
use super::job::Origin;
use super::recorder::Recorder;
use super::{Shop, ShopError};
use toolroom_kernel::SimTime;
use toolroom_scenario::Blocking;

/// How far a machine has come in its sequence.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Followed {
    /// Operations that it has begun: place of the next one.
    pub place: u32,
    /// The time until which it waits for its next operation, s; an event is scheduled then.
    waits_until: f64,
}

impl<R: Recorder> Shop<'_, R> {
    /// The job that a machine takes next by its sequence, if it is there and may begin.
    pub(super) fn pick_planned(&mut self, machine: usize) -> Result<Option<u32>, ShopError> {
        let Some(schedule) = &self.scenario.control.schedule else { return Ok(None) };
        let followed = self.world.sequences[machine];
        let Some(next) = schedule.machines[machine].get(followed.place as usize) else { return Ok(None) };
        if self.now().seconds() < next.not_before {
            if followed.waits_until < next.not_before {
                self.world.sequences[machine].waits_until = next.not_before;
                self.schedule(SimTime::from_seconds(next.not_before)?, Event::Planned { machine: machine as u32 })?;
            }
            return Ok(None);
        }
        let (origin, operation) = (Origin::Order(next.order as u32), next.operation as u32);
        let waits = self.world.jobs.find(|job| job.origin == origin && job.waiting && job.operation == operation);
        let Some(slot) = waits else { return Ok(None) };
        let lack = self.lack_of(machine, slot);
        self.set_lack(machine, lack);
        if lack.is_some() || !self.is_supplied(slot) || !self.fits(machine, slot) {
            return Ok(None);
        }
        let reserves = self.world.flow.is_limited() && self.scenario.blocking == Blocking::BeforeService;
        if reserves && !self.reserve(slot) {
            self.world.flow.held_up.push(machine as u32);
            self.world.flow.suspect = true;
            return Ok(None);
        }
        self.world.sequences[machine].place += 1;
        self.stop_waiting(slot, None);
        Ok(Some(slot))
    }
}
