//! The engaged part of the rim at one position.

use crate::swath::Swath;
use std::f64::consts::{FRAC_PI_2, PI};
use toolroom_contour::{Point, Rim, Track};

/// Outline of a stock seen along Z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outline {
    /// A rectangle by its least and greatest corner.
    Box(Point, Point),
    /// A circle by its centre and radius, m.
    Circle(Point, f64),
}

/// What is cut.
#[derive(Clone, Copy, Debug, PartialEq)]
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
    /// Start and end of each interval, rad from the direction of travel, between minus and plus a right angle.
    pub angles: Vec<(f64, f64)>,
}

/// What is engaged at a position.
#[derive(Clone, Debug, Default)]
pub(crate) struct Engaged {
    pub layers: Vec<Layer>,
}

/// Layers beyond which floors are joined, each to the next higher one: never less material (assumption).
const LAYERS: usize = 8;
/// Depth, m, up to which a point on the boundary of a swath counts as in material: the rim begins a motion on the end of
/// the last one. Rounding is less.
const TOUCH: f64 = 1e-12;
/// Difference of heights, m, that is none.
const LEVEL: f64 = 1e-9;
/// Angle, rad, below which a rim only touches: less than a hundredth of a degree.
const GRAZE: f64 = 1e-4;

impl Stock {
    /// Volume, m³.
    pub fn volume(&self) -> f64 {
        let area = match self.outline {
            Outline::Box(low, high) => (high.x - low.x) * (high.y - low.y),
            Outline::Circle(_, radius) => PI * radius * radius,
        };
        area * (self.top - self.base)
    }

    /// Whether a point lies inside the outline grown by `slack`, m.
    fn holds(&self, point: Point, slack: f64) -> bool {
        match self.outline {
            Outline::Box(low, high) => {
                (low.x - slack..=high.x + slack).contains(&point.x)
                    && (low.y - slack..=high.y + slack).contains(&point.y)
            }
            Outline::Circle(centre, radius) => centre.distance(point) <= radius + slack,
        }
    }

    fn crossings(&self, rim: &Rim, slack: f64, angles: &mut Vec<f64>) {
        match self.outline {
            Outline::Box(low, high) => {
                for (point, heading) in [(low, 0.0), (low, FRAC_PI_2), (high, 0.0), (high, FRAC_PI_2)] {
                    let outwards = if point == low { -slack } else { slack };
                    let grown = Point { x: point.x + outwards, y: point.y + outwards };
                    rim.line(grown, heading, angles);
                }
            }
            Outline::Circle(centre, radius) => rim.circle(centre, radius + slack, angles),
        }
    }

    /// What of a cutter at `centre`, of `radius`, whose end is at the height `bottom` and that moves along `heading`, is in
    /// material that the swaths `around` it, the newest first, and its own have left. Every point of the rim is taken to be deeper in material by `slack`.
    pub(crate) fn engaged(&self, around: &[&Swath], swath: Option<&Swath>, place: &Place, slack: f64) -> Engaged {
        let &Place { centre, radius, bottom, heading } = place;
        let low = bottom.max(self.base);
        if low >= self.top {
            return Engaged::default();
        }
        let rim = Rim { centre, radius };
        let reaches = |swath: &&Swath| swath.track.reaches(centre, swath.radius + radius);
        let near = around.iter().copied().filter(reaches);
        let swaths: Vec<&Swath> = swath.into_iter().chain(near).filter(|swath| swath.floor < self.top).collect();
        let mut floors: Vec<f64> =
            swaths.iter().map(|swath| swath.floor).filter(|floor| *floor > low + LEVEL).chain([self.top]).collect();
        floors.sort_by(f64::total_cmp);
        floors.dedup_by(|a, b| *a - *b < LEVEL);
        while floors.len() > LAYERS {
            // The thinnest layer takes the floor above it.
            let thin = (0..floors.len() - 1)
                .min_by(|a, b| (floors[a + 1] - floors[*a]).total_cmp(&(floors[b + 1] - floors[*b])));
            floors.remove(thin.unwrap_or(0));
        }
        let mut layers = Vec::with_capacity(floors.len());
        let mut angles: Vec<f64> = Vec::new();
        let mut from = low;
        for floor in floors {
            let open: Vec<(&Track, f64)> = swaths
                .iter()
                .filter(|swath| swath.floor <= from + LEVEL)
                .map(|swath| (&swath.track, swath.radius - slack - TOUCH))
                .filter(|(_, reach)| *reach > 0.0)
                .collect();
            self.crossings(&rim, slack, &mut angles);
            for (track, reach) in &open {
                rim.crossings(track, *reach, &mut angles);
            }
            let inside = |angle: f64| {
                let point = rim.at(angle);
                self.holds(point, slack) && !open.iter().any(|(track, reach)| track.reaches(point, *reach))
            };
            let mut list = rim.intervals(heading - FRAC_PI_2, PI, &mut angles, inside);
            list.retain(|(a, b)| b - a > GRAZE);
            if !list.is_empty() {
                let angles = list.into_iter().map(|(a, b)| (a - heading, b - heading)).collect();
                layers.push(Layer { height: floor - from, angles });
            }
            from = floor;
        }
        Engaged { layers }
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
    pub fn area(&self, radius: f64) -> f64 {
        let width = |layer: &Layer| layer.angles.iter().map(|(from, to)| to.sin() - from.sin()).sum::<f64>();
        self.layers.iter().map(|layer| layer.height * radius * width(layer)).sum()
    }
}
