//! Where parts stand between machines.

use super::BatchUnit;
use toolroom_form::vocabulary;

/// Places for jobs before or behind machines. A job is a part, or all that moves together of an order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Buffer {
    /// Name, for messages.
    pub name: String,
    /// How many jobs or pieces may stand in it, beside those on the machines themselves.
    pub places: u32,
    /// What takes a place.
    pub unit: BatchUnit,
    /// Machines that it stands before (an input buffer) or behind (an output buffer), by index.
    pub machines: Vec<usize>,
}

vocabulary! {
    /// When a machine is held up by the lack of a place for its part.
    ///
    /// # Source
    /// A. Buzacott, J. G. Shanthikumar, Stochastic Models of Manufacturing Systems (1993), chapter 5: blocking
    /// after service (manufacturing, production) and before service (communication).
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Blocking {
        /// A part that is done stays on its machine until there is a place.
        AfterService = "after_service",
        /// A machine begins only when a place is reserved for the part.
        BeforeService = "before_service",
    }
}

vocabulary! {
    /// What happens when parts wait for each other's places in a circle.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Deadlock {
        /// The run stops and names the circle.
        Stop = "stop",
        /// The parts of the circle change places in no time.
        Swap = "swap",
    }
}
