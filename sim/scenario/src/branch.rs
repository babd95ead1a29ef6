//! A shop that is changed while it runs.

use super::{DispatchRule, MachineChoice};

/// How a shop was ruled until it was changed. All else that the change does is said by dates: calendars that are joined,
/// orders that are released later.
#[derive(Clone, Debug, PartialEq)]
pub struct Branch {
    /// When it is changed, s.
    pub at: f64,
    /// Rules of the queues before, by machine.
    pub rules: Vec<Vec<DispatchRule>>,
    /// Which of several idle machines took a job before.
    pub machine_choice: MachineChoice,
    /// Orders as they were before, by order.
    pub orders: Vec<Urgency>,
}

/// What makes an order go before others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Urgency {
    /// The smaller, the more urgent.
    pub priority: u32,
    /// Weight of its lateness in weighted rules.
    pub weight: f64,
    /// When it is due, s.
    pub due: f64,
}
