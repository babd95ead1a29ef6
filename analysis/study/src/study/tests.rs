use super::*;
use crate::compare::Comparison;
use crate::fixture;
use crate::summary::summary;
use crate::terminal::{Style, table};
use std::sync::Mutex;

/// Logs that differ by policy and replication, made without a shop.
fn simulate(policy: usize, replication: u32) -> Result<RunLog, ShopError> {
    let mut log = fixture::log();
    log.digest = u64::from(replication) * 31 + policy as u64;
    let shift = f64::from(replication % 7) + 10.0 * policy as f64;
    log.states[0].end += shift;
    log.jobs[0].finish += shift;
    Ok(log)
}

fn options(replications: u32, threads: usize) -> StudyOptions {
    StudyOptions { replications, threads, ..StudyOptions::of(&fixture::scenario()) }
}

fn study(options: &StudyOptions) -> Study {
    let stop = AtomicBool::new(false);
    study_with(&fixture::scenario(), options, None, &|_| {}, &stop, &simulate).expect("a study")
}

/// What a study writes, read again.
fn finished(study: &Study) -> Finished {
    let mut text = Vec::new();
    Finished::write(study, &mut text).expect("JSON");
    serde_json::from_slice(&text).expect("JSON")
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let one = study(&options(37, 1));
    for threads in [2, 5] {
        let many = study(&options(37, threads));
        assert_eq!((one.digest, one.replications), (many.digest, many.replications));
        assert_eq!(format!("{:?}", one.values), format!("{:?}", many.values));
        assert_eq!(format!("{:?}", one.edge_lives), format!("{:?}", many.edge_lives));
    }
    let lead = one.index("lead_time").expect("a figure");
    assert_eq!(one.values(1, lead)[..3], [550.0, 551.0, 552.0]);
    assert_eq!(one.first_logs.len(), 2);
}

#[test]
fn another_replication_or_policy_changes_the_digest() {
    let base = study(&options(5, 1)).digest;
    assert_ne!(base, study(&options(6, 1)).digest);
    assert_ne!(base, study(&StudyOptions { policies: vec![1, 0], ..options(5, 1) }).digest);
}

#[test]
fn a_stop_keeps_the_replications_that_all_policies_finished() {
    let stop = AtomicBool::new(false);
    let after_nine = |progress: Progress| {
        if progress.done >= 9 {
            stop.store(true, Ordering::Relaxed);
        }
    };
    let study =
        study_with(&fixture::scenario(), &options(100, 1), None, &after_nine, &stop, &simulate).expect("a study");
    assert!(!study.complete);
    assert_eq!(study.replications, 4);
    assert_eq!(study.values(0, 0).len(), 4);
    assert_eq!(study.values(1, 0).len(), 4);
}

#[test]
fn progress_counts_every_run() {
    let seen = Mutex::new(Vec::new());
    let stop = AtomicBool::new(false);
    let note = |progress: Progress| seen.lock().expect("a lock").push(progress.done);
    study_with(&fixture::scenario(), &options(6, 2), None, &note, &stop, &simulate).expect("a study");
    let mut seen = seen.into_inner().expect("a lock");
    seen.sort_unstable();
    assert_eq!(seen, (1..=12).collect::<Vec<_>>());
}

#[test]
fn the_stop_rule_stops_when_the_interval_is_narrow_and_not_before() {
    let until = |width| vec![Precision::relative(width)];
    // Every replication makes the same parts at the same cost.
    let narrow = study(&StudyOptions { until: until(0.02), ..options(100, 2) });
    assert_eq!(narrow.replications, 10);
    assert!(narrow.complete);
    // The interval is called by its name, and so it is in a report that is drawn again.
    let told = |study: &Study| {
        let comparison = Comparison::new(&fixture::scenario(), study);
        let text = table(&fixture::scenario(), study, &comparison, Style::default());
        (
            text.contains("(95 % CI, sequential)"),
            summary(&fixture::scenario(), study, &comparison)["sequential"].clone(),
        )
    };
    let rule = serde_json::json!({ "until": ["half-width 2%"], "reached": true });
    assert_eq!(told(&narrow), (true, rule.clone()));
    let again = StudyOptions { earlier: Some(finished(&narrow)), ..options(10, 2) };
    assert_eq!(told(&study(&again)), (true, rule));
    assert_eq!(told(&study(&options(10, 2))), (false, serde_json::Value::Null));
    // Parts that vary from 0 to 1 are never known to a millionth.
    let stop = AtomicBool::new(false);
    let noisy = |policy, replication: u32| {
        simulate(policy, replication).map(|mut log| {
            log.jobs[0].finish = if replication.is_multiple_of(3) { f64::NAN } else { 540.0 };
            if replication.is_multiple_of(3) {
                log.jobs[0].outcome = toolroom_shop::runlog::JobOutcome::InProcess;
            }
            log
        })
    };
    let wide = StudyOptions { until: until(1e-6), ..options(50, 2) };
    let wide = study_with(&fixture::scenario(), &wide, None, &|_| {}, &stop, &noisy).expect("a study");
    assert_eq!(wide.replications, 50);
    assert!(wide.sequential_text().is_some_and(|text| text.contains("not reached with 50 replications")));
}

#[test]
fn impossible_requests_are_refused() {
    let stop = AtomicBool::new(false);
    let scenario = fixture::scenario();
    let run = |options: StudyOptions| study_with(&scenario, &options, None, &|_| {}, &stop, &simulate);
    assert!(matches!(run(options(0, 1)), Err(StudyError::NoReplications)));
    assert!(matches!(run(StudyOptions { policies: vec![], ..options(1, 1) }), Err(StudyError::NoPolicies)));
    let missing = run(StudyOptions { policies: vec![0, 7], ..options(1, 1) });
    assert!(matches!(missing, Err(StudyError::UnknownPolicy { policy: 7, count: 2 })));
}

#[test]
fn a_study_goes_on_from_what_it_finished_to_the_same_result() {
    let precise = StudyOptions { until: vec![Precision::relative(0.02)], logged: 3, ..options(100, 2) };
    for whole in [StudyOptions { until: Vec::new(), ..options(37, 2) }, precise] {
        let expected = study(&whole);
        for stop in [1, 4, 7, 9] {
            let part = study(&StudyOptions { stop_after: Some(stop), ..whole.clone() });
            assert_eq!((part.replications, part.complete), (stop, false));
            let earlier = Some(finished(&part));
            let rest = study(&StudyOptions { earlier, ..whole.clone() });
            assert_eq!((rest.replications, rest.digest), (expected.replications, expected.digest), "after {stop}");
            assert!(rest.complete);
            assert_eq!(format!("{:?}", rest.values), format!("{:?}", expected.values));
            assert_eq!(format!("{:?}", rest.edge_lives), format!("{:?}", expected.edge_lives));
            assert_eq!(format!("{:?}", rest.first_logs), format!("{:?}", expected.first_logs));
        }
    }
}

#[test]
fn a_finished_part_that_is_not_repeated_is_refused() {
    let part = study(&StudyOptions { stop_after: Some(3), ..options(9, 1) });
    let earlier = Some(finished(&part));
    let another = |policy, replication: u32| simulate(policy, replication + 1);
    let going_on = StudyOptions { earlier, ..options(9, 1) };
    let stop = AtomicBool::new(false);
    let refused = study_with(&fixture::scenario(), &going_on, None, &|_| {}, &stop, &another);
    assert!(matches!(refused, Err(StudyError::NotRepeated { .. })));
}

#[test]
fn a_run_that_is_given_up_ends_the_study_after_the_replications_before_it() {
    let given_up = |policy: usize, replication: u32| match (replication, policy) {
        (3, 1) => Ok(None),
        _ => simulate(policy, replication).map(|log| Some(Run::of_log(&fixture::scenario(), log))),
    };
    let stop = AtomicBool::new(false);
    let ended = study_as_far(&fixture::scenario(), &options(9, 2), None, &|_| {}, &stop, &given_up);
    let (study, stopped) = ended.expect("a study");
    assert!(stopped.is_none() && !study.complete && study.replications == 3);
    assert_eq!(study.values(1, 0), self::study(&options(3, 1)).values(1, 0));
}

#[test]
fn a_shop_that_stops_ends_the_study_after_the_replications_before_it() {
    let failing = |policy: usize, replication: u32| match (replication, policy) {
        (3, 1) | (5, 0) => Err(ShopError::NoProgress { time: f64::from(replication), events: 1 }),
        _ => simulate(policy, replication).map(|log| Some(Run::of_log(&fixture::scenario(), log))),
    };
    let stop = AtomicBool::new(false);
    for threads in [1, 4] {
        let ended = study_as_far(&fixture::scenario(), &options(9, threads), None, &|_| {}, &stop, &failing);
        let (study, stopped) = ended.expect("a study");
        let stopped = stopped.expect("a reason");
        assert_eq!((stopped.replication, stopped.policy), (3, 1), "the first in order");
        assert!(!study.complete && study.replications == 3 && study.values(0, 0).len() == 3);
        assert_eq!(study.values(1, 0), self::study(&options(3, 1)).values(1, 0));
    }
}
