//! Crews: a breakdown waits until somebody is free to repair it, and in shift. A repair once begun is finished.

use super::event::Event;
use super::recorder::Recorder;
use super::{Shop, ShopError};
use crate::runlog::LogEvent;
use std::collections::VecDeque;
use toolroom_kernel::SimTime;
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
    pub(super) fn from_crew(crew: &Crew) -> Self {
        Self { free: crew.count, waiting: VecDeque::new() }
    }
}

impl<R: Recorder> Shop<'_, R> {
    /// A machine has broken down: it is repaired at once, or when its crew is free.
    pub(super) fn call_crew(&mut self, mode: usize) -> Result<(), ShopError> {
        if let Some(crew) = self.scenario.failures[mode].crew {
            let here = self.crew_works(crew);
            let state = &mut self.world.crews[crew];
            if state.free == 0 || !here {
                state.waiting.push_back(mode as u32);
                return Ok(());
            }
            state.free -= 1;
        }
        self.begin_repair(mode)
    }

    fn begin_repair(&mut self, mode: usize) -> Result<(), ShopError> {
        if self.scenario.failures[mode].crew.is_some() {
            self.log_event(LogEvent::RepairStart, Some(self.scenario.failures[mode].machine), None, None);
        }
        let time = self.now().after(self.world.modes[mode].repair)?;
        self.schedule(time, Event::Repair { mode: mode as u32 })?;
        Ok(())
    }

    /// A repair is over: the crew goes to the next machine.
    pub(super) fn release_crew(&mut self, mode: usize) -> Result<(), ShopError> {
        let Some(crew) = self.scenario.failures[mode].crew else { return Ok(()) };
        self.world.crews[crew].free += 1;
        self.send_crew(crew)
    }

    /// Lets those of a crew who are free begin repairs that wait for them, in their shift.
    fn send_crew(&mut self, crew: usize) -> Result<(), ShopError> {
        while self.world.crews[crew].free > 0 && self.crew_works(crew) {
            let state = &mut self.world.crews[crew];
            let Some(next) = state.waiting.pop_front() else { break };
            state.free -= 1;
            self.begin_repair(next as usize)?;
        }
        Ok(())
    }

    fn crew_works(&self, crew: usize) -> bool {
        let calendar = self.scenario.crews[crew].calendar.map(|index| &self.scenario.calendars[index]);
        calendar.is_none_or(|calendar| calendar.works_at(self.now().seconds()))
    }

    /// Every crew comes to its first shift.
    pub(super) fn open_crews(&mut self) -> Result<(), ShopError> {
        (0..self.scenario.crews.len()).try_for_each(|crew| self.schedule_crew(crew))
    }

    /// The next shift of a crew.
    fn schedule_crew(&mut self, crew: usize) -> Result<(), ShopError> {
        let Some(calendar) = self.scenario.crews[crew].calendar.map(|index| &self.scenario.calendars[index]) else {
            return Ok(());
        };
        let mut at = self.now().seconds();
        while let Some(next) = calendar.next_boundary(at) {
            at = next.time;
            if next.starts {
                self.schedule(SimTime::from_seconds(at)?, Event::Crew { crew: crew as u32 })?;
                break;
            }
        }
        Ok(())
    }

    /// A crew comes to its shift.
    pub(super) fn crew_comes(&mut self, crew: usize) -> Result<(), ShopError> {
        self.schedule_crew(crew)?;
        self.send_crew(crew)
    }
}
