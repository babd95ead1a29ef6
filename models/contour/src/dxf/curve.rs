//! Ellipses and splines, cut into tangent arcs within 1 µm.
//!
//! # Source
//! Autodesk, "DXF Reference", ELLIPSE and SPLINE; de Boor's algorithm: Piegl & Tiller, "The NURBS Book" (1997), recalled.

use super::JOIN;
use super::elements::Element;
use super::tags::{Entity, fault};
use crate::geometry::wrapped;
use crate::spline::fit_arcs;
use crate::{FileError, Point, Section};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Greatest degree of a spline that is followed (assumption; drawings have 3, rarely 5).
const DEGREE: usize = 15;
/// Share of a span at which the direction is looked for where the curve stands still at its end.
const STEP: f64 = 1e-4;

/// Adds smooth sections, from which their curve strays by `residual`, m, as elements.
fn add(sections: Vec<Section>, residual: f64, line: usize, list: &mut Vec<Element>) {
    for section in sections {
        let (start, end) = (section.start, section.end());
        // An arc that leaves its chord by less than rounding is a line.
        let flat = (section.curvature * section.length).abs() < 1e-9;
        let arc = (!flat).then(|| {
            let centre = section.start.ahead(section.heading + FRAC_PI_2, 1.0 / section.curvature);
            (centre, section.curvature > 0.0)
        });
        // Two pieces of one line are one.
        if let (Some(before), None) = (list.last_mut(), arc)
            && before.curve.is_some()
            && before.line == line
            && before.arc.is_none()
            && wrapped(before.start.heading_to(before.end) - section.heading).abs() < 1e-9
        {
            before.end = end;
            continue;
        }
        list.push(Element { start, end, arc, line, curve: Some(residual) });
    }
}

/// An ellipse, or a part of one: centre, end of the major axis from it, ratio of the axes, parameters of start and end.
pub(super) fn ellipse(entity: &Entity<'_>, unit: f64, list: &mut Vec<Element>) -> Result<(), FileError> {
    let up = entity.mirror()?;
    let centre = [entity.due(10)? * unit, entity.due(20)? * unit];
    let major = [entity.due(11)? * unit, entity.due(21)? * unit];
    let ratio = entity.due(40)?;
    if !(ratio > 0.0 && ratio <= 1.0 + 1e-9) || major[0].hypot(major[1]) < JOIN {
        return Err(fault(entity.line, "an ELLIPSE needs a major axis, and a ratio of its axes above 0 and up to 1"));
    }
    let (from, to) = (entity.number(41)?.unwrap_or(0.0), entity.number(42)?.unwrap_or(TAU));
    let whole = to - from;
    let whole = if whole > TAU - 1e-9 && whole < TAU + 1e-9 { TAU } else { whole.rem_euclid(TAU) };
    if whole * major[0].hypot(major[1]) * ratio < JOIN {
        return Err(fault(entity.line, "an ELLIPSE without any length"));
    }
    // The minor axis is a left turn from the major one, seen against the direction of extrusion.
    let minor = [-up * ratio * major[1], up * ratio * major[0]];
    let on_ellipse = |parameter: f64| {
        let (sin, cos) = parameter.sin_cos();
        let point =
            Point { x: centre[0] + cos * major[0] + sin * minor[0], y: centre[1] + cos * major[1] + sin * minor[1] };
        (point, (cos * minor[1] - sin * major[1]).atan2(cos * minor[0] - sin * major[0]))
    };
    let mut sections = Vec::new();
    let mut residual: f64 = 0.0;
    // Quarters, so that no arc begins with more than a right angle.
    let parts = (whole / FRAC_PI_2 - 1e-9).ceil().max(1.0);
    for part in 0..parts as u32 {
        let begin = from + whole * f64::from(part) / parts;
        residual = residual.max(fit_arcs(&on_ellipse, begin, begin + whole / parts, &mut sections));
    }
    if whole == TAU {
        // Rounding of the last end does not leave the contour open.
        close(&mut sections);
    }
    add(sections, residual, entity.line, list);
    Ok(())
}

/// The last section ends where the first begins.
fn close(sections: &mut [Section]) {
    let Some(start) = sections.first().map(|section| section.start) else { return };
    if let Some(last) = sections.last_mut() {
        *last = Section::tangent(last.start, last.heading, start);
    }
}

/// A rational spline of any degree.
struct Nurbs {
    degree: usize,
    knots: Vec<f64>,
    /// Control points with their weights: x·w, y·w, w.
    control: Vec<[f64; 3]>,
}

impl Nurbs {
    /// Value and derivative at `u` by the polynomial of the span that begins at `knots[span]`.
    fn homogeneous(&self, span: usize, u: f64) -> [[f64; 3]; 2] {
        let p = self.degree;
        let mut value: Vec<[f64; 3]> = (0..=p).map(|i| self.control[span - p + i]).collect();
        let mut slope = [0.0; 3];
        for level in 1..=p {
            if level == p {
                // The last two points span the tangent.
                let width = self.knots[span + 1] - self.knots[span];
                slope = std::array::from_fn(|k| p as f64 * (value[p][k] - value[p - 1][k]) / width);
            }
            for i in (level..=p).rev() {
                let low = self.knots[span - p + i];
                let share = (u - low) / (self.knots[span + 1 + i - level] - low);
                value[i] = std::array::from_fn(|k| (1.0 - share) * value[i - 1][k] + share * value[i][k]);
            }
        }
        [value[p], slope]
    }

    /// Point and direction at the share `u` of a span.
    fn at(&self, span: usize, share: f64) -> (Point, f64) {
        let (low, high) = (self.knots[span], self.knots[span + 1]);
        let place = |share: f64| {
            let [value, slope] = self.homogeneous(span, low + share * (high - low));
            let [x, y] = [0, 1].map(|k| value[k] / value[2]);
            let along = [(slope[0] - x * slope[2]) / value[2], (slope[1] - y * slope[2]) / value[2]];
            (Point { x, y }, along, along[0].hypot(along[1]) * (high - low))
        };
        let (point, along, speed) = place(share);
        if speed > JOIN {
            return (point, along[1].atan2(along[0]));
        }
        // Control points that coincide: the direction is that of the way beside the end.
        let (near, ..) = place(if share < 0.5 { share + STEP } else { share - STEP });
        (point, if share < 0.5 { point.heading_to(near) } else { near.heading_to(point) })
    }
}

/// A spline by its control points.
pub(super) fn spline(entity: &Entity<'_>, unit: f64, list: &mut Vec<Element>) -> Result<(), FileError> {
    let refused = |message: &str| Err(fault(entity.line, format!("SPLINE: {message}")));
    let degree = entity.number(71)?.unwrap_or(3.0);
    if !(1.0..=DEGREE as f64).contains(&degree) || degree.fract() != 0.0 {
        return refused(&format!("degree {degree}; degrees from 1 to {DEGREE} are followed"));
    }
    let degree = degree as usize;
    let (knots, weights) = (entity.all(40)?, entity.all(41)?);
    let (x, y, z) = (entity.all(10)?, entity.all(20)?, entity.all(30)?);
    if x.is_empty() {
        return refused("it names points but no control points; save the drawing with control points, or as polyline");
    }
    if x.len() != y.len() || x.len() <= degree || knots.len() != x.len() + degree + 1 {
        return refused(&format!(
            "{} control points and {} knots do not belong to degree {degree}; it has as many knots as points, degree and 1",
            x.len(),
            knots.len()
        ));
    }
    if z.iter().any(|height| ((height - z[0]) * unit).abs() > JOIN) {
        return refused("it leaves the plane XY; draw it in the plane");
    }
    if !(weights.is_empty() || weights.len() == x.len()) || weights.iter().any(|weight| *weight <= 0.0) {
        return refused("it needs a weight above 0 for each control point, or none at all");
    }
    if knots.windows(2).any(|pair| pair[1] < pair[0]) {
        return refused("its knots do not rise");
    }
    let weight = |i: usize| weights.get(i).copied().unwrap_or(1.0);
    let control = (0..x.len()).map(|i| [x[i] * unit * weight(i), y[i] * unit * weight(i), weight(i)]).collect();
    let nurbs = Nurbs { degree, knots, control };
    let mut sections = Vec::new();
    let mut residual: f64 = 0.0;
    let range = nurbs.knots[nurbs.control.len()] - nurbs.knots[degree];
    for span in degree..nurbs.control.len() {
        if nurbs.knots[span + 1] - nurbs.knots[span] > 1e-12 * range {
            residual = residual.max(fit_arcs(&|share: f64| nurbs.at(span, share), 0.0, 1.0, &mut sections));
        }
    }
    if sections.is_empty() {
        return refused("it has no length");
    }
    let (first, last) = (sections[0].start, sections[sections.len() - 1].end());
    if first.distance(last) < JOIN && sections.len() > 1 {
        close(&mut sections);
    }
    add(sections, residual, entity.line, list);
    Ok(())
}
