//! For what a machine stands ready, and what its work lacks.

use crate::runlog::MachineState;

/// For what a machine stands ready without a setup.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Readiness {
    /// Whatever comes first.
    Anything,
    /// Nothing yet.
    Nothing,
    /// A setup group, by number.
    Group(u32),
}

impl Readiness {
    /// Whether work of a setup group needs no setup.
    #[inline]
    pub fn suits(self, group: u32) -> bool {
        match self {
            Self::Anything => true,
            Self::Nothing => false,
            Self::Group(own) => own == group,
        }
    }
}

/// What the work of a machine waits for that is none of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lack {
    /// A fixture, with the work still in the queue.
    Fixture,
    /// A person, with the work still in the queue because it needs a fixture with it.
    Operator,
}

impl Lack {
    /// State of a machine whose work lacks it.
    pub(super) fn state(self) -> MachineState {
        match self {
            Self::Fixture => MachineState::WaitingFixture,
            Self::Operator => MachineState::WaitingOperator,
        }
    }
}
