//! Orders: a quantity of one part with dates, and who takes them.

use super::{Part, Urgency, Work};
use std::cmp::Ordering;
use toolroom_form::vocabulary;

/// A quantity of one part that is released together and due together.
#[derive(Clone, Debug, PartialEq)]
pub struct Order {
    /// Name, unique; owner of its random numbers.
    pub id: String,
    /// Part, by index.
    pub part: usize,
    /// Pieces.
    pub quantity: u32,
    /// When it enters the shop, s.
    pub release: f64,
    /// When it is due, s.
    pub due: f64,
    /// The smaller, the more urgent.
    pub priority: u32,
    /// Weight of its lateness in weighted rules, 1.
    pub weight: f64,
    /// Who ordered it; empty where that is not said.
    pub customer: String,
    /// Pieces that move on together; `None`: all of them.
    pub transfer: Option<u32>,
    /// Most machines over which it is divided, each with a setup of its own; `None`: it stays on one.
    pub split: Option<u32>,
    /// Whether a machine is set up for its next operation as soon as the one before has begun.
    pub setup_ahead: bool,
    /// The order, by index, for which its pieces are made; `None`: for none.
    pub parent: Option<usize>,
    /// Pieces that are begun beyond the quantity, because some will be lost.
    pub overrun: u32,
    /// How far it has come when the run begins; `None`: it is released in the run.
    pub in_process: Option<InProcess>,
}

/// An order that is in the shop when the run begins.
#[derive(Clone, Debug, PartialEq)]
pub struct InProcess {
    /// The operation for which it waits or in which it is, by index.
    pub operation: usize,
    /// The machine that works on it or is kept for it, by index; `None`: it waits.
    pub machine: Option<usize>,
    /// Share of the operation that is done, 0 to below 1; of its pieces where they move apart.
    pub done: f64,
    /// What the machine still has to be set up for it, s.
    pub setup_left: f64,
    /// When it came to where it is, s, not after 0: who came first stands in front.
    pub since: f64,
}

/// Names in the order in which people count them: digits by the number that they make, so that O2 is before O10.
///
/// # Examples
/// ```
/// use toolroom_scenario::by_id;
/// let mut ids = ["O10", "O2", "A7-11", "A7-9", "O2b"];
/// ids.sort_by(|a, b| by_id(a, b));
/// assert_eq!(ids, ["A7-9", "A7-11", "O2", "O2b", "O10"]);
/// ```
pub fn by_id(a: &str, b: &str) -> Ordering {
    let (mut left, mut right) = (a, b);
    while let (Some(first), Some(other)) = (left.chars().next(), right.chars().next()) {
        let order = if first.is_ascii_digit() && other.is_ascii_digit() {
            let (number, other);
            (number, left) = digits(left);
            (other, right) = digits(right);
            number.len().cmp(&other.len()).then(number.cmp(other))
        } else {
            (left, right) = (&left[first.len_utf8()..], &right[other.len_utf8()..]);
            first.cmp(&other)
        };
        if order.is_ne() {
            return order;
        }
    }
    // O02 and O2 are two names.
    left.len().cmp(&right.len()).then(a.cmp(b))
}

/// The digits at the beginning, without leading zeros, and what follows.
fn digits(text: &str) -> (&str, &str) {
    let end = text.find(|letter: char| !letter.is_ascii_digit()).unwrap_or(text.len());
    (text[..end].trim_start_matches('0'), &text[end..])
}

impl Order {
    /// What makes it go before others.
    pub fn urgency(&self) -> Urgency {
        Urgency { priority: self.priority, weight: self.weight, due: self.due }
    }

    /// Pieces that are begun: those that are ordered, and its overrun.
    pub fn pieces(&self) -> u32 {
        self.quantity.saturating_add(self.overrun)
    }

    /// Pieces that make one job: all that move on together where all work is plain and no order is divided over several
    /// machines, else one.
    pub fn job_size(&self, part: &Part) -> u32 {
        let plain = self.split.is_none_or(|most| most < 2)
            && part.operations.iter().all(|operation| matches!(operation.work, Work::Plain(_)));
        if plain { self.transfer.unwrap_or(self.pieces()).min(self.pieces()) } else { 1 }
    }

    /// Whether it goes through the shop as several jobs.
    pub fn is_divided(&self, part: &Part) -> bool {
        self.pieces() > self.job_size(part)
    }

    /// Whether machines are kept for it: it goes through the shop as several jobs, or is awaited by them.
    pub fn keeps_machines(&self, part: &Part) -> bool {
        self.is_divided(part) || self.setup_ahead
    }

    /// Of the jobs in which it goes through the shop, those that have passed the operation at which it is when the
    /// run begins. An order that is one job has not.
    pub fn jobs_passed(&self, part: &Part) -> u32 {
        let jobs = self.pieces().div_ceil(self.job_size(part));
        // Whole pieces: 0.3 of 10 are 3.
        let done = |own: &InProcess| (own.done * f64::from(self.pieces()) + 1e-9) as u32 / self.job_size(part);
        self.in_process.as_ref().filter(|_| jobs > 1).map_or(0, |own| done(own).min(jobs - 1))
    }

    /// Share of the operation at which it is when the run begins that is done of its job number `index`, from 0: all of it
    /// up to those that have passed, and nothing from the one after that in work on.
    pub fn share_done(&self, part: &Part, index: u32) -> f64 {
        let Some(in_process) = &self.in_process else { return 0.0 };
        let size = self.job_size(part);
        let (before, pieces) = (index * size, size.min(self.pieces() - index * size));
        let share = (in_process.done * f64::from(self.pieces()) - f64::from(before)) / f64::from(pieces);
        if share < 1e-9 { 0.0 } else { share.min(1.0) }
    }

    /// Share of an operation that is still to be done when the run begins.
    pub fn share_left(&self, operation: usize) -> f64 {
        match &self.in_process {
            Some(own) if operation < own.operation => 0.0,
            Some(own) if operation == own.operation => 1.0 - own.done,
            Some(_) | None => 1.0,
        }
    }

    /// Pieces that had left the shop before the run began.
    pub fn finished_before(&self, part: &Part) -> u32 {
        let last = self.in_process.as_ref().is_some_and(|own| own.operation + 1 == part.operations.len());
        if last { self.jobs_passed(part) * self.job_size(part) } else { 0 }
    }
}

vocabulary! {
    /// Which of several idle machines takes a job that each of them may do; ties go to the first of the file.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum MachineChoice {
        /// The one that needs the least setup for it.
        LeastSetup = "least_setup",
        /// The first of the file.
        First = "first",
        /// The one that has been idle for longest.
        LongestIdle = "longest_idle",
        /// The one that would be done first, its setup included.
        EarliestFinish = "earliest_finish",
        /// The one that needs the least time for it, without setup.
        Fastest = "fastest",
        /// The one that has worked least so far.
        LeastUsed = "least_used",
        /// Any of them.
        Random = "random",
    }
}
