//! The spindle beside the axes: it ramps while they move, and some blocks wait for it.

use crate::record::Drives;
use std::f64::consts::TAU;
use toolroom_program::Sense;

/// What the spindle has been told, and when it will be there.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Spindle {
    /// Commanded speed, rad/s, negative to the left.
    speed: f64,
    /// Time at which the real spindle turns as commanded, s.
    ready: f64,
    /// Whether the next motion at feed has to wait for it.
    pub pending: bool,
}

/// Commanded speed, rad/s, negative to the left.
fn signed(speed: f64, sense: Sense) -> f64 {
    let speed = speed * TAU / 60.0;
    match sense {
        Sense::Clockwise => speed,
        Sense::Counterclockwise => -speed,
        Sense::Still | Sense::Oriented => 0.0,
    }
}

impl Spindle {
    /// Takes a command of `speed`, rpm, at the time `now`, s. In a rigid tap it turns back with the axis: the time that this
    /// takes is returned, s.
    pub fn command(&mut self, drives: &Drives, (speed, sense): (f64, Sense), now: f64, tapping: bool) -> f64 {
        let target = signed(speed, sense);
        if target == self.speed {
            return 0.0;
        }
        if tapping && target == -self.speed {
            self.speed = target;
            return drives.tap_reversal(target.abs());
        }
        // A ramp that is not over yet is run to its end first (assumption).
        self.ready = self.ready.max(now) + drives.spindle_ramp(self.speed, target);
        self.speed = target;
        self.pending = target != 0.0;
        0.0
    }

    /// The machine brakes the spindle by itself, as for a tool change.
    pub fn brake(&mut self, drives: &Drives, now: f64) {
        self.command(drives, (0.0, Sense::Still), now, false);
    }

    pub fn stands(&self) -> bool {
        self.speed == 0.0
    }

    /// Time until it turns as commanded, s, after which nothing waits for it any more.
    pub fn wait(&mut self, now: f64) -> f64 {
        self.pending = false;
        (self.ready - now).max(0.0)
    }
}
