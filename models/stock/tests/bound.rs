//! The bound of the engagement between samples, against a rim that is counted point by point.
//!
//! What is in material is decided anew here, from distances to the motions before and nothing of the crate under test: a point of the rim
//! is in material at the end of the cutter where it lies in the outline and no motion before came nearer than the radius at a height
//! that is no greater.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use toolroom_program::{Control, EventKind, Motion, Path, Run};
use toolroom_stock::{Follower, Setup};

/// Angle between the points of the rim, rad: 0.01 deg.
const FINE: f64 = PI / 18_000.0;
/// Points of the rim between those that are looked at first.
const COARSE: usize = 20;
/// Step along the path, mm: what is looked at lies on this grid.
const STEP: f64 = 1e-3;
/// Distance, mm, that is none: the reader rounds nothing, and places are of some ten millimetres.
const ROUNDING: f64 = 1e-9;
const WIDTH: f64 = 60.0;
const HEIGHT: f64 = 40.0;

/// Numbers of one seed, by the multiplier of Knuth (MMIX).
struct Random(u64);

impl Random {
    /// Between two numbers.
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// A place as it is written, with three decimals: the arc that begins there begins on its circle.
fn written(value: f64) -> f64 {
    (value * 1e3).round() / 1e3
}

/// A program of levels, straight walls, arcs, plunges and ramps in a block of 60 x 40 mm.
fn program(random: &mut Random) -> String {
    let mut text = "G21 G90 G0 X-20 Y-20 Z5\nT1 M6\nS3000 M3\n".to_owned();
    let (mut x, mut y, mut z) = (-20.0, -20.0, 5.0);
    for _ in 0..4 + random.between(0.0, 7.0) as u32 {
        let kind = random.between(0.0, 10.0);
        let (to_x, to_y) = (random.between(-8.0, WIDTH + 8.0), random.between(-8.0, HEIGHT + 8.0));
        let (to_x, to_y) = (written(to_x), written(to_y));
        if z > 0.0 || kind < 1.0 {
            // Up, over, and down in material or beside it.
            z = -random.between(0.5, 8.0);
            text += &format!("G0 Z5\nX{to_x:.3} Y{to_y:.3}\nG1 Z{z:.3} F300\n");
            (x, y) = (to_x, to_y);
        } else if kind < 3.0 {
            // A wall along an axis, a small step beside the last.
            let aside = random.between(0.05, 3.0);
            y = written((y + aside).min(HEIGHT + 6.0));
            text += &format!("G1 Y{y:.3} F700\nX{to_x:.3}\n");
            x = to_x;
        } else if kind < 6.0 {
            // An arc about a centre near by. The stock follows its circle, whereas a place on it is one of a spiral to the end that was
            // written: with nine decimals they are one.
            let (reach, from) = (random.between(0.5, 15.0), random.between(0.0, TAU));
            let (turn, left) = (random.between(0.2, TAU), random.between(0.0, 1.0) < 0.5);
            let centre = [x - reach * from.cos(), y - reach * from.sin()];
            let to = if left { from + turn } else { from - turn };
            (x, y) = (centre[0] + reach * to.cos(), centre[1] + reach * to.sin());
            let [i, j] = [-reach * from.cos(), -reach * from.sin()];
            text += &format!("{} X{x:.9} Y{y:.9} I{i:.9} J{j:.9} F700\n", if left { "G3" } else { "G2" });
        } else if kind < 7.0 {
            z -= random.between(0.1, 2.0);
            text += &format!("G1 Z{z:.3} F200\n");
        } else if kind < 8.0 {
            z = (z - random.between(-1.0, 2.0)).min(-0.2);
            text += &format!("G1 X{to_x:.3} Y{to_y:.3} Z{z:.3} F500\n");
            (x, y) = (to_x, to_y);
        } else {
            text += &format!("G1 X{to_x:.3} Y{to_y:.3} F700\n");
            (x, y) = (to_x, to_y);
        }
    }
    text + "M30\n"
}

/// How deep in material a point lies at a height, mm, seen along Z: its distance from what one motion, as far as a share of it, has
/// cleared there. Negative where it has cleared the point.
fn left_by(motion: &Motion, upto: f64, radius: f64, point: [f64; 2], height: f64) -> f64 {
    let place = |share: f64| motion.position(share);
    let away = |share: f64| {
        let at = place(share);
        (at[0] - point[0]).hypot(at[1] - point[1]) - radius
    };
    let low = |share: f64| place(share)[2] <= height + ROUNDING;
    match motion.path {
        Path::Arc(arc) => {
            // Flat arcs only: the whole of it is as low as its start.
            if !low(0.0) {
                return f64::INFINITY;
            }
            let [x, y] = [point[0] - arc.centre[0], point[1] - arc.centre[1]];
            let begin = (motion.start[1] - arc.centre[1]).atan2(motion.start[0] - arc.centre[0]);
            let turn = if arc.left { y.atan2(x) - begin } else { begin - y.atan2(x) };
            if turn.rem_euclid(TAU) <= upto * arc.angle {
                (x.hypot(y) - arc.radius).abs() - radius
            } else {
                away(0.0).min(away(upto))
            }
        }
        Path::Line => {
            // The part of the way that is low enough, then the nearest point of it.
            let fall = motion.end[2] - motion.start[2];
            let (mut from, mut to) = (0.0, upto);
            if fall != 0.0 {
                let at = ((height + ROUNDING - motion.start[2]) / fall).clamp(0.0, upto);
                if fall < 0.0 { from = at } else { to = at }
            }
            if !low(from) && !low(to) {
                return f64::INFINITY;
            }
            let way = [motion.end[0] - motion.start[0], motion.end[1] - motion.start[1]];
            let square = way[0] * way[0] + way[1] * way[1];
            let along = [point[0] - motion.start[0], point[1] - motion.start[1]];
            let nearest = if square > 0.0 { (along[0] * way[0] + along[1] * way[1]) / square } else { 0.0 };
            away(nearest.clamp(from, to))
        }
    }
}

/// The angle of the front half of a rim that is in material at the end of the cutter, rad, from points 0.01 deg apart, and the number of its
/// parts, each of which may be counted as one point more than it is long.
fn counted(before: &[Motion], motion: &Motion, share: f64, radius: f64) -> (f64, u32) {
    let at = motion.position(share);
    let heading = match motion.path {
        Path::Line => (motion.end[1] - motion.start[1]).atan2(motion.end[0] - motion.start[0]),
        Path::Arc(arc) => {
            let across = (at[1] - arc.centre[1]).atan2(at[0] - arc.centre[0]);
            if arc.left { across + FRAC_PI_2 } else { across - FRAC_PI_2 }
        }
    };
    let near = |other: &&Motion| {
        let [a, b] = [other.start, other.end];
        let reach = 2.0 * radius + other.length;
        (a[0] - at[0]).hypot(a[1] - at[1]).min((b[0] - at[0]).hypot(b[1] - at[1])) <= reach
    };
    let around: Vec<&Motion> = before.iter().filter(near).collect();
    let rim = |index: f64| {
        let angle = heading - FRAC_PI_2 + (index + 0.5) * FINE;
        [at[0] + radius * angle.cos(), at[1] + radius * angle.sin()]
    };
    let deep = |index: f64| {
        let point = rim(index);
        let outline = point[0].min(WIDTH - point[0]).min(point[1]).min(HEIGHT - point[1]);
        let swaths = around.iter().map(|other| left_by(other, 1.0, radius, point, at[2]));
        swaths.fold(outline, f64::min)
    };
    // The way of an arc itself has cleared what it comes back to. The place at hand is as far from each point of its rim as the rim.
    let turns = matches!(motion.path, Path::Arc(_));
    let passed = share - STEP / motion.length;
    let own = |index: f64| turns && passed > 0.0 && left_by(motion, passed, radius, rim(index), at[2]) < -ROUNDING;
    let count = (PI / FINE).round() as usize;
    // A distance changes by no more than the way along the rim, so that points nearer than this are alike.
    let reach = (0.5 * COARSE as f64 + 0.5) * FINE * radius;
    let (mut inside, mut parts, mut previous) = (0, 0, false);
    let mut take = |is_inside: bool| {
        inside += u32::from(is_inside);
        parts += u32::from(is_inside && !previous);
        previous = is_inside;
    };
    for first in (0..count).step_by(COARSE) {
        let depth = deep(first as f64 + 0.5 * (COARSE as f64 - 1.0));
        for index in (first..first + COARSE).map(|index| index as f64) {
            take(match (depth < -reach, depth > reach) {
                (true, _) => false,
                (false, true) => !own(index),
                (false, false) => deep(index) > ROUNDING && !own(index),
            });
        }
    }
    (f64::from(inside) * FINE, parts)
}

/// The greatest excess of the counted angle over the bound for each part of the rim, deg, with the places looked at.
fn tried(programs: std::ops::Range<u64>, looks: u32) -> (f64, u64) {
    let (mut worst, mut places) = (f64::NEG_INFINITY, 0);
    for seed in programs {
        let mut random = Random(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(1));
        for _ in 0..4 {
            random.between(0.0, 1.0);
        }
        let radius = random.between(1.5, 8.0);
        let text = program(&mut random);
        let setup = format!(
            "schema = 1\n[stock]\nbox = [[\"0 mm\", \"0 mm\", \"-40 mm\"], [\"{WIDTH} mm\", \"{HEIGHT} mm\", \"0 mm\"]]\n\
             [[tool]]\nnumber = 1\ndiameter = \"{} mm\"\nteeth = 4\n",
            2.0 * radius
        );
        let setup = Setup::parse("setup.toml", &setup, &[]).expect("a setup").content;
        // The diameter as it was read.
        let radius = 1e3 * setup.tools[&1].radius;
        let mut follower = Follower::new(&setup);
        let mut before: Vec<Motion> = Vec::new();
        for event in Run::new(&text, &Control::default()).unwrap_or_else(|error| panic!("{error}\n{text}")) {
            let event = event.unwrap_or_else(|error| panic!("{error}\n{text}"));
            match event.kind {
                EventKind::ToolChange(tool) => follower.change(tool),
                EventKind::Spindle { speed, sense } => follower.spindle(speed, sense),
                EventKind::Motion(motion) => {
                    let mut stretches = Vec::new();
                    let mut trace = |from: f64, to: f64, bound: f64, _| stretches.push((from, to, bound));
                    follower.motion_traced(&motion, &mut trace).expect("a tool");
                    let flat = motion.start[0] != motion.end[0]
                        || motion.start[1] != motion.end[1]
                        || matches!(motion.path, Path::Arc(_));
                    for (from, to, bound) in stretches.into_iter().filter(|_| flat && !motion.rapid) {
                        for _ in 0..looks {
                            let way = random.between(from, to) * motion.length;
                            let share = ((way / STEP).round() * STEP / motion.length).clamp(from, to);
                            let (angle, parts) = counted(&before, &motion, share, radius);
                            let excess = (angle - bound).to_degrees() / f64::from(parts.max(1));
                            assert!(
                                excess <= 0.011,
                                "seed {seed}, line {}, share {share}: {} deg counted, {} deg bound\n{text}",
                                event.line,
                                angle.to_degrees(),
                                bound.to_degrees()
                            );
                            worst = worst.max(excess);
                            places += 1;
                        }
                    }
                    before.push(motion);
                }
                EventKind::Block
                | EventKind::Dwell(_)
                | EventKind::Coolant(_)
                | EventKind::Stop(_)
                | EventKind::Home(_)
                | EventKind::Offset(_)
                | EventKind::ExactStop
                | EventKind::Auxiliary(..)
                | EventKind::Hole
                | EventKind::End => {}
            }
        }
    }
    (worst, places)
}

#[test]
fn no_point_of_the_rim_is_engaged_beyond_the_bound() {
    let (worst, places) = tried(0..6, 1);
    assert!(places > 500 && worst < 0.011, "{worst} deg at {places} places");
}

/// The thousand programs of the specification; some minutes: `cargo test --release -p toolroom-stock --test bound -- --ignored`.
#[test]
#[ignore = "some minutes"]
fn a_thousand_programs_keep_the_bound() {
    let (worst, places) = tried(0..1000, 2);
    assert!(places > 500_000 && worst < 0.011, "{worst} deg at {places} places");
}
