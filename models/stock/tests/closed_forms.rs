//! Engagement against closed forms, and volume against the stock that is left.

use proptest::prelude::*;
use std::f64::consts::PI;
use std::sync::Arc;
use toolroom_contour::{Point, Trace};
use toolroom_program::{Control, EventKind, Run};
use toolroom_stock::{Cut, Cutting, End, Holder, Outline, Profile, Stock, Tool, ToolForce};

fn block(x: f64, y: f64) -> Stock {
    Stock { outline: Outline::Box(Point { x: 0.0, y: 0.0 }, Point { x, y }), base: -0.02, top: 0.0 }
}

/// The cuts of a program's motions at feed, and the stock behind them.
fn run(text: &str, stock: Stock, radius: f64) -> (Vec<Cut>, Cutting) {
    let tool = Tool { radius, end: End::Flat, teeth: 4.0, force: None, holder: None };
    let mut cutting = Cutting::new(stock, radius);
    let mut cuts = Vec::new();
    for event in Run::new(&format!("G21 G90\n{text}"), &Control::default()).expect("a program") {
        if let EventKind::Motion(motion) = event.unwrap_or_else(|error| panic!("{error}\n{text}")).kind {
            let cut = cutting.motion(&motion, &tool, 0.0);
            if !motion.rapid {
                cuts.push(cut);
            }
        }
    }
    (cuts, cutting)
}

#[test]
fn a_slot_and_a_shoulder_have_the_angles_of_the_closed_forms() {
    let (cuts, _) = run("G0 X-10 Y25 Z-5\nG1 X110 F500\n", block(0.1, 0.05), 5e-3);
    assert!((cuts[0].sampled.to_degrees() - 180.0).abs() < 1e-9);
    for (radius, width, angle) in [(5.0, 1.0, 36.869_898), (8.0, 0.5, 20.364_135)] {
        let y = width - radius;
        let (cuts, _) = run(&format!("G0 X-20 Y{y} Z-5\nG1 X120 F500\n"), block(0.1, 0.05), 1e-3 * radius);
        assert!((cuts[0].sampled.to_degrees() - angle).abs() < 1e-6, "{}", cuts[0].sampled.to_degrees());
        assert!(cuts[0].bound - cuts[0].sampled < 3f64.to_radians(), "{:?}", cuts[0]);
    }
}

#[test]
fn an_inner_corner_engages_a_right_angle_more() {
    // The same cutter was there before, 1 mm farther from both walls: R 5, a 1.
    let corner = |x: f64, y: f64| Point { x, y };
    let stock = Stock { outline: Outline::Box(corner(-0.01, -0.04), corner(0.1, 0.06)), base: -0.02, top: 0.0 };
    let text = "G0 X-20 Y1 Z-5\nG1 X59 F500\nY80\nG0 Z5\nX-20 Y0\nZ-5\nG1 X60\nY80\n";
    let (cuts, _) = run(text, stock.clone(), 5e-3);
    let degrees: Vec<f64> = cuts.iter().map(|cut| cut.sampled.to_degrees()).collect();
    assert!((degrees[2] - 126.8699).abs() < 1e-4, "{degrees:?}");
    // Right behind it the shoulder again.
    assert!((degrees[3] - 36.869_898).abs() < 1e-4, "{degrees:?}");
    // Before the corner: distance, mm, and angle, deg.
    for (before, angle) in [(4.0, 36.872), (3.0, 39.488), (2.0, 53.132), (1.0, 95.742), (0.5, 115.845)] {
        let end = 60.0 - before;
        let text = text.replace("G1 X60\nY80\n", &format!("G1 X{end}\n"));
        let (cuts, _) = run(&text, stock.clone(), 5e-3);
        let degrees = cuts[2].sampled.to_degrees();
        // The reference counts points of the rim, to 0.003 deg, and is printed to 0.001.
        assert!((degrees - angle).abs() < 4e-3, "{before}: {degrees}");
    }
}

/// What lies within two contours is a hole.
#[test]
fn a_drawn_stock_has_holes() {
    let circle = |radius: f64| {
        let mut trace = Trace::new(Point { x: radius, y: 0.0 }, 0.5 * PI);
        trace.arc(radius, 2.0 * PI).expect("a circle");
        trace.outline().expect("an outline")
    };
    let ring = Profile::new(&[circle(0.03), circle(0.02)].concat(), 0.0);
    assert!((ring.area() / (PI * 5e-4) - 1.0).abs() < 1e-3, "{}", ring.area());
    assert!(ring.distance(Point { x: 0.025, y: 0.0 }) < 0.0 && ring.distance(Point::default()) > 0.0);
    let stock = Stock { outline: Outline::Profile(Arc::new(ring)), ..block(0.06, 0.04) };
    // Along X through the middle of the ring: two walls of 10 mm for a slot of 8 mm.
    let (cuts, _) = run("G0 X-50 Y0 Z-2\nG1 X50 F500\n", stock, 4e-3);
    let cut = &cuts[0];
    let slot = |half: f64| half * (0.03f64.powi(2) - half * half).sqrt() + 9e-4 * (half / 0.03).asin();
    let hole = |half: f64| half * (0.02f64.powi(2) - half * half).sqrt() + 4e-4 * (half / 0.02).asin();
    let volume = 2e-3 * 2.0 * (slot(4e-3) - hole(4e-3));
    assert!((cut.removed / volume - 1.0).abs() < 1e-3, "{} {volume}", cut.removed);
    assert!(cut.air > 0.7 && cut.sampled > 3.1, "{cut:?}");
}

/// A box drawn by four lines is cut as the box, and grown by an offset its corners are round.
#[test]
fn a_drawn_stock_is_cut_as_what_it_draws() {
    let mut trace = Trace::new(Point { x: 0.0, y: 0.0 }, 0.0);
    for (x, y) in [(0.06, 0.0), (0.06, 0.04), (0.0, 0.04), (0.0, 0.0)] {
        trace.line_to(Point { x, y }).expect("a line");
    }
    let sections = trace.outline().expect("an outline");
    let drawn = |offset: f64| Stock {
        outline: Outline::Profile(Arc::new(Profile::new(&sections, offset))),
        ..block(0.06, 0.04)
    };
    let text = "G0 X-10 Y1 Z-3\nG1 X50 F500\nG2 X62 Y13 R12\nG1 Y45\nG0 Z5\nX20 Y20\nG1 Z-6\nG3 I4\n";
    let (of_box, _) = run(text, block(0.06, 0.04), 4e-3);
    let (of_lines, _) = run(text, drawn(0.0), 4e-3);
    for (one, other) in of_box.iter().zip(&of_lines) {
        assert!((one.sampled - other.sampled).abs() < 1e-9, "{one:?} {other:?}");
        // Between samples less is known of an outline than of a box, so its steps are finer: the volumes differ by what Simpson's rule
        // leaves of both.
        assert!((one.removed - other.removed).abs() < 1e-4 * one.removed + 1e-15, "{one:?} {other:?}");
    }
    // Along the side of the grown stock the same shoulder lies farther out.
    let shoulder = |y: f64, stock: Stock| run(&format!("G0 X20 Y{y} Z-5\nG1 X40 F500\n"), stock, 5e-3).0[0].sampled;
    assert!((shoulder(-4.0, block(0.06, 0.04)) - shoulder(-6.0, drawn(0.002))).abs() < 1e-9);
    // The grown outline has round corners: four sides and a whole circle more than the rectangle.
    let grown = drawn(0.002);
    let exact = 0.06 * 0.04 + 2.0 * 0.002 * (0.06 + 0.04) + PI * 0.002f64.powi(2);
    assert!((grown.volume() / (0.02 * exact) - 1.0).abs() < 1e-4, "{}", grown.volume());
}

#[test]
fn what_is_engaged_is_what_is_gone() {
    let (radius, stock) = (4e-3, block(0.06, 0.04));
    let text = "G0 X-6 Y0 Z-3\nG1 X66 F500\nG0 Z5\nX-6 Y5 Z5\nZ-3\nG1 X30\nG2 X44 Y19 R14\nG1 Y50\nG0 Z5\nX15 Y25\nG1 Z-6\nG3 I5\nG1 X20 Y30 Z-2\n";
    let (cuts, cutting) = run(text, stock.clone(), radius);
    let sum: f64 = cuts.iter().map(|cut| cut.removed).sum();
    assert!((sum - cutting.removed()).abs() < 1e-15);
    assert!(cuts.iter().any(|cut| cut.plunge) && cuts.iter().any(|cut| cut.air > 0.05));
    // Counted column by column, apart from the swaths.
    let mut floors = vec![0.0; 600 * 400];
    for event in Run::new(&format!("G21 G90\n{text}"), &Control::default()).expect("a program") {
        let EventKind::Motion(motion) = event.expect("a motion").kind else { continue };
        let steps = (motion.length / 0.05).ceil().max(1.0) as u32;
        for step in 0..=steps {
            let position = motion.position(f64::from(step) / f64::from(steps));
            if position[2] >= 0.0 {
                continue;
            }
            let reach = 1e3 * radius;
            let cell = |value: f64| ((value / 0.1) - 0.5).floor() as i64;
            for i in (cell(position[0] - reach)..=cell(position[0] + reach) + 1).filter(|i| (0..600).contains(i)) {
                for j in (cell(position[1] - reach)..=cell(position[1] + reach) + 1).filter(|j| (0..400).contains(j)) {
                    let (x, y) = (0.1 * (i as f64 + 0.5), 0.1 * (j as f64 + 0.5));
                    if (x - position[0]).hypot(y - position[1]) <= reach {
                        let floor: &mut f64 = &mut floors[(i * 400 + j) as usize];
                        *floor = floor.min(1e-3 * position[2]);
                    }
                }
            }
        }
    }
    let gone: f64 = floors.iter().map(|floor| -floor * 1e-8).sum();
    assert!((sum / gone - 1.0).abs() < 5e-3, "{sum} {gone}");
}

/// A ramp of length L into solid material takes d·(R·L + π·R²): half of the prism under the way of its width, and the whole end of the
/// cutter at its lower end. The level way back takes the rest of the slot, and the ramp run again takes nothing.
#[test]
fn a_ramp_removes_its_closed_form_motion_by_motion() {
    let (radius, length, depth) = (5.0, 40.0, 4.0);
    let ramp = depth * (radius * length + PI * radius * radius);
    let slot = depth * (2.0 * radius * length + PI * radius * radius);
    for (text, expected) in [
        ("G0 X10 Y25 Z0\nG1 X50 Z-4 F500\nX10\nX50\n", vec![ramp, slot - ramp, 0.0]),
        ("G0 X10 Y25 Z0\nG1 X50 Z-4 F500\nX10 Z0\nX50 Z-4\n", vec![ramp, 0.0, 0.0]),
        // Out of the material again, and from above it.
        ("G0 X50 Y25 Z5\nG1 Z-4 F500\nX10 Z0\n", vec![PI * radius * radius * depth, depth * radius * length]),
        ("G0 X5 Y25 Z0.5\nG1 X50 Z-4 F500\n", vec![ramp]),
        // Half a turn about (30, 25) with the radius 8: the prism of its ring and the end of the cutter.
        ("G0 X38 Y25 Z0\nG3 X22 Y25 Z-4 I-8 F500\n", vec![depth * (radius * PI * 8.0 + PI * radius * radius)]),
    ] {
        let (cuts, cutting) = run(text, block(0.06, 0.05), 1e-3 * radius);
        let removed: Vec<f64> = cuts.iter().map(|cut| cut.removed * 1e9).collect();
        for (found, exact) in removed.iter().zip(&expected) {
            assert!((found - exact).abs() < 3e-3 * ramp, "{text}: {removed:?} {expected:?}");
        }
        assert_eq!(removed.len(), expected.len());
        assert!((cutting.removed() * 1e9 - expected.iter().sum::<f64>()).abs() < 3e-3 * ramp);
    }
}

/// Turns that follow the same path deeper and deeper leave as many floors as there are lines in them: what they take off
/// together is a prism, the region within the radius of their polygon.
#[test]
fn a_helix_of_short_lines_removes_its_prism() {
    let (turns, sides, reach, radius, depth) = (25, 16, 3.0f64, 6.0, 5.0);
    let corner = |i: u32| {
        let angle = 2.0 * PI * f64::from(i % sides) / f64::from(sides);
        (30.0 + reach * angle.cos(), 25.0 + reach * angle.sin())
    };
    let (x, y) = corner(0);
    let mut text = format!("G0 X{x:.4} Y{y:.4} Z2\nG1 Z0 F500\n");
    for i in 1..=(turns + 1) * sides {
        let ((x, y), down) = (corner(i), depth * f64::from(i) / f64::from(turns * sides));
        text += &format!("X{x:.4} Y{y:.4} Z-{:.6}\n", down.min(depth));
    }
    let (_, cutting) = run(&text, block(0.06, 0.05), 1e-3 * radius);
    let side = 2.0 * reach * (PI / f64::from(sides)).sin();
    let polygon = 0.5 * f64::from(sides) * reach * reach * (2.0 * PI / f64::from(sides)).sin();
    let area = polygon + f64::from(sides) * side * radius + PI * radius * radius;
    let share = cutting.removed() * 1e9 / (area * depth);
    // The ends of the lines are looked at by few rings.
    assert!((share - 1.0).abs() < 0.01, "{share}");
}

#[test]
fn rapids_through_stock_are_told() {
    let tool = Tool { radius: 5e-3, end: End::Flat, teeth: 4.0, force: None, holder: None };
    let mut cutting = Cutting::new(block(0.1, 0.05), 5e-3);
    let mut crashes = Vec::new();
    for event in Run::new("G21 G90 G0 X-20 Y25 Z-5\nX50\nZ10\nX80\nZ-1\n", &Control::default()).expect("a program") {
        let event = event.expect("an event");
        if let EventKind::Motion(motion) = event.kind
            && cutting.motion(&motion, &tool, 0.0).crash
        {
            crashes.push(event.line);
        }
    }
    assert_eq!(crashes, [2, 5]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    /// The rim sampled between the steps is never engaged more than the bound says.
    #[test]
    fn the_bound_holds_between_samples(
        places in proptest::collection::vec((0.0..60.0f64, 0.0..40.0f64, 1.0..8.0f64), 3..9),
    ) {
        let (radius, stock) = (5e-3, block(0.06, 0.04));
        let tool = Tool { radius, end: End::Flat, teeth: 4.0, force: None, holder: None };
        let mut text = "G21 G90 G0 X-20 Y-20 Z5\n".to_owned();
        for (i, (x, y, depth)) in places.iter().enumerate() {
            text += &if i % 3 == 2 {
                format!("G1 Z-{depth:.3} F500\nX{x:.3}\n")
            } else {
                format!("G1 X{x:.3} Y{y:.3} F500\n")
            };
        }
        let mut cutting = Cutting::new(stock, radius);
        for event in Run::new(&text, &Control::default()).expect("a program") {
            let EventKind::Motion(motion) = event.expect("an event").kind else { continue };
            let before = cutting.clone();
            let cut = cutting.motion(&motion, &tool, 0.0);
            if motion.rapid || (motion.start[0] == motion.end[0] && motion.start[1] == motion.end[1]) {
                continue;
            }
            // The same motion in many short ones: each begins with a sample of its own.
            let mut fine = before.clone();
            let mut worst: f64 = 0.0;
            const PARTS: u32 = 60;
            for i in 0..PARTS {
                let (from, to) = (f64::from(i) / f64::from(PARTS), f64::from(i + 1) / f64::from(PARTS));
                let (start, end) = (motion.position(from), motion.position(to));
                let length = motion.length / f64::from(PARTS);
                let part = toolroom_program::Motion { start, end, length, time: motion.time / f64::from(PARTS), ..motion };
                worst = worst.max(fine.motion(&part, &tool, 0.0).sampled);
            }
            prop_assert!(worst <= cut.bound + 1e-6, "{} {}\n{text}", worst.to_degrees(), cut.bound.to_degrees());
            prop_assert!(cut.sampled <= cut.bound + 1e-9 && cut.bound <= PI + 1e-9);
        }
    }
}

#[test]
fn a_holder_is_reported_where_it_meets_a_wall_and_not_above_the_stock() {
    let holder = Some(Holder { radius: 20e-3, overhang: 12e-3 });
    let tool = Tool { radius: 5e-3, end: End::Flat, teeth: 4.0, force: None, holder };
    let meets = |text: &str| {
        let mut cutting = Cutting::new(block(0.1, 0.05), 5e-3);
        let mut lines = Vec::new();
        for event in Run::new(&format!("G21 G90\n{text}"), &Control::default()).expect("a program") {
            let event = event.expect("an event");
            if let EventKind::Motion(motion) = event.kind
                && cutting.motion(&motion, &tool, 0.0).holder
            {
                lines.push(event.line);
            }
        }
        lines
    };
    // Its lower face is 2 mm above the stock, then 2 mm below it: beside the stock free, over its edge not.
    assert!(meets("G0 X-10 Y25 Z-10\nG1 X110 F500\n").is_empty());
    assert_eq!(meets("G0 X-40 Y25 Z-14\nG1 X-21 F500\nX-19\nX20\n"), [4, 5]);
    // A pocket as wide as the holder is free; 1 mm less is not.
    let pocket = |x: f64| {
        let levels: String = (0..=40).map(|i| format!("G1 Y{}\nX{x}\nX{}\n", f64::from(i), 100.0 - x)).collect();
        format!("F500 G0 X{x} Y0 Z-3\n{levels}G0 Z20\nX50 Y20\nG1 Z-14\n")
    };
    assert!(meets(&pocket(30.0)).is_empty());
    assert!(!meets(&pocket(36.0)).is_empty());
    // Straight down onto whole material.
    assert_eq!(meets("G0 X50 Y25 Z10\nG1 Z-11 F100\nZ-13\n"), [4]);
}

/// Volume, mm³, and the cuts of a program whose stock is a grid of heights.
fn on_a_grid(text: &str, tool: &Tool, cell: f64) -> (Vec<Cut>, Cutting) {
    let mut cutting = Cutting::mapped(block(0.06, 0.04), cell);
    let mut cuts = Vec::new();
    for event in Run::new(&format!("G21 G90\n{text}"), &Control::default()).expect("a program") {
        if let EventKind::Motion(motion) = event.expect("an event").kind {
            let cut = cutting.motion(&motion, tool, 100.0 * PI);
            if !motion.rapid {
                cuts.push(cut);
            }
        }
    }
    (cuts, cutting)
}

/// A slot along X through the block of 60 mm, `depth` mm deep.
fn slot(depth: f64) -> String {
    format!("G0 X-10 Y20 Z5\nZ-{depth}\nG1 X70 F600\n")
}

#[test]
fn ends_of_every_form_remove_the_section_of_their_closed_form() {
    let (radius, cell) = (5e-3, 0.1e-3);
    let taper = |depth: f64| depth * (4.0 + depth * 0.2f64.tan());
    let corner = |depth: f64| {
        // The flat middle, and a quarter of a circle of 1 mm on both sides.
        2.0 * (5.0 * depth - (1.0 - 0.25 * PI))
    };
    let ball = |depth: f64| {
        let over: f64 = 5.0 - depth;
        25.0 * (over / 5.0).acos() - over * (25.0 - over * over).sqrt()
    };
    for (end, depth, section) in [
        (End::Corner(5e-3), 2.0, ball(2.0)),
        (End::Corner(5e-3), 5.0, ball(5.0)),
        (End::Corner(1e-3), 3.0, corner(3.0)),
        (End::Taper(2e-3, 0.2), 3.0, taper(3.0)),
        (End::Flat, 3.0, 30.0),
    ] {
        let tool = Tool { radius, end, teeth: 2.0, force: None, holder: None };
        let inside = slot(depth).replace("G1 X70", "G1 X20 F600\nX40\nX70");
        let (cuts, cutting) = on_a_grid(&inside, &tool, cell);
        let volume = cutting.removed() * 1e9;
        assert!((volume / (60.0 * section) - 1.0).abs() < 0.01, "{end:?} {depth}: {volume} {}", 60.0 * section);
        // What is engaged sweeps the same section, to three quarters of a cell on both sides.
        let swept = cuts[1].mean.width * cuts[1].mean.depth * 1e6;
        assert!((swept - section).abs() < 0.01 * section + depth * 0.15, "{end:?} {depth}: {swept} {section}");
        let reach = end.at(radius, 1e-3 * depth).0;
        assert!((cuts[1].mean.radius - reach).abs() < 0.05 * radius, "{end:?}: {}", cuts[1].mean.radius);
    }
}

#[test]
fn a_way_that_is_run_again_is_air_and_a_step_beside_it_takes_a_crescent() {
    let (radius, depth) = (5e-3, 1.0);
    let tool = Tool { radius, end: End::Corner(radius), teeth: 2.0, force: None, holder: None };
    let again = format!("{}G0 Z5\nX-10\nZ-{depth}\nG1 X70\n", slot(depth));
    let (cuts, cutting) = on_a_grid(&again, &tool, 0.1e-3);
    assert!(cuts[1].air > 0.99 && cuts[1].removed < 1e-3 * cutting.removed(), "{:?}", cuts[1]);
    // A step of 0.8 mm beside it: two circles of 5 mm below the surface, less what both have.
    let beside = format!("{}G0 Z5\nX-10 Y20.8\nZ-{depth}\nG1 X70\n", slot(depth));
    let (cuts, _) = on_a_grid(&beside, &tool, 0.1e-3);
    let height = |y: f64| (depth - (5.0 - (25.0 - y * y).max(0.0).sqrt())).max(0.0);
    let steps = 100_000;
    let crescent: f64 = (0..steps)
        .map(|i| -4.0 + 9.0 * (f64::from(i) + 0.5) / f64::from(steps))
        .map(|y| (height(y - 0.8) - height(y)).max(0.0) * 9.0 / f64::from(steps))
        .sum();
    let section = cuts[1].removed * 1e9 / 60.0;
    assert!((section / crescent - 1.0).abs() < 0.01, "{section} {crescent}");
    // Through the same slot at rapid speed nothing is met; through the wall something is.
    let rapid = |y: f64| format!("{}G0 Z5\nX-10 Y{y}\nZ-{depth}\nG0 X70\nG1 X71\n", slot(depth));
    let crashes = |text: &str| {
        let mut cutting = Cutting::mapped(block(0.06, 0.04), 0.1e-3);
        let events = Run::new(&format!("G21 G90\n{text}"), &Control::default()).expect("a program");
        let cut = events.map(|event| match event.expect("an event").kind {
            EventKind::Motion(motion) => cutting.motion(&motion, &tool, 0.0).crash,
            _ => false,
        });
        cut.filter(|crash| *crash).count()
    };
    assert_eq!((crashes(&rapid(20.0)), crashes(&rapid(22.0))), (0, 1));
}

#[test]
fn the_power_of_a_ball_in_a_slot_is_that_of_its_integral() {
    // Over the whole front half: P = ω·z/2π·(2·K·f·∫r dh + π·k·∫r ds), with ∫r ds = R·depth.
    let (radius, depth, speed) = (5e-3, 2e-3, 100.0 * PI);
    let force = ToolForce::default();
    let tool = Tool { radius, end: End::Corner(radius), teeth: 2.0, force: Some(force), holder: None };
    let (cuts, _) = on_a_grid(&slot(2.0), &tool, 0.05e-3);
    let feed_per_tooth = 0.01 * 2.0 * PI / (speed * 2.0);
    let steps = 10_000;
    let radii: f64 = (0..steps)
        .map(|i| depth * (f64::from(i) + 0.5) / f64::from(steps))
        .map(|h| (2.0 * radius * h - h * h).sqrt() * depth / f64::from(steps))
        .sum();
    let (cutting, edge) = (force.edge.tangential_cutting, force.edge.tangential_edge);
    let torque = 2.0 * cutting * feed_per_tooth * radii + PI * edge * radius * depth;
    let power = speed * 2.0 / (2.0 * PI) * torque;
    let load = cuts[0].load.expect("a load");
    assert!((load.power / power - 1.0).abs() < 0.05, "{} {power}", load.power);
}

#[test]
fn a_shoulder_on_a_grid_has_its_angle_within_a_cell() {
    let (radius, cell) = (5e-3, 0.05e-3);
    let tool = Tool { radius, end: End::Flat, teeth: 2.0, force: None, holder: None };
    let (cuts, _) = on_a_grid("G0 X-10 Y-4 Z-5\nG1 X70 F500\n", &tool, cell);
    // A cell of width, and a direction.
    let angle = |width: f64| (1.0 - width / radius).acos();
    let (exact, most) = (angle(1e-3), angle(1e-3 + cell) + cell / radius);
    assert!(cuts[0].sampled <= most && cuts[0].sampled > angle(1e-3 - cell) - cell / radius, "{:?} {exact}", cuts[0]);
}
