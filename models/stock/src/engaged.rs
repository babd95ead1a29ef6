//! The engaged part of the rim at one position.

use crate::profile::Profile;
use crate::swath::Swath;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::Arc;
use toolroom_contour::{Point, Rim, Track};

/// Outline of a stock seen along Z.
#[derive(Clone, Debug, PartialEq)]
pub enum Outline {
    /// A rectangle by its least and greatest corner.
    Box(Point, Point),
    /// A circle by its centre and radius, m.
    Circle(Point, f64),
    /// Lines and arcs.
    Profile(Arc<Profile>),
}

/// What is cut.
#[derive(Clone, Debug, PartialEq)]
pub struct Stock {
    /// Seen along Z.
    pub outline: Outline,
    /// Height of its lower face, m.
    pub base: f64,
    /// Height of its upper face, m.
    pub top: f64,
}

/// A layer of the cutter with the angles of the rim that are in material.
#[derive(Clone, Debug)]
pub(crate) struct Layer {
    /// m.
    pub height: f64,
    /// Radius of the cutter there, m.
    pub radius: f64,
    /// Sine of the angle between its axis and the normal of its surface there: 1 on a cylinder.
    pub slope: f64,
    /// Start and end of each interval, rad from the direction of travel, between minus and plus a right angle.
    pub angles: Vec<(f64, f64)>,
}

/// What is engaged at a position.
#[derive(Clone, Debug, Default)]
pub(crate) struct Engaged {
    pub layers: Vec<Layer>,
}

/// Layers beyond which floors are joined, each to the next higher one: never less material (assumption).
const LAYERS: usize = 64;
/// Depth, m, up to which a point on the boundary of a swath counts as in material: the rim begins a motion on the end of
/// the last one. Rounding is less.
const TOUCH: f64 = 1e-12;
/// Difference of heights, m, that is none.
const LEVEL: f64 = 1e-9;
/// Angle, rad, below which nothing lies between two crossings: rounding.
const LEAST: f64 = 1e-13;
/// Angle, rad, below which a rim only touches: less than a hundredth of a degree.
const GRAZE: f64 = 1e-4;

impl Stock {
    /// Volume, m³.
    pub fn volume(&self) -> f64 {
        let area = match &self.outline {
            Outline::Box(low, high) => (high.x - low.x) * (high.y - low.y),
            Outline::Circle(_, radius) => PI * radius * radius,
            Outline::Profile(profile) => profile.area(),
        };
        area * (self.top - self.base)
    }

    /// Whether a point lies inside the outline grown by `slack`, m.
    pub(crate) fn holds(&self, point: Point, slack: f64) -> bool {
        match &self.outline {
            Outline::Box(low, high) => {
                (low.x - slack..=high.x + slack).contains(&point.x)
                    && (low.y - slack..=high.y + slack).contains(&point.y)
            }
            Outline::Circle(centre, radius) => centre.distance(point) <= *radius + slack,
            Outline::Profile(profile) => profile.holds(point, slack),
        }
    }

    fn crossings(&self, rim: &Rim, slack: f64, angles: &mut Vec<f64>) {
        match &self.outline {
            &Outline::Box(low, high) => {
                for (point, heading) in [(low, 0.0), (low, FRAC_PI_2), (high, 0.0), (high, FRAC_PI_2)] {
                    let outwards = if point == low { -slack } else { slack };
                    let grown = Point { x: point.x + outwards, y: point.y + outwards };
                    rim.line(grown, heading, angles);
                }
            }
            Outline::Circle(centre, radius) => rim.circle(*centre, radius + slack, angles),
            Outline::Profile(profile) => profile.crossings(rim, slack, angles),
        }
    }

    /// What of a cutter at `centre`, of `radius`, whose end is at the height `bottom` and that moves along `heading`, is in
    /// material that the swaths `around` it, the lowest first, and its own have left. Every point of the rim is taken to be deeper in material by
    /// `slack`.
    ///
    /// A swath takes its angles from what is still in material, the lowest swaths first: a layer higher up has nothing in
    /// material that the one below it has not. So each swath is looked at once, and only near what is left.
    pub(crate) fn engaged(&self, around: &[&Swath], swath: Option<&Swath>, place: &Place, slack: f64) -> Engaged {
        let &Place { centre, radius, bottom, heading } = place;
        let low = bottom.max(self.base);
        if low >= self.top {
            return Engaged::default();
        }
        let reaches = |swath: &&Swath| swath.floor < self.top && swath.track.reaches(centre, swath.radius + radius);
        let mut swaths: Vec<&Swath> = around.iter().copied().filter(reaches).collect();
        if let Some(latest) = swath.filter(|latest| latest.floor < self.top) {
            let place = swaths.partition_point(|swath| swath.floor < latest.floor);
            swaths.insert(place, latest);
        }
        let mut floors: Vec<f64> =
            swaths.iter().map(|swath| swath.floor).filter(|floor| *floor > low + LEVEL).chain([self.top]).collect();
        floors.dedup_by(|a, b| *a - *b < LEVEL);
        while floors.len() > LAYERS {
            // The thinnest layer takes the floor above it.
            let thin = (0..floors.len() - 1)
                .min_by(|a, b| (floors[a + 1] - floors[*a]).total_cmp(&(floors[b + 1] - floors[*b])));
            floors.remove(thin.unwrap_or(0));
        }
        let mut front = Front::new(Rim { centre, radius }, heading);
        front.take(|rim, angles| self.crossings(rim, slack, angles), |point| !self.holds(point, slack));
        let mut layers = Vec::with_capacity(floors.len());
        let mut from = low;
        let mut rest = swaths.into_iter().peekable();
        for floor in floors {
            while let Some(swath) = rest.next_if(|swath| swath.floor <= from + LEVEL) {
                let reach = swath.radius - slack - TOUCH;
                if reach > 0.0 {
                    front.clear(&swath.track, reach);
                }
            }
            let angles = front.angles();
            if angles.is_empty() {
                // Nor is there anything higher up.
                break;
            }
            layers.push(Layer { height: floor - from, radius, slope: 1.0, angles });
            from = floor;
        }
        Engaged { layers }
    }
}

/// What of the front half of a rim is in material.
struct Front {
    rim: Rim,
    /// Angle at which the front half begins, rad.
    begin: f64,
    parts: Vec<Part>,
    angles: Vec<f64>,
}

/// A part of the rim in material.
#[derive(Clone, Copy, Debug)]
struct Part {
    /// From the begin of the front half, rad.
    from: f64,
    to: f64,
    /// Its middle.
    middle: Point,
    /// Greatest distance of its points from the middle, m.
    reach: f64,
}

impl Front {
    fn new(rim: Rim, heading: f64) -> Self {
        let mut front =
            Self { rim, begin: heading - FRAC_PI_2, parts: Vec::with_capacity(4), angles: Vec::with_capacity(16) };
        front.parts.push(front.arc(0.0, PI));
        front
    }

    fn arc(&self, start: f64, end: f64) -> Part {
        let reach = 2.0 * self.rim.radius * (0.25 * (end - start)).sin();
        Part { from: start, to: end, middle: self.rim.at(self.begin + 0.5 * (start + end)), reach }
    }

    /// Takes the region within `reach` of a track out.
    fn clear(&mut self, track: &Track, reach: f64) {
        let mut crossed = false;
        self.parts.retain(|arc| {
            let distance = track.distance(arc.middle);
            if distance + arc.reach < reach {
                return false;
            }
            crossed |= distance - arc.reach < reach;
            true
        });
        if crossed {
            self.take(|rim, angles| rim.crossings(track, reach, angles), |point| track.reaches(point, reach));
        }
    }

    /// Takes out where `is_free` holds, which changes only at the angles that `crossings` gives.
    fn take(&mut self, crossings: impl FnOnce(&Rim, &mut Vec<f64>), is_free: impl Fn(Point) -> bool) {
        let mut angles = std::mem::take(&mut self.angles);
        angles.clear();
        crossings(&self.rim, &mut angles);
        for angle in &mut angles {
            *angle = (*angle - self.begin).rem_euclid(TAU);
        }
        angles.retain(|angle| *angle < PI);
        angles.sort_by(f64::total_cmp);
        let mut left: Vec<Part> = Vec::with_capacity(self.parts.len() + 2);
        for arc in &self.parts {
            let inner = angles.iter().copied().filter(|angle| *angle > arc.from && *angle < arc.to);
            let (mut from, mut kept): (f64, Option<(f64, f64)>) = (arc.from, None);
            for to in inner.chain([arc.to]) {
                if to - from <= LEAST {
                    continue;
                }
                if !is_free(self.rim.at(self.begin + 0.5 * (from + to))) {
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
                Some((start, end)) if start == arc.from && end == arc.to => left.push(*arc),
                kept => left.extend(kept.map(|(start, end)| self.arc(start, end))),
            }
        }
        self.parts = left;
        self.angles = angles;
    }

    /// Start and end of each part, rad from the direction of travel.
    fn angles(&self) -> Vec<(f64, f64)> {
        let parts = self.parts.iter().filter(|arc| arc.to - arc.from > GRAZE);
        parts.map(|arc| (arc.from - FRAC_PI_2, arc.to - FRAC_PI_2)).collect()
    }
}

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

impl Engaged {
    /// Greatest engagement angle of a layer, rad.
    pub fn angle(&self) -> f64 {
        let measure = |layer: &Layer| layer.angles.iter().map(|(from, to)| to - from).sum::<f64>();
        self.layers.iter().map(measure).fold(0.0, f64::max)
    }

    /// Height of all layers that are engaged, m.
    pub fn depth(&self) -> f64 {
        self.layers.iter().map(|layer| layer.height).sum()
    }

    /// Angle of the middle of the chips from the direction of travel, rad: that of the heaviest layer.
    pub fn side(&self) -> f64 {
        let heavy = |layer: &Layer| layer.height * layer.angles.iter().map(|(from, to)| to - from).sum::<f64>();
        let heaviest = self.layers.iter().max_by(|a, b| heavy(a).total_cmp(&heavy(b)));
        let Some(layer) = heaviest else { return 0.0 };
        let (sum, whole) = (layer.angles.iter())
            .fold((0.0, 0.0), |(sum, whole), (from, to)| (sum + 0.5 * (to * to - from * from), whole + to - from));
        sum / whole
    }

    /// Section of the chips that a way along the path takes off, m²: volume per way.
    pub fn area(&self) -> f64 {
        let width = |layer: &Layer| layer.angles.iter().map(|(from, to)| to.sin() - from.sin()).sum::<f64>();
        self.layers.iter().map(|layer| layer.height * layer.radius * width(layer)).sum()
    }

    /// Greatest radius of the cutter that is engaged, m: the one that cuts fastest.
    pub fn radius(&self) -> f64 {
        self.layers.iter().map(|layer| layer.radius).fold(0.0, f64::max)
    }
}
