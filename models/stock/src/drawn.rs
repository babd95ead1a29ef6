//! What a contour file or a drawing outlines: a stock that is no box, and the part that should be left.

use crate::gouge::Part;
use crate::profile::Profile;
use std::sync::Arc;
use toolroom_contour::{ContourFile, read_dxf_outline};
use toolroom_form::{Fault, Form, Key, Kind, Section, Walk};
use toolroom_program::Units;

pub(crate) const CONTOUR: Key = Key::optional(
    "contour",
    Kind::Text,
    "Contour file whose closed contour is its outline, from the folder of this file",
);
pub(crate) const DXF: Key = Key::optional(
    "dxf",
    Kind::Text,
    "DXF file that draws its outline as one closed contour, from the folder of this file",
);
pub(crate) const LAYER: Key =
    Key::optional("layer", Kind::Text, "Layer of the drawing; left out where it is one contour");
pub(crate) const UNIT: Key = Key::optional("units", Kind::Choice(&Units::NAMES), "Unit of a drawing that names none");

/// The part that should be left.
pub(crate) static PART: Form = Form {
    title: "[finished_part]",
    doc: "The part that should be left, in the coordinates of the program: motions that cut into it are reported",
    keys: &[
        CONTOUR,
        DXF,
        LAYER,
        UNIT,
        Key::default(
            "pocket",
            Kind::Flag,
            "false",
            "Whether the outline is that of a pocket, around which the part lies",
        ),
        Key::required("top", Kind::quantity("m", "mm", -100.0, 100.0, "0 mm"), "Height of its upper face"),
    ],
};

/// The part of a setup; `None` where a problem was noted.
pub(crate) fn part(walk: &mut Walk, section: &Section<'_>) -> Option<Part> {
    let kind = match (section.given("contour"), section.given("dxf")) {
        (true, false) => "contour",
        (false, true) => "dxf",
        (true, true) | (false, false) => {
            let [key, read, expected, example] =
                ["contour", "both or neither", "one of contour and dxf", "\"part.toml\""].map(str::to_owned);
            walk.fault(section.span_of("dxf"), Fault::WrongType { key, read, expected, example });
            return None;
        }
    };
    not_of_contour(walk, section, kind);
    let outline = Arc::new(Profile::new(&outline(walk, section, kind)?, 0.0));
    Some(Part { outline, pocket: section.flag("pocket")?, top: section.si("top")? })
}

/// Refuses what only a drawing has beside a contour file.
pub(crate) fn not_of_contour(walk: &mut Walk, section: &Section<'_>, kind: &str) {
    for key in ["layer", "units"].into_iter().filter(|key| kind != "dxf" && section.given(key)) {
        let (case, applicable) = (format!("{} with `{kind}`", section.form.title), "`dxf`".to_owned());
        walk.fault(section.span_of(key), Fault::NotApplicable { key, case, applicable });
    }
}

/// The sections of the closed contour in the file that the key `kind` names, `contour` or `dxf`; `None` where a problem was noted.
pub(crate) fn outline(walk: &mut Walk, section: &Section<'_>, kind: &str) -> Option<Vec<toolroom_contour::Section>> {
    let file = section.text(kind)?;
    let text = walk.file(section, kind, file)?;
    let found = if kind == "dxf" {
        let unit = section.text("units").and_then(Units::named).map(|units| 1e-3 * units.scale());
        read_dxf_outline(&text, section.text("layer"), unit).map_err(|error| format!("{file}:{error}"))
    } else {
        match ContourFile::parse(file, &text, &[]) {
            Ok(read) if read.content.contour.closed => Ok(read.content.contour.sections),
            Ok(_) => Err(format!(
                "{file}: the contour is open, and an outline is a closed one: close it, or name another file"
            )),
            Err(error) => Err(error.to_string()),
        }
    };
    found.map_err(|reason| walk.fault(section.span_of(kind), Fault::Table { reason })).ok()
}
