//! Working time: shifts that repeat, or shifts of dates.
#![deny(clippy::wildcard_enum_match_arm)]

pub mod date;
mod dated;
mod joined;
mod pace;
mod periodic;

pub use dated::{Dated, PacedShift, WeekPlan};
pub use joined::{Hours, Joined};
pub use pace::Paces;
pub use periodic::Periodic;

use toolroom_form::vocabulary;

vocabulary! {
    /// What becomes of an operation that is interrupted.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Interruption {
        /// Finish it first (shift ends only).
        Finish = "finish",
        /// Go on from where it stopped.
        Resume = "resume",
        /// Start the operation again.
        Repeat = "repeat",
        /// The part is lost.
        Scrap = "scrap",
    }
}

/// When a machine or a person works.
#[derive(Clone, Debug, PartialEq)]
pub struct ShiftCalendar {
    /// Name, unique.
    pub name: String,
    /// The shifts.
    pub time: WorkingTime,
    /// What happens to the part in the machine when a shift ends.
    pub at_end: Interruption,
    /// A step that needs no more than this when a shift ends is finished first, s.
    pub finish_within: f64,
    /// Whether an operation is begun only where it will be over before the shift is.
    pub start_only_if_fits: bool,
    /// Shifts in which work goes slower or faster than planned.
    pub paces: Paces,
}

/// Shifts.
#[derive(Clone, Debug, PartialEq)]
pub enum WorkingTime {
    /// The same in every period.
    Periodic(Periodic),
    /// Of dates: by weekday, with holidays and overtime.
    Dated(Dated),
    /// One until an instant, another from it on.
    Joined(Box<Joined>),
}

/// One working interval, s from the start of a period or of the run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shift {
    /// Start, s.
    pub start: f64,
    /// End, s.
    pub end: f64,
}

/// A change of working time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Boundary {
    /// Instant, s.
    pub time: f64,
    /// Whether work begins there.
    pub starts: bool,
    /// Whether a break begins there: the shift goes on after it.
    pub pauses: bool,
}

impl ShiftCalendar {
    /// Shifts that repeat after `period`, s.
    pub fn periodic(name: &str, period: f64, shifts: Vec<Shift>, at_end: Interruption) -> Self {
        let time = WorkingTime::Periodic(Periodic { period, shifts });
        let (name, paces) = (name.to_owned(), Paces::default());
        Self { name, time, at_end, finish_within: 0.0, start_only_if_fits: false, paces }
    }

    /// Whether work goes on at `time`, s.
    pub fn works_at(&self, time: f64) -> bool {
        self.time.works_at(time)
    }

    /// Working time from `start` to `end`, s. Shifts that overlap count once.
    ///
    /// # Examples
    /// ```
    /// use toolroom_calendar::{Interruption, Shift, ShiftCalendar};
    /// let shifts = vec![Shift { start: 6.0, end: 14.0 }];
    /// let early = ShiftCalendar::periodic("early", 24.0, shifts, Interruption::Resume);
    /// assert_eq!((early.working_time(0.0, 48.0), early.working_time(10.0, 31.0)), (16.0, 5.0));
    /// ```
    pub fn working_time(&self, start: f64, end: f64) -> f64 {
        (self.time.worked_until(end) - self.time.worked_until(start)).max(0.0)
    }

    /// Work as planned that is done from `start` to `end`, s: [`working_time`](Self::working_time) at the pace of its shifts.
    pub fn work_done(&self, start: f64, end: f64) -> f64 {
        let working = |from: f64, to: f64| self.working_time(from, to);
        working(start, end) + self.paces.surplus((start, end), working)
    }

    /// The next change strictly after `time`; shifts that touch are one. `None` where work never
    /// stops or never begins.
    pub fn next_boundary(&self, time: f64) -> Option<Boundary> {
        self.time.next_boundary(time)
    }

    /// When the shift that is on at `time` ends, s, its breaks left aside; `None` out of shifts, and where work never stops.
    pub fn shift_end(&self, time: f64) -> Option<f64> {
        let mut boundary = self.next_boundary(time).filter(|next| !next.starts)?;
        while boundary.pauses {
            boundary = self.next_boundary(boundary.time).and_then(|start| self.next_boundary(start.time))?;
        }
        Some(boundary.time)
    }

    /// Whether a break of a shift begins at `time`, s.
    pub fn pauses_at(&self, time: f64) -> bool {
        self.time.pauses_at(time)
    }

    /// Name of the shift that is on or was last on, `S1`, `S2` … ; `None` without shifts.
    pub fn shift_at(&self, time: f64) -> Option<String> {
        self.time.shift_at(time)
    }

    /// Most shifts of one period or day.
    pub fn shift_count(&self) -> usize {
        self.time.shift_count()
    }

    /// Time after which shifts repeat, s; of dates it is a week, holidays and overtime aside.
    pub fn period(&self) -> f64 {
        self.time.period()
    }
}

impl WorkingTime {
    fn works_at(&self, time: f64) -> bool {
        match self {
            Self::Periodic(shifts) => shifts.works_at(time),
            Self::Dated(shifts) => shifts.works_at(time),
            Self::Joined(both) => both.works_at(time),
        }
    }

    fn worked_until(&self, time: f64) -> f64 {
        match self {
            Self::Periodic(shifts) => shifts.worked_until(time),
            Self::Dated(shifts) => shifts.worked_until(time),
            Self::Joined(both) => both.worked_until(time),
        }
    }

    fn next_boundary(&self, time: f64) -> Option<Boundary> {
        match self {
            Self::Periodic(shifts) => shifts.next_boundary(time),
            Self::Dated(shifts) => shifts.next_boundary(time),
            Self::Joined(both) => both.next_boundary(time),
        }
    }

    fn pauses_at(&self, time: f64) -> bool {
        match self {
            Self::Periodic(_) => false,
            Self::Dated(shifts) => shifts.pauses_at(time),
            Self::Joined(both) => both.pauses_at(time),
        }
    }

    fn shift_at(&self, time: f64) -> Option<String> {
        match self {
            Self::Periodic(shifts) => shifts.shift_at(time),
            Self::Dated(shifts) => shifts.shift_at(time),
            Self::Joined(both) => both.shift_at(time),
        }
    }

    fn shift_count(&self) -> usize {
        match self {
            Self::Periodic(shifts) => shifts.shifts.len(),
            Self::Dated(shifts) => shifts.shift_count(),
            Self::Joined(both) => both.shift_count(),
        }
    }

    fn period(&self) -> f64 {
        match self {
            Self::Periodic(shifts) => shifts.period,
            Self::Dated(_) => dated::WEEK,
            Self::Joined(both) => both.period(),
        }
    }
}
