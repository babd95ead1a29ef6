//! Working time that changes once for good.

use crate::{Boundary, WorkingTime};

/// Working time before an instant and after it.
#[derive(Clone, Debug, PartialEq)]
pub struct Joined {
    /// The instant, s.
    pub junction: f64,
    /// Working time before it.
    pub before: Hours,
    /// Working time from it on.
    pub after: Hours,
}

/// Working time, or none, or all.
#[derive(Clone, Debug, PartialEq)]
pub enum Hours {
    /// Nobody works.
    Never,
    /// Work never stops.
    Always,
    /// Shifts.
    Shifts(WorkingTime),
}

impl Hours {
    fn works_at(&self, time: f64) -> bool {
        match self {
            Self::Never => false,
            Self::Always => true,
            Self::Shifts(shifts) => shifts.works_at(time),
        }
    }

    fn worked_until(&self, time: f64) -> f64 {
        match self {
            Self::Never => 0.0,
            Self::Always => time,
            Self::Shifts(shifts) => shifts.worked_until(time),
        }
    }

    fn shifts(&self) -> Option<&WorkingTime> {
        match self {
            Self::Never | Self::Always => None,
            Self::Shifts(shifts) => Some(shifts),
        }
    }
}

impl Joined {
    fn at(&self, time: f64) -> &Hours {
        if time < self.junction { &self.before } else { &self.after }
    }

    /// Whether work goes on at `time`, s.
    pub(crate) fn works_at(&self, time: f64) -> bool {
        self.at(time).works_at(time)
    }

    /// Working time from the start of the run to `time`, s.
    pub(crate) fn worked_until(&self, time: f64) -> f64 {
        let later = if time > self.junction {
            self.after.worked_until(time) - self.after.worked_until(self.junction)
        } else {
            0.0
        };
        self.before.worked_until(time.min(self.junction)) + later
    }

    /// The next change strictly after `time`.
    pub(crate) fn next_boundary(&self, time: f64) -> Option<Boundary> {
        let next = |hours: &Hours, time: f64| hours.shifts().and_then(|shifts| shifts.next_boundary(time));
        if time >= self.junction {
            return next(&self.after, time);
        }
        if let Some(earlier) = next(&self.before, time).filter(|boundary| boundary.time < self.junction) {
            return Some(earlier);
        }
        // Nothing changes from `time` until the calendars do.
        let starts = self.after.works_at(self.junction);
        if starts == self.before.works_at(time) {
            next(&self.after, self.junction)
        } else {
            Some(Boundary { time: self.junction, starts, pauses: false })
        }
    }

    /// Whether a break of a shift begins at `time`.
    pub(crate) fn pauses_at(&self, time: f64) -> bool {
        self.at(time).shifts().is_some_and(|shifts| shifts.pauses_at(time))
    }

    /// Name of the shift that is on or was last on.
    pub(crate) fn shift_at(&self, time: f64) -> Option<String> {
        self.at(time).shifts().and_then(|shifts| shifts.shift_at(time))
    }

    /// Most shifts of one period or day.
    pub(crate) fn shift_count(&self) -> usize {
        let count = |hours: &Hours| hours.shifts().map_or(0, WorkingTime::shift_count);
        count(&self.before).max(count(&self.after))
    }

    /// Time after which shifts repeat in the end, s; infinite where they do not.
    pub(crate) fn period(&self) -> f64 {
        self.after.shifts().map_or(f64::INFINITY, WorkingTime::period)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Periodic, Shift};

    fn day(start: f64, end: f64) -> Hours {
        Hours::Shifts(WorkingTime::Periodic(Periodic { period: 24.0, shifts: vec![Shift { start, end }] }))
    }

    fn boundaries(joined: &Joined, count: usize) -> Vec<(f64, bool)> {
        let (mut time, mut all) = (0.0, Vec::new());
        while let Some(boundary) = joined.next_boundary(time).filter(|_| all.len() < count) {
            time = boundary.time;
            all.push((boundary.time, boundary.starts));
        }
        all
    }

    #[test]
    fn hours_change_where_they_are_joined() {
        let joined = Joined { junction: 34.0, before: day(6.0, 14.0), after: day(6.0, 22.0) };
        assert_eq!(boundaries(&joined, 5), [(6.0, true), (14.0, false), (30.0, true), (46.0, false), (54.0, true)]);
        assert_eq!((joined.worked_until(34.0), joined.worked_until(48.0)), (12.0, 24.0));
        assert!(!joined.works_at(15.0) && joined.works_at(39.0));
        let later = Joined { junction: 40.0, ..joined.clone() };
        assert_eq!(boundaries(&later, 5), [(6.0, true), (14.0, false), (30.0, true), (38.0, false), (40.0, true)]);
        // Where nothing changes there is no change.
        let same = Joined { after: joined.before.clone(), ..joined };
        assert_eq!(boundaries(&same, 4), [(6.0, true), (14.0, false), (30.0, true), (38.0, false)]);
    }

    #[test]
    fn what_is_there_from_an_instant_on_begins_then() {
        let new = Joined { junction: 10.0, before: Hours::Never, after: Hours::Always };
        assert_eq!(boundaries(&new, 3), [(10.0, true)]);
        assert_eq!((new.worked_until(10.0), new.worked_until(25.0), new.shift_at(12.0)), (0.0, 15.0, None));
        let shifts = Joined { after: day(6.0, 14.0), ..new };
        assert_eq!(boundaries(&shifts, 3), [(10.0, true), (14.0, false), (30.0, true)]);
        let gone = Joined { junction: 10.0, before: Hours::Always, after: Hours::Never };
        assert_eq!(boundaries(&gone, 3), [(10.0, false)]);
    }
}
