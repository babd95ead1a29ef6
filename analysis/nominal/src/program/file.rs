//! Sections of a file that describe a machine and its part programs.

use super::ProgramModel;
use std::path::Path;
use std::sync::Arc;
use toolroom_drives::{DRIVES, drives};
use toolroom_form::{ContentFault, Fault, Form, Key, Kind, Section, Walk};
use toolroom_process::Record;
use toolroom_program::{Control, Program, ProgramError, Units};
use toolroom_scenario::effects::ShopDeviations;
use toolroom_scenario_file::GAP;

/// An effect by its key; a file that does not say has none of it.
const fn effect(name: &str, none: &'static str) -> Key {
    Key::of_named(ShopDeviations::<f64>::FIELDS, name).by_default(none)
}

static EFFECTS: Form = Form {
    title: "[effects]",
    doc: "Effects that are switched on",
    keys: &[
        effect("feed_override", "0"),
        effect("feed_hold", "0 s").called("feed_hold", "Time of a mean hold; holds count as long as logged"),
        effect("feed_hold", "0 s").called("feed_hold_each", "Time of every hold, however long it was logged"),
        effect("axis_acceleration", "0 s2/m"),
        effect("canned_cycle_dwell", "0 s"),
        effect("tool_change_delay", "0 s"),
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
        drives(walk, &section, &mut model.drives);
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
        let text = toolroom_form::bytes(&path).map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
        match text.or_else(|error| shipped().map(str::to_owned).ok_or(error)) {
            Ok(text) => {
                let control = Control::of_file(&path, section.text("units").and_then(Units::named));
                match Program::read(&text, &control) {
                    Ok(program) => model.programs.push((name.to_owned(), program)),
                    Err(reason) => walk.fault(span, PartProgramFault { file, reason }),
                }
            }
            Err(error) => walk.fault(span, Fault::Unreadable { file, reason: error.kind() }),
        }
    }
    model
}

/// Sets the fields of a record that `form` has as keys.
fn fill<R: Record>(record: &mut R, section: &Section<'_>, form: &Form) {
    for key in form.keys {
        if let (Some(index), Some(value)) = (R::index_of(key.name), section.si(key.name)) {
            record.set(index, value);
        }
    }
}
