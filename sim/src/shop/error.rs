//! Why a run stopped.

use crate::KernelError;
use crate::policy::PolicyError;
use toolroom_process::ModelError;

/// Why a shop could not be made or stopped.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ShopError {
    /// A process model refused an operation.
    #[error(transparent)]
    Model(#[from] Box<Refusal>),
    /// A policy could not be resolved for a tool.
    #[error("policy `{policy}` with tool `{tool}`: {source}")]
    Policy {
        /// Policy name.
        policy: String,
        /// Tool name.
        tool: String,
        /// Why.
        source: Box<PolicyError>,
    },
    /// An event in the past or a time that is no number.
    #[error(transparent)]
    Kernel(#[from] KernelError),
    /// The scenario has fewer policies.
    #[error("policy {index} was asked for, the scenario has {count}")]
    UnknownPolicy {
        /// Asked for.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// An index of the scenario points nowhere.
    #[error("{kind} {index} is used, the scenario has {count}")]
    UnknownIndex {
        /// What is indexed.
        kind: &'static str,
        /// Index used.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// An operation without a machine that may do it.
    #[error("operation `{operation}` of part `{part}` has no machine")]
    NoMachine {
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
        "tool `{tool}` is a unit that cannot go back to an earlier state (it does not serialise its FMU state), but \
         passes on machine `{machine}` are interrupted: take its breakdowns out and let shifts finish the part, or \
         export the unit with FMU state"
    )]
    CannotGoBack {
        /// Tool name.
        tool: String,
        /// Machine name.
        machine: String,
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
    /// Name and SI value of every input element of the process.
    pub inputs: Vec<(&'static str, f64)>,
    /// What it refused.
    pub source: ModelError,
}
