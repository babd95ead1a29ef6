//! The gate of plans on random contours: no limit broken between samples, as fast as the finely sampled problem allows, and no
//! gouge. Small here; the whole gate, a minute, by a command:
//!
//! ```sh
//! GATE_CONTOURS=200 GATE_STEP_UM=20 cargo test -p toolroom-contour --test contour gate -- --nocapture
//! ```

use std::f64::consts::TAU;
use std::io::Write;
use toolroom_contour::{
    Along, Contour, ContourError, CornerPolicy, CutterSide, EngagementModel, FormError, Milling, Models, Objective,
    Parameters, Pass, PathError, Piece, Plan, Planner, Point, Trace, Track,
};
use toolroom_program::{Control, EventKind, Run};

/// Numbers of a seed, evenly spread (splitmix64).
struct Draw(u64);

impl Draw {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    fn one_of<T: Copy>(&mut self, list: &[T]) -> T {
        list[((self.next() * list.len() as f64) as usize).min(list.len() - 1)]
    }
}

/// Walls straight, hollow and round that follow each other in tangents, with a sharp outside corner now and then.
fn contour(draw: &mut Draw, radius: f64) -> Contour {
    let side = draw.one_of(&[CutterSide::Left, CutterSide::Right]);
    let mut trace = Trace::new(Point::default(), draw.within(0.0, TAU));
    trace.line(draw.within(0.02, 0.06)).expect("a line");
    for _ in 0..draw.one_of(&[1, 2, 3, 4]) {
        let hollow = draw.next() < 0.6;
        // Hollow walls turn towards the cutter.
        let sign = if (side == CutterSide::Left) == hollow { 1.0 } else { -1.0 };
        let arc = if hollow { draw.within(1.05, 3.0) * radius } else { draw.within(0.2, 3.0) * radius };
        trace.arc(arc, sign * draw.within(0.2, 1.6)).expect("an arc");
        if draw.next() < 0.7 {
            trace.line(draw.within(0.005, 0.05)).expect("a line");
        }
        if draw.next() < 0.2 {
            trace.turn(if side == CutterSide::Left { -1.0 } else { 1.0 } * draw.within(0.3, 1.5));
            trace.line(draw.within(0.01, 0.04)).expect("a line");
        }
    }
    trace.finish(side, false).expect("a contour")
}

/// Every section in steps of at most `step`, m, each with the engagement in its middle.
fn fine(contour: &Contour, parameters: &Parameters, pass: &Pass, models: &Models, step: f64) -> Vec<Piece> {
    let due = if models.milling == Milling::Down { CutterSide::Left } else { CutterSide::Right };
    let along = Along::new(contour, parameters.cutter.radius(), pass.allowance, contour.side != due);
    let mut pieces = Vec::new();
    for (section, shape) in contour.sections.iter().enumerate() {
        let steps = (shape.length / step).ceil().max(1.0) as u32;
        let at = |i: u32| if i == steps { shape.length } else { shape.length * f64::from(i) / f64::from(steps) };
        pieces.extend((0..steps).map(|i| {
            let (from, to) = (at(i), at(i + 1));
            let engagement = along.at(section, 0.5 * (from + to));
            Piece { section, from, to, engagement, least: engagement.angle }
        }));
    }
    pieces
}

/// Greatest ratio to a limit at the samples, and the samples' optimum.
fn sampled(planner: &Planner<'_>, plan: &Plan, fine: &Planner<'_>) -> (f64, f64) {
    let mut worst: f64 = 0.0;
    let mut coarse = planner.pieces().iter().zip(&plan.sections).peekable();
    for (i, piece) in fine.pieces().iter().enumerate() {
        let middle = 0.5 * (piece.from + piece.to);
        while coarse.peek().is_some_and(|(own, _)| own.section < piece.section || own.to < middle) {
            coarse.next();
        }
        let (own, planned) = coarse.peek().expect("pieces cover the contour");
        assert!(own.section == piece.section && own.from <= middle);
        let evaluation = fine.evaluate(i, planned.setting).expect("a section");
        worst = worst.max(evaluation.ratios.tightest().1);
    }
    let optimum = fine.optimal(Objective::Time).expect("a plan of the samples");
    (worst, optimum.time)
}

/// How deep the cutter of a program cuts into the wall, m, sampled along its path below the surface.
fn gouge(contour: &Contour, radius: f64, program: &str, step: f64) -> f64 {
    let tracks: Vec<Track> = contour.sections.iter().copied().map(Track::new).collect();
    let mut deepest: f64 = 0.0;
    for event in Run::new(program, &Control::default()).expect("a program") {
        let EventKind::Motion(motion) = event.expect("a program that runs").kind else { continue };
        if motion.rapid || motion.unknown || motion.end[2] >= 0.0 {
            continue;
        }
        let samples = (1e-3 * motion.length / step).ceil().max(1.0) as u32;
        for i in 0..=samples {
            let place = motion.position(f64::from(i) / f64::from(samples));
            let centre = Point { x: 1e-3 * place[0], y: 1e-3 * place[1] };
            for track in tracks.iter().filter(|track| track.reaches(centre, radius)) {
                deepest = deepest.max(radius - track.distance(centre));
            }
        }
    }
    deepest
}

#[test]
fn plans_of_random_contours_pass_the_gate() {
    let number = |name: &str, otherwise: f64| {
        std::env::var(name).ok().map_or(otherwise, |text| text.parse().expect("a number in the environment"))
    };
    let (contours, step) = (number("GATE_CONTOURS", 6.0) as u64, 1e-6 * number("GATE_STEP_UM", 200.0));
    let parameters = Parameters::default();
    let radius = parameters.cutter.radius();
    let (mut ratio, mut loss, mut depth) = (0.0_f64, 0.0_f64, 0.0_f64);
    let (mut planned, mut narrow, mut empty) = (0, 0, 0);
    let mut seed = 0;
    while planned < contours {
        seed += 1;
        let mut draw = Draw(seed);
        let contour = contour(&mut draw, radius);
        let rough = draw.next() < 0.5;
        let pass = if rough { Pass::rough() } else { Pass::default() };
        let pass = Pass { allowance: pass.allowance * draw.within(0.3, 1.2), ..pass };
        let models = Models {
            milling: draw.one_of(&[Milling::Down, Milling::Up]),
            path_error: PathError::default(),
            form_error: FormError::Mean,
            corners: CornerPolicy::SlowDown { tolerance: None },
            engagement: EngagementModel::Path,
        };
        if contour.clears(radius, pass.gouge()).is_err() {
            narrow += 1;
            continue;
        }
        let planner = Planner::new(&contour, &parameters, &pass, &models).expect("a planner");
        let plan = match planner.optimal(Objective::Time) {
            Ok(plan) => plan,
            // Where nothing is admissible at the bound, it is so at the samples, too.
            Err(ContourError::EmptyFeasibleSet { .. }) => {
                empty += 1;
                continue;
            }
            Err(error) => panic!("seed {seed}: {error}"),
        };
        planned += 1;
        let pieces = fine(&contour, &parameters, &pass, &models, step);
        let samples = Planner::over(&contour, pieces, &parameters, &pass, &models).expect("a planner");
        let (worst, optimum) = sampled(&planner, &plan, &samples);
        assert!(worst <= 1.001, "seed {seed}: a limit is broken {worst} times");
        assert!(plan.time <= 1.02 * optimum, "seed {seed}: {} s, {optimum} s with fine samples", plan.time);
        let program = planner.part_program(&plan, "gate").expect("a program");
        let deepest = gouge(&contour, radius, &program, step);
        assert!(deepest <= pass.gouge() + 1e-7, "seed {seed}: {:.4} mm into the wall", 1e3 * deepest);
        (ratio, loss, depth) = (ratio.max(worst), loss.max(plan.time / optimum - 1.0), depth.max(deepest));
    }
    if std::env::var("GATE_CONTOURS").is_ok() {
        let told = format!(
            "{planned} contours at {:.0} um: limits used up to {ratio:.5}, {:.3} % slower than the samples at most, {:.2} um into \
             the wall; {narrow} too narrow, {empty} without a plan\n",
            1e6 * step,
            100.0 * loss,
            1e6 * depth
        );
        std::io::stderr().write_all(told.as_bytes()).expect("somebody reads it");
    }
}

#[test]
fn a_path_into_the_wall_is_seen_by_the_gate() {
    // The gate's own eye: a straight wall, and a path that runs 0.1 mm too near.
    let mut trace = Trace::new(Point::default(), 0.0);
    trace.line(0.05).expect("a line");
    let wall = trace.finish(CutterSide::Left, false).expect("a contour");
    let program = "G21 G90\nG0 X0 Y20 Z5\nG1 Z-1 F500\nY15.9\nX50\nG0 Z5";
    assert!((gouge(&wall, 0.016, program, 1e-4) - 1e-4).abs() < 1e-9);
}
