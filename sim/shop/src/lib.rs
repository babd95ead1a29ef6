//! The machining shop: jobs, machines, edges, and what happens to them.
//!
//! ```text
//!  Scenario ──► Shop::new(scenario, policy, replication)
//!                 │
//!                 ▼        settle every event of one instant, then let idle machines choose
//!   Calendar ──► Event ──► World ──► Recorder (RunLog)
//!                            │  ▲
//!          start of a pass   ▼  │  end of a pass, breakdown, end of a shift
//!                 Controller ──► Segment on a MachineProcess
//! ```
//!
//! An operation on a machine is: setup where the setup group changes, load, passes or plain work, unload
//! and inspection. Plain work is a time of which nothing else is known, for a piece. A job is a piece, or
//! pieces of an order that move together; the jobs of one order keep the machine on which its first one
//! began until the last is through. Where buffers are limited, a part that finds no place blocks its machine
//! ([`Flow`]); parts that wait for each other's places are found and named. A pass is one calendar event, its end: when it begins the engine copies the edge's
//! state, asks the policy for the speed, and advances the copy through the process to the end of
//! the pass or the loss of the edge. An interruption plans the elapsed part again and takes that
//! over. Nothing is polled.
//!
//! | type | what it is |
//! |---|---|
//! | [`Shop`] | one replication under one policy; `Clone` takes a snapshot, [`Shop::set_policy`] branches |
//! | [`World`] | everything that changes: [`Job`], [`Machine`] with [`Queue`], [`Task`] and [`Edge`] |
//! | [`Event`] | what the calendar holds |
//! | [`Recorder`] | who writes it down: [`RunLog`], or [`Silent`] |
//! | [`ShopError`] | why it stopped |
//!
//! # What is not modelled
//! Traffic of vehicles. Scatter of the stock that a grinder finds, and its finish and
//! roundness; a contour that is adapted while it is milled. Tools change on the machine that needs them, never in stock; a crib holds edges of one tool.

#![deny(clippy::wildcard_enum_match_arm)]

mod ahead;
mod arrival;
mod assembly;
mod assignment;
mod batch;
mod branch;
mod cards;
mod chatter;
mod contour;
mod crew;
mod crib;
mod deadlock;
mod deadlock_words;
mod deviation;
mod dispatch;
mod draws;
mod error;
mod event;
mod fixture;
mod flow;
mod forward_only;
mod grinding;
mod in_process;
mod inspection;
mod interruption;
mod job;
mod layout;
mod look;
mod lot;
mod lots;
mod machine;
mod machine_plan;
mod maintenance;
mod operation;
mod operation_plan;
mod operator;
mod owners;
mod part_program;
mod pass;
mod pieces;
mod plain_jobs;
mod plain_plan;
mod plain_queue;
mod plain_shop;
mod preemption;
mod queue_change;
mod quick;
mod quick_machines;
mod readiness;
mod release;
mod run;
mod sequence;
mod shift;
mod stock;
mod stretches;
mod task;
mod tooling;
mod transport;
mod world;

pub use assembly::StockArrival;
pub use batch::BatchState;
pub use cards::Cards;
pub use crew::CrewState;
pub use crib::CribState;
pub use error::{CODES, Refusal, ShopError};
pub use event::Event;
pub use fixture::{FixtureState, Shortages};
pub use flow::{Flow, Place};
pub use job::{Job, Jobs, Origin};
pub use layout::programmed_cutting_times;
pub use lot::{KeptMachine, Lot, LotStep};
pub use machine::Machine;
pub use maintenance::UpkeepState;
pub use operator::OperatorState;
pub use readiness::{Lack, Readiness};
pub use release::Pool;
pub use sequence::Followed;
pub use stock::StockState;
pub use task::{Content, Machining, Pass, Step, Stretches, Task, Tending};
pub use toolroom_cuts::{Block, Edge, Piece, Program, Reaction, Segment, Surface};
pub use toolroom_queues::{Queue, QueueEntry};
pub use transport::{Call, TransportState, VehicleState};
pub use world::{FailureState, SourceState, World};

pub use toolroom_runlog::recorder::{Closing, Recorder, Silent};
pub use toolroom_runlog::runlog::{self, RunLog};

use crate::runlog::{EventRow, LogEvent, StateRow};
use draws::Ranks;
use layout::{Layout, source_entity};
use std::collections::VecDeque;
use std::sync::Arc;
use toolroom_kernel::{Calendar, Class, Digest, EventKey};
use toolroom_kernel::{Purpose, SimTime, Streams};
use toolroom_runlog::recorder;
use toolroom_scenario::policies::{ResolvedPolicy, WheelEstimate};
use toolroom_scenario::{MachineType, Scenario};
use toolroom_wear::PairScatter;

/// Events at one instant after which the shop counts as stuck. A real shop settles an instant
/// in a few events a machine and job.
const STUCK_EVENTS: u64 = 1_000_000;

/// One replication of a scenario under one policy.
///
/// It is deterministic: the same scenario, policy and replication give the same bits, whatever
/// else runs. A clone is a snapshot that goes on independently.
#[derive(Clone, Debug)]
pub struct Shop<'a, R = RunLog> {
    scenario: &'a Scenario,
    layout: Arc<Layout>,
    controllers: Arc<ResolvedPolicy>,
    streams: Streams,
    pairs: Vec<PairScatter>,
    world: World,
    calendar: Calendar<Event>,
    digest: Digest,
    events: u64,
    recorder: R,
    /// Set when the run is closed between two events.
    end: Option<SimTime>,
}

/// Runs one replication of `scenario` under its policy number `policy`.
///
/// # Errors
/// [`ShopError`], with time, machine and operation where a process model refused.
///
/// # Examples
/// ```
/// let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/demo.toml");
/// let scenario = toolroom_scenario_file::read(file.as_ref(), &[]).unwrap().scenario;
/// let log = toolroom_shop::run(&scenario, 0, 0).unwrap();
/// assert_eq!(log.horizon, scenario.horizon);
/// assert!(log.passes.len() > 1000);
/// ```
pub fn run(scenario: &Scenario, policy: usize, replication: u32) -> Result<RunLog, ShopError> {
    let resolved = Arc::new(ResolvedPolicy::from_scenario(scenario, policy)?);
    let world = scenario.drawn(replication)?;
    Shop::with_recorder(&world, resolved, replication, RunLog::default())?.run()
}

impl<'a> Shop<'a, RunLog> {
    /// A shop at time zero that keeps a full log. Tools have the parameters of the scenario as it is; those of a replication
    /// whose tools have draws are in [`Scenario::drawn`].
    ///
    /// # Errors
    /// [`ShopError`] for indices that point nowhere and for policies that cannot be resolved.
    pub fn new(scenario: &'a Scenario, policy: usize, replication: u32) -> Result<Self, ShopError> {
        let resolved = Arc::new(ResolvedPolicy::from_scenario(scenario, policy)?);
        Shop::with_recorder(scenario, resolved, replication, RunLog::default())
    }
}

impl<'a, R: Recorder> Shop<'a, R> {
    /// A shop at time zero under a policy resolved before (once for many replications), with
    /// any recorder.
    ///
    /// # Errors
    /// [`ShopError`] for indices that point nowhere.
    pub fn with_recorder(
        scenario: &'a Scenario,
        policy: Arc<ResolvedPolicy>,
        replication: u32,
        recorder: R,
    ) -> Result<Self, ShopError> {
        let layout = Arc::new(Layout::of(scenario)?);
        let streams = Streams::new(scenario.seed, u64::from(replication));
        let machine = |(index, kind): (usize, &MachineType)| {
            let ready = layout.readiness(kind.setup_at_start.as_deref());
            let queue = branch::queue_of(scenario, index, branch::rules(scenario, false, index));
            Machine::new(scenario.tools.len(), kind, queue, ready)
        };
        let machines = scenario.machines.iter().enumerate().map(machine).collect();
        let source = |index| {
            let entity = source_entity(scenario, "arrivals", index);
            let ranks = Ranks::from_scenario(scenario, &layout, &streams, index);
            SourceState { released: 0, releases: 0, pieces: 0, stream: streams.open(entity, Purpose::Arrival), ranks }
        };
        let failure = FailureState { count: 0, failed: false, left: 0.0, repair: 0.0, since: SimTime::ZERO, due: None };
        let world = World {
            jobs: Jobs::with_plain_work(layout.plain_operations),
            machines,
            modes: vec![failure; scenario.failures.len()],
            sources: (0..scenario.arrivals.len()).map(source).collect(),
            edges_mounted: 0,
            lots: vec![None; scenario.orders.len()],
            waiting_work: vec![(0, 0.0); layout.overlapping.len()],
            candidates: Vec::new(),
            operators: Vec::new(),
            crews: scenario.crews.iter().map(CrewState::from_crew).collect(),
            transports: scenario.transports.iter().map(TransportState::from_transport).collect(),
            attended: vec![SimTime::ZERO; if scenario.operators.is_empty() { 0 } else { scenario.machines.len() }],
            awaiting: Vec::new(),
            fixtures: vec![FixtureState::default(); scenario.shared.fixtures.len()],
            cribs: scenario.shared.cribs.iter().map(CribState::from_crib).collect(),
            sequences: vec![Followed::default(); scenario.machines.len()],
            upkeep: Vec::new(),
            upkeep_waiting: 0,
            lacking: Shortages::default(),
            flow: Flow::of(scenario),
            stock: vec![VecDeque::new(); scenario.parts.len()],
            stocks: vec![StockState::default(); scenario.shared.stocks.len()],
            missing: Vec::new(),
            anew: vec![0; scenario.orders.len()],
            challengers: Vec::new(),
            branched: false,
            cards: Cards::from_scenario(scenario),
            pool: Pool::default(),
            dividing: Vec::new(),
            setups_ahead: Vec::new(),
        };
        let pairs = scenario.tools.iter().map(|tool| draws::pair(&tool.scatter, &streams, &tool.name)).collect();
        let mut shop = Self {
            scenario,
            layout,
            controllers: policy,
            streams,
            pairs,
            world,
            calendar: Calendar::new(),
            digest: Digest::new(),
            events: 0,
            recorder,
            end: None,
        };
        shop.open_sources()?;
        shop.open_orders()?;
        shop.open_stocks()?;
        shop.open_shifts()?;
        shop.open_operators()?;
        shop.open_failures()?;
        shop.open_maintenance()?;
        shop.open_crews()?;
        for machine in 0..scenario.machines.len() {
            shop.show_state(machine);
        }
        Ok(shop)
    }

    /// Handles every event up to and at `time`.
    ///
    /// # Errors
    /// [`ShopError`]; the shop is then of no further use.
    pub fn run_until(&mut self, time: SimTime) -> Result<(), ShopError> {
        if let Some(change_time) = self.change_until(time)? {
            self.settle_until(change_time)?;
            self.change();
        }
        self.settle_until(time)
    }

    fn settle_until(&mut self, time: SimTime) -> Result<(), ShopError> {
        let (mut instant, mut count) = (self.now(), 0);
        while let Some(now) = self.calendar.peek_time().filter(|next| *next <= time) {
            while let Some(event) = self.calendar.pop_before(now, Class::Observe) {
                self.digest.record(now, &[event.word()]);
                self.events += 1;
                self.settle(event)?;
                count = if now == instant { count + 1 } else { 0 };
                instant = now;
                if count > STUCK_EVENTS {
                    return Err(ShopError::NoProgress { time: now.seconds(), events: count });
                }
            }
            if self.layout.bare {
                self.dispatch()?;
                continue;
            }
            self.send_vehicles()?;
            self.assign_operators()?; // steps in work go before those that are yet to begin
            self.release_from_pool()?;
            if self.world.flow.is_limited() {
                self.settle_places()?;
            } else {
                self.settle_queues()?;
            }
            self.assign_operators()?;
        }
        Ok(())
    }

    /// Lets cards go to who waits for them, idle machines choose and urgent jobs interrupt, until nothing changes.
    fn settle_queues(&mut self) -> Result<(), ShopError> {
        loop {
            self.give_cards()?;
            self.dispatch()?;
            self.let_urgent_interrupt()?;
            if !self.world.cards.changed {
                break;
            }
        }
        if self.has_cards() || self.layout.travels {
            self.resolve_deadlock()?;
        }
        Ok(())
    }

    /// Closes every pass that is in process at `horizon`.
    ///
    /// # Errors
    /// [`ShopError`] where a pass that is cut short cannot be planned.
    fn close(&mut self, horizon: SimTime) -> Result<(), ShopError> {
        self.end = Some(horizon);
        for machine in 0..self.world.machines.len() {
            self.halt(machine)?;
            self.close_pass(machine);
            self.log_state(machine);
            self.log_attendance(machine);
            self.log_in_process(machine);
        }
        Ok(())
    }

    /// Retires edges and jobs as they are now and hands out the log.
    fn hand_out(mut self) -> R {
        for machine in 0..self.world.machines.len() {
            self.log_state(machine);
        }
        self.retire_all();
        for job in self.world.jobs.iter().filter(|job| !job.stand_in) {
            self.recorder.job(job.number, job.row);
        }
        let closing = Closing {
            horizon: self.now().seconds(),
            warm_up: self.scenario.warm_up,
            digest: self.digest.value(),
            calendar_events: self.events,
        };
        self.recorder.close(closing);
        self.recorder
    }

    /// Goes on under another policy of the scenario: the branch of a snapshot. Edges stay in
    /// the machines; a controller that observes measures each of them once when it takes over. The policy is worked out on
    /// the scenario of this shop, which in a world of [`Scenario::drawn`] is the draw.
    ///
    /// # Errors
    /// [`ShopError`] for an unknown policy and one that cannot be resolved.
    pub fn set_policy(&mut self, policy: usize) -> Result<(), ShopError> {
        let resolved = ResolvedPolicy::from_scenario(self.scenario, policy)?;
        if resolved != *self.controllers {
            self.controllers = Arc::new(resolved);
            for machine in &mut self.world.machines {
                machine.learnt.fill(None);
                for edge in machine.edges.iter_mut().flatten() {
                    edge.observer = None;
                    edge.wheel = WheelEstimate::default();
                }
            }
        }
        Ok(())
    }

    /// The state of the shop.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// What was written down so far.
    pub fn recorder(&self) -> &R {
        &self.recorder
    }

    /// Time of the last event.
    pub fn now(&self) -> SimTime {
        self.end.unwrap_or(self.calendar.now())
    }

    /// Hash of all events so far.
    pub fn digest(&self) -> Digest {
        self.digest
    }

    /// Calendar events handled so far.
    pub fn calendar_events(&self) -> u64 {
        self.events
    }

    fn settle(&mut self, event: Event) -> Result<(), ShopError> {
        match event {
            Event::StepEnd { machine } => self.step_ended(machine as usize),
            Event::Failure { mode } => self.fail(mode as usize),
            Event::Repair { mode } => self.repair(mode as usize),
            Event::Arrival { source } => self.arrive(source as usize),
            Event::Release { order } => self.release_order(order as usize),
            Event::BatchDue { machine } => {
                self.batch_due(machine as usize);
                Ok(())
            }
            Event::Pool => {
                self.look_at_pool();
                Ok(())
            }
            Event::Delivery { transport, vehicle } => self.delivered(transport as usize, vehicle as usize),
            Event::Operator { operator, comes } => self.operator_shift(operator as usize, comes),
            Event::Pace { machine } => self.pace_changes(machine as usize),
            Event::PickUp { transport, vehicle } => self.picks_up(transport as usize, vehicle as usize),
            Event::Moved { slot } => {
                self.moved_to(slot);
                Ok(())
            }
            Event::Restock { stock } => self.restock(stock as usize),
            Event::MakeUp { order } => self.begin_anew(order),
            Event::Edges { crib, number } => self.consigned(crib as usize, number),
            Event::Regrind { crib } => self.send_to_regrind(crib as usize),
            Event::Maintenance { plan } => self.maintenance_due(plan as usize),
            Event::Window { plan } => self.window_opens(plan as usize),
            Event::Maintained { plan } => self.maintained(plan as usize),
            Event::Alone { machine } => {
                self.leave_alone(machine as usize);
                Ok(())
            }
            Event::Walked { machine } => self.walked(machine as usize),
            Event::Crew { crew } => self.crew_comes(crew as usize),
            Event::Planned { machine } => {
                self.may_choose(machine as usize);
                Ok(())
            }
            Event::ShiftStart { machine } => self.shift_starts(machine as usize),
            Event::ShiftEnd { machine } => self.shift_ends(machine as usize),
        }
    }

    fn schedule(&mut self, time: SimTime, event: Event) -> Result<EventKey, ShopError> {
        Ok(self.calendar.schedule(time, event.class(), event)?)
    }

    fn job_in(&self, machine: usize) -> Option<u32> {
        let state = &self.world.machines[machine];
        let slot = state.task.as_ref().map(|task| task.slot).or(state.blocked)?;
        Some(self.world.jobs.at(slot).number)
    }

    /// Brings the logged state of a machine up to date.
    fn show_state(&mut self, machine: usize) {
        let state = self.world.machines[machine].current_state();
        let in_shift = !self.world.machines[machine].off_shift;
        let job = self.job_in(machine);
        let logged = &self.world.machines[machine];
        if logged.state != state || logged.state_in_shift != in_shift || logged.state_job != job {
            self.log_state(machine);
            let logged = &mut self.world.machines[machine];
            logged.state = state;
            logged.state_in_shift = in_shift;
            logged.state_job = job;
        }
    }

    /// Writes the stay in the logged state up to now.
    fn log_state(&mut self, machine: usize) {
        let now = self.now();
        let logged = &mut self.world.machines[machine];
        if now > logged.state_since {
            if logged.state.is_busy() {
                logged.worked += now - logged.state_since;
            }
            self.recorder.state(StateRow {
                machine: machine as u32,
                state: logged.state,
                start: logged.state_since.seconds(),
                end: now.seconds(),
                in_shift: logged.state_in_shift,
                job: logged.state_job,
            });
            logged.state_since = now;
        }
    }

    fn log_event(&mut self, event: LogEvent, machine: Option<usize>, job: Option<u32>, edge: Option<u32>) {
        let machine = machine.map(|index| index as u32);
        self.recorder.event(EventRow { time: self.now().seconds(), event, machine, job, edge });
    }
}
