//! Planned feeds against samples of what they cut.

use super::*;
use crate::Cutting;
use std::f64::consts::TAU;

/// A cutter of 10 mm in a plate of 20 mm, with the limits of its set but for those that a test gives.
fn setup(limits: &str) -> Setup {
    let text = format!(
        "schema = 1\n[stock]\nbox = [[\"0 mm\", \"0 mm\", \"-20 mm\"], [\"100 mm\", \"60 mm\", \"0 mm\"]]\n\
         [limits]\nhighest_feed = \"6000 mm/min\"\nlowest_feed = \"1 mm/min\"\n{limits}\n\
         [[tool]]\nnumber = 1\ndiameter = \"10 mm\"\nteeth = 4\nlength = \"30 mm\"\nparameter_set = \"mill_t15k6_d32\"\n"
    );
    Setup::parse("setup.toml", &text, &[]).expect("a setup").content
}

/// A pocket with a slot, sharp inner corners, arcs, air and a ramp.
const POCKET: &str = "G21 G90 G0 X-10 Y-10 Z5\nT1 M6\nS3000 M3\nG0 Z-4\nG1 X-7 Y10 F700\nX90\nY50\nX20\nY20\nX80\nY40\n\
    G2 X70 Y30 I-10\nG1 X30\nG3 X25 Y35 I0 J5\nG1 X110\nG0 Z5\nX50 Y5\nG1 Z-2 F200\nX70 Z-6 F400\nX40 Y8 F700\nM30\n";

fn motions(text: &str) -> Vec<(Motion, f64)> {
    let mut speed = 0.0;
    let mut list = Vec::new();
    for event in Run::new(text, &Control::default()).expect("a program") {
        let kind = event.expect("an event").kind;
        if let EventKind::Spindle { speed: rpm, .. } = kind {
            speed = rpm * TAU / 60.0;
        }
        if let EventKind::Motion(motion) = kind {
            list.push((motion, speed));
        }
    }
    list
}

#[test]
fn every_limit_is_kept_wherever_a_planned_program_is_sampled() {
    for (limits, named) in [
        ("power = \"600 W\"\nchip_thickness = \"200 um\"\ntool_life = \"1 min\"", FeedLimit::Power),
        ("deflection = \"120 um\"\nchip_thickness = \"200 um\"\ntool_life = \"1 min\"", FeedLimit::Deflection),
        ("chip_thickness = \"60 um\"\ntool_life = \"1 min\"", FeedLimit::ChipThickness),
        ("feed_force = \"400 N\"\ntool_life = \"5 min\"", FeedLimit::FeedForce),
    ] {
        let setup = setup(limits);
        // The body of a cutter of 10 mm is weaker than any of these limits, but for its own.
        let names = [named, FeedLimit::ChipThickness, FeedLimit::ToolLife];
        let plan = FeedPlan::new(POCKET, &Control::default(), &setup, (Some(FeedObjective::Time), false), &names)
            .expect("a plan");
        let kept = setup.limits[&1].only(&names);
        assert!(plan.limits[&named].binds > 1.0, "{limits}: {:?}", plan.limits);
        let tool = setup.tools[&1];
        let mut cutting = Cutting::new(setup.stock.clone(), tool.radius);
        let (mut sampled, mut worst) = (0, 0.0_f64);
        for (index, (motion, speed)) in motions(POCKET).into_iter().enumerate() {
            let planned = !plan.pieces(index).is_empty();
            for piece in plan.motion(index, &motion) {
                let feed = 1e-3 * piece.length / piece.time;
                let parts = (piece.length / 0.2).ceil().max(1.0);
                for i in 0..parts as u32 {
                    let (from, to) = (f64::from(i) / parts, f64::from(i + 1) / parts);
                    let way = if motion.rapid { piece } else { part(&piece, from, to, feed) };
                    let mut look = |_: f64, _: f64, seen: Encounter<'_>| {
                        let Encounter::Cut(_, samples, tool) = seen else { return };
                        let at_work = AtWork { tool, limits: &kept, speed };
                        for demand in samples.iter().map(|engaged| Demand::from_engaged(engaged, tool)) {
                            let ratios = FeedLimit::ALL.map(|limit| at_work.ratio(limit, &demand, feed).unwrap_or(0.0));
                            if planned && !motion.rapid {
                                worst = ratios.into_iter().fold(worst, f64::max);
                                sampled += 1;
                            }
                        }
                    };
                    cutting.motion_seen(&way, &tool, speed, Some(&mut look));
                    if motion.rapid {
                        break;
                    }
                }
            }
        }
        assert!(sampled > 2000 && worst <= 1.001, "{limits}: {worst} at {sampled} samples");
        // It would be broken without the plan or the plan would be of no use.
        assert!(plan.limits[&named].programmed.0 > 1.05 || worst > 0.9, "{limits}: {:?}", plan.limits);
    }
}

#[test]
fn a_shoulder_gets_the_feed_of_its_closed_form() {
    let setup = setup("chip_thickness = \"80 um\"");
    let text = "G21 G90 G0 X-10 Y-4 Z5\nT1 M6\nS3000 M3\nG0 Z-5\nG1 X110 F500\nM30\n";
    let names = [FeedLimit::HighestFeed, FeedLimit::ChipThickness];
    let plan =
        FeedPlan::new(text, &Control::default(), &setup, (Some(FeedObjective::Time), false), &names).expect("a plan");
    let index = motions(text).iter().position(|(motion, _)| !motion.rapid).expect("a cut");
    let pieces = plan.pieces(index);
    // A shoulder of 1 mm: 36.87°, of which the sine is 0.6. In air the highest feed.
    let feed = pieces.iter().zip(std::iter::once(0.0).chain(pieces.iter().map(|piece| piece.to)));
    let (_, feed) =
        feed.map(|(piece, from)| (piece.to - from, piece.feed)).fold((0.0, 0.0), |a, b| if b.0 > a.0 { b } else { a });
    // The bound is up to a degree above the samples.
    let expected = 80e-6 / 0.6 * 4.0 * 50.0;
    assert!(feed <= expected && feed > 0.97 * expected, "{feed} {expected} {pieces:?}");
    assert!((pieces[0].feed - 0.1).abs() < 1e-9 && pieces[0].limit.is_none(), "{pieces:?}");
    assert_eq!(pieces.last().map(|piece| piece.to), Some(1.0));
}

#[test]
fn a_limit_that_no_feed_keeps_is_reported_and_makes_nothing_faster() {
    let setup = setup("power = \"1 W\"");
    let plan =
        FeedPlan::new(POCKET, &Control::default(), &setup, (Some(FeedObjective::Time), false), &[FeedLimit::Power])
            .expect("a plan");
    assert!(plan.limits[&FeedLimit::Power].planned.0 > 1.0, "{:?}", plan.limits);
    for (index, (motion, _)) in motions(POCKET).iter().enumerate() {
        for piece in plan.pieces(index).iter().filter(|piece| piece.limit == Some(FeedLimit::Power)) {
            assert!(piece.feed <= 1e-3 * motion.length / motion.time + 1e-12, "{piece:?}");
        }
    }
}

#[test]
fn nothing_is_planned_without_an_objective_or_for_a_tool_that_only_drills() {
    let setup = setup("");
    let used = FeedPlan::new(POCKET, &Control::default(), &setup, (None, false), &[]).expect("a use of limits");
    assert!(used.motions.iter().all(Vec::is_empty) && used.limits[&FeedLimit::Power].programmed.0 > 0.0);
    let drilled = "G21 G90 G0 X10 Y10 Z5\nT1 M6\nS3000 M3\nG81 Z-5 R1 F100\nG80\nM30\n";
    let plan =
        FeedPlan::new(drilled, &Control::default(), &setup, (Some(FeedObjective::Time), false), &[]).expect("a plan");
    assert!(plan.motions.iter().all(Vec::is_empty) && plan.kept[&AsProgrammed::Motion] > 0, "{:?}", plan.kept);
}

#[test]
fn cost_slows_down_only_where_edges_wear_faster_than_time_is_saved() {
    let setup = setup("chip_thickness = \"200 um\"");
    let names = [FeedLimit::HighestFeed, FeedLimit::ChipThickness];
    let [time, cost] = [FeedObjective::Time, FeedObjective::Cost].map(|objective| {
        FeedPlan::new(POCKET, &Control::default(), &setup, (Some(objective), false), &names).expect("a plan").stepped
    });
    // The life of the handbook falls with the feed to the power 0.26/0.37 below 1: the fastest feed is the cheapest.
    assert_eq!(time, cost);
    let mut worn = setup;
    let tool = worn.tools.get_mut(&1).expect("a tool");
    if let Some(force) = &mut tool.force {
        (force.life.feed_exponent, force.life.speed_constant) = (0.74, 0.1 * force.life.speed_constant);
    }
    let limits = worn.limits.get_mut(&1).expect("limits");
    (limits.tool_life, limits.chip_thickness) = (None, Some(200e-6));
    let [time, cost] = [FeedObjective::Time, FeedObjective::Cost].map(|objective| {
        FeedPlan::new(POCKET, &Control::default(), &worn, (Some(objective), false), &names).expect("a plan").stepped
    });
    assert!(cost > 1.01 * time, "{cost} {time}");
}

#[test]
fn the_spindle_goes_as_fast_as_the_life_of_the_edge_allows() {
    // Life falls with speed^(1/m) and grows with the feed's exponent: of all speeds the one with the greatest feed at 60 min.
    let setup = setup("chip_thickness = \"80 um\"\ntool_life = \"60 min\"\nhighest_spindle_speed = \"8000 rpm\"");
    let text = "G21 G90 G0 X-10 Y-4 Z5\nT1 M6\nS300 M3\nG0 Z-5\nG1 X110 F50\nM30\n";
    let names = [FeedLimit::ChipThickness, FeedLimit::ToolLife];
    let plan = |speeds| {
        FeedPlan::new(text, &Control::default(), &setup, (Some(FeedObjective::Time), speeds), &names).expect("a plan")
    };
    let (kept, planned) = (plan(false), plan(true));
    let [change] = planned.speeds[..] else { panic!("{:?}", planned.speeds) };
    assert!(kept.speeds.is_empty() && change.line == 3 && change.tool == 1, "{change:?}");
    assert!(planned.stepped < 0.9 * kept.stepped, "{} {}", planned.stepped, kept.stepped);
    assert!(planned.limits[&FeedLimit::ToolLife].planned.0 <= 1.001, "{:?}", planned.limits);
    // Against every speed of the machine by itself.
    let least = setup.speeds[&1]
        .iter()
        .map(|speed| {
            let text = text.replace("S300", &format!("S{}", speed * 60.0 / TAU));
            let time = (Some(FeedObjective::Time), false);
            let plan = FeedPlan::new(&text[..], &Control::default(), &setup, time, &names).expect("a plan");
            let keeps = plan.limits.values().all(|used| used.planned.0 <= 1.001);
            if keeps { plan.continuous } else { f64::INFINITY }
        })
        .fold(f64::INFINITY, f64::min);
    assert!((planned.continuous / least - 1.0).abs() < 1e-3, "{} {least}", planned.continuous);
    // The command is the one that is written.
    let mut commands = 0;
    let action = planned.action(&mut commands, Action::Spindle(300.0, toolroom_program::Sense::Clockwise));
    let expected = Action::Spindle(change.planned * 60.0 / TAU, toolroom_program::Sense::Clockwise);
    assert_eq!((action, commands), (expected, 1));
}

#[test]
fn a_speed_stays_where_holes_are_drilled_under_it() {
    let setup = setup("chip_thickness = \"80 um\"\nhighest_spindle_speed = \"8000 rpm\"");
    let text = "G21 G90 G0 X-10 Y-4 Z5\nT1 M6\nS300 M3\nG0 Z-5\nG1 X110 F50\nG0 Z5\nG81 X50 Y50 Z-5 R2 F50\nG80\nM30\n";
    let names = [FeedLimit::ChipThickness];
    let plan = FeedPlan::new(text, &Control::default(), &setup, (Some(FeedObjective::Time), true), &names);
    assert!(plan.expect("a plan").speeds.is_empty());
}
