//! Planned maintenance: when its clock says that it is due, it waits for the machine to end its operation, and for its window.
//!
//! A machine in maintenance is not up, as one that is broken down; what it is in the log is told by [`Machine::maintained`].
//! Once begun, maintenance goes on to its end, whatever the shift.
//!
//! [`Machine::maintained`]: super::Machine::maintained

use super::event::Event;
use super::recorder::Recorder;
use super::{Shop, ShopError};
use crate::runlog::LogEvent;
use toolroom_kernel::{EventKey, Purpose, SimTime};
use toolroom_scenario::FailureClock;

/// Planned maintenance on its way to the next time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UpkeepState {
    /// How often it has been done: index of the next draw.
    pub count: u64,
    /// Whether it is due and has not begun.
    pub waiting: bool,
    /// Busy time left until it is due at `since`, s; of calendar clocks unused.
    pub left: f64,
    /// When the busy clock was started.
    pub since: SimTime,
    /// The time at which it is due in the calendar of events; `None` while the clock stands.
    pub due: Option<EventKey>,
}

impl<R: Recorder> Shop<'_, R> {
    /// Winds the clock of every maintenance.
    pub(super) fn open_maintenance(&mut self) -> Result<(), ShopError> {
        for index in 0..self.scenario.maintenance.len() {
            let since = SimTime::ZERO;
            self.world.upkeep.push(UpkeepState { count: 0, waiting: false, left: 0.0, since, due: None });
            self.wind_maintenance(index)?;
        }
        Ok(())
    }

    fn wind_maintenance(&mut self, index: usize) -> Result<(), ShopError> {
        let plan = &self.scenario.maintenance[index];
        match plan.clock {
            FailureClock::Busy => {
                self.world.upkeep[index].left = plan.every;
                self.start_upkeep_clocks(plan.machine)
            }
            FailureClock::Calendar => {
                // The next multiple, so that a late one does not move those that follow.
                let next = ((self.now().seconds() / plan.every).floor() + 1.0) * plan.every;
                let due = self.schedule(SimTime::from_seconds(next)?, Event::Maintenance { plan: index as u32 })?;
                self.world.upkeep[index].due = Some(due);
                Ok(())
            }
        }
    }

    /// Lets the busy clocks of a machine's maintenance run, if it works.
    pub(super) fn start_upkeep_clocks(&mut self, machine: usize) -> Result<(), ShopError> {
        let state = &self.world.machines[machine];
        if !state.is_up() || state.task.is_none() {
            return Ok(());
        }
        for place in 0..self.layout.upkeep_of[machine].len() {
            let index = self.layout.upkeep_of[machine][place];
            let clock = &self.world.upkeep[index as usize];
            let busy = self.scenario.maintenance[index as usize].clock == FailureClock::Busy;
            if !busy || clock.waiting || clock.due.is_some() {
                continue;
            }
            let time = self.now().after(clock.left)?;
            let due = self.schedule(time, Event::Maintenance { plan: index })?;
            let clock = &mut self.world.upkeep[index as usize];
            (clock.since, clock.due) = (self.calendar.now(), Some(due));
        }
        Ok(())
    }

    /// Stops the busy clocks of a machine's maintenance.
    pub(super) fn stop_upkeep_clocks(&mut self, machine: usize) {
        let now = self.now();
        for &index in &self.layout.upkeep_of[machine] {
            let clock = &mut self.world.upkeep[index as usize];
            if self.scenario.maintenance[index as usize].clock == FailureClock::Busy
                && let Some(due) = clock.due.take()
            {
                self.calendar.cancel(due);
                clock.left = (clock.left - (now - clock.since)).max(0.0);
            }
        }
    }

    /// Maintenance is due.
    pub(super) fn maintenance_due(&mut self, index: usize) -> Result<(), ShopError> {
        let state = &mut self.world.upkeep[index];
        (state.due, state.waiting) = (None, true);
        self.world.upkeep_waiting += 1;
        let machine = self.scenario.maintenance[index].machine;
        self.log_event(LogEvent::MaintenanceDue, Some(machine), None, None);
        self.window_opens(index)
    }

    /// The window of maintenance that waits may be open; looks again when it opens the next time.
    pub(super) fn window_opens(&mut self, index: usize) -> Result<(), ShopError> {
        if !self.world.upkeep[index].waiting {
            return Ok(());
        }
        let plan = &self.scenario.maintenance[index];
        if let Some(window) = plan.window.map(|window| &self.scenario.calendars[window]) {
            let mut at = self.now().seconds();
            while let Some(next) = window.next_boundary(at) {
                at = next.time;
                if next.starts {
                    self.schedule(SimTime::from_seconds(at)?, Event::Window { plan: index as u32 })?;
                    break;
                }
            }
        }
        self.may_choose(plan.machine);
        Ok(())
    }

    /// A machine has gone out of shift: maintenance that waits may begin.
    pub(super) fn look_at_upkeep(&mut self, machine: usize) {
        if self.world.upkeep_waiting > 0 {
            self.may_choose(machine);
        }
    }

    /// Machines that may choose work are maintained first where that is due.
    pub(super) fn maintain(&mut self) -> Result<(), ShopError> {
        if self.world.upkeep_waiting == 0 {
            return Ok(());
        }
        for place in 0..self.world.candidates.len() {
            let machine = self.world.candidates[place] as usize;
            for each in 0..self.layout.upkeep_of[machine].len() {
                let index = self.layout.upkeep_of[machine][each] as usize;
                if self.world.upkeep[index].waiting && self.may_be_maintained(index) {
                    self.begin_maintenance(index)?;
                }
            }
        }
        Ok(())
    }

    /// Whether maintenance may begin now: in its window or the machine's shift, between operations, or out of shift with work
    /// that stands still.
    fn may_be_maintained(&self, index: usize) -> bool {
        let plan = &self.scenario.maintenance[index];
        let state = &self.world.machines[plan.machine];
        let open = match plan.window {
            Some(window) => self.scenario.calendars[window].works_at(self.now().seconds()),
            None => !state.off_shift,
        };
        let stands = state.task.as_ref().is_none_or(|task| state.off_shift && task.end.is_none());
        open && stands && state.failures == 0
    }

    fn begin_maintenance(&mut self, index: usize) -> Result<(), ShopError> {
        let plan = &self.scenario.maintenance[index];
        let machine = plan.machine;
        let owner = self.layout.upkeep_owners[index];
        let count = self.world.upkeep[index].count;
        let time = plan.duration.sample(&mut self.streams.at(owner, Purpose::Repair, count));
        self.world.upkeep[index].waiting = false;
        self.world.upkeep_waiting -= 1;
        self.stop_clocks(machine);
        let state = &mut self.world.machines[machine];
        state.failures += 1;
        state.maintained = true;
        self.log_event(LogEvent::Maintenance, Some(machine), None, None);
        let end = self.now().after(time)?;
        self.schedule(end, Event::Maintained { plan: index as u32 })?;
        self.show_state(machine);
        Ok(())
    }

    /// Maintenance is over.
    pub(super) fn maintained(&mut self, index: usize) -> Result<(), ShopError> {
        let machine = self.scenario.maintenance[index].machine;
        self.log_event(LogEvent::MaintenanceEnd, Some(machine), None, None);
        self.world.upkeep[index].count += 1;
        let state = &mut self.world.machines[machine];
        state.failures -= 1;
        state.maintained = false;
        self.wind_maintenance(index)?;
        self.go_on(machine)
    }
}
