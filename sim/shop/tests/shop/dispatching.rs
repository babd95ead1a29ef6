//! The job shops of Fisher and Thompson through the real shop.
//!
//! Makespan and sum of flow times as in the reference results of jasima (Apache-2.0,
//! `testInstances/*.expected`). There all jobs are due at time zero; a common due date far ahead
//! makes "least critical ratio" the same choice as their "least slack": most work left first.

use crate::instances::{FT06, FT10, FT20, Instance};
use crate::scenarios::{self, jobs_at, machine, operation, part, run};
use toolroom_scenario::{Arrival, DispatchRule, Scenario};
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
        arrivals: (0..instance.len()).map(|part| Arrival { part, ..jobs_at(&[(0.0, 1)]) }).collect(),
        dispatch: rule,
        ..scenarios::scenario()
    }
}

/// Makespan and sum of flow times.
fn result(instance: Instance, rule: DispatchRule) -> (f64, f64) {
    let log = run(&job_shop(instance, rule));
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
    let mut other = shop.parts[0].clone();
    other.operations[0].setup_group = "b".to_owned();
    shop.parts.push(other);
    // a b a b a, all there from the start.
    shop.arrivals = (0..5).map(|i| Arrival { part: i % 2, ..jobs_at(&[(0.0, 1)]) }).collect();
    let makespan = |rule| {
        let log = run(&Scenario { dispatch: rule, ..shop.clone() });
        log.jobs.iter().map(|job| job.finish).fold(0.0, f64::max)
    };
    assert_eq!(makespan(DispatchRule::Fifo), 5.0 * 10.0 + 4.0 * 50.0);
    assert_eq!(makespan(DispatchRule::LeastSetup), 5.0 * 10.0 + 50.0);
}
