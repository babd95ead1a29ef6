//! An outline of lines and arcs: what is inside it, how far a point is from it, and where a rim crosses it.

use std::f64::consts::{FRAC_PI_2, SQRT_2, TAU};
use toolroom_contour::{Point, Rim, Section, Track};

/// The region inside closed contours, grown by an offset: within an odd number of them, so that one within another is its hole.
///
/// Distances outside are exact. Inside they are those from the contour itself and the offset, which the distance from the grown
/// outline is never below.
///
/// ```
/// use toolroom_contour::{Point, Trace};
/// use toolroom_stock::Profile;
/// let mut trace = Trace::new(Point { x: 0.03, y: 0.0 }, std::f64::consts::FRAC_PI_2);
/// trace.arc(0.03, 2.0 * std::f64::consts::PI).unwrap();
/// let disc = Profile::new(&trace.outline().unwrap(), 0.002);
/// assert!((disc.area() - std::f64::consts::PI * 0.032 * 0.032).abs() < 1e-6);
/// assert!((disc.distance(Point { x: 0.0, y: -0.035 }) - 0.003).abs() < 1e-12);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    tracks: Vec<Track>,
    /// m.
    offset: f64,
    /// Least and greatest corner of a box around the grown outline.
    bounds: (Point, Point),
}

/// Squares into which the box around an outline is cut at most for its area: along each side two to this power. What a square on
/// the outline adds is off by less than a tenth of it, and squares in a row are off to both sides.
const FINEST: u32 = 10;

/// A way from a chord on which no point lies by design, m; less than what any place is known to.
const ASIDE: f64 = 2.3e-11;

impl Profile {
    /// Of the sections of closed contours, one after the other, grown by `offset`, m, of at least 0.
    pub fn new(sections: &[Section], offset: f64) -> Self {
        let tracks: Vec<Track> = sections.iter().copied().map(Track::new).collect();
        let mut bounds = (corner(f64::INFINITY), corner(f64::NEG_INFINITY));
        for point in sections.iter().flat_map(extremes) {
            bounds.0 = Point { x: bounds.0.x.min(point.x - offset), y: bounds.0.y.min(point.y - offset) };
            bounds.1 = Point { x: bounds.1.x.max(point.x + offset), y: bounds.1.y.max(point.y + offset) };
        }
        Self { tracks, offset, bounds }
    }

    /// Least and greatest corner of a box around it.
    pub fn bounds(&self) -> (Point, Point) {
        self.bounds
    }

    /// Distance of a point from the outline, m, negative inside.
    pub fn distance(&self, point: Point) -> f64 {
        let from_contour = self.tracks.iter().map(|track| track.distance(point)).fold(f64::INFINITY, f64::min);
        if self.turns(point) % 2 == 0 { from_contour - self.offset } else { -from_contour - self.offset }
    }

    /// Whether a point lies inside the outline grown by `slack`, m.
    pub(crate) fn holds(&self, point: Point, slack: f64) -> bool {
        let (low, high) = self.bounds;
        let near = |value: f64, low: f64, high: f64| (low - slack..=high + slack).contains(&value);
        near(point.x, low.x, high.x) && near(point.y, low.y, high.y) && self.distance(point) <= slack
    }

    /// Adds the angles at which a rim may cross the outline grown by `slack`, m.
    pub(crate) fn crossings(&self, rim: &Rim, slack: f64, angles: &mut Vec<f64>) {
        let reach = (self.offset + slack).abs();
        for track in self.tracks.iter().filter(|track| track.reaches(rim.centre, rim.radius + reach)) {
            rim.crossings(track, reach, angles);
        }
    }

    /// Its area, m², within a thousandth: squares are halved until they lie on one side of the outline.
    pub fn area(&self) -> f64 {
        let (low, high) = self.bounds;
        let side = (high.x - low.x).max(high.y - low.y);
        let mut area = 0.0;
        let mut open = vec![(low, side, 0)];
        while let Some((low, side, level)) = open.pop() {
            let half = 0.5 * side;
            let distance = self.distance(Point { x: low.x + half, y: low.y + half });
            if distance.abs() >= half * SQRT_2 {
                area += if distance < 0.0 { side * side } else { 0.0 };
            } else if level == FINEST {
                area += side * side * (0.5 - distance / side).clamp(0.0, 1.0);
            } else {
                for (right, up) in [(0.0, 0.0), (half, 0.0), (0.0, half), (half, half)] {
                    open.push((Point { x: low.x + right, y: low.y + up }, half, level + 1));
                }
            }
        }
        area
    }

    /// How often the contour runs around a point, to the left: around its chords, and around what arcs enclose beside theirs.
    fn turns(&self, point: Point) -> i32 {
        // Chords between the arcs of a circle lie along an axis, as places of programs do, and their ends are rounded.
        let point = Point { x: point.x + ASIDE, y: point.y + ASIDE };
        self.tracks.iter().map(|track| around_chord(track, point) + around_arc(track, point)).sum()
    }
}

fn corner(value: f64) -> Point {
    Point { x: value, y: value }
}

/// The ends of a section, and where it is farthest along X and Y.
fn extremes(section: &Section) -> impl Iterator<Item = Point> + use<> {
    let section = *section;
    let sense = section.curvature.signum();
    // Ways at which an arc is parallel to an axis.
    let parallel = (0..4).filter_map(move |quarter| {
        let turned = (sense * (FRAC_PI_2 * f64::from(quarter) - section.heading)).rem_euclid(TAU);
        (section.curvature != 0.0 && turned < section.sweep().abs()).then(|| turned / section.curvature.abs())
    });
    [0.0, section.length].into_iter().chain(parallel).map(move |way| section.at(way))
}

/// Twice the area of the triangle of a section's chord and a point, positive where the point is on the left.
fn left_of_chord(track: &Track, point: Point) -> f64 {
    let (start, end) = (track.section().start, track.end());
    (end.x - start.x) * (point.y - start.y) - (point.x - start.x) * (end.y - start.y)
}

/// What a chord adds to the turns around a point: whether it crosses the ray from the point along X.
fn around_chord(track: &Track, point: Point) -> i32 {
    let (start, end) = (track.section().start, track.end());
    let left = left_of_chord(track, point);
    if start.y <= point.y {
        i32::from(end.y > point.y && left > 0.0)
    } else {
        -i32::from(end.y <= point.y && left < 0.0)
    }
}

/// What an arc adds beside its chord: whether the point lies between the two.
fn around_arc(track: &Track, point: Point) -> i32 {
    let section = track.section();
    if section.curvature == 0.0 {
        return 0;
    }
    let radius = 1.0 / section.curvature.abs();
    let centre = section.start.ahead(section.heading + section.curvature.signum() * FRAC_PI_2, radius);
    let sense = if section.curvature > 0.0 { 1 } else { -1 };
    let beyond_chord = f64::from(sense) * left_of_chord(track, point) < 0.0;
    let whole = section.sweep().abs() >= TAU - 1e-9;
    if (beyond_chord || whole) && centre.distance(point) < radius { sense } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use toolroom_contour::Trace;

    /// A plate with a bay: lines, arcs to either side, and one of more than half a turn.
    fn plate() -> Vec<Section> {
        let mut trace = Trace::new(Point::default(), 0.0);
        trace.line_to(Point { x: 0.03, y: 0.0 }).expect("a line");
        trace.arc_to(Point { x: 0.046, y: 0.0 }, Point { x: 0.038, y: 0.0 }, false).expect("a bay");
        trace.line_to(Point { x: 0.08, y: 0.0 }).expect("a line");
        trace.arc_to(Point { x: 0.08, y: 0.02 }, Point { x: 0.085, y: 0.01 }, true).expect("a nose");
        trace.line_to(Point { x: 0.0, y: 0.04 }).expect("a line");
        trace.line_to(Point::default()).expect("a line");
        trace.outline().expect("an outline")
    }

    #[test]
    fn the_area_is_that_of_the_polygon_with_its_segments() {
        let sections = plate();
        // Shoelace over the ends, and the segments of the two arcs.
        let ends: Vec<Point> = sections.iter().map(|section| section.start).collect();
        let shoelace: f64 = (0..ends.len())
            .map(|i| (ends[i], ends[(i + 1) % ends.len()]))
            .map(|(a, b)| 0.5 * (a.x * b.y - b.x * a.y))
            .sum();
        let segment = |section: &Section| {
            let turned = section.sweep();
            if turned == 0.0 { 0.0 } else { 0.5 * (turned - turned.sin()) / section.curvature.powi(2) }
        };
        let exact = shoelace + sections.iter().map(segment).sum::<f64>();
        let found = Profile::new(&sections, 0.0).area();
        assert!((found / exact - 1.0).abs() < 1e-4, "{found} {exact}");
    }

    #[test]
    fn the_box_around_it_touches_it_on_every_side() {
        let profile = Profile::new(&plate(), 0.001);
        let (low, high) = profile.bounds();
        let radius = (0.005f64.powi(2) + 0.01f64.powi(2)).sqrt();
        assert!((low.x + 0.001).abs() < 1e-12 && (low.y - 0.01 + radius + 0.001).abs() < 1e-9, "{low:?}");
        assert!((high.x - 0.085 - radius - 0.001).abs() < 1e-9 && (high.y - 0.041).abs() < 1e-9, "{high:?}");
    }

    proptest! {
        /// Whether a point is inside is what a ray in a random direction says of many short chords.
        #[test]
        fn inside_is_inside_the_polygon_of_many_points(x in -0.01..0.11f64, y in -0.02..0.05f64) {
            let sections = plate();
            let points: Vec<Point> = (sections.iter())
                .flat_map(|section| (0..4000).map(|i| section.at(section.length * f64::from(i) / 4000.0)))
                .collect();
            let (sin, cos) = 0.7347f64.sin_cos();
            let turned = |point: &Point| {
                let (dx, dy) = (point.x - x, point.y - y);
                (dx * cos + dy * sin, dy * cos - dx * sin)
            };
            let crossed = (0..points.len()).filter(|i| {
                let (a, b) = (turned(&points[*i]), turned(&points[(i + 1) % points.len()]));
                (a.1 > 0.0) != (b.1 > 0.0) && a.0 + (b.0 - a.0) * a.1 / (a.1 - b.1) > 0.0
            });
            let odd = crossed.count() % 2 == 1;
            let distance = Profile::new(&sections, 0.0).distance(Point { x, y });
            prop_assume!(distance.abs() > 1e-6);
            prop_assert_eq!(distance < 0.0, odd, "{}", distance);
        }

        /// A rim changes between material and air only at its crossings.
        #[test]
        fn a_rim_changes_sides_only_at_its_crossings(x in -0.01..0.11f64, y in -0.02..0.05f64, slack in 0.0..0.003f64) {
            let profile = Profile::new(&plate(), 0.001);
            let rim = Rim { centre: Point { x, y }, radius: 0.006 };
            let mut angles = Vec::new();
            profile.crossings(&rim, slack, &mut angles);
            let mut angles: Vec<f64> = angles.into_iter().map(|angle| angle.rem_euclid(TAU)).collect();
            angles.sort_by(f64::total_cmp);
            const RIM: u32 = 720;
            let at = |i: u32| TAU * f64::from(i) / f64::from(RIM);
            for i in 0..RIM {
                let [before, after] = [at(i), at(i + 1)].map(|angle| profile.holds(rim.at(angle), slack));
                let crossed = angles.iter().any(|angle| (at(i) - 1e-9..=at(i + 1) + 1e-9).contains(angle));
                prop_assert!(before == after || crossed, "{}", at(i));
            }
        }
    }
}
