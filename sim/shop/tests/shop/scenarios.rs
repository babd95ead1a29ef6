//! Small scenarios and processes that tests are made of.

use std::sync::Arc;
use toolroom_process::{Advance, AnyRecord, MachineProcess, ModelError, Process, ProcessEvent, Record, record};
use toolroom_scenario::*;
use toolroom_shop::runlog::{MachineState, RunLog};
use toolroom_wear::Scatter;

record! {
    /// What the test process is told.
    pub struct Command {
        /// Cutting speed.
        cutting_speed: Real["m/s" => "m/min"] = 1.0, 0.0..=10.0;
        /// Whether the edge is in cut.
        engaged: Boolean = 1.0;
        /// Factor on wear.
        wear_rate_factor: Real = 1.0, 0.0..=100.0;
    }
}

record! {
    /// State of the test process.
    pub struct Worn {
        /// Flank wear.
        flank_wear: Real["m" => "mm"] = 0.0, 0.0..=10.0;
    }
}

record! {
    /// Output of the test process.
    pub struct Shown {
        /// Flank wear.
        flank_wear: Real["m" => "mm"] = 0.0, 0.0..=10.0;
        /// Size error, equal to the wear.
        size_error: Real["m" => "mm"] = 0.0, 0.0..=10.0;
        /// Spindle power, constant.
        spindle_power: Real["W" => "kW"] = 100.0, 0.0..=1e4;
    }
}

/// Wear proportional to path; the edge is spent at one wear and breaks at another.
#[derive(Clone, Debug)]
pub struct Rubbing {
    pub wear_per_path: f64,
    pub wear_limit: f64,
    pub breaks_at: f64,
}

impl Process for Rubbing {
    type Input = Command;
    type State = Worn;
    type Output = Shown;
    const NAME: &'static str = "rubbing";
    const EVENTS: &'static [ProcessEvent] = &[ProcessEvent::WearLimit, ProcessEvent::Chipping];

    fn initial(&self) -> Worn {
        Worn::default()
    }

    fn output(&self, x: &Worn, _: &Command) -> Shown {
        Shown { flank_wear: x.flank_wear, size_error: x.flank_wear, spindle_power: 100.0 }
    }

    fn advance(&self, x: &mut Worn, u: &Command, dt: f64) -> Result<Advance, ModelError> {
        u.check()?;
        let rate = u.engaged * u.cutting_speed * u.wear_rate_factor * self.wear_per_path;
        let crossing = |limit: f64| (x.flank_wear < limit).then(|| (limit - x.flank_wear) / rate);
        let events = [(self.wear_limit, ProcessEvent::WearLimit), (self.breaks_at, ProcessEvent::Chipping)];
        let first = events
            .into_iter()
            .filter_map(|(limit, event)| crossing(limit).map(|time| (time, limit, event)))
            .filter(|(time, ..)| *time < dt)
            .min_by(|a, b| a.0.total_cmp(&b.0));
        match first {
            Some((elapsed, limit, event)) => {
                x.flank_wear = limit;
                Ok(Advance { elapsed, event: Some(event) })
            }
            None => {
                x.flank_wear += rate * dt;
                Ok(Advance { elapsed: dt, event: None })
            }
        }
    }

    fn event_indicators(&self, x: &Worn, _: &Command, indicators: &mut [f64]) {
        indicators.copy_from_slice(&[x.flank_wear - self.wear_limit, x.flank_wear - self.breaks_at]);
    }

    fn parameters_mut(&mut self) -> Vec<(&'static str, &mut dyn AnyRecord)> {
        Vec::new()
    }
}

/// An edge that never wears.
pub fn eternal() -> Rubbing {
    Rubbing { wear_per_path: 0.0, wear_limit: 1.0, breaks_at: 2.0 }
}

pub fn tool(process: impl MachineProcess + 'static) -> ToolType {
    ToolType {
        name: "insert".to_owned(),
        process: ProcessModel::Other(Arc::new(process)),
        variants: Default::default(),
        parameter_set: "test".to_owned(),
        edge_cost: 5.0,
        dressing_time: 0.0,
        scatter: Scatter::none(),
        structure_scatter: Default::default(),
        posterior: None,
        spreads: Default::default(),
        life: None,
    }
}

pub fn machine(name: &str) -> MachineType {
    MachineType {
        name: name.to_owned(),
        process: "rubbing".to_owned(),
        rate: 0.01,
        load_time: Distribution::Constant(0.0),
        unload_time: Distribution::Constant(0.0),
        tool_change_time: 7.0,
        setup_time: 0.0,
        setup_matrix: None,
        setup_at_start: None,
        edges_at_start: Vec::new(),
        input_buffer: None,
        output_buffer: None,
        location: name.to_owned(),
        batch: None,
        magazine: 1000,
        refill_time: 0.0,
        speed_range: (0.1, 5.0),
        idle_power: 0.0,
        coolant_change: None,
        rules: None,
        calendar: None,
    }
}

/// Passes of these durations at 1 m/s.
pub fn operation(machines: &[usize], durations: &[f64]) -> Operation {
    let cut = |&path_length: &f64| Cut {
        cutting_speed: 1.0,
        feed: 1e-4,
        depth_of_cut: 1e-3,
        width_of_cut: 0.0,
        path_length,
        ..Cut::default()
    };
    Operation {
        name: "turn".to_owned(),
        machines: machines.to_vec(),
        tool: Some(0),
        worn_tool: None,
        setup_group: "a".to_owned(),
        machine_choice: None,
        time_on: Vec::new(),
        setup_time: None,
        setup_spread: None,
        attendance: Attendance::default(),
        work: Work::Cutting(durations.iter().map(cut).collect()),
        work_per: WorkPer::Part,
        draw: DrawUnit::Lot,
        inspection: Inspection::default(),
        preemptible: true,
        assembles: false,
        size_tolerance: f64::INFINITY,
        roughness_limit: f64::INFINITY,
        scrap_on_tool_failure: 0.0,
    }
}

pub fn part(name: &str, operations: Vec<Operation>) -> Part {
    Part {
        name: name.to_owned(),
        material_cost: 1.0,
        flow_allowance: 1000.0,
        batch_size: 10,
        deviating_lot: None,
        components: Vec::new(),
        pegging: Default::default(),
        replenish: Default::default(),
        random_routing: false,
        operations,
    }
}

pub fn policy(name: &str, speed: SpeedRule, tool_change: ToolChangeRule) -> PolicyRule {
    PolicyRule {
        name: name.to_owned(),
        speed,
        tool_change,
        sensors: SensorSheet { flank_wear: 0.0, ..SensorSheet::default() },
        ..PolicyRule::default()
    }
}

/// One machine, one part of one operation with one pass of 10 s; the policy reads no wear.
pub fn scenario() -> Scenario {
    Scenario {
        name: "test".to_owned(),
        title: "test".to_owned(),
        seed: 11,
        horizon: 1000.0,
        machines: vec![machine("lathe")],
        tools: vec![tool(eternal())],
        parts: vec![part("shaft", vec![operation(&[0], &[10.0])])],
        arrivals: vec![jobs_at(&[(0.0, 1)])],
        policies: vec![policy("programmed", SpeedRule::Programmed, ToolChangeRule::PartCount { parts: u32::MAX })],
        ..Scenario::empty()
    }
}

pub fn jobs_at(times: &[(f64, u32)]) -> Arrival {
    Arrival::from_part(0, ArrivalPattern::Schedule(times.to_vec()))
}

pub fn run(scenario: &Scenario) -> RunLog {
    toolroom_shop::run(scenario, 0, 0).unwrap()
}

/// Time that machine `machine` spent in a state, s.
pub fn time_in(log: &RunLog, machine: u32, state: MachineState) -> f64 {
    let rows = log.states.iter().filter(|row| row.machine == machine && row.state == state);
    rows.map(|row| row.end - row.start).sum()
}
