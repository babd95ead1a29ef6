//! Calibrated constants of a shop that the replay of queues needs, by which model and replay name them alike.

use std::fmt;

/// A constant of the shop, of one program or of one machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Constant<'a> {
    /// Times of all programs.
    ProgrammedTimes,
    /// Time of one program.
    ProgrammedTime(&'a str),
    /// Times on one machine.
    MachineGain(&'a str),
    /// Loading and unloading everywhere.
    Handling,
    /// Loading and unloading for one program.
    HandlingOfProgram(&'a str),
    /// Loading and unloading at one machine.
    HandlingAtMachine(&'a str),
    /// Changes of edges everywhere.
    Change,
    /// Changes of edges at one machine.
    ChangeAtMachine(&'a str),
}

/// The name of the parameter in files and reports.
impl fmt::Display for Constant<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::ProgrammedTimes => write!(f, "programmed times"),
            Self::ProgrammedTime(program) => write!(f, "programmed time of {program}"),
            Self::MachineGain(machine) => write!(f, "times in cut at {machine}"),
            Self::Handling => write!(f, "handling time"),
            Self::HandlingOfProgram(program) => write!(f, "handling time of {program}"),
            Self::HandlingAtMachine(machine) => write!(f, "handling at {machine}"),
            Self::Change => write!(f, "change time"),
            Self::ChangeAtMachine(machine) => write!(f, "changes at {machine}"),
        }
    }
}
