//! Machine files: the control and the drives of a machine, and presets of them.

use crate::record::Drives;
use std::path::Path;
use std::sync::Arc;
use toolroom_form::{
    ContentFault, Fault, Form, FormFile, Key, Kind, Quantity, ReadError, Section, Walk, fill_record, parse, read,
};
use toolroom_process::Record;
use toolroom_program::{Control, Units};

/// A machine: what its control adds to the words, and what its drives, spindle and changer do to the times.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Machine {
    /// Settings of the control.
    pub control: Control,
    /// Drives, spindle and tool changer.
    pub drives: Drives,
}

/// Names of the machines that come with toolroom.
pub const PRESETS: [&str; 8] =
    ["generic-vmc", "fanuc-0i", "fanuc-31i", "haas-ngc", "siemens-840d", "heidenhain-tnc", "hurco-winmax", "linuxcnc"];

const TEXTS: [&str; PRESETS.len()] = [
    include_str!("../presets/generic-vmc.toml"),
    include_str!("../presets/fanuc-0i.toml"),
    include_str!("../presets/fanuc-31i.toml"),
    include_str!("../presets/haas-ngc.toml"),
    include_str!("../presets/siemens-840d.toml"),
    include_str!("../presets/heidenhain-tnc.toml"),
    include_str!("../presets/hurco-winmax.toml"),
    include_str!("../presets/linuxcnc.toml"),
];

/// The key of a field of the drives under another name.
const fn named(name: &'static str, field: &str) -> Key {
    Key { name, ..Key::of_named(Drives::<f64>::FIELDS, field) }
}

/// A form whose keys are fields of the drives, and which key is which field.
macro_rules! fields {
    ($form:ident, $map:ident, $title:literal, $doc:literal, [$($key:literal = $field:literal),* $(,)?] $(, $more:expr)*) => {
        const $map: &[(&str, &str)] = &[$(($key, $field)),*];
        static $form: Form = Form { title: $title, doc: $doc, keys: &[$(named($key, $field),)* $($more),*] };
    };
}

fields!(
    SETTLING,
    SETTLING_FIELDS,
    "settling",
    "Time that the axes need to settle where they stop",
    ["feed" = "feed_settling", "rapid" = "rapid_settling",]
);
fields!(
    BRAKING,
    BRAKING_FIELDS,
    "braking",
    "The spindle while it brakes; as upwards where it is left out",
    ["constant" = "braking_constant", "base_speed" = "braking_base_speed",]
);
fields!(
    SPINDLE,
    SPINDLE_FIELDS,
    "[drives.spindle]",
    "How fast the spindle changes its speed, and what waits for it",
    [
        "constant" = "spindle_constant",
        "base_speed" = "spindle_base_speed",
        "orient_time" = "orient_time",
        "rigid_tap_reversal" = "tap_reversal",
    ],
    Key::optional("braking", Kind::Table(&BRAKING), "The spindle while it brakes"),
    Key::optional(
        "waits",
        Kind::Choice(&WAITS),
        "What waits for the spindle: the first motion at feed or the block of the coolant, or the block of its command"
    ),
    Key::optional(
        "stop_waits",
        Kind::Flag,
        "Whether a programmed stop waits until the spindle stands; it does if left out"
    )
);
fields!(
    CHANGER,
    CHANGER_FIELDS,
    "[drives.changer]",
    "The tool changer",
    [
        "change_time" = "tool_change_time",
        "approach_time" = "approach_time",
        "home_time" = "home_time",
        "from_home_time" = "from_home_time",
        "index_time" = "index_time",
    ],
    Key::optional(
        "kind",
        Kind::Choice(&CHANGERS),
        "Whether the next tool waits at an arm, so that no pocket takes time, or a carousel turns to it by index_time"
    )
);

/// Words of `waits`: `spindle_block_wait` 0 and 1.
const WAITS: [&str; 2] = ["first_feed", "block"];
/// Words of `rapid`: `independent_rapid` 0 and 1.
const RAPID: [&str; 2] = ["interpolated", "independent"];
/// Step of the speed that is a stop, m/s.
const STOP: f64 = 1e-9;
/// Words of the rule of corners.
const CORNER_RULES: [&str; 4] = ["deviation", "axis_step", "exact_stop", "cosine"];
/// Words of `kind` of the changer: the next tool waits at an arm, or the magazine turns to it first.
const CHANGERS: [&str; 2] = ["arm", "carousel"];
/// Words of `spindle_wait` of the control.
const SPINDLE_WAITS: [&str; 3] = ["M8", "first_feed", "block"];

static CORNER: Form = Form {
    title: "corner",
    doc: "Speed at corners",
    keys: &[
        Key::required("rule", Kind::Choice(&CORNER_RULES), "What is bounded there"),
        named("value", "corner_deviation").when("rule", &["deviation"]),
        named("value", "corner_step").when("rule", &["axis_step"]),
    ],
};

/// A speed in rapid motion.
const SPEED: Kind = Kind::Quantity(Quantity {
    example: "30 m/min",
    ..Quantity::of(&Drives::<f64>::FIELDS[0]) // rapid_speed stands first
});
/// A speed of rotary axes.
const TURN: Kind = Kind::positive("rad/s", "rpm", 1e4, "25 rpm");
/// An acceleration of linear axes.
const ACCELERATION: Kind = Kind::positive("m/s2", "m/s2", 1000.0, "3 m/s2");

static SPEEDS: Form = Form {
    title: "rapid_speed",
    doc: "Rapid speed of each axis",
    keys: &[
        Key::required("X", SPEED, "Rapid speed of X"),
        Key::required("Y", SPEED, "Rapid speed of Y"),
        Key::required("Z", SPEED, "Rapid speed of Z"),
        Key::optional("A", TURN, "Rapid speed of rotary axes"),
    ],
};

static ACCELERATIONS: Form = Form {
    title: "acceleration",
    doc: "Acceleration of each axis in rapid motion",
    keys: &[
        Key::required("X", ACCELERATION, "Acceleration of X"),
        Key::required("Y", ACCELERATION, "Acceleration of Y"),
        Key::required("Z", ACCELERATION, "Acceleration of Z"),
    ],
};

/// `[drives]`: feed drives, spindle and tool changer. [`drives`] reads it.
pub static DRIVES: Form = Form {
    title: "[drives]",
    doc: "Feed drives, spindle and tool changer",
    keys: &[
        Key::optional("preset", Kind::Choice(&PRESETS), "Machine whose values hold where none is given"),
        Key::optional(
            "rapid_speed",
            Kind::Shorthand { word: &SPEED, form: &SPEEDS },
            "Rapid speed of all axes, or of each: { X, Y, Z, A }",
        ),
        Key::optional(
            "acceleration",
            Kind::Shorthand { word: &ACCELERATION, form: &ACCELERATIONS },
            "Acceleration of rapid motions, of all axes or of each: { X, Y, Z }; at feed too, where feed_acceleration is not given",
        ),
        Key::optional("feed_acceleration", ACCELERATION, "Acceleration along the path at feed"),
        Key::optional("jerk", Kind::positive("m/s3", "m/s3", 1e6, "20 m/s3"), "Jerk along the path at feed"),
        Key::optional("corner", Kind::Table(&CORNER), "Speed at corners: { rule, value }"),
        Key::optional("settling", Kind::Table(&SETTLING), "Time that the axes need to settle: { feed, rapid }"),
        Key::optional(
            "look_ahead",
            Kind::Count { min: 0, max: 1_000_000 },
            "Motions over which the control looks ahead; 0 for the whole path",
        ),
        Key::optional("rapid", Kind::Choice(&RAPID), "Whether the axes of a rapid motion arrive together"),
        Key::optional("spindle", Kind::Table(&SPINDLE), "How fast the spindle changes its speed"),
        Key::optional("changer", Kind::Table(&CHANGER), "The tool changer"),
        named("tool_change_time", "tool_change_time"),
        named("inverse_acceleration", "inverse_acceleration"),
        named("inverse_rapid_acceleration", "inverse_rapid_acceleration"),
        named("corner_deviation", "corner_deviation"),
        named("jerk_time", "jerk_time"),
        named("feed_settling", "feed_settling"),
        named("rapid_settling", "rapid_settling"),
        named("hole_dwell", "hole_dwell"),
        named("feed_override", "feed_override"),
        named("block_time", "block_time"),
        named("coolant_time", "coolant_time"),
        named("program_start", "program_start"),
        named("program_end", "program_end"),
    ],
};

static CONTROL: Form = Form {
    title: "[control]",
    doc: "What the control adds to the words of a program",
    keys: &[
        Key::optional("units", Kind::Choice(&Units::NAMES), "Unit of lengths of a program that names none"),
        Key::optional(
            "decimal",
            Kind::Choice(&["calculator", "least_increment"]),
            "What a number without a point counts",
        ),
        Key::optional("rotary_feed", Kind::Choice(&["linear_axes", "all_axes"]), "Axes of which F is the speed"),
        Key::optional("feed_at", Kind::Choice(&["centre", "contour"]), "Where F holds under compensation"),
        Key::optional(
            "peck_clearance",
            Kind::quantity("m", "mm", 0.0, 1.0, "1 mm"),
            "Distance above the last depth at which a peck begins again",
        ),
        Key::optional(
            "pecks",
            Kind::Choice(&["chip_breaking", "full"]),
            "Where pecks of lathes are drawn: back by the clearance, or out to the plane R",
        ),
        Key::optional("turns", Kind::Choice(&["L", "P"]), "Letter of the turns of a helix on Fanuc"),
        Key::optional(
            "startup",
            Kind::Choice(&["A", "B"]),
            "How compensation of the radius begins and ends at outer corners: A straight, B around the corner",
        ),
        Key::optional(
            "spindle_wait",
            Kind::Choice(&SPINDLE_WAITS),
            "What waits for the spindle: the block of the coolant or the first motion at feed, the latter alone, or the block of its command",
        ),
        Key::optional(
            "rapid_blend",
            Kind::Flag,
            "Whether the axes go on between motions at feed and rapid ones; they rest if left out",
        ),
        Key::optional(
            "offset",
            Kind::Texts,
            "Origins of the work offsets G54 to G59 against each other: G55 = \"100,0,0 mm\"",
        ),
        Key::optional("m", Kind::Texts, "Times of M codes: 29 = \"0.3 s\""),
        Key::optional("g", Kind::Texts, "Times of G codes that are not understood: 411 = \"0 s\""),
    ],
};

/// A machine file. [`Machine::read`] reads it.
pub static MACHINE: Form = Form {
    title: "the machine",
    doc: "The control, drives, spindle and tool changer of a machine",
    keys: &[
        Key::optional("schema", Kind::Count { min: 1, max: u64::MAX }, "Version of the format, 1"),
        Key::optional("control", Kind::Table(&CONTROL), "What the control adds to the words of a program"),
        Key::optional("drives", Kind::Table(&DRIVES), "Feed drives, spindle and tool changer"),
    ],
};

/// What is wrong in a machine file beside its form.
#[derive(Debug, thiserror::Error)]
enum MachineFault {
    #[error("{0}")]
    Control(String),
    #[error("a jerk bounds how fast an acceleration builds up, but none is given; give feed_acceleration")]
    Jerk,
}

/// The code of what is wrong in a machine file beside its form, with its explanation.
pub const CODES: &[(&str, &str)] = &[(
    "machine",
    "A machine file says what its control and its drives do. [control.m] and [control.g] hold times of codes by number, such as 29 = \"0.3 s\". A jerk needs the acceleration that it builds up.",
)];

impl ContentFault for MachineFault {
    fn code(&self) -> &'static str {
        CODES[0].0
    }
}

impl From<MachineFault> for Fault {
    fn from(fault: MachineFault) -> Self {
        Self::Content(Arc::new(fault))
    }
}

impl Machine {
    /// The machine of a name of [`PRESETS`]; `None` for another name.
    pub fn preset(name: &str) -> Option<Self> {
        let index = PRESETS.iter().position(|known| *known == name)?;
        parse(&format!("preset {name}"), TEXTS[index], &[], &MACHINE, machine).ok().map(|file| file.content)
    }

    /// Reads a machine file, or a preset where `path` is the name of one and no file; `set` are changes as after `--set`.
    ///
    /// # Errors
    /// [`ReadError`]: the file cannot be opened, or every fault found in it.
    pub fn read(path: &Path, set: &[String]) -> Result<FormFile<Self>, ReadError> {
        let name = path.to_string_lossy();
        match PRESETS.iter().position(|known| *known == name).filter(|_| !path.exists()) {
            Some(index) => parse(&format!("preset {name}"), TEXTS[index], set, &MACHINE, machine),
            None => read(path, set, &MACHINE, machine),
        }
    }

    /// The machine of a text, which is called `name` in messages; `set` are changes as after `--set`.
    ///
    /// # Errors
    /// [`ReadError`] with every fault found.
    pub fn of(name: &str, text: &str, set: &[String]) -> Result<FormFile<Self>, ReadError> {
        parse(name, text, set, &MACHINE, machine)
    }
}

fn machine(walk: &mut Walk, root: &Section<'_>) -> Option<Machine> {
    let mut machine = Machine::default();
    if let Some(section) = walk.table(root, "drives") {
        machine = preset(&section);
        drives(walk, &section, &mut machine.drives);
    }
    if let Some(section) = walk.table(root, "control") {
        control(walk, &section, &mut machine.control);
        let drives = &mut machine.drives;
        if let Some(word) = section.text("spindle_wait") {
            drives.spindle_block_wait = f64::from(u8::from(word == SPINDLE_WAITS[2]));
            drives.coolant_wait = f64::from(u8::from(word != SPINDLE_WAITS[1]));
        }
        if let Some(on) = section.flag("rapid_blend") {
            drives.rapid_blend = f64::from(u8::from(on));
        }
    }
    Some(machine)
}

/// The machine that `[drives]` begins with.
fn preset(section: &Section<'_>) -> Machine {
    section.text("preset").and_then(Machine::preset).unwrap_or_default()
}

/// Sets the fields of the drives that a section gives under other names.
fn fill(drives: &mut Drives, section: &Section<'_>, fields: &[(&str, &str)]) {
    for (key, field) in fields {
        if let (Some(index), Some(value)) = (Drives::<f64>::index_of(field), section.si(key)) {
            drives.set(index, value);
        }
    }
}

/// The greatest of three values, and the share of each.
fn shares(values: [f64; 3]) -> (f64, [f64; 3]) {
    let greatest = values.into_iter().fold(0.0, f64::max);
    (greatest, values.map(|value| value / greatest))
}

/// Sets the drives that a section of [`DRIVES`] gives; its preset comes first.
pub fn drives(walk: &mut Walk, section: &Section<'_>, drives: &mut Drives) {
    if section.given("preset") {
        *drives = preset(section).drives;
    }
    let axes = |section: &Section<'_>| ["X", "Y", "Z"].map(|axis| section.required(axis));
    if let Some(table) = walk.table(section, "rapid_speed") {
        let (speed, ratios) = shares(axes(&table));
        drives.rapid_speed = speed;
        [drives.rapid_ratio_x, drives.rapid_ratio_y, drives.rapid_ratio_z] = ratios;
        drives.rotary_rapid_speed = table.si("A").unwrap_or(drives.rotary_rapid_speed);
    } else if let Some(speed) = section.si("rapid_speed") {
        drives.rapid_speed = speed;
        [drives.rapid_ratio_x, drives.rapid_ratio_y, drives.rapid_ratio_z] = [1.0; 3];
    }
    let by_axis = walk.table(section, "acceleration").map(|table| axes(&table));
    if let Some(values) = by_axis.or_else(|| section.si("acceleration").map(|value| [value; 3])) {
        let (acceleration, ratios) = shares(values);
        drives.inverse_rapid_acceleration = 1.0 / acceleration;
        [drives.acceleration_ratio_x, drives.acceleration_ratio_y, drives.acceleration_ratio_z] = ratios;
        drives.inverse_acceleration = 1.0 / values.into_iter().fold(f64::INFINITY, f64::min);
    }
    if let Some(acceleration) = section.si("feed_acceleration") {
        drives.inverse_acceleration = 1.0 / acceleration;
    }
    fill_record(section, drives);
    if let Some(jerk) = section.si("jerk") {
        if drives.inverse_acceleration > 0.0 {
            drives.jerk_time = 1.0 / (drives.inverse_acceleration * jerk);
        } else {
            walk.fault(section.span_of("jerk"), MachineFault::Jerk);
        }
    }
    if section.given("look_ahead") {
        drives.look_ahead = f64::from(section.count32("look_ahead"));
    }
    if let Some(word) = section.text("rapid") {
        drives.independent_rapid = f64::from(u8::from(word == RAPID[1]));
    }
    if let Some(table) = walk.table(section, "corner") {
        let rule = table.text("rule");
        // The least step is a stop.
        drives.corner_step = if rule == Some(CORNER_RULES[2]) { STOP } else { 0.0 };
        drives.corner_cosine = f64::from(u8::from(rule == Some(CORNER_RULES[3])));
        let field = if rule == Some(CORNER_RULES[1]) { "corner_step" } else { "corner_deviation" };
        fill(drives, &table, &[("value", field)]);
    }
    if let Some(table) = walk.table(section, "settling") {
        fill(drives, &table, SETTLING_FIELDS);
    }
    if let Some(table) = walk.table(section, "spindle") {
        fill(drives, &table, SPINDLE_FIELDS);
        if let Some(word) = table.text("waits") {
            drives.spindle_block_wait = f64::from(u8::from(word == WAITS[1]));
        }
        if let Some(on) = table.flag("stop_waits") {
            drives.stop_wait = f64::from(u8::from(on));
        }
        if let Some(braking) = walk.table(&table, "braking") {
            fill(drives, &braking, BRAKING_FIELDS);
        }
    }
    if let Some(table) = walk.table(section, "changer") {
        fill(drives, &table, CHANGER_FIELDS);
        if table.text("kind") == Some(CHANGERS[0]) {
            drives.index_time = 0.0;
        }
    }
}

fn control(walk: &mut Walk, section: &Section<'_>, control: &mut Control) {
    let mut set = |walk: &mut Walk, key: &str, name: &str, value: &str| {
        if let Err(reason) = control.set(name, value) {
            walk.fault(section.span_of(key), MachineFault::Control(reason));
        }
    };
    for key in ["units", "decimal", "pecks", "rotary_feed", "feed_at", "turns", "startup"] {
        if let Some(word) = section.text(key) {
            set(walk, key, key, word);
        }
    }
    if let Some(clearance) = section.si("peck_clearance") {
        set(walk, "peck_clearance", "peck_clearance", &format!("{} mm", 1e3 * clearance));
    }
    let tables = [("m", "{ 29 = \"0.3 s\" }"), ("g", "{ 411 = \"0 s\" }"), ("offset", "{ G55 = \"100,0,0 mm\" }")];
    for (table, example) in tables {
        for (name, value) in walk.texts(section, table, example) {
            set(walk, table, &format!("{table}.{name}"), &value);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn machine_of(text: &str) -> Result<Machine, String> {
        parse("m.toml", text, &[], &MACHINE, machine).map(|file| file.content).map_err(|error| error.to_string())
    }

    #[test]
    fn every_preset_is_read() {
        for (index, name) in PRESETS.iter().enumerate() {
            let file = parse(name, TEXTS[index], &[], &MACHINE, machine).map_err(|error| error.to_string());
            let drives = file.expect("a preset").content.drives;
            assert!(drives.check().is_ok(), "{name}");
            assert!(drives.inverse_acceleration > 0.0 && drives.spindle_constant > 0.0, "{name}");
        }
    }

    #[test]
    fn axes_have_speeds_and_accelerations_of_their_own() {
        let text = "[drives]\nrapid_speed = { X = \"30 m/min\", Y = \"30 m/min\", Z = \"24 m/min\" }\n\
                    acceleration = { X = \"3 m/s2\", Y = \"2 m/s2\", Z = \"1.5 m/s2\" }\nfeed_acceleration = \"0.5 m/s2\"\n\
                    jerk = \"10 m/s3\"\n[control.m]\n29 = \"0.3 s\"\n";
        let machine = machine_of(text).expect("a machine");
        assert_eq!(machine.drives.rapid_speed, 0.5);
        assert!((machine.drives.rapid_ratio_z - 0.8).abs() < 1e-12);
        assert!((machine.drives.acceleration_ratio_y - 2.0 / 3.0).abs() < 1e-12);
        assert!((machine.drives.jerk_time - 0.05).abs() < 1e-12);
        assert_eq!(machine.control.m[&29], 0.3);
    }

    #[test]
    fn a_preset_is_the_ground_for_what_a_file_gives() {
        let machine = machine_of("[drives]\npreset = \"hurco-winmax\"\n[drives.changer]\nchange_time = \"4 s\"\n")
            .expect("a machine");
        let preset = Machine::preset("hurco-winmax").expect("a preset");
        assert_eq!(machine.drives, Drives { tool_change_time: 4.0, ..preset.drives });
    }

    #[test]
    fn slips_are_told_with_their_place() {
        for (text, word) in [
            ("[drives]\njerk = \"10 m/s3\"\n", "m.toml:2:8"),
            ("[drives]\npreset = \"hurco\"\n", "hurco-winmax"),
            ("[control.m]\nx = \"1 s\"\n", "m.toml"),
            ("[drives]\ncorner = { rule = \"sine\" }\n", "deviation"),
            ("[drives.spindle]\nconstant = \"1 s\"\n", "s/rpm2"),
        ] {
            let error = machine_of(text).expect_err(text);
            assert!(error.contains(word), "{text}: {error}");
        }
    }
}
