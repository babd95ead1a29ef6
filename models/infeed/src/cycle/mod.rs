//! Rough–finish–spark-out cycles: the fastest within limits, and when to dress.

mod design;
mod dressing;
mod file;

pub use design::{Cycle, CycleError, CyclePhase, CyclePoint, depth_at_temperature, fastest_cycle, grind_cycle};
pub use dressing::{DressingInterval, cycle_time_estimate, dressing_interval};
pub use file::{CYCLE, CycleFile, DressingPlan};

use toolroom_process::record;

record! {
    /// What a cycle must reach and must not exceed.
    ///
    /// Temperature limits hold for the greatest depth of the rough phase and for the depth to
    /// which the finish phase tends: what the rough phase heats beyond the finish limit, the
    /// finish stock takes away.
    ///
    /// # Source
    /// Defaults: assumption.
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
        /// Greatest infeed per revolution of the machine.
        greatest_infeed: Real["m" => "um"] = 1e-4, 1e-9..=1e-3;
        /// Step in which the finish infeed can be set.
        infeed_step: Real["m" => "um"] = 0.1e-6, 1e-9..=1e-4;
    }
}
