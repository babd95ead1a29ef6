//! The columns of measured records, each listed once.

use super::RecordKind;

/// What a column holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColumnKind {
    /// A name or word.
    Text,
    /// A commanded or surrounding quantity.
    Condition,
    /// A measured quantity that a model can predict.
    Channel,
}

/// One column of a kind of records.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RecordColumn {
    /// Name in the header.
    pub name: &'static str,
    /// SI unit; `1` for ratios, counts and texts.
    pub unit: &'static str,
    /// Unit of files.
    pub display: &'static str,
    /// What it holds.
    pub kind: ColumnKind,
    /// Whether a row without it is of no use.
    pub required: bool,
    /// Greatest magnitude that occurs in practice, in the display unit: larger ones are slips.
    pub greatest: f64,
}

const fn text(name: &'static str) -> RecordColumn {
    RecordColumn { name, unit: "1", display: "1", kind: ColumnKind::Text, required: false, greatest: f64::INFINITY }
}

const fn condition(name: &'static str, unit: &'static str, display: &'static str, greatest: f64) -> RecordColumn {
    RecordColumn { name, unit, display, kind: ColumnKind::Condition, required: false, greatest }
}

const fn channel(name: &'static str, unit: &'static str, display: &'static str, greatest: f64) -> RecordColumn {
    RecordColumn { name, unit, display, kind: ColumnKind::Channel, required: false, greatest }
}

const fn required(mut column: RecordColumn) -> RecordColumn {
    column.required = true;
    column
}

/// Columns of turning operations.
const TURNING: &[RecordColumn] = &[
    required(text("operation_id")),
    required(text("machine")),
    required(text("tool_id")),
    required(condition("sequence", "1", "1", 1e7)),
    condition("start_time", "s", "s", 1e10),
    text("material"),
    text("lot"),
    text("part_type"),
    text("operator"),
    text("shift"),
    text("coolant_id"),
    condition("coolant_age", "s", "h", 1e5),
    required(condition("cutting_speed", "m/s", "m/min", 3000.0)),
    required(condition("feed_per_rev", "m", "mm", 5.0)),
    required(condition("depth_of_cut", "m", "mm", 50.0)),
    required(condition("cutting_time", "s", "min", 1e4)),
    condition("spindle_speed", "rad/s", "rpm", 2e5),
    condition("position", "m", "mm", 1e5),
    condition("feed_override", "1", "%", 300.0),
    condition("chatter", "1", "1", 1.0),
    condition("chatter_frequency", "1/s", "Hz", 1e6),
    text("edge_end"),
    channel("flank_wear", "m", "mm", 5.0),
    channel("cutting_force", "N", "N", 1e5),
    channel("feed_force", "N", "N", 1e5),
    channel("spindle_power", "W", "kW", 500.0),
    channel("temperature", "K", "K", 3000.0),
    channel("thermo_emf", "V", "mV", 200.0),
    channel("vibration_rms", "m", "um", 1e4),
    channel("dominant_frequency", "1/s", "Hz", 1e6),
    channel("roughness_ra", "m", "um", 1e3),
    channel("cycle_time", "s", "s", 1e6),
    channel("stop_count", "1", "1", 1e4),
    channel("stop_time", "s", "s", 1e6),
];

/// Columns of milling cuts.
const MILLING: &[RecordColumn] = &[
    required(text("operation_id")),
    required(text("machine")),
    required(text("tool_id")),
    required(condition("sequence", "1", "1", 1e7)),
    condition("start_time", "s", "s", 1e10),
    text("material"),
    text("lot"),
    text("part_type"),
    text("operator"),
    text("shift"),
    text("coolant_id"),
    condition("coolant_age", "s", "h", 1e5),
    required(condition("cutting_speed", "m/s", "m/min", 3000.0)),
    required(condition("feed_per_tooth", "m", "mm", 5.0)),
    required(condition("depth_of_cut", "m", "mm", 200.0)),
    required(condition("width_of_cut", "m", "mm", 500.0)),
    required(condition("cutting_time", "s", "min", 1e4)),
    condition("spindle_speed", "rad/s", "rpm", 2e5),
    condition("path_length", "m", "mm", 1e7),
    condition("path_curvature", "1/m", "1/m", 1e5),
    condition("helical_deviation", "m", "um", 1e4),
    condition("feed_override", "1", "%", 300.0),
    condition("chatter", "1", "1", 1.0),
    condition("chatter_frequency", "1/s", "Hz", 1e6),
    text("edge_end"),
    channel("flank_wear", "m", "mm", 5.0),
    channel("cutting_force", "N", "N", 1e5),
    channel("feed_force", "N", "N", 1e5),
    channel("spindle_power", "W", "kW", 500.0),
    channel("temperature", "K", "K", 3000.0),
    channel("vibration_rms", "m", "um", 1e4),
    channel("dominant_frequency", "1/s", "Hz", 1e6),
    channel("roughness_ra", "m", "um", 1e3),
    channel("form_error", "m", "um", 1e4),
    channel("cycle_time", "s", "s", 1e6),
    channel("stop_count", "1", "1", 1e4),
    channel("stop_time", "s", "s", 1e6),
];

/// Columns of grinding trials.
const GRINDING: &[RecordColumn] = &[
    required(text("trial_id")),
    required(text("machine")),
    text("wheel_id"),
    text("dressing_cycle"),
    condition("part_in_cycle", "1", "1", 1e6),
    required(condition("infeed_per_rev", "m", "um", 1e3)),
    required(condition("revolutions", "1", "1", 1e6)),
    condition("spark_out_revolutions", "1", "1", 1e6),
    required(condition("work_rotation_speed", "rad/s", "rpm", 1e5)),
    condition("width", "m", "mm", 2000.0),
    text("coolant_id"),
    condition("coolant_age", "s", "h", 1e5),
    condition("wait_time", "s", "s", 1e6),
    condition("start_time", "s", "s", 1e10),
    channel("stock_removed", "m", "um", 1e4),
    channel("normal_force", "N", "N", 1e5),
    channel("tangential_force", "N", "N", 1e5),
    channel("rise_revolutions", "1", "1", 1e4),
    channel("force_after_spark_out", "N", "N", 1e5),
];

/// Columns of shop events.
const SHOP: &[RecordColumn] = &[
    required(condition("time", "s", "s", 1e11)),
    required(text("machine")),
    text("state"),
    text("program"),
    text("operation_id"),
    text("tool_id"),
    condition("block", "1", "1", 1e9),
    condition("feed_override", "1", "%", 300.0),
    condition("rapid_override", "1", "%", 300.0),
    condition("spindle_override", "1", "%", 300.0),
    condition("part_count", "1", "1", 1e9),
];

/// Columns of runs of part programs, as a whole or stretch by stretch.
const PROGRAM: &[RecordColumn] = &[
    required(text("operation_id")),
    required(text("machine")),
    required(text("program")),
    required(condition("sequence", "1", "1", 1e7)),
    text("tool_id"),
    text("section"),
    text("override_source"),
    condition("first_block", "1", "1", 1e9),
    condition("last_block", "1", "1", 1e9),
    condition("start_time", "s", "s", 1e10),
    condition("feed_override", "1", "%", 300.0),
    condition("tool_changes", "1", "1", 1e4),
    condition("hold_count", "1", "1", 1e4),
    condition("hold_time", "s", "s", 1e6),
    channel("cycle_time", "s", "s", 1e6),
];

/// Columns that every table of an empirical model may have.
const ANY: &[RecordColumn] = &[
    required(text("operation_id")),
    required(text("tool_id")),
    required(condition("sequence", "1", "1", 1e7)),
    text("machine"),
    condition("start_time", "s", "s", 1e10),
    text("material"),
    text("lot"),
    text("part_type"),
    text("operator"),
    text("shift"),
    text("coolant_id"),
    condition("coolant_age", "s", "h", 1e5),
    condition("cutting_speed", "m/s", "m/min", 3000.0),
    condition("feed_per_rev", "m", "mm", 5.0),
    condition("feed_per_tooth", "m", "mm", 5.0),
    condition("depth_of_cut", "m", "mm", 200.0),
    condition("width_of_cut", "m", "mm", 500.0),
    condition("spindle_speed", "rad/s", "rpm", 2e5),
    condition("cutting_time", "s", "min", 1e4),
    condition("life", "s", "min", 1e5),
    condition("censored", "1", "1", 1.0),
    condition("inspected", "s", "min", 1e5),
    condition("feed_override", "1", "%", 300.0),
    text("edge_end"),
    channel("flank_wear", "m", "mm", 5.0),
    channel("cutting_force", "N", "N", 1e5),
    channel("feed_force", "N", "N", 1e5),
    channel("passive_force", "N", "N", 1e5),
    channel("spindle_power", "W", "kW", 500.0),
    channel("spindle_torque", "N m", "N m", 1e5),
    channel("temperature", "K", "K", 3000.0),
    channel("thermo_emf", "V", "mV", 200.0),
    channel("vibration_rms", "m", "um", 1e4),
    channel("roughness_ra", "m", "um", 1e3),
    channel("acoustic_emission_rms", "1", "1", 1e9),
    channel("cycle_time", "s", "s", 1e6),
    channel("stop_count", "1", "1", 1e4),
    channel("stop_time", "s", "s", 1e6),
];

impl RecordKind {
    /// Its columns.
    pub fn columns(self) -> &'static [RecordColumn] {
        match self {
            Self::Turning => TURNING,
            Self::Milling => MILLING,
            Self::Grinding => GRINDING,
            Self::Shop => SHOP,
            Self::Program => PROGRAM,
            Self::Empirical => ANY,
        }
    }

    /// The column called `name`.
    pub fn column(self, name: &str) -> Option<&'static RecordColumn> {
        self.columns().iter().find(|column| column.name == name)
    }

    /// Name of its file in a directory of records, without extension.
    pub fn file_stem(self) -> &'static str {
        match self {
            Self::Turning | Self::Empirical => "operations",
            Self::Milling => "cuts",
            Self::Grinding => "trials",
            Self::Shop => "events",
            Self::Program => "stretches",
        }
    }
}

impl RecordColumn {
    /// SI value of one display unit.
    pub fn scale(&self) -> f64 {
        super::csv_table::scale(self.display, self.unit).map_or(1.0, |(factor, _)| factor)
    }

    /// `name [unit]`.
    pub fn header(&self) -> String {
        if self.display == "1" { self.name.to_owned() } else { format!("{} [{}]", self.name, self.display) }
    }
}
