//! Shifts: when a machine may work, and what happens when it may no longer.

use super::event::Event;
use super::recorder::Recorder;
use super::task::Step;
use super::{Shop, ShopError};
use crate::runlog::{JobOutcome, LogEvent};
use toolroom_kernel::SimTime;
use toolroom_scenario::{Interruption, ShiftCalendar};

impl<R: Recorder> Shop<'_, R> {
    /// Puts every machine in or out of shift at time zero.
    pub(super) fn open_shifts(&mut self) -> Result<(), ShopError> {
        for machine in 0..self.scenario.machines.len() {
            if let Some(calendar) = self.calendar_of(machine) {
                let off = !calendar.works_at(0.0);
                self.world.machines[machine].off_shift = off;
                self.schedule_boundary(machine)?;
                self.schedule_pace(machine)?;
            }
        }
        Ok(())
    }

    /// Puts the next change of the pace of a machine into the calendar.
    fn schedule_pace(&mut self, machine: usize) -> Result<(), ShopError> {
        let now = self.now().seconds();
        if let Some(change) = self.calendar_of(machine).and_then(|calendar| calendar.paces.next_change(now)) {
            self.schedule(SimTime::from_seconds(change)?, Event::Pace { machine: machine as u32 })?;
        }
        Ok(())
    }

    /// How fast setups, handling and plain work go on a machine that began with them at `time`: a factor that does not change
    /// before the next change of pace.
    #[inline]
    pub(super) fn pace_at(&self, machine: usize, time: SimTime) -> f64 {
        if !self.layout.uneven {
            return 1.0;
        }
        self.calendar_of(machine).map_or(1.0, |calendar| calendar.paces.factor_at(time.seconds()))
    }

    /// How fast the step of a machine goes.
    #[inline]
    pub(super) fn step_pace(&self, machine: usize) -> f64 {
        let task = self.world.machines[machine].task.as_ref().filter(|task| task.step.is_paced());
        task.map_or(1.0, |task| self.pace_at(machine, task.since))
    }

    /// Work goes faster or slower on a machine from now on.
    pub(super) fn pace_changes(&mut self, machine: usize) -> Result<(), ShopError> {
        self.schedule_pace(machine)?;
        let task = self.world.machines[machine].task.as_ref();
        if !task.is_some_and(|task| task.end.is_some() && task.step.is_paced()) {
            return Ok(()); // nothing moves, or what does takes its time
        }
        self.halt(machine)?;
        self.drive(machine, false)
    }

    fn calendar_of(&self, machine: usize) -> Option<&ShiftCalendar> {
        self.scenario.machines[machine].calendar.map(|index| &self.scenario.calendars[index])
    }

    fn schedule_boundary(&mut self, machine: usize) -> Result<(), ShopError> {
        let now = self.now().seconds();
        let Some(boundary) = self.calendar_of(machine).and_then(|calendar| calendar.next_boundary(now)) else {
            return Ok(());
        };
        let index = machine as u32;
        let event =
            if boundary.starts { Event::ShiftStart { machine: index } } else { Event::ShiftEnd { machine: index } };
        self.schedule(SimTime::from_seconds(boundary.time)?, event)?;
        Ok(())
    }

    /// Whether a machine begins operations only where they will be over before its shift is.
    pub(super) fn looks_at_shift_end(&self, machine: usize) -> bool {
        self.layout.machine_plans[machine].fits_shifts
    }

    /// Whether a machine may begin the operation of a job now: where its calendar asks for it, only what will be over before
    /// the shift is, with its setup; by the time that is drawn or programmed, and mean times of loading and unloading.
    pub(super) fn fits(&self, machine: usize, slot: u32) -> bool {
        if !self.looks_at_shift_end(machine) {
            return true;
        }
        let now = self.now().seconds();
        let Some(calendar) = self.calendar_of(machine) else { return true };
        let Some(end) = calendar.shift_end(now) else { return true };
        let job = self.world.jobs.at(slot);
        let (part, index) = (job.row.part as usize, job.operation as usize);
        let setup = self.setup_of_next(machine, slot);
        let handling = self.layout.operations[part][index].known_time * f64::from(job.row.quantity);
        let work = job.rest.map_or_else(|| self.time_in_line(slot, machine), |rest| rest + handling);
        let whole = setup.unwrap_or(0.0) + work;
        // Breaks are no time to work in; a nanosecond more than the rounding of sums of times.
        whole <= calendar.work_done(now, end) + 1e-9
    }

    pub(super) fn shift_starts(&mut self, machine: usize) -> Result<(), ShopError> {
        self.log_event(LogEvent::ShiftStart, Some(machine), None, None);
        self.schedule_boundary(machine)?;
        let state = &mut self.world.machines[machine];
        state.leaving = false;
        state.off_shift = false;
        self.go_on(machine)
    }

    pub(super) fn shift_ends(&mut self, machine: usize) -> Result<(), ShopError> {
        self.log_event(LogEvent::ShiftEnd, Some(machine), None, None);
        self.schedule_boundary(machine)?;
        let now = self.now().seconds();
        let (at_end, within) = self.calendar_of(machine).map_or((Interruption::Finish, 0.0), |calendar| {
            // After a break the work goes on, whatever becomes of it when the shift is over.
            let at_end = if calendar.pauses_at(now) { Interruption::Resume } else { calendar.at_end };
            (at_end, calendar.finish_within)
        });
        let finishes = |left: f64| at_end == Interruption::Finish || left <= within;
        // A part in a machine that is down cannot be finished; it stays where it is.
        let state = &self.world.machines[machine];
        let lacks_tool = state.task.as_ref().is_some_and(|task| matches!(task.step, Step::NoTool));
        if lacks_tool {
            // Nobody waits after the shift for an edge: the part stays for the next one.
            self.stop_clocks(machine);
            self.world.machines[machine].off_shift = true;
            self.look_at_upkeep(machine);
            self.show_state(machine);
            return Ok(());
        }
        if state.is_up() && self.left_in(machine).is_some_and(finishes) {
            self.world.machines[machine].leaving = true;
            return Ok(());
        }
        self.interrupt(machine, at_end, JobOutcome::ShiftEnd)?;
        self.world.machines[machine].off_shift = true;
        self.look_at_upkeep(machine);
        self.show_state(machine);
        Ok(())
    }
}
