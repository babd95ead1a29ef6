//! A pen that draws a contour section by section.

use crate::geometry::wrapped;
use crate::{Contour, ContourError, Corner, CutterSide, Point, Section, spline};
use std::f64::consts::PI;

/// Distance within which a contour counts as closed and an arc as meeting its end, m: ten times
/// the resolution of part programs (assumption).
pub const POSITION_TOLERANCE: f64 = 5e-6;

/// Change of direction from which a joint is a corner, rad: half a degree (assumption). Below
/// it, joints are taken as tangent; coordinates rounded to 1 µm stay well below.
pub const CORNER_ANGLE: f64 = 0.5 * PI / 180.0;

/// Most sections of one profile.
const GREATEST_DIVISION: u32 = 1_000_000;

/// Greatest turn: beyond it the path comes back on itself.
const GREATEST_TURN: f64 = PI - 2.0 * CORNER_ANGLE;

/// Draws a contour: where the pen stands, where it heads, what it has drawn.
///
/// # Examples
/// ```
/// use std::f64::consts::FRAC_PI_2;
/// use toolroom_contour::{CutterSide, Point, Trace};
/// let mut trace = Trace::new(Point::default(), 0.0);
/// for _ in 0..4 {
///     trace.line(0.02).unwrap();
///     trace.arc(0.01, FRAC_PI_2).unwrap();
/// }
/// let plate = trace.finish(CutterSide::Right, true).unwrap();
/// assert!((plate.length() - (0.08 + 0.02 * std::f64::consts::PI)).abs() < 1e-15);
/// ```
#[derive(Clone, Debug)]
pub struct Trace {
    pen: Point,
    heading: f64,
    sections: Vec<Section>,
}

impl Trace {
    /// A pen at `start` that heads in direction `heading`, rad from the X axis.
    pub fn new(start: Point, heading: f64) -> Self {
        Self { pen: start, heading, sections: Vec::new() }
    }

    /// Number of sections drawn so far.
    pub fn sections(&self) -> usize {
        self.sections.len()
    }

    /// Where the pen stands.
    pub fn position(&self) -> Point {
        self.pen
    }

    /// Turns the pen on the spot, left where positive: a corner.
    pub fn turn(&mut self, angle: f64) {
        self.heading += angle;
    }

    /// A line straight on.
    ///
    /// # Errors
    /// [`ContourError::NoLength`] unless `length` is positive and finite.
    pub fn line(&mut self, length: f64) -> Result<(), ContourError> {
        let end = self.pen.ahead(self.heading, length);
        self.push(Section { start: self.pen, heading: self.heading, length, curvature: 0.0, arc_angle: 0.0 }, end)
    }

    /// A line to a point.
    ///
    /// # Errors
    /// [`ContourError::NoLength`] where the pen is there already.
    pub fn line_to(&mut self, end: Point) -> Result<(), ContourError> {
        let heading = self.pen.heading_to(end);
        self.push(Section::tangent(self.pen, heading, end), end)
    }

    /// An arc that goes on tangentially, left where `angle` is positive.
    ///
    /// # Errors
    /// [`ContourError::NoLength`] unless radius and angle span a length.
    pub fn arc(&mut self, radius: f64, angle: f64) -> Result<(), ContourError> {
        let section = Section {
            start: self.pen,
            heading: self.heading,
            length: radius * angle.abs(),
            curvature: angle.signum() / radius,
            arc_angle: angle.abs(),
        };
        self.push(section, section.end())
    }

    /// An arc around `center` to `end`, to the left or to the right; a full circle where the
    /// pen is at `end` already.
    ///
    /// # Errors
    /// [`ContourError::ArcMissesEnd`] where `end` does not lie on the circle.
    pub fn arc_to(&mut self, end: Point, center: Point, left: bool) -> Result<(), ContourError> {
        let radius = center.distance(self.pen);
        let gap = (center.distance(end) - radius).abs();
        if misses(gap) {
            return Err(ContourError::ArcMissesEnd { section: self.sections.len(), gap });
        }
        let side = if left { 1.0 } else { -1.0 };
        let heading = center.heading_to(self.pen) + side * 0.5 * PI;
        let turned = side * (center.heading_to(end) - center.heading_to(self.pen));
        let full = self.pen.distance(end) <= 1e-9;
        let angle = if full { 2.0 * PI } else { turned.rem_euclid(2.0 * PI) };
        let section =
            Section { start: self.pen, heading, length: radius * angle, curvature: side / radius, arc_angle: angle };
        self.push(section, end)
    }

    /// An arc of `radius` to `end`: the shorter way, or the longer one where `radius` is
    /// negative (the convention of R in G2 and G3).
    ///
    /// # Errors
    /// [`ContourError::ArcMissesEnd`] where the end lies farther than the diameter.
    pub fn arc_by_radius(&mut self, end: Point, radius: f64, left: bool) -> Result<(), ContourError> {
        let half = 0.5 * self.pen.distance(end);
        let gap = 2.0 * (half - radius.abs());
        if misses(gap) {
            return Err(ContourError::ArcMissesEnd { section: self.sections.len(), gap });
        }
        let height = (radius * radius - half * half).max(0.0).sqrt();
        let side = if left == (radius > 0.0) { 1.0 } else { -1.0 };
        let middle = Point { x: 0.5 * (self.pen.x + end.x), y: 0.5 * (self.pen.y + end.y) };
        let center = middle.ahead(self.pen.heading_to(end) + 0.5 * PI, side * height);
        self.arc_to(end, center, left)
    }

    /// A smooth curve through `points`, cut into tangent arcs within 1 µm: the interpolating
    /// cubic spline over chord length, periodic where it alone closes the contour, natural
    /// otherwise. The natural arc of a section is the run of one sign of curvature around it.
    /// The greatest distance of the curve from the arcs is returned, m.
    ///
    /// # Errors
    /// [`ContourError::NoLength`] where two successive points coincide.
    pub fn spline_to(&mut self, points: &[Point]) -> Result<f64, ContourError> {
        let mut through = vec![self.pen];
        through.extend_from_slice(points);
        let periodic = self.sections.is_empty() && points.last().is_some_and(|last| last.distance(self.pen) <= 1e-9);
        if through.len() < 2 || through.windows(2).any(|pair| !is_length(pair[0].distance(pair[1]))) {
            return Err(ContourError::NoLength { section: self.sections.len() });
        }
        let (arcs, residual) = spline::arcs(&through, periodic);
        for mut section in arcs {
            // The fit already set the natural arc.
            section.heading = wrapped(section.heading);
            let end = section.end();
            self.push(section, end)?;
        }
        if let Some(last) = through.last() {
            self.pen = *last;
        }
        Ok(residual)
    }

    /// A closed hole or disc of equal width: support function
    /// `h(φ) = diameter/2 − eccentricity·cos(lobes·φ)`, hence radius of curvature
    /// `diameter/2 + (lobes² − 1)·eccentricity·cos(lobes·φ)`, as `sections` arcs of the mean
    /// radius, as in the paper: 18 of them are off the profile RK-3 by ±324 um about the best fit ([`Trace::lobed_within`] is not). The natural arc is the angle from one extreme of curvature to the next.
    ///
    /// # Errors
    /// [`ContourError::NoLength`] where the eccentricity is so great that a radius vanishes,
    /// [`ContourError::Division`] for fewer than 3 sections or more than a million.
    ///
    /// # Source
    /// Support function of the RK/P3G profile, Lukin's "RK-3 profile hole" (reading of the scan).
    pub fn lobed(&mut self, diameter: f64, eccentricity: f64, lobes: u32, sections: u32) -> Result<(), ContourError> {
        if !(3..=GREATEST_DIVISION).contains(&sections) {
            return Err(ContourError::Division { sections, greatest: GREATEST_DIVISION });
        }
        let m = f64::from(lobes);
        let step = 2.0 * PI / f64::from(sections);
        let amplitude = (m * m - 1.0) * eccentricity;
        for i in 0..sections {
            let (from, to) = (f64::from(i) * step, f64::from(i + 1) * step);
            let mean_cos = ((m * to).sin() - (m * from).sin()) / (m * step);
            let radius = 0.5 * diameter + amplitude * mean_cos;
            if !is_length(radius) {
                return Err(ContourError::NoLength { section: self.sections.len() });
            }
            self.arc(radius, step)?;
            self.natural_arc(PI / m);
        }
        Ok(())
    }

    /// Sections from number `start` on.
    pub(crate) fn drawn(&self, start: usize) -> &[Section] {
        &self.sections[start..]
    }

    /// Says of which arc the last section is a part, rad.
    pub(crate) fn natural_arc(&mut self, angle: f64) {
        if let Some(section) = self.sections.last_mut() {
            section.arc_angle = angle;
        }
    }

    fn push(&mut self, section: Section, end: Point) -> Result<(), ContourError> {
        if !is_length(section.length) || !section.curvature.is_finite() {
            return Err(ContourError::NoLength { section: self.sections.len() });
        }
        self.heading = section.end_heading();
        self.pen = end;
        self.sections.push(section);
        Ok(())
    }

    /// The contour drawn, for a cutter on `side`.
    ///
    /// # Errors
    /// [`ContourError::Empty`], [`ContourError::Open`] where a closed contour does not come
    /// back to its start, [`ContourError::SharpInsideCorner`] where the path jumps towards the
    /// cutter, [`ContourError::Reversal`] where it comes back on itself.
    pub fn finish(self, side: CutterSide, closed: bool) -> Result<Contour, ContourError> {
        let (Some(first), Some(last)) = (self.sections.first(), self.sections.last()) else {
            return Err(ContourError::Empty);
        };
        if closed {
            self.closes(first)?;
        }
        let mut joints: Vec<(usize, f64)> = (self.sections.windows(2).enumerate())
            .map(|(i, pair)| (i, wrapped(pair[1].heading - pair[0].end_heading())))
            .collect();
        if closed {
            joints.push((self.sections.len() - 1, wrapped(first.heading - last.end_heading())));
        }
        let mut corners = Vec::new();
        for (after, turn) in joints.iter().copied() {
            if turn.abs() <= CORNER_ANGLE {
                continue;
            }
            if turn.abs() > GREATEST_TURN {
                return Err(ContourError::Reversal { section: after });
            }
            if turn * side.sign() > 0.0 {
                return Err(ContourError::SharpInsideCorner { section: after, angle: PI - turn.abs() });
            }
            corners.push(Corner { after, interior_angle: PI - turn.abs() });
        }
        let mut sections = self.sections;
        merge_arcs(&mut sections, &joints);
        Ok(Contour { sections, corners, side, closed })
    }

    /// The closed outline drawn, along which no cutter runs: its corners may be of any kind.
    ///
    /// # Errors
    /// [`ContourError::Empty`], and [`ContourError::Open`] where it does not come back to its start.
    pub fn outline(self) -> Result<Vec<Section>, ContourError> {
        self.closes(self.sections.first().ok_or(ContourError::Empty)?)?;
        Ok(self.sections)
    }

    /// Refuses what does not come back to its first section.
    fn closes(&self, section: &Section) -> Result<(), ContourError> {
        let gap = self.pen.distance(section.start);
        if misses(gap) { Err(ContourError::Open { gap }) } else { Ok(()) }
    }
}

/// Whether a gap is one; a gap that is not a number is.
fn misses(gap: f64) -> bool {
    gap.is_nan() || gap > POSITION_TOLERANCE
}

/// Whether a number is a length worth drawing.
fn is_length(value: f64) -> bool {
    value > 1e-9 && value.is_finite()
}

/// Arcs that were drawn in pieces count as one: neighbours that join smoothly with one
/// curvature share the angle of the whole.
fn merge_arcs(sections: &mut [Section], joints: &[(usize, f64)]) {
    let whole = |section: &Section| section.curvature != 0.0 && section.arc_angle == section.sweep().abs();
    let same = |a: &Section, b: &Section| (a.curvature - b.curvature).abs() <= 1e-6 * a.curvature.abs();
    let mut start = 0;
    while start < sections.len() {
        let mut end = start + 1;
        while end < sections.len()
            && whole(&sections[start])
            && whole(&sections[end])
            && same(&sections[start], &sections[end])
            && joints[end - 1].1.abs() <= CORNER_ANGLE
        {
            end += 1;
        }
        if end > start + 1 {
            let total: f64 = sections[start..end].iter().map(|section| section.sweep().abs()).sum();
            for section in &mut sections[start..end] {
                section.arc_angle = total.min(2.0 * PI);
            }
        }
        start = end;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(x: f64, y: f64) -> Point {
        Point { x, y }
    }

    #[test]
    fn an_arc_that_misses_its_end_is_refused() {
        let mut trace = Trace::new(point(0.0, 0.0), 0.0);
        let missed = trace.arc_to(point(0.02, 0.001), point(0.01, 0.0), true);
        assert!(matches!(missed, Err(ContourError::ArcMissesEnd { section: 0, gap }) if gap > 40e-6), "{missed:?}");
        assert!(trace.arc_by_radius(point(0.02, 0.0), 0.009, true).is_err());
        assert!(trace.arc_to(point(0.02, 0.0), point(0.01, 0.0), true).is_ok());
    }

    #[test]
    fn radius_and_center_describe_the_same_arc() {
        for (radius, left) in [(0.015, true), (0.015, false), (-0.015, true), (-0.015, false)] {
            let mut by_radius = Trace::new(point(0.0, 0.0), 0.0);
            by_radius.arc_by_radius(point(0.02, 0.0), radius, left).unwrap();
            let arc = by_radius.sections[0];
            assert!(arc.end().distance(point(0.02, 0.0)) < 1e-12);
            assert_eq!(arc.curvature > 0.0, left);
            assert_eq!(arc.sweep().abs() > PI, radius < 0.0);
        }
    }

    #[test]
    fn an_open_contour_is_refused_where_a_closed_one_is_due() {
        let mut trace = Trace::new(point(0.0, 0.0), 0.0);
        trace.line(0.1).unwrap();
        trace.turn(2.0);
        trace.line(0.1).unwrap();
        assert!(matches!(trace.clone().finish(CutterSide::Right, true), Err(ContourError::Open { .. })));
        assert_eq!(trace.finish(CutterSide::Right, false).unwrap().corners.len(), 1);
    }

    #[test]
    fn a_sharp_inside_corner_cannot_be_milled() {
        let mut trace = Trace::new(point(0.0, 0.0), 0.0);
        trace.line(0.1).unwrap();
        trace.turn(1.0);
        trace.line(0.1).unwrap();
        let inside = trace.clone().finish(CutterSide::Left, false);
        assert!(matches!(inside, Err(ContourError::SharpInsideCorner { section: 0, .. })));
        trace.turn(PI);
        trace.line(0.1).unwrap();
        assert!(matches!(trace.finish(CutterSide::Right, false), Err(ContourError::Reversal { section: 1 })));
    }

    #[test]
    fn an_arc_drawn_in_pieces_counts_as_one() {
        let mut trace = Trace::new(point(0.0, 0.0), 0.0);
        trace.line(0.01).unwrap();
        for _ in 0..4 {
            trace.arc(0.02, 0.3).unwrap();
        }
        let contour = trace.finish(CutterSide::Right, false).unwrap();
        assert!((contour.sections[2].arc_angle - 1.2).abs() < 1e-12);
        assert_eq!(contour.sections[0].arc_angle, 0.0);
    }
}
