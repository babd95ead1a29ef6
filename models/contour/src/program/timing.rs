//! How long each block takes.

use super::motion::{Motion, dot};
use super::{Block, Program};
use toolroom_process::record;

record! {
    /// What drives and tool changer do to the programmed times. Neutral at zero: acceleration,
    /// holes.
    pub struct Drives {
        /// Rapid speed of each axis. 30 m/min: a vertical machining centre of the middle class (assumption).
        rapid_speed: Real["m/s" => "m/min"] = 0.5, 1e-4..=10.0;
        /// Time from chip to chip of a tool change.
        tool_change_time: Real["s" => "s"] = 0.0, 0.0..=3600.0;
        /// Inverse of the acceleration along the path; 0 for drives that need none.
        inverse_acceleration: Real["s2/m" => "s2/m"] = 0.0, 0.0..=100.0;
        /// Distance by which corners may be rounded: it gives the speed at them.
        corner_deviation: Real["m" => "um"] = 10e-6, 1e-9..=1e-3;
        /// Time in which a drive builds its acceleration up: acceleration over jerk.
        jerk_time: Real["s" => "s"] = 0.0, 0.0..=1.0;
        /// Time that every hole of a canned cycle takes beside its motions.
        hole_dwell: Real["s" => "s"] = 0.0, 0.0..=3600.0;
    }
}

/// A motion with the block that it belongs to, and whether the axes rest behind it.
struct Step<'p> {
    motion: &'p Motion,
    block: usize,
    rest: bool,
}

impl Program {
    /// Time of each block, s.
    ///
    /// `t = length/feed`, rapid `longest axis/rapid_speed`, without acceleration. With it the speed
    /// follows trapezoids between the speeds at the ends of motions: rest before and behind rapid
    /// motions, dwells, tool changes, M codes and exact stops, else at most
    /// `v² = a·corner_deviation·s/(1 − s)`, `s = cos(half the turn)`, and at most `v² = a·radius` on arcs.
    /// With a jerk time a change of speed by `Δv` takes `Δv/a + jerk_time`, and where it is too small to
    /// need the whole acceleration `2 √(Δv·jerk_time/a)`.
    ///
    /// # Source
    /// Trapezoidal speed with look-ahead over all blocks; corner speed of Jeon, "Improving Grbl:
    /// cornering algorithm" (2011). Ramps of limited jerk: Biagiotti & Melchiorri, "Trajectory Planning
    /// for Automatic Machines and Robots" (2008), double S; the look-ahead does without jerk. That rapid motions start and end at rest, and that one
    /// acceleration holds for all directions, are assumptions.
    pub fn times(&self, drives: &Drives) -> Vec<f64> {
        let fixed = |block: &Block| {
            let change = if block.tool_change { drives.tool_change_time } else { 0.0 };
            block.dwell + change + f64::from(block.holes) * drives.hole_dwell
        };
        let mut times: Vec<f64> = self.blocks.iter().map(fixed).collect();
        let steps = self.steps();
        if drives.inverse_acceleration <= 0.0 {
            for step in &steps {
                times[step.block] += step.motion.nominal(drives.rapid_speed);
            }
            return times;
        }
        let acceleration = 1.0 / drives.inverse_acceleration;
        let speeds: Vec<f64> =
            steps.iter().map(|step| step.motion.top_speed(acceleration, drives.rapid_speed)).collect();
        let joints = joints(&steps, &speeds, acceleration, drives.corner_deviation);
        let ramp = Ramp { acceleration, jerk_time: drives.jerk_time };
        for (i, step) in steps.iter().enumerate() {
            times[step.block] += ramp.time_of(step.motion.way(), speeds[i], joints[i], joints[i + 1]);
        }
        times
    }

    fn steps(&self) -> Vec<Step<'_>> {
        let mut steps: Vec<Step<'_>> = Vec::new();
        for (index, block) in self.blocks.iter().enumerate() {
            let rests = block.dwell > 0.0 || block.tool_change || !block.auxiliary.is_empty();
            // M codes act before the motion of their block or behind it; either way the axes rest.
            if rests && let Some(last) = steps.last_mut() {
                last.rest = true;
            }
            let count = block.motions.len();
            steps.extend(block.motions.iter().enumerate().map(|(i, motion)| Step {
                motion,
                block: index,
                rest: block.holes > 0 || (i + 1 == count && (block.exact_stop || rests)),
            }));
        }
        steps
    }
}

impl Motion {
    /// The way whose speed the drives limit: the longest axis of a rapid motion.
    fn way(&self) -> f64 {
        if self.feed.is_some() { self.length } else { self.longest }
    }

    fn top_speed(&self, acceleration: f64, rapid_speed: f64) -> f64 {
        // On an arc part of the acceleration turns the path.
        self.feed.map_or(rapid_speed, |feed| feed.min((acceleration * self.radius).sqrt()))
    }
}

/// Speeds before each step and behind the last.
fn joints(steps: &[Step<'_>], speeds: &[f64], acceleration: f64, deviation: f64) -> Vec<f64> {
    let mut joints = vec![0.0; steps.len() + 1];
    for i in 1..steps.len() {
        let (before, after) = (&steps[i - 1], &steps[i]);
        if before.rest || before.motion.feed.is_none() || after.motion.feed.is_none() {
            continue;
        }
        let turn = dot(before.motion.end, after.motion.start).clamp(-1.0, 1.0);
        let half = (0.5 * (1.0 + turn)).sqrt();
        let corner = (acceleration * deviation * half / (1.0 - half).max(1e-15)).sqrt();
        joints[i] = corner.min(speeds[i - 1]).min(speeds[i]);
    }
    let reach = |speed: f64, way: f64| (speed * speed + 2.0 * acceleration * way).sqrt();
    for i in (0..steps.len()).rev() {
        joints[i] = joints[i].min(reach(joints[i + 1], steps[i].motion.way()));
    }
    for i in 0..steps.len() {
        joints[i + 1] = joints[i + 1].min(reach(joints[i], steps[i].motion.way()));
    }
    joints
}

/// How a drive changes its speed.
struct Ramp {
    acceleration: f64,
    jerk_time: f64,
}

/// Halvings of the interval of a peak speed: to a thousandth of a per cent.
const HALVINGS: usize = 17;

impl Ramp {
    /// Time of a change of speed.
    fn time(&self, change: f64) -> f64 {
        let full = self.acceleration * self.jerk_time;
        if change >= full {
            change / self.acceleration + self.jerk_time
        } else {
            2.0 * (change * self.jerk_time / self.acceleration).sqrt()
        }
    }

    /// Times and ways of the ramps from `start` over `peak` to `end`; their speed is symmetric.
    fn both(&self, start: f64, peak: f64, end: f64) -> (f64, f64) {
        let (up, down) = (self.time((peak - start).max(0.0)), self.time((peak - end).max(0.0)));
        (up + down, 0.5 * (start + peak) * up + 0.5 * (peak + end) * down)
    }

    /// Time of a way from speed `start` over at most `top` to `end`.
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
    use crate::Units;
    use proptest::prelude::*;

    fn time(text: &str, drives: &Drives) -> f64 {
        Program::read_in(text, Some(Units::Millimetre)).expect("a program").times(drives).iter().sum()
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
