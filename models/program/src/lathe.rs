//! Feed per revolution at constant surface speed.

use crate::error::Fault;
use crate::motion::{Arc, Axes, Motion, Path, Purpose};
use std::f64::consts::TAU;

/// Pieces of an arc over which the radius counts as linear: their error is below 1e-6 of the time.
const PIECES: usize = 256;

/// Time of a motion with `feed` mm a revolution at `surface` mm/min and at most `clamp` rpm, s.
///
/// On a line at radius `r` the spindle turns `surface/(2π r)` a minute, so that
/// `t = ∫ 2π r/(feed·surface) dl`, and `l/(feed·clamp)` below the radius at which the clamp acts.
pub(crate) fn surface_time(
    start: &Axes,
    end: &Axes,
    arc: Option<&Arc>,
    length: f64,
    feed: f64,
    surface: f64,
    clamp: f64,
) -> Result<f64, Fault> {
    if surface <= 0.0 {
        return Err(Fault::new("a constant surface speed of zero: write S behind G96"));
    }
    let line = |a: f64, b: f64, length: f64| -> f64 {
        // Where the path crosses the axis both sides count by their distance from it.
        if a * b < 0.0 {
            let share = a / (a - b);
            return revolutions(a.abs(), 0.0, share * length, surface, clamp)
                + revolutions(0.0, b.abs(), (1.0 - share) * length, surface, clamp);
        }
        revolutions(a.abs(), b.abs(), length, surface, clamp)
    };
    let minutes = match arc {
        None => line(start[0], end[0], length),
        Some(arc) => {
            let path = Path::Arc(*arc);
            let motion = Motion {
                rapid: false,
                path,
                start: *start,
                end: *end,
                time: 0.0,
                length,
                unknown: false,
                purpose: Purpose::Cut,
            };
            let radius = |i: usize| motion.position(i as f64 / PIECES as f64)[0];
            (0..PIECES).map(|i| line(radius(i), radius(i + 1), length / PIECES as f64)).sum()
        }
    };
    let time = 60.0 * minutes / feed;
    if time.is_finite() {
        Ok(time)
    } else {
        Err(Fault::new(
            "constant surface speed up to the axis needs a greatest speed: write G50 S, or D of G96 on LinuxCNC, before",
        ))
    }
}

/// ∫ dl/n over a line from radius `a` to `b`, mm·min.
fn revolutions(a: f64, b: f64, length: f64, surface: f64, clamp: f64) -> f64 {
    let (low, high) = (a.min(b), a.max(b));
    let bound = if clamp.is_finite() { surface / (TAU * clamp) } else { 0.0 };
    if high <= bound {
        // On the axis nothing but a greatest speed ends the speed.
        return if clamp.is_finite() || length == 0.0 { length / clamp } else { f64::INFINITY };
    }
    let free = |from: f64, to: f64, length: f64| TAU * 0.5 * (from + to) * length / surface;
    if low >= bound || high == low {
        return free(low, high, length);
    }
    let share = (high - bound) / (high - low);
    free(bound, high, share * length) + (1.0 - share) * length / clamp
}
