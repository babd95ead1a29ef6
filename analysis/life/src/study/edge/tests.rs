use super::super::points::Points;
use super::super::policy::{Ramp, Reading, Rule};
use super::super::{Passes, cell};
use super::*;
use toolroom_scenario::{Knowledge, SensorSheet, SpeedRule};

/// A study of the default pair from 30 m/min with chipping.
fn study(scatter: Scatter, rule: impl Into<Rule>, reading: Reading, lagged: bool) -> Study {
    let mut pair = Pair::default();
    let cut = pair.reference_cut().at_speed(0.5);
    pair.chipping = pair.chipping.for_share(&pair, &cut, 0.3).unwrap();
    let passes = Passes { path: 37.7, pause: if lagged { 18.0 } else { 0.0 } };
    let cells =
        vec![cell(("", cut), ("", rule.into(), reading), &pair, &scatter, SensorSheet::default(), (passes, lagged))];
    Study { seed: 11, lives: 1000, ..Study::plain(pair, scatter, cells, (passes, lagged)) }
}

/// The lives of the first edges with every step and panel cut into `parts`.
fn lives(study: &Study, edges: u64, parts: u32) -> Vec<Outcome> {
    let points = Points::new(study.sampling, study.seed, study.lives);
    let mut point = vec![0.0; study.dimensions()];
    let cell = &study.cells[0];
    (0..edges)
        .map(|index| {
            points.at(index, &mut point);
            let draws = &mut Draws::of(study.seed, index);
            live_in_parts(study, &study.pair, &cell.cut, &cell.speed, &point, draws, parts)
        })
        .collect()
}

/// Greatest relative difference of the lives of two runs; every edge ends in the same way.
fn difference(rows: &[Outcome], others: &[Outcome]) -> f64 {
    let pairs = rows.iter().zip(others).map(|(row, other)| {
        assert_eq!(row.end, other.end);
        (row.life / other.life - 1.0).abs().max((row.path / other.path - 1.0).abs())
    });
    pairs.fold(0.0, f64::max)
}

#[test]
fn every_life_is_within_1e_4_of_the_exact_one_for_its_noise() {
    let shop = Scatter::shop();
    let even = Scatter { allowance: 0.0, piece_hardness: 0.0, ..shop };
    let mut faults = Vec::new();
    let smooth = Scatter { life_noise: 0.0, ..even };
    let edge_known = Rule { knows: Knowledge::Edge, ..SpeedRule::Oracle.into() };
    let literal = Rule { knows: Knowledge::Edge, ..SpeedRule::MinimumWearLiteral.into() };
    for (name, study) in [
        ("steady", study(even, SpeedRule::Programmed, Reading::Pass, false)),
        ("steady without noise", study(smooth, SpeedRule::Programmed, Reading::Pass, false)),
        ("passes", study(shop, SpeedRule::Programmed, Reading::Pass, false)),
        ("fast passes", study(shop, SpeedRule::Makarov { at_flank_wear: 0.1e-3 }, Reading::Pass, false)),
        ("lagged body", study(shop, SpeedRule::Programmed, Reading::Pass, true)),
        ("one reading a pass", study(shop, SpeedRule::MinimumWear, Reading::Pass, false)),
        ("readings every 6 s", study(shop, SpeedRule::MinimumWear, Reading::Period, false)),
        ("schedule", study(shop, SpeedRule::Schedule, Reading::Pass, false)),
        ("price of a metre", study(shop, SpeedRule::Productivity { price: Some(1.3) }, Reading::Period, false)),
        ("oracle of wear", study(shop, SpeedRule::Oracle, Reading::Pass, false)),
        ("oracle of the edge", study(shop, edge_known, Reading::Pass, false)),
        ("literal rule of the edge", study(shop, literal, Reading::Pass, false)),
        ("readings every 6 s, lagged body", study(shop, SpeedRule::MinimumWear, Reading::Period, true)),
    ] {
        let (exact, check) = (lives(&study, 150, 32), lives(&study, 150, 16));
        let chipped = exact.iter().filter(|row| row.end == End::Chipping).count();
        assert!((10..140).contains(&chipped), "{name}: {chipped} of 150 chip");
        let error = difference(&lives(&study, 150, 1), &exact);
        // The reference: its own error is well below its distance from half as many parts.
        let doubt = difference(&check, &exact);
        if error >= 1e-4 || doubt >= 5e-6 {
            faults.push(format!("{name}: {error:.1e}, the reference within {doubt:.1e}"));
        }
    }
    assert!(faults.is_empty(), "{faults:?}");
}

#[test]
fn a_life_by_set_increment_is_within_2e_4_of_the_exact_one_for_its_noise() {
    // The rule turns the estimate of every pass into a demand on the next one, and so hands on what the estimate is off by.
    let increment = SpeedRule::SetIncrement { path_per_edge: 800.0 };
    let study = study(Scatter::shop(), increment, Reading::Period, false);
    let (exact, check) = (lives(&study, 150, 32), lives(&study, 150, 16));
    let (error, doubt) = (difference(&lives(&study, 150, 1), &exact), difference(&check, &exact));
    assert!(error < 2e-4 && doubt < 1e-5, "{error:.1e}, the reference within {doubt:.1e}");
}

#[test]
fn an_edge_that_is_lost_or_spent_at_the_start_has_no_life() {
    let calm = Scatter { initial_wear_scatter: 0.0, life_noise: 0.0, ..Scatter::shop() };
    let first = |study: &Study| lives(study, 1, 1)[0];
    for scatter in [calm, Scatter { allowance: 0.0, piece_hardness: 0.0, ..calm }] {
        // Too hot from the first moment on, in passes and as a steady life.
        let mut hot = study(scatter, SpeedRule::Programmed, Reading::Pass, false);
        hot.pair.temperature.collapse_temperature = 400.0;
        assert_eq!((first(&hot).life, first(&hot).end), (0.0, End::Collapse));
        // Mounted worn out.
        let worn = study(Scatter { initial_wear: 0.7e-3, ..scatter }, SpeedRule::Programmed, Reading::Pass, false);
        let end = first(&worn);
        assert_eq!((end.life, end.end, end.passages), (0.0, End::WearLimit, [0.0; LEVELS]));
        assert!(end.flank_wear >= worn.pair.limits.wear_limit);
    }
}

#[test]
fn a_ramp_down_that_begins_too_hot_is_lost_at_its_start() {
    let study = study(Scatter::none(), SpeedRule::Programmed, Reading::Pass, false);
    let (pair, cell) = (&study.pair, &study.cells[0]);
    let mut draws = Draws::of(study.seed, 0);
    let edge = Edge::of(&study, &cell.cut, &[0.5; COORDINATES.len()], &mut draws.wear);
    let cold = pair.contact(&cell.cut).steady_temperature(0.0);
    let mut hot = pair.clone();
    let fast = pair.contact(&cell.cut.at_speed(2.0 * cell.cut.cutting_speed));
    hot.temperature.collapse_temperature = 0.5 * (cold + fast.steady_temperature(0.0));
    let ramp = Ramp { start: 2.0 * cell.cut.cutting_speed, end: 0.2 * cell.cut.cutting_speed };
    let contact = hot.contact(&cell.cut.at_speed(ramp.start));
    let mut pilot = cell.speed.pilot(&hot, cell.cut);
    // A pass so short that its first step reaches the cool end.
    let outcome =
        Machining::new(&study, &hot, &edge, &cell.speed, &mut draws, 1).pass(&contact, &ramp, 1e-3, &mut pilot);
    assert_eq!(outcome.map(|outcome| (outcome.life, outcome.end)), Some((0.0, End::Collapse)));
}
