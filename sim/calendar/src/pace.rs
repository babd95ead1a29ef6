//! Shifts in which work goes slower or faster than planned.

use crate::Shift;

/// How fast work goes: a factor on its speed in some stretches of time, and 1 in all others.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Paces {
    /// Stretches, s since the start, each with its factor; ascending, not overlapping.
    stretches: Vec<(Shift, f64)>,
}

impl Paces {
    /// Stretches (s since the start), each with its factor above 0; where two overlap the later one counts from its start.
    pub fn new(mut stretches: Vec<(Shift, f64)>) -> Self {
        stretches.sort_by(|a, b| a.0.start.total_cmp(&b.0.start));
        let starts: Vec<f64> = stretches.iter().map(|(own, _)| own.start).skip(1).collect();
        for ((own, _), next) in stretches.iter_mut().zip(starts) {
            own.end = own.end.min(next);
        }
        stretches.retain(|(own, factor)| own.start < own.end && *factor != 1.0);
        Self { stretches }
    }

    /// Whether work always goes as planned.
    pub fn is_even(&self) -> bool {
        self.stretches.is_empty()
    }

    fn at(&self, time: f64) -> Option<&(Shift, f64)> {
        let begun = self.stretches.partition_point(|(own, _)| own.start <= time);
        self.stretches[..begun].last().filter(|(own, _)| time < own.end)
    }

    /// Factor on the speed of work at `time`, s.
    ///
    /// # Examples
    /// ```
    /// use toolroom_calendar::{Paces, Shift};
    /// let night = Paces::new(vec![(Shift { start: 22.0, end: 30.0 }, 0.8)]);
    /// assert_eq!([21.0, 22.0, 29.0, 30.0].map(|time| night.factor_at(time)), [1.0, 0.8, 0.8, 1.0]);
    /// assert_eq!((night.next_change(5.0), night.next_change(22.0), night.next_change(30.0)), (Some(22.0), Some(30.0), None));
    /// ```
    pub fn factor_at(&self, time: f64) -> f64 {
        self.at(time).map_or(1.0, |(_, factor)| *factor)
    }

    /// The next instant strictly after `time` at which the factor changes, s.
    pub fn next_change(&self, time: f64) -> Option<f64> {
        if let Some((own, _)) = self.at(time) {
            return Some(own.end);
        }
        let begun = self.stretches.partition_point(|(own, _)| own.start <= time);
        self.stretches.get(begun).map(|(own, _)| own.start)
    }

    /// What the factors add to the time from `start` to `end`, s, of which `working` says how much of any stretch is worked:
    /// below zero where work is slower.
    pub(crate) fn surplus(&self, (start, end): (f64, f64), working: impl Fn(f64, f64) -> f64) -> f64 {
        let inside = |(own, factor): &(Shift, f64)| {
            let (from, to) = (own.start.max(start), own.end.min(end));
            if from < to { (factor - 1.0) * working(from, to) } else { 0.0 }
        };
        self.stretches.iter().map(inside).sum()
    }

    /// These until `at`, s, and `after` from then on.
    #[must_use]
    pub fn joined(&self, at: f64, after: &Self) -> Self {
        let before = self.stretches.iter().map(|(own, factor)| (Shift { end: own.end.min(at), ..*own }, *factor));
        let later = after.stretches.iter().map(|(own, factor)| (Shift { start: own.start.max(at), ..*own }, *factor));
        Self { stretches: before.chain(later).filter(|(own, _)| own.start < own.end).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stretch(start: f64, end: f64, factor: f64) -> (Shift, f64) {
        (Shift { start, end }, factor)
    }

    #[test]
    fn stretches_that_touch_change_at_once() {
        let paces = Paces::new(vec![stretch(14.0, 22.0, 0.9), stretch(22.0, 30.0, 0.8), stretch(6.0, 14.0, 1.0)]);
        assert_eq!([13.0, 14.0, 21.9, 22.0].map(|time| paces.factor_at(time)), [1.0, 0.9, 0.9, 0.8]);
        assert_eq!([0.0, 14.0, 22.0].map(|time| paces.next_change(time)), [Some(14.0), Some(22.0), Some(30.0)]);
        // Eight hours less a tenth, and four hours less a fifth.
        assert!((paces.surplus((0.0, 26.0), |from, to| to - from) - (-0.8 - 0.8)).abs() < 1e-12);
    }

    #[test]
    fn paces_change_where_calendars_do() {
        let (before, after) = (Paces::new(vec![stretch(0.0, 10.0, 0.5)]), Paces::new(vec![stretch(2.0, 8.0, 2.0)]));
        let joined = before.joined(4.0, &after);
        assert_eq!([3.0, 4.0, 9.0].map(|time| joined.factor_at(time)), [0.5, 2.0, 1.0]);
        assert!(Paces::default().joined(4.0, &Paces::default()).is_even());
    }
}
