//! Everything of a shop that changes, as plain data.

use super::assembly::StockArrival;
use super::cards::Cards;
use super::crew::CrewState;
use super::crib::CribState;
use super::draws::Ranks;
use super::fixture::{FixtureState, Shortages};
use super::flow::Flow;
use super::job::Jobs;
use super::lot::Lot;
use super::machine::Machine;
use super::maintenance::UpkeepState;
use super::operator::{OperatorState, StepRequest};
use super::release::Pool;
use super::sequence::Followed;
use super::stock::StockState;
use super::transport::TransportState;
use std::collections::VecDeque;
use toolroom_kernel::{EventKey, SimTime, Stream};

/// Jobs, machines with their queues and edges, failure clocks, sources. Cloning it takes a
/// snapshot.
#[derive(Clone, Debug)]
pub struct World {
    /// Jobs in the shop.
    pub jobs: Jobs,
    /// Machines, as in the scenario.
    pub machines: Vec<Machine>,
    /// Failure modes, as in the scenario.
    pub modes: Vec<FailureState>,
    /// Sources of jobs, as in the scenario.
    pub sources: Vec<SourceState>,
    /// Orders of which several jobs are in the shop, by order.
    pub lots: Vec<Option<Lot>>,
    /// People, as in the scenario.
    pub operators: Vec<OperatorState>,
    /// Crews, as in the scenario.
    pub crews: Vec<CrewState>,
    /// Vehicles, as in the scenario.
    pub transports: Vec<TransportState>,
    /// Fixtures, as in the scenario.
    pub fixtures: Vec<FixtureState>,
    /// Edges that are limited, by crib.
    pub cribs: Vec<CribState>,
    /// Sequences that machines follow, by machine.
    pub sequences: Vec<Followed>,
    /// Planned maintenance, as in the scenario.
    pub upkeep: Vec<UpkeepState>,
    /// Maintenance that is due and has not begun.
    pub(super) upkeep_waiting: u32,
    /// Machines with work that lacks one of them.
    pub(super) lacking: Shortages,
    /// Since when somebody attends to every machine, by machine; nothing without people.
    pub(super) attended: Vec<SimTime>,
    /// Steps that wait for somebody.
    pub(super) awaiting: Vec<StepRequest>,
    /// Cards of loops, and jobs that wait for them.
    pub cards: Cards,
    /// Jobs that are not let into the shop yet.
    pub pool: Pool,
    /// Places in buffers, and jobs that cannot move on.
    pub flow: Flow,
    /// Finished components that are not built in yet, by part, the first come in front.
    pub stock: Vec<VecDeque<StockArrival>>,
    /// Components that are ordered when few are left, as in the scenario.
    pub stocks: Vec<StockState>,
    /// Orders of which pieces begin anew in this instant, and how many.
    pub(super) missing: Vec<(u32, u32)>,
    /// Pieces that have begun anew, by order.
    pub(super) anew: Vec<u32>,
    /// Whether the shop has been changed as its scenario says.
    pub(super) branched: bool,
    /// Waiting jobs that may interrupt others.
    pub(super) challengers: Vec<u32>,
    /// Edges mounted so far.
    pub edges_mounted: u32,
    /// Number and time (s) of the operations that wait at every station, kept where a rule looks at them.
    pub(super) waiting_work: Vec<(u32, f64)>,
    /// Orders and operations that machines begin in this instant: others may still join them.
    pub(super) dividing: Vec<(u32, u32)>,
    /// Orders on their way to operations for which a machine may be set up.
    pub(super) setups_ahead: Vec<(u32, u32)>,
    /// Machines that may choose a job now.
    pub(super) candidates: Vec<u32>,
}

/// A failure mode on its way to the next failure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FailureState {
    /// Failures so far: index of the next draw.
    pub count: u64,
    /// Whether it is being repaired.
    pub failed: bool,
    /// Busy time left to the failure at `since`, s; of calendar clocks unused.
    pub left: f64,
    /// Time that the repair of the failure takes, s.
    pub repair: f64,
    /// When the busy clock was started.
    pub since: SimTime,
    /// The failure in the calendar; `None` while the clock stands.
    pub due: Option<EventKey>,
}

/// A source of jobs.
#[derive(Clone, Debug)]
pub struct SourceState {
    /// Jobs released so far: index of the next one.
    pub released: u64,
    /// Pieces of these jobs.
    pub pieces: u64,
    /// Releases so far: row of a schedule, number of a lot.
    pub releases: u64,
    /// Times between arrivals.
    pub stream: Stream,
    /// Times of plain work, by part.
    pub(super) ranks: Vec<Ranks>,
}
