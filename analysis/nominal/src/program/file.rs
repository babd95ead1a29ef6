//! Sections of a file that describe a machine and its part programs.

use super::ProgramModel;
use std::path::Path;
use std::sync::Arc;
use toolroom_form::{ContentFault, Fault, Form, Key, Kind, Quantity, Section, Walk};
use toolroom_process::Record;
use toolroom_program::{Control, Program, ProgramError, Units};
use toolroom_scenario::file::GAP;

const fn quantity(unit: &'static str, display: &'static str, max: f64, example: &'static str) -> Kind {
    Kind::Quantity(Quantity { unit, display, min: 0.0, max, above: false, example })
}

/// Drives by key: SI unit, and the value where a file does not say.
pub const DEFAULT_DRIVES: [(&str, &str, f64); 3] =
    [("rapid_speed", "m/s", 0.5), ("corner_deviation", "m", 10e-6), ("jerk_time", "s", 0.0)];

static DRIVES: Form = Form {
    title: "[drives]",
    doc: "Feed drives and tool changer",
    keys: &[
        Key::default("rapid_speed", quantity("m/s", "m/min", 10.0, "30 m/min"), "30 m/min", "Rapid speed of each axis"),
        Key::default(
            "tool_change_time",
            quantity("s", "s", 3600.0, "4 s"),
            "0 s",
            "Time of a tool change by the sheet",
        ),
        Key::default(
            "corner_deviation",
            quantity("m", "um", 1e-3, "10 um"),
            "10 um",
            "Distance by which corners may be rounded",
        ),
        Key::default("jerk_time", quantity("s", "s", 1.0, "0.01 s"), "0 s", "Time in which the acceleration builds up"),
    ],
};

static EFFECTS: Form = Form {
    title: "[effects]",
    doc: "Effects that are switched on",
    keys: &[
        Key::default("feed_override", quantity("1", "1", 10.0, "1"), "0", "Share of the logged override that acts"),
        Key::default(
            "feed_hold",
            quantity("s", "s", 3600.0, "10 s"),
            "0 s",
            "Time of a mean hold; holds count as long as logged",
        ),
        Key::default(
            "feed_hold_each",
            quantity("s", "s", 3600.0, "10 s"),
            "0 s",
            "Time of every hold, however long it was logged",
        ),
        Key::default(
            "axis_acceleration",
            quantity("s2/m", "s2/m", 100.0, "0.5 s2/m"),
            "0 s2/m",
            "Inverse of the acceleration",
        ),
        Key::default("canned_cycle_dwell", quantity("s", "s", 60.0, "1 s"), "0 s", "Time per hole"),
        Key::default(
            "tool_change_delay",
            quantity("s", "s", 3600.0, "10 s"),
            "0 s",
            "Time per tool change beside that of the sheet",
        ),
    ],
};

static PROGRAM: Form = Form {
    title: "[[program]]",
    doc: "A part program",
    keys: &[
        Key::required("name", Kind::Name, "Name under which its runs are recorded"),
        Key::required("file", Kind::Text, "G-code, from the directory of this file"),
        Key::optional("units", Kind::Choice(&Units::NAMES), "Unit of a program without G20 or G21"),
    ],
};

/// A part program with a fault of its own.
#[derive(Debug, thiserror::Error)]
#[error("{file}:{reason}")]
struct PartProgramFault {
    /// The file as written.
    file: String,
    /// The fault with its place in that file.
    reason: ProgramError,
}

/// The code of a part program at fault, with its explanation.
pub const CODES: &[(&str, &str)] = &[(
    "part-program",
    "A part program named in the file has a block whose time cannot be told: a subprogram, a variable, a motion at feed without F, an arc that misses its end. `toolroom program` reads it by itself.",
)];

impl ContentFault for PartProgramFault {
    fn code(&self) -> &'static str {
        CODES[0].0
    }
}

impl From<PartProgramFault> for Fault {
    fn from(fault: PartProgramFault) -> Self {
        Self::Content(Arc::new(fault))
    }
}

/// Shipped part programs, found where the directory of the file has none of the name.
const SHIPPED: [(&str, &str); 3] = [
    ("programs/bracket.nc", include_str!("../../../../scenarios/gap/programs/bracket.nc")),
    ("programs/plate.nc", include_str!("../../../../scenarios/gap/programs/plate.nc")),
    ("programs/pocket.nc", include_str!("../../../../scenarios/gap/programs/pocket.nc")),
];

/// The form of a file that describes part programs.
pub static FORM: Form = Form {
    title: "the nominal model",
    doc: "A machine and its part programs",
    keys: &[
        Key::required("schema", Kind::Count { min: 1, max: u64::MAX }, "Version of the format, 1"),
        Key::required("gap", Kind::Table(&GAP), "Priors and sensors"),
        Key::optional("drives", Kind::Table(&DRIVES), "Feed drives and tool changer"),
        Key::optional("effects", Kind::Table(&EFFECTS), "Effects that are switched on"),
        Key::optional("program", Kind::Tables(&PROGRAM), "Part programs"),
    ],
};

/// The model of a file in `directory`; programs that cannot be read are faults of it.
pub fn section(walk: &mut Walk, root: &Section<'_>, directory: &Path) -> ProgramModel {
    let mut model = ProgramModel::default();
    if let Some(section) = walk.table(root, "drives") {
        fill(&mut model.drives, &section, &DRIVES);
    }
    if let Some(section) = walk.table(root, "effects") {
        fill(&mut model.effects, &section, &EFFECTS);
        model.hold_each = section.required("feed_hold_each");
    }
    for section in walk.sections(root, "program", None) {
        let (Some(name), Some(file)) = (section.text("name"), section.text("file")) else { continue };
        let path = directory.join(file);
        let span = section.span_of("file");
        let file = path.display().to_string();
        let shipped = || SHIPPED.iter().find(|(known, _)| section.text("file") == Some(known)).map(|(_, text)| *text);
        let text = std::fs::read(&path).map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
        match text.or_else(|error| shipped().map(str::to_owned).ok_or(error)) {
            Ok(text) => match Program::read(&text, &control(&path, section.text("units"))) {
                Ok(program) => model.programs.push((name.to_owned(), program)),
                Err(reason) => walk.fault(span, PartProgramFault { file, reason }),
            },
            Err(error) => walk.fault(span, Fault::Unreadable { file, reason: error.kind() }),
        }
    }
    model
}

/// The control of a program in a file: its subprograms stand beside it.
fn control(path: &Path, units: Option<&str>) -> Control {
    Control {
        units: units.and_then(Units::named),
        extension: path.extension().map(|extension| extension.to_string_lossy().into_owned()),
        library: path.parent().map(Path::to_path_buf),
        ..Control::default()
    }
}

/// Sets the fields of a record that `form` has as keys.
fn fill<R: Record>(record: &mut R, section: &Section<'_>, form: &Form) {
    for key in form.keys {
        if let (Some(index), Some(value)) = (R::index_of(key.name), section.si(key.name)) {
            record.set(index, value);
        }
    }
}
