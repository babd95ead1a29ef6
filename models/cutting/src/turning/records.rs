//! Input, state and output of turning.

use toolroom_process::record;
use toolroom_wear::WearState;

record! {
    /// What turning is commanded, and what surrounds the cut. Factors are 1 for a nominal edge
    /// in nominal material.
    pub struct TurningInput {
        /// Cutting speed v_c at the start of the step.
        cutting_speed: Real["m/s" => "m/min"] = 40.0 / 60.0, 0.0..=50.0;
        /// Change of cutting speed during the step.
        cutting_acceleration: Real["m/s2" => "m/min2"] = 0.0, -1.0..=1.0;
        /// Feed per revolution f.
        feed_per_rev: Real["m" => "mm"] = 0.12e-3, 1e-6..=5e-3;
        /// Depth of cut a_p.
        depth_of_cut: Real["m" => "mm"] = 0.75e-3, 1e-6..=20e-3;
        /// Diameter of the workpiece at the cut, for the spindle speed.
        workpiece_diameter: Real["m" => "mm"] = 0.1, 1e-3..=20.0;
        /// Whether the edge is in cut.
        engaged: Boolean = 1.0;
        /// Hardness of the workpiece against the nominal one, HB/HB0.
        hardness_ratio: Real = 1.0, 0.3..=3.0;
        /// Factor of this edge on mechanical wear.
        mechanical_wear_factor: Real = 1.0, 0.0..=100.0;
        /// Factor of this edge on thermal wear.
        thermal_wear_factor: Real = 1.0, 0.0..=100.0;
        /// Factor on both parts of wear: noise during the life of the edge.
        wear_rate_factor: Real = 1.0, 0.0..=100.0;
        /// Factor on the force of the sharp edge.
        force_factor: Real = 1.0, 0.0..=10.0;
        /// Factor on the shear stress on the flank land.
        flank_shear_factor: Real = 1.0, 0.0..=10.0;
        /// Factor on the pressure on the flank land.
        flank_pressure_factor: Real = 1.0, 0.0..=10.0;
        /// Chipping hazard that this edge bears (an Exp(1) number); large where the edge is
        /// taken as unbreakable.
        chipping_resistance: Real = 1e12, 0.0..=1e12;
        /// Chipping rate on top of the tool's own.
        chipping_rate: Real["1/m" => "1/km"] = 0.0, 0.0..=10.0;
        /// Time since the coolant was changed.
        coolant_age: Real["s" => "h"] = 0.0, 0.0..=1e9;
        /// 1 in a deviating lot of material, 0 in a nominal one.
        lot_deviation: Real = 0.0, 0.0..=1.0;
        /// Time since this pass began; seen by effects only.
        pass_time: Real["s" => "s"] = 0.0, 0.0..=1e6;
        /// Time since the force sensor was zeroed; seen by effects only.
        sensor_time: Real["s" => "h"] = 0.0, 0.0..=1e9;
        /// Feed override in force, 1 as programmed; seen by effects only.
        feed_override: Real = 1.0, 0.0..=3.0;
        /// Place of the tool along a bar, from the jaws; 0 where the structure's own counts.
        position: Real["m" => "mm"] = 0.0, 0.0..=100.0;
        /// Factor of this machine on the natural frequencies of its structure.
        natural_frequency_factor: Real = 1.0, 0.5..=2.0;
        /// Factor of this machine on the damping ratios of its structure.
        modal_damping_factor: Real = 1.0, 0.1..=10.0;
        /// Amplitude of a sinusoidal variation of the spindle speed over its mean, RVA.
        speed_variation: Real = 0.0, 0.0..=0.5;
        /// Mean revolutions in one period of the variation, 1/RVF.
        variation_revolutions: Integer = 5.0, 2.0..=200.0;
    }
}

record! {
    /// Everything that changes of one edge.
    pub struct TurningState {
        /// Flank wear VB, the width of the land.
        flank_wear: Real["m" => "mm"] = 0.0, 0.0..=1.0;
        /// Temperature rise of the tool body.
        tool_body_temperature_rise: Real["K" => "K"] = 0.0, 0.0..=1e5;
        /// Thermal damage D of the layer under the land.
        thermal_damage: Real = 0.0, 0.0..=1.0;
        /// Part of the flank wear driven by force and path, F_M.
        mechanical_wear: Real["m" => "mm"] = 0.0, 0.0..=1.0;
        /// Part of the flank wear driven by temperature and time, F_T.
        thermal_wear: Real["m" => "mm"] = 0.0, 0.0..=1.0;
        /// Cutting path.
        cutting_path: Real["m" => "m"] = 0.0, 0.0..=1e9;
        /// Time in cut.
        cutting_time: Real["s" => "min"] = 0.0, 0.0..=1e9;
        /// Accumulated chipping hazard.
        chipping_hazard: Real = 0.0, 0.0..=1e9;
        /// Energy of the cut.
        energy: Real["J" => "kJ"] = 0.0, 0.0..=1e15;
        /// Time in an unstable cut.
        chatter_time: Real["s" => "min"] = 0.0, 0.0..=1e9;
    }
}

record! {
    /// What can be observed of turning.
    pub struct TurningOutput {
        /// Flank wear VB.
        flank_wear: Real["m" => "mm"] = 0.0, 0.0..=1.0;
        /// Flank wear against the wear limit.
        wear_ratio: Real = 0.0, 0.0..=1e6;
        /// Contact temperature at the flank.
        temperature: Real["K" => "K"] = 293.15, 0.0..=1e5;
        /// Mechanical wear per cutting path, A.
        mechanical_wear_per_path: Real["1" => "um/m"] = 0.0, 0.0..=1e3;
        /// Thermal wear rate, B.
        thermal_wear_rate: Real["m/s" => "um/min"] = 0.0, 0.0..=1e6;
        /// Wear per cutting path, J.
        wear_intensity: Real["1" => "um/m"] = 0.0, 0.0..=1e9;
        /// Balance of the weighted functionals: positive where more speed means less wear per path.
        wear_balance: Real = 0.0, -1.0..=1.0;
        /// Cutting force F_c, mean over a revolution.
        cutting_force: Real["N" => "N"] = 0.0, 0.0..=1e9;
        /// Feed force F_f.
        feed_force: Real["N" => "N"] = 0.0, 0.0..=1e9;
        /// Passive force F_p.
        passive_force: Real["N" => "N"] = 0.0, 0.0..=1e9;
        /// Greatest cutting force of a revolution, where the blank runs out.
        peak_cutting_force: Real["N" => "N"] = 0.0, 0.0..=1e9;
        /// Cutting power.
        spindle_power: Real["W" => "kW"] = 0.0, 0.0..=1e9;
        /// Thermo-EMF of the tool–work pair.
        thermo_emf: Real["V" => "mV"] = 0.0, -10.0..=10.0;
        /// Spindle speed.
        spindle_speed: Real["rad/s" => "rpm"] = 0.0, 0.0..=1e6;
        /// Material removal rate.
        material_removal_rate: Real["m3/s" => "cm3/min"] = 0.0, 0.0..=1.0;
        /// Arithmetic mean roughness of an ideal edge, with the marks of chatter.
        roughness_ra: Real["m" => "um"] = 0.0, 0.0..=1.0;
        /// Growth of the workpiece radius since the edge was new and set.
        size_error: Real["m" => "um"] = 0.0, -1.0..=1.0;
        /// Whether the cut is stable; without a structure it is.
        stable: Boolean = 1.0;
        /// `1 − depth_of_cut/limit`, the limit being the least unstable depth; negative in an
        /// unstable cut, 1 where no depth is unstable or none is judged.
        stability_margin: Real = 1.0, -1e9..=1.0;
        /// Amplitude of the vibration between tool and workpiece, half of peak to peak.
        vibration_amplitude: Real["m" => "um"] = 0.0, 0.0..=1.0;
        /// Root mean square of a sinusoid of that amplitude.
        vibration_rms: Real["m" => "um"] = 0.0, 0.0..=1.0;
        /// Frequency of chatter, else of runout or the chuck's lobes; 0 where there is neither.
        dominant_frequency: Real["Hz" => "Hz"] = 0.0, 0.0..=1e6;
        /// Growth rate of an unstable vibration; 0 in a stable cut.
        chatter_growth_rate: Real["1/s" => "1/s"] = 0.0, 0.0..=1e6;
        /// Root mean square of the force about its mean under chatter, over the mean.
        force_ripple: Real = 0.0, 0.0..=1e3;
    }
}

record! {
    /// What decides size and finish.
    ///
    /// # Source
    /// Corner radius of ISO 1832 series 08; clearance angle of a negative insert in its holder,
    /// static stiffness and fluctuation of the force are assumptions.
    pub struct Finish {
        /// Corner radius r_ε.
        corner_radius: Real["m" => "mm"] = 0.8e-3, 1e-6..=1.0;
        /// Clearance angle α_o at the flank land.
        clearance_angle: Real["rad" => "deg"] = 0.104_719_755, 0.0..=0.7;
        /// Static stiffness between tool and workpiece in the passive direction.
        static_stiffness: Real["N/m" => "N/um"] = 30e6, 1e5..=1e12;
        /// Amplitude of the passive force by chip formation, over its mean.
        force_fluctuation: Real = 0.05, 0.0..=1.0;
        /// Rate at which thermal damage builds up at the reference temperature, where the wear
        /// law itself gives none.
        thermal_damage_rate: Real["1/s" => "1/min"] = 0.5 / 60.0, 0.0..=10.0;
    }
}

impl<N: Copy> TurningState<N> {
    /// The part that the wear model knows.
    pub(crate) fn wear(&self) -> WearState<N> {
        WearState {
            flank_wear: self.flank_wear,
            body_temperature_rise: self.tool_body_temperature_rise,
            thermal_damage: self.thermal_damage,
            mechanical_wear: self.mechanical_wear,
            thermal_wear: self.thermal_wear,
            path: self.cutting_path,
            cutting_time: self.cutting_time,
            chipping_hazard: self.chipping_hazard,
        }
    }
}
