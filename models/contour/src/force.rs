//! Linear edge-force model: forces averaged over a revolution, and those of one tooth.

use std::f64::consts::TAU;
use toolroom_process::record;

toolroom_form::vocabulary! {
    /// How the teeth pass the wall.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Milling {
        /// The tooth leaves the cut at the wall (climb milling): the cutter is pushed off the wall.
        Down = "down",
        /// The tooth enters the cut at the wall (conventional milling).
        Up = "up",
    }
}

impl Milling {
    /// +1 down, −1 up.
    pub fn sign(self) -> f64 {
        match self {
            Self::Down => 1.0,
            Self::Up => -1.0,
        }
    }
}

record! {
    /// Coefficients of the linear edge-force model, in which a tooth that cuts a chip of
    /// thickness h over a width b meets the tangential force `(tangential_cutting·h +
    /// tangential_edge)·b` and the radial force `(radial_cutting·h + radial_edge)·b`.
    ///
    /// | symbol | field |
    /// |---|---|
    /// | K_tc (C_пп) | `tangential_cutting` |
    /// | K_te (C_зп) | `tangential_edge` |
    /// | K_rc, K_re | `radial_cutting`, `radial_edge` |
    ///
    /// # Source
    /// Lukin's eq. (9) has the same integrals; K_tc and K_te calibrated to the handbook force
    /// ([`HandbookForce`](crate::HandbookForce)); radial shares, wear and hardness terms are
    /// assumptions.
    pub struct EdgeForce {
        /// Tangential force per chip section.
        tangential_cutting: Real["Pa" => "N/mm2"] = 2960e6, 1e6..=1e11;
        /// Tangential force per width of edge.
        tangential_edge: Real["N/m" => "N/mm"] = 20.8e3, 0.0..=1e7;
        /// Radial force per chip section.
        radial_cutting: Real["Pa" => "N/mm2"] = 0.35 * 2960e6, 0.0..=1e11;
        /// Radial force per width of edge.
        radial_edge: Real["N/m" => "N/mm"] = 0.9 * 20.8e3, 0.0..=1e7;
        /// Flank wear that doubles the edge forces.
        doubling_wear: Real["m" => "mm"] = 0.2e-3, 1e-6..=1.0;
        /// Exponent of hardness in the cutting coefficients.
        hardness_exponent: Real = 0.75, 0.0..=3.0;
    }
}

/// Forces on the cutter, N.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Forces {
    /// Tangential, against rotation: it makes the torque.
    pub tangential: f64,
    /// Along the wall's normal, positive where it pushes the cutter off the wall.
    pub normal: f64,
    /// Along the path, positive against the feed.
    pub feed: f64,
}

impl Forces {
    /// Force that bends the cutter, N.
    pub fn resultant(&self) -> f64 {
        self.normal.hypot(self.feed)
    }
}

/// Forces averaged over a revolution, which are linear in the feed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeanForces {
    /// At zero feed, N.
    pub edge: Forces,
    /// Per feed per tooth, N/m.
    pub per_feed: Forces,
}

impl MeanForces {
    /// Forces at `feed_per_tooth`.
    pub fn at(&self, feed_per_tooth: f64) -> Forces {
        Forces {
            tangential: self.edge.tangential + self.per_feed.tangential * feed_per_tooth,
            normal: self.edge.normal + self.per_feed.normal * feed_per_tooth,
            feed: self.edge.feed + self.per_feed.feed * feed_per_tooth,
        }
    }
}

impl EdgeForce {
    /// Coefficients in harder work and with a worn edge: cutting coefficients times
    /// `hardness_ratio^hardness_exponent`, edge coefficients times
    /// `1 + flank_wear/doubling_wear`.
    ///
    /// # Examples
    /// ```
    /// use toolroom_contour::EdgeForce;
    /// let sharp = EdgeForce::default();
    /// let worn = sharp.under(1.0, 0.2e-3);
    /// assert_eq!(worn.tangential_edge, 2.0 * sharp.tangential_edge);
    /// ```
    pub fn under(&self, hardness_ratio: f64, flank_wear: f64) -> Self {
        let hard = hardness_ratio.powf(self.hardness_exponent);
        let worn = 1.0 + flank_wear / self.doubling_wear;
        Self {
            tangential_cutting: self.tangential_cutting * hard,
            radial_cutting: self.radial_cutting * hard,
            tangential_edge: self.tangential_edge * worn,
            radial_edge: self.radial_edge * worn,
            ..*self
        }
    }

    /// Forces averaged over a revolution of a cutter with `teeth` at engagement angle `ψ` and
    /// width of edge `depth_of_cut`, with `a = depth_of_cut·teeth/2π` and s = +1 down, −1 up:
    ///
    /// ```text
    /// tangential = a·[Ktc·f·(1 − cos ψ) + Kte·ψ]
    /// normal     = a·[Krc·f·½sin²ψ + Kre·sin ψ + s·(Ktc·f·(ψ/2 − ¼sin 2ψ) + Kte·(1 − cos ψ))]
    /// feed       = a·[Krc·f·(ψ/2 − ¼sin 2ψ) + Kre·(1 − cos ψ) − s·(Ktc·f·½sin²ψ + Kte·sin ψ)]
    /// ```
    ///
    /// The helix does not change the average.
    ///
    /// # Examples
    /// ```
    /// use toolroom_contour::{EdgeForce, Milling};
    /// let forces = EdgeForce::default().mean(0.250656, 0.030, 4.0, Milling::Down).at(0.1e-3);
    /// assert!((forces.normal - 191.265).abs() < 0.001);
    /// ```
    pub fn mean(&self, engagement_angle: f64, depth_of_cut: f64, teeth: f64, milling: Milling) -> MeanForces {
        let (sin, cos) = engagement_angle.sin_cos();
        let (rise, half_square) = (1.0 - cos, 0.5 * sin * sin);
        let area = 0.5 * engagement_angle - 0.5 * sin * cos;
        let s = milling.sign();
        let a = depth_of_cut * teeth / TAU;
        let (ktc, kte, krc, kre) =
            (self.tangential_cutting, self.tangential_edge, self.radial_cutting, self.radial_edge);
        MeanForces {
            edge: Forces {
                tangential: a * kte * engagement_angle,
                normal: a * (kre * sin + s * kte * rise),
                feed: a * (kre * rise - s * kte * sin),
            },
            per_feed: Forces {
                tangential: a * ktc * rise,
                normal: a * (krc * half_square + s * ktc * area),
                feed: a * (krc * area - s * ktc * half_square),
            },
        }
    }

    /// Forces per width of edge, N/m, of one tooth at `angle` from the wall within the
    /// engagement, chip thickness `feed_per_tooth·sin(angle)`.
    pub fn of_tooth(&self, feed_per_tooth: f64, angle: f64, milling: Milling) -> Forces {
        let (sin, cos) = angle.sin_cos();
        let s = milling.sign();
        let tangential = self.tangential_cutting * feed_per_tooth * sin + self.tangential_edge;
        let radial = self.radial_cutting * feed_per_tooth * sin + self.radial_edge;
        Forces { tangential, normal: radial * cos + s * tangential * sin, feed: radial * sin - s * tangential * cos }
    }

    /// Force per width of the tooth that meets the thickest chip, N/m.
    pub fn on_tooth(&self, chip_thickness: f64) -> f64 {
        self.tangential_cutting * chip_thickness + self.tangential_edge
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_mean_is_the_integral_over_a_tooth(angle in 0.01..3.1f64, feed in 1e-5..5e-4f64, up: bool) {
            let milling = if up { Milling::Up } else { Milling::Down };
            let force = EdgeForce::default();
            let closed = force.mean(angle, 0.03, 4.0, milling).at(feed);
            let steps = 2000;
            let width = angle / f64::from(steps);
            let mut sum = Forces::default();
            for i in 0..steps {
                let tooth = force.of_tooth(feed, (f64::from(i) + 0.5) * width, milling);
                let share = 0.03 * 4.0 / TAU * width;
                sum.tangential += share * tooth.tangential;
                sum.normal += share * tooth.normal;
                sum.feed += share * tooth.feed;
            }
            let scale = closed.tangential;
            prop_assert!((sum.tangential - closed.tangential).abs() < 1e-6 * scale);
            prop_assert!((sum.normal - closed.normal).abs() < 1e-6 * scale);
            prop_assert!((sum.feed - closed.feed).abs() < 1e-6 * scale);
        }
    }

    #[test]
    fn hardness_acts_on_cutting_and_wear_on_the_edge() {
        let sharp = EdgeForce::default();
        let hard = sharp.under(1.1, 0.0);
        assert_eq!(hard.tangential_edge, sharp.tangential_edge);
        assert!((hard.tangential_cutting / sharp.tangential_cutting - 1.1f64.powf(0.75)).abs() < 1e-12);
        assert_eq!(sharp.under(1.0, 0.0), sharp);
    }
}
