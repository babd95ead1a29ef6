//! Crews: a breakdown waits until somebody is free to repair it.

use super::event::Event;
use super::recorder::Recorder;
use super::{Shop, ShopError};
use std::collections::VecDeque;
use toolroom_scenario::Crew;

/// A crew.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CrewState {
    /// Repairs that it could begin now.
    pub free: u32,
    /// Failure modes that wait for it, the first in front.
    pub waiting: VecDeque<u32>,
}

impl CrewState {
    pub(super) fn of(crew: &Crew) -> Self {
        Self { free: crew.count, waiting: VecDeque::new() }
    }
}

impl<R: Recorder> Shop<'_, R> {
    /// A machine has broken down: it is repaired at once, or when its crew is free.
    pub(super) fn call_crew(&mut self, mode: usize) -> Result<(), ShopError> {
        if let Some(crew) = self.scenario.failures[mode].crew {
            let state = &mut self.world.crews[crew];
            if state.free == 0 {
                state.waiting.push_back(mode as u32);
                return Ok(());
            }
            state.free -= 1;
        }
        self.begin_repair(mode)
    }

    fn begin_repair(&mut self, mode: usize) -> Result<(), ShopError> {
        if self.scenario.failures[mode].crew.is_some() {
            self.log_event("repair_start", Some(self.scenario.failures[mode].machine), None, None);
        }
        let time = self.now().after(self.world.modes[mode].repair)?;
        self.schedule(time, Event::Repair { mode: mode as u32 })?;
        Ok(())
    }

    /// A repair is over: the crew goes to the next machine.
    pub(super) fn release_crew(&mut self, mode: usize) -> Result<(), ShopError> {
        let Some(crew) = self.scenario.failures[mode].crew else { return Ok(()) };
        match self.world.crews[crew].waiting.pop_front() {
            Some(next) => self.begin_repair(next as usize),
            None => {
                self.world.crews[crew].free += 1;
                Ok(())
            }
        }
    }
}
