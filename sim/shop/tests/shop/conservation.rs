//! Nothing is lost and nothing appears, whatever happens in the shop.

use crate::scenarios::{Rubbing, jobs_at, machine, operation, part, scenario, tool};
use proptest::prelude::*;
use std::collections::BTreeMap;
use toolroom_scenario::*;
use toolroom_shop::runlog::{ChangeReason, JobOutcome, LogEvent, OperationResult, RunLog};

/// A busy small shop with every kind of trouble.
fn troubled(seed: u64, dispatch: DispatchRule, part_rule: Interruption, at_end: Interruption) -> Scenario {
    let mut lathe = machine("lathe");
    lathe.load_time = Distribution::Triangular { low: 1.0, mode: 2.0, high: 6.0 };
    lathe.unload_time = Distribution::Uniform { low: 1.0, high: 2.0 };
    lathe.setup_time = 20.0;
    lathe.magazine = 3;
    lathe.refill_time = 30.0;
    let mut second = lathe.clone();
    second.name = "second".to_owned();
    second.calendar = Some(0);
    let mut rough = operation(&[0, 1], &[8.0, 12.0]);
    rough.scrap_on_tool_failure = 0.3;
    let mut fine = operation(&[1], &[5.0, 5.0, 5.0]);
    fine.setup_group = "b".to_owned();
    fine.size_tolerance = 0.45;
    Scenario {
        seed,
        horizon: 5000.0,
        machines: vec![lathe, second],
        tools: vec![tool(Rubbing { wear_per_path: 0.011, wear_limit: 0.5, breaks_at: 0.55 })],
        parts: vec![part("shaft", vec![rough.clone(), fine]), part("ring", vec![rough])],
        arrivals: vec![
            Arrival::from_part(0, ArrivalPattern::Poisson { rate: 0.015 }),
            Arrival::from_part(1, ArrivalPattern::Batch { interval: 400.0, size: 4 }),
            Arrival::from_part(1, ArrivalPattern::ConstantWork { jobs: 1 }),
            jobs_at(&[(7000.0, 3), (10.0, 2)]),
        ],
        dispatch: vec![dispatch],
        calendars: vec![ShiftCalendar::periodic(
            "two shifts",
            1000.0,
            vec![Shift { start: 50.0, end: 400.0 }, Shift { start: 400.0, end: 900.0 }],
            at_end,
        )],
        failures: vec![
            FailureMode {
                name: None,
                machine: 0,
                time_between: Distribution::Exponential { mean: 150.0 },
                time_to_repair: Distribution::Exponential { mean: 15.0 },
                clock: FailureClock::Busy,
                crew: None,
                part: part_rule,
            },
            FailureMode {
                name: None,
                machine: 1,
                time_between: Distribution::Weibull { mean: 300.0, shape: 1.5 },
                time_to_repair: Distribution::Exponential { mean: 40.0 },
                clock: FailureClock::Calendar,
                crew: None,
                part: part_rule,
            },
            FailureMode {
                name: None,
                machine: 1,
                time_between: Distribution::Exponential { mean: 100.0 },
                time_to_repair: Distribution::Constant(25.0),
                clock: FailureClock::Busy,
                crew: None,
                part: part_rule,
            },
        ],
        ..scenario()
    }
}

fn check(shop: &Scenario, log: &RunLog) {
    let close = |a: f64, b: f64| (a - b).abs() <= 1e-9 * shop.horizon;
    for machine in 0..shop.machines.len() as u32 {
        // States follow one another without gap from zero to the horizon.
        let mut end = 0.0;
        for row in log.states.iter().filter(|row| row.machine == machine) {
            assert_eq!(row.start, end, "a gap in the states of machine {machine}");
            assert!(row.end > row.start);
            end = row.end;
        }
        assert_eq!(end, shop.horizon);
        // Time in cut is the time of the passes.
        let cut: f64 = log.passes.iter().filter(|row| row.machine == machine).map(|row| row.cutting_time).sum();
        let state = crate::scenarios::time_in(log, machine, toolroom_shop::runlog::MachineState::Cutting);
        assert!(close(cut, state), "machine {machine}: {cut} s of passes, {state} s cutting");
    }
    for (number, edge) in log.edges.iter().enumerate() {
        let passes = || log.passes.iter().filter(|row| row.edge as usize == number);
        assert_eq!(passes().count(), edge.passes as usize);
        assert!(close(passes().map(|row| row.cutting_time).sum(), edge.cutting_time));
        assert!(close(passes().map(|row| row.path).sum(), edge.path));
        assert!(edge.installed <= edge.removed && edge.removed <= shop.horizon);
        // Wear is handed on from pass to pass.
        let mut wear = passes().next().map_or(0.0, |row| row.flank_wear_start);
        for row in passes() {
            assert_eq!(row.flank_wear_start, wear);
            wear = row.flank_wear_end;
        }
        assert_eq!(wear, edge.flank_wear);
    }
    // Every operation of a good part is completed, on one machine after the other.
    for machine in 0..shop.machines.len() as u32 {
        let mut free = 0.0;
        for row in log.operations.iter().filter(|row| row.machine == machine) {
            assert!(row.start >= free, "two operations at once in machine {machine}");
            assert_eq!(row.result == OperationResult::InProcess, row.end.is_nan());
            assert!(row.time_left >= 0.0 && (row.time_left == 0.0 || row.end.is_nan()));
            free = if row.end.is_nan() { shop.horizon } else { row.end };
        }
    }
    for (number, job) in log.jobs.iter().enumerate().filter(|(_, job)| job.outcome == JobOutcome::Good) {
        let rows = log.operations.iter().filter(|row| row.job as usize == number);
        assert!(rows.clone().all(|row| row.result == OperationResult::Good));
        assert_eq!(rows.count(), shop.parts[job.part as usize].operations.len());
    }
    let mut outcomes: BTreeMap<JobOutcome, usize> = BTreeMap::new();
    for (number, job) in log.jobs.iter().enumerate() {
        *outcomes.entry(job.outcome).or_default() += 1;
        assert_eq!(job.outcome == JobOutcome::InProcess, job.finish.is_nan());
        if job.outcome == JobOutcome::Good {
            // A good part has all of its path behind it.
            let planned: f64 = shop.parts[job.part as usize]
                .operations
                .iter()
                .flat_map(|operation| match &operation.work {
                    Work::Cutting(cuts) => cuts.clone(),
                    Work::Plain(_) | Work::Grinding { .. } | Work::Cycle(_) | Work::Contour(_) | Work::Program(_) => {
                        Vec::new()
                    }
                })
                .map(|cut| cut.path_length)
                .sum();
            let cut: f64 = log.passes.iter().filter(|row| row.job as usize == number).map(|row| row.path).sum();
            assert!(cut >= planned - 1e-9 * planned, "job {number}: {cut} m of {planned} m");
        }
    }
    let count = |event: LogEvent| log.events.iter().filter(|row| row.event == event).count();
    assert_eq!(count(LogEvent::Arrival), log.jobs.len());
    assert_eq!(count(LogEvent::Finish), outcomes.get(&JobOutcome::Good).copied().unwrap_or(0));
    let scrap = log.jobs.iter().filter(|job| !matches!(job.outcome, JobOutcome::Good | JobOutcome::InProcess));
    assert_eq!(count(LogEvent::Scrap), scrap.count());
    assert!(log.events.windows(2).all(|pair| pair[0].time <= pair[1].time));
}

const RULES: [DispatchRule; 5] = [
    DispatchRule::Fifo,
    DispatchRule::ShortestProcessingTime,
    DispatchRule::EarliestDueDate,
    DispatchRule::CriticalRatio,
    DispatchRule::LeastSetup,
];
const BREAKDOWN: [Interruption; 3] = [Interruption::Resume, Interruption::Repeat, Interruption::Scrap];
const SHIFT_END: [Interruption; 4] =
    [Interruption::Finish, Interruption::Resume, Interruption::Repeat, Interruption::Scrap];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]
    #[test]
    fn jobs_times_and_edges_add_up(
        seed in 0u64..1000, dispatch in 0usize..5, part in 0usize..3, at_end in 0usize..4, change in 0usize..3
    ) {
        let mut shop = troubled(seed, RULES[dispatch], BREAKDOWN[part], SHIFT_END[at_end]);
        shop.policies[0].tool_change = [
            ToolChangeRule::PartCount { parts: 3 },
            ToolChangeRule::CuttingTime { time: 30.0 },
            ToolChangeRule::WearLimit { limit: Some(0.4) },
        ][change];
        let log = toolroom_shop::run(&shop, 0, 0).unwrap();
        prop_assert!(log.passes.len() > 100);
        check(&shop, &log);
    }
}

#[test]
fn every_kind_of_ending_occurs() {
    let mut seen: Vec<JobOutcome> = Vec::new();
    let mut reasons: Vec<ChangeReason> = Vec::new();
    for part in BREAKDOWN {
        let mut shop = troubled(1, DispatchRule::Fifo, part, Interruption::Scrap);
        shop.policies[0].tool_change = ToolChangeRule::WearLimit { limit: Some(0.44) };
        let log = toolroom_shop::run(&shop, 0, 0).unwrap();
        seen.extend(log.jobs.iter().map(|job| job.outcome));
        reasons.extend(log.edges.iter().map(|edge| edge.reason));
    }
    for outcome in [
        JobOutcome::Good,
        JobOutcome::ToolFailure,
        JobOutcome::OutOfTolerance,
        JobOutcome::Breakdown,
        JobOutcome::ShiftEnd,
        JobOutcome::InProcess,
    ] {
        assert!(seen.contains(&outcome), "{outcome:?} never happened");
    }
    for reason in [ChangeReason::Rule, ChangeReason::WearLimit, ChangeReason::Chipping, ChangeReason::EndOfRun] {
        assert!(reasons.contains(&reason), "{reason:?} never happened");
    }
}

#[test]
fn an_empty_shop_is_idle_all_day() {
    let mut shop = scenario();
    shop.arrivals.clear();
    let log = toolroom_shop::run(&shop, 0, 0).unwrap();
    assert_eq!((log.jobs.len(), log.passes.len(), log.edges.len(), log.states.len()), (0, 0, 0, 1));
    assert_eq!((log.states[0].start, log.states[0].end), (0.0, shop.horizon));
}
