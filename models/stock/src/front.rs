//! What of the front half of a rim is in material: at one place, or anywhere on a step.

use crate::swath::Swath;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use toolroom_contour::{Point, Rim, Section};

/// Depth, m, up to which a point on the boundary of a swath counts as in material: the rim begins a motion on the end of
/// the last one. Rounding is less.
const TOUCH: f64 = 1e-12;
/// Angle, rad, below which nothing lies between two crossings: rounding.
const LEAST: f64 = 1e-13;
/// Angle, rad, below which a rim only touches: less than a hundredth of a degree.
const GRAZE: f64 = 1e-4;

/// A cutter on its way.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub centre: Point,
    /// m.
    pub radius: f64,
    /// Height of its end, m.
    pub bottom: f64,
    /// rad.
    pub heading: f64,
}

/// Where a cutter is: at one place, or anywhere between two.
///
/// A point of the rim at a fixed angle from the direction of travel moves along a line, or along an arc about the centre of the
/// path. It never leaves a region that is convex, such as the swath of a line, where it begins and ends in it, by more than the
/// arc bulges over its chord: a bound between both places whose error falls with the square of the step. Angles of two rims are
/// angles of one, each from its own direction of travel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step {
    /// Rims at the begin, at the end and in the middle, each with the angle at which its front half begins, rad.
    rims: [(Rim, f64); 3],
    /// Height of the cutter's end, m.
    pub bottom: f64,
    /// Half of the greatest chord along which a point of the rim moves, m; 0 at one place.
    half: f64,
    /// How far its way bulges over the chord at most, m.
    bulge: f64,
    /// Every point of the rim is taken to be deeper in material by this, m.
    slack: f64,
}

/// Which rims decide whether a region holds a point of the rim all along the step, and how deep they have to be in it.
#[derive(Clone, Copy)]
enum Deciding {
    /// Both ends.
    Ends(f64),
    /// Both ends and the middle, where no point in between is farther from the nearest of them than this allows for.
    All(f64),
}

impl Step {
    /// At one place, with every point of the rim deeper in material by `slack`, m.
    pub fn at(place: &Place, slack: f64) -> Self {
        let &Place { centre, radius, bottom, heading } = place;
        let rim = (Rim { centre, radius }, heading - FRAC_PI_2);
        Self { rims: [rim; 3], bottom, half: 0.0, bulge: 0.0, slack }
    }

    /// Anywhere between two ways along a path, m, with every point of the rim deeper in material by `slack`, m.
    pub fn between(path: &Section, (from, to): (f64, f64), (radius, bottom): (f64, f64), slack: f64) -> Self {
        let rim = |way: f64| {
            let heading = path.heading + path.curvature * way;
            (Rim { centre: path.at(way), radius }, heading - FRAC_PI_2)
        };
        let way = 0.5 * (to - from);
        let curvature = path.curvature.abs();
        // The point of the rim farthest from the centre of the path moves most.
        let half = way * (1.0 + radius * curvature);
        // An arc of radius r that turns by 2·t lies within r·t²/2 of its chord.
        let bulge = 0.5 * half * way * curvature;
        Self { rims: [rim(from), rim(to), rim(0.5 * (from + to))], bottom, half, bulge, slack }
    }

    /// Radius of the cutter, m.
    pub fn radius(&self) -> f64 {
        self.rims[0].0.radius
    }

    /// Whether it is one place.
    pub fn is_place(&self) -> bool {
        self.half == 0.0
    }

    fn rims(&self, deciding: Deciding) -> &[(Rim, f64)] {
        match deciding {
            Deciding::Ends(_) if self.is_place() => &self.rims[..1],
            Deciding::Ends(_) => &self.rims[..2],
            Deciding::All(_) => &self.rims,
        }
    }

    /// How deep in a swath the rims have to be.
    ///
    /// Of an arc of radius ρ: a chord between two points of its swath lies within φ²·ρ/8 of it, where φ is the angle between
    /// both points at its centre; where the centre is nearer to the swath than half the chord nothing is known of φ.
    fn deciding(&self, swath: &Swath) -> Deciding {
        let radius = swath.radius - self.slack - TOUCH;
        let curvature = swath.track.section().curvature.abs();
        if self.is_place() || curvature == 0.0 {
            return Deciding::Ends(radius - self.bulge);
        }
        let room = 1.0 / curvature - swath.radius;
        if self.half < room {
            let angle = 2.0 * (self.half / room).asin();
            let dent = angle * angle / (8.0 * curvature) + self.bulge;
            if dent < self.half {
                return Deciding::Ends(radius - dent);
            }
        }
        Deciding::All(radius - 0.5 * self.half)
    }
}

/// What of the front half of a rim is in material.
pub(crate) struct Front<'s> {
    step: &'s Step,
    parts: Vec<Part>,
    angles: Vec<f64>,
}

/// A part of the rim in material.
#[derive(Clone, Copy, Debug)]
struct Part {
    /// From the begin of the front half, rad.
    from: f64,
    to: f64,
    /// Its middle at the begin and at the end of the step.
    middles: [Point; 2],
    /// Greatest distance of its points from the middle, m.
    reach: f64,
}

/// The point of a rim at an angle from the begin of its front half, rad.
fn on(&(rim, begin): &(Rim, f64), angle: f64) -> Point {
    rim.at(begin + angle)
}

impl<'s> Front<'s> {
    pub fn new(step: &'s Step) -> Self {
        let mut front = Self { step, parts: Vec::with_capacity(4), angles: Vec::with_capacity(16) };
        front.parts.push(front.arc(0.0, PI));
        front
    }

    /// Whether nothing is in material.
    pub fn is_clear(&self) -> bool {
        self.parts.is_empty()
    }

    fn arc(&self, start: f64, end: f64) -> Part {
        let [begin, last, _] = &self.step.rims;
        let reach = 2.0 * begin.0.radius * (0.25 * (end - start)).sin();
        let middle = 0.5 * (start + end);
        let first = on(begin, middle);
        Part {
            from: start,
            to: end,
            middles: [first, if self.step.is_place() { first } else { on(last, middle) }],
            reach,
        }
    }

    /// Whether a swath may hold a point of what is in material at one place.
    pub fn meets(&self, swath: &Swath) -> bool {
        self.parts.iter().any(|part| swath.track.reaches(part.middles[0], swath.radius + part.reach))
    }

    /// Takes what a swath holds all along the step out; whether there was anything.
    pub fn clear(&mut self, swath: &Swath) -> bool {
        let (track, step) = (&swath.track, self.step);
        let deciding = step.deciding(swath);
        let (Deciding::Ends(reach) | Deciding::All(reach)) = deciding;
        if reach <= 0.0 {
            return false;
        }
        let before = self.parts.len();
        let mut crossed = false;
        self.parts.retain(|part| {
            let mut distance = track.distance(part.middles[0]);
            if !step.is_place() {
                distance = distance.max(track.distance(part.middles[1]));
            }
            if let Deciding::All(_) = deciding {
                distance = distance.max(track.distance(on(&step.rims[2], 0.5 * (part.from + part.to))));
            }
            if distance + part.reach < reach {
                return false;
            }
            crossed |= distance - part.reach < reach;
            true
        });
        let gone = self.parts.len() < before;
        let crossings = |rim: &Rim, angles: &mut Vec<f64>| rim.crossings(track, reach, angles);
        let taken = crossed && self.take(deciding, crossings, |point| track.reaches(point, reach));
        gone || taken
    }

    /// Takes out where the rim is beyond a straight line all along the step: `beyond` is the distance on its far side, m.
    pub fn clear_beyond(&mut self, line: (Point, f64), beyond: impl Fn(Point) -> f64) {
        let deciding = Deciding::Ends(0.0);
        let least = self.step.slack + self.step.bulge;
        let nowhere = |(rim, _): &(Rim, f64)| beyond(rim.centre) + rim.radius <= least;
        if self.step.rims(deciding).iter().any(nowhere) {
            return;
        }
        let (point, heading) = line;
        // The line is moved to its far side.
        let ahead = point.ahead(heading + FRAC_PI_2, 1.0);
        let side = if beyond(ahead) > beyond(point) { least } else { -least };
        let moved = point.ahead(heading + FRAC_PI_2, side);
        self.take(deciding, |rim, angles| rim.line(moved, heading, angles), |point| beyond(point) > least);
    }

    /// Takes out where the rim is outside of a circle all along the step.
    pub fn clear_outside_circle(&mut self, centre: Point, radius: f64) {
        let step = self.step;
        // Between two points outside a chord comes nearer to the centre.
        let radius = (radius + step.slack + step.bulge).hypot(step.half);
        let crossings = |rim: &Rim, angles: &mut Vec<f64>| rim.circle(centre, radius, angles);
        self.take(Deciding::Ends(0.0), crossings, |point| centre.distance(point) > radius);
    }

    /// Takes out where the rim is free all along the step: `is_free` and `crossings` are given the distance from material, m, that is asked
    /// for at its ends and its middle.
    pub fn clear_around(&mut self, crossings: impl Fn(&Rim, f64, &mut Vec<f64>), is_free: impl Fn(Point, f64) -> bool) {
        let slack = 0.5 * self.step.half + self.step.slack;
        let crossings = |rim: &Rim, angles: &mut Vec<f64>| crossings(rim, slack, angles);
        self.take(Deciding::All(slack), crossings, |point| is_free(point, slack));
    }

    /// Takes out where `is_free` holds at all deciding rims, which changes only at the angles that `crossings` gives; whether there was anything.
    fn take(
        &mut self,
        deciding: Deciding,
        crossings: impl Fn(&Rim, &mut Vec<f64>),
        is_free: impl Fn(Point) -> bool,
    ) -> bool {
        let rims = self.step.rims(deciding);
        let mut angles = std::mem::take(&mut self.angles);
        angles.clear();
        for (rim, begin) in rims {
            let count = angles.len();
            crossings(rim, &mut angles);
            for angle in &mut angles[count..] {
                let turned = *angle - begin;
                *angle = turned - TAU * (turned / TAU).floor();
            }
        }
        angles.retain(|angle| *angle < PI);
        angles.sort_unstable_by(f64::total_cmp);
        let mut taken = false;
        let mut left: Vec<Part> = Vec::with_capacity(self.parts.len() + 2);
        for part in &self.parts {
            let inner = angles.iter().copied().filter(|angle| *angle > part.from && *angle < part.to);
            let (mut from, mut kept): (f64, Option<(f64, f64)>) = (part.from, None);
            for to in inner.chain([part.to]) {
                if to - from <= LEAST {
                    continue;
                }
                let middle = 0.5 * (from + to);
                if !rims.iter().all(|rim| is_free(on(rim, middle))) {
                    kept = match kept {
                        Some((start, end)) if from - end < LEAST => Some((start, to)),
                        before => {
                            left.extend(before.map(|(start, end)| self.arc(start, end)));
                            Some((from, to))
                        }
                    };
                }
                from = to;
            }
            match kept {
                Some((start, end)) if start == part.from && end == part.to => left.push(*part),
                kept => {
                    taken = true;
                    left.extend(kept.map(|(start, end)| self.arc(start, end)));
                }
            }
        }
        self.parts = left;
        self.angles = angles;
        taken
    }

    /// Start and end of each part, rad from the direction of travel. On a step the last one is longer by what only touches, so that the
    /// sum is a bound.
    pub fn angles(&self) -> Vec<(f64, f64)> {
        let (mut list, mut touches) = (Vec::with_capacity(self.parts.len()), 0.0);
        for part in &self.parts {
            if part.to - part.from > GRAZE {
                list.push((part.from - FRAC_PI_2, part.to - FRAC_PI_2));
            } else {
                touches += part.to - part.from;
            }
        }
        if let Some((_, end)) = list.last_mut().filter(|_| !self.step.is_place()) {
            *end += touches;
        }
        list
    }
}
