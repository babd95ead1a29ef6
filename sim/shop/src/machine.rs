//! A machine and what it is doing.

use super::chatter::{Reaction, Surface};
use super::cut::Segment;
use super::draws::Blank;
use super::edge::Edge;
use super::queue::Queue;
use crate::runlog::{MachineState, PassRow};
use toolroom_kernel::{EventKey, SimTime};
use toolroom_scenario::policies::ForceReading;

/// A machine of the shop.
#[derive(Clone, Debug)]
pub struct Machine {
    /// Jobs waiting for it.
    pub queue: Queue,
    /// The operation in the machine.
    pub task: Option<Task>,
    /// Edge of every tool, by tool index.
    pub edges: Vec<Option<Edge>>,
    /// Edges mounted so far, by tool index.
    pub mounted: Vec<u64>,
    /// Edges left in the magazine.
    pub magazine: u32,
    /// Setup group it is prepared for.
    pub setup_group: Option<u32>,
    /// Failures not yet repaired.
    pub failures: u32,
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

/// An operation in a machine.
#[derive(Clone, Debug)]
pub struct Task {
    /// Where the job is kept.
    pub slot: u32,
    /// Tool of the operation.
    pub tool: u32,
    /// Since when the time of the operation counts: begun, or begun anew.
    pub begun: SimTime,
    /// What is being done.
    pub step: Step,
    /// Pass or phase that is due or in work.
    pub pass: u32,
    /// Time that the step still takes from `since` on, s.
    pub left: f64,
    /// When the step began or went on.
    pub since: SimTime,
    /// Its end in the calendar; `None` while nothing moves.
    pub end: Option<EventKey>,
    /// Time of loading, s.
    pub load_time: f64,
    /// Time of unloading, s.
    pub unload_time: f64,
    /// Time that the program takes beyond its passes, s.
    pub delay: f64,
    /// For how long the feed will be held, s.
    pub hold: f64,
    /// Row of the pass in work.
    pub row: Option<PassRow>,
    /// Share of the pass that is still to be cut.
    pub share_left: f64,
    /// Broken edges in this operation: index of the next draw.
    pub lost_edges: u32,
    /// The work as it came.
    pub blank: Blank,
    /// Size error at the end of the last pass, m.
    pub size_error: f64,
    /// Layers in which the pass in work is cut.
    pub layers: u32,
    /// The surface of the last pass.
    pub surface: Surface,
    /// Whether the surface is burnt.
    pub burnt: bool,
    /// Whether a broken edge spoiled the part.
    pub spoiled: bool,
    /// How far the machine moved the wheel in before the part, because of its wear, m.
    pub correction: f64,
    /// Forces of the phase in work that the machine has not come to yet.
    pub readings: Vec<ForceReading>,
}

/// Why a step may count on an operation.
pub(super) const IN_WORK: &str = "a step belongs to the operation in its machine";
/// Why a pass may count on an edge.
pub(super) const MOUNTED: &str = "a pass begins with an edge in its place, which stays until the next one is mounted";

/// The operation in work and the edge that cuts it.
///
/// # Panics
/// Where there is none of them: only passes ask.
pub(super) fn in_cut<'a>(task: &'a mut Option<Task>, edge: &'a mut Option<Edge>) -> (&'a mut Task, &'a mut Edge) {
    (task.as_mut().expect(IN_WORK), edge.as_mut().expect(MOUNTED))
}

/// Step of an operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Changing over.
    Setup,
    /// Fastening the part.
    Load,
    /// Changing the edge.
    ToolChange,
    /// Cutting.
    Pass,
    /// The program runs longer than its passes.
    Delay,
    /// The feed is held.
    Hold,
    /// Dressing the wheel.
    Dressing,
    /// Taking the part off.
    Unload,
}

impl Step {
    /// State of a machine that does it.
    pub fn state(self) -> MachineState {
        match self {
            Self::Setup => MachineState::Setup,
            Self::Load | Self::Unload => MachineState::Handling,
            Self::ToolChange => MachineState::ToolChange,
            Self::Pass | Self::Delay | Self::Hold => MachineState::Cutting,
            Self::Dressing => MachineState::Dressing,
        }
    }
}

impl Machine {
    /// A machine with a full magazine, ready at time zero.
    pub(super) fn new(tools: usize, magazine: u32) -> Self {
        Self {
            queue: Queue::default(),
            task: None,
            edges: vec![None; tools],
            mounted: vec![0; tools],
            magazine,
            setup_group: None,
            failures: 0,
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
    pub fn is_up(&self) -> bool {
        self.failures == 0 && !self.off_shift
    }

    /// The state that the log should show.
    pub fn current_state(&self) -> MachineState {
        if self.failures > 0 {
            MachineState::Down
        } else if self.off_shift {
            MachineState::OffShift
        } else {
            self.task.as_ref().map_or(MachineState::Idle, |task| task.step.state())
        }
    }
}
