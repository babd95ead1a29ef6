//! What the edge meets: cutting data and the multipliers of scatter and effects.

use toolroom_process::record;

record! {
    /// Cutting data of one instant, with the multipliers that scatter and switched-on effects
    /// put on the nominal model. Every multiplier is neutral at 1, every addition at 0, bit for
    /// bit.
    pub struct Cut {
        /// Cutting speed v_c.
        cutting_speed: Real["m/s" => "m/min"] = 40.0 / 60.0, 0.0..=50.0;
        /// Feed per revolution (s in the paper).
        feed_per_rev: Real["m" => "mm/rev"] = 0.12e-3, 1e-6..=5e-3;
        /// Depth of cut (t in the paper).
        depth_of_cut: Real["m" => "mm"] = 0.75e-3, 1e-6..=20e-3;
        /// Whether the edge is in cut; out of cut it cools and does not wear.
        engaged: Boolean = 1.0;
        /// Work hardness against the nominal one, HB/HB0; acts on heat, mechanical wear and force.
        hardness: Real = 1.0, 0.3..=3.0;
        /// Multiplier of the mechanical wear per path.
        mechanical_factor: Real = 1.0, 0.0..=100.0;
        /// Multiplier of the thermal wear rate.
        thermal_factor: Real = 1.0, 0.0..=100.0;
        /// Multiplier of both parts of wear.
        wear_factor: Real = 1.0, 0.0..=100.0;
        /// Multiplier of the temperature rise of chip and flank.
        temperature_factor: Real = 1.0, 0.0..=10.0;
        /// Multiplier of the force of the sharp edge.
        force_factor: Real = 1.0, 0.0..=10.0;
        /// Multiplier of the shear stress on the flank land.
        flank_shear_factor: Real = 1.0, 0.0..=10.0;
        /// Multiplier of the pressure on the flank land.
        flank_pressure_factor: Real = 1.0, 0.0..=10.0;
        /// Added to the wear law's rate of thermal damage.
        damage_rate: Real["1/s" => "1/min"] = 0.0, 0.0..=10.0;
        /// Added to the wear law's gain of thermal damage.
        damage_gain: Real = 0.0, 0.0..=100.0;
        /// Added to the chipping rate.
        chipping_rate: Real["1/m" => "1/km"] = 0.0, 0.0..=10.0;
    }
}

impl Cut {
    /// Nominal cut: no scatter, no effects.
    pub fn nominal(cutting_speed: f64, feed_per_rev: f64, depth_of_cut: f64) -> Self {
        Self { cutting_speed, feed_per_rev, depth_of_cut, ..Self::default() }
    }

    /// The same cut at another speed.
    pub fn at_speed(&self, cutting_speed: f64) -> Self {
        Self { cutting_speed, ..*self }
    }
}
