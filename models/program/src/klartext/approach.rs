//! Approach to a contour and departure from it: APPR and DEP with LT, LN, CT and LCT.

use super::Klartext;
use super::block::Words;
use super::contour::{Corner, Element};
use crate::error::Fault;
use crate::kernel::{Kernel, Round, Target};
use crate::motion::{Axes, centre_by_radius};

/// How the contour is met.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Way {
    /// A straight line in the direction of the contour.
    LineTangent,
    /// A straight line across the contour.
    LineNormal,
    /// An arc.
    Arc,
    /// An arc and the straight line that touches it.
    LineArc,
}

impl Way {
    fn of(word: &str) -> Option<Self> {
        Some(match word {
            "LT" => Self::LineTangent,
            "LN" => Self::LineNormal,
            "CT" => Self::Arc,
            "LCT" => Self::LineArc,
            _ => return None,
        })
    }
}

/// An approach that waits for the first element of its contour.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Approach {
    way: Way,
    /// The first point of the contour.
    target: Target,
    /// LEN or R, mm.
    size: f64,
    /// CCA, rad.
    angle: f64,
    side: Option<char>,
    feed: (Option<f64>, f64),
    rapid: bool,
    line: usize,
}

type Point = [f64; 2];

fn along(a: Point, b: Point, share: f64) -> Point {
    [a[0] + share * b[0], a[1] + share * b[1]]
}

/// A vector turned by a right angle to the left, or to the right.
fn across(direction: Point, left: bool) -> Point {
    if left { [-direction[1], direction[0]] } else { [direction[1], -direction[0]] }
}

/// The tangent point of a circle as seen from `point`: there a line from `point` goes on as the arc that turns left or
/// right about `centre`; `None` inside of it.
fn touch(point: Point, centre: Point, radius: f64, left: bool) -> Option<Point> {
    let gap = [point[0] - centre[0], point[1] - centre[1]];
    let distance = gap[0].hypot(gap[1]);
    if distance <= radius {
        return None;
    }
    let turn = (radius / distance).acos();
    let angle = gap[1].atan2(gap[0]) + if left { turn } else { -turn };
    Some(along(centre, [angle.cos(), angle.sin()], radius))
}

/// A point turned about `centre`, rad, to the left.
fn turned(point: Point, centre: Point, angle: f64) -> Point {
    let arm = [point[0] - centre[0], point[1] - centre[1]];
    let (sin, cos) = angle.sin_cos();
    [centre[0] + cos * arm[0] - sin * arm[1], centre[1] + sin * arm[0] + cos * arm[1]]
}

/// A place in a plane, by the numbers of its two axes.
fn in_plane([u, v]: [usize; 2], place: Point) -> Target {
    let mut target = Target::default();
    (target.absolute[u], target.absolute[v]) = (Some(place[0]), Some(place[1]));
    target
}

/// The first motion of a block, which has the block's height along `axis`.
fn with_height(mut target: Target, block: &Target, axis: usize) -> Target {
    (target.absolute[axis], target.step[axis]) = (block.absolute[axis], block.step[axis]);
    target
}

/// Ends the compensation of the radius where the tool stands: that is the place from which the next motion counts.
fn leave_contour(kernel: &mut Kernel) -> Result<(), Fault> {
    kernel.finish_offset()?;
    if let Some(place) = kernel.offset.as_ref().and_then(|offset| offset.standing(kernel.at)) {
        kernel.at = place;
        kernel.offset = None;
    }
    Ok(())
}

impl Approach {
    /// The first point of the contour; `start` is where the approach begins.
    pub fn end(&self, start: &Axes) -> Axes {
        std::array::from_fn(|axis| self.target.end(axis, start))
    }
}

/// What stands behind the kind of an approach or departure.
struct Sizes {
    /// Those of a positioning block, R among them.
    words: Words,
    /// LEN, mm.
    len: Option<f64>,
    /// CCA, rad.
    angle: Option<f64>,
}

impl Klartext {
    /// Words of APPR or DEP behind the kind.
    fn sizes(&self, list: &[(String, usize)], kernel: &Kernel) -> Result<Sizes, Fault> {
        let (mut rest, mut len, mut angle) = (Vec::new(), None, None);
        for (word, column) in list {
            if let Some(text) = word.strip_prefix("LEN") {
                len = Some(kernel.length(self.value(text, *column)?)?);
            } else if let Some(text) = word.strip_prefix("CCA") {
                angle = Some(self.value(text, *column)?.to_radians());
            } else {
                rest.push((word.clone(), *column));
            }
        }
        let words = self.words(&rest, kernel)?;
        Ok(Sizes { words, len, angle })
    }

    fn way(word: &str, column: usize) -> Result<Way, Fault> {
        Way::of(word).ok_or_else(|| {
            Fault::at(column, format!("{word} is no approach that is followed; LT, LN, CT and LCT are, by X and Y"))
        })
    }

    /// The radius of the arc that the cutter's edge draws where its centre runs on one of `radius`, mm; negative comes from, or
    /// leaves to, the side of the work. R of an arc of approach or departure is that of the path of the tool's centre, which lies
    /// inside of the arc of the edge on the side of the tool and outside of it on the side of the work.
    fn edge_radius(&self, radius: f64, kernel: &Kernel) -> Result<f64, Fault> {
        let cutter = self.cutter_radius(kernel).unwrap_or(0.0);
        let edge = if radius < 0.0 { -radius - cutter } else { radius + cutter };
        if edge > 0.0 && radius != 0.0 {
            return Ok(edge);
        }
        Err(Fault::new(if radius == 0.0 {
            "the arc of the approach or departure has the radius 0: give R, that of the path of the tool's centre"
                .to_owned()
        } else {
            format!(
                "the cutter of {} mm does not fit outside of an arc of R{radius}, the path of its centre: take a larger R",
                2.0 * cutter
            )
        }))
    }

    /// `APPR LCT X+10 Y+20 R5 RL F300`: waits for the element behind it, whose direction it needs.
    pub(super) fn approach(&mut self, list: &[(String, usize)], kernel: &mut Kernel) -> Result<(), Fault> {
        let column = list.get(1).map_or(1, |(_, column)| *column);
        let way = Self::way(list.get(1).map_or("", |(word, _)| word.as_str()), column)?;
        let Sizes { words, len, angle } = self.sizes(list.get(2..).unwrap_or_default(), kernel)?;
        let radius = words.radius;
        self.flush(kernel)?;
        self.before(&words.m, kernel)?;
        self.feed(&words, kernel)?;
        let size = match way {
            Way::LineTangent | Way::LineNormal => {
                len.ok_or_else(|| Fault::new("the approach needs LEN, its length"))?
            }
            Way::Arc | Way::LineArc => radius.ok_or_else(|| Fault::new("the approach needs R, its radius"))?,
        };
        let angle = match (way, angle) {
            (Way::Arc, None) => return Err(Fault::new("the approach needs CCA, the angle of its arc")),
            (_, angle) => angle.unwrap_or(0.0),
        };
        let side = words.side;
        if side.is_none_or(|side| side == '0') && matches!(way, Way::LineNormal | Way::Arc | Way::LineArc) {
            return Err(Fault::new("the approach needs RL or RR: without it nothing says from which side it comes"));
        }
        let feed = (kernel.feed, kernel.feed_scale);
        let line = kernel.line;
        let Words { target, fmax: rapid, .. } = words;
        self.approach = Some(Approach { way, target, size, angle, side, feed, rapid, line });
        Ok(())
    }

    /// Runs the approach that waits, to the beginning of an element.
    pub(super) fn run_approach(&mut self, corner: &Corner, kernel: &mut Kernel) -> Result<(), Fault> {
        let Some(approach) = self.approach.take() else { return Ok(()) };
        let from = kernel.program_at();
        let start = approach.end(&from);
        let [u, v, w] = kernel.plane;
        let point = [start[u], start[v]];
        let d = self.tangent(corner, &start, kernel).ok_or_else(|| {
            Fault::new("the approach needs an element in the plane behind it, whose direction it takes")
        })?;
        let (feed, line) = ((kernel.feed, kernel.feed_scale), kernel.line);
        (kernel.feed, kernel.feed_scale) = approach.feed;
        kernel.line = approach.line;
        let at = |place: Point| in_plane([u, v], place);
        let at_height = |place: Point| with_height(at(place), &approach.target, w);
        let side = approach.side.filter(|side| *side != '0');
        // A negative radius comes from the side of the work.
        let left = (side == Some('L')) != (approach.size < 0.0);
        let size = approach.size.abs();
        if approach.way != Way::LineNormal
            && let Some(side) = side
        {
            self.side(side, kernel)?;
        }
        match approach.way {
            Way::LineTangent => {
                kernel.straight(&at_height(along(point, d, -size)), approach.rapid)?;
                kernel.straight(&at(point), approach.rapid)?;
            }
            Way::LineNormal => {
                let away = size + self.cutter_radius(kernel).unwrap_or(0.0);
                kernel.straight(&at_height(along(point, across(d, left), away)), approach.rapid)?;
                if let Some(side) = side {
                    self.side(side, kernel)?;
                }
                kernel.straight(&at(point), approach.rapid)?;
            }
            Way::Arc | Way::LineArc => {
                let edge = self.edge_radius(approach.size, kernel)?;
                let centre = along(point, across(d, left), edge);
                let begin = if approach.way == Way::Arc {
                    turned(point, centre, if left { -approach.angle } else { approach.angle })
                } else {
                    let meeting = touch([from[u], from[v]], centre, size, left).ok_or_else(|| {
                        Fault::new("the arc of the approach reaches around its start: take a smaller R")
                    })?;
                    along(centre, [meeting[0] - centre[0], meeting[1] - centre[1]], edge / size)
                };
                kernel.straight(&at_height(begin), approach.rapid)?;
                kernel.round(&at(point), Round::Centre(centre), left, 0.0)?;
            }
        }
        (kernel.feed, kernel.feed_scale) = feed;
        kernel.line = line;
        Ok(())
    }

    /// `DEP CT CCA90 R+5 F300`: leaves the contour and ends the compensation of the radius.
    pub(super) fn depart(&mut self, list: &[(String, usize)], kernel: &mut Kernel) -> Result<(), Fault> {
        let column = list.get(1).map_or(1, |(_, column)| *column);
        let way = Self::way(list.get(1).map_or("", |(word, _)| word.as_str()), column)?;
        let Sizes { words, len, angle } = self.sizes(list.get(2..).unwrap_or_default(), kernel)?;
        let radius = words.radius;
        self.flush(kernel)?;
        self.before(&words.m, kernel)?;
        self.feed(&words, kernel)?;
        let from = kernel.program_at();
        let [u, v, w] = kernel.plane;
        let (point, d) = ([from[u], from[v]], [self.direction[u], self.direction[v]]);
        if d == [0.0; 2] {
            return Err(Fault::new("the departure needs an element in the plane before it, whose direction it takes"));
        }
        let at = |place: Point| in_plane([u, v], place);
        let at_height = |place: Point| with_height(at(place), &words.target, w);
        let side = || kernel.side.ok_or_else(|| Fault::new("the departure has no side: no RL or RR is in force"));
        match way {
            Way::LineTangent => {
                let len = len.ok_or_else(|| Fault::new("the departure needs LEN, its length"))?;
                kernel.straight(&at_height(along(point, d, len)), words.fmax)?;
                leave_contour(kernel)?;
            }
            Way::LineNormal => {
                let len = len.ok_or_else(|| Fault::new("the departure needs LEN, its length"))?;
                let away = len + self.cutter_radius(kernel).unwrap_or(0.0);
                let end = along(point, across(d, side()?), away);
                kernel.finish_offset()?;
                kernel.straight(&at_height(end), words.fmax)?;
            }
            Way::Arc | Way::LineArc => {
                let radius = radius.ok_or_else(|| Fault::new("the departure needs R, its radius"))?;
                let left = side()? != (radius < 0.0);
                let edge = self.edge_radius(radius, kernel)?;
                let centre = along(point, across(d, left), edge);
                let end = if way == Way::Arc {
                    let angle = angle.ok_or_else(|| Fault::new("the departure needs CCA, the angle of its arc"))?;
                    turned(point, centre, if left { angle } else { -angle })
                } else {
                    // The way back is an approach with the other sense.
                    let target = [words.target.end(u, &from), words.target.end(v, &from)];
                    let parting = touch(target, centre, radius.abs(), !left).ok_or_else(|| {
                        Fault::new("the arc of the departure reaches around its end: take a smaller R")
                    })?;
                    along(centre, [parting[0] - centre[0], parting[1] - centre[1]], edge / radius.abs())
                };
                kernel.round(&at(end), Round::Centre(centre), left, 0.0)?;
                leave_contour(kernel)?;
                if way == Way::LineArc {
                    kernel.straight(&words.target, words.fmax)?;
                }
            }
        }
        self.direction = [0.0; 3];
        self.after(&words.m, kernel).map(|_| ())
    }

    /// Keeps the direction in which an element has ended, in coordinates of the program: the element itself may wait for the
    /// compensation of the radius.
    pub(super) fn turn_to(&mut self, element: &Corner, from: &Axes, kernel: &Kernel) {
        let [u, v, _] = kernel.plane;
        let to = kernel.program_at();
        let (start, end) = ([from[u], from[v]], [to[u], to[v]]);
        let vector = match element.element {
            Element::Line => [end[0] - start[0], end[1] - start[1]],
            Element::Arc(round, left, _) => {
                let centre = match round {
                    Round::Centre(centre) => Some(centre),
                    Round::Radius(radius) => centre_by_radius(start, end, radius, left),
                };
                centre.map_or([0.0; 2], |centre| across([end[0] - centre[0], end[1] - centre[1]], left))
            }
        };
        let size = vector[0].hypot(vector[1]);
        // A motion across the plane turns nothing.
        if size > 1e-9 {
            self.direction = [0.0; 3];
            (self.direction[u], self.direction[v]) = (vector[0] / size, vector[1] / size);
        }
    }

    /// Direction in the plane at the start of an element; `None` where it does not move there.
    fn tangent(&self, element: &Corner, from: &Axes, kernel: &Kernel) -> Option<Point> {
        let [u, v, _] = kernel.plane;
        let (start, end) = ([from[u], from[v]], [element.target.end(u, from), element.target.end(v, from)]);
        let vector = match element.element {
            Element::Line => [end[0] - start[0], end[1] - start[1]],
            Element::Arc(round, left, _) => {
                let centre = match round {
                    Round::Centre(centre) => centre,
                    Round::Radius(radius) => centre_by_radius(start, end, radius, left)?,
                };
                across([start[0] - centre[0], start[1] - centre[1]], left)
            }
        };
        let size = vector[0].hypot(vector[1]);
        (size > 1e-9).then(|| vector.map(|part| part / size))
    }
}
