//! Coefficient files: cutting-force coefficients of milling in a file of their own, with how well they are known.

use super::keys::{EDGE_EITHER, PRESSURE, PRESSURE_EITHER};
use std::path::Path;
use toolroom_form::{ContentFault, Fault, Form, FormFile, Key, Kind, ReadError, Section, Walk};

/// The whole file.
pub static COEFFICIENTS: Form = Form {
    title: "the coefficient file",
    doc: "Cutting-force coefficients, for `coefficients` of lobes files; `toolroom coefficients` writes them",
    keys: &[
        Key::required("schema", Kind::Count { min: 1, max: u64::MAX }, "Version of the format, 1"),
        Key::required("name", Kind::Name, "Short name"),
        Key::default("material", Kind::Text, "", "Work material, tool and coolant"),
        Key::default("source", Kind::Text, "", "Where the values come from: test and command, or table"),
        Key::required("tangential", Kind::Table(&CHIP), "Tangential coefficient of the chip"),
        Key::required("radial", Kind::Table(&CHIP_EITHER), "Radial coefficient of the chip"),
        Key::optional("axial", Kind::Table(&CHIP_EITHER), "Axial coefficient of the chip"),
        Key::optional("edge_tangential", Kind::Table(&EDGE), "Tangential force of the edge per depth"),
        Key::optional("edge_radial", Kind::Table(&EDGE), "Radial force of the edge per depth"),
        Key::optional("edge_axial", Kind::Table(&EDGE), "Axial force of the edge per depth"),
        Key::optional(
            "feed_per_tooth",
            Kind::List(&Kind::positive("m", "mm", 0.1, "0.1 mm/tooth")),
            "Least and greatest feed per tooth that they hold for",
        ),
    ],
};

static CHIP: Form = Form {
    title: "a coefficient",
    doc: "A coefficient with its standard deviation",
    keys: &[
        Key::required("value", PRESSURE, "The value"),
        Key::default("sd", DEVIATION, "0 MPa", "Its standard deviation"),
    ],
};

static CHIP_EITHER: Form = Form {
    title: "a coefficient",
    doc: "A coefficient with its standard deviation",
    keys: &[
        Key::required("value", PRESSURE_EITHER, "The value"),
        Key::default("sd", DEVIATION, "0 MPa", "Its standard deviation"),
    ],
};

static EDGE: Form = Form {
    title: "an edge force",
    doc: "A force of the edge per depth with its standard deviation",
    keys: &[
        Key::required("value", EDGE_EITHER, "The value"),
        Key::default("sd", Kind::quantity("N/m", "N/mm", 0.0, 1e9, "1 N/mm"), "0 N/mm", "Its standard deviation"),
    ],
};

const DEVIATION: Kind = Kind::quantity("Pa", "MPa", 0.0, 1e12, "15 MPa");

/// What a coefficient file says.
#[derive(Clone, Debug, PartialEq)]
pub struct CoefficientFile {
    /// Short name.
    pub name: String,
    /// Tangential and radial coefficient of the chip (Pa).
    pub chip: [f64; 2],
    /// Tangential and radial force of the edge per depth (N/m); zero where the file has none.
    pub edge: [f64; 2],
    /// Relative standard deviation of the resultant of both coefficients of the chip.
    pub deviation: f64,
}

/// Reads a coefficient file; `overrides` are `path=value` as after `--set`.
///
/// # Errors
/// As [`file::read`](toolroom_form::read).
pub fn read_coefficients(path: &Path, overrides: &[String]) -> Result<FormFile<CoefficientFile>, ReadError> {
    toolroom_form::read(path, overrides, &COEFFICIENTS, resolve)
}

fn resolve(walk: &mut Walk, root: &Section<'_>) -> Option<CoefficientFile> {
    let mut value = |key: &str| {
        let table = walk.table(root, key)?;
        Some([table.si("value")?, table.si("sd")?])
    };
    let (tangential, radial) = (value("tangential"), value("radial"));
    let [edge_tangential, edge_radial] =
        ["edge_tangential", "edge_radial"].map(|key| value(key).map_or(0.0, |[value, _]| value));
    // Read for their faults.
    for key in ["axial", "edge_axial"] {
        value(key);
    }
    let name = root.text("name")?.to_owned();
    let ([t, t_sd], [r, r_sd]) = (tangential?, radial?);
    let size = t.hypot(r);
    let deviation = (t * t_sd / size).hypot(r * r_sd / size) / size;
    // An edge does not pull the cutter around: a small negative estimate is none.
    Some(CoefficientFile { name, chip: [t, r], edge: [edge_tangential.max(0.0), edge_radial], deviation })
}

/// The coefficient file that a section of a lobes file names.
pub(super) fn named(walk: &mut Walk, section: &Section<'_>) -> Option<CoefficientFile> {
    let name = section.text("coefficients")?.to_owned();
    let path = walk.folder.join(&name);
    walk.named(path.clone());
    match read_coefficients(&path, &[]) {
        Ok(file) => Some(file.content),
        Err(error) => {
            let fault = CoefficientFault { file: path.display().to_string(), reason: error.to_string() };
            walk.fault(section.span_of("coefficients"), Fault::Content(std::sync::Arc::new(fault)));
            None
        }
    }
}

/// A value of a section, or that of its coefficient file; both or none of them is a fault.
pub(super) fn value(
    walk: &mut Walk,
    section: &Section<'_>,
    key: &'static str,
    example: &str,
    file: Option<f64>,
) -> Option<f64> {
    match (section.given(key), section.given("coefficients")) {
        (true, false) => section.si(key),
        (false, true) => file,
        (true, true) => {
            let fault = Fault::Contradiction {
                first: "coefficients",
                first_value: section.text("coefficients").unwrap_or_default().to_owned(),
                second: key,
                second_value: section.si(key).map_or_else(String::new, toolroom_form::significant),
                rule: "the coefficients stand in one of the two places",
            };
            walk.fault(section.span_of(key), fault);
            None
        }
        (false, false) => {
            let title = section.form.title.to_owned();
            walk.fault(section.span_of(""), Fault::MissingKey { section: title, key, example: example.to_owned() });
            None
        }
    }
}

/// A coefficient file that could not be read.
#[derive(Clone, Debug, thiserror::Error)]
#[error("coefficients \"{file}\": {reason}")]
struct CoefficientFault {
    /// The file.
    file: String,
    /// What is wrong.
    reason: String,
}

impl ContentFault for CoefficientFault {
    fn code(&self) -> &'static str {
        "coefficients"
    }

    fn fix(&self) -> Option<String> {
        Some(format!(
            "give a file of `toolroom coefficients`; `toolroom check {}` tells its faults line by line",
            self.file
        ))
    }
}
