//! What a machine does to the programmed times.

use toolroom_process::record;
use toolroom_program::Motion;

record! {
    /// What drives, spindle and tool changer do to the programmed times. Neutral at zero, but for the override, rapid
    /// speeds and ratios.
    pub struct Drives {
        /// Rapid speed of the fastest linear axis. 30 m/min: a vertical machining centre of the middle class (assumption).
        rapid_speed: Real["m/s" => "m/min"] = 0.5, 1e-4..=10.0;
        /// Time from chip to chip of a tool change, less spindle and approach where those are given.
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
        /// Feed override in force. It acts neither on rapid motions nor on threads.
        feed_override: Real = 1.0, 0.01..=3.0;
        /// Rapid speed of X as a share of the fastest axis.
        rapid_ratio_x: Real = 1.0, 0.001..=1.0;
        /// Rapid speed of Y as a share of the fastest axis.
        rapid_ratio_y: Real = 1.0, 0.001..=1.0;
        /// Rapid speed of Z as a share of the fastest axis.
        rapid_ratio_z: Real = 1.0, 0.001..=1.0;
        /// Rapid speed of rotary axes. 25 turns a minute (assumption).
        rotary_rapid_speed: Real["rad/s" => "rpm"] = 2.617993877991494, 1e-4..=1e4;
        /// Rapid acceleration of X as a share of the fastest axis.
        acceleration_ratio_x: Real = 1.0, 0.001..=1.0;
        /// Rapid acceleration of Y as a share of the fastest axis.
        acceleration_ratio_y: Real = 1.0, 0.001..=1.0;
        /// Rapid acceleration of Z as a share of the fastest axis.
        acceleration_ratio_z: Real = 1.0, 0.001..=1.0;
        /// 1 where each axis of a rapid motion runs by itself, 0 where all arrive together.
        independent_rapid: Real = 0.0, 0.0..=1.0;
        /// Step of the speed of an axis that is allowed at corners; 0 where the corner deviation rules.
        corner_step: Real["m/s" => "m/min"] = 0.0, 0.0..=10.0;
        /// Motions over which the control looks ahead, so that it could stop at the end of them; 0 for the whole path.
        look_ahead: Real = 0.0, 0.0..=1e6;
        /// Least time of a motion at feed: the control prepares no more of them.
        block_time: Real["s" => "ms"] = 0.0, 0.0..=1.0;
        /// Time that coolant takes to be switched.
        coolant_time: Real["s" => "s"] = 0.0, 0.0..=60.0;
        /// Time before the first block.
        program_start: Real["s" => "s"] = 0.0, 0.0..=3600.0;
        /// Time of the end of the program, beside waiting for the spindle.
        program_end: Real["s" => "s"] = 0.0, 0.0..=3600.0;
        /// Constant k of the spindle: from rest to n it takes 2·k·n_b·n up to the base speed n_b and k·(n² + n_b²) above,
        /// k = inertia/(2·power).
        spindle_constant: Real["s3/rad2" => "s/rpm2"] = 0.0, 0.0..=1.0;
        /// Speed of the spindle up to which its torque is constant, and above which its power is.
        spindle_base_speed: Real["rad/s" => "rpm"] = 0.0, 0.0..=1e5;
        /// The same constant while the spindle brakes; 0 for that upwards, with its base speed.
        braking_constant: Real["s3/rad2" => "s/rpm2"] = 0.0, 0.0..=1.0;
        /// Speed up to which the braking torque is constant.
        braking_base_speed: Real["rad/s" => "rpm"] = 0.0, 0.0..=1e5;
        /// 1 where the block that commands the spindle waits until it turns at speed, 0 where the first motion at feed or the
        /// block that switches coolant on waits.
        spindle_block_wait: Real = 0.0, 0.0..=1.0;
        /// 1 where the block that switches coolant on waits for the spindle as well, 0 where it does not.
        coolant_wait: Real = 1.0, 0.0..=1.0;
        /// 1 where a programmed stop waits until the spindle stands, 0 where it does not.
        stop_wait: Real = 1.0, 0.0..=1.0;
        /// 1 where the axes go on between motions at feed and rapid ones, 0 where they rest.
        rapid_blend: Real = 0.0, 0.0..=1.0;
        /// 1 where the speed of the slower motion at a corner is reduced by the cosine of the turn, 0 where another rule holds.
        corner_cosine: Real = 0.0, 0.0..=1.0;
        /// Time that the spindle needs to orient itself for a tool change.
        orient_time: Real["s" => "s"] = 0.0, 0.0..=60.0;
        /// Time of a reversal in rigid tapping at 175 rpm; it grows with the ramp. 0 for braking and ramp alone.
        tap_reversal: Real["s" => "s"] = 0.0, 0.0..=60.0;
        /// Time from the place of the tool change to the first place, beside the ramp of the spindle; 0 where that motion is
        /// timed as any other.
        approach_time: Real["s" => "s"] = 0.0, 0.0..=600.0;
        /// Time of the way to the reference point, beside the braking of the spindle.
        home_time: Real["s" => "s"] = 0.0, 0.0..=600.0;
        /// Time of the way from the reference point to a place that the program gives.
        from_home_time: Real["s" => "s"] = 0.0, 0.0..=600.0;
        /// Time of a magazine for one pocket between the old tool and the new one; 0 where the next tool waits at the arm.
        index_time: Real["s" => "s"] = 0.0, 0.0..=60.0;
    }
}

/// Speed of the spindle at which `tap_reversal` holds, rad/s: 175 rpm.
const TAPPING: f64 = 175.0 / 60.0 * std::f64::consts::TAU;

impl Drives {
    /// Time of the spindle from rest to `speed`, rad/s, or back to rest, s.
    fn time_from_rest(&self, speed: f64, braking: bool) -> f64 {
        let (constant, base) = if braking && self.braking_constant > 0.0 {
            (self.braking_constant, self.braking_base_speed)
        } else {
            (self.spindle_constant, self.spindle_base_speed)
        };
        if speed <= base { 2.0 * constant * base * speed } else { constant * (speed * speed + base * base) }
    }

    /// Time in which the spindle changes from one speed to another, s; both in rad/s, negative to the left.
    ///
    /// Below the base speed n_b the torque is constant: `2·k·n_b·n` from rest to n; above it the power is:
    /// `k·(n² + n_b²)`. A reversal brakes to rest and starts again.
    ///
    /// # Source
    /// Constant torque and constant power of a rotating mass; checked on the tool changes of the NIST box.
    ///
    /// ```
    /// use toolroom_drives::Machine;
    /// let drives = Machine::preset("hurco-winmax").unwrap().drives;
    /// let rpm = std::f64::consts::TAU / 60.0;
    /// let time = |from: f64, to: f64| drives.spindle_ramp(from * rpm, to * rpm);
    /// assert!((time(0.0, 12_000.0) - 7.07).abs() < 0.01);
    /// assert!(time(3000.0, -3000.0) > time(0.0, 3000.0) + 0.9);
    /// ```
    pub fn spindle_ramp(&self, start: f64, end: f64) -> f64 {
        if start * end < 0.0 {
            return self.time_from_rest(start.abs(), true) + self.time_from_rest(end.abs(), false);
        }
        let (start, end) = (start.abs(), end.abs());
        if end >= start {
            self.time_from_rest(end, false) - self.time_from_rest(start, false)
        } else {
            self.time_from_rest(start, true) - self.time_from_rest(end, true)
        }
    }

    /// Time of a reversal in rigid tapping at `speed`, rad/s, in s.
    pub(crate) fn tap_reversal(&self, speed: f64) -> f64 {
        let ramp = |speed: f64| self.time_from_rest(speed, false);
        if self.tap_reversal <= 0.0 {
            self.spindle_ramp(speed, -speed)
        } else if ramp(TAPPING) > 0.0 {
            self.tap_reversal * ramp(speed.abs()) / ramp(TAPPING)
        } else {
            self.tap_reversal
        }
    }

    /// Inverse of the acceleration of rapid motions, s²/m: their own, else that along the path; 0 where none is needed.
    pub fn rapid_inertia(&self) -> f64 {
        if self.inverse_rapid_acceleration > 0.0 { self.inverse_rapid_acceleration } else { self.inverse_acceleration }
    }

    /// Rapid speed, m/s, and acceleration, m/s² (0 where none is needed), of axis `k` of X Y Z A B C U V W; those of
    /// rotary axes are not used.
    fn axis(&self, k: usize) -> (f64, f64) {
        let speed = [self.rapid_ratio_x, self.rapid_ratio_y, self.rapid_ratio_z];
        let acceleration = [self.acceleration_ratio_x, self.acceleration_ratio_y, self.acceleration_ratio_z];
        let inverse = self.rapid_inertia();
        let ratio = |list: [f64; 3]| list.get(k).copied().unwrap_or(1.0);
        (self.rapid_speed * ratio(speed), if inverse > 0.0 { ratio(acceleration) / inverse } else { 0.0 })
    }

    /// Ways of a rapid motion that are run one beside the other: each with its length, m, greatest speed, m/s, and
    /// acceleration, m/s², 0 where none is needed.
    pub(crate) fn rapid_ways(&self, motion: &Motion) -> Vec<(f64, f64, f64)> {
        let travels = [0, 1, 2, 6, 7, 8].map(|k| (k, 1e-3 * (motion.end[k] - motion.start[k]).abs()));
        let longest = travels.iter().map(|(_, travel)| *travel).fold(0.0, f64::max);
        let moving = travels.iter().filter(|(_, travel)| *travel > 0.0);
        if self.independent_rapid >= 0.5 {
            return moving.map(|(k, travel)| (*travel, self.axis(*k).0, self.axis(*k).1)).collect();
        }
        // All axes arrive together: the way of the longest at the speed that no axis exceeds.
        let mut whole = (longest, f64::INFINITY, f64::INFINITY);
        for (k, travel) in moving {
            let (speed, acceleration) = self.axis(*k);
            let share = longest / travel;
            whole.1 = whole.1.min(speed * share);
            whole.2 = whole.2.min(acceleration * share);
        }
        if longest > 0.0 { vec![whole] } else { Vec::new() }
    }

    /// Time of a motion's rotary axes at rapid speed, s.
    pub(crate) fn rotary(&self, motion: &Motion) -> f64 {
        motion.longest().1.to_radians() / self.rotary_rapid_speed
    }

    /// Time of a rapid motion at the speeds of its axes without acceleration, s; 0 of a motion at feed.
    pub fn rapid_time(&self, motion: &Motion) -> f64 {
        if !motion.rapid {
            return 0.0;
        }
        let ways = self.rapid_ways(motion);
        ways.iter().map(|(way, speed, _)| way / speed).fold(self.rotary(motion), f64::max)
    }
}

#[cfg(test)]
mod tests {
    use crate::Machine;

    #[test]
    fn ramps_of_the_spindle_are_those_of_the_box() {
        // Closed forms with the constants of the preset's source, s.
        let drives = Machine::preset("hurco-winmax").expect("a preset").drives;
        let rpm = std::f64::consts::TAU / 60.0;
        for (speed, time) in
            [(1000.0, 0.3120), (3436.0, 1.0720), (6000.0, 2.1704), (8000.0, 3.4416), (12_000.0, 7.0736)]
        {
            let ramp = drives.spindle_ramp(0.0, speed * rpm);
            assert!((ramp - time).abs() < 1e-4, "{speed} rpm: {ramp}");
        }
        assert!((drives.spindle_ramp(12_000.0 * rpm, 0.0) - 7.9958).abs() < 1e-3);
    }
}
