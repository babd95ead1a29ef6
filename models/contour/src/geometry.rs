//! Points, cutter sides, sections and corners of a contour.

use std::f64::consts::PI;

/// A point of the part plane, m.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Point {
    /// Along the machine's X axis.
    pub x: f64,
    /// Along the machine's Y axis.
    pub y: f64,
}

impl Point {
    /// The point `length` away in direction `heading` (rad from the X axis).
    ///
    /// ```
    /// use toolroom_contour::Point;
    /// let point = Point::default().ahead(std::f64::consts::FRAC_PI_2, 0.01);
    /// assert!((point.y - 0.01).abs() < 1e-15);
    /// ```
    pub fn ahead(self, heading: f64, length: f64) -> Self {
        let (sin, cos) = heading.sin_cos();
        Self { x: self.x + length * cos, y: self.y + length * sin }
    }

    /// Distance to another point.
    pub fn distance(self, other: Self) -> f64 {
        (other.x - self.x).hypot(other.y - self.y)
    }

    /// Direction towards another point, rad from the X axis.
    pub fn heading_to(self, other: Self) -> f64 {
        (other.y - self.y).atan2(other.x - self.x)
    }
}

/// An angle brought into (−π, π].
pub(crate) fn wrapped(angle: f64) -> f64 {
    let turn = angle.rem_euclid(2.0 * PI);
    if turn > PI { turn - 2.0 * PI } else { turn }
}

toolroom_form::vocabulary! {
    /// Side of the path, seen in the direction of travel, on which the cutter runs; the material is
    /// on the other one.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum CutterSide {
        /// Left, G41.
        Left = "left",
        /// Right, G42.
        Right = "right",
    }
}

impl CutterSide {
    /// +1 on the left, −1 on the right.
    pub fn sign(self) -> f64 {
        match self {
            Self::Left => 1.0,
            Self::Right => -1.0,
        }
    }

    /// The other side.
    pub fn other(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::Right => Self::Left,
        }
    }
}

/// Form of the wall under the cutter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// Straight wall.
    Straight,
    /// The wall bulges towards the cutter, with this radius, m.
    Convex(f64),
    /// The wall is hollow, with this radius, m.
    Concave(f64),
}

impl Shape {
    /// Signed curvature, 1/m: positive where convex.
    pub fn curvature(self) -> f64 {
        match self {
            Self::Straight => 0.0,
            Self::Convex(radius) => 1.0 / radius,
            Self::Concave(radius) => -1.0 / radius,
        }
    }

    /// Length of the cutter-centre path per length of wall, `(R ± R_f)/R`.
    ///
    /// ```
    /// use toolroom_contour::Shape;
    /// assert!((Shape::Concave(0.022).centre_path_ratio(0.016) - 6.0 / 22.0).abs() < 1e-15);
    /// ```
    pub fn centre_path_ratio(self, cutter_radius: f64) -> f64 {
        1.0 + cutter_radius * self.curvature()
    }

    /// Radius of the cutter-centre path, m; infinite on a straight wall.
    pub fn centre_radius(self, cutter_radius: f64) -> f64 {
        match self {
            Self::Straight => f64::INFINITY,
            Self::Convex(radius) => radius + cutter_radius,
            Self::Concave(radius) => radius - cutter_radius,
        }
    }

    /// Name in tables: `straight`, `convex`, `concave`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Straight => "straight",
            Self::Convex(_) => "convex",
            Self::Concave(_) => "concave",
        }
    }

    /// Radius, m; `None` on a straight wall.
    pub fn radius(self) -> Option<f64> {
        match self {
            Self::Straight => None,
            Self::Convex(radius) | Self::Concave(radius) => Some(radius),
        }
    }
}

/// A line or an arc of the wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Section {
    /// Where it starts.
    pub start: Point,
    /// Direction of travel at its start, rad from the X axis.
    pub heading: f64,
    /// Length along the wall, m.
    pub length: f64,
    /// Signed curvature, 1/m: positive where the path turns left, 0 on a line.
    pub curvature: f64,
    /// Angle of the arc of which this section is a part, rad; 0 on a line. The empirical path
    /// error depends on the whole arc, however finely it is divided.
    pub arc_angle: f64,
}

impl Section {
    /// The line or arc that leaves `start` along `heading` and runs to `end`.
    pub(crate) fn tangent(start: Point, heading: f64, end: Point) -> Self {
        let chord = start.distance(end);
        let half = wrapped(start.heading_to(end) - heading);
        // Below this the arc and its chord differ by less than rounding.
        if half.abs() < 1e-9 || chord == 0.0 {
            return Self { start, heading, length: chord, curvature: 0.0, arc_angle: 0.0 };
        }
        Self {
            start,
            heading,
            length: chord * half / half.sin(),
            curvature: 2.0 * half.sin() / chord,
            arc_angle: 2.0 * half.abs(),
        }
    }

    /// Angle by which the direction changes from start to end, rad, positive to the left.
    pub fn sweep(&self) -> f64 {
        self.length * self.curvature
    }

    /// Direction at the end, rad.
    pub fn end_heading(&self) -> f64 {
        self.heading + self.sweep()
    }

    /// Point at the end.
    pub fn end(&self) -> Point {
        self.at(self.length)
    }

    /// Point after `length` of wall.
    ///
    /// ```
    /// use std::f64::consts::PI;
    /// use toolroom_contour::{Point, Section};
    /// let start = Point::default();
    /// let half_turn = Section { start, heading: 0.0, length: PI * 0.01, curvature: 100.0, arc_angle: PI };
    /// assert!((half_turn.end().y - 0.02).abs() < 1e-15);
    /// ```
    pub fn at(&self, length: f64) -> Point {
        let half = 0.5 * length * self.curvature;
        let chord = if half.abs() < 1e-9 { length } else { length * half.sin() / half };
        self.start.ahead(self.heading + half, chord)
    }

    /// The same section travelled the other way.
    pub fn reversed(&self) -> Self {
        Self { start: self.end(), heading: wrapped(self.end_heading() + PI), curvature: -self.curvature, ..*self }
    }

    /// Shape of the wall for a cutter on `side`.
    pub fn shape(&self, side: CutterSide) -> Shape {
        if self.curvature == 0.0 {
            Shape::Straight
        } else if self.curvature * side.sign() < 0.0 {
            Shape::Convex(1.0 / self.curvature.abs())
        } else {
            Shape::Concave(1.0 / self.curvature.abs())
        }
    }
}

/// A sharp outside corner: the path's direction jumps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// Index of the section that ends in the corner.
    pub after: usize,
    /// Angle of the material, α, rad, between 0 and π.
    pub interior_angle: f64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_tangent_arc_meets_its_end(x in -1.0..1.0f64, y in -1.0..1.0f64, heading in -3.0..3.0f64) {
            let end = Point { x, y };
            prop_assume!(wrapped(Point::default().heading_to(end) - heading).abs() < 3.0);
            let section = Section::tangent(Point::default(), heading, end);
            prop_assert!(section.end().distance(end) < 1e-12);
            prop_assert!(section.reversed().end().distance(Point::default()) < 1e-12);
        }
    }

    #[test]
    fn the_same_arc_is_convex_to_one_side_and_concave_to_the_other() {
        let arc = Section {
            curvature: 50.0,
            length: 0.01,
            ..Section::tangent(Point::default(), 0.0, Point { x: 1.0, y: 0.0 })
        };
        assert_eq!(arc.shape(CutterSide::Right), Shape::Convex(0.02));
        assert_eq!(arc.shape(CutterSide::Left), Shape::Concave(0.02));
    }
}
