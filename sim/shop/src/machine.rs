//! A machine and what it is doing.

use super::batch::BatchState;
use super::job::Origin;
use super::readiness::{Lack, Readiness};
use super::task::Task;
use crate::runlog::MachineState;
use toolroom_cuts::cut::Segment;
use toolroom_cuts::edge::Edge;
use toolroom_cuts::reaction::Reaction;
use toolroom_kernel::SimTime;
use toolroom_queues::Queue;
use toolroom_scenario::MachineType;
use toolroom_scenario::policies::Observer;

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
