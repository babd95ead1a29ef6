//! An operation in a machine and its steps.

use crate::runlog::{MachineState, PassRow};
use toolroom_cuts::edge::Edge;
use toolroom_cuts::workpiece::Piece;
use toolroom_kernel::{EventKey, SimTime};
use toolroom_scenario::policies::ForceReading;

/// An operation in a machine.
#[derive(Clone, Debug)]
pub struct Task {
    /// Where the job is kept.
    pub slot: u32,
    /// Since when the time of the operation counts: begun, or begun anew.
    pub begun: SimTime,
    /// What is being done.
    pub step: Step,
    /// Time that the step still takes from `since` on, s.
    pub left: f64,
    /// When the step began or went on.
    pub since: SimTime,
    /// Its end in the calendar; `None` while nothing moves.
    pub end: Option<EventKey>,
    /// Who attends to it, by index into the operators of the scenario.
    pub operator: Option<u32>,
    /// Share of that person which it takes, 0 to 1.
    pub presence: f32,
    /// Whether it waits for somebody.
    pub waits: bool,
    /// Time of loading, s.
    pub load_time: f64,
    /// Time of unloading, s.
    pub unload_time: f64,
    /// What is done to the part.
    pub content: Content,
    /// Time of its work that lies before the start of the run, s.
    pub before: f64,
    /// Other jobs that are worked on together with it.
    pub riders: Vec<u32>,
    /// How long somebody still attends to its piece; `None`: as long as there is something to attend to.
    pub tending: Option<Box<Tending>>,
}

/// What an operation does to its part.
#[derive(Clone, Debug)]
pub enum Content {
    /// Plain work that takes this time, s: its one step is [`Step::Work`].
    Plain(f64),
    /// Plain work in several stretches.
    Stretches(Box<Stretches>),
    /// Passes of a tool, with all that comes between them; apart, so that plain work moves little.
    Machining(Box<Machining>),
}

/// Plain work in which an edge wears, or to whose pieces somebody attends for a while.
#[derive(Clone, Debug)]
pub struct Stretches {
    /// All of the work, s.
    pub whole: f64,
    /// What is left of it, s, when the step that it is in began or went on.
    pub left: f64,
    /// Time of a piece, s; infinite where all pieces are one.
    pub piece: f64,
    /// What is left of the piece, s.
    pub piece_left: f64,
    /// Tool of which an edge wears.
    pub tool: Option<u32>,
    /// Life of the edge that a unit of this work takes, 1.
    pub aging: f64,
}

/// Somebody attends to the first time of a piece only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tending {
    /// What is left of that time, s, when the step that it is in began or went on.
    pub left: f64,
    /// The end of it in the calendar; `None` while nobody is there, or where the step ends before.
    pub leaves: Option<EventKey>,
}

impl Task {
    /// The tool whose edge it uses now.
    ///
    /// # Panics
    /// Where it uses none: only changes of edges ask.
    pub(super) fn tool(&self) -> usize {
        match &self.content {
            Content::Machining(machining) => machining.tool as usize,
            Content::Stretches(work) => work.tool.expect("only work with an edge changes it") as usize,
            Content::Plain(_) => unreachable!("{PLAIN}"),
        }
    }

    /// Its tool and workpiece.
    ///
    /// # Panics
    /// Where the work is plain: only what belongs to passes asks.
    #[inline]
    pub(super) fn machining(&self) -> &Machining {
        match &self.content {
            Content::Machining(machining) => machining,
            Content::Plain(_) | Content::Stretches(_) => unreachable!("{PLAIN}"),
        }
    }

    /// The same to change it.
    ///
    /// # Panics
    /// Where the work is plain.
    pub(super) fn machining_mut(&mut self) -> &mut Machining {
        match &mut self.content {
            Content::Machining(machining) => machining,
            Content::Plain(_) | Content::Stretches(_) => unreachable!("{PLAIN}"),
        }
    }
}

/// Why plain work has no passes.
const PLAIN: &str = "plain work has neither passes nor changes of edges";

/// What holds for an operation with a tool from its beginning to its end.
#[derive(Clone, Debug)]
pub struct Machining {
    /// Tool of the operation.
    pub tool: u32,
    /// Time that the program will take beyond its passes, s.
    pub delay: f64,
    /// For how long the feed will be held, s.
    pub hold: f64,
    /// What calibration and deviations make of its time in cut and of the wear of its edge.
    pub moved: Moved,
    /// What acts on it among the entries of its tool that have a scope.
    pub acting: u32,
    /// Broken edges in this operation: index of the next draw.
    pub lost_edges: u32,
    /// The workpiece.
    pub piece: Piece,
}

/// What calibration and deviations make of an operation.
#[derive(Clone, Copy, Debug)]
pub struct Moved {
    /// Time that a second of the programmed passes takes, s.
    pub pace: f64,
    /// Factor on the wear rate of the edge.
    pub wear_rate: f64,
}

/// Why a step may count on an operation.
pub(super) const IN_WORK: &str = "a step belongs to the operation in its machine";

/// Why a pass may count on an edge.
pub(super) const MOUNTED: &str = "a pass begins with an edge in its place, which stays until the next one is mounted";

/// The operation in work, taken apart, and the edge that cuts it.
pub(super) struct InCut<'a> {
    pub step: &'a mut Step,
    /// [`Task::left`].
    pub left: &'a mut f64,
    pub machining: &'a mut Machining,
    pub edge: &'a mut Edge,
}

/// The operation in work and the edge that cuts it.
///
/// # Panics
/// Where there is none of them: only passes ask.
pub(super) fn in_cut<'a>(task: &'a mut Option<Task>, edge: &'a mut Option<Edge>) -> InCut<'a> {
    let Task { step, left, content, .. } = task.as_mut().expect(IN_WORK);
    let Content::Machining(machining) = content else { unreachable!("{PLAIN}") };
    InCut { step, left, machining, edge: edge.as_mut().expect(MOUNTED) }
}

/// Step of an operation, with what belongs to it alone.
#[derive(Clone, Debug)]
pub enum Step {
    /// Changing over.
    Setup,
    /// Fastening the part.
    Load,
    /// Plain work.
    Work,
    /// Waiting for an edge from its crib.
    NoTool,
    /// Changing the edge.
    ToolChange,
    /// Cutting.
    Pass(Box<Pass>),
    /// Reading the wear of the edge.
    Reading,
    /// The program runs longer than its passes.
    Delay,
    /// The feed is held.
    Hold,
    /// Dressing the wheel.
    Dressing,
    /// Taking the part off.
    Unload,
}

/// A pass or phase in work.
#[derive(Clone, Debug)]
pub struct Pass {
    /// Its row in the log, as far as it has been cut.
    pub row: PassRow,
    /// Whether that can be known: a unit that cannot go back does not tell what it had cut when the
    /// run ended within the pass.
    pub known: bool,
    /// Layers in which it is cut.
    pub layers: u32,
    /// Forces of a phase that the machine has not come to yet.
    pub readings: Vec<ForceReading>,
}

impl Step {
    /// The pass in work.
    ///
    /// # Panics
    /// Where none is: only what belongs to a pass asks.
    pub(super) fn pass_mut(&mut self) -> &mut Pass {
        match self {
            Self::Pass(pass) => pass,
            Self::Setup
            | Self::Load
            | Self::Work
            | Self::NoTool
            | Self::ToolChange
            | Self::Reading
            | Self::Delay
            | Self::Hold
            | Self::Dressing
            | Self::Unload => {
                unreachable!("only a pass is planned, interrupted and taken over")
            }
        }
    }

    /// Whether it is part of the run of an operation, to which its person for the run attends.
    pub(super) fn is_run(&self) -> bool {
        match self {
            Self::Setup | Self::Load | Self::Unload | Self::NoTool => false,
            Self::Work
            | Self::ToolChange
            | Self::Pass(_)
            | Self::Reading
            | Self::Delay
            | Self::Hold
            | Self::Dressing => true,
        }
    }

    /// Whether it goes as fast as the shift does; passes of a tool and what belongs to them take their time.
    pub(super) fn is_paced(&self) -> bool {
        matches!(self, Self::Setup | Self::Load | Self::Work | Self::Unload)
    }

    /// State of a machine that does it.
    #[inline]
    pub fn state(&self) -> MachineState {
        match self {
            Self::Setup => MachineState::Setup,
            Self::Load | Self::Unload | Self::Reading => MachineState::Handling,
            Self::Work => MachineState::Working,
            Self::NoTool => MachineState::WaitingTool,
            Self::ToolChange => MachineState::ToolChange,
            Self::Pass(_) | Self::Delay | Self::Hold => MachineState::Cutting,
            Self::Dressing => MachineState::Dressing,
        }
    }
}
