//! Orders: a quantity of one part with dates, and who takes them.

use super::{Part, Work};
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
}

impl Order {
    /// Pieces that make one job: all that move on together where all work is plain, else one.
    pub fn job_size(&self, part: &Part) -> u32 {
        let plain = part.operations.iter().all(|operation| matches!(operation.work, Work::Plain(_)));
        if plain { self.transfer.unwrap_or(self.quantity).min(self.quantity) } else { 1 }
    }

    /// Whether it goes through the shop as several jobs.
    pub fn is_divided(&self, part: &Part) -> bool {
        self.quantity > self.job_size(part)
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
    }
}
