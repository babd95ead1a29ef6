//! What a run leaves behind: tidy tables, one row a fact, in SI.

pub use crate::log_event::LogEvent;
pub use crate::whole_job::WholeJob;
use toolroom_scenario::Scenario;

/// State of a machine (ISO 22400-2 time elements).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum MachineState {
    /// In cut: the productive part of the actual production time.
    Cutting,
    /// Plain work: the productive part of an operation without a tool.
    Working,
    /// Loading or unloading.
    Handling,
    /// Changing over to another setup group.
    Setup,
    /// Changing an edge or refilling the magazine.
    ToolChange,
    /// Dressing a grinding wheel.
    Dressing,
    /// Kept for a lot of which nothing is there.
    Starved,
    /// With a job that is done and has no place to go to, or with work for which no place can be reserved.
    Blocked,
    /// With a job whose step waits for somebody.
    WaitingOperator,
    /// Broken down.
    Down,
    /// Ready, nothing to do.
    Idle,
    /// Out of shift.
    OffShift,
    /// With work that lacks a fixture.
    WaitingFixture,
    /// With a part for which there is no edge in the crib.
    WaitingTool,
    /// Maintained as planned.
    Maintenance,
}

impl MachineState {
    /// All states in the order of reports; new ones at the end, so that the numbers of the others stay.
    pub const ALL: [Self; 15] = [
        Self::Cutting,
        Self::Working,
        Self::Handling,
        Self::Setup,
        Self::ToolChange,
        Self::Dressing,
        Self::Starved,
        Self::Blocked,
        Self::WaitingOperator,
        Self::Down,
        Self::Idle,
        Self::OffShift,
        Self::WaitingFixture,
        Self::WaitingTool,
        Self::Maintenance,
    ];

    /// Whether the machine works on a job or is set up for one.
    pub fn is_busy(self) -> bool {
        match self {
            Self::Cutting | Self::Working | Self::Handling | Self::Setup | Self::ToolChange | Self::Dressing => true,
            Self::Starved
            | Self::Blocked
            | Self::WaitingOperator
            | Self::WaitingFixture
            | Self::WaitingTool
            | Self::Maintenance
            | Self::Down
            | Self::Idle
            | Self::OffShift => false,
        }
    }

    /// States in which machines of a scenario may be, in the order of [`ALL`](Self::ALL).
    pub fn of(scenario: &Scenario) -> impl Iterator<Item = Self> {
        let (fixtures, cribs) = (!scenario.shared.fixtures.is_empty(), !scenario.shared.cribs.is_empty());
        let maintenance = !scenario.maintenance.is_empty();
        Self::ALL.into_iter().filter(move |state| state.occurs(fixtures, cribs, maintenance))
    }

    /// Whether it occurs where there are fixtures, cribs, planned maintenance.
    fn occurs(self, fixtures: bool, cribs: bool, maintenance: bool) -> bool {
        (self != Self::WaitingFixture || fixtures)
            && (self != Self::WaitingTool || cribs)
            && (self != Self::Maintenance || maintenance)
    }

    /// Name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Cutting => "cutting",
            Self::Working => "working",
            Self::Handling => "handling",
            Self::Setup => "setup",
            Self::ToolChange => "tool_change",
            Self::Dressing => "dressing",
            Self::Starved => "starved",
            Self::Blocked => "blocked",
            Self::WaitingOperator => "waiting_operator",
            Self::WaitingFixture => "waiting_fixture",
            Self::WaitingTool => "waiting_tool",
            Self::Maintenance => "maintenance",
            Self::Down => "down",
            Self::Idle => "idle",
            Self::OffShift => "off_shift",
        }
    }
}

/// Why an edge left the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum ChangeReason {
    /// The policy's tool change rule.
    Rule,
    /// The edge passed its wear limit inside a pass.
    WearLimit,
    /// The edge chipped.
    Chipping,
    /// The edge collapsed thermally.
    ThermalCollapse,
    /// The wheel was dressed.
    Dressing,
    /// Still in the machine at the end of the run.
    EndOfRun,
}

impl ChangeReason {
    /// All reasons.
    pub const ALL: [Self; 6] =
        [Self::Rule, Self::WearLimit, Self::Chipping, Self::ThermalCollapse, Self::Dressing, Self::EndOfRun];

    /// Name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rule => "rule",
            Self::WearLimit => "wear_limit",
            Self::Chipping => "chipping",
            Self::ThermalCollapse => "thermal_collapse",
            Self::Dressing => "dressing",
            Self::EndOfRun => "end_of_run",
        }
    }
}

/// How a job ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum JobOutcome {
    /// Finished, good.
    Good,
    /// Scrapped: an edge failed and spoiled it.
    ToolFailure,
    /// Scrapped at inspection: size error above tolerance.
    OutOfTolerance,
    /// Scrapped at inspection: grinding burnt the surface.
    Burnt,
    /// Scrapped at inspection: rough by chatter.
    Chatter,
    /// Scrapped at an inspection of which only shares are known.
    Rejected,
    /// Lost when a more urgent job took its machine.
    Preempted,
    /// Scrapped by a breakdown of the machine.
    Breakdown,
    /// Scrapped because the shift ended while it was in the machine.
    ShiftEnd,
    /// Not finished at the end of the run.
    InProcess,
}

impl JobOutcome {
    /// Whether its pieces are lost.
    pub fn is_scrap(self) -> bool {
        match self {
            Self::Good | Self::InProcess => false,
            Self::ToolFailure
            | Self::OutOfTolerance
            | Self::Burnt
            | Self::Chatter
            | Self::Rejected
            | Self::Preempted
            | Self::Breakdown
            | Self::ShiftEnd => true,
        }
    }

    /// Name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::ToolFailure => "tool_failure",
            Self::OutOfTolerance => "out_of_tolerance",
            Self::Burnt => "burnt",
            Self::Chatter => "chatter",
            Self::Rejected => "rejected",
            Self::Preempted => "preempted",
            Self::Breakdown => "breakdown",
            Self::ShiftEnd => "shift_end",
            Self::InProcess => "in_process",
        }
    }
}

/// One pass of one operation by one edge: a pass that two edges share has two rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassRow {
    /// Job.
    pub job: u32,
    /// Part type.
    pub part: u32,
    /// Operation within the routing.
    pub operation: u32,
    /// Pass within the operation (phase for grinding).
    pub pass: u32,
    /// Machine.
    pub machine: u32,
    /// Edge, unique within the run; row of [`RunLog::edges`].
    pub edge: u32,
    /// Start, s.
    pub start: f64,
    /// End, s.
    pub end: f64,
    /// Time in cut, s (an interruption counts in `end - start` only).
    pub cutting_time: f64,
    /// Cutting speed at the start, m/s (wheel speed does not count here: grinding has 0).
    pub speed_start: f64,
    /// Cutting speed at the end, m/s.
    pub speed_end: f64,
    /// Feed per revolution, per tooth, or infeed per revolution, m.
    pub feed: f64,
    /// Depth of cut with its allowance scatter, m.
    pub depth_of_cut: f64,
    /// Path along the feed as programmed, m: of the cutting edge where it turns the work, of the
    /// cutter's axis in milling.
    pub path: f64,
    /// Time in engagement at a known cutting speed, s: time in cut without the ways around of a
    /// contour; 0 for grinding.
    pub engaged_time: f64,
    /// Cutting speed integrated over that time, m: the way of an edge against the work.
    pub cutting_length: f64,
    /// Cutting time on this edge before the pass, s.
    pub edge_time: f64,
    /// True flank wear (wheel wear for grinding) at the start, m.
    pub flank_wear_start: f64,
    /// True flank wear at the end, m.
    pub flank_wear_end: f64,
    /// Wear that the controller believes at the end, m; NaN without observer.
    pub flank_wear_estimate: f64,
    /// Main (normal for grinding) force at the end, N.
    pub cutting_force: f64,
    /// Spindle power at the end, W.
    pub spindle_power: f64,
    /// Contact temperature at the end, K.
    pub temperature: f64,
    /// Energy of the cut, J.
    pub energy: f64,
    /// Size error at the end, m.
    pub size_error: f64,
    /// Time in an unstable cut, s.
    pub chatter_time: f64,
    /// Least stability margin, 1 − depth/limit; NaN where stability is not judged.
    pub stability_margin: f64,
    /// Frequency with which it chattered first, Hz; 0 without chatter.
    pub chatter_frequency: f64,
    /// Greatest amplitude of the vibration, m.
    pub vibration_amplitude: f64,
    /// Greatest roughness Ra, m.
    pub roughness: f64,
}

/// One cutting edge, or one dressing cycle of a wheel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeRow {
    /// How often it had been ground anew when it was mounted.
    pub ground: u32,
    /// Tool type.
    pub tool: u32,
    /// Machine.
    pub machine: u32,
    /// Put in, s.
    pub installed: f64,
    /// Taken out, s.
    pub removed: f64,
    /// Why.
    pub reason: ChangeReason,
    /// Cutting time, s.
    pub cutting_time: f64,
    /// Cutting path, m.
    pub path: f64,
    /// Passes it cut, whole or in part: its rows in [`RunLog::passes`].
    pub passes: u32,
    /// Parts whose operation it finished.
    pub parts: u32,
    /// Final flank wear (specific removed volume has no place here), m.
    pub flank_wear: f64,
    /// True factor on mechanical wear, 1.
    pub mechanical_wear_factor: f64,
    /// True factor on thermal wear, 1.
    pub thermal_wear_factor: f64,
}

/// One job: a piece, or pieces of an order that move together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JobRow {
    /// Part type.
    pub part: u32,
    /// Order that it belongs to, by index.
    pub order: Option<u32>,
    /// Pieces.
    pub quantity: u32,
    /// Hardness batch of its source, from 1; of an order its number, from 1.
    pub lot: u32,
    /// Arrival, s.
    pub arrival: f64,
    /// First operation started, s; NaN: never.
    pub start: f64,
    /// Left the shop, s; NaN: still in it.
    pub finish: f64,
    /// Due, s.
    pub due: f64,
    /// Time of its operations in process, s, as far as they have ended.
    pub in_process: f64,
    /// The job from which an inspection divided it.
    pub divided_from: Option<u32>,
    /// How it ended.
    pub outcome: JobOutcome,
}

impl JobRow {
    /// A job that comes at `arrival`, s, and is due at `due`, s; of no order.
    pub fn new(part: u32, quantity: u32, arrival: f64, due: f64) -> Self {
        let (start, finish, outcome) = (f64::NAN, f64::NAN, JobOutcome::InProcess);
        let (in_process, divided_from) = (0.0, None);
        Self { part, order: None, quantity, lot: 1, arrival, start, finish, due, in_process, divided_from, outcome }
    }
}

/// What became of an operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum OperationResult {
    /// Completed, and the part is good so far.
    Good,
    /// Completed, and the part was scrapped at its inspection.
    Bad,
    /// Completed, and the part was sent back at its inspection.
    Rework,
    /// Not completed: a breakdown or the end of a shift spoiled the part.
    Lost,
    /// Not completed at the end of the run.
    InProcess,
}

/// One operation of one job on one machine, from setup to inspection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OperationRow {
    /// Job.
    pub job: u32,
    /// Part type.
    pub part: u32,
    /// Operation within the routing.
    pub operation: u32,
    /// Pieces.
    pub quantity: u32,
    /// Machine.
    pub machine: u32,
    /// Since when its time counts, s: begun, or begun anew after an interruption that undid it.
    pub start: f64,
    /// Time from when its job came to the queue to that, s.
    pub waited: f64,
    /// Completed or lost, s; NaN: in process at the end of the run.
    pub end: f64,
    /// Time in cut and in handling that it would still take, s, later passes as programmed; 0 unless
    /// it is in process.
    pub time_left: f64,
    /// Time of its work that lies before the start of the run, s; 0 unless it was in process then.
    pub time_before: f64,
    /// Times of plain work, or of passes, that it stands for: pieces, or its share of what a lot or a batch took once.
    pub work: f64,
    /// Operation to which its job goes; the same one where it is not completed.
    pub next: u32,
    /// What became of it.
    pub result: OperationResult,
}

/// One stay of a machine in one state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StateRow {
    /// Machine.
    pub machine: u32,
    /// State.
    pub state: MachineState,
    /// From, s.
    pub start: f64,
    /// To, s.
    pub end: f64,
    /// Whether the machine is in shift: inside its calendar, or at work after it to finish a part.
    /// A repair goes on out of shift; a stay that the end of a shift divides has two rows.
    pub in_shift: bool,
    /// Job in the machine.
    pub job: Option<u32>,
}

/// One stay of a person at a machine, on the way to it included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AttendanceRow {
    /// Person, by index into the operators of the scenario.
    pub operator: u32,
    /// Machine.
    pub machine: u32,
    /// Job in the machine.
    pub job: u32,
    /// From, s.
    pub start: f64,
    /// To, s.
    pub end: f64,
    /// Share of the person that it takes, 0 to 1.
    pub share: f32,
}

/// One event worth a line in the log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EventRow {
    /// When, s.
    pub time: f64,
    /// What.
    pub event: LogEvent,
    /// Machine.
    pub machine: Option<u32>,
    /// Job.
    pub job: Option<u32>,
    /// Edge.
    pub edge: Option<u32>,
}

/// The tables of one replication under one policy.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RunLog {
    /// Passes in the order of their end.
    pub passes: Vec<PassRow>,
    /// Edges in the order of their installation; the index is the edge number.
    pub edges: Vec<EdgeRow>,
    /// Jobs in the order of their arrival; the index is the job number.
    pub jobs: Vec<JobRow>,
    /// Operations in the order of their end, those in process last.
    pub operations: Vec<OperationRow>,
    /// Machine states in the order of their end.
    pub states: Vec<StateRow>,
    /// Stays of people at machines in the order of their end.
    pub attendances: Vec<AttendanceRow>,
    /// Events in order.
    pub events: Vec<EventRow>,
    /// Simulated time, s.
    pub horizon: f64,
    /// Time at the start that no statistic counts, s. The tables hold it all the same.
    pub warm_up: f64,
    /// Replay proof: the same scenario, seed and version give the same digest.
    pub digest: u64,
    /// Calendar events handled.
    pub calendar_events: u64,
}
