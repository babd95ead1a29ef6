//! Stock that is cut motion by motion.

use crate::engaged::{Engaged, Stock};
use crate::front::{Place, Step};
use crate::load::{Load, Tool};
use crate::map::Map;
use crate::swath::{Floors, Index, Swath, by_mean_floors};
use std::cmp::Ordering;
use std::f64::consts::{PI, TAU};
use toolroom_contour::{Point, Section, Track};
use toolroom_program::{Motion, Path};

/// Share of the axial depth by which the floor may change within a piece of a ramp.
const RAMP: f64 = 0.1;
/// Rings of the end of a cutter that goes straight down.
const RINGS: u32 = 40;
/// Rings of the end of a cutter on a ramp.
pub(crate) const RAMP_RINGS: u32 = 12;
/// Pieces of a motion that is neither straight nor an arc in the plane XY.
const PIECES: u32 = 64;
/// Greatest number of pieces of a ramp (assumption).
const RAMP_PIECES: f64 = 500.0;

/// What a stretch of a motion meets, as it is handed on to those who look.
pub(crate) enum Encounter<'a> {
    /// No material within the margin.
    Air,
    /// None engaged, but some within the margin.
    Near,
    /// Engaged at the bound, and at the samples.
    Cut(&'a Engaged, [&'a Engaged; 3], &'a Tool),
}

/// Takes the shares of a motion between which a stretch lies, and what it meets; in order.
pub(crate) type Look<'l> = dyn FnMut(f64, f64, Encounter<'_>) + 'l;

/// Distance, m, from material within which a way is not in air for those who look (assumption).
pub(crate) const MARGIN: f64 = 1e-3;

/// What a motion does to the stock.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cut {
    /// Greatest engagement angle at the samples, rad.
    pub sampled: f64,
    /// Angle that is exceeded nowhere, rad.
    pub bound: f64,
    /// Greatest axial depth, m.
    pub depth: f64,
    /// Volume removed, m³.
    pub removed: f64,
    /// Share of the way without any engagement, 0 to 1.
    pub air: f64,
    /// Greatest load, at the bound of the engagement; `None` where the forces of the tool are not known.
    pub load: Option<Load>,
    /// Share of the life of an edge that it uses, 1; `None` where the life of the tool is not known.
    pub wear: Option<f64>,
    /// Mean of the way in material.
    pub mean: Mean,
    /// Whether the motion is a rapid one that meets material.
    pub crash: bool,
    /// Whether the end of the cutter goes straight down into material.
    pub plunge: bool,
    /// Whether the holder of the tool meets material.
    pub holder: bool,
}

/// The engagement of a motion in the mean of its way in material; 0 where there is none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mean {
    /// Radial width of cut, m: section of the chips over the depth.
    pub width: f64,
    /// Axial depth of cut, m.
    pub depth: f64,
    /// Greatest radius of the cutter that is engaged, m: less than its own where only a rounded end cuts.
    pub radius: f64,
    /// Angle of the middle of the chips from the direction of travel, rad; below 0 a clockwise cutter mills down.
    pub side: f64,
}

/// Sums along the way of a motion.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sums {
    /// Way in air, m.
    pub air: f64,
    /// Way in material, m.
    pub way: f64,
    /// Section of the chips, m³.
    area: f64,
    /// Depth, m².
    depth: f64,
    /// Greatest radius that is engaged, m.
    radius: f64,
    /// Angle of the middle of the chips, m³.
    side: f64,
    /// Share of a life times the feed, 1/s·m.
    wear: Option<f64>,
}

impl Cut {
    /// Takes what is engaged on a step: at its samples, and at the bound.
    pub(crate) fn take(&mut self, samples: [&Engaged; 3], bound: &Engaged) {
        self.sampled = samples.into_iter().map(Engaged::angle).fold(self.sampled, f64::max);
        self.bound = self.bound.max(bound.angle());
        self.depth = self.depth.max(bound.depth());
    }
}

impl Sums {
    /// Adds a step of this length, m, from what is engaged at its ends and its middle, by Simpson's rule; `wear_rate` is the share of a
    /// life that a second uses.
    pub(crate) fn take(&mut self, samples: [&Engaged; 3], step: f64, wear_rate: impl Fn(&Engaged) -> Option<f64>) {
        if samples.iter().all(|engaged| engaged.angle() == 0.0) {
            self.air += step;
        } else {
            self.way += step;
        }
        for (engaged, share) in samples.into_iter().zip([1.0, 4.0, 1.0]) {
            let weight = share * step / 6.0;
            let area = engaged.area();
            self.area += weight * area;
            self.depth += weight * engaged.depth();
            self.side += weight * area * engaged.side();
            self.radius = self.radius.max(engaged.radius());
            if let Some(rate) = wear_rate(engaged) {
                *self.wear.get_or_insert(0.0) += weight * rate;
            }
        }
    }

    /// The means and shares of a motion whose way in the plane and in space are these, m, at a feed, m/s.
    pub(crate) fn settle(&self, cut: &mut Cut, length: f64, way: f64, feed: f64) {
        if self.way > 0.0 {
            cut.mean.depth = self.depth / self.way;
            cut.mean.radius = self.radius;
            (cut.mean.width, cut.mean.side) = (self.area / self.depth, self.side / self.area);
        }
        // Time is way over feed; a motion without feed has no wear. Ramps are longer than their way in the plane.
        let slant = if length > 0.0 { way / length } else { 1.0 };
        cut.wear = self.wear.map(|wear| wear * slant / feed);
        cut.air = if length > 0.0 { self.air / length } else { 1.0 };
    }
}

/// Stock, and what of it is gone.
///
/// ```
/// use toolroom_contour::Point;
/// use toolroom_program::{Control, EventKind, Run};
/// use toolroom_stock::{Cutting, End, Outline, Stock, Tool};
/// let corner = |x, y| Point { x, y };
/// let stock = Stock { outline: Outline::Box(corner(0.0, 0.0), corner(0.1, 0.05)), base: -0.02, top: 0.0 };
/// let tool = Tool { radius: 5e-3, end: End::Flat, teeth: 4.0, force: None, holder: None };
/// let mut cutting = Cutting::new(stock, tool.radius);
/// let text = "G21 G90 G0 X-10 Y-4 Z-5\nG1 X110 F500\n"; // a shoulder of 1 mm
/// for event in Run::new(text, &Control::default()).unwrap() {
///     if let EventKind::Motion(motion) = event.unwrap().kind {
///         let cut = cutting.motion(&motion, &tool, 0.0);
///         if !motion.rapid {
///             assert!((cut.sampled.to_degrees() - 36.869898).abs() < 1e-6);
///             assert!((cut.removed - 0.1 * 1e-3 * 5e-3).abs() < 1e-3 * cut.removed);
///         }
///     }
/// }
/// ```
#[derive(Clone, Debug)]
pub struct Cutting {
    stock: Stock,
    index: Index,
    /// What is left as heights, where a cutter has an end that is not flat.
    map: Option<Map>,
    removed: f64,
}

/// A piece of a path at one height.
pub(crate) struct Piece {
    pub path: Section,
    /// Heights of the cutter's end at both ends, m.
    pub from: f64,
    pub to: f64,
}

impl Piece {
    /// Height of the cutter's end in its middle, m.
    pub fn mean(&self) -> f64 {
        0.5 * (self.from + self.to)
    }

    /// What a cutter of this radius, m, has cleared behind it.
    fn swath(&self, radius: f64) -> Swath {
        Swath { track: Track::new(self.path), radius, floor: self.from.max(self.to), mean: self.mean() }
    }
}

/// The lower end of a ramp, where the whole end of the cutter reaches the height of its tip, m: that of the pieces is the mean of
/// each.
enum RampEnd {
    Start(Point, f64),
    End(Point, f64),
}

fn ramp_end(motion: &Motion, pieces: &[Piece]) -> Option<RampEnd> {
    let (first, last) = (pieces.first()?, pieces.last()?);
    let (from, to) = (1e-3 * motion.start[2], 1e-3 * motion.end[2]);
    match from.total_cmp(&to) {
        Ordering::Less => Some(RampEnd::Start(first.path.start, from)),
        Ordering::Equal => None,
        Ordering::Greater => Some(RampEnd::End(last.path.at(last.path.length), to)),
    }
}

impl Cutting {
    /// Stock of which nothing is gone; `radius` is that of the usual cutter, m, and decides how fast places are found.
    pub fn new(stock: Stock, radius: f64) -> Self {
        Self { stock, index: Index::new(radius), map: None, removed: 0.0 }
    }

    /// Stock of which nothing is gone, as heights over a grid of this cell, m, which cutters of any end may cut. A larger cell is
    /// taken where there would be more than 25 million.
    pub fn mapped(stock: Stock, cell: f64) -> Self {
        Self { map: Some(Map::new(&stock, cell)), ..Self::new(stock, 1.0) }
    }

    /// Side of a cell of its grid, m; `None` where the stock is followed by closed forms.
    pub fn cell(&self) -> Option<f64> {
        self.map.as_ref().map(Map::cell)
    }

    /// The stock as it was.
    pub fn stock(&self) -> &Stock {
        &self.stock
    }

    pub(crate) fn index(&self) -> &Index {
        &self.index
    }

    /// Volume removed so far, m³.
    pub fn removed(&self) -> f64 {
        self.removed
    }

    /// Moves a tool; `speed` is that of the spindle, rad/s. A rapid motion clears what it meets, as any other.
    ///
    /// The engaged angle of a step is measured at its ends and its middle, and bounded in between: a point of the rim counts as in
    /// material unless one swath holds it all along the step, which for convex ones its ends tell. Steps are halved until both differ by less
    /// than half a degree and the sections of the chips by less than a tenth, or to a fiftieth of the cutter's radius.
    pub fn motion(&mut self, motion: &Motion, tool: &Tool, speed: f64) -> Cut {
        self.motion_seen(motion, tool, speed, None)
    }

    /// [`motion`](Self::motion), looked at stretch by stretch.
    pub(crate) fn motion_seen(
        &mut self,
        motion: &Motion,
        tool: &Tool,
        speed: f64,
        mut look: Option<&mut Look<'_>>,
    ) -> Cut {
        let mut cut = Cut::default();
        if motion.rapid && motion.unknown {
            // It comes from or goes to a place that only the machine knows.
            return Cut { air: 1.0, ..cut };
        }
        if let Some(map) = &mut self.map {
            let cut = map.motion(motion, tool, speed, look);
            self.removed += cut.removed;
            return cut;
        }
        let pieces = pieces(motion, &self.stock);
        let length: f64 = pieces.iter().map(|piece| piece.path.length).sum();
        let feed = if motion.rapid || motion.time <= 0.0 { 0.0 } else { 1e-3 * motion.length / motion.time };
        let mut sums = Sums::default();
        let ramp_end = ramp_end(motion, &pieces);
        if let Some(RampEnd::Start(place, height)) = ramp_end {
            cut.removed += self.clear_disc(place, tool.radius, height);
        }
        let mut before = 0.0;
        for piece in &pieces {
            let among = look.as_deref_mut().map(|look| (look, before, length));
            self.piece(piece, tool, (feed, speed), (&mut cut, &mut sums), among);
            before += piece.path.length;
            let swath = piece.swath(tool.radius);
            if swath.mean < self.stock.top {
                self.index.push(swath);
            }
        }
        if let Some(RampEnd::End(place, height)) = ramp_end {
            cut.removed += self.clear_disc(place, tool.radius, height);
        }
        if pieces.is_empty() {
            self.straight_down(motion, tool, &mut cut);
        }
        sums.settle(&mut cut, length, 1e-3 * motion.length, feed);
        if length == 0.0 {
            cut.air = f64::from(u8::from(!cut.plunge));
        }
        if let Some(holder) = &tool.holder {
            let end = Point { x: 1e-3 * motion.end[0], y: 1e-3 * motion.end[1] };
            cut.holder = self.holder_meets(holder, &pieces, (end, 1e-3 * motion.start[2].min(motion.end[2])));
        }
        cut.crash = motion.rapid && (cut.sampled > 0.0 || cut.plunge);
        self.removed += cut.removed;
        cut
    }

    /// A motion along Z alone: the whole end of the cutter goes into material, or comes out of it.
    fn straight_down(&mut self, motion: &Motion, tool: &Tool, cut: &mut Cut) {
        let (from, to) = (1e-3 * motion.start[2], 1e-3 * motion.end[2]);
        if to >= from.min(self.stock.top) || motion.unknown {
            return;
        }
        let centre = Point { x: 1e-3 * motion.end[0], y: 1e-3 * motion.end[1] };
        let path = Section { start: centre, heading: 0.0, length: 0.0, curvature: 0.0, arc_angle: 0.0 };
        let around = self.index.near(centre, tool.radius);
        let (volume, depth) = self.disc(&around, centre, tool.radius, to, RINGS, Floors::Highest);
        cut.depth = cut.depth.max(depth);
        cut.removed += self.disc_volume(&around, centre, tool.radius, to, RINGS);
        cut.plunge = volume > 1e-6 * PI * tool.radius.powi(2) * (from.min(self.stock.top) - to);
        self.index.push(Swath { track: Track::new(path), radius: tool.radius, floor: to, mean: to });
    }

    /// Takes off what the end of a cutter reaches where it stands at the lower end of a ramp; the volume, m³.
    fn clear_disc(&mut self, centre: Point, radius: f64, bottom: f64) -> f64 {
        if bottom >= self.stock.top {
            return 0.0;
        }
        let volume = self.disc_volume(&self.index.near(centre, radius), centre, radius, bottom, RAMP_RINGS);
        if volume > 0.0 {
            let path = Section { start: centre, heading: 0.0, length: 0.0, curvature: 0.0, arc_angle: 0.0 };
            self.index.push(Swath { track: Track::new(path), radius, floor: bottom, mean: bottom });
        }
        volume
    }

    /// Volume, m³, of material above `bottom`, m, under the whole end of a cutter, by the mean floors around it.
    pub(crate) fn disc_volume(&self, around: &[&Swath], centre: Point, radius: f64, bottom: f64, rings: u32) -> f64 {
        match by_mean_floors(around, (bottom, self.stock.top)) {
            Some(swaths) => self.disc(&swaths, centre, radius, bottom, rings, Floors::Mean).0,
            None => self.disc(around, centre, radius, bottom, rings, Floors::Highest).0,
        }
    }

    /// Volume, m³, and greatest depth, m, of material above `bottom` under the whole end of a cutter: a disc, looked at by
    /// rings, each as a rim in two halves; the swaths around it are sorted by `floors`.
    pub(crate) fn disc(
        &self,
        around: &[&Swath],
        centre: Point,
        radius: f64,
        bottom: f64,
        rings: u32,
        floors: Floors,
    ) -> (f64, f64) {
        let (mut volume, mut depth) = (0.0, 0.0f64);
        for ring in 0..rings {
            let reach = radius * (f64::from(ring) + 0.5) / f64::from(rings);
            for heading in [0.0, PI] {
                let step = Step::at(&Place { centre, radius: reach, bottom, heading }, 0.0);
                let engaged = self.stock.engaged(around, None, &step, floors);
                let solid: f64 = engaged
                    .layers
                    .iter()
                    .map(|layer| layer.height * layer.angles.iter().map(|(a, b)| b - a).sum::<f64>())
                    .sum();
                volume += solid * reach * radius / f64::from(rings);
                depth = depth.max(engaged.depth());
            }
        }
        (volume, depth)
    }
}

/// The path of a motion in the plane XY, cut where it turns round: sections with the heights at their ends, m; nothing where only Z
/// moves.
pub(crate) fn paths(motion: &Motion) -> Vec<(Section, f64, f64)> {
    let point = |axes: &[f64; 9]| Point { x: 1e-3 * axes[0], y: 1e-3 * axes[1] };
    let (start, end) = (point(&motion.start), point(&motion.end));
    let (from, to) = (1e-3 * motion.start[2], 1e-3 * motion.end[2]);
    let straight = |start: Point, end: Point| Section {
        start,
        heading: start.heading_to(end),
        length: start.distance(end),
        curvature: 0.0,
        arc_angle: 0.0,
    };
    match motion.path {
        Path::Line => {
            if start.distance(end) < 1e-9 {
                return Vec::new();
            }
            vec![(straight(start, end), from, to)]
        }
        Path::Arc(arc) if arc.plane == [0, 1, 2] => {
            let sign = if arc.left { 1.0 } else { -1.0 };
            let centre = Point { x: 1e-3 * arc.centre[0], y: 1e-3 * arc.centre[1] };
            let radius = 1e-3 * arc.radius;
            let parts = (arc.angle / PI).ceil().max(1.0);
            let turn = sign * arc.angle / parts;
            let level = |share: f64| from + (to - from) * share;
            (0..parts as u32)
                .map(|i| {
                    let angle = centre.heading_to(start) + turn * f64::from(i);
                    let section = Section {
                        start: centre.ahead(angle, radius),
                        heading: angle + sign * 0.25 * TAU,
                        length: radius * turn.abs(),
                        curvature: sign / radius,
                        arc_angle: turn.abs(),
                    };
                    (section, level(f64::from(i) / parts), level(f64::from(i + 1) / parts))
                })
                .collect()
        }
        Path::Arc(_) => {
            let places: Vec<[f64; 9]> =
                (0..=PIECES).map(|i| motion.position(f64::from(i) / f64::from(PIECES))).collect();
            let chord = |pair: &[[f64; 9]]| {
                let section = straight(point(&pair[0]), point(&pair[1]));
                (section.length > 1e-9).then_some((section, 1e-3 * pair[0][2], 1e-3 * pair[1][2]))
            };
            places.windows(2).filter_map(chord).collect()
        }
    }
}

/// [`paths`], cut also where the height changes too much.
fn pieces(motion: &Motion, stock: &Stock) -> Vec<Piece> {
    let mut list = Vec::new();
    for (section, from, to) in paths(motion) {
        let depth = (stock.top - from.min(to)).max(1e-4);
        let parts = ((to - from).abs() / (RAMP * depth)).ceil().clamp(1.0, RAMP_PIECES);
        for i in 0..parts as u32 {
            let (low, high) = (f64::from(i) / parts, f64::from(i + 1) / parts);
            let way = section.length * low;
            let path = Section {
                start: section.at(way),
                heading: section.heading + section.curvature * way,
                length: section.length / parts,
                ..section
            };
            list.push(Piece { path, from: from + (to - from) * low, to: from + (to - from) * high });
        }
    }
    list
}
