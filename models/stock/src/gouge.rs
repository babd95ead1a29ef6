//! Gouges: where a cutter reaches into the part that a program should leave.

use crate::cutting::paths;
use crate::load::Tool;
use crate::profile::Profile;
use std::sync::Arc;
use toolroom_contour::{Point, Section};
use toolroom_program::Motion;

/// The part that has to be left: a prism of its outline, or all around it.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Seen along Z.
    pub outline: Arc<Profile>,
    /// Whether the outline is that of a pocket, around which the part lies.
    pub pocket: bool,
    /// Height of its upper face, m.
    pub top: f64,
}

/// How a motion reaches into the part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gouge {
    /// Greatest depth, m: into the wall or below the upper face, whichever is less.
    pub depth: f64,
    /// Where the axis of the cutter is then.
    pub place: Point,
    /// Way on which it is deeper than a micrometre, m, to a five-hundredth of the path.
    pub length: f64,
}

/// Depth, m, from which a gouge is one (spec of this project: 1 µm).
const LEAST: f64 = 1e-6;
/// Difference between the greatest depth that is found and what may lie between samples, m.
const FINE: f64 = 0.2e-6;
/// Steps of a path are not halved below this length, m, where the cutter's axis comes to the outline itself: its depth there is known to half of it.
const SHORTEST: f64 = 0.5e-6;
/// Samples by which the length is found.
const SAMPLES: u32 = 500;

impl Part {
    /// Distance of a point from the part, m, negative inside.
    fn distance(&self, point: Point) -> f64 {
        let distance = self.outline.distance(point);
        if self.pocket { -distance } else { distance }
    }

    /// What a motion of a tool cuts into the part by more than a micrometre; nothing of one from or to a place that only the machine
    /// knows.
    ///
    /// Every point of the outline is a line, an arc or a corner. Between two samples a distance `h` apart the distance from any of
    /// these falls below the lesser of both by no more than h²/8 times the sum of the curvature of the path and the inverse of the
    /// distance (the second derivative of the distance from a point is at most its inverse; that from a hollow arc never bends
    /// upwards). Steps are halved until that is less than 0.2 µm.
    pub fn gouge(&self, motion: &Motion, tool: &Tool) -> Option<Gouge> {
        if motion.unknown {
            return None;
        }
        let (low, high) = (motion.start[2].min(motion.end[2]), motion.start[2].max(motion.end[2]));
        let paths = paths(motion);
        if paths.is_empty() {
            let centre = Point { x: 1e-3 * motion.end[0], y: 1e-3 * motion.end[1] };
            let depth = self.depth(self.distance(centre), 1e-3 * low, tool);
            let length = 1e-3 * high.min(1e3 * self.top) - 1e-3 * low;
            return (depth > LEAST).then_some(Gouge { depth, place: centre, length });
        }
        let mut found: Option<Gouge> = None;
        for path in &paths {
            let Some((depth, place)) = self.deepest(path, tool) else { continue };
            let (section, from, to) = path;
            let deep = |i: u32| {
                let share = (f64::from(i) + 0.5) / f64::from(SAMPLES);
                let distance = self.distance(section.at(section.length * share));
                self.depth(distance, from + (to - from) * share, tool) > LEAST
            };
            // A gouge between two samples is shorter than their distance.
            let share = (0..SAMPLES).filter(|i| deep(*i)).count().max(1) as f64 / f64::from(SAMPLES);
            let before = found.map_or(0.0, |found| found.length);
            let length = before + section.length * share;
            found = match found {
                Some(deeper) if deeper.depth >= depth => Some(Gouge { length, ..deeper }),
                Some(_) | None => Some(Gouge { depth, place, length }),
            };
        }
        found
    }

    /// Depth of a cutter whose axis is `distance` from the part and whose tip is at the height `tip`, m; not positive where it
    /// does not reach into it.
    fn depth(&self, distance: f64, tip: f64, tool: &Tool) -> f64 {
        let below = self.top - tip;
        if below <= 0.0 {
            return below;
        }
        (tool.end.at(tool.radius, below).0 - distance).min(below)
    }

    /// The greatest depth along a path of more than a micrometre, m, and where it is.
    fn deepest(&self, (section, from, to): &(Section, f64, f64), tool: &Tool) -> Option<(f64, Point)> {
        let height = |way: f64| from + (to - from) * way / section.length;
        let distance = |way: f64| self.distance(section.at(way));
        let ends = [0.0, section.length].map(|way| (way, distance(way)));
        let mut best = (LEAST, None);
        let mut open = vec![(ends[0], ends[1])];
        let take = |(way, distance): (f64, f64), best: &mut (f64, Option<Point>)| {
            let depth = self.depth(distance, height(way), tool);
            if depth > best.0 {
                *best = (depth, Some(section.at(way)));
            }
        };
        ends.into_iter().for_each(|end| take(end, &mut best));
        while let Some((a, b)) = open.pop() {
            let (step, nearest) = (b.0 - a.0, a.1.min(b.1));
            // Distances of the outline's elements on the step are no less than this.
            let least = nearest.abs() - 0.5 * step;
            let bend =
                if least > 0.0 { 0.125 * step * step * (1.0 / least + section.curvature.abs()) } else { 0.5 * step };
            let lowest = height(a.0).min(height(b.0));
            let bound = self.depth(nearest - bend.min(0.5 * step), lowest, tool);
            if bound <= best.0 + FINE || step <= SHORTEST {
                continue;
            }
            let way = 0.5 * (a.0 + b.0);
            let middle = (way, distance(way));
            take(middle, &mut best);
            open.extend([(middle, b), (a, middle)]);
        }
        best.1.map(|place| (best.0, place))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::End;
    use toolroom_contour::Trace;
    use toolroom_program::{Control, EventKind, Run};

    /// A square of 40 mm with its corner at the origin.
    fn part(pocket: bool) -> Part {
        let mut trace = Trace::new(Point::default(), 0.0);
        for (x, y) in [(0.04, 0.0), (0.04, 0.04), (0.0, 0.04), (0.0, 0.0)] {
            trace.line_to(Point { x, y }).expect("a line");
        }
        Part { outline: Arc::new(Profile::new(&trace.outline().expect("closed"), 0.0)), pocket, top: 0.0 }
    }

    fn gouges(text: &str, part: &Part, end: End) -> Vec<Option<Gouge>> {
        let tool = Tool { radius: 5e-3, end, teeth: 4.0, force: None, holder: None };
        let events = Run::new(&format!("G21 G90 F500\n{text}"), &Control::default()).expect("a program");
        let gouge = |event: EventKind| {
            if let EventKind::Motion(motion) = event { Some(part.gouge(&motion, &tool)) } else { None }
        };
        events.filter_map(|event| gouge(event.expect("a motion").kind)).collect()
    }

    fn depths(text: &str, part: &Part, end: End) -> Vec<f64> {
        gouges(text, part, end).into_iter().map(|found| found.map_or(0.0, |found| 1e6 * found.depth)).collect()
    }

    #[test]
    fn a_wall_a_corner_a_face_and_a_pocket_are_cut_into_as_geometry_says() {
        let close = |found: Vec<f64>, due: &[f64]| {
            assert_eq!(found.len(), due.len(), "{found:?}");
            assert!(found.iter().zip(due).all(|(one, other)| (one - other).abs() < 0.3), "{found:?} {due:?}");
        };
        // Along a wall: just beside it, half a micrometre in it, and 20 µm in it.
        let wall = |y: f64| format!("G0 X-10 Y{y} Z-5\nG1 X50\n");
        close(depths(&wall(-5.0), &part(false), End::Flat), &[0.0, 0.0]);
        close(depths(&wall(-4.9995), &part(false), End::Flat), &[0.0, 0.0]);
        close(depths(&wall(-4.98), &part(false), End::Flat), &[0.0, 20.0]);
        // Past a corner at 45°, whose tip lies 10 µm within the cutter, wherever it is on the long way.
        let past = 5.0 * 2f64.sqrt() - 0.010 * 2f64.sqrt();
        let text = format!("G0 X-30 Y{} Z-5\nG1 X{} Y-30\n", 30.0 - past, 30.0 - past);
        close(depths(&text, &part(false), End::Flat), &[0.0, 10.0]);
        // 30 µm below the upper face, above it, and straight down into it.
        close(depths("G0 X-10 Y20 Z-0.03\nG1 X50\n", &part(false), End::Flat), &[0.0, 30.0]);
        close(depths("G0 X-10 Y20 Z0\nG1 X50\n", &part(false), End::Flat), &[0.0, 0.0]);
        close(depths("G0 X20 Y20 Z5\nG1 Z-0.5\n", &part(false), End::Flat), &[0.0, 500.0]);
        // Around the inside of a pocket, 50 µm too far along one wall: where it comes and where it leaves, too.
        let inside = "G0 X5 Y5 Z5\nG1 Z-3\nX35.05\nY35\nX5\nY5\n";
        close(depths(inside, &part(true), End::Flat), &[0.0, 0.0, 50.0, 50.0, 50.0, 0.0]);
        // A ball that is 1 mm below the upper face has a radius of 3 mm there.
        close(depths("G0 X-10 Y-3 Z-1\nG1 X50\n", &part(false), End::Corner(5e-3)), &[0.0, 0.0]);
        close(depths("G0 X-10 Y-2.9 Z-1\nG1 X50\n", &part(false), End::Corner(5e-3)), &[0.0, 100.0]);
    }

    #[test]
    fn the_length_of_a_gouge_is_the_way_on_which_it_is_one() {
        // The wall is 40 mm long; past its ends the corners are within the cutter for √(5² − 4.9²) mm more.
        let found = gouges("G0 X-10 Y-4.9 Z-5\nG1 X50\n", &part(false), End::Flat)[1].expect("a gouge");
        let due = 40.0 + 2.0 * (25.0f64 - 4.9 * 4.9).sqrt();
        assert!((1e3 * found.length - due).abs() < 0.15 && (found.place.y + 4.9e-3).abs() < 1e-12, "{found:?} {due}");
    }
}
