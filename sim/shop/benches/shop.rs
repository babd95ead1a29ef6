//! Calendar events per second of the shop, with and without a log, and a shift of a shop with
//! real cuts.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;
use std::sync::Arc;
use toolroom_cutting::{Milling, Turning};
use toolroom_infeed::Infeed;
use toolroom_scenario::policies::ResolvedPolicy;
use toolroom_scenario::*;
use toolroom_shop::Silent;
use toolroom_shop::{RunLog, Shop};
use toolroom_wear::Scatter;

fn machine(name: &str, process: &str, load_time: Distribution) -> MachineType {
    MachineType {
        name: name.to_owned(),
        process: process.to_owned(),
        rate: 0.02,
        load_time,
        unload_time: Distribution::Constant(0.0),
        tool_change_time: 120.0,
        setup_time: 600.0,
        setup_matrix: None,
        setup_at_start: None,
        edges_at_start: Vec::new(),
        input_buffer: None,
        output_buffer: None,
        location: name.to_owned(),
        batch: None,
        magazine: 20,
        refill_time: 300.0,
        speed_range: (0.1, 10.0),
        idle_power: 500.0,
        coolant_change: None,
        rules: None,
        calendar: None,
    }
}

fn tool(name: &str, process: ProcessModel) -> ToolType {
    ToolType {
        name: name.to_owned(),
        process,
        variants: Default::default(),
        parameter_set: name.to_owned(),
        edge_cost: 8.0,
        dressing_time: 90.0,
        scatter: Scatter::shop(),
        structure_scatter: Default::default(),
        posterior: None,
        spreads: Default::default(),
        life: None,
    }
}

fn operation(machines: &[usize], tool: usize, work: Work) -> Operation {
    Operation {
        name: "operation".to_owned(),
        machines: machines.to_vec(),
        tool: Some(tool),
        worn_tool: None,
        machine_choice: None,
        time_on: Vec::new(),
        setup_group: "one".to_owned(),
        setup_time: None,
        setup_spread: None,
        attendance: Attendance::default(),
        work,
        work_per: WorkPer::Part,
        draw: DrawUnit::Lot,
        inspection: Inspection::default(),
        preemptible: true,
        assembles: false,
        size_tolerance: f64::INFINITY,
        roughness_limit: f64::INFINITY,
        scrap_on_tool_failure: 0.3,
    }
}

fn part(name: String, operations: Vec<Operation>) -> Part {
    let components = Vec::new();
    Part {
        name,
        material_cost: 1.0,
        flow_allowance: 1e5,
        batch_size: 25,
        deviating_lot: None,
        components,
        pegging: Default::default(),
        replenish: Default::default(),
        random_routing: false,
        operations,
    }
}

fn policy(speed: SpeedRule) -> PolicyRule {
    PolicyRule {
        name: format!("{speed:?}"),
        speed,
        tool_change: ToolChangeRule::WearLimit { limit: None },
        ..PolicyRule::default()
    }
}

fn scenario() -> Scenario {
    Scenario {
        name: "bench".to_owned(),
        title: "bench".to_owned(),
        policies: vec![policy(SpeedRule::Programmed)],
        ..Scenario::empty()
    }
}

/// Six machines at 85 % load, exponential work, sixty routes through all of them: 7 events a job.
fn job_shop(dispatch: DispatchRule) -> Scenario {
    let mut state = 1u64;
    let mut random = |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    let work = Distribution::Exponential { mean: 1.0 };
    let routes: Vec<Vec<usize>> = (0..60)
        .map(|_| {
            let mut route: Vec<usize> = (0..6).collect();
            (1..6).rev().for_each(|i| route.swap(i, random(i + 1)));
            route
        })
        .collect();
    Scenario {
        horizon: 20_000.0,
        machines: (0..6).map(|i| machine(&format!("machine {i}"), "turning", work.clone())).collect(),
        tools: vec![tool("insert", ProcessModel::Turning(Arc::new(Turning::default())))],
        parts: routes
            .iter()
            .enumerate()
            .map(|(i, route)| {
                let operations = route.iter().map(|&m| operation(&[m], 0, Work::Cutting(Vec::new())));
                part(format!("part {i}"), operations.collect())
            })
            .collect(),
        arrivals: (0..60).map(|part| Arrival::from_part(part, ArrivalPattern::Poisson { rate: 0.85 / 60.0 })).collect(),
        dispatch: vec![dispatch],
        ..scenario()
    }
}

/// Three lathes, two mills, one grinder, one shift.
fn demo() -> Scenario {
    let load = Distribution::Triangular { low: 20.0, mode: 30.0, high: 60.0 };
    let cut = |cutting_speed: f64, feed, depth_of_cut, width_of_cut, path_length| Cut {
        cutting_speed,
        feed,
        depth_of_cut,
        width_of_cut,
        path_length,
        ..Cut::default()
    };
    let turning = Work::Cutting(vec![cut(40.0 / 60.0, 0.12e-3, 0.75e-3, 0.0, 40.0); 4]);
    let milling = Work::Cutting(vec![cut(160.0 / 60.0, 0.05e-3, 12e-3, 3e-3, 0.8); 3]);
    let phase = |infeed_per_rev, revolutions| GrindingPhase { infeed_per_rev, revolutions };
    let grinding = Work::Grinding {
        work_rotation_speed: 292.0 / 60.0 * std::f64::consts::TAU,
        phases: vec![phase(4.43e-6, 20), phase(1.3e-6, 8), phase(0.0, 4)],
    };
    let route = vec![operation(&[0, 1, 2], 0, turning), operation(&[3, 4], 1, milling), operation(&[5], 2, grinding)];
    let machines = ["turning", "turning", "turning", "milling", "milling", "infeed"];
    Scenario {
        machines: (0..6).map(|i| machine(&format!("machine {i}"), machines[i], load.clone())).collect(),
        tools: vec![
            tool("insert", ProcessModel::Turning(Arc::new(Turning::default()))),
            tool("cutter", ProcessModel::Milling(Arc::new(Milling::default()))),
            tool("wheel", ProcessModel::Infeed(Arc::new(Infeed::default()))),
        ],
        parts: vec![part("ring".to_owned(), route)],
        arrivals: vec![Arrival::from_part(0, ArrivalPattern::ConstantWork { jobs: 12 })],
        policies: [
            SpeedRule::Programmed,
            SpeedRule::BestRate,
            SpeedRule::Schedule,
            SpeedRule::MinimumWear,
            SpeedRule::Productivity { price: None },
        ]
        .map(policy)
        .to_vec(),
        ..scenario()
    }
}

fn events(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("job shop");
    for dispatch in [DispatchRule::Fifo, DispatchRule::ShortestProcessingTime] {
        let scenario = job_shop(dispatch);
        let policy = Arc::new(ResolvedPolicy::from_scenario(&scenario, 0).unwrap());
        let log = Shop::with_recorder(&scenario, policy.clone(), 0, RunLog::default()).unwrap().run().unwrap();
        group.throughput(Throughput::Elements(log.calendar_events));
        group.bench_function(BenchmarkId::new("full log", format!("{dispatch:?}")), |bench| {
            bench.iter(|| {
                Shop::with_recorder(black_box(&scenario), policy.clone(), 0, RunLog::default()).unwrap().run().unwrap()
            });
        });
        group.bench_function(BenchmarkId::new("no log", format!("{dispatch:?}")), |bench| {
            bench.iter(|| Shop::with_recorder(black_box(&scenario), policy.clone(), 0, Silent).unwrap().run().unwrap());
        });
    }
    group.finish();
}

fn shift(criterion: &mut Criterion) {
    let scenario = demo();
    let mut group = criterion.benchmark_group("shift of six machines");
    group.sample_size(10);
    for (index, rule) in scenario.policies.iter().enumerate() {
        let policy = Arc::new(ResolvedPolicy::from_scenario(&scenario, index).unwrap());
        let log = Shop::with_recorder(&scenario, policy.clone(), 0, RunLog::default()).unwrap().run().unwrap();
        group.throughput(Throughput::Elements(log.passes.len() as u64));
        group.bench_function(BenchmarkId::new("run", &rule.name), |bench| {
            bench.iter(|| {
                Shop::with_recorder(black_box(&scenario), policy.clone(), 0, RunLog::default()).unwrap().run().unwrap()
            });
        });
        group.bench_function(BenchmarkId::new("resolve", &rule.name), |bench| {
            bench.iter(|| ResolvedPolicy::from_scenario(black_box(&scenario), index).unwrap());
        });
    }
    group.finish();
}

criterion_group!(benches, events, shift);
criterion_main!(benches);
