//! Holes and discs of equal width as arcs that meet without a corner.

use crate::track::distance;
use crate::{ContourError, Point, Section, Trace};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A profile of equal width, by its support function `h(φ) = diameter/2 − eccentricity·cos(lobes·φ)`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Profile {
    pub diameter: f64,
    pub eccentricity: f64,
    pub lobes: u32,
}

/// Pairs of arcs beyond which no division is sought.
const MOST_PAIRS: u32 = 2000;
/// Points of a whole profile at which its distance is measured.
const OUTLINE: u32 = 1440;
/// Points of the profile between two ends of pairs at which the distance is measured.
const MEASURED: u32 = 128;

impl Profile {
    /// The point whose normal has the angle `phi`.
    fn at(&self, phi: f64) -> Point {
        let m = f64::from(self.lobes);
        let support = 0.5 * self.diameter - self.eccentricity * (m * phi).cos();
        let slope = self.eccentricity * m * (m * phi).sin();
        let (sin, cos) = phi.sin_cos();
        Point { x: support * cos - slope * sin, y: support * sin + slope * cos }
    }

    /// Least radius of curvature, m.
    fn least_radius(&self) -> f64 {
        let m = f64::from(self.lobes);
        0.5 * self.diameter - (m * m - 1.0) * self.eccentricity.abs()
    }

    /// Two arcs that meet in a common tangent and join the profile at the normal angles `from` and `to` in its own
    /// directions: the biarc of equal tangent lengths.
    fn pair(&self, from: f64, to: f64) -> [Section; 2] {
        let (start, end) = (self.at(from), self.at(to));
        let headings = [from + FRAC_PI_2, to + FRAC_PI_2];
        let [(s0, c0), (s1, c1)] = headings.map(f64::sin_cos);
        let (dx, dy) = (end.x - start.x, end.y - start.y);
        let along = dx * (c0 + c1) + dy * (s0 + s1);
        let bend = 2.0 * (1.0 - (c0 * c1 + s0 * s1));
        let reach = ((along * along + bend * (dx * dx + dy * dy)).sqrt() - along) / bend;
        let (first, last) = (start.ahead(headings[0], reach), end.ahead(headings[1], -reach));
        let joint = Point { x: 0.5 * (first.x + last.x), y: 0.5 * (first.y + last.y) };
        let one = Section::tangent(start, headings[0], joint);
        [one, Section::tangent(joint, one.end_heading(), end)]
    }

    /// Greatest distance between the profile and `pairs` pairs of arcs of equal normal angle, m.
    fn residual(&self, pairs: u32) -> f64 {
        let step = TAU / f64::from(pairs);
        let greatest_gap = |i: u32| {
            let from = f64::from(i) * step;
            let arcs = self.pair(from, from + step);
            let point = |j: u32| self.at(from + step * f64::from(j) / f64::from(MEASURED));
            let gap = |point: Point| arcs.iter().map(|arc| distance(arc, point)).fold(f64::INFINITY, f64::min);
            (1..MEASURED).map(|j| gap(point(j))).fold(0.0, f64::max)
        };
        (0..pairs).map(greatest_gap).fold(0.0, f64::max)
    }

    /// The fewest pairs of arcs that stay within `tolerance`, m.
    fn pairs_within(&self, tolerance: f64) -> u32 {
        // The distance falls with the third power of the number, so that doubling comes close at once.
        let mut high = 3;
        while high < MOST_PAIRS && self.residual(high) > tolerance {
            high *= 2;
        }
        let mut low = high / 2;
        while high - low > 1 {
            let middle = low + (high - low) / 2;
            if self.residual(middle) > tolerance { low = middle } else { high = middle }
        }
        high
    }
}

impl Trace {
    /// Greatest distance of a profile from the sections that were drawn for it from number `start` on, m.
    pub(crate) fn residual(&self, profile: Profile, start: usize) -> f64 {
        let drawn = self.drawn(start);
        let Some(first) = drawn.first() else { return 0.0 };
        // The profile begins at the normal angle 0, where it runs along +Y.
        let (turn, origin) = (first.heading - FRAC_PI_2, profile.at(0.0));
        let (sin, cos) = turn.sin_cos();
        let gap = |i: u32| {
            let point = profile.at(TAU * f64::from(i) / f64::from(OUTLINE));
            let (dx, dy) = (point.x - origin.x, point.y - origin.y);
            let placed = Point { x: first.start.x + dx * cos - dy * sin, y: first.start.y + dx * sin + dy * cos };
            drawn.iter().map(|section| distance(section, placed)).fold(f64::INFINITY, f64::min)
        };
        (0..OUTLINE).map(gap).fold(0.0, f64::max)
    }

    /// A closed hole or disc of equal width, support function `h(φ) = diameter/2 − eccentricity·cos(lobes·φ)`, as pairs of
    /// arcs that meet each other and the profile in common tangents. They stay within `tolerance`, m, of the profile; the
    /// distance that they keep is returned, m. `pairs` asks for a number, else the fewest are taken.
    ///
    /// # Errors
    /// [`ContourError::NoLength`] where the eccentricity is so great that a radius vanishes, [`ContourError::Residual`] where
    /// the number of pairs that is requested is too small, [`ContourError::Division`] for fewer than 3.
    ///
    /// # Source
    /// Support function of the RK/P3G profile, Lukin's "RK-3 profile hole" (reading of the scan); biarcs of equal tangent
    /// lengths.
    ///
    /// ```
    /// use toolroom_contour::{Point, Trace};
    /// let mut trace = Trace::new(Point::default(), 0.0);
    /// let residual = trace.lobed_within(0.1, 0.0035, 3, 25e-6, Some(18)).unwrap();
    /// assert!((residual - 24.51e-6).abs() < 0.01e-6);
    /// assert!(trace.lobed_within(0.1, 0.0035, 3, 1e-6, Some(18)).is_err());
    /// ```
    pub fn lobed_within(
        &mut self,
        diameter: f64,
        eccentricity: f64,
        lobes: u32,
        tolerance: f64,
        pairs: Option<u32>,
    ) -> Result<f64, ContourError> {
        let profile = Profile { diameter, eccentricity, lobes };
        if !(profile.least_radius() > 0.0 && profile.least_radius().is_finite()) {
            return Err(ContourError::NoLength { section: self.sections() });
        }
        if pairs.is_some_and(|pairs| !(3..=MOST_PAIRS).contains(&pairs)) {
            return Err(ContourError::Division { sections: pairs.unwrap_or(0), greatest: MOST_PAIRS });
        }
        let count = pairs.unwrap_or_else(|| profile.pairs_within(tolerance));
        let residual = profile.residual(count);
        if residual > tolerance {
            let enough = profile.pairs_within(tolerance);
            return Err(ContourError::Residual { residual, tolerance, sections: count, enough });
        }
        let step = TAU / f64::from(count);
        for i in 0..count {
            let from = f64::from(i) * step;
            for arc in profile.pair(from, from + step) {
                self.arc(1.0 / arc.curvature, arc.length * arc.curvature)?;
                self.natural_arc(PI / f64::from(lobes.max(1)));
            }
        }
        Ok(residual)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::CutterSide;

    #[test]
    fn residuals_are_those_of_the_reference() {
        let profile = Profile { diameter: 0.1, eccentricity: 0.0035, lobes: 3 };
        for (pairs, um) in [(6, 993.5), (9, 255.7), (12, 79.96), (18, 24.51), (24, 8.331), (36, 2.154)] {
            let residual = 1e6 * profile.residual(pairs);
            assert!((residual - um).abs() < 1e-3 * um, "{pairs}: {residual}");
        }
    }

    #[test]
    fn the_traced_profile_is_closed_smooth_and_within_its_tolerance() {
        let mut trace = Trace::new(Point { x: 0.01, y: -0.02 }, 0.4);
        let residual = trace.lobed_within(0.1, 0.0035, 3, 5e-6, None).expect("a profile");
        assert!(residual <= 5e-6 && residual > 1e-6, "{residual}");
        let contour = trace.finish(CutterSide::Left, true).expect("closed");
        assert!(contour.corners.is_empty());
        // Measured from outside: the width of the hole is the same in every direction.
        let points: Vec<Point> = contour
            .sections
            .iter()
            .flat_map(|section| (0..50).map(move |i| section.at(section.length * f64::from(i) / 50.0)))
            .collect();
        for k in 0..90 {
            let (sin, cos) = (f64::from(k) * PI / 90.0).sin_cos();
            let along = points.iter().map(|point| point.x * cos + point.y * sin);
            let (low, high) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
            assert!((high - low - 0.1).abs() < 2.0 * 5e-6 + 2e-6, "{}", high - low);
        }
        let mut few = Trace::new(Point::default(), 0.0);
        let error = few.lobed_within(0.1, 0.0035, 3, 1e-6, Some(18)).expect_err("too few");
        let ContourError::Residual { enough, .. } = error else { panic!("{error}") };
        assert!(few.lobed_within(0.1, 0.0035, 3, 1e-6, Some(enough)).is_ok(), "{enough}");
    }
}
