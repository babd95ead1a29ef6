//! Working time that repeats: shifts within a period, and when they change.

use crate::{Boundary, Shift};

/// Working time that repeats.
#[derive(Clone, Debug, PartialEq)]
pub struct Periodic {
    /// Period of repetition, s (a day, a week).
    pub period: f64,
    /// Working intervals inside one period, ascending, not overlapping.
    pub shifts: Vec<Shift>,
}

impl Periodic {
    /// Whether work goes on at `time`, s.
    pub fn works_at(&self, time: f64) -> bool {
        let within = time - (time / self.period).floor() * self.period;
        self.shifts.iter().any(|shift| shift.start <= within && within < shift.end)
    }

    /// Working time from zero to `time`, s.
    pub(super) fn worked_until(&self, time: f64) -> f64 {
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
    pub fn next_boundary(&self, time: f64) -> Option<Boundary> {
        let first = (time / self.period).floor() as u64;
        // A change lies within the next two periods or there is none.
        (first..first + 3)
            .flat_map(|k| {
                let zero = k as f64 * self.period;
                let both = |shift: &Shift| [(zero + shift.start, true), (zero + shift.end, false)];
                self.shifts.iter().flat_map(both).collect::<Vec<_>>()
            })
            .filter(|&(at, _)| at > time)
            .find(|&(at, starts)| !self.touches(at, starts))
            .map(|(time, starts)| Boundary { time, starts, pauses: false })
    }

    /// Whether another shift goes on where this one ends, or ended where this one starts.
    fn touches(&self, at: f64, starts: bool) -> bool {
        let tolerance = 1e-9 * self.period;
        self.works_at(at + if starts { -tolerance } else { tolerance })
    }

    /// Name of the shift that is on or was last on, `S1`, `S2` … ; `None` without shifts.
    pub fn shift_at(&self, time: f64) -> Option<String> {
        let phase = time.rem_euclid(self.period);
        let begun = self.shifts.iter().rposition(|shift| phase >= shift.start);
        let last = self.shifts.len().checked_sub(1)?;
        Some(format!("S{}", begun.unwrap_or(last) + 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn calendar(shifts: &[(f64, f64)]) -> Periodic {
        Periodic { period: 24.0, shifts: shifts.iter().map(|&(start, end)| Shift { start, end }).collect() }
    }

    fn boundaries(calendar: &Periodic, count: usize) -> Vec<(f64, bool)> {
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
        let between = |calendar: &Periodic, start, end| calendar.worked_until(end) - calendar.worked_until(start);
        let night = calendar(&[(0.0, 6.0), (22.0, 24.0)]);
        assert_eq!((between(&night, 0.0, 48.0), between(&night, 5.0, 23.0)), (16.0, 2.0));
        assert_eq!((between(&night, 23.0, 49.0), between(&night, 7.0, 21.0)), (1.0 + 8.0 + 1.0, 0.0));
        assert_eq!(between(&calendar(&[(6.0, 14.0), (12.0, 16.0)]), 0.0, 24.0), 10.0);
        assert_eq!(between(&calendar(&[]), 0.0, 1e6), 0.0);
    }

    #[test]
    fn a_calendar_without_shifts_never_works() {
        let never = calendar(&[]);
        assert!(!never.works_at(3.0));
        assert_eq!(boundaries(&never, 1), []);
    }

    #[test]
    fn overtime_belongs_to_the_shift_before() {
        let shifts = vec![Shift { start: 6.0, end: 14.0 }, Shift { start: 14.0, end: 22.0 }];
        let calendar = Periodic { period: 24.0, shifts };
        let names: Vec<_> = [6.0, 13.9, 14.0, 23.0, 25.0].map(|time| calendar.shift_at(time)).into();
        assert_eq!(names.iter().flatten().map(String::as_str).collect::<Vec<_>>(), ["S1", "S1", "S2", "S2", "S2"]);
    }
}
