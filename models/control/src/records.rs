//! Input, state, output and parameters of the controller.

use toolroom_process::record;
use toolroom_wear::BELIEF;

/// Rules of speed by the number of [`Rule::speed_rule`], from 0.
pub const SPEED_RULES: &[&str] =
    &["fixed speed", "least wear", "productivity at a shadow price", "set path per edge", "literal balance"];

/// Rules of edge change by the number of [`Change::change_rule`], from 0.
pub const CHANGE_RULES: &[&str] = &["never", "wear read", "passes", "cutting time", "wear predicted"];

record! {
    /// What the machine measures.
    pub struct ControlInput {
        /// Whether the edge is in cut.
        engaged: Boolean = 1.0;
        /// Spindle power without idle power.
        spindle_power: Real["W" => "kW"] = 0.0, -1e9..=1e9;
        /// Feed force.
        feed_force: Real["N" => "N"] = 0.0, -1e9..=1e9;
        /// Thermo-EMF of the tool–work pair.
        thermo_emf: Real["V" => "mV"] = 0.0, -10.0..=10.0;
        /// Flank wear as it is read between passes; at any time for a controller that knows it.
        flank_wear: Real["m" => "mm"] = 0.0, -1.0..=1.0;
        /// Whether the edge has collapsed or chipped: it is changed at the next sample.
        tool_lost: Boolean = 0.0;
        /// Whether the wear limit of the edge itself has been passed: the edge is changed after the pass, without a reading.
        tool_worn: Boolean = 0.0;
    }
}

record! {
    /// What the controller keeps from sample to sample.
    pub struct ControlState {
        /// Whether the first pass has begun.
        started: Boolean = 0.0;
        /// What the filter has learnt: means, covariances, level of edges.
        belief: Real["1" => "1"; 22] = 0.0, -1e30..=1e30;
        /// Time to the next sample.
        to_sample: Real["s" => "s"] = 0.0, -1e9..=1e9;
        /// Time in cut since the last sample.
        since_sample: Real["s" => "s"] = 0.0, 0.0..=1e9;
        /// Time in cut since the pass began.
        pass_time: Real["s" => "s"] = 0.0, 0.0..=1e9;
        /// Speed at the start of the pass as planned.
        start_speed: Real["m/s" => "m/min"] = 0.0, 0.0..=50.0;
        /// Speed at its end as planned.
        end_speed: Real["m/s" => "m/min"] = 0.0, 0.0..=50.0;
        /// Speed commanded until the next sample.
        speed: Real["m/s" => "m/min"] = 0.0, 0.0..=50.0;
        /// Speed at the end of the last pass of this edge; 0 before its first.
        last_speed: Real["m/s" => "m/min"] = 0.0, 0.0..=50.0;
        /// Path that the edge has cut.
        edge_path: Real["m" => "m"] = 0.0, 0.0..=1e9;
        /// Time that it has cut.
        edge_time: Real["s" => "min"] = 0.0, 0.0..=1e9;
        /// Passes that it has begun.
        edge_passes: Integer = 0.0, 0.0..=1e9;
        /// Passes begun in all.
        passes: Integer = 0.0, 0.0..=1e9;
        /// Edges used so far, the one in the machine included.
        edges: Integer = 1.0, 1.0..=1e9;
        /// Whether the edge is changed now.
        changing: Boolean = 0.0;
    }
}

const _: () = assert!(BELIEF == 22, "the state holds a belief");

record! {
    /// What the controller commands.
    pub struct ControlOutput {
        /// Cutting speed.
        cutting_speed: Real["m/s" => "m/min"] = 0.0, 0.0..=50.0;
        /// True from the sample at which the edge is changed to the next one.
        tool_change: Boolean = 0.0;
        /// Flank wear as it is believed.
        estimated_flank_wear: Real["m" => "mm"] = 0.0, -1.0..=10.0;
        /// Passes begun so far.
        passes: Integer = 0.0, 0.0..=1e9;
        /// Edges used so far.
        edges: Integer = 1.0, 1.0..=1e9;
    }
}

record! {
    /// The cut as programmed.
    pub struct Operation {
        /// Cutting speed as programmed.
        cutting_speed: Real["m/s" => "m/min"] = 40.0 / 60.0, 1e-3..=50.0;
        /// Feed per revolution.
        feed_per_rev: Real["m" => "mm"] = 0.12e-3, 1e-6..=5e-3;
        /// Depth of cut.
        depth_of_cut: Real["m" => "mm"] = 0.75e-3, 1e-6..=20e-3;
        /// Cutting path of a pass.
        path_length: Real["m" => "m"] = 37.7, 1e-3..=1e6;
    }
}

record! {
    /// How the speed is found.
    pub struct Rule {
        /// 0: the programmed speed; 1: least wear per path; 2: productivity at a shadow price; 3: a set path per edge;
        /// 4: the literal balance of the paper's mode 1.
        speed_rule: Integer = 1.0, 0.0..=4.0;
        /// Factor on the speed that the rule commands.
        speed_factor: Real = 1.0, 1e-3..=1e3;
        /// Worth of a metre of path, of rule 2.
        shadow_price: Real["s/m" => "s/m"] = 1.29, 1e-6..=1e6;
        /// Cutting path over the life of an edge, of rule 3.
        path_per_edge: Real["m" => "m"] = 750.0, 1e-3..=1e9;
        /// Least speed of the machine.
        lowest_speed: Real["m/s" => "m/min"] = 0.0, 0.0..=50.0;
        /// Greatest speed of the machine.
        highest_speed: Real["m/s" => "m/min"] = 50.0, 0.0..=50.0;
    }
}

record! {
    /// When an edge is changed; decided between passes.
    pub struct Change {
        /// 0: never; 1: when the wear read after a pass reaches the limit; 2: after so many passes; 3: before the cutting
        /// time passes the limit; 4: before the next pass brings the estimated wear past the limit.
        change_rule: Integer = 1.0, 0.0..=4.0;
        /// Flank wear of rules 1 and 4.
        flank_wear: Real["m" => "mm"] = 0.5e-3, 0.0..=1.0;
        /// Passes of rule 2.
        passes: Integer = 10.0, 1.0..=1e9;
        /// Cutting time of rule 3.
        cutting_time: Real["s" => "min"] = 900.0, 0.0..=1e9;
    }
}

record! {
    /// How the controller senses.
    pub struct Sensing {
        /// Time between two samples.
        sampling_period: Real["s" => "s"] = 6.0, 1e-3..=1e6;
        /// Whether it is shown the true flank wear in place of an estimate.
        knows_wear: Boolean = 0.0;
        /// Passes from one reading of flank wear to the next.
        read_every: Integer = 1.0, 1.0..=1e9;
        /// Error of such a reading that the filter reckons with.
        reading_error: Real["m" => "mm"] = 1.118e-5, 0.0..=1.0;
    }
}
