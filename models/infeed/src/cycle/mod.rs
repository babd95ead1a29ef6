//! Rough–finish–spark-out cycles: the fastest within limits, and when to dress.

mod candidate;
mod caps;
mod design;
mod dressing;
mod error;
mod file;
mod law;
mod run;
mod search;
mod surface;

pub use caps::depth_at_temperature;
pub use design::{Cycle, CyclePhase, CyclePoint, fastest_cycle, fastest_cycle_while_dulling, grind_cycle};
pub use dressing::{DressingInterval, DressingPlan, WheelLife, cycle_time_estimate, dressing_interval};
pub use error::CycleError;
pub use file::{CYCLE, CycleFile, WheelState};
pub use surface::Surface;

use toolroom_process::record;

/// Share by which a limit may be passed in rounding.
const ROUNDING: f64 = 1e-12;

record! {
    /// What a cycle must reach and must not exceed.
    ///
    /// Temperature limits hold for the greatest depth of the rough phase and for the depth to
    /// which the finish phase tends: what the rough phase heats beyond the finish limit, the
    /// finish stock takes away. Power, normal force, removal rate and burn margin are those of every revolution.
    ///
    /// # Source
    /// Defaults: assumption. The removal rate of 6 mm²/s is a usual upper value of vitrified corundum wheels
    /// (assumption); without it a soft process would be ground in a few revolutions that no wheel could take. Power,
    /// normal force, infeed speed, roughness and burn margin have defaults that limit nothing.
    pub struct CycleLimits {
        /// Radial stock to remove, Z.
        stock: Real["m" => "um"] = 100e-6, 1e-7..=1e-2;
        /// Temperature rise allowed in the rough phase.
        rough_temperature_rise: Real["K" => "K"] = 650.0, 1.0..=3000.0;
        /// Temperature rise allowed at the depth to which the finish phase tends.
        finish_temperature_rise: Real["K" => "K"] = 250.0, 1.0..=3000.0;
        /// Least stock removed after the rough phase.
        finish_stock: Real["m" => "um"] = 12e-6, 0.0..=1e-2;
        /// Greatest depth of the last revolution: the finish of the surface, and the step that
        /// retraction leaves.
        last_depth: Real["m" => "um"] = 0.30e-6, 1e-12..=1e-3;
        /// Greatest radius left above the commanded size.
        size_error: Real["m" => "um"] = 0.50e-6, 1e-12..=1e-3;
        /// Greatest out-of-roundness, the last step and what is left of the blank's together.
        roundness_error: Real["m" => "um"] = 0.50e-6, 1e-12..=1e-3;
        /// Out-of-roundness of the blank, from a whole number of lobes.
        blank_roundness_error: Real["m" => "um"] = 0.0, 0.0..=1e-2;
        /// Greatest power of the wheel spindle.
        power: Real["W" => "kW"] = 1e6, 1.0..=1e6;
        /// Greatest normal force.
        normal_force: Real["N" => "N"] = 1e6, 0.1..=1e6;
        /// Greatest specific removal rate, Q'_w = v_w h: beyond it the pores of the wheel are full.
        material_removal: Real["m2/s" => "mm2/s"] = 6e-6, 1e-9..=1e-2;
        /// Least distance to burn, by the temperature and by the specific energy; a negative one limits nothing.
        burn_margin: Real = -1e3, -1e3..=0.99;
        /// Greatest roughness Ra at the end of the cycle; needs a measured roughness.
        roughness: Real["m" => "um"] = 1e-3, 1e-9..=1e-3;
        /// Greatest infeed per revolution of the machine.
        greatest_infeed: Real["m" => "um"] = 1e-4, 1e-9..=1e-3;
        /// Greatest finish infeed per revolution: more would be roughing, however cool a soft process stays.
        greatest_finish_infeed: Real["m" => "um"] = 4e-6, 1e-9..=1e-3;
        /// Greatest speed of the infeed of the machine.
        infeed_speed: Real["m/s" => "mm/min"] = 1.0, 1e-9..=1.0;
        /// Step in which the finish infeed can be set.
        infeed_step: Real["m" => "um"] = 0.1e-6, 1e-9..=1e-4;
    }
}

impl CycleLimits {
    /// Whether a roughness is requested.
    pub fn asks_for_roughness(&self) -> bool {
        self.roughness < 1e-3
    }
}
