//! Stock as heights over a grid, for cutters whose end is not flat.

use crate::end::End;
use crate::engaged::{Engaged, Layer, Outline, Stock};
use crate::front::Place;
use crate::load::Tool;
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, PI};
use toolroom_contour::Point;

/// Columns of what is left of a stock.
#[derive(Clone, Debug)]
pub(crate) struct Map {
    /// Height of each column, m, row by row along Y.
    heights: Vec<f64>,
    columns: usize,
    rows: usize,
    low: Point,
    /// Side of a column, m.
    cell: f64,
    base: f64,
    top: f64,
}

/// Columns at most, so that memory stays below 200 MB; the cells of larger stocks are larger (assumption).
const COLUMNS: f64 = 25e6;
/// Layers of an end and of the cylinder above it.
const LAYERS: u32 = 16;
/// Directions of the rim that are looked at: one a cell, within these numbers.
const DIRECTIONS: (f64, f64) = (12.0, 180.0);
/// Stamps of the cutter lie this share of a cell from each other: what they leave between them is below a thousandth of a cell.
const PITCH: f64 = 0.5;

impl Map {
    /// A whole stock in columns of about `cell`, m.
    pub fn new(stock: &Stock, cell: f64) -> Self {
        let (low, high) = match &stock.outline {
            Outline::Box(low, high) => (*low, *high),
            Outline::Profile(profile) => profile.bounds(),
            Outline::Circle(centre, radius) => (
                Point { x: centre.x - radius, y: centre.y - radius },
                Point { x: centre.x + radius, y: centre.y + radius },
            ),
        };
        let (wide, deep) = (high.x - low.x, high.y - low.y);
        let cell = cell.max((wide * deep / COLUMNS).sqrt());
        let count = |length: f64| (length / cell).ceil().max(1.0) as usize;
        let (columns, rows) = (count(wide), count(deep));
        let mut map = Self {
            heights: vec![stock.top; columns * rows],
            columns,
            rows,
            low,
            cell,
            base: stock.base,
            top: stock.top,
        };
        for row in 0..rows {
            for column in 0..columns {
                if !stock.holds(map.middle(column, row), 0.0) {
                    map.heights[row * columns + column] = stock.base;
                }
            }
        }
        map
    }

    /// Side of a column, m.
    pub fn cell(&self) -> f64 {
        self.cell
    }

    fn middle(&self, column: usize, row: usize) -> Point {
        let at = |low: f64, i: usize| low + (i as f64 + 0.5) * self.cell;
        Point { x: at(self.low.x, column), y: at(self.low.y, row) }
    }

    /// Whether the square around a place reaches the grid.
    fn is_near(&self, centre: Point, reach: f64) -> bool {
        let within =
            |at: f64, low: f64, count: usize| at + reach >= low && at - reach <= low + self.cell * count as f64;
        within(centre.x, self.low.x, self.columns) && within(centre.y, self.low.y, self.rows)
    }

    /// Height of the material at a place, m; that of the base outside the stock.
    fn height(&self, x: f64, y: f64) -> f64 {
        let (column, row) = (((x - self.low.x) / self.cell).floor(), ((y - self.low.y) / self.cell).floor());
        if column < 0.0 || row < 0.0 || column >= self.columns as f64 || row >= self.rows as f64 {
            return self.base;
        }
        self.heights[row as usize * self.columns + column as usize]
    }

    /// Columns whose middles lie within a square around a place.
    fn around(&self, centre: Point, reach: f64) -> (std::ops::Range<usize>, std::ops::Range<usize>) {
        let range = |at: f64, low: f64, count: usize| {
            let from = ((at - reach - low) / self.cell - 0.5).ceil().clamp(0.0, count as f64);
            let to = ((at + reach - low) / self.cell + 0.5).floor().clamp(0.0, count as f64);
            from as usize..(to as usize).max(from as usize)
        };
        (range(centre.x, self.low.x, self.columns), range(centre.y, self.low.y, self.rows))
    }

    /// Lowers the columns under a tool that stands with its tip at a place, and gives the volume that goes, m³.
    pub fn stamp(&mut self, tool: &Tool, centre: Point, tip: f64) -> f64 {
        if tip >= self.top {
            return 0.0;
        }
        let (columns, rows) = self.around(centre, tool.radius);
        let mut gone = 0.0;
        for row in rows {
            for column in columns.clone() {
                let distance = self.middle(column, row).distance(centre);
                let Some(above) = tool.end.above(tool.radius, distance) else { continue };
                let height = &mut self.heights[row * self.columns + column];
                let left = (tip + above).max(self.base);
                if left < *height {
                    gone += *height - left;
                    *height = left;
                }
            }
        }
        gone * self.cell * self.cell
    }

    /// Lowers the columns under a tool on its `way`, m, between two shares of it at which it stands `at` places, and gives the volume
    /// that goes, m³.
    pub fn sweep(&mut self, tool: &Tool, at: impl Fn(f64) -> (Point, f64), (from, to): (f64, f64), way: f64) -> f64 {
        let stamps = (way / (PITCH * self.cell)).ceil().max(1.0) as u32;
        let place = |i: u32| at(from + (to - from) * f64::from(i) / f64::from(stamps));
        (1..=stamps).map(place).map(|(centre, tip)| self.stamp(tool, centre, tip)).sum()
    }

    /// Greatest height of material above `tip` and within `radius` of a place, m, over it: what a holder meets.
    pub fn over(&self, centre: Point, radius: f64, bottom: f64) -> f64 {
        let (columns, rows) = self.around(centre, radius);
        let mut most = 0.0_f64;
        for row in rows {
            for column in columns.clone() {
                if self.middle(column, row).distance(centre) <= radius {
                    most = most.max(self.heights[row * self.columns + column] - bottom);
                }
            }
        }
        most
    }

    /// What of a tool is in material, looked at half a diagonal of a column in front of its surface, where it has not been yet; every point is
    /// taken to be deeper in material by `slack`, m.
    pub fn engaged(&self, tool: &Tool, place: &Place, slack: f64) -> Engaged {
        let &Place { centre, radius, bottom, heading } = place;
        if bottom >= self.top || !self.is_near(centre, radius + slack + self.cell) {
            return Engaged::default();
        }
        let whole = tool.end.height(radius);
        let mut layers = Vec::new();
        // The end below the top of the stock, in layers of one angle of its normal where it is round.
        let high = whole.min(self.top - bottom);
        let parts = if high > 0.0 { LAYERS } else { 0 };
        let edge = |i: u32| {
            let share = f64::from(i) / f64::from(parts);
            match tool.end {
                End::Corner(corner) => corner * (1.0 - (share * (1.0 - high / corner).acos()).cos()),
                End::Flat | End::Taper(..) => high * share,
            }
        };
        for i in 0..parts {
            let (from, to) = (edge(i), edge(i + 1));
            let middle = 0.5 * (from + to);
            let (reach, slope) = tool.end.at(radius, middle);
            let depths = self.depths((centre, heading), reach, bottom + middle, slack);
            self.layer(&mut layers, &depths, (0.0, to - from), (reach, slope));
        }
        // The cylinder above it, up to the highest material in front of it.
        let depths = self.depths((centre, heading), radius, bottom + whole, slack);
        let most = depths.iter().copied().fold(0.0, f64::max);
        let height = most / f64::from(LAYERS);
        for i in 0..LAYERS {
            self.layer(&mut layers, &depths, ((f64::from(i) + 0.5) * height, height), (radius, 1.0));
        }
        Engaged { layers, sloped: false }
    }

    /// How far material reaches above `bottom` in front of every direction of the front half of a rim, m.
    fn depths(&self, (centre, heading): (Point, f64), radius: f64, bottom: f64, slack: f64) -> Vec<f64> {
        let count = (PI * radius / self.cell).ceil().clamp(DIRECTIONS.0, DIRECTIONS.1) as u32;
        // A column there has its middle outside of the surface, so that the tool as it stands has not lowered it.
        let reach = radius + FRAC_1_SQRT_2 * self.cell;
        let depth = |i: u32| {
            let angle = heading - FRAC_PI_2 + PI * (f64::from(i) + 0.5) / f64::from(count);
            let place = centre.ahead(angle, reach);
            let mut height = self.height(place.x, place.y);
            if slack > 0.0 {
                for turn in [0.0, FRAC_PI_2, PI, -FRAC_PI_2] {
                    let beside = place.ahead(angle + turn, slack);
                    height = height.max(self.height(beside.x, beside.y));
                }
            }
            height - bottom.max(self.base)
        };
        (0..count).map(depth).collect()
    }

    /// Adds a layer of this height with the directions in which material reaches higher than `level`.
    fn layer(&self, layers: &mut Vec<Layer>, depths: &[f64], (level, height): (f64, f64), (radius, slope): (f64, f64)) {
        let width = PI / depths.len() as f64;
        let mut angles: Vec<(f64, f64)> = Vec::new();
        for (i, _) in depths.iter().enumerate().filter(|(_, depth)| **depth > level) {
            let from = i as f64 * width - FRAC_PI_2;
            match angles.last_mut() {
                Some(last) if (last.1 - from).abs() < 1e-9 => last.1 = from + width,
                _ => angles.push((from, from + width)),
            }
        }
        if height <= 0.0 || angles.is_empty() {
            return;
        }
        match layers.last_mut() {
            Some(last) if (last.radius, last.slope) == (radius, slope) && last.angles == angles => {
                last.height += height
            }
            _ => layers.push(Layer { height, radius, slope, angles }),
        }
    }
}
