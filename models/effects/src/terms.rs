//! What an effect may change.

use toolroom_process::{Number, record};

record! {
    /// What the equations of a process read: factors (neutral 1) and summands (neutral 0).
    /// An equation multiplies by the factor or adds the summand and knows nothing of effects.
    pub struct Terms {
        /// Factor on the whole cutting force, and with it on spindle power.
        cutting_force: Real = 1.0, 0.0..=1e6;
        /// Factor on the whole feed force.
        feed_force: Real = 1.0, 0.0..=1e6;
        /// Factor on the specific cutting force k_c: chip formation only, not flank friction.
        specific_cutting_force: Real = 1.0, 0.0..=1e6;
        /// Factor on the rise of the contact temperature above ambient.
        temperature_rise: Real = 1.0, 0.0..=1e6;
        /// Factor on the whole rate of flank wear.
        wear_rate: Real = 1.0, 0.0..=1e6;
        /// Factor on the mechanical, path-driven part of flank wear.
        mechanical_wear: Real = 1.0, 0.0..=1e6;
        /// Summand of the coupling kap_D of mechanical wear to thermal damage D of the tool
        /// material: mechanical wear × (1 + kap_D D). D is a state of the process.
        thermal_damage_coupling: Real = 0.0, 0.0..=1e6;
        /// Summand of the radial offset between the axis of rotation and the axis of the tool
        /// (milling) or of the blank (turning); the process turns it into chip load.
        runout: Real["m" => "um"] = 0.0, 0.0..=1e-2;
        /// Summand of the relative amplitude of the clamping stiffness in a chuck of three jaws.
        chuck_modulation: Real = 0.0, 0.0..=1.0;
        /// Factor on the natural frequencies of what vibrates, at the same stiffness.
        mode_frequency: Real = 1.0, 0.5..=2.0;
        /// Factor on the damping ratios of what vibrates.
        mode_damping: Real = 1.0, 0.1..=10.0;
        /// Factor on the modal stiffnesses of what vibrates, at the same natural frequencies.
        mode_stiffness: Real = 1.0, 0.1..=10.0;
        /// Summand of the indentation coefficient of process damping.
        process_damping: Real["N/m" => "N/m"] = 0.0, 0.0..=1e9;
        /// Factor on the process stiffness Cp of grinding (normal force per depth of cut).
        process_stiffness: Real = 1.0, 0.0..=1e6;
        /// Summand of the normal force below which a grinding wheel rubs without cutting, F0.
        threshold_force: Real["N" => "N"] = 0.0, 0.0..=1e5;
        /// Summand of the fall of the specific cutting force per kelvin of contact temperature
        /// rise: force of the sharp edge × (1 − thermal_softening · rise).
        thermal_softening: Real["1/K" => "1/K"] = 0.0, 0.0..=1.0;
        /// Summand of the chipping rate per path.
        chipping_rate: Real["1/m" => "1/km"] = 0.0, 0.0..=10.0;
        /// Factor on the reading of both force channels.
        force_reading: Real = 1.0, 0.0..=1e6;
        /// Summand of the reading of the cutting force.
        force_offset: Real["N" => "N"] = 0.0, -1e6..=1e6;
        /// Summand of the reading of the contact temperature.
        temperature_offset: Real["K" => "K"] = 0.0, -1e4..=1e4;
        /// Summand of the reading of spindle power: what the drive loses beside the cut.
        spindle_loss: Real["W" => "kW"] = 0.0, 0.0..=1e8;
        /// Summand of the form error of a milled wall.
        form_error: Real["m" => "um"] = 0.0, -1.0..=1.0;
        /// Summand of the radial width of cut.
        width_of_cut: Real["m" => "mm"] = 0.0, -1.0..=1.0;
        /// Summand of the wheel volume worn per work volume ground.
        wheel_wear_ratio: Real = 0.0, 0.0..=100.0;
        /// Summand of the infeed that is commanded before contact.
        start_offset: Real["m" => "um"] = 0.0, -1.0..=1.0;
        /// Factor on the system stiffness of a grinding machine.
        system_stiffness: Real = 1.0, -1e6..=1e6;
        /// Summand of the growth of a part by grinding heat, per normal force and revolution, as
        /// it is when the part is gauged.
        thermal_growth: Real["m/N" => "um/N"] = 0.0, 0.0..=1.0;
    }
}

impl<N: Number> Terms<N> {
    /// What an empty list of effects gives.
    ///
    /// ```
    /// use toolroom_effects::Terms;
    /// assert_eq!(Terms::<f64>::neutral().cutting_force, 1.0);
    /// assert_eq!(Terms::<f64>::neutral().threshold_force, 0.0);
    /// ```
    pub fn neutral() -> Self {
        Terms::<f64>::default().map(N::from)
    }
}
