//! The columns of measured records, each listed once.

use super::combine::Combine;
use super::{RecordKind, Sensor};

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
    /// Least possible number (minus infinity: any).
    pub least: f64,
    /// The sensor that it usually has (assumption).
    pub sensor: Sensor,
    /// How the samples of an operation become its number, where a mapping does not say it.
    pub combine: Combine,
}

const fn column(
    name: &'static str,
    unit: &'static str,
    display: &'static str,
    kind: ColumnKind,
    greatest: f64,
) -> RecordColumn {
    let (sensor, combine) = (Sensor::ORDINARY, Combine::Mean);
    RecordColumn { name, unit, display, kind, required: false, greatest, least: f64::NEG_INFINITY, sensor, combine }
}

const fn text(name: &'static str) -> RecordColumn {
    column(name, "1", "1", ColumnKind::Text, f64::INFINITY)
}

const fn condition(name: &'static str, unit: &'static str, display: &'static str, greatest: f64) -> RecordColumn {
    column(name, unit, display, ColumnKind::Condition, greatest)
}

const fn channel(name: &'static str, unit: &'static str, display: &'static str, greatest: f64) -> RecordColumn {
    column(name, unit, display, ColumnKind::Channel, greatest)
}

const fn required(mut column: RecordColumn) -> RecordColumn {
    column.required = true;
    column
}

impl RecordColumn {
    /// The same column, whose numbers are at least `least`.
    const fn from(mut self, least: f64) -> Self {
        self.least = least;
        self
    }

    /// The same column of a sensor with these errors, SI: absolute, relative, least step.
    const fn of_sensor(mut self, absolute: f64, relative: f64, resolution: f64) -> Self {
        self.sensor = Sensor { absolute, relative, resolution };
        self
    }

    /// The same column, of which an operation has the first, the last or the sum of its samples.
    const fn taken(mut self, combine: Combine) -> Self {
        self.combine = combine;
        self
    }
}

/// Least of what nothing is cut without. A time in cut may be zero: a reading before the first cut.
const SOME: f64 = f64::MIN_POSITIVE;

// Columns of several kinds of records: unit and range stand here once.
const SEQUENCE: RecordColumn = condition("sequence", "1", "1", 1e7).taken(Combine::First);
const START_TIME: RecordColumn = condition("start_time", "s", "s", 1e10).taken(Combine::First);
const COOLANT_AGE: RecordColumn = condition("coolant_age", "s", "h", 1e5).taken(Combine::Last);
const CUTTING_SPEED: RecordColumn = condition("cutting_speed", "m/s", "m/min", 3000.0).from(SOME);
const FEED_PER_REV: RecordColumn = condition("feed_per_rev", "m", "mm", 5.0).from(SOME);
const DEPTH_OF_CUT: RecordColumn = condition("depth_of_cut", "m", "mm", 200.0);
const CUTTING_TIME: RecordColumn = condition("cutting_time", "s", "min", 1e4).taken(Combine::Sum).from(0.0);
const SPINDLE_SPEED: RecordColumn = condition("spindle_speed", "rad/s", "rpm", 2e5);
const FEED_OVERRIDE: RecordColumn = condition("feed_override", "1", "%", 300.0);
const CHATTER: RecordColumn = condition("chatter", "1", "1", 1.0);
// Lines of the spectrum of a second of sound.
const CHATTER_FREQUENCY: RecordColumn = condition("chatter_frequency", "1/s", "Hz", 1e6).of_sensor(1.0, 0.0, 1.0);
// Scatter of the rate within a life shows as a few per cent of the land.
const FLANK_WEAR: RecordColumn =
    channel("flank_wear", "m", "mm", 5.0).of_sensor(5e-6, 0.02, 10e-6).taken(Combine::Last);
const CUTTING_FORCE: RecordColumn = channel("cutting_force", "N", "N", 1e5).of_sensor(0.0, 0.02, 0.0);
const FEED_FORCE: RecordColumn = channel("feed_force", "N", "N", 1e5).of_sensor(0.0, 0.03, 0.0);
const SPINDLE_POWER: RecordColumn = channel("spindle_power", "W", "kW", 500.0).of_sensor(0.0, 0.02, 0.0);
const TEMPERATURE: RecordColumn = channel("temperature", "K", "K", 3000.0).of_sensor(3.0, 0.015, 0.0);
const THERMO_EMF: RecordColumn = channel("thermo_emf", "V", "mV", 200.0).of_sensor(0.0, 0.015, 0.0);
const VIBRATION_RMS: RecordColumn = channel("vibration_rms", "m", "um", 1e4);
const DOMINANT_FREQUENCY: RecordColumn = channel("dominant_frequency", "1/s", "Hz", 1e6);
const ROUGHNESS_RA: RecordColumn = channel("roughness_ra", "m", "um", 1e3);
const CYCLE_TIME: RecordColumn = channel("cycle_time", "s", "s", 1e6).of_sensor(0.5, 0.0, 0.0).taken(Combine::Sum);
const STOP_COUNT: RecordColumn = channel("stop_count", "1", "1", 1e4).taken(Combine::Sum);
const STOP_TIME: RecordColumn = channel("stop_time", "s", "s", 1e6).taken(Combine::Sum);
const FEED_PER_TOOTH: RecordColumn = condition("feed_per_tooth", "m", "mm", 5.0).from(SOME);
const WIDTH_OF_CUT: RecordColumn = condition("width_of_cut", "m", "mm", 500.0);

/// Columns of turning operations.
const TURNING: &[RecordColumn] = &[
    required(text("operation_id")),
    required(text("machine")),
    required(text("tool_id")),
    required(SEQUENCE),
    START_TIME,
    text("material"),
    text("lot"),
    text("part_type"),
    text("operator"),
    text("shift"),
    text("coolant_id"),
    COOLANT_AGE,
    required(CUTTING_SPEED),
    required(FEED_PER_REV),
    required(condition("depth_of_cut", "m", "mm", 50.0)),
    required(CUTTING_TIME),
    SPINDLE_SPEED,
    condition("position", "m", "mm", 1e5),
    FEED_OVERRIDE,
    CHATTER,
    CHATTER_FREQUENCY,
    text("edge_end"),
    FLANK_WEAR,
    CUTTING_FORCE,
    FEED_FORCE,
    SPINDLE_POWER,
    TEMPERATURE,
    THERMO_EMF,
    VIBRATION_RMS,
    DOMINANT_FREQUENCY,
    ROUGHNESS_RA,
    CYCLE_TIME,
    STOP_COUNT,
    STOP_TIME,
];

/// Columns of milling cuts.
const MILLING: &[RecordColumn] = &[
    required(text("operation_id")),
    required(text("machine")),
    required(text("tool_id")),
    required(SEQUENCE),
    START_TIME,
    text("material"),
    text("lot"),
    text("part_type"),
    text("operator"),
    text("shift"),
    text("coolant_id"),
    COOLANT_AGE,
    required(CUTTING_SPEED),
    required(FEED_PER_TOOTH),
    required(DEPTH_OF_CUT),
    required(WIDTH_OF_CUT),
    required(CUTTING_TIME),
    SPINDLE_SPEED,
    condition("path_length", "m", "mm", 1e7).taken(Combine::Sum),
    condition("path_curvature", "1/m", "1/m", 1e5),
    condition("helical_deviation", "m", "um", 1e4),
    FEED_OVERRIDE,
    CHATTER,
    CHATTER_FREQUENCY,
    text("edge_end"),
    FLANK_WEAR,
    CUTTING_FORCE,
    FEED_FORCE,
    SPINDLE_POWER,
    TEMPERATURE,
    VIBRATION_RMS,
    DOMINANT_FREQUENCY,
    ROUGHNESS_RA,
    channel("form_error", "m", "um", 1e4).of_sensor(0.5e-6, 0.0, 0.0),
    CYCLE_TIME,
    STOP_COUNT,
    STOP_TIME,
];

/// Columns of grinding trials.
const GRINDING: &[RecordColumn] = &[
    required(text("trial_id")),
    required(text("machine")),
    text("wheel_id"),
    text("dressing_cycle"),
    condition("part_in_cycle", "1", "1", 1e6).taken(Combine::First),
    required(condition("infeed_per_rev", "m", "um", 1e3)),
    required(condition("revolutions", "1", "1", 1e6)),
    condition("spark_out_revolutions", "1", "1", 1e6),
    condition("finish_infeed_per_rev", "m", "um", 1e3),
    condition("finish_revolutions", "1", "1", 1e6),
    required(condition("work_rotation_speed", "rad/s", "rpm", 1e5)),
    condition("width", "m", "mm", 2000.0),
    text("coolant_id"),
    COOLANT_AGE,
    condition("wait_time", "s", "s", 1e6),
    START_TIME,
    channel("stock_removed", "m", "um", 1e4).of_sensor(0.5e-6, 0.0, 0.0),
    channel("normal_force", "N", "N", 1e5).of_sensor(0.0, 0.02, 0.0),
    channel("tangential_force", "N", "N", 1e5).of_sensor(0.0, 0.02, 0.0),
    channel("rise_revolutions", "1", "1", 1e4).of_sensor(0.1, 0.0, 0.0),
    channel("force_after_spark_out", "N", "N", 1e5).of_sensor(1.0, 0.02, 0.0),
];

/// Columns of shop events.
const SHOP: &[RecordColumn] = &[
    required(condition("time", "s", "s", 1e11).taken(Combine::First)),
    required(text("machine")),
    text("state"),
    text("program"),
    text("operation_id"),
    text("tool_id"),
    text("order"),
    condition("quantity", "1", "1", 1e9),
    text("operator"),
    condition("block", "1", "1", 1e9),
    FEED_OVERRIDE,
    condition("rapid_override", "1", "%", 300.0),
    condition("spindle_override", "1", "%", 300.0),
    condition("part_count", "1", "1", 1e9),
];

/// Columns of runs of part programs, as a whole or stretch by stretch.
const PROGRAM: &[RecordColumn] = &[
    required(text("operation_id")),
    required(text("machine")),
    required(text("program")),
    required(SEQUENCE),
    text("tool_id"),
    text("section"),
    text("override_source"),
    condition("first_block", "1", "1", 1e9),
    condition("last_block", "1", "1", 1e9),
    START_TIME,
    FEED_OVERRIDE,
    condition("tool_changes", "1", "1", 1e4),
    condition("hold_count", "1", "1", 1e4),
    condition("hold_time", "s", "s", 1e6),
    condition("spindle_from", "rad/s", "rpm", 2e5),
    condition("spindle_to", "rad/s", "rpm", 2e5),
    condition("stops", "1", "1", 1e7),
    condition("rapid_length", "m", "mm", 1e9),
    condition("corner_sum", "1", "1", 1e7),
    condition("shortest_block", "s", "ms", 1e9),
    condition("waits", "1", "1", 1e6),
    CYCLE_TIME,
];

/// Columns of the jobs that came to a shop.
const ORDERS: &[RecordColumn] = &[
    required(text("order")),
    required(text("part_type")),
    required(condition("arrival_time", "s", "s", 1e10)),
    condition("start_time", "s", "s", 1e10),
    condition("finish_time", "s", "s", 1e10),
    condition("quantity", "1", "1", 1e9).from(0.0),
    condition("scrapped_quantity", "1", "1", 1e9).from(0.0),
];

/// Columns that every table of an empirical model may have.
const ANY: &[RecordColumn] = &[
    required(text("operation_id")),
    required(text("tool_id")),
    required(SEQUENCE),
    text("machine"),
    START_TIME,
    text("material"),
    text("lot"),
    text("part_type"),
    text("operator"),
    text("shift"),
    text("coolant_id"),
    COOLANT_AGE,
    CUTTING_SPEED,
    FEED_PER_REV,
    FEED_PER_TOOTH,
    DEPTH_OF_CUT,
    WIDTH_OF_CUT,
    SPINDLE_SPEED,
    CUTTING_TIME,
    condition("path_length", "m", "m", 1e6).taken(Combine::Sum),
    condition("life", "s", "min", 1e5),
    condition("censored", "1", "1", 1.0),
    condition("inspected", "s", "min", 1e5),
    FEED_OVERRIDE,
    text("edge_end"),
    FLANK_WEAR,
    CUTTING_FORCE,
    FEED_FORCE,
    channel("passive_force", "N", "N", 1e5).of_sensor(0.0, 0.03, 0.0),
    SPINDLE_POWER,
    channel("spindle_torque", "N m", "N m", 1e5).of_sensor(0.0, 0.02, 0.0),
    TEMPERATURE,
    THERMO_EMF,
    VIBRATION_RMS,
    ROUGHNESS_RA,
    channel("acoustic_emission_rms", "1", "1", 1e9),
    CYCLE_TIME,
    STOP_COUNT,
    STOP_TIME,
];

impl RecordKind {
    /// Every kind.
    pub const ALL: [Self; 7] =
        [Self::Turning, Self::Milling, Self::Grinding, Self::Shop, Self::Orders, Self::Program, Self::Empirical];

    /// Its columns.
    pub fn columns(self) -> &'static [RecordColumn] {
        match self {
            Self::Turning => TURNING,
            Self::Milling => MILLING,
            Self::Grinding => GRINDING,
            Self::Shop => SHOP,
            Self::Orders => ORDERS,
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
            Self::Orders => "orders",
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
