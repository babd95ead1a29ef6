//! What is simulated: an immutable description of shop, parts, tools and policies, in SI.
//!
//! ```text
//!  scenario.toml ──read──► Scenario ──► Shop::new(scenario, policy, replication) ──► RunLog
//! ```
//! Everything refers to everything else by index; the room of scenario files turns names into indices and reports every
//! fault of a file with its place.
//!
//! | module | what it is |
//! |---|---|
//! | [`date`] | civil dates of orders and calendars |
//! | [`policies`] | who chooses the speed and when an edge is changed: a scenario's policy worked out |
//! | [`effects`] | catalogue rows of what a shop does beside its nominal simulation |
//!
//! # What is not modelled
//! What controllers leave out is listed in [`policies`].

#![deny(clippy::wildcard_enum_match_arm)]
#![cfg_attr(test, allow(clippy::wildcard_enum_match_arm))]

mod assembly;
mod batch;
mod branch;
mod calibration;
mod contour;
mod control;
mod crib;
mod deviation;
mod dispatch;
pub mod effects;
mod empty;
mod flow;
mod gap;
mod grinding;
mod inspection;
mod life_only;
mod maintenance;
mod order;
mod part;
pub mod policies;
mod policy;
mod posterior;
mod program;
mod resource;
mod schedule;
mod scope;
mod shared;
mod speed;
mod spreads;
mod stability;
mod station;
mod transport;
mod tuning;
mod unit;
mod variants;

pub use assembly::{Component, Pegging, Reorder, Stock};
pub use batch::{Batch, BatchFamily, BatchUnit, DrawUnit, PieceTimes, WorkPer};
pub use branch::{Branch, Urgency};
pub use calibration::{Calibration, CalibrationShift, ShopConstant, Target, calibrated, calibrated_channel};
pub use contour::{ContourRule, ContourWork};
pub use control::{
    Assignment, CardLoop, Control, DueRule, KeyOptions, KeyTime, MOST_LOOPS, NextQueue, QueueChoice, ReleaseRule,
    SlackBy,
};
pub use crib::{Crib, Purchase, Regrind};
pub use deviation::{Deviation, MICRO_STOP, ShopEffect};
pub use dispatch::{DispatchRule, MOST_RULES, Preemption};
pub use flow::{Blocking, Buffer, Deadlock};
pub use gap::{GapSection, SensorErrors};
pub use grinding::{CycleWork, DressingRule, GrindingRule};
pub use inspection::{InspectedTo, InspectedUnit, Inspection, InspectionOutcome, OutsideSample, Replenish, Sample};
pub use life_only::{EdgeLife, LifeOnly, LifeSpeed, WornTool};
pub use maintenance::Maintenance;
pub use order::{InProcess, MachineChoice, Order, by_id};
pub use part::{Arrival, ArrivalPattern, Cut, GrindingPhase, MachineTime, Operation, Part, Work, lot_name};
pub use policy::{Knowledge, PolicyRule, SensorSheet, ToolChangeRule};
pub use posterior::{DrawReader, DrawTable, Posterior, read_posterior, read_posterior_of_pair, set_draw_reader};
pub use program::{ProgramWork, ProgramWorkError, ToolCall};
pub use resource::{Attendance, Operator, Presence, SetupMatrix, Ways};
pub use schedule::{PlannedOperation, Schedule};
pub use scope::{Occasion, SCOPE_NAMES, Scope};
pub use shared::{Fixture, Hold, Shared};
pub use speed::{Course, PATH, PRICE, SPEED, SpeedChoice, SpeedEntry, SpeedPart, SpeedRule, WEAR};
pub use spreads::Spreads;
pub use stability::{StabilityRule, StructureScatter, Uncertainty};
pub use station::{FailureClock, FailureMode, MachineType, ProcessModel, ToolType, station_name};
pub use toolroom_calendar::{
    Boundary, Dated, Hours, Interruption, Joined, PacedShift, Paces, Periodic, Shift, ShiftCalendar, WeekPlan,
    WorkingTime, date,
};
pub use toolroom_distribution::{Distribution, Empirical};
pub use toolroom_stock::{Conditions as CutConditions, Span, TimedStretch};
pub use transport::{Crew, Parking, Transport, TransportRule};
pub use tuning::{Setting, SettingRange, Tunable, TuneRequest};
pub use unit::{Importer, UnitRefusal, UnitRequest, import_unit, set_importer};
pub use variants::{MOST_SCOPED, SwitchedEffect, Variants, move_constant};

use std::borrow::Cow;

/// A complete study: one shop under one or more policies.
#[derive(Clone, Debug)]
pub struct Scenario {
    /// Short name, also of the output folder.
    pub name: String,
    /// One line for people.
    pub title: String,
    /// The date of second 0, s since 1970-01-01; `None` where the scenario has no dates.
    pub start: Option<f64>,
    /// Seed of every random stream.
    pub seed: u64,
    /// Independent repetitions of the horizon.
    pub replications: u32,
    /// Simulated time of one replication, s, warm-up included.
    pub horizon: f64,
    /// Time at the start that no statistic counts, s; 0 while it is still to be found.
    pub warm_up: f64,
    /// Whether the warm-up is to be found from runs before figures are counted.
    pub seeks_warm_up: bool,
    /// Length of the shift to which rates refer (parts per shift), s.
    pub shift_length: f64,
    /// Machines.
    pub machines: Vec<MachineType>,
    /// Tools (cutting edges, milling cutters, grinding wheels).
    pub tools: Vec<ToolType>,
    /// Parts with their routings.
    pub parts: Vec<Part>,
    /// Where jobs come from.
    pub arrivals: Vec<Arrival>,
    /// Orders, beside what comes from the sources.
    pub orders: Vec<Order>,
    /// Names of what operators can do.
    pub skills: Vec<String>,
    /// People.
    pub operators: Vec<Operator>,
    /// Crews that repair.
    pub crews: Vec<Crew>,
    /// Vehicles; of several kinds that could carry a job the first does.
    pub transports: Vec<Transport>,
    /// Time of a move from one place to another between which no vehicle drives.
    pub move_time: Distribution,
    /// Fixtures, pallets: what operations need beside their machines.
    pub shared: Shared,
    /// Times of changing over between setup groups.
    pub setup_matrices: Vec<SetupMatrix>,
    /// Which of several idle machines takes a job.
    pub machine_choice: MachineChoice,
    /// Buffers with a limited number of places, before machines and behind them.
    pub buffers: Vec<Buffer>,
    /// When a machine is held up by the lack of a place.
    pub blocking: Blocking,
    /// What happens when parts wait for each other's places.
    pub deadlock: Deadlock,
    /// Which waiting job a free machine takes: rules of which each decides where the ones before are equal.
    /// The first [`MOST_RULES`] count.
    pub dispatch: Vec<DispatchRule>,
    /// Cards, release, and what the keys of the rules are made of.
    pub control: Control,
    /// What becomes of plain work in a machine when a job of better priority comes.
    pub preemption: Preemption,
    /// Working time; a machine without calendar always works.
    pub calendars: Vec<ShiftCalendar>,
    /// Breakdowns.
    pub failures: Vec<FailureMode>,
    /// Planned maintenance.
    pub maintenance: Vec<Maintenance>,
    /// The comparison axis; the first one is the baseline of every difference.
    pub policies: Vec<PolicyRule>,
    /// What the true shop does otherwise than planned.
    pub deviations: Vec<Deviation>,
    /// Constants that measurements have moved. Those of a tool's process are in its process already.
    pub calibrations: Vec<Calibration>,
    /// Effects that the file defines beside those of the catalogue.
    pub defined: Vec<&'static toolroom_effects::Definition>,
    /// Currency code of all costs.
    pub currency: String,
    /// How it was ruled before it was changed; `None`: it is not changed while it runs.
    pub branch: Option<Branch>,
}

impl Scenario {
    /// Replications that one draw of a posterior serves: one where a single policy is looked at; four where policies are
    /// compared, so that what the data leave open can be told from what chance does within one draw (assumption: four give
    /// three degrees of freedom for the latter, and cost as few draws as possible).
    pub fn replications_per_draw(&self) -> u32 {
        if self.policies.len() > 1 { 4 } else { 1 }
    }

    /// Replications in a row that meet the same true parameters, and are therefore not independent of each other: one where
    /// no tool takes draws of a posterior.
    pub fn replications_alike(&self) -> u32 {
        if self.has_draws() { self.replications_per_draw() } else { 1 }
    }

    fn has_draws(&self) -> bool {
        self.tools.iter().any(|tool| tool.posterior.is_some())
    }

    /// The true world of a replication: tools whose parameters come from a posterior take one of its draws, the same under
    /// every policy. Policies are worked out on the scenario itself, which has the values of the sets: controllers
    /// believe those and not the draw.
    ///
    /// # Errors
    /// [`ResolveError::Draw`](policies::ResolveError::Draw) where a draw gives a process that contradicts itself.
    pub fn drawn(&self, replication: u32) -> Result<Cow<'_, Self>, policies::ResolveError> {
        if !self.has_draws() {
            return Ok(Cow::Borrowed(self));
        }
        let number = replication / self.replications_per_draw();
        let mut world = self.clone();
        for tool in &mut world.tools {
            *tool = tool
                .drawn(self.seed, number, &self.calibrations)
                .map_err(|reason| policies::ResolveError::Draw { tool: tool.name.clone(), replication, reason })?;
        }
        Ok(Cow::Owned(world))
    }

    /// Whether the run ends by itself: with the last of its orders, or of jobs that come at given times. Nothing
    /// settles then, and the whole run counts.
    pub fn is_terminating(&self) -> bool {
        let given = |arrival: &Arrival| matches!(arrival.pattern, ArrivalPattern::Schedule(_));
        !self.orders.is_empty() || self.arrivals.iter().all(given)
    }

    /// What went wrong with the tools' processes without changing a result ([`MachineProcess::notes`](toolroom_process::MachineProcess::notes)).
    pub fn notes(&self) -> Vec<String> {
        self.tools.iter().flat_map(|tool| tool.process.machine_process().notes()).collect()
    }

    /// Whether policies choose the cutting speed of a tool: that of lathes, and of mills where nothing else has a speed to choose.
    pub fn commands_speed_of(&self, tool: &ToolType) -> bool {
        let commanded = |tool: &ToolType| tool.process.takes_speed_commands();
        let mill = matches!(tool.process, ProcessModel::Milling(_));
        commanded(tool) || mill && !self.tools.iter().any(commanded)
    }

    /// Rules of the queue of a machine.
    #[inline]
    pub fn rules(&self, machine: usize) -> &[DispatchRule] {
        self.machines[machine].rules.as_deref().unwrap_or(&self.dispatch)
    }
}
