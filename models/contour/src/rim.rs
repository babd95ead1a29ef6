//! The rim of a cutter against regions around lines and arcs.

use crate::geometry::wrapped;
use crate::{Point, Track};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Angle, rad, below which a part of the rim is rounding.
pub(crate) const SLIVER: f64 = 1e-13;

/// The rim of a cutter seen along its axis; angles on it are rad from the X axis.
///
/// ```
/// use toolroom_contour::{Point, Rim};
/// let rim = Rim { centre: Point::default(), radius: 0.005 };
/// // In front of a shoulder of 1 mm: all that lies beyond 4 mm to the left.
/// let mut angles = vec![(0.8f64).asin(), std::f64::consts::PI - (0.8f64).asin()];
/// let front = (-std::f64::consts::FRAC_PI_2, std::f64::consts::PI);
/// let engaged = rim.intervals(front.0, front.1, &mut angles, |angle| rim.at(angle).y > 0.004);
/// let [(from, to)] = engaged[..] else { panic!("one interval") };
/// assert!(((to - from).to_degrees() - 36.869898).abs() < 1e-6);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rim {
    /// Centre of the cutter.
    pub centre: Point,
    /// Its radius, m.
    pub radius: f64,
}

impl Rim {
    /// The point of the rim at an angle.
    pub fn at(&self, angle: f64) -> Point {
        self.centre.ahead(angle, self.radius)
    }

    /// Adds the angles at which the rim crosses a circle.
    pub fn circle(&self, centre: Point, radius: f64, angles: &mut Vec<f64>) {
        let (x, y) = (centre.x - self.centre.x, centre.y - self.centre.y);
        let gap = (x * x + y * y).sqrt();
        if radius <= 0.0 || gap <= 0.0 {
            return;
        }
        let cos = (self.radius * self.radius + gap * gap - radius * radius) / (2.0 * self.radius * gap);
        if cos.abs() <= 1.0 {
            let (towards, half) = (y.atan2(x), cos.acos());
            angles.extend([towards - half, towards + half]);
        }
    }

    /// Adds the angles at which the rim crosses a straight line through `point` along `heading`.
    pub fn line(&self, point: Point, heading: f64, angles: &mut Vec<f64>) {
        self.line_along(point, heading, heading.sin_cos(), angles);
    }

    fn line_along(&self, point: Point, heading: f64, (sin, cos): (f64, f64), angles: &mut Vec<f64>) {
        let left = (point.y - self.centre.y) * cos - (point.x - self.centre.x) * sin;
        if left.abs() <= self.radius {
            let half = (left / self.radius).acos();
            angles.extend([heading + FRAC_PI_2 - half, heading + FRAC_PI_2 + half]);
        }
    }

    /// Adds the angles at which the rim may enter or leave the region within `reach`, m, of a section.
    pub fn crossings(&self, track: &Track, reach: f64, angles: &mut Vec<f64>) {
        let section = track.section();
        self.circle(section.start, reach, angles);
        self.circle(track.end(), reach, angles);
        match track.circle() {
            Some(circle) => {
                self.circle(circle.centre, circle.radius + reach, angles);
                self.circle(circle.centre, circle.radius - reach, angles);
            }
            None => {
                for side in [reach, -reach] {
                    self.line_along(track.left_of_start(side), section.heading, track.along, angles);
                }
            }
        }
    }

    /// Intervals of the angles from `start` over `span`, rad, in which `inside` holds, each as its start and end; it changes
    /// only at `angles`, which are used up.
    pub fn intervals(
        &self,
        start: f64,
        span: f64,
        angles: &mut Vec<f64>,
        inside: impl Fn(f64) -> bool,
    ) -> Vec<(f64, f64)> {
        let mut list: Vec<(f64, f64)> = Vec::new();
        self.parts(start, span, angles, |low, high| {
            let (low, high) = (start + low, start + high);
            if inside(0.5 * (low + high)) {
                match list.last_mut() {
                    Some(last) if low - last.1 < 1e-12 => last.1 = high,
                    _ => list.push((low, high)),
                }
            }
        });
        list
    }

    /// Hands on the parts between neighbouring `angles`, from `start` over `span`, each by its start and end after `start`.
    pub(crate) fn parts(&self, start: f64, span: f64, angles: &mut Vec<f64>, mut part: impl FnMut(f64, f64)) {
        for angle in angles.iter_mut() {
            *angle = (*angle - start).rem_euclid(TAU);
        }
        angles.retain(|angle| *angle < span);
        angles.extend([0.0, span]);
        angles.sort_by(f64::total_cmp);
        for pair in angles.windows(2) {
            if pair[1] - pair[0] > SLIVER {
                part(pair[0], pair[1]);
            }
        }
        angles.clear();
    }
}

/// The direction against another one, rad in (−π, π].
pub(crate) fn opposite(heading: f64) -> f64 {
    wrapped(heading + PI)
}
