//! Planned maintenance of machines.

use super::{Distribution, FailureClock};

/// Work that is planned on a machine again and again. It waits until the machine has ended its operation, and takes the
/// time away from that which is planned for production.
#[derive(Clone, Debug)]
pub struct Maintenance {
    /// Machine, by index.
    pub machine: usize,
    /// Time on its clock until it is due, s.
    pub every: f64,
    /// Clock that runs towards it: busy time since the last one, or multiples of all time.
    pub clock: FailureClock,
    /// How long it takes.
    pub duration: Distribution,
    /// Calendar, by index, in whose working time it may begin, in the machine's shift or out of it; `None`: in the
    /// machine's own shift.
    pub window: Option<usize>,
}
