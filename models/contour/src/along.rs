//! Engagement along the path: what sections ahead bring, with a bound between samples.
//!
//! Material lies within the allowance of the wall. On the wall of one curvature the engagement is constant; near the next
//! section the rim already reaches into its allowance. What the section under the cutter brings is exact, what the others
//! bring is measured on the rim, at samples, and between them bounded: a point of the rim at a fixed angle to the direction
//! of travel moves by no more than the way of the step, and the distance from the wall by no more than the point.

use crate::rim::{Rim, SLIVER, opposite};
use crate::{Contour, Corner, CutterSide, Engagement, Section, Track};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

// Chosen so that plans of random contours are less than 2 % slower than the optimum over pieces of 20 um (tests/contour/gate.rs;
// with a degree, 50 um, 3 % and 0.2 mm some were up to 9 % slower).
/// Difference between bound and sample that is not refined further, rad.
const FINE: f64 = 0.25 * PI / 180.0;
/// Half length of a step that is not halved again, m.
const SHORTEST: f64 = 10e-6;
/// Steps into which a section is cut at most; a longer one keeps a looser bound.
const MOST_STEPS: f64 = 2048.0;
/// Neighbouring steps are one piece as long as their engagement differs by no more than this share.
const ALIKE: f64 = 0.015;
/// Length, m, below which pieces are joined whatever their engagement: some blocks at usual feeds (assumption).
const LEAST_PIECE: f64 = 0.1e-3;

/// A piece of a section on which one engagement is an upper bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Section of the contour.
    pub section: usize,
    /// Way along the section's wall at which it begins, m.
    pub from: f64,
    /// Way at which it ends, m.
    pub to: f64,
    /// Engagement that is exceeded nowhere on it.
    pub engagement: Engagement,
    /// Engagement angle, rad, below which it falls nowhere: forces across the wall are not greatest at the greatest angle.
    pub least: f64,
}

/// The engagement of a cutter along a contour whose stock lies parallel to the wall.
///
/// # Validity
/// The allowance is that of every section; what a pass leaves at sharp corners is not followed, nor is the way around them.
///
/// # Source
/// Closed forms on the rim; the bound by the Lipschitz constant 1 of a distance.
///
/// ```
/// use toolroom_contour::{Along, CutterSide, Point, Trace};
/// let mut trace = Trace::new(Point::default(), 0.0);
/// trace.line(0.1).unwrap();
/// trace.arc(0.022, 2.0).unwrap();
/// let contour = trace.finish(CutterSide::Left, false).unwrap();
/// let along = Along::new(&contour, 0.016, 0.003, false);
/// let at = |before_arc: f64| along.at(0, 0.1 - before_arc).angle.to_degrees();
/// assert!((at(0.02) - 35.6591).abs() < 1e-4);       // a straight wall
/// assert!((at(2.3318e-3) - 50.7887).abs() < 1e-3);  // the hollow arc is near
/// ```
#[derive(Clone, Debug)]
pub struct Along<'a> {
    contour: &'a Contour,
    /// Of its sections.
    tracks: Vec<Track>,
    radius: f64,
    allowance: f64,
    backwards: bool,
}

impl<'a> Along<'a> {
    /// A cutter of `radius`, m, that leaves nothing of `allowance`, m; `backwards` travels the contour against the order in
    /// which it is drawn.
    pub fn new(contour: &'a Contour, radius: f64, allowance: f64, backwards: bool) -> Self {
        let tracks = contour.sections.iter().copied().map(Track::new).collect();
        Self { contour, tracks, radius, allowance, backwards }
    }

    /// Engagement after `way` along a section's wall.
    pub fn at(&self, section: usize, way: f64) -> Engagement {
        self.engagement(self.steady(section) + self.others(section, way, 0.0))
    }

    /// The engagement of an angle, rad.
    fn engagement(&self, angle: f64) -> Engagement {
        let angle = angle.min(PI);
        Engagement { angle, immersion: self.radius * (1.0 - angle.cos()) }
    }

    fn steady(&self, section: usize) -> f64 {
        Engagement::new(self.contour.shape(&self.contour.sections[section]), self.radius, self.allowance).angle
    }

    /// Angle that other sections engage beside the one under the cutter, rad, when every rim point is taken to be nearer to
    /// the wall by `slack`, m.
    fn others(&self, section: usize, way: f64, slack: f64) -> f64 {
        let shape = &self.contour.sections[section];
        let side = self.contour.side.sign();
        let heading = shape.heading + shape.curvature * way;
        let rim = Rim { centre: shape.at(way).ahead(heading + side * FRAC_PI_2, self.radius), radius: self.radius };
        let reach = self.allowance + slack;
        if reach <= 0.0 {
            return 0.0;
        }
        let ahead = if self.backwards { opposite(heading) } else { heading };
        let contact = heading - side * FRAC_PI_2;
        // From the contact with the wall towards the direction of travel.
        let steady = self.steady(section);
        let left = (self.contour.side == CutterSide::Left) != self.backwards;
        let start = if left { contact } else { contact - steady };
        let front = ahead - FRAC_PI_2;
        let free = free_of((start - front).rem_euclid(TAU), steady);
        let (mut angles, mut parts) = (Vec::new(), Vec::new());
        for (other, track) in self.tracks.iter().enumerate() {
            if other == section || !track.reaches(rim.centre, rim.radius + reach) {
                continue;
            }
            rim.crossings(track, reach, &mut angles);
            rim.parts(front, PI, &mut angles, |low, high| {
                if track.reaches(rim.at(front + 0.5 * (low + high)), reach) {
                    let free_parts = free.iter().map(|(from, to)| (low.max(*from), high.min(*to)));
                    parts.extend(free_parts.filter(|(from, to)| to - from > SLIVER));
                }
            });
        }
        measure_of_union(&mut parts)
    }

    /// Pieces of all sections in the order of the contour, on each of which one engagement is never exceeded.
    pub fn pieces(&self) -> Vec<Piece> {
        (0..self.contour.sections.len()).flat_map(|section| self.pieces_of(section)).collect()
    }

    fn pieces_of(&self, section: usize) -> Vec<Piece> {
        let shape = &self.contour.sections[section];
        let steady = self.steady(section);
        // Greatest way of a rim point for a way along the wall: the centre's on a line, more where the direction turns.
        let centre = self.contour.shape(shape).centre_path_ratio(self.radius);
        let moves = centre + self.radius * shape.curvature.abs();
        let shortest = SHORTEST.max(0.5 * shape.length * moves / MOST_STEPS);
        let mut steps: Vec<(f64, f64, f64, f64)> = Vec::new();
        let sampled = |way: f64| self.others(section, way, 0.0);
        // Each with the angles that are sampled at its two ends, which neighbours share.
        let mut open = vec![((0.0, sampled(0.0)), (shape.length, sampled(shape.length)))];
        while let Some((from, to)) = open.pop() {
            let (way, half) = (0.5 * (from.0 + to.0), 0.5 * (to.0 - from.0));
            let bound = self.others(section, way, half * moves);
            if bound == 0.0 {
                steps.push((from.0, to.0, steady, steady));
                continue;
            }
            let middle = (way, sampled(way));
            if half * moves <= shortest || bound - middle.1.max(from.1).max(to.1) <= FINE {
                let under = self.others(section, way, -half * moves);
                steps.push((from.0, to.0, steady + bound, steady + under));
            } else {
                // The first half comes first.
                open.extend([(middle, to), (from, middle)]);
            }
        }
        let mut pieces: Vec<Piece> = Vec::new();
        let mut least = f64::INFINITY;
        for (from, to, angle, under) in steps {
            let engagement = self.engagement(angle);
            match pieces.last_mut() {
                Some(last)
                    if engagement.angle.max(last.engagement.angle) <= engagement.angle.min(least) * (1.0 + ALIKE)
                        || to - last.from <= LEAST_PIECE =>
                {
                    last.to = to;
                    last.least = last.least.min(under);
                    if engagement.angle > last.engagement.angle {
                        last.engagement = engagement;
                    }
                    least = least.min(engagement.angle);
                }
                _ => {
                    least = engagement.angle;
                    pieces.push(Piece { section, from, to, engagement, least: under });
                }
            }
        }
        pieces
    }
}

/// What is left of the front half of a rim, rad from 0 to π, without the `steady` angle, rad, from `start`, rad in [0, 2π).
fn free_of(start: f64, steady: f64) -> [(f64, f64); 2] {
    // What passes a full turn begins the half.
    let before = (start + steady - TAU).max(0.0);
    [(before, start.min(PI)), (start + steady, PI)]
}

/// Measure of the union of intervals, each with its start and end.
fn measure_of_union(parts: &mut [(f64, f64)]) -> f64 {
    parts.sort_by(|one, other| one.0.total_cmp(&other.0));
    let mut reached = f64::NEG_INFINITY;
    let grown = |&(low, high): &(f64, f64)| {
        let more = (high - low.max(reached)).max(0.0);
        reached = reached.max(high);
        more
    };
    parts.iter().map(grown).sum()
}

/// Every section as one piece.
pub(crate) fn whole(contour: &Contour, radius: f64, allowance: f64) -> Vec<Piece> {
    let piece = |(section, own): (usize, &Section)| {
        let engagement = Engagement::new(contour.shape(own), radius, allowance);
        Piece { section, from: 0.0, to: own.length, engagement, least: engagement.angle }
    };
    contour.sections.iter().enumerate().map(piece).collect()
}

/// The contour with its sections cut into pieces.
pub(crate) fn cut(contour: &Contour, pieces: &[Piece]) -> Contour {
    let section = |piece: &Piece| {
        let shape = &contour.sections[piece.section];
        let heading = shape.heading + shape.curvature * piece.from;
        Section { start: shape.at(piece.from), heading, length: piece.to - piece.from, ..*shape }
    };
    let last = |section: usize| pieces.iter().rposition(|piece| piece.section == section).unwrap_or(section);
    let corners = contour.corners.iter().map(|corner| Corner { after: last(corner.after), ..*corner }).collect();
    Contour { sections: pieces.iter().map(section).collect(), corners, side: contour.side, closed: contour.closed }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Point, Trace, distance};
    use proptest::prelude::*;

    /// A straight wall into a hollow arc of 22 mm, on whichever side the cutter runs.
    fn hollow(side: CutterSide) -> Contour {
        let mut trace = Trace::new(Point::default(), 0.3);
        trace.line(0.06).expect("a line");
        trace.arc(0.022, side.sign() * 1.8).expect("an arc");
        trace.line(0.05).expect("a line");
        trace.finish(side, false).expect("a contour")
    }

    #[test]
    fn a_hollow_arc_ahead_engages_as_the_closed_form_says() {
        // Distance before the arc, mm; engagement angle, deg; immersion, mm.
        let rows = [
            (9.3274, 35.6591, 3.0),
            (6.9955, 36.7187, 3.1747),
            (4.6637, 40.9388, 3.9134),
            (2.3318, 50.7887, 5.8851),
            (0.9327, 60.6377, 8.1547),
        ];
        for side in [CutterSide::Left, CutterSide::Right] {
            let contour = hollow(side);
            for (before, angle, immersion) in rows {
                let forwards = Along::new(&contour, 0.016, 0.003, false).at(0, 0.06 - 1e-3 * before);
                assert!(
                    (forwards.angle.to_degrees() - angle).abs() < 2e-3,
                    "{before}: {}",
                    forwards.angle.to_degrees()
                );
                assert!((forwards.immersion * 1e3 - immersion).abs() < 2e-3, "{before}: {}", forwards.immersion);
                // The same wall from its other end.
                let backwards = Along::new(&contour, 0.016, 0.003, true).at(2, 1e-3 * before);
                assert!((backwards.angle - forwards.angle).abs() < 1e-9, "{before}");
            }
            let along = Along::new(&contour, 0.016, 0.003, false);
            assert!((along.at(0, 0.06 - 1e-9).angle.to_degrees() - 68.9382).abs() < 1e-3);
            assert!((along.at(1, 0.01).angle.to_degrees() - 68.9382).abs() < 1e-4);
            // Behind the arc nothing of it is left in front.
            assert!((along.at(2, 0.001).angle.to_degrees() - 35.6591).abs() < 1e-4);
        }
    }

    #[test]
    fn pieces_are_few_and_cover_the_contour() {
        let contour = hollow(CutterSide::Left);
        let pieces = Along::new(&contour, 0.016, 0.003, false).pieces();
        assert!(pieces.len() < 60, "{}", pieces.len());
        for (section, shape) in contour.sections.iter().enumerate() {
            let mut way = 0.0;
            for piece in pieces.iter().filter(|piece| piece.section == section) {
                assert_eq!(piece.from, way);
                way = piece.to;
            }
            assert_eq!(way, shape.length);
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(8))]

        /// The rim sampled by itself never has more material than the piece under it says.
        #[test]
        fn no_rim_has_more_material_than_its_piece(
            radii in proptest::collection::vec((prop::bool::ANY, 0.009..0.05f64, 0.2..1.6f64, 0.004..0.03f64), 1..4),
            allowance in 0.0002..0.004f64,
            left in prop::bool::ANY,
            backwards in prop::bool::ANY,
        ) {
            let radius = 0.008;
            let side = if left { CutterSide::Left } else { CutterSide::Right };
            let mut trace = Trace::new(Point::default(), 0.0);
            trace.line(0.03).expect("a line");
            for (turns_left, arc, angle, line) in radii {
                trace.arc(arc, if turns_left { angle } else { -angle }).expect("an arc");
                trace.line(line).expect("a line");
            }
            let contour = trace.finish(side, false).expect("a contour");
            let along = Along::new(&contour, radius, allowance, backwards);
            for piece in along.pieces() {
                let shape = &contour.sections[piece.section];
                for step in 0..=8 {
                    let way = piece.from + (piece.to - piece.from) * f64::from(step) / 8.0;
                    let heading = shape.heading + shape.curvature * way;
                    let centre = shape.at(way).ahead(heading + side.sign() * FRAC_PI_2, radius);
                    let ahead = if backwards { heading + PI } else { heading };
                    const RIM: u32 = 1440;
                    let inside = (0..RIM).filter(|i| {
                        let angle = ahead - FRAC_PI_2 + PI * (f64::from(*i) + 0.5) / f64::from(RIM);
                        let point = centre.ahead(angle, radius);
                        contour.sections.iter().any(|section| distance(section, point) < allowance)
                    });
                    let sampled = PI * inside.count() as f64 / f64::from(RIM);
                    // The rim is sampled to an eighth of a degree at both ends of its intervals.
                    prop_assert!(sampled <= piece.engagement.angle + 4.0 * PI / f64::from(RIM), "{sampled} {piece:?} {way}");
                }
            }
        }
    }
}
