//! The job shops of Fisher and Thompson through the real shop.
//!
//! Makespan and sum of flow times as in the reference results of jasima (Apache-2.0,
//! `testInstances/*.expected`). There all jobs are due at time zero; a common due date far ahead
//! makes "least critical ratio" the same choice as their "least slack": most work left first.

use crate::instances::{FT06, FT10, FT20, Instance};
use crate::scenarios::{self, jobs_at, machine, operation, part, run};
use toolroom_scenario::{Arrival, DispatchRule, Distribution, MachineType, NextQueue, Operation, Part, Scenario, Work};
use toolroom_shop::runlog::JobOutcome;

fn job_shop(instance: Instance, rule: DispatchRule) -> Scenario {
    let machines = instance[0].len() / 2;
    let parts = instance.iter().enumerate().map(|(index, steps)| {
        let operations = steps.chunks(2).map(|step| operation(&[step[0] as usize], &[f64::from(step[1])]));
        let mut part = part(&format!("job {index}"), operations.collect());
        part.flow_allowance = 1e6;
        part
    });
    Scenario {
        horizon: 1e4,
        machines: (0..machines).map(|index| machine(&format!("machine {index}"))).collect(),
        parts: parts.collect(),
        arrivals: (0..instance.len())
            .map(|part| Arrival { parts: vec![(part, 1.0)], ..jobs_at(&[(0.0, 1)]) })
            .collect(),
        dispatch: vec![rule],
        ..scenarios::scenario()
    }
}

/// Makespan and sum of flow times.
fn result(instance: Instance, rule: DispatchRule) -> (f64, f64) {
    makespan_and_flow(&job_shop(instance, rule))
}

fn makespan_and_flow(scenario: &Scenario) -> (f64, f64) {
    let log = run(scenario);
    assert!(log.jobs.iter().all(|job| job.outcome == JobOutcome::Good));
    let makespan = log.jobs.iter().map(|job| job.finish).fold(0.0, f64::max);
    (makespan, log.jobs.iter().map(|job| job.finish - job.arrival).sum())
}

#[test]
fn dispatching_rules_give_the_published_schedules() {
    let published = [
        (DispatchRule::ShortestProcessingTime, [(88.0, 316.0), (1074.0, 8343.0), (1267.0, 15705.0)]),
        (DispatchRule::Fifo, [(65.0, 329.0), (1184.0, 9782.0), (1645.0, 25542.0)]),
        (DispatchRule::EarliestDueDate, [(65.0, 329.0), (1184.0, 9782.0), (1645.0, 25542.0)]),
        (DispatchRule::CriticalRatio, [(61.0, 335.0), (1108.0, 10105.0), (1501.0, 24258.0)]),
        (DispatchRule::Slack, [(61.0, 335.0), (1108.0, 10105.0), (1501.0, 24258.0)]),
        (DispatchRule::LongestRemaining, [(61.0, 335.0), (1108.0, 10105.0), (1501.0, 24258.0)]),
        (DispatchRule::Lifo, [(68.0, 325.0), (1393.0, 9978.0), (1365.0, 16314.0)]),
        (DispatchRule::LongestProcessingTime, [(67.0, 347.0), (1295.0, 11034.0), (1631.0, 24430.0)]),
        // One setup group: nothing to tell jobs apart by but their arrival.
        (DispatchRule::LeastSetup, [(65.0, 329.0), (1184.0, 9782.0), (1645.0, 25542.0)]),
    ];
    for (rule, expected) in published {
        for (instance, expected) in [FT06, FT10, FT20].into_iter().zip(expected) {
            assert_eq!(result(instance, rule), expected, "{rule:?}");
        }
    }
}

#[test]
fn next_queues_with_started_work_give_the_schedules_of_jasima() {
    let published = [
        (DispatchRule::WorkInNextQueue, [(88.0, 326.0), (1344.0, 9743.0), (1513.0, 19510.0)]),
        (DispatchRule::TimesAndNextQueue, [(88.0, 317.0), (1181.0, 8135.0), (1335.0, 15088.0)]),
    ];
    for (rule, expected) in published {
        for (instance, expected) in [FT06, FT10, FT20].into_iter().zip(expected) {
            let mut scenario = job_shop(instance, rule);
            scenario.control.keys.next_queue = NextQueue::Started;
            assert_eq!(makespan_and_flow(&scenario), expected, "{rule:?}");
        }
    }
    // Waiting jobs alone are another rule.
    assert_eq!(result(FT10, DispatchRule::WorkInNextQueue).0, 1149.0);
}

#[test]
fn no_schedule_beats_the_optimum() {
    // Optimal makespans: Fisher & Thompson's instances in the ScheduleOpt benchmarks.
    for (instance, optimum) in [(FT06, 55.0), (FT10, 930.0), (FT20, 1165.0)] {
        for rule in [DispatchRule::Fifo, DispatchRule::ShortestProcessingTime, DispatchRule::CriticalRatio] {
            assert!(result(instance, rule).0 >= optimum);
        }
    }
}

#[test]
fn least_setup_keeps_the_setup_group_as_long_as_it_can() {
    let mut shop = scenarios::scenario();
    shop.machines[0].setup_time = 50.0;
    let mut parts = shop.parts[0].clone();
    parts.operations[0].setup_group = "b".to_owned();
    shop.parts.push(parts);
    // a b a b a, all there from the start.
    shop.arrivals = (0..5).map(|i| Arrival { parts: vec![(i % 2, 1.0)], ..jobs_at(&[(0.0, 1)]) }).collect();
    let makespan = |rule| {
        let log = run(&Scenario { dispatch: vec![rule], ..shop.clone() });
        log.jobs.iter().map(|job| job.finish).fold(0.0, f64::max)
    };
    assert_eq!(makespan(DispatchRule::Fifo), 5.0 * 10.0 + 4.0 * 50.0);
    assert_eq!(makespan(DispatchRule::LeastSetup), 5.0 * 10.0 + 50.0);
}

/// A job: time on the first machine, flow allowance, and the machine and time of a second operation.
type Job = (f64, f64, Option<(usize, f64)>);

/// Plain operations of these times on the first machine, all jobs there from the start; the part of each
/// job has its own allowance and, where it is given, a second operation on another machine.
fn plain_shop(rule: &[DispatchRule], jobs: &[Job]) -> Scenario {
    let plain = |machine: usize, time: f64| Operation {
        name: format!("on machine {machine}"),
        tool: None,
        work: Work::Plain(Distribution::Constant(time)),
        ..operation(&[machine], &[])
    };
    let machine =
        |index: usize| MachineType { process: MachineType::PLAIN.to_owned(), ..machine(&format!("M{index}")) };
    let part = |(index, &(time, flow_allowance, second)): (usize, &Job)| Part {
        flow_allowance,
        operations: [(0, time)].into_iter().chain(second).map(|(machine, time)| plain(machine, time)).collect(),
        ..part(&format!("job {index}"), Vec::new())
    };
    Scenario {
        machines: (0..3).map(machine).collect(),
        tools: Vec::new(),
        parts: jobs.iter().enumerate().map(part).collect(),
        arrivals: (0..jobs.len()).map(|part| Arrival { parts: vec![(part, 1.0)], ..jobs_at(&[(0.0, 1)]) }).collect(),
        dispatch: rule.to_vec(),
        ..scenarios::scenario()
    }
}

/// The order in which the first machine took the jobs.
fn order(rule: &[DispatchRule], jobs: &[Job]) -> Vec<u32> {
    let mut starts: Vec<(f64, u32)> =
        (0..).zip(&run(&plain_shop(rule, jobs)).jobs).map(|(i, job)| (job.start, i)).collect();
    starts.sort_by(|a, b| a.partial_cmp(b).unwrap());
    starts.into_iter().map(|(_, job)| job).collect()
}

#[test]
fn every_rule_takes_jobs_in_the_order_of_its_formula() {
    use DispatchRule::*;
    // Time, allowance, next operation; the keys at each decision were computed independently.
    let jobs = [
        (4.0, 30.0, Some((1, 6.0))),
        (2.0, 40.0, None),
        (6.0, 14.0, Some((2, 1.0))),
        (3.0, 12.0, Some((1, 2.0))),
        (5.0, 9.0, None),
    ];
    let cases: [(DispatchRule, [u32; 5]); 21] = [
        (Fifo, [0, 1, 2, 3, 4]),
        (FirstReleased, [0, 1, 2, 3, 4]),
        (ShortestProcessingTime, [1, 3, 0, 4, 2]),
        (LongestProcessingTime, [2, 4, 0, 3, 1]),
        (ShortestRemaining, [1, 3, 4, 2, 0]),
        (LongestRemaining, [0, 2, 3, 4, 1]),
        (EarliestDueDate, [4, 3, 2, 0, 1]),
        // Due dates of operations: 12, 40, 12, 7.2, 9.
        (EarliestOperationDue, [3, 4, 0, 2, 1]),
        // Slack without the clock: 20, 38, 7, 7, 4.
        (Slack, [4, 2, 3, 0, 1]),
        (FewestOperations, [1, 4, 0, 2, 3]),
        (MostOperations, [0, 2, 3, 1, 4]),
        // At 0: 10, 38, 3.5, 3.5, 4. At 6 job 3 has 0.5, job 4 -2; and so on.
        (SlackPerOperation, [2, 4, 3, 0, 1]),
        // At 0: 3, 20, 2, 2.4, 1.8. At 5: 2.5, 17.5, 1.286, 1.4. At 11: 1.9, 14.5, 0.2.
        (CriticalRatio, [4, 2, 3, 0, 1]),
        // At 0 the due dates; at 5: 30, 40, 14, 12; at 8: 30, 40, 15.
        (ModifiedDueDate, [4, 3, 2, 0, 1]),
        // At 0: 12, 40, 12, 7.2, 9; at 3: 12, 40, 12, -, 9; at 8: 12, 40, 14; at 12 the rest.
        (ModifiedOperationDue, [3, 4, 0, 2, 1]),
        // At 4 job 0 waits with its 6 where job 3 would go; at 6 nobody waits there.
        (WorkInNextQueue, [0, 1, 2, 3, 4]),
        // At 5 job 3 waits with its 2 where job 0 would go: 6, -, 6, -, 5. At 10 nobody does: 4, -, 6.
        (TimeAndNextQueue, [1, 3, 4, 0, 2]),
        // At 5: 16, -, 13, -, 10.
        (TimesAndNextQueue, [1, 3, 4, 2, 0]),
        // At 5: 6, -, 6, -, 4. At 10: 4, -, 3.
        (TimeNextQueueAndSlack, [1, 3, 4, 2, 0]),
        // At 0 (mean 4): 0.0472, 0.0211, 0.0930, 0.186, 0.1433; at 3 (mean 4.25): 0.0659, 0.0321, 0.122, -, 0.185;
        // at 8 (mean 4): 0.0920, 0.0411, 0.167; at 14 (mean 3): 0.128, 0.0848.
        (Atc, [3, 4, 2, 0, 1]),
        // At 0: 0.125, 0, 0.125, 0.217, 0.16; at 3: 0.144, 0, 0.143, -, 0.19; at 8: 0.175, 0, 0.167.
        (Covert, [3, 4, 0, 2, 1]),
    ];
    for (rule, expected) in cases {
        assert_eq!(order(&[rule], &jobs), expected, "{rule:?}");
    }
    assert_ne!(order(&[Random], &jobs), order(&[Fifo], &jobs));
}

#[test]
fn a_second_rule_decides_where_the_first_is_equal() {
    let jobs = [(4.0, 30.0, None), (2.0, 30.0, None), (3.0, 20.0, None), (1.0, 30.0, None)];
    assert_eq!(order(&[DispatchRule::EarliestDueDate, DispatchRule::ShortestProcessingTime], &jobs), [2, 3, 1, 0]);
    assert_eq!(order(&[DispatchRule::EarliestDueDate, DispatchRule::Lifo], &jobs), [2, 0, 1, 3]);
}

#[test]
fn a_machine_may_have_its_own_rule() {
    let jobs = [(4.0, 30.0, None), (2.0, 30.0, None), (3.0, 20.0, None)];
    let mut shop = plain_shop(&[DispatchRule::Fifo], &jobs);
    shop.machines[0].rules = Some(vec![DispatchRule::ShortestProcessingTime]);
    let starts: Vec<f64> = run(&shop).jobs.iter().map(|job| job.start).collect();
    assert_eq!(starts, [5.0, 0.0, 2.0]);
}

#[test]
fn rules_look_at_the_work_that_waits_for_the_next_operation() {
    use DispatchRule::*;
    // At 1 job 0 waits for the second machine with its 9: jobs 1 and 2 would follow it, job 3 finds the
    // third machine free.
    let jobs = [
        (1.0, 90.0, Some((1, 9.0))),
        (1.0, 90.0, Some((1, 9.0))),
        (3.0, 90.0, Some((1, 1.0))),
        (8.0, 90.0, Some((2, 1.0))),
    ];
    assert_eq!(order(&[WorkInNextQueue], &jobs), [0, 3, 1, 2]);
    assert_eq!(order(&[TimeAndNextQueue], &jobs), [0, 3, 1, 2]);
    assert_eq!(order(&[ShortestProcessingTime], &jobs), [0, 1, 2, 3]);
}
