//! How long each block takes.

use crate::block::{Block, ROTARY_RAPID};
use crate::motion::{Motion, Path};
use toolroom_process::record;

record! {
    /// What drives and tool changer do to the programmed times. Neutral at zero: acceleration,
    /// settling, holes.
    pub struct Drives {
        /// Rapid speed of each axis. 30 m/min: a vertical machining centre of the middle class (assumption).
        rapid_speed: Real["m/s" => "m/min"] = 0.5, 1e-4..=10.0;
        /// Time from chip to chip of a tool change.
        tool_change_time: Real["s" => "s"] = 0.0, 0.0..=3600.0;
        /// Inverse of the acceleration along the path; 0 for drives that need none.
        inverse_acceleration: Real["s2/m" => "s2/m"] = 0.0, 0.0..=100.0;
        /// Inverse of the acceleration of rapid motions; 0 for that along the path.
        inverse_rapid_acceleration: Real["s2/m" => "s2/m"] = 0.0, 0.0..=100.0;
        /// Distance by which corners may be rounded: it gives the speed at them.
        corner_deviation: Real["m" => "um"] = 10e-6, 1e-9..=1e-3;
        /// Time in which a drive builds its acceleration up: acceleration over jerk.
        jerk_time: Real["s" => "s"] = 0.0, 0.0..=1.0;
        /// Time that the axes need to settle where a stop ends a motion at feed.
        feed_settling: Real["s" => "s"] = 0.0, 0.0..=60.0;
        /// Time that the axes need to settle behind a rapid motion.
        rapid_settling: Real["s" => "s"] = 0.0, 0.0..=60.0;
        /// Time that every hole of a canned cycle takes beside its motions.
        hole_dwell: Real["s" => "s"] = 0.0, 0.0..=3600.0;
    }
}

/// A motion at feed whose speed at its ends is not settled.
#[derive(Clone, Copy, Debug)]
struct Step {
    key: usize,
    /// m.
    way: f64,
    /// m/s.
    top: f64,
    start: [f64; 3],
    end: [f64; 3],
}

/// Motions that are looked at together: a control looks ahead over some hundred blocks, and a machine that slows over
/// more than this many motions stops at the end of what it sees (assumption).
const WINDOW: usize = 8192;

/// Times blocks one after the other, in bounded memory.
///
/// `t = length/feed`, rapid `longest axis/rapid_speed`, without acceleration. With it the speed follows trapezoids
/// between the speeds at the ends of motions: rest before and behind rapid motions, dwells, tool changes, auxiliary
/// functions and exact stops, else at most `v² = a·corner_deviation·s/(1 − s)`, `s = cos(half the turn)`, and at most
/// `v² = a·radius` on arcs. With a jerk time a change of speed by `Δv` takes `Δv/a + jerk_time`, and where it is too
/// small to need the whole acceleration `2 √(Δv·jerk_time/a)`. Rotary axes alone need no acceleration.
///
/// # Source
/// Trapezoidal speed with look-ahead; corner speed of Jeon, "Improving Grbl: cornering algorithm" (2011). Ramps of
/// limited jerk: Biagiotti & Melchiorri, "Trajectory Planning for Automatic Machines and Robots" (2008), double S; the
/// look-ahead does without jerk. That rapid motions start and end at rest, and that one acceleration holds for all
/// directions, are assumptions.
pub struct Timer {
    drives: Drives,
    steps: Vec<Step>,
    /// Speed at which the first step begins, m/s.
    entry: f64,
    last: Option<Last>,
}

/// The motion that ended last, where the axes still have to settle.
#[derive(Clone, Copy, Debug)]
struct Last {
    key: usize,
    rapid: bool,
}

impl Timer {
    /// Begins at rest.
    pub fn new(drives: &Drives) -> Self {
        Self { drives: *drives, steps: Vec::new(), entry: 0.0, last: None }
    }

    /// Takes the next block; `done` gets the times that are settled, each with the key of its block, s.
    pub fn block(&mut self, key: usize, block: &Block, done: &mut Vec<(usize, f64)>) {
        let change = if block.tool_change { self.drives.tool_change_time } else { 0.0 };
        let fixed = block.dwell + block.auxiliary_time + change + f64::from(block.holes) * self.drives.hole_dwell;
        if fixed > 0.0 {
            done.push((key, fixed));
        }
        // Auxiliary functions act before the motion of their block or behind it; either way the axes rest.
        let rests = block.dwell > 0.0 || block.tool_change || block.auxiliary;
        if rests {
            self.rest(done);
        }
        for motion in &block.motions {
            self.motion(key, motion, done);
            if block.holes > 0 {
                self.rest(done);
            }
        }
        if rests || block.exact_stop {
            self.rest(done);
        }
    }

    fn motion(&mut self, key: usize, motion: &Motion, done: &mut Vec<(usize, f64)>) {
        let drives = self.drives;
        if motion.rapid {
            let (linear, rotary) = motion.longest();
            if linear == 0.0 && rotary == 0.0 {
                return;
            }
            let inverse = if drives.inverse_rapid_acceleration > 0.0 {
                drives.inverse_rapid_acceleration
            } else {
                drives.inverse_acceleration
            };
            let straight = if inverse > 0.0 {
                let ramp = Ramp { acceleration: 1.0 / inverse, jerk_time: drives.jerk_time };
                ramp.time_of(1e-3 * linear, drives.rapid_speed, 0.0, 0.0)
            } else {
                1e-3 * linear / drives.rapid_speed
            };
            let time = straight.max(rotary / ROTARY_RAPID);
            self.rest(done);
            done.push((key, time));
            self.last = Some(Last { key, rapid: true });
            return;
        }
        if self.last.is_some_and(|last| last.rapid) {
            self.settle(done);
        }
        self.last = Some(Last { key, rapid: false });
        if drives.inverse_acceleration <= 0.0 || motion.is_rotary() || motion.length <= 0.0 || motion.time <= 0.0 {
            done.push((key, motion.time));
            return;
        }
        let (start, end) = motion.directions();
        let way = 1e-3 * motion.length;
        let feed = way / motion.time;
        // On an arc part of the acceleration turns the path.
        let top = match motion.path {
            Path::Line => feed,
            Path::Arc(arc) => feed.min((1e-3 * arc.radius / drives.inverse_acceleration).sqrt()),
        };
        self.steps.push(Step { key, way, top, start, end });
        if self.steps.len() >= WINDOW {
            self.commit(WINDOW / 2, done);
        }
    }

    /// The axes come to rest.
    fn rest(&mut self, done: &mut Vec<(usize, f64)>) {
        self.commit(self.steps.len(), done);
        self.settle(done);
        self.entry = 0.0;
    }

    fn settle(&mut self, done: &mut Vec<(usize, f64)>) {
        if let Some(last) = self.last.take() {
            let time = if last.rapid { self.drives.rapid_settling } else { self.drives.feed_settling };
            if time > 0.0 {
                done.push((last.key, time));
            }
        }
    }

    /// Times the first `count` steps, as if the axes rested behind the last that is known.
    fn commit(&mut self, count: usize, done: &mut Vec<(usize, f64)>) {
        if self.steps.is_empty() {
            return;
        }
        let acceleration = 1.0 / self.drives.inverse_acceleration;
        let joints = joints(&self.steps, self.entry, acceleration, self.drives.corner_deviation);
        let ramp = Ramp { acceleration, jerk_time: self.drives.jerk_time };
        for (i, step) in self.steps[..count].iter().enumerate() {
            done.push((step.key, ramp.time_of(step.way, step.top, joints[i], joints[i + 1])));
        }
        self.entry = joints[count];
        self.steps.drain(..count);
    }

    /// The program ends: everything that is left comes to rest; `done` gets its times as in [`block`](Self::block).
    pub fn finish(&mut self, done: &mut Vec<(usize, f64)>) {
        self.rest(done);
    }
}

/// Speeds before each step and behind the last, m/s, by `acceleration`, m/s², and corner `deviation`, m.
fn joints(steps: &[Step], entry: f64, acceleration: f64, deviation: f64) -> Vec<f64> {
    let mut joints = vec![0.0; steps.len() + 1];
    joints[0] = entry;
    for i in 1..steps.len() {
        let (before, after) = (&steps[i - 1], &steps[i]);
        let dot: f64 = before.end.iter().zip(after.start).map(|(a, b)| a * b).sum();
        let half = (0.5 * (1.0 + dot.clamp(-1.0, 1.0))).sqrt();
        // Without a turn the speed is that of the motions, whatever the rounding of `half`.
        let corner = (acceleration * deviation * half / (1.0 - half).max(1e-15)).sqrt();
        joints[i] = corner.min(before.top).min(after.top);
    }
    let reach = |speed: f64, way: f64| (speed * speed + 2.0 * acceleration * way).sqrt();
    for i in (1..steps.len()).rev() {
        joints[i] = joints[i].min(reach(joints[i + 1], steps[i].way));
    }
    for i in 0..steps.len() {
        joints[i + 1] = joints[i + 1].min(reach(joints[i], steps[i].way));
    }
    joints
}

/// How a drive changes its speed.
struct Ramp {
    /// m/s².
    acceleration: f64,
    /// s.
    jerk_time: f64,
}

/// Halvings of the interval of a peak speed: to a thousandth of a per cent.
const HALVINGS: usize = 17;

impl Ramp {
    /// Time of a change of speed by `change` m/s, s.
    fn time(&self, change: f64) -> f64 {
        let full = self.acceleration * self.jerk_time;
        if change >= full {
            change / self.acceleration + self.jerk_time
        } else {
            2.0 * (change * self.jerk_time / self.acceleration).sqrt()
        }
    }

    /// Time, s, and way, m, of the ramps from `start` over `peak` to `end`; their speed is symmetric.
    fn both(&self, start: f64, peak: f64, end: f64) -> (f64, f64) {
        let (up, down) = (self.time((peak - start).max(0.0)), self.time((peak - end).max(0.0)));
        (up + down, 0.5 * (start + peak) * up + 0.5 * (peak + end) * down)
    }

    /// Time of a `way`, m, from speed `start` over at most `top` to `end`, m/s, in s.
    fn time_of(&self, way: f64, top: f64, start: f64, end: f64) -> f64 {
        let squares = start * start + end * end;
        let mut peak = top.min((self.acceleration * way + 0.5 * squares).sqrt());
        if self.jerk_time > 0.0 && self.both(start, peak, end).1 > way {
            let (mut low, mut high) = (start.max(end), peak);
            for _ in 0..HALVINGS {
                peak = 0.5 * (low + high);
                if self.both(start, peak, end).1 > way { high = peak } else { low = peak }
            }
        }
        let (time, ramps) = self.both(start, peak, end);
        if ramps > way {
            // The look-ahead knows no jerk: ramps that are too long are taken at their mean speed.
            return time * way / ramps;
        }
        time + if peak > 0.0 { (way - ramps) / peak } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Control, Dialect, Program, Units};
    use proptest::prelude::*;

    fn control() -> Control {
        Control { units: Some(Units::Millimetre), ..Control::of(Dialect::LinuxCnc) }
    }

    fn time(text: &str, drives: &Drives) -> f64 {
        Program::read(text, &control()).expect("a program").times(drives).iter().sum()
    }

    fn with(inverse_acceleration: f64) -> Drives {
        Drives { inverse_acceleration, ..Drives::default() }
    }

    #[test]
    fn a_short_way_is_a_triangle_and_a_long_one_a_trapezoid() {
        // 100 mm at 6 m/min = 0.1 m/s with 1 m/s²: 1 s and one ramp's 0.1 s more.
        assert!((time("G0 X0 Y0 Z0\nG1 X100 F6000", &with(1.0)) - 1.1).abs() < 1e-12);
        // 4 mm: 2·√(way/a).
        assert!((time("G0 X0 Y0 Z0\nG1 X4 F6000", &with(1.0)) - 2.0 * 4e-3_f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn a_straight_path_in_pieces_takes_the_time_of_one() {
        let pieces: String = (1..=100).map(|i| format!("X{i}\n")).collect();
        let whole = time("G0 X0 Y0 Z0\nG1 X100 F6000", &with(0.5));
        assert!((time(&format!("G0 X0 Y0 Z0\nG1 F6000\n{pieces}"), &with(0.5)) - whole).abs() < 1e-9);
        let stopped = time(&format!("G61 G0 X0 Y0 Z0\nG1 F6000\n{pieces}"), &with(0.5));
        assert!(stopped > 1.5 * whole, "{stopped}");
    }

    #[test]
    fn a_ramp_of_limited_jerk_takes_longer_by_its_mean_speed() {
        let with = |jerk_time| Drives { inverse_acceleration: 1.0, jerk_time, ..Drives::default() };
        let time = |x: f64, jerk_time| time(&format!("G0 X0 Y0 Z0\nG1 X{x} F6000"), &with(jerk_time));
        // 0.1 m/s at 1 m/s² in 0.1 s; with 0.05 s of jerk in 0.15 s, half of it lost at each end.
        assert!((time(100.0, 0.05) - 1.15).abs() < 1e-9, "{}", time(100.0, 0.05));
        // With 0.4 s the whole acceleration is never reached: 2·√(0.1·0.4) s a ramp.
        assert!((time(100.0, 0.4) - 1.4).abs() < 1e-9, "{}", time(100.0, 0.4));
        // Two triangles of jerk and way 4 mm: both ramps to v in 2·√(v·0.4), way v·2·√(v·0.4).
        let peak = (4e-3 / (2.0 * 0.4_f64.sqrt())).powf(2.0 / 3.0);
        assert!((time(4.0, 0.4) - 4.0 * (peak * 0.4).sqrt()).abs() < 1e-4, "{}", time(4.0, 0.4));
        assert_eq!(time(4.0, 0.0), self::time("G0 X0 Y0 Z0\nG1 X4 F6000", &self::with(1.0)));
    }

    #[test]
    fn corners_cost_time_by_their_angle() {
        let corner = |y: f64| time(&format!("G0 X0 Y0 Z0\nG1 X50 F6000\nX100 Y{y}"), &with(0.5)) - (1.0 + 0.05);
        let flat = (50.0_f64.hypot(1.0) - 50.0) / 100.0;
        assert!((corner(0.0)).abs() < 1e-12 && corner(1.0) - flat < 1e-3 && corner(50.0) > 0.2);
    }

    proptest! {
        #[test]
        fn no_acceleration_is_the_limit_of_great_acceleration(x in 1.0..50.0_f64, y in -50.0..50.0_f64) {
            let text = format!("G0 X0 Y0 Z0\nG1 X{x:.3} Y{y:.3} F1000\nG2 X{:.3} I5 J0\nG0 Z9\nG81 Z-3 R1 X3", x + 10.0);
            let (none, much) = (time(&text, &with(0.0)), time(&text, &with(1e-9)));
            prop_assert!((none - much).abs() < 1e-6 * none, "{none} {much}");
            prop_assert!(time(&text, &with(1.0)) > none);
        }
    }
}
