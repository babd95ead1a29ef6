//! Distances from a section, with what they need of it worked out once.

use crate::{Point, Section};
use std::f64::consts::{FRAC_PI_2, PI};

/// A section of which many distances are asked, as a rim that moves along it does.
///
/// ```
/// use toolroom_contour::{Point, Section, Track};
/// let wall = Section { start: Point::default(), heading: 0.0, length: 0.1, curvature: 0.0, arc_angle: 0.0 };
/// let track = Track::new(wall);
/// assert_eq!(track.distance(Point { x: 0.05, y: -0.002 }), 0.002);
/// assert!(track.reaches(Point { x: 0.103, y: 0.0 }, 0.004) && !track.reaches(Point { x: 0.105, y: 0.0 }, 0.004));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Track {
    section: Section,
    end: Point,
    /// Sine and cosine of its heading at the start.
    pub(crate) along: (f64, f64),
    /// Sine and cosine of the direction to the left of it.
    left: (f64, f64),
    circle: Option<Circle>,
}

/// The circle of an arc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Circle {
    pub centre: Point,
    /// m.
    pub radius: f64,
    /// Cosine and sine of the direction from the centre to the middle of the arc.
    middle: (f64, f64),
    /// Cosine of half of its sweep: directions from the centre that are nearer to the middle lead to the arc.
    widest: f64,
}

impl Track {
    /// Of a section.
    pub fn new(section: Section) -> Self {
        let left = (section.heading + FRAC_PI_2).sin_cos();
        let circle = (section.curvature != 0.0).then(|| {
            let centre = beside(section.start, left, 1.0 / section.curvature);
            let radius = 1.0 / section.curvature.abs();
            let half = 0.5 * section.sweep();
            let outwards = if half > 0.0 { -FRAC_PI_2 } else { FRAC_PI_2 };
            let (sin, cos) = (section.heading + half + outwards).sin_cos();
            Circle { centre, radius, middle: (cos, sin), widest: half.abs().min(PI).cos() }
        });
        Self { section, end: section.end(), along: section.heading.sin_cos(), left, circle }
    }

    /// The section.
    pub fn section(&self) -> &Section {
        &self.section
    }

    /// Point at its end.
    pub fn end(&self) -> Point {
        self.end
    }

    /// The circle of an arc; `None` on a line.
    pub(crate) fn circle(&self) -> Option<&Circle> {
        self.circle.as_ref()
    }

    /// The point `away`, m, to the left of the start.
    pub(crate) fn left_of_start(&self, away: f64) -> Point {
        beside(self.section.start, self.left, away)
    }

    /// Distance of a point, m.
    #[inline]
    pub fn distance(&self, point: Point) -> f64 {
        let Section { start, length, .. } = self.section;
        let (dx, dy) = (point.x - start.x, point.y - start.y);
        let Some(circle) = &self.circle else {
            let (sin, cos) = self.along;
            let ahead = dx * cos + dy * sin;
            return if ahead < 0.0 {
                (dx * dx + dy * dy).sqrt()
            } else if ahead > length {
                square_to(self.end, point).sqrt()
            } else {
                (dy * cos - dx * sin).abs()
            };
        };
        let (x, y) = (point.x - circle.centre.x, point.y - circle.centre.y);
        let away = (x * x + y * y).sqrt();
        if x * circle.middle.0 + y * circle.middle.1 >= away * circle.widest {
            return (away - circle.radius).abs();
        }
        (dx * dx + dy * dy).min(square_to(self.end, point)).sqrt()
    }

    /// Whether a point is nearer than `reach`, m.
    #[inline]
    pub fn reaches(&self, point: Point, reach: f64) -> bool {
        let (dx, dy) = (point.x - self.section.start.x, point.y - self.section.start.y);
        // Nothing of a section is farther from its start than it is long; the margin is above rounding.
        let farthest = (self.section.length + reach) * (1.0 + 1e-9);
        dx * dx + dy * dy <= farthest * farthest && self.distance(point) < reach
    }
}

/// Square of the distance of two points, m².
fn square_to(from: Point, to: Point) -> f64 {
    let (x, y) = (to.x - from.x, to.y - from.y);
    x * x + y * y
}

fn beside(start: Point, (sin, cos): (f64, f64), away: f64) -> Point {
    Point { x: start.x + away * cos, y: start.y + away * sin }
}

/// Distance of a point from a section, m. Of many points a [`Track`] tells it faster.
pub fn distance(section: &Section, point: Point) -> f64 {
    Track::new(*section).distance(point)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// The nearest of many points of a section is as far as the distance says.
        #[test]
        fn a_distance_is_that_of_the_nearest_point(
            x in -2.0..2.0f64, y in -2.0..2.0f64, heading in -4.0..4.0f64, sweep in -3.0..3.0f64, length in 0.01..2.0f64,
        ) {
            let curvature = if sweep.abs() < 0.1 { 0.0 } else { sweep / length };
            let section = Section { start: Point::default(), heading, length, curvature, arc_angle: sweep.abs() };
            let (track, point) = (Track::new(section), Point { x, y });
            let sampled = (0..=2000)
                .map(|i| section.at(length * f64::from(i) / 2000.0).distance(point))
                .fold(f64::INFINITY, f64::min);
            let distance = track.distance(point);
            prop_assert!(distance <= sampled + 1e-12 && sampled < distance + length / 2000.0, "{distance} {sampled}");
            for reach in [0.5 * distance, 0.999 * distance, 1.001 * distance, 2.0 * distance] {
                prop_assert_eq!(track.reaches(point, reach), distance < reach);
            }
        }
    }
}
