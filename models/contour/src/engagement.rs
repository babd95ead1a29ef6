//! How much of the cutter's circumference is in the wall.

use crate::Shape;

/// Contact of a cutter with the allowance that it removes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Engagement {
    /// Engagement angle ψ, rad, from the finished wall to the edge of the stock.
    pub angle: f64,
    /// Effective radial immersion `cutter_radius·(1 − cos ψ)`, m: the allowance of a straight
    /// wall with the same engagement.
    pub immersion: f64,
}

impl Engagement {
    /// Engagement on a wall of constant curvature with parallel stock:
    /// `cos ψ = ±[(R ± R_f)² + R_f² − (R ± t)²] / [2·R_f·(R ± R_f)]`, upper signs convex, lower
    /// concave; `cos ψ = 1 − t/R_f` on a straight wall.
    ///
    /// # Validity
    /// `cutter_radius` below a concave radius. Where the stock leaves no free side of the
    /// cutter, ψ = π: a full slot.
    ///
    /// # Source
    /// Lukin, eq. (10). For concave walls the printed numerator has the wrong sign: the cosine
    /// rule in the triangle of wall centre, cutter centre and stock edge gives the form here.
    ///
    /// # Examples
    /// ```
    /// use toolroom_contour::{Engagement, Shape};
    /// let straight = Engagement::new(Shape::Straight, 0.016, 0.003);
    /// let concave = Engagement::new(Shape::Concave(0.022), 0.016, 0.003);
    /// assert!((straight.immersion - 0.003).abs() < 1e-15);
    /// assert!((concave.immersion - 0.01025).abs() < 1e-15); // 3.4 times as much
    /// ```
    pub fn new(shape: Shape, cutter_radius: f64, allowance: f64) -> Self {
        let cos = match shape {
            Shape::Straight => 1.0 - allowance / cutter_radius,
            Shape::Convex(radius) => {
                let centre = radius + cutter_radius;
                let stock = radius + allowance;
                (centre * centre + cutter_radius * cutter_radius - stock * stock) / (2.0 * cutter_radius * centre)
            }
            Shape::Concave(radius) => {
                let centre = radius - cutter_radius;
                let stock = (radius - allowance).max(0.0);
                (stock * stock - centre * centre - cutter_radius * cutter_radius) / (2.0 * cutter_radius * centre)
            }
        };
        let cos = cos.clamp(-1.0, 1.0);
        Self { angle: cos.acos(), immersion: cutter_radius * (1.0 - cos) }
    }

    /// Greatest undeformed chip thickness per feed per tooth, `sin ψ`, 1 from a right angle on.
    pub fn chip_thickness_ratio(&self) -> f64 {
        if self.angle < std::f64::consts::FRAC_PI_2 { self.angle.sin() } else { 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// The edge of the stock, walked along the cutter, lies on the stock circle.
        #[test]
        fn the_engaged_arc_ends_on_the_stock(radius in 0.02..0.5f64, share in 0.05..0.95f64, t in 0.0001..0.01f64) {
            let cutter = share * radius;
            for (shape, side) in [(Shape::Convex(radius), 1.0), (Shape::Concave(radius), -1.0)] {
                let angle = Engagement::new(shape, cutter, t).angle;
                prop_assume!(angle < 0.999 * std::f64::consts::PI);
                // Wall centre at the origin, cutter centre on the x axis, contact towards the wall.
                let centre = radius + side * cutter;
                let edge = (centre - side * cutter * angle.cos()).hypot(cutter * angle.sin());
                prop_assert!((edge - (radius + side * t)).abs() < 1e-9, "{shape:?} {edge}");
            }
        }

        #[test]
        fn great_radii_tend_to_a_straight_wall(t in 0.0001..0.01f64) {
            let straight = Engagement::new(Shape::Straight, 0.016, t).angle;
            for shape in [Shape::Convex(1e4), Shape::Concave(1e4)] {
                prop_assert!((Engagement::new(shape, 0.016, t).angle - straight).abs() < 1e-4);
            }
        }
    }

    #[test]
    fn stock_all_round_is_a_full_slot() {
        let slot = Engagement::new(Shape::Concave(0.02), 0.016, 0.05);
        assert_eq!(slot.angle, std::f64::consts::PI);
        assert_eq!(slot.chip_thickness_ratio(), 1.0);
    }
}
