//! What a planner asks of a scenario with orders: when each is finished and whether in time, how loaded
//! every machine is week by week, where work waits, and how much of it is in the shop.
//!
//! The figures of a run stand behind its key figures, in the order of [`Figures`], so that they are kept,
//! sharded and resumed with them.

mod answers;
mod files;
mod plan;
mod waits;
mod wip;

pub use answers::{Answers, Finish, LoadAnswer, LongestWait, OrderAnswer, QueueAnswer, answers};
pub(crate) use answers::{late, late_in, shown, stamped};
pub use files::{FILES, json, late_orders, write};
pub(crate) use files::{resource_name, station, ticks};
pub use plan::{PLAN, SEQUENCES, plan_json, plan_line, write_plan, write_sequences};
pub use wip::WipAnswer;

use std::collections::BTreeMap;
use toolroom_scenario::{Scenario, date};
use toolroom_schedule::attended;
use toolroom_shop::runlog::{JobOutcome, MachineState, RunLog, StateRow};
use waits::QueueFigure;
use wip::WipFigure;

/// Length of a week, s.
const WEEK: f64 = 7.0 * 86_400.0;

/// A calendar week of the run.
#[derive(Clone, Debug, PartialEq)]
pub struct Week {
    /// `2026-W14` by ISO 8601, or `week 1` where the scenario has no dates.
    pub name: String,
    /// From, s since the start.
    pub from: f64,
    /// To, s.
    pub to: f64,
}

/// What a machine does in a week, in the order of the figures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LoadKind {
    /// Working time of its calendar and overtime.
    PlannedBusy,
    /// Cutting, plain work, handling.
    Production,
    /// Changing over.
    Setup,
    /// Changing edges, dressing.
    Delay,
    /// Kept for a lot of which nothing is there.
    Starved,
    /// With a job that has no place to go to.
    Blocked,
    /// With a job whose step waits for somebody.
    WaitingOperator,
    /// Broken down in shift.
    Down,
    /// Ready without work.
    Free,
    /// With work that lacks a fixture.
    WaitingFixture,
    /// With a part for which there is no edge.
    WaitingTool,
    /// Maintained as planned: no planned busy time.
    Maintenance,
}

impl LoadKind {
    /// All of them.
    pub const ALL: [Self; 12] = [
        Self::PlannedBusy,
        Self::Production,
        Self::Setup,
        Self::Delay,
        Self::Starved,
        Self::Blocked,
        Self::WaitingOperator,
        Self::Down,
        Self::Free,
        Self::WaitingFixture,
        Self::WaitingTool,
        Self::Maintenance,
    ];

    /// Those that a scenario has.
    pub fn of_scenario(scenario: &Scenario) -> impl Iterator<Item = Self> {
        let states: Vec<MachineState> = MachineState::of(scenario).collect();
        let is_rare = |kind: Self| kind as usize > Self::Free as usize;
        Self::ALL.into_iter().filter(move |kind| {
            !is_rare(*kind) || states.iter().any(|own| Self::from_machine_state(*own) == Some(*kind))
        })
    }

    /// Name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::PlannedBusy => "planned_busy",
            Self::Production => "production",
            Self::Setup => "setup",
            Self::Delay => "delay",
            Self::Starved => "starved",
            Self::Blocked => "blocked",
            Self::WaitingOperator => "waiting_operator",
            Self::Down => "down",
            Self::Free => "free",
            Self::WaitingFixture => "waiting_fixture",
            Self::WaitingTool => "waiting_tool",
            Self::Maintenance => "maintenance",
        }
    }

    /// To which of them time in a state belongs that is in shift.
    fn from_machine_state(state: MachineState) -> Option<Self> {
        match state {
            MachineState::Cutting | MachineState::Working | MachineState::Handling => Some(Self::Production),
            MachineState::Setup => Some(Self::Setup),
            MachineState::ToolChange | MachineState::Dressing => Some(Self::Delay),
            MachineState::Starved => Some(Self::Starved),
            MachineState::Blocked => Some(Self::Blocked),
            MachineState::WaitingOperator => Some(Self::WaitingOperator),
            MachineState::WaitingFixture => Some(Self::WaitingFixture),
            MachineState::WaitingTool => Some(Self::WaitingTool),
            MachineState::Maintenance => Some(Self::Maintenance),
            MachineState::Down => Some(Self::Down),
            MachineState::Idle => Some(Self::Free),
            MachineState::OffShift => None,
        }
    }
}

/// Figures of an order: its finish, its good pieces, where it waited longest and how long.
const OF_ORDER: usize = 4;

/// Where the figures of a planner stand.
#[derive(Clone, Debug, PartialEq)]
pub struct Figures {
    orders: usize,
    /// Machines, and behind them people.
    resources: usize,
    /// Weeks of the run.
    pub weeks: Vec<Week>,
    /// Machines of every station: those that do the same operations.
    pub stations: Vec<Vec<usize>>,
    /// Instants at which work in process is taken stock of, s.
    pub instants: Vec<f64>,
    /// Number of the order and operation in the schedule that the shop follows.
    planned: BTreeMap<(u32, u32), usize>,
}

impl Figures {
    /// Of a scenario; nothing is there without orders.
    pub fn of(scenario: &Scenario) -> Self {
        if scenario.orders.is_empty() {
            return Self {
                orders: 0,
                resources: 0,
                weeks: Vec::new(),
                stations: Vec::new(),
                instants: Vec::new(),
                planned: BTreeMap::new(),
            };
        }
        let mut stations: Vec<Vec<usize>> = Vec::new();
        for operation in scenario.parts.iter().flat_map(|part| &part.operations) {
            let mut machines = operation.machines.clone();
            machines.sort_unstable();
            if !stations.contains(&machines) {
                stations.push(machines);
            }
        }
        stations.sort();
        let schedule = scenario.control.schedule.iter().flat_map(|schedule| schedule.operations());
        let planned =
            schedule.enumerate().map(|(number, (.., own))| ((own.order as u32, own.operation as u32), number));
        let (orders, resources) = (scenario.orders.len(), scenario.machines.len() + scenario.operators.len());
        let instants = wip::instants(scenario.horizon);
        Self { orders, resources, weeks: weeks(scenario), stations, instants, planned: planned.collect() }
    }

    /// Number of figures.
    pub fn len(&self) -> usize {
        self.wip(self.instants.len(), WipFigure::Orders) + self.planned.len()
    }

    /// Whether there is nothing that a planner would ask.
    pub fn is_empty(&self) -> bool {
        self.orders == 0
    }

    fn loads(&self) -> usize {
        self.resources * self.weeks.len() * LoadKind::ALL.len()
    }

    fn finish(&self, order: usize) -> usize {
        order
    }

    fn good(&self, order: usize) -> usize {
        self.orders + order
    }

    /// Whether an order has left the shop by the time it is due, with anything good of it.
    fn is_on_time(&self, scenario: &Scenario, run: &[f64], order: usize) -> bool {
        let ordered = &scenario.orders[order];
        let delivered = run[self.good(order)] > 0.0 || ordered.finished_before(&scenario.parts[ordered.part]) > 0;
        // NaN where it is not finished.
        run[self.finish(order)] <= ordered.due && delivered
    }

    /// The station at which it waited longest, by index; NaN where it waited nowhere.
    fn longest_at(&self, order: usize) -> usize {
        2 * self.orders + order
    }

    /// How long it waited there, s.
    fn longest_wait(&self, order: usize) -> usize {
        3 * self.orders + order
    }

    /// Of a machine, or of a person behind them.
    fn load(&self, resource: usize, week: usize, kind: LoadKind) -> usize {
        OF_ORDER * self.orders + (resource * self.weeks.len() + week) * LoadKind::ALL.len() + kind as usize
    }

    fn queue(&self, station: usize, figure: QueueFigure) -> usize {
        OF_ORDER * self.orders + self.loads() + station * QueueFigure::COUNT + figure as usize
    }

    fn wip(&self, instant: usize, figure: WipFigure) -> usize {
        self.queue(self.stations.len(), QueueFigure::MeanLength) + instant * WipFigure::COUNT + figure as usize
    }

    /// When an operation of the schedule began, s, by its number.
    fn start(&self, number: usize) -> usize {
        self.len() - self.planned.len() + number
    }

    /// The figures of one run; NaN where an order is not finished.
    pub fn evaluate(&self, scenario: &Scenario, log: &RunLog) -> Vec<f64> {
        let mut values = vec![0.0; self.len()];
        if self.is_empty() {
            return values;
        }
        for job in &log.jobs {
            let Some(order) = job.order.map(|order| order as usize) else { continue };
            // NaN stays once it is there: one job that is in process leaves the order unfinished.
            let last: f64 = values[self.finish(order)];
            values[self.finish(order)] =
                if last.is_nan() || job.finish.is_nan() { f64::NAN } else { last.max(job.finish) };
            if job.outcome == JobOutcome::Good {
                values[self.good(order)] += f64::from(job.quantity);
            }
        }
        self.add_loads(scenario, log, &mut values);
        self.add_people(scenario, log, &mut values);
        self.add_waits(scenario, log, &mut values);
        self.add_wip(scenario, log, &mut values);
        for number in 0..self.planned.len() {
            values[self.start(number)] = f64::NAN;
        }
        for row in log.operations.iter().filter(|_| !self.planned.is_empty()) {
            let order = log.jobs[row.job as usize].order;
            let Some(&number) = order.and_then(|order| self.planned.get(&(order, row.operation))) else { continue };
            let start = &mut values[self.start(number)];
            *start = start.min(row.start); // the first piece; a number that is none gives way
        }
        values
    }

    fn add_loads(&self, scenario: &Scenario, log: &RunLog, values: &mut [f64]) {
        for (number, week) in self.weeks.iter().enumerate() {
            for (machine, kind) in scenario.machines.iter().enumerate() {
                let calendar = kind.calendar.map(|index| &scenario.calendars[index]);
                let planned = calendar
                    .map_or(week.to - week.from, |calendar| calendar.working_time(week.from, week.to.min(log.horizon)));
                values[self.load(machine, number, LoadKind::PlannedBusy)] = planned;
            }
            let inside = |row: &&StateRow| row.in_shift && row.start < week.to && row.end > week.from;
            for row in log.states.iter().filter(inside) {
                let machine = row.machine as usize;
                let (from, to) = (row.start.max(week.from), row.end.min(week.to));
                if let Some(kind) = LoadKind::from_machine_state(row.state) {
                    values[self.load(machine, number, kind)] += to - from;
                }
                let calendar = scenario.machines[machine].calendar.map(|index| &scenario.calendars[index]);
                let overtime = calendar.map_or(0.0, |calendar| to - from - calendar.working_time(from, to));
                let maintained = if row.state == MachineState::Maintenance { to - from } else { 0.0 };
                values[self.load(machine, number, LoadKind::PlannedBusy)] += overtime - maintained;
            }
        }
    }

    /// What people do, each share of a person by its time: planned are the hours of their calendars, free is what is left.
    fn add_people(&self, scenario: &Scenario, log: &RunLog, values: &mut [f64]) {
        let machines = scenario.machines.len();
        let stays = if scenario.operators.is_empty() { Vec::new() } else { attended(log) };
        for (number, week) in self.weeks.iter().enumerate() {
            for (person, operator) in scenario.operators.iter().enumerate() {
                let (from, to) = (week.from, week.to.min(log.horizon));
                let calendar = operator.calendar.map(|index| &scenario.calendars[index]);
                let planned = calendar.map_or(to - from, |calendar| calendar.working_time(from, to));
                values[self.load(machines + person, number, LoadKind::PlannedBusy)] = planned;
                values[self.load(machines + person, number, LoadKind::Free)] = planned;
            }
            for stay in stays.iter().filter(|stay| stay.start < week.to && stay.end > week.from) {
                let time = stay.share * (stay.end.min(week.to) - stay.start.max(week.from));
                let person = machines + stay.operator as usize;
                // On the way to a machine that waits.
                let kind = match LoadKind::from_machine_state(stay.state) {
                    Some(LoadKind::WaitingOperator) | None => LoadKind::Delay,
                    Some(kind) => kind,
                };
                values[self.load(person, number, kind)] += time;
                values[self.load(person, number, LoadKind::Free)] -= time;
            }
        }
        // Ten shares of a tenth are one, but for rounding.
        for person in 0..scenario.operators.len() {
            for number in 0..self.weeks.len() {
                let free = &mut values[self.load(machines + person, number, LoadKind::Free)];
                *free = if free.abs() < 1e-3 { 0.0 } else { *free };
            }
        }
    }
}

/// The weeks that a run touches: of the calendar where it has dates, else from its start on.
fn weeks(scenario: &Scenario) -> Vec<Week> {
    let mut weeks = Vec::new();
    let mut from = scenario.start.map_or(0.0, |start| date::week(start).1 - start);
    while from < scenario.horizon {
        let name = match scenario.start {
            // Noon of its Monday lies in the week for certain.
            Some(start) => date::week(start + from + 43_200.0).0,
            None => format!("week {}", weeks.len() + 1),
        };
        weeks.push(Week { name, from: from.max(0.0), to: (from + WEEK).min(scenario.horizon) });
        from += WEEK;
    }
    weeks
}

#[cfg(test)]
mod tests;
