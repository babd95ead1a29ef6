//! What an effect may look at.

use toolroom_process::{Number, record};

record! {
    /// What a process tells its effects about the cut: physical quantities only, never a name
    /// of a machine or a tool.
    ///
    /// A process fills what it has and takes the rest from [`Context::neutral`].
    ///
    /// ```
    /// use toolroom_effects::Context;
    /// let worn = Context { flank_wear: 0.2e-3, ..Context::neutral() };
    /// assert_eq!(worn.cutting_time, 0.0);
    /// ```
    pub struct Context {
        /// Flank wear land VB of the edge (ISO 3685).
        flank_wear: Real["m" => "mm"] = 0.0, 0.0..=0.01;
        /// Time that the edge has been in cut.
        cutting_time: Real["s" => "min"] = 0.0, 0.0..=1e8;
        /// Age of the coolant since it was changed.
        coolant_age: Real["s" => "h"] = 0.0, 0.0..=1e9;
        /// Membership of the deviating material lot: 0 for a nominal lot, 1 for the deviating one.
        lot_deviation: Real = 0.0, 0.0..=1.0;
        /// Whether another coolant than the nominal one is in use: 0 or 1.
        coolant_changed: Real = 0.0, 0.0..=1.0;
        /// Material removed per wheel width since dressing, V'.
        removed_volume: Real["m2" => "mm3/mm"] = 0.0, 0.0..=1e3;
        /// Cutting speed v_c.
        cutting_speed: Real["m/s" => "m/min"] = 0.0, 0.0..=50.0;
        /// Time since this pass began.
        pass_time: Real["s" => "s"] = 0.0, 0.0..=1e6;
        /// Time since the force sensor was zeroed.
        sensor_time: Real["s" => "h"] = 0.0, 0.0..=1e9;
        /// Time since the machine was switched on.
        machine_time: Real["s" => "h"] = 0.0, 0.0..=1e9;
        /// Feed override in force, 1 as programmed.
        feed_override: Real = 1.0, 0.0..=3.0;
        /// Time between the end of grinding and gauging.
        wait_time: Real["s" => "s"] = 0.0, 0.0..=1e6;
        /// Speed of the cutter axis along the path.
        feed_rate: Real["m/s" => "mm/min"] = 0.0, 0.0..=100.0;
        /// Curvature of the path.
        path_curvature: Real["1/m" => "1/m"] = 0.0, 0.0..=1e5;
        /// Deviation of the helical profile of the wall from its mean, where it is gauged.
        helical_deviation: Real["m" => "um"] = 0.0, -1e-2..=1e-2;
        /// Feed per revolution in turning, per tooth in milling.
        feed: Real["m" => "mm"] = 0.1e-3, 1e-7..=5e-3;
        /// Depth of cut a_p.
        depth_of_cut: Real["m" => "mm"] = 1e-3, 1e-6..=0.2;
        /// Commanded radial width of cut a_e.
        width_of_cut: Real["m" => "mm"] = 1e-3, 1e-6..=0.5;
        /// Diameter of the workpiece at the cut.
        workpiece_diameter: Real["m" => "mm"] = 0.1, 1e-3..=20.0;
    }
}

impl<N: Number> Context<N> {
    /// A new edge or freshly dressed wheel, nominal material, fresh nominal coolant.
    pub fn neutral() -> Self {
        Context::<f64>::default().map(N::from)
    }
}
