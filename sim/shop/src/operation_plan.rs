//! An operation as the engine sees it.

use toolroom_scenario::WorkPer;

/// An operation as the engine sees it, small and beside the others of its part: the scenario is too large to be looked at
/// several times an event. It has one line of the processor's memory to itself.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct OperationPlan {
    pub content: ContentPlan,
    pub setup_group: u32,
    /// What takes its plain work once.
    pub work_per: WorkPer,
    /// The machines that may do it, together.
    pub station: u32,
    /// Expected time on its first machine, s: loading, passes as programmed, unloading; plain work is not
    /// in it.
    pub known_time: f64,
    /// The machine that does it, if no other may.
    pub only_machine: Option<u32>,
    /// Its setup time where it has one of its own, s.
    pub setup_time: Option<f64>,
    /// Whether chance decides how long its setup takes.
    pub random_setup: bool,
    /// Whether machines differ in the time of its plain work.
    pub paced: bool,
    /// Whether any machine has a time of its own for it, to which the rank of a job is kept.
    pub own_times: bool,
    /// Whether its plain work goes on in stretches.
    pub stretched: bool,
    /// Whether pieces of a job differ in its plain work: each has its own time, or only a sample is worked on.
    pub apart: bool,
    /// Whether it needs the components of its part.
    pub assembles: bool,
    /// Whether chance decides what becomes of its pieces.
    pub inspected: bool,
}

/// What an operation does, as the engine sees it.
#[derive(Clone, Copy, Debug)]
pub(super) enum ContentPlan {
    /// Plain work.
    Plain,
    /// Passes of a tool.
    Machining { tool: u32, passes: Passes },
}

/// Passes of an operation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Passes {
    /// How many.
    pub passes: u32,
    /// Index of the first among all passes of the scenario.
    pub first_pass: u32,
}
