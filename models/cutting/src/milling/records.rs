//! Input, state and output of milling, and the constants of cutter and work.

use toolroom_process::record;
use toolroom_wear::{LARGEST_CONTRAST, LARGEST_TILT};

record! {
    /// What milling is commanded, and what surrounds the cut. Factors are 1 for a nominal
    /// cutter in nominal material.
    pub struct MillingInput {
        /// Cutting speed v_c.
        cutting_speed: Real["m/s" => "m/min"] = 160.0 / 60.0, 0.0..=50.0;
        /// Feed per tooth f_z.
        feed_per_tooth: Real["m" => "mm"] = 0.05e-3, 1e-7..=5e-3;
        /// Axial depth of cut a_p.
        depth_of_cut: Real["m" => "mm"] = 12e-3, 1e-6..=0.2;
        /// Radial width of cut a_e, at most the cutter diameter.
        width_of_cut: Real["m" => "mm"] = 3e-3, 1e-6..=0.5;
        /// Down milling (climb) or, at 0, up milling.
        down_milling: Boolean = 1.0;
        /// Whether the cutter is in cut.
        engaged: Boolean = 1.0;
        /// Hardness of the workpiece against the nominal one, HB/HB0.
        hardness_ratio: Real = 1.0, 0.3..=3.0;
        /// Factor of this cutter on wear.
        wear_rate_factor: Real = 1.0, 0.0..=100.0;
        /// Factor on the force of the sharp cutter.
        force_factor: Real = 1.0, 0.0..=10.0;
        /// Chipping hazard that this cutter bears (an Exp(1) number); large where it is taken
        /// as unbreakable.
        chipping_resistance: Real = 1e12, 0.0..=1e12;
        /// Chipping rate on top of the cutter's own.
        chipping_rate: Real["1/m" => "1/km"] = 0.0, 0.0..=10.0;
        /// 1 in a deviating lot of material, 0 in a nominal one.
        lot_deviation: Real = 0.0, 0.0..=1.0;
        /// Time since the force sensor was zeroed; seen by effects only.
        sensor_time: Real["s" => "h"] = 0.0, 0.0..=1e9;
        /// Feed override in force, 1 as programmed; seen by effects only.
        feed_override: Real = 1.0, 0.0..=3.0;
        /// Curvature of the path; seen by effects only.
        path_curvature: Real["1/m" => "1/m"] = 0.0, 0.0..=1e5;
        /// Deviation of the helical profile of the wall from its mean, where it is gauged; seen
        /// by effects only.
        helical_deviation: Real["m" => "um"] = 0.0, -1e-2..=1e-2;
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
    /// Everything that changes of one cutter.
    pub struct MillingState {
        /// Flank wear VB, mean over the teeth.
        flank_wear: Real["m" => "mm"] = 0.0, 0.0..=1.0;
        /// Path of a tooth in the material.
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
    /// What can be observed of milling. Forces are means over a rotation.
    pub struct MillingOutput {
        /// Flank wear VB.
        flank_wear: Real["m" => "mm"] = 0.0, 0.0..=1.0;
        /// Flank wear against the wear limit.
        wear_ratio: Real = 0.0, 0.0..=1e6;
        /// Tool life of a new cutter in this cut without effects on the rate over its life;
        /// capped where nothing wears.
        tool_life: Real["s" => "min"] = 0.0, 0.0..=1e9;
        /// Tangential force F_t.
        cutting_force: Real["N" => "N"] = 0.0, 0.0..=1e9;
        /// Force along the feed F_f, positive against the feed.
        feed_force: Real["N" => "N"] = 0.0, -1e9..=1e9;
        /// Force across the feed F_n, positive off the wall.
        normal_force: Real["N" => "N"] = 0.0, -1e9..=1e9;
        /// Greatest force on a tooth, tangential and radial together, of the heaviest tooth.
        peak_tooth_force: Real["N" => "N"] = 0.0, 0.0..=1e9;
        /// Cutting power F_t v_c.
        spindle_power: Real["W" => "kW"] = 0.0, 0.0..=1e9;
        /// Spindle speed.
        spindle_speed: Real["rad/s" => "rpm"] = 0.0, 0.0..=1e6;
        /// Speed of the cutter axis, f_z z n.
        feed_rate: Real["m/s" => "mm/min"] = 0.0, 0.0..=100.0;
        /// Material removal rate a_p a_e v_f.
        material_removal_rate: Real["m3/s" => "cm3/min"] = 0.0, 0.0..=1.0;
        /// Engagement angle ψ.
        engagement_angle: Real["rad" => "deg"] = 0.0, 0.0..=3.2;
        /// Greatest chip thickness of the heaviest tooth.
        peak_chip_thickness: Real["m" => "mm"] = 0.0, 0.0..=1.0;
        /// Arithmetic mean roughness of the milled wall, of ideal teeth, with the marks of chatter.
        roughness_ra: Real["m" => "um"] = 0.0, 0.0..=1.0;
        /// Material left on the wall because the cutter gives way, F_n / stiffness.
        form_error: Real["m" => "um"] = 0.0, -1.0..=1.0;
        /// Growth of the material left on the wall since the cutter was new and set.
        size_error: Real["m" => "um"] = 0.0, -1.0..=1.0;
        /// Whether the cut is stable; without a structure it is.
        stable: Boolean = 1.0;
        /// `1 − depth_of_cut/limit`, the limit being the least unstable depth; negative in an
        /// unstable cut, 1 where no depth is unstable or none is judged.
        stability_margin: Real = 1.0, -1e9..=1.0;
        /// Amplitude of the vibration normal to the wall, half of peak to peak.
        vibration_amplitude: Real["m" => "um"] = 0.0, 0.0..=1.0;
        /// Root mean square of a sinusoid of that amplitude.
        vibration_rms: Real["m" => "um"] = 0.0, 0.0..=1.0;
        /// Frequency of chatter, else of the teeth.
        dominant_frequency: Real["Hz" => "Hz"] = 0.0, 0.0..=1e6;
        /// Growth rate of an unstable vibration; 0 in a stable cut.
        chatter_growth_rate: Real["1/s" => "1/s"] = 0.0, 0.0..=1e6;
        /// Root mean square of the force about its mean under chatter, over the mean.
        force_ripple: Real = 0.0, 0.0..=1e3;
    }
}

record! {
    /// The cutter in its holder. Defaults are the set `c45_endmill_d12`.
    pub struct Cutter {
        /// Diameter D.
        diameter: Real["m" => "mm"] = 12e-3, 0.1e-3..=0.5;
        /// Number of teeth z.
        teeth: Integer = 4.0, 1.0..=100.0;
        /// Static stiffness of cutter, holder and spindle at the tip, across the feed.
        static_stiffness: Real["N/m" => "N/um"] = 9.59e6, 1e4..=1e12;
        /// Clearance angle α at the flank land.
        clearance_angle: Real["rad" => "deg"] = 12.0 * std::f64::consts::PI / 180.0, 0.0..=0.7;
    }
}

record! {
    /// Linear edge force: on a tooth at chip thickness h, per depth of cut,
    ///
    /// | force | equation |
    /// |---|---|
    /// | tangential | `K_tc · h + K_te + flank_shear_stress · VB` |
    /// | radial | `K_rc · h + K_re + flank_pressure · VB` |
    ///
    /// # Source
    /// Armarego & Whitfield 1985; Budak, Altintas & Armarego 1996. Land terms: force in
    /// proportion to b·VB as in turning, assumption. Defaults are the set `c45_endmill_d12`.
    pub struct EdgeForce {
        /// Tangential cutting coefficient K_tc.
        tangential_cutting: Real["Pa" => "N/mm2"] = 2389e6, 1e6..=1e11;
        /// Tangential edge coefficient K_te of the sharp edge.
        tangential_edge: Real["N/m" => "N/mm"] = 21.92e3, 0.0..=1e7;
        /// Radial cutting coefficient K_rc.
        radial_cutting: Real["Pa" => "N/mm2"] = 965e6, 0.0..=1e11;
        /// Radial edge coefficient K_re of the sharp edge.
        radial_edge: Real["N/m" => "N/mm"] = 19.73e3, 0.0..=1e7;
        /// Exponent of hardness in the cutting coefficients.
        hardness_exponent: Real = 0.75, 0.0..=3.0;
        /// Shear stress on the flank land.
        flank_shear_stress: Real["Pa" => "MPa"] = 250e6, 0.0..=1e10;
        /// Pressure on the flank land.
        flank_pressure: Real["Pa" => "MPa"] = 600e6, 0.0..=1e10;
    }
}

record! {
    /// Extended Taylor tool life with a flank-wear curve that reaches the wear limit at that
    /// life.
    ///
    /// `tool_life = reference_life · (v/v_r)^-p · (f_z/f_r)^-q · (a_p/a_r)^-r · (a_e/e_r)^-s`,
    /// divided by `hardness^n` and the wear factors;
    /// `d flank_wear / d time = wear_limit / (tool_life · s(x))`, `x = flank_wear/wear_limit`,
    /// `s(x) = 1 + stage_contrast·(6·x·(1 − x) − 1) + stage_tilt·(2·x − 1)`, whose integral over the
    /// life is 1 ([`toolroom_wear::wear_stage`]).
    ///
    /// State of wear and conditions separate, so lives of changing conditions add up by linear
    /// damage: `Σ tᵢ/Tᵢ = 1` at the wear limit, in any order.
    ///
    /// # Source
    /// Taylor 1907 with the exponents of feed, depth and width (handbook form); the three-stage
    /// curve and linear damage are assumptions. Defaults are the set `c45_endmill_d12`.
    pub struct CutterLife {
        /// Tool life at the reference cut.
        reference_life: Real["s" => "min"] = 3600.0, 1.0..=1e7;
        /// Exponent of cutting speed, p.
        speed_exponent: Real = 2.7027, 1.0..=20.0;
        /// Exponent of feed per tooth, q.
        feed_exponent: Real = 0.36, 0.0..=10.0;
        /// Exponent of depth of cut, r.
        depth_exponent: Real = 0.98, 0.0..=10.0;
        /// Exponent of width of cut, s.
        width_exponent: Real = 0.6486, 0.0..=10.0;
        /// Exponent of hardness, n.
        hardness_exponent: Real = 1.0, 0.0..=5.0;
        /// Contrast of the three wear stages: 0 is a straight line, near 1 a sharp S.
        stage_contrast: Real = 0.6, 0.0..=LARGEST_CONTRAST;
        /// Tilt of the wear curve: positive where a new cutter wears faster than a spent one. At most
        /// 0.95·(1 − stage_contrast) in absolute value.
        stage_tilt: Real = 0.0, -LARGEST_TILT..=LARGEST_TILT;
        /// Flank wear at the end of the life (ISO 8688-2: 0.3 mm, mean over the teeth).
        wear_limit: Real["m" => "mm"] = 0.3e-3, 1e-6..=5e-3;
        /// Reference speed.
        reference_speed: Real["m/s" => "m/min"] = 167.4 / 60.0, 1e-3..=50.0;
        /// Reference feed per tooth.
        reference_feed: Real["m" => "mm"] = 0.05e-3, 1e-7..=5e-3;
        /// Reference depth of cut.
        reference_depth: Real["m" => "mm"] = 12e-3, 1e-6..=0.2;
        /// Reference width of cut.
        reference_width: Real["m" => "mm"] = 3e-3, 1e-6..=0.5;
    }
}
