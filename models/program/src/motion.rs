//! What a program makes the machine do.

use std::f64::consts::TAU;

/// Positions of X Y Z in mm, A B C in degrees, U V W in mm.
pub type Axes = [f64; 9];

/// Letters of [`Axes`].
pub const AXES: [char; 9] = ['X', 'Y', 'Z', 'A', 'B', 'C', 'U', 'V', 'W'];

/// Planes of G17, G18 and G19: indices of the first axis, the second and the one across.
pub const PLANES: [[usize; 3]; 3] = [[0, 1, 2], [2, 0, 1], [1, 2, 0]];

/// Number of the G code that chooses a plane of [`PLANES`]: 17, 18 or 19.
pub fn plane_code(plane: [usize; 3]) -> usize {
    17 + PLANES.iter().position(|known| *known == plane).unwrap_or(0)
}

/// A circular path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arc {
    /// Centre in the axes `plane[0]` and `plane[1]`, mm.
    pub centre: [f64; 2],
    /// Indices of the first and second axis of the plane and of the axis across.
    pub plane: [usize; 3],
    /// Whether it turns from the first axis to the second.
    pub left: bool,
    /// Angle with all full turns, rad, above 0.
    pub angle: f64,
    /// Radius, mm, above 0.
    pub radius: f64,
}

/// The path of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Path {
    /// All axes arrive together.
    Line,
    /// A circle or helix.
    Arc(Arc),
}

/// Why an axis moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// Positioning at rapid speed.
    Approach,
    /// Away from the work along Z at rapid speed.
    Retract,
    /// At feed.
    Cut,
    /// At feed straight down along Z.
    Plunge,
    /// Part of a canned cycle.
    Cycle,
    /// With the spindle's turns, which no override changes.
    Thread,
}

/// One motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Whether it runs at rapid speed instead of a feed.
    pub rapid: bool,
    /// Path between start and end.
    pub path: Path,
    /// Where it starts, in the units of [`Axes`]; an axis from an unknown place counts as standing.
    pub start: Axes,
    /// Where it ends, in the units of [`Axes`].
    pub end: Axes,
    /// Time at the programmed feed, s; 0 of a rapid motion.
    pub time: f64,
    /// Length of the path of the linear axes, mm; of the rotary axes, degrees, where only those move.
    pub length: f64,
    /// Whether an axis comes from or goes to a place that only the machine knows.
    pub unknown: bool,
    /// Why it moves.
    pub purpose: Purpose,
}

impl Motion {
    /// Length at feed, mm; 0 of rapid motions and of rotary axes alone.
    pub fn feed_length(&self) -> f64 {
        if self.rapid || self.is_rotary() { 0.0 } else { self.length }
    }

    /// Whether only rotary axes move.
    pub fn is_rotary(&self) -> bool {
        let still = |axis: usize| self.start[axis] == self.end[axis];
        matches!(self.path, Path::Line) && [0, 1, 2, 6, 7, 8].into_iter().all(still)
    }

    /// Longest travel of a linear axis, mm, and of a rotary one, degrees.
    pub fn longest(&self) -> (f64, f64) {
        let travel = |axis: usize| (self.end[axis] - self.start[axis]).abs();
        let linear = [0, 1, 2, 6, 7, 8].into_iter().map(travel).fold(0.0, f64::max);
        (linear, [3, 4, 5].into_iter().map(travel).fold(0.0, f64::max))
    }

    /// Directions of X Y Z at start and end, without unit, each of length 1, or 0 where none of them moves.
    pub fn directions(&self) -> ([f64; 3], [f64; 3]) {
        match self.path {
            Path::Line => {
                let span: [f64; 3] = std::array::from_fn(|axis| self.end[axis] - self.start[axis]);
                let length = norm(span);
                let direction = if length > 0.0 { span.map(|part| part / length) } else { [0.0; 3] };
                (direction, direction)
            }
            Path::Arc(arc) => (arc.tangent(self, &self.start), arc.tangent(self, &self.end)),
        }
    }

    /// Position after a `share` of the path, 0 to 1, in the units of [`Axes`].
    pub fn position(&self, share: f64) -> Axes {
        let mut place: Axes = std::array::from_fn(|i| self.start[i] + share * (self.end[i] - self.start[i]));
        if let Path::Arc(arc) = self.path {
            let [u, v, _] = arc.plane;
            let (x, y) = (self.start[u] - arc.centre[0], self.start[v] - arc.centre[1]);
            let turn = if arc.left { share * arc.angle } else { -share * arc.angle };
            // The end lies on its own radius, which differs by the rounding of the program.
            let stretch = 1.0 + share * (arc.reach(&self.end) / arc.reach(&self.start).max(f64::MIN_POSITIVE) - 1.0);
            let (sin, cos) = turn.sin_cos();
            place[u] = arc.centre[0] + stretch * (cos * x - sin * y);
            place[v] = arc.centre[1] + stretch * (sin * x + cos * y);
        }
        place
    }
}

impl Arc {
    fn reach(&self, axes: &Axes) -> f64 {
        (axes[self.plane[0]] - self.centre[0]).hypot(axes[self.plane[1]] - self.centre[1])
    }

    fn tangent(&self, motion: &Motion, axes: &Axes) -> [f64; 3] {
        let [u, v, w] = self.plane;
        let arm = [axes[u] - self.centre[0], axes[v] - self.centre[1]];
        let reach = arm[0].hypot(arm[1]).max(f64::MIN_POSITIVE);
        let sign = if self.left { 1.0 } else { -1.0 };
        let (round, rise) = (self.radius * self.angle, motion.end[w] - motion.start[w]);
        let length = round.hypot(rise).max(f64::MIN_POSITIVE);
        let mut direction = [0.0; 3];
        direction[u] = -sign * arm[1] / reach * round / length;
        direction[v] = sign * arm[0] / reach * round / length;
        direction[w] = rise / length;
        direction
    }
}

pub(crate) fn norm(a: [f64; 3]) -> f64 {
    (a[0] * a[0] + a[1] * a[1] + a[2] * a[2]).sqrt()
}

/// Angle turned from `start` to `end` around `centre`, rad, above 0 and at most a full turn: the same point twice is a
/// full circle.
pub(crate) fn sweep(start: [f64; 2], end: [f64; 2], centre: [f64; 2], left: bool) -> f64 {
    let (a, b) = ([start[0] - centre[0], start[1] - centre[1]], [end[0] - centre[0], end[1] - centre[1]]);
    let cross = a[0] * b[1] - a[1] * b[0];
    let dot = a[0] * b[0] + a[1] * b[1];
    let turn = if left { cross.atan2(dot) } else { (-cross).atan2(dot) };
    let turn = turn.rem_euclid(TAU);
    let chord = (end[0] - start[0]).hypot(end[1] - start[1]);
    // Ends are rounded to the last digits: a point within a nanometre is the same point.
    if chord < 1e-6 || turn == 0.0 { TAU } else { turn }
}

/// Distance by which the end of an arc may miss its circle, mm: 0.01 mm or 0.2 % of the radius (assumption; controls have
/// it as a parameter).
pub(crate) fn arc_tolerance(radius: f64) -> f64 {
    0.01_f64.max(2e-3 * radius)
}

/// Centre of the arc of `radius` from `start` to `end`; a negative radius takes the long way. `None` where the points
/// coincide or are too far apart.
pub(crate) fn centre_by_radius(start: [f64; 2], end: [f64; 2], radius: f64, left: bool) -> Option<[f64; 2]> {
    let chord = [end[0] - start[0], end[1] - start[1]];
    let span = chord[0].hypot(chord[1]);
    let height = radius * radius - 0.25 * span * span;
    // Half a chord may exceed the radius by the tolerance of the end point.
    let excess = 0.5 * span - radius.abs();
    if span == 0.0 || radius == 0.0 || excess > arc_tolerance(radius.abs()) {
        return None;
    }
    let side = if left == (radius > 0.0) { 1.0 } else { -1.0 };
    let height = side * height.max(0.0).sqrt() / span;
    Some([0.5 * (start[0] + end[0]) - height * chord[1], 0.5 * (start[1] + end[1]) + height * chord[0]])
}

/// How the spindle turns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sense {
    /// M3.
    Clockwise,
    /// M4.
    Counterclockwise,
    /// M5.
    Still,
    /// It stands at its angle: M19, and the cycles that move a tool out of a bore beside its wall.
    Oriented,
}

impl Sense {
    /// Whether the spindle does not turn.
    pub fn stands(self) -> bool {
        matches!(self, Self::Still | Self::Oriented)
    }

    /// The other way round; what stands goes on standing.
    pub fn reversed(self) -> Self {
        match self {
            Self::Clockwise => Self::Counterclockwise,
            Self::Counterclockwise => Self::Clockwise,
            Self::Still | Self::Oriented => self,
        }
    }
}

/// What a table of the control adds to programmed positions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Offset {
    /// Work offset by its number: from 0 on G54 to G59, from 6 on G59.1 to G59.3, from 100 on G54.1 P1 and on, or G505 and on; 99 is none,
    /// G500. Datums 1 to 99 of Klartext are one less, those from 100 on their own number, datum 0 is 10 000. It is told where how it lies
    /// to the first one is not known; else motions are in the coordinates of that.
    Work(u32),
    /// Length of the tool by its register; `None` where it is switched off.
    Length(Option<u32>),
}

/// What happens.
// Events are read one after the other and motions are most of them: a box for each would only cost time.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EventKind {
    /// A block of the program begins.
    Block,
    /// A motion.
    Motion(Motion),
    /// A dwell, s.
    Dwell(f64),
    /// The tool changes to this number, where one was called.
    ToolChange(Option<u32>),
    /// The spindle is commanded, rpm.
    Spindle {
        /// Speed, rpm; 0 where it stands.
        speed: f64,
        /// How it turns.
        sense: Sense,
    },
    /// Coolant on or off.
    Coolant(bool),
    /// A stop, such as M0; true where the operator chooses, as with M1.
    Stop(bool),
    /// An auxiliary function: number of its M code, and its time, s.
    Auxiliary(u32, f64),
    /// A hole of a canned cycle is finished.
    Hole,
    /// The axes come to rest though the path goes on.
    ExactStop,
    /// These axes, in the order of [`AXES`], are at their reference point or at another place of the machine.
    Home([bool; 9]),
    /// An offset from a table of the control.
    Offset(Offset),
    /// The program ends.
    End,
}

/// Something that happens, with its place in the program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    /// Line of the file that runs, from 1.
    pub line: usize,
    /// Line of the main program that it belongs to: of the call, for a subprogram.
    pub main_line: usize,
    /// Depth of subprograms, 0 for the main program.
    pub depth: usize,
    /// What happens.
    pub kind: EventKind,
}

/// Centre and sense of the circle through three points.
pub(crate) fn circle(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> Option<([f64; 2], bool)> {
    let (p, q) = ([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]]);
    let cross = p[0] * q[1] - p[1] * q[0];
    let size = (p[0].hypot(p[1]) * q[0].hypot(q[1])).max(f64::MIN_POSITIVE);
    if (cross / size).abs() < 1e-9 {
        return None;
    }
    let (pp, qq) = (p[0] * p[0] + p[1] * p[1], q[0] * q[0] + q[1] * q[1]);
    let centre = [a[0] + 0.5 * (q[1] * pp - p[1] * qq) / cross, a[1] + 0.5 * (p[0] * qq - q[0] * pp) / cross];
    Some((centre, cross > 0.0))
}

/// Centre and sense of the arc from `a` to `b` that begins along `direction`; `None` on a line.
pub(crate) fn tangent(a: [f64; 2], b: [f64; 2], direction: [f64; 2]) -> Option<([f64; 2], bool)> {
    let size = direction[0].hypot(direction[1]);
    let chord = [b[0] - a[0], b[1] - a[1]];
    if size == 0.0 {
        return None;
    }
    let d = [direction[0] / size, direction[1] / size];
    let side = d[0] * chord[1] - d[1] * chord[0];
    let square = chord[0] * chord[0] + chord[1] * chord[1];
    if side.abs() < 1e-9 * square.sqrt().max(f64::MIN_POSITIVE) {
        return None;
    }
    let radius = 0.5 * square / side;
    Some(([a[0] - radius * d[1], a[1] + radius * d[0]], radius > 0.0))
}
