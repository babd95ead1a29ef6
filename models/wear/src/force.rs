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

/// Forces of one cut, for any flank wear: both are affine in it.
#[derive(Clone, Copy, Debug)]
pub struct Load<N> {
    /// Force of the sharp edge P_c, N.
    pub sharp: N,
    /// The same at the reference speed.
    sharp_level: N,
    /// Cutting force per flank wear, N/m.
    pub shear_per_wear: N,
    /// Feed force of the sharp edge against [`Load::sharp`].
    pub feed_force_ratio: N,
    /// Feed force per flank wear, N/m.
    pub pressure_per_wear: N,
}

impl<N: Number> Load<N> {
    /// Cutting force P_z, N.
    #[inline]
    pub fn cutting(&self, flank_wear: N) -> N {
        self.sharp + self.shear_per_wear * flank_wear
    }

    /// Feed force P_x, N.
    #[inline]
    pub fn feed(&self, flank_wear: N) -> N {
        self.feed_force_ratio * self.sharp + self.pressure_per_wear * flank_wear
    }

    /// The same with another factor on the force of the sharp edge.
    #[inline]
    pub fn times(&self, factor: N) -> Self {
        Self { sharp: self.sharp * factor, sharp_level: self.sharp_level * factor, ..*self }
    }
}

impl<N: Number> Force<N> {
    /// The forces that `cut` causes. A speed of zero counts as the reference speed where the
    /// exponent is negative.
    ///
    /// # Examples
    /// ```
    /// use toolroom_wear::{Cut, Force};
    /// let load = Force::default().load(&Cut::default());
    /// assert!((load.cutting(0.2e-3) - 604.8577).abs() < 1e-4);
    /// assert!((load.feed(0.2e-3) - 347.2446).abs() < 1e-4);
    /// ```
    pub fn load(&self, cut: &Cut<N>) -> Load<N> {
        // The projected width `b·sin κ` is the depth of cut.
        let width = cut.depth_of_cut / self.cutting_edge_angle.sin();
        let sharp_level = self.specific_force
            * power(cut.depth_of_cut / self.reference_length, self.depth_exponent)
            * power(cut.feed_per_rev / self.reference_length, self.feed_exponent)
            * power(cut.hardness, self.hardness_exponent)
            * cut.force_factor;
        let level = Load {
            sharp: sharp_level,
            sharp_level,
            shear_per_wear: self.flank_shear_stress * cut.flank_shear_factor * width,
            feed_force_ratio: self.feed_force_ratio,
            pressure_per_wear: self.flank_pressure * cut.flank_pressure_factor * cut.depth_of_cut,
        };
        self.at_speed(&level, cut.cutting_speed)
    }

    /// The same cut at another speed.
    #[inline]
    pub fn at_speed(&self, load: &Load<N>, cutting_speed: N) -> Load<N> {
        let speed = cutting_speed / self.reference_speed;
        let speed = if speed.re() > 0.0 { power(speed, self.speed_exponent) } else { N::from(1.0) };
        Load { sharp: load.sharp_level * speed, ..*load }
    }

    /// Uncut chip thickness a = f·sin κ, m.
    pub fn chip_thickness(&self, cut: &Cut<N>) -> N {
        cut.feed_per_rev * self.cutting_edge_angle.sin()
    }
}
