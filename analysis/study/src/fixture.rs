//! A small shop and hand-made logs for tests.

use std::sync::Arc;
use toolroom_cutting::Turning;
use toolroom_infeed::Infeed;
use toolroom_scenario::*;
use toolroom_shop::runlog::{
    ChangeReason, EdgeRow, EventRow, JobOutcome, JobRow, LogEvent, MachineState, OperationResult, OperationRow,
    PassRow, RunLog, StateRow,
};

fn machine(name: &str, process: &str, rate: f64, handling: f64) -> MachineType {
    MachineType {
        name: name.to_owned(),
        process: process.to_owned(),
        rate,
        load_time: Distribution::Constant(handling),
        unload_time: Distribution::Uniform { low: 0.5 * handling, high: 1.5 * handling },
        tool_change_time: 60.0,
        setup_time: 0.0,
        setup_matrix: None,
        setup_at_start: None,
        edges_at_start: Vec::new(),
        input_buffer: None,
        output_buffer: None,
        location: name.to_owned(),
        batch: None,
        magazine: 10,
        refill_time: 0.0,
        speed_range: (0.1, 5.0),
        idle_power: 100.0,
        coolant_change: None,
        rules: None,
        calendar: None,
    }
}

fn tool(name: &str, process: ProcessModel, edge_cost: f64) -> ToolType {
    ToolType {
        name: name.to_owned(),
        process,
        variants: Default::default(),
        parameter_set: "test".to_owned(),
        edge_cost,
        dressing_time: 30.0,
        scatter: Default::default(),
        structure_scatter: Default::default(),
        posterior: None,
        spreads: Default::default(),
        life: None,
    }
}

fn policy(name: &str, speed: SpeedRule) -> PolicyRule {
    PolicyRule {
        name: name.to_owned(),
        speed,
        tool_change: ToolChangeRule::WearLimit { limit: None },
        ..PolicyRule::default()
    }
}

/// Two lathes that share an operation, a grinder after them; an hour.
pub(crate) fn scenario() -> Scenario {
    let cut = Cut {
        cutting_speed: 0.5,
        feed: 1e-4,
        depth_of_cut: 1e-3,
        width_of_cut: 0.0,
        path_length: 60.0,
        ..Cut::default()
    };
    let operation = |name: &str, machines: Vec<usize>, tool, work| Operation {
        name: name.to_owned(),
        machines,
        tool: Some(tool),
        worn_tool: None,
        setup_group: name.to_owned(),
        machine_choice: None,
        time_on: Vec::new(),
        setup_time: None,
        setup_spread: None,
        attendance: Attendance::default(),
        work,
        work_per: WorkPer::Part,
        draw: DrawUnit::Lot,
        inspection: Inspection::default(),
        preemptible: true,
        assembles: false,
        size_tolerance: 1e-4,
        roughness_limit: f64::INFINITY,
        scrap_on_tool_failure: 1.0,
    };
    let grinding = Work::Grinding {
        work_rotation_speed: std::f64::consts::TAU,
        phases: vec![GrindingPhase { infeed_per_rev: 1e-6, revolutions: 100 }],
    };
    Scenario {
        name: "fixture".to_owned(),
        title: "Two lathes <and> a grinder".to_owned(),
        seed: 42,
        replications: 20,
        horizon: 3600.0,
        shift_length: 3600.0,
        machines: vec![
            machine("L1", "turning", 0.01, 60.0),
            machine("L2", "turning", 0.01, 60.0),
            machine("G1", "infeed", 0.02, 10.0),
        ],
        tools: vec![
            tool("insert", ProcessModel::Turning(turning()), 2.0),
            tool("wheel", ProcessModel::Infeed(infeed()), 1.0),
        ],
        parts: vec![Part {
            name: "ring".to_owned(),
            material_cost: 10.0,
            flow_allowance: 500.0,
            batch_size: 10,
            deviating_lot: None,
            components: Vec::new(),
            pegging: Default::default(),
            replenish: Default::default(),
            random_routing: false,
            operations: vec![
                operation("turn", vec![0, 1], 0, Work::Cutting(vec![cut; 2])),
                operation("grind", vec![2], 1, grinding),
            ],
        }],
        arrivals: vec![Arrival::from_part(0, ArrivalPattern::Schedule(vec![(0.0, 2)]))],
        policies: vec![policy("constant", SpeedRule::BestCost), policy("adaptive", SpeedRule::MinimumWear)],
        ..Scenario::empty()
    }
}

fn turning() -> Arc<Turning> {
    Arc::new(Turning::named("ni_vk6om").expect("a shipped set"))
}

fn infeed() -> Arc<Infeed> {
    Arc::default()
}

/// A pass at 0.5 m/s.
pub(crate) fn pass(job: u32, operation: u32, pass: u32, machine: u32, edge: u32, start: f64, end: f64) -> PassRow {
    PassRow {
        job,
        part: 0,
        operation,
        pass,
        machine,
        edge,
        start,
        end,
        cutting_time: end - start,
        speed_start: 0.5,
        speed_end: 0.5,
        feed: 1e-4,
        depth_of_cut: 1e-3,
        path: 0.5 * (end - start),
        engaged_time: end - start,
        cutting_length: 0.5 * (end - start),
        edge_time: 0.0,
        flank_wear_start: 1e-4,
        flank_wear_end: 2e-4,
        flank_wear_estimate: f64::NAN,
        cutting_force: 500.0,
        spindle_power: 250.0,
        temperature: 1000.0,
        energy: 1000.0,
        chatter_time: 0.0,
        stability_margin: f64::NAN,
        chatter_frequency: 0.0,
        vibration_amplitude: 0.0,
        roughness: 0.0,
        size_error: 1e-6,
    }
}

pub(crate) fn edge(
    tool: u32,
    machine: u32,
    installed: f64,
    removed: f64,
    reason: ChangeReason,
    cutting_time: f64,
) -> EdgeRow {
    EdgeRow {
        ground: 0,
        tool,
        machine,
        installed,
        removed,
        reason,
        cutting_time,
        path: 0.5 * cutting_time,
        passes: 2,
        parts: 1,
        flank_wear: 3e-4,
        mechanical_wear_factor: 1.0,
        thermal_wear_factor: 1.0,
    }
}

pub(crate) fn states(machine: u32, steps: &[(MachineState, f64)]) -> Vec<StateRow> {
    let mut start = 0.0;
    let row = |&(state, end): &(MachineState, f64)| {
        let in_shift = state != MachineState::OffShift;
        let row = StateRow { machine, state, start, end, in_shift, job: None };
        start = end;
        row
    };
    steps.iter().map(row).collect()
}

/// An operation that is over.
pub(crate) fn operation(
    job: u32,
    operation: u32,
    machine: u32,
    start: f64,
    end: f64,
    result: OperationResult,
) -> OperationRow {
    OperationRow {
        job,
        part: 0,
        operation,
        quantity: 1,
        machine,
        start,
        waited: 0.0,
        end,
        time_left: 0.0,
        time_before: 0.0,
        work: 1.0,
        next: operation + 1,
        result,
    }
}

/// One good part, and one whose edge chipped in its first pass.
pub(crate) fn log() -> RunLog {
    use MachineState::{Cutting, Handling, Idle, ToolChange};
    let lathe = states(
        0,
        &[
            (Handling, 60.0),
            (Cutting, 360.0),
            (Handling, 420.0),
            (ToolChange, 480.0),
            (Handling, 540.0),
            (Cutting, 690.0),
            (Idle, 3600.0),
        ],
    );
    let grinder = states(2, &[(Idle, 420.0), (Handling, 430.0), (Cutting, 530.0), (Handling, 540.0), (Idle, 3600.0)]);
    let mut rows = [lathe, states(1, &[(Idle, 3600.0)]), grinder].concat();
    rows.sort_by(|a, b| a.end.total_cmp(&b.end));
    let job = |finish: f64, outcome| JobRow {
        part: 0,
        order: None,
        quantity: 1,
        lot: 1,
        arrival: 0.0,
        start: 0.0,
        finish,
        due: 500.0,
        in_process: 0.0,
        divided_from: None,
        outcome,
    };
    let grinding = PassRow {
        speed_start: 0.0,
        speed_end: 0.0,
        path: 0.0,
        engaged_time: 0.0,
        cutting_length: 0.0,
        ..pass(0, 1, 0, 2, 2, 430.0, 530.0)
    };
    RunLog {
        passes: vec![
            pass(0, 0, 0, 0, 0, 60.0, 210.0),
            pass(0, 0, 1, 0, 0, 210.0, 360.0),
            grinding,
            pass(1, 0, 0, 0, 1, 540.0, 690.0),
        ],
        edges: vec![
            edge(0, 0, 0.0, 420.0, ChangeReason::Rule, 300.0),
            edge(0, 0, 480.0, 690.0, ChangeReason::Chipping, 150.0),
            edge(1, 2, 0.0, 3600.0, ChangeReason::EndOfRun, 100.0),
        ],
        jobs: vec![job(540.0, JobOutcome::Good), job(690.0, JobOutcome::ToolFailure)],
        operations: vec![
            operation(0, 0, 0, 0.0, 420.0, OperationResult::Good),
            operation(0, 1, 2, 420.0, 540.0, OperationResult::Good),
            operation(1, 0, 0, 480.0, 690.0, OperationResult::Bad),
        ],
        states: rows,
        events: vec![
            EventRow { time: 0.0, event: LogEvent::Arrival, machine: None, job: Some(0), edge: None },
            EventRow { time: 420.0, event: LogEvent::ToolChange, machine: Some(0), job: None, edge: Some(0) },
            EventRow { time: 690.0, event: LogEvent::Scrap, machine: None, job: Some(1), edge: Some(1) },
        ],
        attendances: Vec::new(),
        horizon: 3600.0,
        warm_up: 0.0,
        digest: 0x0123_4567_89ab_cdef,
        calendar_events: 12,
    }
}
