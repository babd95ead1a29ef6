//! Why a run stopped.

use toolroom_kernel::KernelError;
use toolroom_process::ModelError;
use toolroom_scenario::policies::ResolveError;

/// Codes of what stops a shop on its way, each with its explanation.
pub const CODES: &[(&str, &str)] = &[(
    "deadlock",
    "Parts wait for each other's places in a circle, so that none of them can ever move: A holds a part that wants B, which holds a part that wants A. The message names the time at which the circle formed and who holds what. A place more in the circle (`input_buffer`, `output_buffer`, `[[buffer]]`), fewer parts in the shop (`constant_work`), or `deadlock = \"swap\"` in [dispatch], which lets the parts of the circle change places in no time, help. Cards of a [[loop]] are such places too: then more `cards`, or loops that do not lead into each other, help; cards are not swapped. Where fixtures travel with parts, a circle may close over them as well: a fixture more, or fewer parts in the shop. docs/guide/shops.md says when parts move.",
)];

/// Why a shop could not be made or stopped.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ShopError {
    /// A process model refused an operation.
    #[error(transparent)]
    Model(#[from] Box<Refusal>),
    /// A policy could not be worked out for the scenario.
    #[error(transparent)]
    Policy(#[from] ResolveError),
    /// An event in the past or a time that is no number.
    #[error(transparent)]
    Kernel(#[from] KernelError),
    /// An operation without a machine that may do it.
    #[error("operation `{operation}` of part `{part}` has no machine")]
    NoMachine {
        /// Part name.
        part: String,
        /// Operation name.
        operation: String,
    },
    /// An operation that is cut has a tool, plain work has none.
    #[error("operation `{operation}` of part `{part}` has a tool and plain work, or neither")]
    ToolAndWork {
        /// Part name.
        part: String,
        /// Operation name.
        operation: String,
    },
    /// A breakdown cannot wait for the part to be finished.
    #[error("failure {mode} of machine `{machine}` would let the part be finished; use resume, repeat or scrap")]
    FailureFinishesPart {
        /// Index of the failure mode.
        mode: usize,
        /// Machine name.
        machine: String,
    },
    /// A unit without FMU state on a machine that is interrupted within passes.
    #[error(
        "tool `{tool}` is a unit that cannot go back to an earlier state (canGetAndSetFMUState), but \
         passes on machine `{machine}` are interrupted by {by}: do without, or export the unit with FMU state"
    )]
    CannotGoBack {
        /// Tool name.
        tool: String,
        /// Machine name.
        machine: String,
        /// What interrupts them.
        by: String,
    },
    /// A process of fixed steps that no step brings to the end of a pass.
    #[error(
        "tool \"{tool}\" takes steps of {step} s only, and a pass of operation \"{operation}\" takes {pass:.1} s: its end cannot be \
         met within half a step; get a unit with steps of at most {longest:.1} s"
    )]
    FixedStep {
        /// Tool name.
        tool: String,
        /// Operation name.
        operation: String,
        /// The only step, s.
        step: f64,
        /// Time of the pass as programmed, s.
        pass: f64,
        /// Longest step that meets its end, s.
        longest: f64,
    },
    /// Parts wait for each other's places.
    #[error(
        "deadlock at {time} s: {circle}: add a place with `input_buffer`, or write deadlock = \"swap\" in [dispatch]"
    )]
    Deadlock {
        /// When it formed, s.
        time: f64,
        /// Who holds what and wants what.
        circle: String,
    },
    /// Jobs wait for each other's cards.
    #[error(
        "deadlock at {time} s: {circle}: add `cards` to a loop of the circle, or let the loops not lead into each other"
    )]
    CardDeadlock {
        /// When it formed, s.
        time: f64,
        /// Who has what and wants what.
        circle: String,
    },
    /// Jobs that travel with fixtures wait for each other in a circle.
    #[error("deadlock at {time} s: {circle}: add a fixture or a place, or let fewer jobs in at once")]
    FixtureDeadlock {
        /// When it formed, s.
        time: f64,
        /// Who holds what and wants what.
        circle: String,
    },
    /// The clock stands still: a source or a routing without any duration.
    #[error("{events} events at {time} s: the shop makes no progress")]
    NoProgress {
        /// Simulated time, s.
        time: f64,
        /// Events at that instant.
        events: u64,
    },
}

impl ShopError {
    /// Whether no run of the shop would begin: what `check` refuses as well.
    pub fn is_of_the_scenario(&self) -> bool {
        match self {
            Self::Policy(_)
            | Self::NoMachine { .. }
            | Self::ToolAndWork { .. }
            | Self::FailureFinishesPart { .. }
            | Self::CannotGoBack { .. }
            | Self::FixedStep { .. } => true,
            Self::Model(_)
            | Self::Kernel(_)
            | Self::Deadlock { .. }
            | Self::CardDeadlock { .. }
            | Self::FixtureDeadlock { .. }
            | Self::NoProgress { .. } => false,
        }
    }

    /// A word for programs, where the error has one of its own.
    pub fn code(&self) -> Option<&'static str> {
        let is_deadlock =
            matches!(self, Self::Deadlock { .. } | Self::CardDeadlock { .. } | Self::FixtureDeadlock { .. });
        is_deadlock.then_some("deadlock")
    }
}

/// Where and on what a process model refused to go on.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("at {time:.3} s on machine `{machine}`, part `{part}`, operation `{operation}`, pass {pass}: {source}")]
pub struct Refusal {
    /// Simulated time, s.
    pub time: f64,
    /// Machine name.
    pub machine: String,
    /// Part name.
    pub part: String,
    /// Operation name.
    pub operation: String,
    /// Pass within the operation, from 0.
    pub pass: u32,
    /// Name and SI value of every input element of the process; none where a finished run is followed for its records.
    pub inputs: Vec<(&'static str, f64)>,
    /// What it refused.
    pub source: ModelError,
}
