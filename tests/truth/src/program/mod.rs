//! Three part programs on a machining centre, run again and again and timed stretch by stretch.
//!
//! Times come from a reading of the programs of its own: ramps last longer by a constant jerk time,
//! corners of more than a limit stop the path, flatter ones slow it down in proportion.

mod path;

use crate::noise::Chance;
use crate::{Case, Edges, Generator};
use path::{Line, read};
use std::fmt::Write;

/// Programs and their text.
const PROGRAMS: [(&str, &str); 3] = [
    ("BRACKET", include_str!("../../../../scenarios/gap/programs/bracket.nc")),
    ("PLATE", include_str!("../../../../scenarios/gap/programs/plate.nc")),
    ("POCKET", include_str!("../../../../scenarios/gap/programs/pocket.nc")),
];
/// Runs of each program.
const RUNS: usize = 5;

/// The machine.
pub const GENERATOR: Generator = Generator { process: "program", effects: &EFFECTS, outside: &OUTSIDE, records };

const EFFECTS: [(&str, f64); 5] = [
    ("tool_change_delay", 5.0),
    ("axis_acceleration", 0.5),
    ("canned_cycle_dwell", 1.0),
    ("feed_override", 1.0),
    ("feed_hold", 10.0),
];

const OUTSIDE: [&str; 3] = ["pallet_wait", "warm_up", "slow_controller"];

/// Tool change by the sheet, s, and axis speed in rapid motion, mm/s; the model believes 4 and 500.
const CHANGE: f64 = 4.0;
const RAPID: f64 = 480.0;
/// Nominal time behind which a stretch of motions is cut, s.
const CUT: f64 = 10.0;

/// How fast the axes are.
struct Drives {
    /// mm/s², infinite for ideal drives.
    acceleration: f64,
    /// Time by which each ramp is longer, s.
    jerk_time: f64,
    /// Cosine of the corner beyond which the path stops.
    stop_below: f64,
}

/// Time of a motion from speed `start` over `top` to `end`, mm and s.
fn motion(way: f64, top: f64, start: f64, end: f64, drives: &Drives) -> f64 {
    if drives.acceleration.is_infinite() || way <= 0.0 {
        return way / top;
    }
    let a = drives.acceleration;
    let ramp_up = (top * top - start * start) / (2.0 * a);
    let ramp_down = (top * top - end * end) / (2.0 * a);
    let jerks = |speed: f64| f64::from(u8::from(speed > start)) + f64::from(u8::from(speed > end));
    if ramp_up + ramp_down <= way {
        let cruise = (way - ramp_up - ramp_down) / top;
        return (top - start) / a + cruise + (top - end) / a + jerks(top) * drives.jerk_time;
    }
    let peak = (a * way + 0.5 * (start * start + end * end)).sqrt().min(top);
    ((2.0 * peak - start - end) / a).max(way / top) + jerks(peak) * drives.jerk_time * (peak / top)
}

/// Seconds of every line of a program.
fn times(lines: &[Line], drives: &Drives) -> Vec<(f64, f64)> {
    let flat: Vec<(usize, usize)> =
        lines.iter().enumerate().flat_map(|(i, line)| (0..line.moves.len()).map(move |j| (i, j))).collect();
    let move_of = |k: usize| &lines[flat[k].0].moves[flat[k].1];
    let mut joint = vec![0.0; flat.len() + 1];
    for k in 1..flat.len() {
        let (before, after) = (move_of(k - 1), move_of(k));
        let cosine = (0..3).map(|axis| before.leaves[axis] * after.enters[axis]).sum::<f64>();
        let rests = before.rapid || after.rapid || (flat[k - 1].0 + 1..=flat[k].0).any(|line| lines[line].stops);
        if !rests && cosine > drives.stop_below {
            let slow = (cosine - drives.stop_below) / (1.0 - drives.stop_below);
            joint[k] = before.speed(RAPID).min(after.speed(RAPID)) * slow;
        }
    }
    if drives.acceleration.is_finite() {
        let reach = |speed: f64, way: f64| (speed * speed + 2.0 * drives.acceleration * way).sqrt();
        (0..flat.len()).rev().for_each(|k| joint[k] = joint[k].min(reach(joint[k + 1], move_of(k).way)));
        (0..flat.len()).for_each(|k| joint[k + 1] = joint[k + 1].min(reach(joint[k], move_of(k).way)));
    }
    // Time at feed, and all else.
    let mut sums: Vec<(f64, f64)> = lines.iter().map(|line| (0.0, line.dwell)).collect();
    for (k, (line, _)) in flat.iter().enumerate() {
        let step = move_of(k);
        let time = motion(step.way, step.speed(RAPID), joint[k], joint[k + 1], drives);
        let sum = &mut sums[*line];
        if step.rapid { sum.1 += time } else { sum.0 += time }
    }
    sums
}

/// First and last line of stretches that are timed, with the tool and its section.
fn cuts(lines: &[Line]) -> Vec<(usize, usize, u32, usize)> {
    let ideal = Drives { acceleration: f64::INFINITY, jerk_time: 0.0, stop_below: 0.0 };
    let times = times(lines, &ideal);
    let mut list: Vec<(usize, usize, u32, usize)> = Vec::new();
    let (mut seconds, mut section, mut class) = (0.0, 0, 0);
    for (i, line) in lines.iter().enumerate() {
        let kind = if line.stops {
            1
        } else if line.holes > 0 {
            2
        } else {
            3
        };
        section += usize::from(line.change);
        let nothing = !line.stops && line.moves.is_empty();
        let joins = !list.is_empty() && (nothing || (kind == class && (kind != 3 || seconds < CUT)));
        if joins {
            let last = list.len() - 1;
            list[last] = (list[last].0, i, line.tool, section);
        } else {
            list.push((i, i, line.tool, section));
            seconds = 0.0;
            class = kind;
        }
        seconds += times[i].0 + times[i].1;
    }
    list
}

fn records(case: &Case) -> String {
    // The shop: what does not change between pieces.
    let mut shop = Chance::new(case.seed, 0);
    let mut chance = Chance::new(case.seed, case.stream());
    let slow = case.strength("axis_acceleration");
    let drives = Drives {
        acceleration: if slow > 0.0 { 1e3 / (0.5 * slow) } else { f64::INFINITY },
        jerk_time: if case.stress { 0.03 } else { 0.01 },
        stop_below: if case.stress { 0.9 } else { 0.7 },
    };
    let runs = if case.edges == Edges::New { 3 * RUNS } else { case.times * RUNS };
    let mut csv = String::from(
        "operation_id,machine,program,sequence,tool_id,section,first_block,last_block,start_time [s],\
         feed_override [%],hold_count,hold_time [s],cycle_time [s]\n",
    );
    let mut clock = 0.0;
    for (name, text) in PROGRAMS {
        let lines = read(text);
        let durations = times(&lines, &drives);
        let stretches = cuts(&lines);
        let factor = (if case.stress { 0.04 } else { 0.02 } * shop.normal()).exp();
        let forms: Vec<f64> = stretches.iter().map(|_| (0.005 * case.scatter * shop.normal()).exp() * factor).collect();
        for run in 0..runs {
            let override_share = if case.strength("feed_override") > 0.0 && chance.uniform() < 0.6 {
                [0.6, 0.7, 0.8, 0.9][chance.below(4)]
            } else {
                1.0
            };
            let spread = (0.001 * case.scatter * chance.normal()).exp();
            let controller =
                if case.strength("slow_controller") > 0.0 { 0.004 * case.strength("slow_controller") } else { 0.0 };
            for (i, (first, last, tool, section)) in stretches.iter().enumerate() {
                let inside = *first..=*last;
                let feed: f64 = inside.clone().map(|line| durations[line].0).sum();
                let rest: f64 = inside.clone().map(|line| durations[line].1).sum();
                let count = |of: &dyn Fn(&Line) -> u32| inside.clone().map(|line| of(&lines[line])).sum::<u32>();
                let mut time = feed * (1.0 + case.strength("feed_override") * (1.0 / override_share - 1.0)) + rest;
                time = time * forms[i] * spread;
                for _ in 0..count(&|line| u32::from(line.change)) {
                    time += CHANGE
                        + chance.delay(5.0 * case.strength("tool_change_delay")).max(0.0)
                        + 0.1 * chance.normal().abs();
                }
                time += f64::from(count(&|line| line.holes)) * case.strength("canned_cycle_dwell");
                let (mut holds, mut held) = (0, 0.0);
                if case.strength("feed_hold") > 0.0 && chance.uniform() < 0.15 {
                    holds = 1;
                    held = chance.delay(10.0 * case.strength("feed_hold"));
                }
                if case.strength("pallet_wait") > 0.0 && chance.uniform() < 0.1 {
                    time += chance.delay(15.0 * case.strength("pallet_wait"));
                }
                if run < 2 {
                    time *= 1.0 + 0.05 * case.strength("warm_up");
                }
                // The controller needs time to read a line: only its author knows which.
                time += controller * f64::from(count(&|line| u32::from(line.characters > 24))) * 10.0;
                time += held + 0.08 * chance.normal();
                let number = |line: usize| lines[line].number;
                let _ = writeln!(
                    csv,
                    "{name}-{run},VMC,{name},{},T{tool},{name} {section},{},{},{clock:.1},{:.0},{holds},{held:.1},{:.2}",
                    i + 1,
                    number(*first),
                    number(*last),
                    100.0 * override_share,
                    time.max(0.05)
                );
                clock += time;
            }
            clock += 60.0;
        }
    }
    csv
}
