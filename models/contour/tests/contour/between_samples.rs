//! Plans keep their limits between samples: the rim is sampled every 20 um of the path, apart from the planner's bound.

use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};
use toolroom_contour::{
    Along, Contour, ContourFile, CutterSide, EngagementModel, Milling, Models, Objective, Parameters, Pass, PathError,
    Plan, Planner, Point, Section, Trace,
};

const MC1: &str = include_str!("../../../../scenarios/contour/mc1.toml");

/// Distance of a point from a section, by a dense polyline: slow, and nothing of the planner's.
fn distance(section: &Section, point: Point) -> f64 {
    const PARTS: u32 = 100;
    let parts = if section.curvature == 0.0 { 1 } else { PARTS };
    let at = |i: u32| section.at(section.length * f64::from(i) / f64::from(parts));
    (0..parts)
        .map(|i| {
            let (a, b) = (at(i), at(i + 1));
            let (dx, dy) = (b.x - a.x, b.y - a.y);
            let share = ((point.x - a.x) * dx + (point.y - a.y) * dy) / (dx * dx + dy * dy);
            Point { x: a.x + share.clamp(0.0, 1.0) * dx, y: a.y + share.clamp(0.0, 1.0) * dy }.distance(point)
        })
        .fold(f64::INFINITY, f64::min)
}

/// Engagement angle at a place of the drawn contour, rad, by counting points of the rim.
fn sampled(contour: &Contour, radius: f64, allowance: f64, backwards: bool, section: usize, way: f64) -> f64 {
    const RIM: u32 = 360;
    let shape = &contour.sections[section];
    let heading = shape.heading + shape.curvature * way;
    let centre = shape.at(way).ahead(heading + contour.side.sign() * FRAC_PI_2, radius);
    let ahead = if backwards { heading + PI } else { heading };
    let near: Vec<&Section> =
        contour.sections.iter().filter(|other| distance(other, centre) < radius + allowance).collect();
    let inside = (0..RIM).filter(|i| {
        let point = centre.ahead(ahead - FRAC_PI_2 + PI * (f64::from(*i) + 0.5) / f64::from(RIM), radius);
        near.iter().any(|other| distance(other, point) < allowance)
    });
    PI * inside.count() as f64 / f64::from(RIM)
}

/// The greatest ratio of what a plan does to a limit, where the rim really is at every `step` of the wall, m.
fn worst(contour: &Contour, parameters: &Parameters, pass: &Pass, models: &Models, plan: &Plan, step: f64) -> f64 {
    let planner = Planner::new(contour, parameters, pass, models).expect("a planner");
    let radius = parameters.cutter.radius();
    let due = if models.milling == Milling::Down { CutterSide::Left } else { CutterSide::Right };
    let along = Along::new(contour, radius, pass.allowance, contour.side != due);
    let mut worst: f64 = 0.0;
    for (piece, planned) in planner.pieces().iter().zip(&plan.sections) {
        let samples = ((piece.to - piece.from) / step).ceil().clamp(1.0, 2000.0) as u32;
        for i in 0..=samples {
            let way = piece.from + (piece.to - piece.from) * f64::from(i) / f64::from(samples);
            let angle = along.at(piece.section, way).angle;
            // A contour whose every allowance engages so: the limits at this very place.
            let allowance = radius * (1.0 - angle.cos());
            let mut straight = Trace::new(Point::default(), 0.0);
            straight.line(0.01).expect("a line");
            let straight = straight.finish(contour.side, false).expect("a contour");
            let local = Pass { allowance, ..*pass };
            let section = Models { engagement: EngagementModel::Section, ..*models };
            let here = Planner::new(&straight, parameters, &local, &section).expect("a planner");
            let evaluation = here.evaluate(0, planned.setting).expect("a section");
            use toolroom_contour::Constraint::{BodyStrength, ChipSpace, FeedForce, Power, ToolLife, ToothStrength};
            for limit in [Power, FeedForce, ToothStrength, BodyStrength, ChipSpace, ToolLife] {
                worst = worst.max(evaluation.ratios.of(limit));
            }
        }
    }
    worst
}

#[test]
fn the_rough_plan_of_the_shipped_plate_keeps_its_limits_before_hollow_walls() {
    let file = ContourFile::parse("mc1.toml", MC1, &[]).expect("a contour file").content;
    let (pass, models) = (file.pass("rough").expect("a pass"), file.models);
    assert_eq!(models.engagement, EngagementModel::Path);
    let planner = Planner::new(&file.contour, &file.parameters, pass, &models).expect("a planner");
    let plan = planner.optimal(Objective::Time).expect("a plan");
    let kept = worst(&file.contour, &file.parameters, pass, &models, &plan, 20e-6);
    assert!(kept <= 1.001, "{kept}");
    // One engagement a section breaks them by more than two, for next to no time.
    let section = Models { engagement: EngagementModel::Section, ..models };
    let naive = Planner::new(&file.contour, &file.parameters, pass, &section).expect("a planner");
    let blind = naive.optimal(Objective::Time).expect("a plan");
    let broken = worst(&file.contour, &file.parameters, pass, &section, &blind, 100e-6);
    assert!(broken > 2.0, "{broken}");
    assert!(plan.time < 1.05 * blind.time, "{} {}", plan.time, blind.time);
    let program = planner.part_program(&plan, "mc1").expect("a part program");
    assert!(program.lines().count() > naive.part_program(&blind, "mc1").expect("a part program").lines().count());
}

#[test]
fn the_bound_of_every_piece_is_that_of_the_rim_counted_point_by_point() {
    let file = ContourFile::parse("mc1.toml", MC1, &[]).expect("a contour file").content;
    let pass = file.pass("rough").expect("a pass");
    let radius = file.parameters.cutter.radius();
    let backwards = file.contour.side != CutterSide::Left;
    let along = Along::new(&file.contour, radius, pass.allowance, backwards);
    for piece in along.pieces() {
        for share in [0.01, 0.5, 0.99] {
            let way = piece.from + share * (piece.to - piece.from);
            let counted = sampled(&file.contour, radius, pass.allowance, backwards, piece.section, way);
            assert!(counted <= piece.engagement.angle + 2.5 * PI / 360.0, "{counted} {piece:?}");
            // At a sharp corner ahead the stock ends, which the model does not know.
            assert!(along.at(piece.section, way).angle > counted - 2.5 * PI / 360.0, "{counted} {piece:?}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn plans_of_random_contours_keep_their_limits(
        walls in proptest::collection::vec((prop::bool::ANY, 0.02..0.06f64, 0.2..1.3f64, 0.01..0.04f64), 1..4),
        allowance in 0.0005..0.003f64,
        up in prop::bool::ANY,
    ) {
        let parameters = Parameters::default();
        let mut trace = Trace::new(Point::default(), 0.0);
        trace.line(0.04).expect("a line");
        for (left, radius, angle, line) in walls {
            trace.arc(radius, if left { angle } else { -angle }).expect("an arc");
            trace.line(line).expect("a line");
        }
        let contour = trace.finish(CutterSide::Left, false).expect("a contour");
        let pass = Pass { allowance, ..Pass::rough() };
        let milling = if up { Milling::Up } else { Milling::Down };
        let models = Models { milling, path_error: PathError::Off, engagement: EngagementModel::Path, ..Models::default() };
        let planner = Planner::new(&contour, &parameters, &pass, &models).expect("a planner");
        let Ok(plan) = planner.optimal(Objective::Time) else { return Ok(()) };
        let kept = worst(&contour, &parameters, &pass, &models, &plan, 200e-6);
        prop_assert!(kept <= 1.001, "{kept}");
        // Pieces of one engagement cost little against pieces that are much finer.
        let section = Models { engagement: EngagementModel::Section, ..models };
        let blind = Planner::new(&contour, &parameters, &pass, &section).expect("a planner").optimal(Objective::Time);
        prop_assert!(blind.is_err() || blind.is_ok_and(|blind| blind.time <= plan.time * (1.0 + 1e-9)));
    }
}
