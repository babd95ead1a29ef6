//! Whether a cutter that runs along a contour cuts into the wall elsewhere: necks, narrow slots, contours that cross themselves.
//!
//! The distance of the cutter's centre from a section changes by no more than the centre moves. A step is safe where the
//! distance in its middle exceeds the radius by half its way; steps are halved until they are safe or shorter than what is
//! admitted.

use crate::{Contour, ContourError, Track};
use std::collections::HashMap;
use std::f64::consts::FRAC_PI_2;

/// Cells of the grid that a section may cover before it is looked at everywhere (assumption).
const MOST_CELLS: i64 = 256;

/// Sections by the squares in whose neighbourhood they lie.
struct Grid {
    size: f64,
    cells: HashMap<(i64, i64), Vec<usize>>,
    everywhere: Vec<usize>,
}

impl Grid {
    /// Sections that may come nearer than `reach` to a point of a cell stand in it.
    fn new(contour: &Contour, reach: f64) -> Self {
        let mut grid = Self { size: 2.0 * reach, cells: HashMap::new(), everywhere: Vec::new() };
        for (index, section) in contour.sections.iter().enumerate() {
            let far = section.length + reach;
            let cell = |place: f64| (place / grid.size).floor() as i64;
            let (x, y) = (section.start.x, section.start.y);
            let (left, right, low, high) = (cell(x - far), cell(x + far), cell(y - far), cell(y + far));
            if (right - left + 1).saturating_mul(high - low + 1) > MOST_CELLS {
                grid.everywhere.push(index);
                continue;
            }
            for column in left..=right {
                for row in low..=high {
                    grid.cells.entry((column, row)).or_default().push(index);
                }
            }
        }
        grid
    }

    fn near(&self, x: f64, y: f64) -> impl Iterator<Item = usize> + '_ {
        let cell = ((x / self.size).floor() as i64, (y / self.size).floor() as i64);
        self.cells.get(&cell).into_iter().flatten().chain(&self.everywhere).copied()
    }
}

impl Contour {
    /// Whether a cutter of `radius`, m, runs along every section without cutting deeper than `tolerance`, m, into another.
    /// Moves around sharp corners are not looked at.
    ///
    /// # Errors
    /// As [`Contour::admits`], and [`ContourError::Neck`] for the first section on which it cuts into another.
    ///
    /// ```
    /// use toolroom_contour::{CutterSide, Point, Trace};
    /// // Between two walls 25 mm apart, with a half circle at the end: a cutter of 24 mm runs through, one of 26 mm does not.
    /// let mut trace = Trace::new(Point::default(), 0.0);
    /// trace.line(0.05).unwrap();
    /// trace.arc(0.0125, std::f64::consts::PI).unwrap();
    /// trace.line(0.05).unwrap();
    /// let slot = trace.finish(CutterSide::Left, false).unwrap();
    /// assert!(slot.clears(0.012, 1e-6).is_ok());
    /// assert!(slot.clears(0.013, 1e-6).is_err());
    /// ```
    pub fn clears(&self, radius: f64, tolerance: f64) -> Result<(), ContourError> {
        self.admits(radius)?;
        let tracks: Vec<Track> = self.sections.iter().copied().map(Track::new).collect();
        let grid = Grid::new(self, radius + tolerance);
        for (index, section) in self.sections.iter().enumerate() {
            let shape = self.shape(section);
            let moves = shape.centre_path_ratio(radius).abs();
            let mut open = vec![(0.0, section.length)];
            while let Some((from, to)) = open.pop() {
                let (way, half) = (0.5 * (from + to), 0.5 * (to - from) * moves);
                let heading = section.heading + section.curvature * way;
                let centre = section.at(way).ahead(heading + self.side.sign() * FRAC_PI_2, radius);
                // A step that is long against the cells is cut before its neighbours are asked for.
                if half > 0.5 * radius {
                    open.extend([(way, to), (from, way)]);
                    continue;
                }
                let others = grid.near(centre.x, centre.y).filter(|other| *other != index);
                let nearest = others
                    .map(|other| (tracks[other].distance(centre), other))
                    .min_by(|one, other| one.0.total_cmp(&other.0));
                let Some((distance, other)) = nearest else { continue };
                if distance < radius - tolerance {
                    return Err(ContourError::Neck { section: index, other, depth: radius - distance });
                }
                if distance - half < radius - tolerance && half > 0.25 * tolerance {
                    open.extend([(way, to), (from, way)]);
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use crate::{Contour, ContourError, CutterSide, Point, Trace};
    use std::f64::consts::{FRAC_PI_2, PI};

    /// A keyhole: a round chamber of 30 mm radius behind a neck of `width`.
    fn keyhole(width: f64) -> Contour {
        let (chamber, half) = (0.03_f64, 0.5 * width);
        let opening = (half / chamber).asin();
        let mut trace = Trace::new(Point { x: half, y: 0.0 }, FRAC_PI_2);
        trace.line(0.04).unwrap();
        // The edges of the chamber are rounded towards the neck.
        trace.arc(0.002, -(FRAC_PI_2 - opening)).unwrap();
        trace.arc(chamber, 2.0 * PI - 2.0 * opening).unwrap();
        trace.arc(0.002, -(FRAC_PI_2 - opening)).unwrap();
        trace.line(0.04).unwrap();
        trace.finish(CutterSide::Left, false).unwrap()
    }

    #[test]
    fn a_neck_narrower_than_the_cutter_is_found_though_every_radius_admits_it() {
        for opening in [0.02, 0.03] {
            let keyhole = keyhole(opening);
            // Both walls of the neck run along Y.
            let width = keyhole.sections[0].start.x - keyhole.sections[4].start.x;
            assert!(width > 0.01, "{width}");
            for (share, fits) in [(0.495, true), (0.505, false), (0.8, false)] {
                assert!(keyhole.admits(share * width).is_ok());
                let found = keyhole.clears(share * width, 5e-6);
                assert_eq!(found.is_ok(), fits, "{width} {share} {found:?}");
            }
        }
    }

    #[test]
    fn a_contour_that_crosses_itself_is_found() {
        let mut trace = Trace::new(Point::default(), 0.0);
        trace.line(0.1).unwrap();
        trace.arc(0.02, 1.5 * PI).unwrap();
        trace.line(0.1).unwrap();
        let crossing = trace.finish(CutterSide::Left, false).unwrap();
        assert!(matches!(crossing.clears(0.005, 1e-6), Err(ContourError::Neck { .. })));
        // A radius that is too small by itself is named as that.
        assert!(matches!(crossing.clears(0.021, 1e-6), Err(ContourError::CutterTooLarge { section: 1, .. })));
        // Tangential joints are no necks, whatever the side.
        let mut trace = Trace::new(Point::default(), 0.0);
        for (radius, angle) in [(0.02, 1.0), (0.03, -1.2), (0.025, 0.7)] {
            trace.line(0.03).unwrap();
            trace.arc(radius, angle).unwrap();
        }
        for side in [CutterSide::Left, CutterSide::Right] {
            assert_eq!(trace.clone().finish(side, false).unwrap().clears(0.012, 1e-6), Ok(()));
        }
    }
}
