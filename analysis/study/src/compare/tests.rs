use super::*;
use crate::fixture;
use crate::study::{StudyOptions, study_with};
use std::sync::atomic::AtomicBool;
use toolroom_scenario::SpeedRule;
use toolroom_shop::runlog::RunLog;

/// A study in which the insert of policy `p` costs as many edges as `edges[p]` says, plus noise
/// common to all policies.
fn study(scenario: &Scenario, edges: &[usize], replications: u32) -> Study {
    let simulate = |policy: usize, replication: u32| {
        let mut log: RunLog = fixture::log();
        let edge = log.edges[0];
        log.edges.extend(std::iter::repeat_n(edge, edges[policy]));
        log.edges.extend(std::iter::repeat_n(edge, replication as usize % 3));
        // Edges without passes count as used when they were removed.
        for edge in &mut log.edges[3..] {
            edge.cutting_time = 0.0;
        }
        log.states[0].end += f64::from(replication % 2);
        Ok(log)
    };
    let options = StudyOptions { replications, ..StudyOptions::of(scenario) };
    study_with(scenario, &options, None, &|_| {}, &AtomicBool::new(false), &simulate).expect("a study")
}

fn scenario(speeds: &[SpeedRule]) -> Scenario {
    let mut scenario = fixture::scenario();
    let policy = scenario.policies[0].clone();
    let named = |(i, &speed): (usize, &SpeedRule)| {
        let mut policy = policy.clone();
        policy.name = format!("p{i}");
        policy.speed = speed;
        policy
    };
    scenario.policies = speeds.iter().enumerate().map(named).collect();
    scenario
}

const ADAPTIVE: SpeedRule = SpeedRule::MinimumWear;
const BEST_COST: SpeedRule = SpeedRule::BestCost;

#[test]
fn adaptive_wins_loses_or_makes_no_difference_by_the_interval() {
    let scenario = scenario(&[BEST_COST, ADAPTIVE]);
    for (edges, outcome, words) in [
        ([4, 2], Outcome::Wins, "adaptive wins as set on cost per part: p1"),
        ([2, 4], Outcome::Loses, "adaptive loses as set on cost per part: p1"),
        ([3, 3], Outcome::NoDifference, "not resolved on cost per part"),
    ] {
        let decision = Comparison::new(&scenario, &study(&scenario, &edges, 6)).decision;
        assert_eq!(decision.outcome, outcome, "{decision:?}");
        assert!(decision.line.starts_with(words), "{}", decision.line);
        assert!(decision.line.contains("best constant speed for cost"));
        assert!(decision.notes.iter().any(|note| note.contains("missing: Makarov speed, schedule")));
    }
}

#[test]
fn adaptive_is_measured_against_the_best_rival_not_the_baseline() {
    let given = SpeedRule::Constant { cutting_speed: 0.5 };
    let scenario = scenario(&[given, BEST_COST, ADAPTIVE]);
    let comparison = Comparison::new(&scenario, &study(&scenario, &[9, 2, 4], 6));
    assert_eq!((comparison.decision.outcome, comparison.decision.rival), (Outcome::Loses, Some(1)));
    // It is still cheaper than the baseline, and the headline shows that difference.
    let cost = study(&scenario, &[9, 2, 4], 6).index("cost_per_part").expect("a figure");
    let headline = comparison.headline.expect("a difference");
    assert_eq!(comparison.differences[headline].policy, 2);
    assert!(comparison.differences[headline].kpis[cost].difference.mean < 0.0);
}

#[test]
fn an_oracle_neither_wins_nor_is_a_rival() {
    let scenario = scenario(&[BEST_COST, ADAPTIVE, SpeedRule::Oracle]);
    let decision = Comparison::new(&scenario, &study(&scenario, &[4, 3, 0], 6)).decision;
    assert_eq!((decision.outcome, decision.adaptive, decision.rival), (Outcome::Wins, Some(1), Some(0)));
}

#[test]
fn every_adaptive_policy_that_loses_is_named() {
    let scenario = scenario(&[BEST_COST, ADAPTIVE, SpeedRule::SetIncrement { path_per_edge: 900.0 }]);
    let decision = Comparison::new(&scenario, &study(&scenario, &[4, 3, 8], 6)).decision;
    assert_eq!(decision.outcome, Outcome::Wins);
    assert!(decision.notes.iter().any(|note| note.starts_with("p2 loses to p0")), "{:?}", decision.notes);
}

#[test]
fn one_replication_or_no_adaptive_policy_decides_nothing() {
    let both = scenario(&[BEST_COST, ADAPTIVE]);
    assert_eq!(Comparison::new(&both, &study(&both, &[4, 2], 1)).decision.outcome, Outcome::Undecided);
    let constant = scenario(&[BEST_COST, BEST_COST]);
    let comparison = Comparison::new(&constant, &study(&constant, &[4, 2], 6));
    assert_eq!(comparison.decision.outcome, Outcome::Undecided);
    assert_eq!(comparison.headline, Some(0));
    let line = &comparison.decision.line;
    assert!(line.contains("Best on cost per part: p1") && line.contains("against p0"), "{line}");
    let alone = scenario(&[ADAPTIVE]);
    let comparison = Comparison::new(&alone, &study(&alone, &[4], 6));
    assert!(comparison.headline.is_none() && comparison.decision.line.contains("nothing to compare"));
}

#[test]
fn gains_of_equal_policies_are_one() {
    let scenario = scenario(&[BEST_COST, ADAPTIVE]);
    let comparison = Comparison::new(&scenario, &study(&scenario, &[2, 2], 6));
    let difference = &comparison.differences[0];
    assert_eq!((difference.cell_gain.mean, difference.shop_gain.mean), (1.0, 1.0));
    assert_eq!(difference.cell_gain.half_width, 0.0);
}

#[test]
fn the_bottleneck_is_the_station_that_is_occupied_longest() {
    let scenario = fixture::scenario();
    let comparison = Comparison::new(&scenario, &study(&scenario, &[0, 0], 2));
    let bottleneck = comparison.bottleneck().expect("a station");
    assert_eq!((bottleneck.name.as_str(), bottleneck.in_cell), ("L1 + L2", true));
    // L1 works 690 s, 510 s of them in cut or tool change; L2 is idle.
    assert!((bottleneck.load - 0.5 * 690.0 / 3600.0).abs() < 1e-3);
    assert!((bottleneck.cell_share - 510.0 / 690.0).abs() < 1e-3);
}
