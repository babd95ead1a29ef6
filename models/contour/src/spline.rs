//! Smooth curves through points, cut into tangent arcs.

use crate::geometry::wrapped;
use crate::{Point, Section};

/// Greatest distance between the arcs and the spline, m.
const FIT_TOLERANCE: f64 = 1e-6;

/// Greatest halving of one span; 2^12 pieces of a span are finer than any control resolves.
const DEEPEST: u32 = 12;

/// Piecewise cubic through points over chord length, continuous up to curvature.
struct Spline {
    knots: Vec<f64>,
    points: Vec<Point>,
    /// Second derivatives at the knots.
    bend: Vec<Point>,
}

/// Tangent arcs along the spline through `points`, and how far they stray from it, m; natural arcs are runs of one sign.
pub(crate) fn arcs(points: &[Point], periodic: bool) -> (Vec<Section>, f64) {
    let spline = Spline::through(points, periodic);
    let mut sections = Vec::new();
    let mut residual: f64 = 0.0;
    for span in 0..points.len() - 1 {
        residual = residual.max(fit_arcs(&|u: f64| spline.at(span, u), 0.0, 1.0, &mut sections));
    }
    let mut start = 0;
    while start < sections.len() {
        let sign = sections[start].curvature.signum();
        let run = sections[start..].iter().take_while(|section| section.curvature.signum() == sign).count();
        let angle: f64 = sections[start..start + run].iter().map(|section| section.sweep().abs()).sum();
        for section in &mut sections[start..start + run] {
            section.arc_angle = if section.curvature == 0.0 { 0.0 } else { angle };
        }
        start += run;
    }
    (sections, residual)
}

impl Spline {
    fn through(points: &[Point], periodic: bool) -> Self {
        let mut knots = vec![0.0];
        for pair in points.windows(2) {
            knots.push(knots[knots.len() - 1] + pair[0].distance(pair[1]));
        }
        let solve = |value: fn(&Point) -> f64| {
            let values: Vec<f64> = points.iter().map(value).collect();
            if periodic { periodic_bend(&knots, &values) } else { natural_bend(&knots, &values) }
        };
        let bend = solve(|p| p.x).into_iter().zip(solve(|p| p.y)).map(|(x, y)| Point { x, y }).collect();
        Self { knots, points: points.to_vec(), bend }
    }

    /// Point and direction at the share `u` of a span.
    fn at(&self, span: usize, u: f64) -> (Point, f64) {
        let h = self.knots[span + 1] - self.knots[span];
        let (a, b) = (1.0 - u, u);
        let value =
            |p: f64, q: f64, m: f64, n: f64| a * p + b * q + h * h / 6.0 * ((a * a * a - a) * m + (b * b * b - b) * n);
        let slope = |p: f64, q: f64, m: f64, n: f64| {
            (q - p) / h + h / 6.0 * ((1.0 - 3.0 * a * a) * m + (3.0 * b * b - 1.0) * n)
        };
        let (p, q, m, n) = (self.points[span], self.points[span + 1], self.bend[span], self.bend[span + 1]);
        let point = Point { x: value(p.x, q.x, m.x, n.x), y: value(p.y, q.y, m.y, n.y) };
        (point, slope(p.y, q.y, m.y, n.y).atan2(slope(p.x, q.x, m.x, n.x)))
    }
}

/// Places of a piece at which the distance to its arcs is measured (count): the farthest of one bend lies near one of them.
const MEASURED: u32 = 16;

/// Tangent arcs within 1 µm along a smooth curve between two parameters, and the greatest distance of the curve from them, m;
/// `curve` gives point and direction.
pub(crate) fn fit_arcs(curve: &impl Fn(f64) -> (Point, f64), u: f64, w: f64, sections: &mut Vec<Section>) -> f64 {
    fit(curve, u, w, DEEPEST, sections)
}

/// Two tangent arcs from `u` to `w` where they keep within the tolerance, else halves.
fn fit(curve: &impl Fn(f64) -> (Point, f64), u: f64, w: f64, depth: u32, sections: &mut Vec<Section>) -> f64 {
    let (start, end) = (curve(u), curve(w));
    let pair = biarc(start, end);
    let strays = |share: f64| {
        let (point, _) = curve(u + share * (w - u));
        let arc = if pair[0].start.distance(point) < pair[0].start.distance(pair[1].start) { pair[0] } else { pair[1] };
        distance(&arc, point)
    };
    let too_bent = pair.iter().any(|arc| arc.sweep().abs() > 1.0);
    let residual = (1..MEASURED).map(|i| strays(f64::from(i) / f64::from(MEASURED))).fold(0.0, f64::max);
    if depth > 0 && (too_bent || residual > FIT_TOLERANCE) {
        let middle = 0.5 * (u + w);
        let first = fit(curve, u, middle, depth - 1, sections);
        first.max(fit(curve, middle, w, depth - 1, sections))
    } else {
        sections.extend(pair.into_iter().filter(|arc| arc.length > 1e-9));
        residual
    }
}

/// Distance of a point from the circle or line that carries an arc.
fn distance(arc: &Section, point: Point) -> f64 {
    let (dx, dy) = (point.x - arc.start.x, point.y - arc.start.y);
    let (sin, cos) = arc.heading.sin_cos();
    let (along, left) = (dx * cos + dy * sin, dy * cos - dx * sin);
    // 2·left − κ·(along² + left²) vanishes on the circle and has slope 2 across it.
    (left - 0.5 * arc.curvature * (along * along + left * left)).abs()
}

/// Two arcs that meet tangentially between two points with given directions, with equal tangent
/// lengths (Bolton 1975).
fn biarc((from, heading): (Point, f64), (to, end_heading): (Point, f64)) -> [Section; 2] {
    let (vx, vy) = (to.x - from.x, to.y - from.y);
    let (s0, c0) = heading.sin_cos();
    let (s1, c1) = end_heading.sin_cos();
    let along = vx * (c0 + c1) + vy * (s0 + s1);
    let square = vx * vx + vy * vy;
    let turn = 2.0 * (1.0 - (c0 * c1 + s0 * s1));
    // The root of turn·d² + 2·along·d... in the form that does not cancel for parallel tangents.
    let d = square / (along + (along * along + turn * square).sqrt());
    let joint = Point { x: 0.5 * (from.x + to.x + d * (c0 - c1)), y: 0.5 * (from.y + to.y + d * (s0 - s1)) };
    let first = Section::tangent(from, heading, joint);
    let second = Section::tangent(joint, first.end_heading(), to);
    [first, Section { heading: wrapped(second.heading), ..second }]
}

/// Second derivatives of the natural spline (Thomas's algorithm).
fn natural_bend(knots: &[f64], values: &[f64]) -> Vec<f64> {
    let n = knots.len();
    let mut bend = vec![0.0; n];
    if n < 3 {
        return bend;
    }
    let mut upper = vec![0.0; n];
    for i in 1..n - 1 {
        let (h, g) = (knots[i] - knots[i - 1], knots[i + 1] - knots[i]);
        let right = 6.0 * ((values[i + 1] - values[i]) / g - (values[i] - values[i - 1]) / h);
        let pivot = 2.0 * (h + g) - h * upper[i - 1];
        upper[i] = g / pivot;
        bend[i] = (right - h * bend[i - 1]) / pivot;
    }
    for i in (1..n - 1).rev() {
        bend[i] -= upper[i] * bend[i + 1];
    }
    bend
}

/// Second derivatives of the periodic spline whose last point is its first: the natural system
/// bordered by one unknown, solved by superposition.
fn periodic_bend(knots: &[f64], values: &[f64]) -> Vec<f64> {
    let n = knots.len() - 1;
    let h = |i: usize| knots[i % n + 1] - knots[i % n];
    let slope = |i: usize| (values[i % n + 1] - values[i % n]) / h(i);
    if n < 3 {
        return natural_bend(knots, values);
    }
    // Unknowns 1..n−1 for the right-hand side and for a unit bend at the closing knot.
    let mut upper = vec![0.0; n];
    let mut given = vec![0.0; n + 1];
    let mut unit = vec![0.0; n + 1];
    unit[0] = 1.0;
    unit[n] = 1.0;
    for i in 1..n {
        let pivot = 2.0 * (h(i - 1) + h(i)) - h(i - 1) * upper[i - 1];
        upper[i] = h(i) / pivot;
        given[i] = (6.0 * (slope(i) - slope(i - 1)) - h(i - 1) * given[i - 1]) / pivot;
        unit[i] = -h(i - 1) * unit[i - 1] / pivot;
    }
    // The last row carries the closing knot on its right.
    unit[n - 1] -= upper[n - 1];
    for i in (1..n - 1).rev() {
        given[i] -= upper[i] * given[i + 1];
        unit[i] -= upper[i] * unit[i + 1];
    }
    let right = 6.0 * (slope(0) - slope(n - 1)) - h(0) * given[1] - h(n - 1) * given[n - 1];
    let pivot = 2.0 * (h(n - 1) + h(0)) + h(0) * unit[1] + h(n - 1) * unit[n - 1];
    let closing = right / pivot;
    (0..=n).map(|i| given[i] + closing * unit[i]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{CutterSide, Trace};
    use std::f64::consts::PI;

    fn circle(points: u32) -> Vec<Point> {
        let step = 2.0 * PI / f64::from(points);
        (0..=points)
            .map(|i| Point {
                x: 0.03 * (step * f64::from(i % points)).cos(),
                y: 0.03 * (step * f64::from(i % points)).sin(),
            })
            .collect()
    }

    #[test]
    fn a_periodic_spline_through_a_circle_is_the_circle() {
        let points = circle(24);
        let mut trace = Trace::new(points[0], 0.5 * PI);
        trace.spline_to(&points[1..]).unwrap();
        let contour = trace.finish(CutterSide::Left, true).unwrap();
        assert!(contour.corners.is_empty());
        assert!((contour.length() / (0.06 * PI) - 1.0).abs() < 1e-4);
        for section in &contour.sections {
            assert!((section.curvature * 0.03 - 1.0).abs() < 0.01, "{}", section.curvature);
            assert!((section.arc_angle - 2.0 * PI).abs() < 1e-3);
        }
    }

    #[test]
    fn arcs_of_a_natural_spline_pass_through_its_points_smoothly() {
        let points: Vec<Point> =
            (0..9).map(|i| Point { x: 0.01 * f64::from(i), y: 0.004 * (0.9 * f64::from(i)).sin() }).collect();
        let (sections, _) = arcs(&points, false);
        for pair in sections.windows(2) {
            assert!(pair[0].end().distance(pair[1].start) < 1e-12);
            assert!(wrapped(pair[1].heading - pair[0].end_heading()).abs() < 1e-6);
        }
        for point in &points[1..8] {
            assert!(sections.iter().any(|section| section.start.distance(*point) < 1e-12));
        }
        assert!(sections.iter().any(|section| section.curvature > 0.0));
        assert!(sections.iter().any(|section| section.curvature < 0.0));
    }
}
