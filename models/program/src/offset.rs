//! Compensation of the cutter's radius: the path of its centre beside the programmed contour.

use crate::error::Fault;
use crate::motion::{Arc, Axes, Event, EventKind, Motion, Path, Purpose, norm, sweep};

type Point = [f64; 2];

/// What joins the offset elements at an outer corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Corner {
    /// An arc about the corner: LinuxCNC, Heidenhain, Haas, Siemens G450.
    Round,
    /// The elements go straight on to where they meet; beyond 90 degrees a chamfer cuts the tip: Fanuc, Siemens G451.
    Extended,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Stage {
    Starting,
    Running,
    /// The next motion in the plane leads from the cutter's centre to the programmed end.
    Leaving(Point),
}

/// Compensation in force.
pub(crate) struct Offsetting {
    left: bool,
    radius: f64,
    plane: [usize; 3],
    corner: Corner,
    stage: Stage,
    /// Whether the first motion behind the contour leads back to the programmed path even where it leaves the plane, as on
    /// LinuxCNC (its interpreter rs274 shows it); elsewhere the first motion in the plane does.
    at_once: bool,
    /// Whether F holds on the contour instead of the path of the cutter's centre.
    at_contour: bool,
    /// Whether it begins and ends around an outer corner, instead of straight from and to the programmed path.
    around: bool,
    /// Where the last element ended on the contour, with its direction there.
    last: Option<(Point, Point)>,
    /// The motion whose end waits for the next, with its centre path up to now.
    waiting: Option<(Motion, Event)>,
    /// What happens behind the waiting motion.
    held: Vec<Event>,
    lifts: usize,
}

const SAME: f64 = 1e-7;

fn length(a: Point) -> f64 {
    a[0].hypot(a[1])
}

fn less(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

fn along(a: Point, b: Point, share: f64) -> Point {
    [a[0] + share * b[0], a[1] + share * b[1]]
}

fn cross(a: Point, b: Point) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

impl Offsetting {
    pub fn new(left: bool, radius: f64, plane: [usize; 3], corner: Corner) -> Self {
        // A negative radius is one on the other side.
        let (left, radius) = if radius < 0.0 { (!left, -radius) } else { (left, radius) };
        let stage = Stage::Starting;
        let (at_once, at_contour, around) = (false, false, false);
        let (last, waiting, held) = (None, None, Vec::new());
        Self { left, radius, plane, corner, stage, at_once, at_contour, around, last, waiting, held, lifts: 0 }
    }

    /// The same on the other side where `mirrored` says so.
    pub fn mirrored(self, mirrored: bool) -> Self {
        Self { left: self.left != mirrored, ..self }
    }

    /// The same with F on the contour where `at_contour` says so.
    pub fn fed(self, at_contour: bool) -> Self {
        Self { at_contour, ..self }
    }

    /// The same, begun and ended around an outer corner where `around` says so.
    pub fn led(self, around: bool) -> Self {
        Self { around, ..self }
    }

    /// Whether the path turns away from the cutter.
    fn turns_outwards(&self, leaving: Point, entering: Point) -> bool {
        let turn = cross(leaving, entering);
        if self.left { turn < -SAME } else { turn > SAME }
    }

    /// Where the cutter stands behind the contour, beside the programmed place `start`; `None` before the contour ends.
    pub fn standing(&self, mut start: Axes) -> Option<Axes> {
        let Stage::Leaving(place) = self.stage else { return None };
        (start[self.plane[0]], start[self.plane[1]]) = (place[0], place[1]);
        Some(start)
    }

    /// The same, left by the first motion of all.
    pub fn left_at_once(self) -> Self {
        Self { at_once: true, ..self }
    }

    /// Whether a motion, `flat` where it leaves the plane alone, leads back to the programmed path.
    pub fn leaves_by(&self, flat: bool) -> bool {
        self.is_leaving() && (!flat || self.at_once)
    }

    pub fn is_waiting(&self) -> bool {
        self.waiting.is_some()
    }

    pub fn hold(&mut self, kind: EventKind) {
        if let Some((_, place)) = self.waiting {
            self.held.push(Event { kind, ..place });
        }
    }

    fn pick(&self, at: &[f64; 9]) -> Point {
        [at[self.plane[0]], at[self.plane[1]]]
    }

    /// Unit vector from a point of the contour to the cutter's centre, where the path runs along `direction`.
    fn normal(&self, direction: Point) -> Point {
        if self.left { [-direction[1], direction[0]] } else { [direction[1], -direction[0]] }
    }

    fn directions(&self, motion: &Motion) -> (Point, Point) {
        let (a, b) = motion.directions();
        let flat = |d: [f64; 3]| {
            let in_plane = [d[self.plane[0]], d[self.plane[1]]];
            let size = length(in_plane).max(f64::MIN_POSITIVE);
            [in_plane[0] / size, in_plane[1] / size]
        };
        (flat(a), flat(b))
    }

    /// Takes the next programmed motion; gives those that are known now.
    pub fn take(&mut self, motion: Motion, place: Event) -> Result<Vec<Event>, Fault> {
        let [u, v, _] = self.plane;
        let flat =
            motion.start[u] == motion.end[u] && motion.start[v] == motion.end[v] && matches!(motion.path, Path::Line);
        if flat && !self.leaves_by(flat) {
            if self.waiting.is_none() {
                return Ok(vec![Event { kind: EventKind::Motion(self.lifted(motion)), ..place }]);
            }
            self.lifts += 1;
            if self.lifts > 2 {
                return Err(Fault::new(
                    "more than two blocks without a motion in the plane stand within the compensation of the radius: \
                     the control cannot see the next corner",
                ));
            }
            self.held.push(Event { kind: EventKind::Motion(motion), ..place });
            return Ok(Vec::new());
        }
        self.lifts = 0;
        if let Stage::Leaving(from) = self.stage {
            if matches!(motion.path, Path::Arc(_)) {
                return Err(Fault::new("the compensation of the radius ends in an arc; end it in a straight motion"));
            }
            let end = self.pick(&motion.end);
            let mut out = Vec::new();
            let mut from = from;
            if let Some((corner, leaving)) = self.last.take().filter(|_| self.around) {
                let (entering, _) = self.directions(&motion);
                if self.turns_outwards(leaving, entering) {
                    let start = along(corner, self.normal(entering), self.radius);
                    self.outer(&mut out, &motion, (from, start), corner, (leaving, entering), place);
                    from = start;
                }
            }
            out.push(Event { kind: EventKind::Motion(self.between(&motion, from, end)), ..place });
            return Ok(out);
        }
        let Some((before, before_place)) = self.waiting.take() else {
            if matches!(motion.path, Path::Arc(_)) {
                return Err(Fault::new(
                    "the compensation of the radius begins in an arc; begin it in a straight motion",
                ));
            }
            self.waiting = Some((motion, place));
            return Ok(Vec::new());
        };
        let mut out = Vec::new();
        let starting = self.stage == Stage::Starting;
        let corner = self.pick(&motion.start);
        let ((_, leaving), (entering, _)) = (self.directions(&before), self.directions(&motion));
        let start = along(corner, self.normal(entering), self.radius);
        let mut next = self.beside(&motion, before_place.line, place.line)?;
        if starting {
            self.stage = Stage::Running;
            // The cutter comes to the point beside the beginning of the first element, or first beside the end of its way there.
            let around = self.around && self.turns_outwards(leaving, entering);
            let to = if around { along(corner, self.normal(leaving), self.radius) } else { start };
            let first = self.between(&before, self.pick(&before.start), to);
            out.push(Event { kind: EventKind::Motion(first), ..before_place });
            self.release(&mut out, to);
            if around {
                self.outer(&mut out, &motion, (to, start), corner, (leaving, entering), place);
            }
        } else {
            let end = along(corner, self.normal(leaving), self.radius);
            let turn = cross(leaving, entering);
            let inner = if self.left { turn > 0.0 } else { turn < 0.0 };
            if length(less(end, start)) < SAME {
                out.push(Event { kind: EventKind::Motion(before), ..before_place });
                self.release(&mut out, start);
            } else if inner {
                let meet =
                    self.meet(&before, &next, corner).ok_or_else(|| self.tight(before_place.line, place.line))?;
                let first =
                    self.trim(&before, None, Some(meet)).ok_or_else(|| self.tight(before_place.line, place.line))?;
                out.push(Event { kind: EventKind::Motion(first), ..before_place });
                self.release(&mut out, meet);
                next = self.trim(&next, Some(meet), None).ok_or_else(|| self.tight(before_place.line, place.line))?;
            } else {
                out.push(Event { kind: EventKind::Motion(before), ..before_place });
                self.release(&mut out, end);
                self.outer(&mut out, &motion, (end, start), corner, (leaving, entering), place);
            }
        }
        self.waiting = Some((next, place));
        Ok(out)
    }

    fn tight(&self, previous: usize, after: usize) -> Fault {
        Fault::new(format!(
            "the cutter of {} mm does not fit between lines {previous} and {after}: take a smaller one or another contour",
            2.0 * self.radius
        ))
    }

    /// Gives what was held, at the place where the cutter stands.
    fn release(&mut self, out: &mut Vec<Event>, end: Point) {
        let [u, v, _] = self.plane;
        for mut event in self.held.drain(..) {
            if let EventKind::Motion(motion) = &mut event.kind {
                for (axis, place) in [(u, end[0]), (v, end[1])] {
                    (motion.start[axis], motion.end[axis]) = (place, place);
                }
            }
            out.push(event);
        }
    }

    /// A motion across the plane while nothing waits, beside the contour.
    fn lifted(&self, mut motion: Motion) -> Motion {
        if let Stage::Leaving(at) = self.stage {
            for (axis, place) in [(self.plane[0], at[0]), (self.plane[1], at[1])] {
                (motion.start[axis], motion.end[axis]) = (place, place);
            }
        }
        motion
    }

    /// A straight motion between other points of the plane, at the same feed.
    fn between(&self, motion: &Motion, start: Point, end: Point) -> Motion {
        let mut straight = *motion;
        let [u, v, _] = self.plane;
        (straight.start[u], straight.start[v], straight.end[u], straight.end[v]) = (start[0], start[1], end[0], end[1]);
        straight.path = Path::Line;
        straight.length = norm(std::array::from_fn(|i| straight.end[i] - straight.start[i]));
        straight.time = if motion.length > 0.0 { motion.time * straight.length / motion.length } else { 0.0 };
        straight
    }

    /// The motion moved sideways by the radius.
    fn beside(&self, motion: &Motion, previous: usize, line: usize) -> Result<Motion, Fault> {
        let (first, last) = self.directions(motion);
        let start = along(self.pick(&motion.start), self.normal(first), self.radius);
        let end = along(self.pick(&motion.end), self.normal(last), self.radius);
        match motion.path {
            Path::Line => Ok(self.between(motion, start, end)),
            Path::Arc(arc) => {
                // A cutter on the inner side of an arc runs on a smaller one.
                let radius = if arc.left == self.left { arc.radius - self.radius } else { arc.radius + self.radius };
                if radius <= SAME {
                    return Err(Fault::new(format!(
                        "the inner arc of {} mm in line {line} is no larger than that of the cutter, {} mm, whose centre then has \
                         no path beside it: it does not fit between lines {previous} and {line}, take a smaller cutter or a larger arc",
                        arc.radius, self.radius
                    )));
                }
                let mut arc_motion = *motion;
                let [u, v, _] = self.plane;
                (arc_motion.start[u], arc_motion.start[v], arc_motion.end[u], arc_motion.end[v]) =
                    (start[0], start[1], end[0], end[1]);
                let paced = self.paced(arc_motion, Arc { radius, ..arc }, motion);
                // The centre takes as long as the point of the contour beside it: its feed is F·(R ± r)/R.
                Ok(if self.at_contour { Motion { time: motion.time, ..paced } } else { paced })
            }
        }
    }

    /// An arc with the feed of `motion`.
    fn paced(&self, mut result: Motion, arc: Arc, motion: &Motion) -> Motion {
        let w = self.plane[2];
        result.path = Path::Arc(arc);
        result.length = (arc.radius * arc.angle).hypot(result.end[w] - result.start[w]);
        result.time = if motion.length > 0.0 { motion.time * result.length / motion.length } else { 0.0 };
        result
    }

    /// The motion from `start` or to `end` instead; `None` where nothing is left of it.
    fn trim(&self, motion: &Motion, start: Option<Point>, end: Option<Point>) -> Option<Motion> {
        let from = start.unwrap_or_else(|| self.pick(&motion.start));
        let to = end.unwrap_or_else(|| self.pick(&motion.end));
        match motion.path {
            Path::Line => {
                let (direction, _) = self.directions(motion);
                (dot(less(to, from), direction) > -SAME).then(|| self.between(motion, from, to))
            }
            Path::Arc(arc) => {
                let mut part = *motion;
                let [u, v, _] = self.plane;
                (part.start[u], part.start[v], part.end[u], part.end[v]) = (from[0], from[1], to[0], to[1]);
                let full = std::f64::consts::TAU * (arc.angle / std::f64::consts::TAU - 1e-12).floor().max(0.0);
                let angle = sweep(from, to, arc.centre, arc.left) + full;
                (angle <= arc.angle + 1e-7).then(|| self.paced(part, Arc { angle, ..arc }, motion))
            }
        }
    }

    /// Where the centre paths of two elements meet, nearest to the corner.
    fn meet(&self, a: &Motion, b: &Motion, corner: Point) -> Option<Point> {
        let line = |motion: &Motion| (self.pick(&motion.start), self.directions(motion).0);
        let mut found: Vec<Point> = Vec::new();
        match (a.path, b.path) {
            (Path::Line, Path::Line) => {
                let ((p, d), (q, e)) = (line(a), line(b));
                let denominator = cross(d, e);
                if denominator.abs() > 1e-12 {
                    found.push(along(p, d, cross(less(q, p), e) / denominator));
                }
            }
            (Path::Line, Path::Arc(arc)) => found.extend(line_circle(line(a), arc.centre, arc.radius)),
            (Path::Arc(arc), Path::Line) => found.extend(line_circle(line(b), arc.centre, arc.radius)),
            (Path::Arc(one), Path::Arc(two)) => {
                let gap = less(two.centre, one.centre);
                let distance = length(gap);
                if distance > SAME {
                    let x =
                        (distance * distance + one.radius * one.radius - two.radius * two.radius) / (2.0 * distance);
                    let height = one.radius * one.radius - x * x;
                    if height >= 0.0 {
                        let unit = [gap[0] / distance, gap[1] / distance];
                        let foot = along(one.centre, unit, x);
                        for side in [height.sqrt(), -height.sqrt()] {
                            found.push(along(foot, [-unit[1], unit[0]], side));
                        }
                    }
                }
            }
        }
        let distance = |point: &Point| length(less(*point, corner));
        found.into_iter().filter(|point| point[0].is_finite()).min_by(|p, q| distance(p).total_cmp(&distance(q)))
    }

    /// Joins the centre paths at an outer corner.
    fn outer(
        &self,
        out: &mut Vec<Event>,
        motion: &Motion,
        (end, start): (Point, Point),
        corner: Point,
        (leaving, entering): (Point, Point),
        place: Event,
    ) {
        let mut add = |motion: Motion| out.push(Event { kind: EventKind::Motion(motion), ..place });
        let mut flat = *motion;
        flat.end = motion.start;
        if self.corner == Corner::Round {
            let [u, v, _] = self.plane;
            let mut round = flat;
            (round.start[u], round.start[v], round.end[u], round.end[v]) = (end[0], end[1], start[0], start[1]);
            let left = !self.left;
            // Nearly straight on, the chord says nothing of the turn.
            let angle = cross(leaving, entering).abs().atan2(dot(leaving, entering));
            add(self.paced(round, Arc { centre: corner, plane: self.plane, left, angle, radius: self.radius }, motion));
            return;
        }
        let pace = |from: Point, to: Point| {
            let mut line = self.between(&flat, from, to);
            line.time = if motion.length > 0.0 { motion.time * line.length / motion.length } else { 0.0 };
            line.purpose = Purpose::Cut;
            line
        };
        if dot(leaving, entering) >= 0.0 {
            let half = 0.5 * dot(leaving, entering).clamp(-1.0, 1.0).acos();
            let tip = along(end, leaving, self.radius * half.tan());
            add(pace(end, tip));
            add(pace(tip, start));
        } else {
            // Beyond 90 degrees both elements go on by the radius, and a chamfer joins them.
            let first = along(end, leaving, self.radius);
            let second = along(start, entering, -self.radius);
            add(pace(end, first));
            add(pace(first, second));
            add(pace(second, start));
        }
    }

    /// Ends the last element beside its end; the cutter's centre leaves from there.
    pub fn finish(&mut self) -> Result<Vec<Event>, Fault> {
        let mut out = Vec::new();
        if let Some((motion, place)) = self.waiting.take() {
            if self.stage == Stage::Starting {
                return Err(Fault::new("the compensation of the radius ends with the motion in which it begins"));
            }
            let end = self.pick(&motion.end);
            let (_, leaving) = self.directions(&motion);
            self.last = Some((along(end, self.normal(leaving), -self.radius), leaving));
            out.push(Event { kind: EventKind::Motion(motion), ..place });
            self.release(&mut out, end);
            self.stage = Stage::Leaving(end);
        }
        Ok(out)
    }

    /// Whether the cutter's centre still has to come back to the programmed path.
    pub fn is_leaving(&self) -> bool {
        matches!(self.stage, Stage::Leaving(_))
    }
}

fn line_circle((p, d): (Point, Point), centre: Point, radius: f64) -> Vec<Point> {
    let gap = less(p, centre);
    let half = dot(gap, d);
    let rest = half * half - (dot(gap, gap) - radius * radius);
    if rest < 0.0 { Vec::new() } else { [-half - rest.sqrt(), -half + rest.sqrt()].map(|t| along(p, d, t)).to_vec() }
}
