//! The range in which a pair is used.

use toolroom_process::record;

record! {
    /// Wear limit and speed range of a tool–work pair. Defaults are the set `ni_vk6om`.
    pub struct Limits {
        /// Flank wear at which the edge is spent, h_cr (ISO 3685 VB criterion).
        wear_limit: Real["m" => "mm"] = 0.6e-3, 1e-6..=5e-3;
        /// Lowest admissible cutting speed, v_min.
        lowest_speed: Real["m/s" => "m/min"] = 15.0 / 60.0, 1e-4..=50.0;
        /// Highest admissible cutting speed, v_max.
        highest_speed: Real["m/s" => "m/min"] = 80.0 / 60.0, 1e-4..=50.0;
        /// Usual cutting speed, the centre of every search over speed, v_ref.
        reference_speed: Real["m/s" => "m/min"] = 40.0 / 60.0, 1e-4..=50.0;
    }
}

impl Limits {
    /// `cutting_speed` brought into the admissible range.
    pub fn clip(&self, cutting_speed: f64) -> f64 {
        cutting_speed.max(self.lowest_speed).min(self.highest_speed)
    }
}
