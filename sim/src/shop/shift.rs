//! Shifts: when a machine may work, and what happens when it may no longer.

use super::event::Event;
use super::recorder::Recorder;
use super::{Shop, ShopError};
use crate::SimTime;
use crate::runlog::JobOutcome;
use crate::scenario::{Interruption, ShiftCalendar};

/// A change of working time.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Boundary {
    time: f64,
    /// Whether work begins there.
    starts: bool,
}

impl ShiftCalendar {
    /// Whether work goes on at `time`, s.
    pub fn works_at(&self, time: f64) -> bool {
        let within = time - (time / self.period).floor() * self.period;
        self.shifts.iter().any(|shift| shift.start <= within && within < shift.end)
    }

    /// Working time from `start` to `end`, s. Shifts that overlap count once.
    ///
    /// # Examples
    /// ```
    /// use toolroom_sim::scenario::{Interruption, Shift, ShiftCalendar};
    /// let shifts = vec![Shift { start: 6.0, end: 14.0 }];
    /// let early = ShiftCalendar { name: "early".into(), period: 24.0, shifts, at_end: Interruption::Resume };
    /// assert_eq!((early.working_time(0.0, 48.0), early.working_time(10.0, 31.0)), (16.0, 5.0));
    /// ```
    pub fn working_time(&self, start: f64, end: f64) -> f64 {
        (self.worked_until(end) - self.worked_until(start)).max(0.0)
    }

    /// Working time from zero to `time`, s.
    fn worked_until(&self, time: f64) -> f64 {
        let periods = (time / self.period).floor();
        let within = time - periods * self.period;
        periods * self.worked_within(self.period) + self.worked_within(within)
    }

    /// Working time from the start of a period to `within` it, s. Shifts are ascending.
    fn worked_within(&self, within: f64) -> f64 {
        let (mut worked, mut until) = (0.0, 0.0_f64);
        for shift in &self.shifts {
            worked += (shift.end.min(within) - shift.start.max(until)).max(0.0);
            until = until.max(shift.end);
        }
        worked
    }

    /// The next change strictly after `time`; shifts that touch are one. `None` where work never
    /// stops or never begins.
    fn next_boundary(&self, time: f64) -> Option<Boundary> {
        let first = (time / self.period).floor() as u64;
        // A change lies within the next two periods or there is none.
        (first..first + 3)
            .flat_map(|k| {
                let zero = k as f64 * self.period;
                let both = |shift: &crate::scenario::Shift| [(zero + shift.start, true), (zero + shift.end, false)];
                self.shifts.iter().flat_map(both).collect::<Vec<_>>()
            })
            .filter(|&(at, _)| at > time)
            .find(|&(at, starts)| !self.touches(at, starts))
            .map(|(time, starts)| Boundary { time, starts })
    }

    /// Whether another shift goes on where this one ends, or ended where this one starts.
    fn touches(&self, at: f64, starts: bool) -> bool {
        let tolerance = 1e-9 * self.period;
        self.works_at(at + if starts { -tolerance } else { tolerance })
    }
}

impl<R: Recorder> Shop<'_, R> {
    /// Puts every machine in or out of shift at time zero.
    pub(super) fn open_shifts(&mut self) -> Result<(), ShopError> {
        for machine in 0..self.scenario.machines.len() {
            if let Some(calendar) = self.calendar_of(machine) {
                let off = !calendar.works_at(0.0);
                self.world.machines[machine].off_shift = off;
                self.schedule_boundary(machine)?;
            }
        }
        Ok(())
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

    pub(super) fn shift_starts(&mut self, machine: usize) -> Result<(), ShopError> {
        self.log_event("shift_start", Some(machine), None, None);
        self.schedule_boundary(machine)?;
        let state = &mut self.world.machines[machine];
        state.leaving = false;
        state.off_shift = false;
        self.go_on(machine)
    }

    pub(super) fn shift_ends(&mut self, machine: usize) -> Result<(), ShopError> {
        self.log_event("shift_end", Some(machine), None, None);
        self.schedule_boundary(machine)?;
        let at_end = self.calendar_of(machine).map_or(Interruption::Finish, |calendar| calendar.at_end);
        // A part in a machine that is down cannot be finished; it stays where it is.
        let state = &mut self.world.machines[machine];
        if state.task.is_some() && state.is_up() && at_end == Interruption::Finish {
            state.leaving = true;
            return Ok(());
        }
        self.interrupt(machine, at_end, JobOutcome::ShiftEnd)?;
        self.world.machines[machine].off_shift = true;
        self.show_state(machine);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::Shift;

    fn calendar(shifts: &[(f64, f64)]) -> ShiftCalendar {
        let shifts = shifts.iter().map(|&(start, end)| Shift { start, end }).collect();
        ShiftCalendar { name: String::new(), period: 24.0, shifts, at_end: Interruption::Finish }
    }

    fn boundaries(calendar: &ShiftCalendar, count: usize) -> Vec<(f64, bool)> {
        let mut time = 0.0;
        let mut all = Vec::new();
        while let Some(boundary) = calendar.next_boundary(time).filter(|_| all.len() < count) {
            time = boundary.time;
            all.push((boundary.time, boundary.starts));
        }
        all
    }

    #[test]
    fn one_shift_a_day_starts_and_ends_every_day() {
        let calendar = calendar(&[(6.0, 14.0)]);
        assert!(!calendar.works_at(0.0) && calendar.works_at(6.0) && !calendar.works_at(14.0));
        assert_eq!(boundaries(&calendar, 4), [(6.0, true), (14.0, false), (30.0, true), (38.0, false)]);
    }

    #[test]
    fn shifts_that_touch_are_one() {
        assert_eq!(boundaries(&calendar(&[(0.0, 8.0), (8.0, 24.0)]), 4), []);
        assert_eq!(boundaries(&calendar(&[(0.0, 6.0), (22.0, 24.0)]), 3), [(6.0, false), (22.0, true), (30.0, false)]);
    }

    #[test]
    fn working_time_is_that_of_all_periods_and_counts_overlaps_once() {
        let night = calendar(&[(0.0, 6.0), (22.0, 24.0)]);
        assert_eq!((night.working_time(0.0, 48.0), night.working_time(5.0, 23.0)), (16.0, 2.0));
        assert_eq!((night.working_time(23.0, 49.0), night.working_time(7.0, 21.0)), (1.0 + 8.0 + 1.0, 0.0));
        assert_eq!(calendar(&[(6.0, 14.0), (12.0, 16.0)]).working_time(0.0, 24.0), 10.0);
        assert_eq!(calendar(&[]).working_time(0.0, 1e6), 0.0);
    }

    #[test]
    fn a_calendar_without_shifts_never_works() {
        let never = calendar(&[]);
        assert!(!never.works_at(3.0));
        assert_eq!(boundaries(&never, 1), []);
    }
}
