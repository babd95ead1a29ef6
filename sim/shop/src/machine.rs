//! A machine and what it is doing.

use super::batch::BatchState;
use super::chatter::{Reaction, Surface};
use super::cut::Segment;
use super::deviation::Moved;
use super::draws::Blank;
use super::edge::Edge;
use super::job::Origin;
use crate::runlog::{MachineState, PassRow};
use toolroom_kernel::{EventKey, SimTime};
use toolroom_queues::Queue;
use toolroom_scenario::MachineType;
use toolroom_scenario::policies::{ForceReading, Observer};

/// A machine of the shop.
#[derive(Clone, Debug)]
pub struct Machine {
    /// Jobs waiting for it.
    pub queue: Queue,
    /// The operation in the machine.
    pub task: Option<Task>,
    /// Edge of every tool, by tool index.
    pub edges: Vec<Option<Edge>>,
    /// What the controller knew of the edge before, by tool index.
    pub learnt: Vec<Option<Observer>>,
    /// Edges mounted so far, by tool index.
    pub mounted: Vec<u64>,
    /// Edges left in the magazine.
    pub magazine: u32,
    /// For what it stands ready.
    pub ready: Readiness,
    /// The order and operation for which it is kept, until the last job of that order is through.
    pub kept_for: Option<(u32, u32)>,
    /// Whether it has been set up for that, or is being set up.
    pub set_up: bool,
    /// Jobs that have joined its queue, and the time of their operations, s, where that is settled when they come.
    pub line: (u32, f64),
    /// Time for which it has worked on jobs and been set up, s.
    pub worked: f64,
    /// Batches that it has made.
    pub batch: BatchState,
    /// The job that is done on it and cannot move on.
    pub blocked: Option<u32>,
    /// Whether it has work for which no place can be reserved.
    pub held_up: bool,
    /// What its work lacks.
    pub lacks: Option<Lack>,
    /// Failures not yet repaired, and maintenance in progress.
    pub failures: u32,
    /// Whether it is maintained.
    pub maintained: bool,
    /// Whether it is out of shift.
    pub off_shift: bool,
    /// Whether the shift is over as soon as the operation is finished: the machine works overtime.
    pub leaving: bool,
    /// Whether it is on the list of machines that may choose a job.
    pub listed: bool,
    /// State in the log.
    pub state: MachineState,
    /// Whether in shift, in the log.
    pub state_in_shift: bool,
    /// Job in the log.
    pub state_job: Option<u32>,
    /// Since when.
    pub state_since: SimTime,
    /// The pass in work; buffers are used again.
    pub segment: Segment,
    /// What it has learnt about chatter.
    pub reactions: Vec<Reaction>,
}

/// What the work of a machine waits for that is none of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lack {
    /// A fixture, with the work still in the queue.
    Fixture,
    /// A person, with the work still in the queue because it needs a fixture with it.
    Operator,
}

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

impl Lack {
    /// State of a machine whose work lacks it.
    fn state(self) -> MachineState {
        match self {
            Self::Fixture => MachineState::WaitingFixture,
            Self::Operator => MachineState::WaitingOperator,
        }
    }
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

/// A workpiece, as far as its operation has come.
#[derive(Clone, Debug)]
pub struct Piece {
    /// Pass or phase that is due or in work.
    pub pass: u32,
    /// Share of the pass that is still to be cut.
    pub share_left: f64,
    /// The work as it came.
    pub blank: Blank,
    /// Size error at the end of the last pass, m.
    pub size_error: f64,
    /// The surface of the last pass.
    pub surface: Surface,
    /// Whether the surface is burnt.
    pub burnt: bool,
    /// Whether a broken edge spoiled the part.
    pub spoiled: bool,
    /// How far the machine moved the wheel in before the part, because of its wear, m.
    pub correction: f64,
}

impl Default for Piece {
    /// A workpiece before its first pass.
    fn default() -> Self {
        Self {
            pass: 0,
            share_left: 1.0,
            blank: Blank { hardness: 1.0, lot_deviation: 0.0 },
            size_error: 0.0,
            surface: Surface::default(),
            burnt: false,
            spoiled: false,
            correction: 0.0,
        }
    }
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

impl Machine {
    /// A machine with a full magazine, ready at time zero.
    pub(super) fn new(tools: usize, kind: &MachineType, queue: Queue, ready: Readiness) -> Self {
        Self {
            queue,
            task: None,
            edges: vec![None; tools],
            learnt: vec![None; tools],
            mounted: vec![0; tools],
            magazine: kind.magazine,
            ready,
            kept_for: None,
            set_up: false,
            line: (0, 0.0),
            worked: 0.0,
            batch: BatchState::default(),
            blocked: None,
            held_up: false,
            lacks: None,
            failures: 0,
            maintained: false,
            off_shift: false,
            leaving: false,
            listed: false,
            state: MachineState::Idle,
            state_in_shift: true,
            state_job: None,
            state_since: SimTime::ZERO,
            segment: Segment::default(),
            reactions: Vec::new(),
        }
    }

    /// Whether it can work now.
    #[inline]
    pub fn is_up(&self) -> bool {
        self.failures == 0 && !self.off_shift
    }

    /// Whether it can take a job now.
    #[inline]
    pub fn is_free(&self) -> bool {
        self.is_up() && self.task.is_none() && self.blocked.is_none()
    }

    /// Whether it is kept for the order that a job belongs to.
    #[inline]
    pub(super) fn is_kept_for(&self, origin: Origin) -> bool {
        self.kept_for.is_some_and(|(order, _)| origin == Origin::Order(order))
    }

    /// The state that the log should show.
    #[inline]
    pub fn current_state(&self) -> MachineState {
        if self.maintained {
            MachineState::Maintenance
        } else if self.failures > 0 {
            MachineState::Down
        } else if self.off_shift {
            MachineState::OffShift
        } else {
            let empty = if self.blocked.is_some() || self.held_up {
                MachineState::Blocked
            } else if let Some(lack) = self.lacks {
                lack.state()
            } else if self.kept_for.is_some() {
                MachineState::Starved
            } else {
                MachineState::Idle
            };
            let busy = |task: &Task| if task.waits { MachineState::WaitingOperator } else { task.step.state() };
            self.task.as_ref().map_or(empty, busy)
        }
    }
}
