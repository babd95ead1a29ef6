//! Calibrated constants of a shop, by which its model, a scenario and the replay of queues name them alike.

use super::nominal::Shop;
use crate::Movable;
use std::fmt;
use toolroom_scenario::Target;

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
    /// Lives of edges everywhere.
    Lives,
    /// Lives of edges at one machine.
    LivesAtMachine(&'a str),
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
            Self::Lives => write!(f, "wear rate level"),
            Self::LivesAtMachine(machine) => write!(f, "lives of edges at {machine}"),
        }
    }
}

impl Constant<'_> {
    /// How a scenario says it; `None` of a machine or a program that the shop of the scenario has not.
    pub(super) fn movable(self, shop: &Shop) -> Option<Movable> {
        let machine = |name: &str| shop.station(name).map(|_| Target::Machine(name.to_owned()));
        let program = |name: &str| shop.programs.get(name).map(|_| Target::Operation(name.to_owned()));
        let (parameter, target) = match self {
            Self::ProgrammedTimes => ("programmed_time", Target::Shop),
            Self::ProgrammedTime(name) => ("programmed_time", program(name)?),
            Self::MachineGain(name) => ("programmed_time", machine(name)?),
            Self::Handling => ("handling_time", Target::Shop),
            Self::HandlingOfProgram(name) => ("handling_time", program(name)?),
            Self::HandlingAtMachine(name) => ("handling_time", machine(name)?),
            Self::Change => ("tool_change_time", Target::Shop),
            Self::ChangeAtMachine(name) => ("tool_change_time", machine(name)?),
            Self::Lives => ("wear_rate", Target::Shop),
            Self::LivesAtMachine(name) => ("wear_rate", machine(name)?),
        };
        // A life counts against a rate.
        let inverse = matches!(self, Self::Lives | Self::LivesAtMachine(_));
        Some(Movable { inverse, ..Movable::factor(parameter, target) })
    }
}

/// What a correction of a channel is called: a constant, or the shape of a distribution, which no scenario has a word for.
pub(super) enum Label<'a> {
    Constant(Constant<'a>),
    Shape(String),
}

impl<'a> From<Constant<'a>> for Label<'a> {
    fn from(constant: Constant<'a>) -> Self {
        Self::Constant(constant)
    }
}

impl From<String> for Label<'_> {
    fn from(shape: String) -> Self {
        Self::Shape(shape)
    }
}

impl fmt::Display for Label<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Constant(constant) => constant.fmt(f),
            Self::Shape(shape) => f.write_str(shape),
        }
    }
}

impl Label<'_> {
    /// How a scenario says it.
    pub fn movable(&self, shop: &Shop) -> Option<Movable> {
        match self {
            Self::Constant(constant) => constant.movable(shop),
            Self::Shape(_) => None,
        }
    }
}
