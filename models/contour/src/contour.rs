//! A contour ready to be milled.

use crate::{ContourError, Corner, CutterSide, Section, Shape};

/// Sections in the order of travel, sharp outside corners, and the side of the cutter.
///
/// Drawn with a [`Trace`](crate::Trace), read from a contour file or from G-code.
#[derive(Clone, Debug, PartialEq)]
pub struct Contour {
    /// Lines and arcs in the order of travel.
    pub sections: Vec<Section>,
    /// Sharp outside corners, in the order of travel.
    pub corners: Vec<Corner>,
    /// Side of the path on which the cutter runs.
    pub side: CutterSide,
    /// Whether the end is the start.
    pub closed: bool,
}

impl Contour {
    /// Length of the wall, m.
    pub fn length(&self) -> f64 {
        self.sections.iter().map(|section| section.length).sum()
    }

    /// Shape of the wall along section `i`.
    pub fn shape(&self, section: &Section) -> Shape {
        section.shape(self.side)
    }

    /// Length of the cutter-centre path, m, without moves around corners.
    pub fn centre_length(&self, cutter_radius: f64) -> f64 {
        self.sections.iter().map(|s| s.length * self.shape(s).centre_path_ratio(cutter_radius)).sum()
    }

    /// Smallest concave radius, m; infinite where there is none.
    pub fn smallest_concave_radius(&self) -> f64 {
        let radius = |section: &Section| match self.shape(section) {
            Shape::Concave(radius) => radius,
            Shape::Straight | Shape::Convex(_) => f64::INFINITY,
        };
        self.sections.iter().map(radius).fold(f64::INFINITY, f64::min)
    }

    /// Whether a cutter of this radius can follow every concave section.
    ///
    /// # Errors
    /// [`ContourError::CutterTooLarge`] for the first section that it cannot follow.
    pub fn admits(&self, cutter_radius: f64) -> Result<(), ContourError> {
        for (i, section) in self.sections.iter().enumerate() {
            if let Shape::Concave(radius) = self.shape(section)
                && cutter_radius >= radius
            {
                return Err(ContourError::CutterTooLarge { section: i, radius, cutter_radius });
            }
        }
        Ok(())
    }

    /// The same contour travelled the other way, the cutter therefore on the other side.
    pub fn reversed(&self) -> Self {
        let last = self.sections.len().saturating_sub(1);
        let sections: Vec<Section> = self.sections.iter().rev().map(Section::reversed).collect();
        let mut corners: Vec<Corner> = (self.corners.iter())
            // The corner after section i comes after the reverse of section i + 1; the closing
            // corner stays the closing corner.
            .map(|corner| Corner {
                after: if corner.after == last { last } else { last - 1 - corner.after },
                ..*corner
            })
            .collect();
        corners.sort_by_key(|corner| corner.after);
        Self { sections, corners, side: self.side.other(), closed: self.closed }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Point, Trace};

    fn wedge() -> Contour {
        let mut trace = Trace::new(Point::default(), 0.0);
        for corner in [Point { x: 0.05, y: 0.0 }, Point { x: 0.05, y: 0.02 }, Point::default()] {
            trace.line_to(corner).unwrap();
        }
        trace.finish(CutterSide::Right, true).unwrap()
    }

    #[test]
    fn reversing_twice_is_the_same_contour() {
        let there = wedge();
        let back = there.reversed();
        assert_eq!(back.side, CutterSide::Left);
        assert!((back.corners[0].interior_angle - there.corners[1].interior_angle).abs() < 1e-12);
        assert!((back.corners[2].interior_angle - there.corners[2].interior_angle).abs() < 1e-12);
        let again = back.reversed();
        for (a, b) in again.sections.iter().zip(&there.sections) {
            assert!(a.start.distance(b.start) < 1e-12 && a.shape(again.side) == b.shape(there.side));
        }
    }

    #[test]
    fn a_cutter_larger_than_a_concave_radius_is_refused() {
        let mut trace = Trace::new(Point::default(), 0.0);
        trace.line(0.01).unwrap();
        trace.arc(0.012, 1.0).unwrap();
        let hollow = trace.finish(CutterSide::Left, false).unwrap();
        assert!(hollow.admits(0.010).is_ok());
        assert!(matches!(hollow.admits(0.012), Err(ContourError::CutterTooLarge { section: 1, .. })));
        assert_eq!(wedge().smallest_concave_radius(), f64::INFINITY);
    }
}
