//! Motions of the axes.

use std::f64::consts::TAU;

/// A point or direction in space, m or 1.
pub(super) type Vector = [f64; 3];

pub(super) fn less(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(super) fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn length(a: Vector) -> f64 {
    dot(a, a).sqrt()
}

/// One straight or circular motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Path feed, m/s; `None` for a rapid motion.
    pub feed: Option<f64>,
    /// Length of the path, m.
    pub length: f64,
    /// Longest travel of an axis, m: the axes of a rapid motion arrive together.
    pub longest: f64,
    /// Radius of the arc, m; infinite for a straight motion.
    pub radius: f64,
    /// Direction at the start.
    pub start: [f64; 3],
    /// Direction at the end.
    pub end: [f64; 3],
}

impl Motion {
    /// A straight motion; `None` where nothing moves.
    pub(super) fn straight(from: Vector, to: Vector, feed: Option<f64>) -> Option<Self> {
        let span = less(to, from);
        let length = length(span);
        let direction = span.map(|part| part / length);
        let longest = span.iter().fold(0.0_f64, |longest, part| longest.max(part.abs()));
        (length > 0.0).then_some(Self {
            feed,
            length,
            longest,
            radius: f64::INFINITY,
            start: direction,
            end: direction,
        })
    }

    /// A circular or helical motion around `center` in the plane of the axes `plane[0]` and
    /// `plane[1]`, the third rising evenly; `left` turns from the first axis to the second.
    pub(super) fn arc(
        from: Vector,
        to: Vector,
        center: [f64; 2],
        plane: [usize; 3],
        left: bool,
        feed: f64,
    ) -> Option<Self> {
        let [u, v, w] = plane;
        let (a, b) = ([from[u] - center[0], from[v] - center[1]], [to[u] - center[0], to[v] - center[1]]);
        let radius = a[0].hypot(a[1]);
        let sign = if left { 1.0 } else { -1.0 };
        let mut turn = (sign * (b[1].atan2(b[0]) - a[1].atan2(a[0]))).rem_euclid(TAU);
        // The same point twice is a full circle.
        if turn < 1e-9 {
            turn = TAU;
        }
        let (round, rise) = (radius * turn, to[w] - from[w]);
        let length = round.hypot(rise);
        if length.is_nan() || length <= 0.0 || radius <= 0.0 {
            return None;
        }
        let tangent = |arm: [f64; 2]| {
            let reach = arm[0].hypot(arm[1]).max(f64::MIN_POSITIVE);
            let mut direction = [0.0; 3];
            direction[u] = -sign * arm[1] / reach * round / length;
            direction[v] = sign * arm[0] / reach * round / length;
            direction[w] = rise / length;
            direction
        };
        Some(Self { feed: Some(feed), length, longest: length, radius, start: tangent(a), end: tangent(b) })
    }
}

/// Centre of the arc of `radius` from `from` to `to`; a negative radius takes the long way.
/// `None` where the points are too far apart.
pub(super) fn center_by_radius(from: [f64; 2], to: [f64; 2], radius: f64, left: bool) -> Option<[f64; 2]> {
    let chord = [to[0] - from[0], to[1] - from[1]];
    let span = chord[0].hypot(chord[1]);
    let height = radius * radius - 0.25 * span * span;
    // Ends are rounded to the last digit of the program.
    if span == 0.0 || height < -1e-4 * span * span {
        return None;
    }
    let side = if left == (radius > 0.0) { 1.0 } else { -1.0 };
    let height = side * height.max(0.0).sqrt() / span;
    Some([0.5 * (from[0] + to[0]) - height * chord[1], 0.5 * (from[1] + to[1]) + height * chord[0]])
}

#[cfg(test)]
mod tests {
    use super::*;

    const XY: [usize; 3] = [0, 1, 2];

    #[test]
    fn a_quarter_turn_has_its_length_and_tangents() {
        let arc = Motion::arc([0.0; 3], [1.0, 1.0, 0.0], [0.0, 1.0], XY, true, 1.0).expect("an arc");
        assert!((arc.length - 0.25 * TAU).abs() < 1e-12);
        assert!((arc.start[0] - 1.0).abs() < 1e-12 && (arc.end[1] - 1.0).abs() < 1e-12);
        let back = Motion::arc([1.0, 1.0, 0.0], [0.0; 3], [0.0, 1.0], XY, false, 1.0).expect("an arc");
        assert!((back.length - arc.length).abs() < 1e-12 && (back.start[1] + 1.0).abs() < 1e-12);
        let helix = Motion::arc([1.0, 0.0, 0.0], [1.0, 0.0, 1.0], [0.0, 0.0], XY, true, 1.0).expect("a turn");
        assert!((helix.length - TAU.hypot(1.0)).abs() < 1e-12);
    }

    #[test]
    fn a_radius_finds_the_near_and_the_far_centre() {
        let near = center_by_radius([0.0, 0.0], [1.0, 1.0], 1.0, true).expect("a centre");
        let far = center_by_radius([0.0, 0.0], [1.0, 1.0], -1.0, true).expect("a centre");
        assert!((near[0]).abs() < 1e-12 && (near[1] - 1.0).abs() < 1e-12, "{near:?}");
        assert!((far[0] - 1.0).abs() < 1e-12 && far[1].abs() < 1e-12, "{far:?}");
        assert!(center_by_radius([0.0, 0.0], [3.0, 0.0], 1.0, true).is_none());
    }
}
