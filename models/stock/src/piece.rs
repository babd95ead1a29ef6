//! A piece of a path through the stock, step by step.

use crate::cutting::{Cut, Cutting, Encounter, Look, MARGIN, Piece, RAMP_RINGS, Sums};
use crate::engaged::Engaged;
use crate::front::{Place, Step};
use crate::load::{Load, Tool, wear_rate};
use crate::swath::{Floors, Swath, by_mean_floors};
use std::f64::consts::PI;
use std::ops::Range;
use std::rc::Rc;
use toolroom_contour::{Section, Track};

/// Difference between bound and samples that is not refined further, rad.
const FINE: f64 = 0.5 * PI / 180.0;
/// Sections of chips of one step differ by no more than this share.
const ALIKE: f64 = 0.1;
/// Half a step is no longer than this share of the cutter's radius.
const LONGEST: f64 = 0.25;
/// Steps are not halved below this share of the cutter's radius.
const SHORTEST: f64 = 0.02;

/// A piece among those of its motion, with who looks: the way before it and the whole way, m.
type PieceInMotion<'r, 'l> = (&'r mut Look<'l>, f64, f64);

/// A step that has not been looked at yet.
struct Open {
    /// Ways along the piece, m.
    from: f64,
    to: f64,
    /// What is engaged there, where that is known.
    ends: [Option<Rc<Engaged>>; 2],
    /// Swaths that may reach it, in the list of all that are looked at.
    near: Range<usize>,
}

impl Open {
    /// Both halves, the later one first.
    fn halves(self, middle: f64, sample: Option<Rc<Engaged>>, near: Range<usize>) -> [Self; 2] {
        let [begin, end] = self.ends;
        let later = Self { from: middle, to: self.to, ends: [sample.clone(), end], near: near.clone() };
        [later, Self { from: self.from, to: middle, ends: [begin, sample], near }]
    }
}

impl Cutting {
    /// Moves a cutter along a piece at a feed, m/s, and a spindle speed, rad/s; the piece is no swath yet.
    pub(crate) fn piece(
        &self,
        piece: &Piece,
        tool: &Tool,
        (feed, speed): (f64, f64),
        (cut, sums): (&mut Cut, &mut Sums),
        mut among: Option<PieceInMotion<'_, '_>>,
    ) {
        let (path, radius) = (&piece.path, tool.radius);
        let low = piece.from.min(piece.to);
        let middle_height = piece.mean();
        // Greatest way of a rim point for a way of the centre.
        let moves = 1.0 + radius * path.curvature.abs();
        let own_way = |way: f64| self.own_way(piece, radius, way);
        let anywhere = |around: &[&Swath], (from, to): (f64, f64), slack: f64| {
            let step = Step::between(path, (from, to), (radius, low), slack);
            self.stock().engaged(around, own_way(from).as_ref(), &step, Floors::Highest)
        };
        let sample = |around: &[&Swath], way: f64, bottom: f64| {
            let heading = path.heading + path.curvature * way;
            let place = Place { centre: path.at(way), radius, bottom, heading };
            self.stock().engaged(around, own_way(way).as_ref(), &Step::at(&place, 0.0), Floors::Highest)
        };
        // On a ramp the end of the cutter takes off what its rim has not: all that stands in its way at the start of a piece.
        // What is counted as removed is what counts as gone in the mean of each piece: steps whose middles lie on the ramp.
        if piece.from != piece.to && middle_height < self.stock().top {
            let around = self.index().near(path.start, radius);
            cut.removed += self.disc_volume(&around, path.start, radius, middle_height, RAMP_RINGS);
        }
        let section_at_mean = |around: &[&Swath], way: f64| {
            let heading = path.heading + path.curvature * way;
            let place = Place { centre: path.at(way), radius, bottom: middle_height, heading };
            self.stock().engaged(around, own_way(way).as_ref(), &Step::at(&place, 0.0), Floors::Mean).area()
        };
        let margin = if among.is_some() { MARGIN } else { 0.0 };
        // Where there has never been anything, no swath is asked.
        let never = anywhere(&[], (0.0, path.length), margin).layers.is_empty();
        // Of what the piece can touch every step can touch a part.
        let mut lists = if never { Vec::new() } else { self.index().along(path, radius) };
        let mut open = vec![Open { from: 0.0, to: path.length, ends: [None, None], near: 0..lists.len() }];
        while let Some(step) = open.pop() {
            let (from, to) = (step.from, step.to);
            let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
            // The lists behind that of the whole are of steps that are done.
            lists.truncate(step.near.end);
            let centre = path.at(middle);
            for i in step.near.clone() {
                let swath: &Swath = lists[i];
                if swath.track.reaches(centre, swath.radius + radius + half) {
                    lists.push(swath);
                }
            }
            let near = step.near.end..lists.len();
            let around = &lists[near.clone()];

            let bound = anywhere(around, (from, to), 0.0);
            if bound.layers.is_empty() {
                if let Some((look, before, length)) = &mut among {
                    let close = !anywhere(around, (from, to), MARGIN).layers.is_empty();
                    if close && half > 0.5 * MARGIN {
                        open.extend(step.halves(middle, None, near));
                        continue;
                    }
                    let share = |way: f64| (*before + way) / *length;
                    look(share(from), share(to), if close { Encounter::Near } else { Encounter::Air });
                }
                sums.air += to - from;
                continue;
            }
            if half * moves > LONGEST * radius {
                open.extend(step.halves(middle, None, near));
                continue;
            }
            let at = |way: f64| Rc::new(sample(around, way, middle_height));
            let [begin, end] = &step.ends;
            let begin = begin.clone().unwrap_or_else(|| at(from));
            let end = end.clone().unwrap_or_else(|| at(to));
            let halfway = at(middle);
            let samples: [&Engaged; 3] = [&begin, &halfway, &end];
            let sampled = samples.into_iter().map(Engaged::angle).fold(0.0, f64::max);
            let [first, second, third] = samples.map(Engaged::area);
            let [most, least] = [first.max(second).max(third), first.min(second).min(third)];
            // The angle needs its bound close; volume and air need sections of chips that are alike, and near each other.
            let coarse = bound.angle() - sampled > FINE || most - least > ALIKE * most;
            if coarse && half * moves > SHORTEST * radius {
                let known = Open { ends: [Some(begin), Some(end)], ..step };
                open.extend(known.halves(middle, Some(halfway), near));
                continue;
            }
            if let Some((look, before, length)) = &mut among {
                let share = |way: f64| (*before + way) / *length;
                look(share(from), share(to), Encounter::Cut(&bound, samples, tool));
            }
            cut.take(samples, &bound);
            // Simpson's rule over the step.
            // Where a ramp may have cleared something volumes are those of mean floors.
            let sloped = samples.iter().any(|engaged| engaged.sloped);
            let swaths = by_mean_floors(around, (middle_height, self.stock().top)).filter(|_| sloped);
            let section = |way: f64, sample: &Engaged| match &swaths {
                Some(swaths) if sample.sloped => section_at_mean(swaths, way),
                Some(_) | None => sample.area(),
            };
            let [first, second, third] = [section(from, &begin), section(middle, &halfway), section(to, &end)];
            cut.removed += (to - from) * (first + 4.0 * second + third) / 6.0;
            sums.take(samples, to - from, |engaged| wear_rate(engaged, tool, feed, speed));
            if let Some(load) = Load::most(&bound, samples, tool, feed, speed) {
                cut.load = Some(cut.load.map_or(load, |before| before.max(load)));
            }
            if let Some(next) = open.last_mut().filter(|next| next.from == to) {
                next.ends[0].get_or_insert(end);
            }
        }
    }

    /// What a piece has cleared up to a way along it, m; `None` where its front half cannot come on it: an arc that is wider than the
    /// cutter turns the cutter's front away from where it has been.
    fn own_way(&self, piece: &Piece, radius: f64, way: f64) -> Option<Swath> {
        let path = piece.path;
        let narrow = path.curvature.abs() * radius > 1.0;
        let track = || Track::new(Section { length: way, ..path });
        let floor = piece.from.min(piece.to);
        (narrow && way > 0.0).then(|| Swath { track: track(), radius, floor, mean: piece.mean() })
    }
}
