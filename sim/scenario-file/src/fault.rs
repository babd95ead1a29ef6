//! What can be wrong in a scenario beyond what every file can have.

use std::sync::Arc;
use toolroom_form::{ContentFault, Fault};
use toolroom_infeed::CycleError;
use toolroom_scenario::policies::{PlanError, PolicyError};

/// One thing that is wrong in a scenario.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ScenarioFault {
    /// A tool that no operation uses.
    #[error("tool \"{tool}\" fits no operation: {reason}")]
    UnusedTool {
        /// The tool.
        tool: String,
        /// Why.
        reason: String,
    },
    /// An operation on a machine of another process than its tool's.
    #[error(
        "operation \"{operation}\" uses the {tool_process} tool \"{tool}\", but \"{machine}\" is a {machine_process} machine"
    )]
    WrongProcess {
        /// Operation.
        operation: String,
        /// Tool.
        tool: String,
        /// Process of the tool.
        tool_process: String,
        /// Machine.
        machine: String,
        /// Process of the machine.
        machine_process: String,
    },
    /// An operation that no machine can do.
    #[error("no machine can do operation \"{operation}\"")]
    NoMachine {
        /// Operation.
        operation: String,
    },
    /// A part that an arrival source names but that has no operation.
    #[error("part \"{part}\" has no operation")]
    NoOperation {
        /// Part.
        part: String,
    },
    /// Sequences of machines that wait for each other.
    #[error("the sequences wait for each other in a circle: {circle}")]
    ScheduleCycle {
        /// Operations, each before the next, and the last before the first.
        circle: String,
    },
    /// Working intervals out of order.
    #[error("shift {second} starts before shift {first} ends")]
    ShiftsOverlap {
        /// Number of the earlier shift, from 1.
        first: usize,
        /// Number of the later shift, from 1.
        second: usize,
    },
    /// A parameter set that could not be read.
    #[error("parameter set \"{name}\": {reason}")]
    ParameterSet {
        /// Name of the set.
        name: String,
        /// What its reader says.
        reason: String,
    },
    /// A cycle file with faults of its own.
    #[error("{reason}")]
    CycleFile {
        /// Each with its place in that file.
        reason: String,
    },
    /// Limits that no cycle keeps.
    #[error("{subject}: {reason}")]
    Cycle {
        /// Operation or policy.
        subject: String,
        /// The limits that conflict.
        reason: CycleError,
    },
    /// A contour file with faults of its own.
    #[error("{reason}")]
    ContourFile {
        /// Each with its place in that file.
        reason: String,
    },
    /// A contour that cannot be milled as planned.
    #[error("{subject}: {reason}")]
    Contour {
        /// Operation.
        subject: String,
        /// Why.
        reason: PlanError,
    },
    /// A part program that is no work for the shop.
    #[error("{subject}: {reason}")]
    Program {
        /// Operation.
        subject: String,
        /// Why.
        reason: String,
    },
    /// A setup of a part program with faults of its own.
    #[error("{reason}")]
    SetupFile {
        /// Each with its place in that file.
        reason: String,
    },
    /// A policy that cannot plan the work of a tool.
    #[error("policy \"{policy}\" with tool \"{tool}\": {reason}")]
    Policy {
        /// Policy.
        policy: String,
        /// Tool.
        tool: String,
        /// Why.
        reason: Box<PolicyError>,
    },
    /// A structure that could not be read.
    #[error("structure \"{file}\": {reason}")]
    Structure {
        /// The lobes file.
        file: String,
        /// What is wrong.
        reason: String,
    },
    /// An imported unit that cannot stand in for the process.
    #[error("unit \"{file}\": {reason}")]
    Unit {
        /// File of the unit.
        file: String,
        /// What is wrong.
        reason: String,
        /// What to do about it.
        fix: String,
    },
    /// A policy that plans with a unit, which tells nobody its parameters, and believes in no model.
    #[error("policy \"{policy}\" plans the cuts of tool \"{tool}\", an imported unit, and has no model to plan on")]
    UnbelievedUnit {
        /// The policy.
        policy: String,
        /// The tool.
        tool: String,
    },
    /// A name in a scope that nothing carries.
    #[error("scope: there is no {key} \"{name}\"")]
    ScopeName {
        /// Key of the scope.
        key: &'static str,
        /// What was read.
        name: String,
        /// The most similar name.
        nearest: Option<String>,
        /// Every name.
        known: String,
    },
    /// A date in a scenario that does not say when it starts.
    #[error("`{key}` = {read} is a date, but the scenario has no start to count from")]
    DateWithoutStart {
        /// The key.
        key: &'static str,
        /// What was read.
        read: String,
    },
    /// A text that is no date, no time of the day or no interval.
    #[error("`{key}` = \"{read}\" is no {expected}")]
    NoDate {
        /// The key.
        key: &'static str,
        /// What was read.
        read: String,
        /// What was expected.
        expected: &'static str,
        /// One that would do.
        example: &'static str,
    },
    /// A calendar in which nobody ever works.
    #[error("calendar \"{name}\" has no working time until the horizon")]
    CalendarEmpty {
        /// The calendar.
        name: String,
    },
    /// An order that is released when the run is over, or before it begins.
    #[error("order \"{id}\" is released at {release}, but the run goes {run}")]
    OrderOutside {
        /// The order.
        id: String,
        /// When it is released.
        release: String,
        /// First and last instant of the run.
        run: String,
    },
    /// A row of a table.
    #[error("{file}, line {line}: {reason}")]
    TableCell {
        /// The file.
        file: String,
        /// Line of the file, from 1.
        line: u64,
        /// What is wrong.
        reason: String,
        /// What to do about it.
        fix: Option<String>,
    },
    /// Draws of a posterior that a tool cannot take.
    #[error("draws \"{file}\": {reason}")]
    Draws {
        /// The file.
        file: String,
        /// What is wrong.
        reason: String,
    },
    /// A fitted law of lives that no time can be drawn from.
    #[error("fitted law of \"{file}\": {reason}")]
    FittedLaw {
        /// The file.
        file: String,
        /// What is wrong.
        reason: String,
    },
    /// A skill that no operator has.
    #[error("nobody has the skill \"{skill}\"")]
    SkillNobody {
        /// The skill.
        skill: String,
        /// The most similar one.
        nearest: Option<String>,
        /// All that somebody has.
        known: String,
    },
    /// A setup group that a setup matrix does not have.
    #[error("setup matrix \"{matrix}\" has no row and column for \"{group}\", which comes to machine \"{machine}\"")]
    MissingPair {
        /// The matrix.
        matrix: String,
        /// The machine that has it.
        machine: String,
        /// The setup group; empty for a machine that was never set up.
        group: String,
    },
    /// A part that holds the only place that it could move to.
    #[error(
        "part \"{part}\" can never begin \"{}\": it holds the only place of \"{buffer}\" and would have to reserve another one there for \"{}\"",
        operations[0],
        operations[1]
    )]
    BufferLoop {
        /// The part.
        part: String,
        /// The operation that cannot begin, and the one that follows it.
        operations: [String; 2],
        /// The machine or buffer.
        buffer: String,
    },
    /// An order in several jobs that comes to a buffer.
    #[error(
        "order \"{order}\" moves in several jobs, which must wait for each other, but comes to the limited buffer of \"{buffer}\""
    )]
    BufferLot {
        /// The order.
        order: String,
        /// The machine or buffer.
        buffer: String,
    },
    /// What contradicts itself, could never work or is not modelled together.
    #[error("{reason}")]
    Arrangement {
        /// What.
        reason: String,
        /// What to do about it.
        fix: String,
    },
    /// A calibration that its process refuses.
    #[error("calibration: {reason}")]
    Calibration {
        /// Why.
        reason: String,
    },
}

impl ContentFault for ScenarioFault {
    fn code(&self) -> &'static str {
        match self {
            Self::UnusedTool { .. } => "unused-tool",
            Self::WrongProcess { .. } => "wrong-process",
            Self::NoMachine { .. } => "no-machine",
            Self::NoOperation { .. } => "no-operation",
            Self::ScheduleCycle { .. } => "schedule-cycle",
            Self::ShiftsOverlap { .. } => "shifts-overlap",
            Self::ParameterSet { .. } => "parameter-set",
            Self::CycleFile { .. } | Self::Cycle { .. } => "cycle",
            Self::ContourFile { .. } | Self::Contour { .. } => "contour",
            Self::Program { .. } | Self::SetupFile { .. } => "program",
            Self::Policy { .. } => "policy",
            Self::Structure { .. } => "structure",
            Self::Unit { .. } => "unit",
            Self::UnbelievedUnit { .. } => "believed-model",
            Self::ScopeName { .. } => "scope-name",
            Self::DateWithoutStart { .. } => "date-without-start",
            Self::NoDate { .. } => "no-date",
            Self::CalendarEmpty { .. } => "calendar-empty",
            Self::OrderOutside { .. } => "order-beyond-horizon",
            Self::TableCell { .. } => "table-cell",
            Self::Draws { .. } => "draws",
            Self::FittedLaw { .. } => "fitted-law",
            Self::SkillNobody { .. } => "skill-nobody",
            Self::MissingPair { .. } => "missing-pair",
            Self::BufferLoop { .. } => "buffer-loop",
            Self::BufferLot { .. } => "buffer-lot",
            Self::Arrangement { .. } => "arrangement",
            Self::Calibration { .. } => "calibration",
        }
    }

    fn fix(&self) -> Option<String> {
        Some(match self {
            Self::ScopeName { nearest: Some(nearest), known, .. } => {
                format!("did you mean `{nearest}`? known: {known}")
            }
            Self::ScopeName { nearest: None, known, .. } => format!("known: {known}"),
            Self::UnusedTool { .. } => "name it in an operation, or remove it".to_owned(),
            Self::WrongProcess { tool_process, .. } => {
                format!("list machines of process \"{tool_process}\", or choose another tool")
            }
            Self::NoMachine { .. } => "list at least one machine of the tool's process in `machines`".to_owned(),
            Self::NoOperation { .. } => "add [[part.operation]] below the part".to_owned(),
            Self::ScheduleCycle { .. } => {
                "let one of them come earlier or later on its machine: in a circle none can ever begin".to_owned()
            }
            Self::ShiftsOverlap { .. } => "order the shifts and let each end before the next starts".to_owned(),
            Self::Unit { fix, .. } | Self::Arrangement { fix, .. } => fix.clone(),
            Self::UnbelievedUnit { .. } => {
                "name the parameter set that it believes in: believed_model = \"ni_vk6om\"".to_owned()
            }
            Self::DateWithoutStart { .. } => {
                "write `start = \"2026-03-30 00:00\"` in [shop], or the time since the start, such as \"12 day\""
                    .to_owned()
            }
            Self::NoDate { example, .. } => format!("such as {example}"),
            Self::CalendarEmpty { .. } => "give a day of `week` its shifts, or overtime".to_owned(),
            Self::OrderOutside { .. } => {
                "lengthen `horizon`, move `start`, take the order out, or say by a [[wip]] where it is at the start"
                    .to_owned()
            }
            Self::TableCell { fix, .. } => return fix.clone(),
            Self::Draws { .. } => "`toolroom calibrate --data` writes such a table beside the set".to_owned(),
            Self::FittedLaw { .. } => {
                "`toolroom life --fit LIVES.csv --out DIR` writes DIR/summary.json with lives in a unit of time"
                    .to_owned()
            }
            Self::SkillNobody { nearest: Some(nearest), known, .. } => {
                format!("did you mean `{nearest}`? known: {known}")
            }
            Self::SkillNobody { nearest: None, .. } => "add [[operator]] with this skill".to_owned(),
            Self::MissingPair { group, .. } if group.is_empty() => {
                "add a row in front of the others, for a machine that was never set up".to_owned()
            }
            Self::MissingPair { .. } => "add the group to `groups`, and a row and a column to `times`".to_owned(),
            Self::BufferLoop { .. } => {
                "give it a place more with `input_buffer`, or use blocking = \"after_service\"".to_owned()
            }
            Self::BufferLot { .. } => "take out `transfer`, or the limit of the buffer".to_owned(),
            Self::Structure { file, .. } => {
                format!(
                    "give a lobes file of the tool's process; `toolroom lobes {file}` tells its faults line by line"
                )
            }
            Self::ParameterSet { .. }
            | Self::CycleFile { .. }
            | Self::Cycle { .. }
            | Self::ContourFile { .. }
            | Self::Contour { .. }
            | Self::Program { .. }
            | Self::SetupFile { .. }
            | Self::Policy { .. }
            | Self::Calibration { .. } => return None,
        })
    }
}

impl From<ScenarioFault> for Fault {
    fn from(fault: ScenarioFault) -> Self {
        Self::Content(Arc::new(fault))
    }
}
