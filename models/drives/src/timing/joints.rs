//! Speeds at the corners between motions, as far as the control looks ahead.

use super::Step;
use crate::record::Drives;

/// Speed at the corner between two motions, m/s.
fn corner(previous: &Step, following: &Step, drives: &Drives) -> f64 {
    let top = previous.top.min(following.top);
    if drives.corner_step > 0.0 {
        let change = previous.end.iter().zip(following.start).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        return top.min(drives.corner_step / change.max(1e-12));
    }
    let dot: f64 = previous.end.iter().zip(following.start).map(|(a, b)| a * b).sum();
    if drives.corner_cosine >= 0.5 {
        return top * dot.clamp(0.0, 1.0);
    }
    let half = (0.5 * (1.0 + dot.clamp(-1.0, 1.0))).sqrt();
    // Without a turn the speed is that of the motions, whatever the rounding of `half`.
    let acceleration = 1.0 / drives.inverse_acceleration;
    top.min((acceleration * drives.corner_deviation * half / (1.0 - half).max(1e-15)).sqrt())
}

/// Whether a motion goes on at the speed of the one before it without slowing down between them.
pub(super) fn smooth(previous: &Step, following: &Step, drives: &Drives) -> bool {
    (previous.top - following.top).abs() <= 1e-9 * previous.top
        && corner(previous, following, drives) >= previous.top * (1.0 - 1e-9)
}

/// Speeds before each step and behind the last, m/s, and whether the look-ahead holds them below the speed of the step.
pub(super) fn joints(steps: &[Step], entry: f64, drives: &Drives) -> (Vec<f64>, Vec<bool>) {
    let acceleration = 1.0 / drives.inverse_acceleration;
    let mut joints = vec![0.0; steps.len() + 1];
    let mut short_sighted = vec![false; steps.len() + 1];
    joints[0] = entry;
    for i in 1..steps.len() {
        joints[i] = corner(&steps[i - 1], &steps[i], drives);
    }
    let reach = |speed: f64, way: f64| (speed * speed + 2.0 * acceleration * way).sqrt();
    if drives.look_ahead >= 1.0 {
        // What lies beyond the look-ahead may be a stop.
        let ahead = drives.look_ahead as usize;
        let mut ways = vec![0.0; steps.len() + 1];
        for (i, step) in steps.iter().enumerate() {
            ways[i + 1] = ways[i] + step.way;
        }
        for i in 1..steps.len() {
            let seen = (i + ahead - 1).min(steps.len());
            let speed = reach(0.0, ways[seen] - ways[i]);
            // What is known to be the last step needs no foresight.
            short_sighted[i] = seen < steps.len() && speed < joints[i];
            joints[i] = joints[i].min(speed);
        }
    }
    for i in (1..steps.len()).rev() {
        joints[i] = joints[i].min(reach(joints[i + 1], steps[i].way));
    }
    for i in 0..steps.len() {
        joints[i + 1] = joints[i + 1].min(reach(joints[i], steps[i].way));
    }
    (joints, short_sighted)
}
