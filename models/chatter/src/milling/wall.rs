//! Roughness of the wall that a milling cut leaves, from the paths of its edges.
//!
//! The wall is what no edge has reached: at every place along the feed the farthest of all passages counts. It has the cusps of the
//! feed, the marks of the vibration between them and, with runout, of the teeth that reach farthest. It is taken at the foot of the
//! wall, where the error of the surface location is.

use super::{Direction, Forced, Milling};
use crate::Simulation;
use crate::error::ChatterError;
use crate::milling::engagement::Geometry;
use std::f64::consts::{PI, TAU};

/// Points of the path of an edge (count). Assumption: four times as many change Ra by less than 1 %.
const POINTS: usize = 400;
/// Places along the wall to a feed per tooth (count). Assumption: as of the points.
const PLACES: usize = 60;
/// Greatest number of places along a wall, of a long simulation (count). Assumption: enough for five sampling lengths.
const MOST_PLACES: usize = 20_000;
/// Sampling lengths over which Ra and Rz are means, as ISO 21920 has them.
const LENGTHS: usize = 5;
/// Angle (rad) about the wall beyond which no part of a path is left on it (assumption: cusps are far shorter).
const WIDEST: f64 = 0.5;

/// Roughness of a profile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Roughness {
    /// Mean deviation from the mean line (m).
    pub ra: f64,
    /// Greatest height (m), of sampling lengths the mean.
    pub rz: f64,
}

impl Roughness {
    fn of(profile: &[f64]) -> Self {
        let mean = profile.iter().sum::<f64>() / profile.len() as f64;
        let ra = profile.iter().map(|height| (height - mean).abs()).sum::<f64>() / profile.len() as f64;
        let rz = profile.iter().copied().fold(f64::MIN, f64::max) - profile.iter().copied().fold(f64::MAX, f64::min);
        Self { ra, rz }
    }
}

/// A stretch of wall: where it begins along the feed (m), its length (m), and the passages of teeth that shape it.
struct Stretch {
    from: f64,
    length: f64,
    places: usize,
    passages: std::ops::Range<i64>,
}

impl Milling {
    /// Roughness of the wall of a stable cut at `depth` (m) with its forced vibration; none without feed, and of a cut that is not
    /// as deep as its corner.
    ///
    /// # Errors
    /// As [`Milling::forced`].
    pub fn forced_roughness(&self, depth: f64, forced: &Forced) -> Result<Option<Roughness>, ChatterError> {
        if self.feed_per_tooth <= 0.0 || depth <= self.cutter.corner_radius {
            return Ok(None);
        }
        let geometry = Geometry::new(self, depth, false)?;
        let samples = forced.displacement.len() as f64;
        let at = |angle: f64| {
            let place = ((angle - geometry.origin) / geometry.span).rem_euclid(1.0) * samples;
            between(&forced.displacement, place, true)
        };
        let reach = self.reach(forced.peak_to_peak[1]);
        let teeth = self.cutter.teeth as i64;
        let around = (reach / self.feed_per_tooth).ceil() as i64 + teeth + 1;
        // Of equal teeth one feed is like the next.
        let repeated = if self.cutter.is_regular() { 1 } else { teeth };
        let stretch = Stretch {
            from: self.feed_per_angle() * self.passage(0, depth),
            length: self.feed_per_tooth * repeated as f64,
            places: PLACES * 4 * repeated as usize,
            passages: -around..around + repeated,
        };
        Ok(Some(Roughness::of(&self.wall_profile(&stretch, depth, reach, &at))))
    }

    /// Roughness of the wall of a simulated cut at `depth` (m), over five sampling lengths; none with runout, and where the record is
    /// too short.
    pub fn simulated_roughness(&self, depth: f64, run: &Simulation, steps: usize) -> Option<Roughness> {
        let periods = (run.displacement.len() / steps.max(1)) as i64;
        if self.feed_per_tooth <= 0.0 || depth <= self.cutter.corner_radius || self.cutter.runout > 0.0 {
            return None;
        }
        let step_angle = TAU / (self.cutter.teeth * steps) as f64;
        let at = |angle: f64| between(&run.displacement, (angle - self.engagement.entry) / step_angle, false);
        let reach = self.reach(run.peak_to_peak(1));
        let around = (reach / self.feed_per_tooth).ceil() as i64 + 2;
        // The passages whose neighbours are in the record too.
        let lag = (self.passage(0, depth) - self.engagement.entry) / (step_angle * steps as f64);
        let (first, last) = (around - lag.floor() as i64, periods - around - lag.ceil() as i64 - 1);
        let count = last - first;
        if count < LENGTHS as i64 {
            return None;
        }
        let stretch = Stretch {
            from: self.feed_per_angle() * self.passage(first, depth),
            length: self.feed_per_tooth * count as f64,
            places: (PLACES * count as usize).min(MOST_PLACES),
            passages: first - around..last + around,
        };
        let profile = self.wall_profile(&stretch, depth, reach, &at);
        let lengths: Vec<Roughness> = profile.chunks_exact(profile.len() / LENGTHS).map(Roughness::of).collect();
        let mean = |of: fn(&Roughness) -> f64| lengths.iter().map(of).sum::<f64>() / lengths.len() as f64;
        Some(Roughness { ra: mean(|length| length.ra), rz: mean(|length| length.rz) })
    }

    /// Feed to an angle of the spindle (m/rad).
    fn feed_per_angle(&self) -> f64 {
        self.feed_per_tooth * self.cutter.teeth as f64 / TAU
    }

    /// Angle of tooth 0 at its tip (rad) at which a passage leaves the foot of the wall, counted on over revolutions.
    fn passage(&self, number: i64, depth: f64) -> f64 {
        let teeth = self.cutter.teeth as i64;
        let tooth = number.rem_euclid(teeth) as usize;
        self.wall(depth) - self.cutter.offsets()[tooth] + TAU * number.div_euclid(teeth) as f64
    }

    /// How far beside its passage (m) a path of this range across the wall (m) can be left.
    fn reach(&self, range: f64) -> f64 {
        let radius = 0.5 * self.cutter.diameter;
        let deep = (2.0 * radius * (range + 2.0 * self.cutter.runout)).sqrt();
        (1.5 * self.feed_per_tooth * self.cutter.teeth as f64).max(1.2 * deep).min(radius * WIDEST.sin())
    }

    /// Heights of the wall (m) over a stretch of the feed, towards the work.
    fn wall_profile(&self, stretch: &Stretch, depth: f64, reach: f64, at: &dyn Fn(f64) -> [f64; 2]) -> Vec<f64> {
        let Stretch { from, length, places, passages } = stretch;
        let (radius, feed) = (0.5 * self.cutter.diameter, self.feed_per_angle());
        let (leaving, side) = if self.direction() == Direction::Up { (0.0, 1.0) } else { (PI, -1.0) };
        let widest = (reach / radius).min(1.0).asin();
        let cell = length / *places as f64;
        let mut wall = vec![f64::NEG_INFINITY; *places];
        for number in passages.clone() {
            let tooth = number.rem_euclid(self.cutter.teeth as i64) as usize;
            let (middle, radius_of_tooth) = (self.passage(number, depth), radius + self.cutter.extra_radius(tooth));
            let mut before: Option<(f64, f64)> = None;
            for i in 0..=POINTS {
                let turn = widest * (2.0 * i as f64 / POINTS as f64 - 1.0);
                let (sine, cosine) = (leaving + turn).sin_cos();
                let [x, y] = at(middle + turn);
                let place = (feed * (middle + turn) + radius_of_tooth * sine + x - from) / cell - 0.5;
                let height = side * (radius_of_tooth * cosine + y) - radius;
                if let Some((last, last_height)) = before {
                    raise(&mut wall, (last, last_height), (place, height));
                }
                before = Some((place, height));
            }
        }
        wall
    }
}

/// Raises the places between two points of a path to the line between them.
fn raise(wall: &mut [f64], one: (f64, f64), other: (f64, f64)) {
    let (left, right) = if one.0 <= other.0 { (one, other) } else { (other, one) };
    if right.0 < 0.0 || left.0 > wall.len() as f64 || right.0 <= left.0 {
        return;
    }
    let slope = (right.1 - left.1) / (right.0 - left.0);
    let (first, end) = (left.0.max(0.0).ceil() as usize, (right.0.floor() + 1.0).min(wall.len() as f64) as usize);
    for (place, height) in wall.iter_mut().enumerate().take(end).skip(first) {
        *height = height.max(left.1 + slope * (place as f64 - left.0));
    }
}

/// A displacement between two samples; beyond the record that of its end, or of its beginning where it repeats.
fn between(samples: &[[f64; 2]], place: f64, repeats: bool) -> [f64; 2] {
    let (count, floor) = (samples.len(), place.max(0.0).floor());
    let index = |i: usize| if repeats { i % count } else { i.min(count - 1) };
    let (one, other) = (samples[index(floor as usize)], samples[index(floor as usize + 1)]);
    let share = (place - floor).clamp(0.0, 1.0);
    [one[0] + share * (other[0] - one[0]), one[1] + share * (other[1] - one[1])]
}
