//! The engaged part of the rim at one position.

use crate::front::{Front, Step};
use crate::profile::Profile;
use crate::swath::{Floors, Swath};
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;
use toolroom_contour::Point;

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
    /// Whether a ramp may have cleared some of it at one place, so that it is another by mean floors.
    pub sloped: bool,
}

/// Layers beyond which floors are joined, each to the next higher one: never less material (assumption).
const LAYERS: usize = 64;
/// Difference of heights, m, that is none.
const LEVEL: f64 = 1e-9;

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

    /// Takes out of a front where it lies outside of the outline.
    fn clear_outside(&self, front: &mut Front<'_>) {
        match &self.outline {
            &Outline::Box(low, high) => {
                front.clear_beyond((low, FRAC_PI_2), |point| low.x - point.x);
                front.clear_beyond((low, 0.0), |point| low.y - point.y);
                front.clear_beyond((high, FRAC_PI_2), |point| point.x - high.x);
                front.clear_beyond((high, 0.0), |point| point.y - high.y);
            }
            Outline::Circle(centre, radius) => front.clear_outside_circle(*centre, *radius),
            Outline::Profile(profile) => front.clear_around(
                |rim, slack, angles| profile.crossings(rim, slack, angles),
                |point, slack| !profile.holds(point, slack),
            ),
        }
    }

    /// What of a cutter is in material that the swaths `around` it, the lowest first by `floors`, and its own have left: at a place, or
    /// anywhere on a step.
    ///
    /// A swath takes its angles from what is still in material, the lowest swaths first: a layer higher up has nothing in
    /// material that the one below it has not. So each swath is looked at once, and only near what is left.
    pub(crate) fn engaged(&self, around: &[&Swath], own: Option<&Swath>, step: &Step, floors: Floors) -> Engaged {
        let floor = |swath: &Swath| floors.of(swath);
        let low = step.bottom.max(self.base);
        if low >= self.top {
            return Engaged::default();
        }
        let mut front = Front::new(step);
        self.clear_outside(&mut front);
        let own_place = own.map_or(around.len(), |own| around.partition_point(|swath| floor(swath) < floor(own)));
        let (lower, higher) = around.split_at(own_place);
        let all = lower.iter().copied().chain(own).chain(higher.iter().copied());
        let mut rest = all.take_while(|swath| floor(swath) < self.top).peekable();
        while !front.is_clear() {
            let Some(swath) = rest.next_if(|swath| floor(swath) <= low + LEVEL) else { break };
            front.clear(swath);
        }
        let mut angles = front.angles();
        if angles.is_empty() {
            // Nor is there anything higher up.
            return Engaged::default();
        }
        let sloped = step.is_place()
            && floors == Floors::Highest
            && (around.iter().copied().chain(own))
                .any(|swath| swath.slopes_between(low + LEVEL, self.top) && front.meets(swath));
        let mut count = 0;
        let mut last = low;
        for swath in rest.clone().filter(|swath| floor(swath) > low + LEVEL) {
            count += usize::from(floor(swath) - last >= LEVEL);
            last = floor(swath);
        }
        let thin = if count > LAYERS { (self.top - low) / LAYERS as f64 } else { 0.0 };
        let mut layers = Vec::new();
        let mut from = low;
        while !front.is_clear() {
            // Floors that are too near to the last one are joined to the next one.
            let Some(level) = rest.clone().map(floor).find(|floor| *floor >= from + thin) else { break };
            let mut changed = false;
            while let Some(swath) = rest.next_if(|swath| floor(swath) <= level + LEVEL) {
                changed |= front.clear(swath);
            }
            // A layer begins only where something has been cleared above it.
            if changed {
                let above = front.angles();
                if above != angles {
                    let angles = std::mem::replace(&mut angles, above);
                    layers.push(Layer { height: level - from, radius: step.radius(), slope: 1.0, angles });
                    from = level;
                }
                if angles.is_empty() {
                    return Engaged { layers, sloped };
                }
            }
        }
        layers.push(Layer { height: self.top - from, radius: step.radius(), slope: 1.0, angles });
        Engaged { layers, sloped }
    }
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
