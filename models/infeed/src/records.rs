//! What goes into plunge grinding, what changes, what comes out.

use toolroom_process::record;

record! {
    /// What the machine commands and what surrounds the cut.
    pub struct Input {
        /// Commanded infeed per work revolution, S (0 in spark-out).
        infeed_per_rev: Real["m" => "um"] = 4.43e-6, 0.0..=1e-3;
        /// Rotation of the workpiece.
        work_rotation_speed: Real["rad/s" => "rpm"] = 292.0 / 60.0 * std::f64::consts::TAU, 0.0..=1e3;
        /// Whether the wheel touches the part; a retracted wheel changes nothing.
        engaged: Boolean = 1.0;
        /// Factor of the coolant on the process stiffness.
        coolant_factor: Real = 1.0, 0.05..=20.0;
        /// Factor of the coolant on the friction F_t/F_n.
        friction_factor: Real = 1.0, 0.05..=20.0;
        /// Factor of this wheel and part on the process stiffness (scatter).
        process_stiffness_factor: Real = 1.0, 0.05..=20.0;
        /// Time since the coolant was changed; seen by effects only.
        coolant_age: Real["s" => "h"] = 0.0, 0.0..=1e9;
        /// Whether another coolant than the nominal one is in use; seen by effects only.
        coolant_changed: Boolean = 0.0;
        /// Time since the machine was switched on; seen by effects only.
        machine_time: Real["s" => "h"] = 0.0, 0.0..=1e9;
        /// Time between the end of grinding and gauging; seen by effects only.
        wait_time: Real["s" => "s"] = 0.0, 0.0..=1e6;
    }
}

record! {
    /// What changes: position, part and wheel.
    ///
    /// Part and wheel change at whole revolutions of the work (a staircase); the commanded
    /// infeed and the phase run on between them.
    pub struct State {
        /// Infeed commanded since the wheel touched the part, u.
        commanded_infeed: Real["m" => "um"] = 0.0, -1.0..=1.0;
        /// Radial stock removed, r.
        stock_removed: Real["m" => "um"] = 0.0, -1.0..=1.0;
        /// Depth of cut of the last whole revolution, h; the spiral step left on the part.
        depth_of_cut: Real["m" => "um"] = 0.0, 0.0..=1.0;
        /// Share of the current revolution that has passed.
        revolution_phase: Real = 0.0, -1e-6..=1.0;
        /// Whole revolutions ground on this part.
        revolutions: Real = 0.0, 0.0..=1e12;
        /// Greatest temperature rise of the grinding zone on this part.
        peak_temperature_rise: Real["K" => "K"] = 0.0, 0.0..=1e5;
        /// Radial wear of the wheel since dressing, w.
        wheel_wear: Real["m" => "um"] = 0.0, 0.0..=1.0;
        /// Volume removed per width since dressing, V'.
        removed_volume: Real["m2" => "mm3/mm"] = 0.0, 0.0..=1e4;
    }
}

record! {
    /// What can be observed, at the last whole revolution.
    pub struct Output {
        /// Normal force F_n (the paper's P_y).
        normal_force: Real["N" => "N"] = 0.0, 0.0..=1e8;
        /// Tangential force F_t (the paper's P_z).
        tangential_force: Real["N" => "N"] = 0.0, 0.0..=1e8;
        /// Power at the wheel, F_t v_s.
        spindle_power: Real["W" => "kW"] = 0.0, 0.0..=1e10;
        /// Depth of cut of the last revolution, h.
        depth_of_cut: Real["m" => "um"] = 0.0, 0.0..=1.0;
        /// Radial stock removed, r.
        stock_removed: Real["m" => "um"] = 0.0, -1.0..=1.0;
        /// Radius left above the commanded size, u − r: deflection, wheel wear, threshold force.
        /// Grows within a revolution with the commanded infeed and falls at its end.
        size_error: Real["m" => "um"] = 0.0, -1.0..=1.0;
        /// Out-of-roundness that an abrupt retraction would leave: the step of the spiral, h, and in a profile its waves.
        roundness_error: Real["m" => "um"] = 0.0, 0.0..=1.0;
        /// Temperature rise of the grinding zone.
        temperature_rise: Real["K" => "K"] = 0.0, 0.0..=1e5;
        /// Temperature of the grinding zone.
        temperature: Real["K" => "K"] = 293.15, 0.0..=1e5;
        /// Specific grinding energy, F_t v_s over the removal rate; 0 out of cut, and without
        /// bound as the depth tends to nothing above a threshold force.
        specific_energy: Real["J/m3" => "J/mm3"] = 0.0, 0.0..=1e35;
        /// Distance to burn, 1 − temperature rise / burn limit.
        burn_margin: Real = 1.0, -1e3..=1.0;
        /// Radial wear of the wheel since dressing, w.
        wheel_wear: Real["m" => "um"] = 0.0, 0.0..=1.0;
        /// Process stiffness Cp now: dulling, coolant and effects included; with a force exponent below 1 at 1 um.
        process_stiffness: Real["N/m" => "N/um"] = 0.0, 0.0..=1e14;
        /// Lag K = Cp/(J + Cp): share of the deflection that a revolution leaves; with a force exponent below 1 that of
        /// a small change at this depth.
        lag: Real = 0.0, 0.0..=1.0;
        /// Revolutions after which the force has risen to 95 %, ln 0.05 / ln K.
        rise_revolutions: Real = 0.0, 0.0..=1e12;
    }
}
