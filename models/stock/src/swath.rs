//! What the cutter has run over, found by its place.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use toolroom_contour::{Point, Section, Track};

/// A region around a path, cleared down to a floor.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Swath {
    pub track: Track,
    /// m.
    pub radius: f64,
    /// Height of the lowest place that is cleared everywhere along it, m: on a ramp that of its higher end.
    pub floor: f64,
    /// Height of its floor in the mean, m, which volumes are counted with: other than `floor` on a ramp alone.
    pub mean: f64,
}

/// Which of its two floors counts of a swath.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Floors {
    /// That of its higher end: no less material than there is.
    Highest,
    /// That in its mean, for volumes.
    Mean,
}

impl Floors {
    /// The floor of a swath that counts, m.
    pub fn of(self, swath: &Swath) -> f64 {
        match self {
            Self::Highest => swath.floor,
            Self::Mean => swath.mean,
        }
    }
}

impl Swath {
    /// Whether its two floors make a difference to what lies between two heights, m.
    pub fn slopes_between(&self, low: f64, top: f64) -> bool {
        self.mean != self.floor && self.mean.max(self.floor) > low && self.mean.min(self.floor) < top
    }
}

/// Swaths by their mean floors, the lowest first; `None` where these make no difference between two heights, m.
pub(crate) fn by_mean_floors<'s>(around: &[&'s Swath], (low, top): (f64, f64)) -> Option<Vec<&'s Swath>> {
    around.iter().any(|swath| swath.slopes_between(low, top)).then(|| {
        let mut swaths = around.to_vec();
        swaths.sort_by(|a, b| a.mean.total_cmp(&b.mean));
        swaths
    })
}

/// Swaths in the squares that they touch.
#[derive(Clone, Debug)]
pub(crate) struct Index {
    swaths: Vec<Swath>,
    squares: HashMap<(i64, i64), Vec<u32>>,
    /// The swath of each path that has been run, whichever way round.
    paths: HashMap<[i64; 6], u32>,
    /// Side of a square, m.
    side: f64,
}

/// The box around a section, grown by `reach`: least and greatest corner.
fn around(path: &Section, reach: f64) -> (Point, Point) {
    let parts = if path.curvature == 0.0 { 1 } else { (path.sweep().abs() / 0.2).ceil().max(1.0) as u32 };
    let mut low = Point { x: f64::INFINITY, y: f64::INFINITY };
    let mut high = Point { x: f64::NEG_INFINITY, y: f64::NEG_INFINITY };
    for i in 0..=parts {
        let point = path.at(path.length * f64::from(i) / f64::from(parts));
        low = Point { x: low.x.min(point.x), y: low.y.min(point.y) };
        high = Point { x: high.x.max(point.x), y: high.y.max(point.y) };
    }
    // An arc bulges over the chord of a part by less than its sagitta.
    let bulge = if path.curvature == 0.0 { 0.0 } else { 0.01 / path.curvature.abs() };
    let reach = reach + bulge;
    (Point { x: low.x - reach, y: low.y - reach }, Point { x: high.x + reach, y: high.y + reach })
}

/// Lengths that differ by less than this, m, are one: it is that of rounding, as the depth of a touch is.
const SAME: f64 = 1e-12;

/// The path of a swath with its radius, the same in both directions.
fn key(swath: &Swath) -> [i64; 6] {
    let section = swath.track.section();
    let (start, end) = (section.start, swath.track.end());
    let steps = |length: f64| (length / SAME).round() as i64;
    let forth = [start.x, start.y, end.x, end.y].map(steps);
    let back = [end.x, end.y, start.x, start.y].map(steps);
    // By how far the arc is from its chord, which changes its sign with the direction.
    let bulge = section.curvature * section.length * section.length;
    let (ends, bulge) = if forth <= back { (forth, bulge) } else { (back, -bulge) };
    [ends[0], ends[1], ends[2], ends[3], steps(bulge), steps(swath.radius)]
}

impl Index {
    /// Without swaths, for cutters of about this radius, m.
    pub fn new(radius: f64) -> Self {
        Self { swaths: Vec::new(), squares: HashMap::new(), paths: HashMap::new(), side: 2.0 * radius.max(1e-4) }
    }

    fn square(&self, point: Point) -> (i64, i64) {
        ((point.x / self.side).floor() as i64, (point.y / self.side).floor() as i64)
    }

    /// A path that is run again, as levels of a pocket and turns of a helix are, has one swath with the lowest floor.
    pub fn push(&mut self, swath: Swath) {
        let number = self.swaths.len() as u32;
        match self.paths.entry(key(&swath)) {
            Entry::Occupied(before) => {
                let known = &mut self.swaths[*before.get() as usize];
                known.floor = known.floor.min(swath.floor);
                known.mean = known.mean.min(swath.mean);
                return;
            }
            Entry::Vacant(place) => {
                place.insert(number);
            }
        }
        let (low, high) = around(swath.track.section(), swath.radius);
        let (from, to) = (self.square(low), self.square(high));
        for x in from.0..=to.0 {
            for y in from.1..=to.1 {
                // Of a long slanted path only the squares near it are touched.
                let middle = Point { x: (x as f64 + 0.5) * self.side, y: (y as f64 + 0.5) * self.side };
                if swath.track.distance(middle) <= swath.radius + self.side {
                    self.squares.entry((x, y)).or_default().push(number);
                }
            }
        }
        self.swaths.push(swath);
    }

    /// Swaths that reach within `radius` of a point, the lowest first.
    pub fn near(&self, centre: Point, radius: f64) -> Vec<&Swath> {
        let corner = |away: f64| Point { x: centre.x + away, y: centre.y + away };
        self.within((corner(-radius), corner(radius)), centre, radius)
    }

    /// Swaths that may reach within `radius` of a path, the lowest first.
    pub fn along(&self, path: &Section, radius: f64) -> Vec<&Swath> {
        let half = 0.5 * path.length;
        self.within(around(path, radius), path.at(half), radius + half)
    }

    fn within(&self, (low, high): (Point, Point), centre: Point, radius: f64) -> Vec<&Swath> {
        let (from, to) = (self.square(low), self.square(high));
        // A bit of each swath: most lie in many squares.
        let mut seen = vec![0u64; self.swaths.len().div_ceil(64)];
        let mut near: Vec<(f64, u32)> = Vec::new();
        for x in from.0..=to.0 {
            for y in from.1..=to.1 {
                for number in self.squares.get(&(x, y)).into_iter().flatten() {
                    let (word, bit) = (&mut seen[*number as usize / 64], 1u64 << (number % 64));
                    let swath = &self.swaths[*number as usize];
                    if *word & bit == 0 && swath.track.reaches(centre, swath.radius + radius) {
                        near.push((swath.floor, *number));
                    }
                    *word |= bit;
                }
            }
        }
        // Of one floor the latest first: it is the likeliest to have cleared what is in front of the cutter.
        near.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
        near.into_iter().map(|(_, number)| &self.swaths[number as usize]).collect()
    }
}
