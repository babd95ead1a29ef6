//! The form that a helical cutter leaves along its axis.

use crate::{EdgeForce, Milling};
use std::f64::consts::TAU;

/// A helical cutter at one engagement: force at every rotation, and the wall that it leaves.
///
/// A point of the wall is finished when a tooth passes it, and keeps the deflection that the
/// cutter has at that instant. Along the helix the instants differ, so does the deflection: the
/// error varies over the height where the average force sees a constant.
///
/// # Source
/// Surface generation by helical teeth after Kline, DeVor & Shareef 1982; closed integrals of the
/// linear edge-force model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HelicalCut<'f> {
    /// Force coefficients.
    pub force: &'f EdgeForce,
    /// Down or up milling.
    pub milling: Milling,
    /// Engagement angle ψ, rad.
    pub engagement_angle: f64,
    /// Width of edge, m.
    pub depth_of_cut: f64,
    /// Number of teeth.
    pub teeth: f64,
    /// Angle by which the upper end of an edge lags per height, `tan(helix)/cutter_radius`, rad/m.
    pub lag: f64,
}

impl HelicalCut<'_> {
    /// Force along the wall's normal, N, at `rotation` (rad, 0 where a tooth passes the wall at
    /// the lower end).
    pub fn normal_force(&self, feed_per_tooth: f64, rotation: f64) -> f64 {
        let pitch = TAU / self.teeth;
        let s = self.milling.sign();
        let span = self.lag * self.depth_of_cut;
        // Angle from the wall of tooth j at height ζ: s·(lag·ζ − rotation) + j·pitch, so at the
        // lower end −s·rotation + j·pitch and at the upper end s·span more.
        let low = if s > 0.0 { -rotation } else { rotation - span };
        let first = ((-span - low) / pitch).ceil() as i64;
        let last = ((self.engagement_angle - low) / pitch).floor() as i64;
        let mut total = 0.0;
        for tooth in first..=last {
            let from = low + tooth as f64 * pitch;
            let (a, b) = (from.max(0.0), (from + span).min(self.engagement_angle));
            if b > a {
                total += self.primitive(feed_per_tooth, b) - self.primitive(feed_per_tooth, a);
            }
        }
        total / self.lag
    }

    /// Integral of the normal force per width over the angle from the wall.
    fn primitive(&self, feed_per_tooth: f64, angle: f64) -> f64 {
        let (sin, cos) = angle.sin_cos();
        let EdgeForce { tangential_cutting, tangential_edge, radial_cutting, radial_edge, .. } = *self.force;
        radial_cutting * feed_per_tooth * 0.5 * sin * sin
            + radial_edge * sin
            + self.milling.sign()
                * (tangential_cutting * feed_per_tooth * 0.5 * (angle - sin * cos) - tangential_edge * cos)
    }

    /// Force, N, at the instant in which the wall at `height` (m from the lower end) is finished;
    /// over a stiffness it is the form error there.
    ///
    /// # Examples
    /// ```
    /// use toolroom_contour::{Cutter, EdgeForce, HelicalCut, Milling};
    /// let cutter = Cutter::default();
    /// let force = EdgeForce::default();
    /// let cut = HelicalCut { force: &force, milling: Milling::Down, engagement_angle: 0.250656,
    ///     depth_of_cut: 0.03, teeth: cutter.teeth, lag: cutter.helix_lag() };
    /// let error = cut.finishing_force(0.08e-3, 0.015) / cutter.stiffness();
    /// assert!((error - 14.8736e-6).abs() < 1e-10);
    /// ```
    pub fn finishing_force(&self, feed_per_tooth: f64, height: f64) -> f64 {
        self.normal_force(feed_per_tooth, self.lag * height)
    }

    /// Heights, m, between which the finishing force is smooth, both ends included: where a
    /// tooth enters or leaves, at the lower or the upper end, while the wall is finished.
    pub fn heights(&self) -> Vec<f64> {
        let pitch = TAU / self.teeth;
        let span = self.lag * self.depth_of_cut;
        let s = self.milling.sign();
        let mut heights = vec![0.0, self.depth_of_cut];
        for edge in [0.0, self.engagement_angle] {
            for end in [0.0, span] {
                // s·(end − rotation) + j·pitch = edge, with rotation = lag·height.
                let height = end - s * edge;
                let first = (-height / pitch).ceil() as i64;
                let last = ((span - height) / pitch).floor() as i64;
                heights.extend((first..=last).map(|j| (height + j as f64 * pitch) / self.lag));
            }
        }
        heights.retain(|height| (0.0..=self.depth_of_cut).contains(height));
        heights.sort_by(f64::total_cmp);
        heights.dedup();
        heights
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Cutter;
    use proptest::prelude::*;

    fn cut(force: &EdgeForce, engagement_angle: f64, milling: Milling) -> HelicalCut<'_> {
        let cutter = Cutter::default();
        HelicalCut { force, milling, engagement_angle, depth_of_cut: 0.03, teeth: 4.0, lag: cutter.helix_lag() }
    }

    proptest! {
        #[test]
        fn the_average_over_a_pitch_is_the_mean_force(angle in 0.05..2.5f64, up: bool) {
            let force = EdgeForce::default();
            let milling = if up { Milling::Up } else { Milling::Down };
            let cut = cut(&force, angle, milling);
            let mean = force.mean(angle, 0.03, 4.0, milling).at(1e-4);
            let n = 4000;
            let pitch = TAU / 4.0;
            let average: f64 =
                (0..n).map(|i| cut.normal_force(1e-4, (f64::from(i) + 0.5) / f64::from(n) * pitch)).sum::<f64>() / f64::from(n);
            prop_assert!((average - mean.normal).abs() < 1e-5 * mean.tangential, "{average} {}", mean.normal);
        }

        #[test]
        fn the_force_repeats_every_pitch(angle in 0.05..2.5f64, rotation in -4.0..4.0f64) {
            let force = EdgeForce::default();
            let cut = cut(&force, angle, Milling::Down);
            let (here, there) = (cut.normal_force(1e-4, rotation), cut.normal_force(1e-4, rotation + TAU / 4.0));
            prop_assert!((here - there).abs() < 1e-9 * (1.0 + here.abs()));
        }
    }

    #[test]
    fn kinks_of_the_form_are_found() {
        let force = EdgeForce::default();
        let cut = cut(&force, 0.9, Milling::Down);
        let heights = cut.heights();
        let smooth = |a: f64, b: f64| {
            // Halving the step of a smooth function quarters the second difference.
            let bend = |h: f64| {
                let m = 0.5 * (a + b);
                cut.finishing_force(1e-4, m + h) - 2.0 * cut.finishing_force(1e-4, m) + cut.finishing_force(1e-4, m - h)
            };
            let h = 0.4 * (b - a);
            bend(h).abs() < 1e-6 || (bend(h) / bend(0.5 * h) - 4.0).abs() < 0.5
        };
        assert!(heights.len() > 2);
        assert!(heights.windows(2).all(|pair| smooth(pair[0], pair[1])), "{heights:?}");
    }
}
