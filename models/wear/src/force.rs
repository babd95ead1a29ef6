//! Cutting force and feed force with a wear land.

use crate::{Cut, temperature::power};
use toolroom_process::{Number, record};

record! {
    /// Forces of a worn edge: the sharp edge's force plus shear and pressure on the land.
    ///
    /// | force | equation |
    /// |---|---|
    /// | sharp | `specific_force · (a_p/l_r)^xp · (f/l_r)^yp · (v/v_r)^np · hardness^nP · force_factor` |
    /// | cutting | `sharp + flank_shear_stress · b · h` |
    /// | feed | `feed_force_ratio · sharp + flank_pressure · b·sin κ · h` |
    ///
    /// with width of cut `b = a_p / sin κ`.
    ///
    /// # Source
    /// Power-law force of Kosilova & Meshcheryakov; land terms as in Postnov & Shafikov, eq. (8)
    /// (force proportional to b·h), stresses assumptions. Defaults are the set `ni_vk6om`.
    pub struct Force {
        /// Force at unit depth and feed, C_P.
        specific_force: Real["N" => "N"] = 3470.0, 0.0..=1e6;
        /// Exponent of depth of cut, x_P.
        depth_exponent: Real = 1.0, 0.0..=2.0;
        /// Exponent of feed, y_P.
        feed_exponent: Real = 0.75, 0.0..=2.0;
        /// Exponent of speed, n.
        speed_exponent: Real = 0.0, -1.0..=1.0;
        /// Exponent of hardness, n_P.
        hardness_exponent: Real = 0.75, 0.0..=3.0;
        /// Shear stress on the flank land, tau_f.
        flank_shear_stress: Real["Pa" => "MPa"] = 350e6, 0.0..=1e10;
        /// Pressure on the flank land, sig_f.
        flank_pressure: Real["Pa" => "MPa"] = 900e6, 0.0..=1e10;
        /// Feed force of the sharp edge against its cutting force, k_x.
        feed_force_ratio: Real = 0.40, 0.0..=3.0;
        /// Cutting edge angle κ.
        cutting_edge_angle: Real["rad" => "deg"] = std::f64::consts::FRAC_PI_4, 0.05..=2.0;
        /// Speed at which the coefficients hold, 1 m/min.
        reference_speed: Real["m/s" => "m/min"] = 1.0 / 60.0, 1e-6..=100.0;
        /// Length in which feed and depth are counted, 1 mm.
        reference_length: Real["m" => "mm"] = 1e-3, 1e-6..=1.0;
    }
}

impl<N: Number> Force<N> {
    /// Force of the sharp edge, P_c, N. A speed of zero counts as the reference speed where the
    /// exponent is negative.
    pub fn sharp(&self, cut: &Cut<N>) -> N {
        let speed = cut.cutting_speed / self.reference_speed;
        let speed = if speed.re() > 0.0 { power(speed, self.speed_exponent) } else { N::from(1.0) };
        self.specific_force
            * power(cut.depth_of_cut / self.reference_length, self.depth_exponent)
            * power(cut.feed_per_rev / self.reference_length, self.feed_exponent)
            * speed
            * power(cut.hardness, self.hardness_exponent)
            * cut.force_factor
    }

    /// Cutting force P_z, N.
    pub fn cutting(&self, cut: &Cut<N>, flank_wear: N) -> N {
        let width = cut.depth_of_cut / self.cutting_edge_angle.sin();
        self.sharp(cut) + self.flank_shear_stress * cut.flank_shear_factor * width * flank_wear
    }

    /// Feed force P_x, N. The projected width `b·sin κ` is the depth of cut.
    pub fn feed(&self, cut: &Cut<N>, flank_wear: N) -> N {
        self.feed_force_ratio * self.sharp(cut)
            + self.flank_pressure * cut.flank_pressure_factor * cut.depth_of_cut * flank_wear
    }

    /// Uncut chip thickness a = f·sin κ, m.
    pub fn chip_thickness(&self, cut: &Cut<N>) -> N {
        cut.feed_per_rev * self.cutting_edge_angle.sin()
    }
}
