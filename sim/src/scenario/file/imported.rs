//! Tools whose process is an imported unit.

use super::fault::Fault;
use super::walk::{Section, Value, Walk};
use crate::scenario::ProcessModel;
use crate::scenario::unit::{UnitRequest, import};
use std::collections::BTreeMap;
use toml::de::DeValue;
use toolroom_cutting::{MillingInput, MillingOutput, TurningInput, TurningOutput};
use toolroom_process::{Field, Record, Wiring};

/// The unit in `file` as the process of a tool; `None` where a problem was noted.
pub(super) fn process(walk: &mut Walk, tool: &Section<'_>, process: &str, file: &str) -> Option<ProcessModel> {
    for key in ["parameter_set", "parameters", "effects", "structure", "structure_scatter"] {
        if tool.given(key) {
            let rule = "a unit brings its own parameters and effects; set them in wiring.start";
            walk.fault(tool.span_of(key), Fault::Beside { key, beside: "fmu", rule });
        }
    }
    let wiring = wiring(walk, tool);
    let (process, inputs, outputs): (&'static str, &'static [Field], &'static [Field]) = match process {
        "turning" => ("turning", TurningInput::FIELDS, TurningOutput::FIELDS),
        "milling" => ("milling", MillingInput::FIELDS, MillingOutput::FIELDS),
        _ => return None, // the key does not apply, which is noted
    };
    let path = walk.folder.join(file);
    walk.files.push(path.clone());
    match import(&UnitRequest { path: &path, process, inputs, outputs, wiring: &wiring }) {
        Ok(unit) => Some(ProcessModel::Other(unit)),
        Err(reason) => {
            walk.fault(tool.span_of("fmu"), Fault::Unit { file: file.to_owned(), reason });
            None
        }
    }
}

fn wiring(walk: &mut Walk, tool: &Section<'_>) -> Wiring {
    let Some(section) = walk.table(tool, "wiring") else { return Wiring::default() };
    Wiring {
        inputs: texts(walk, &section, "inputs"),
        outputs: texts(walk, &section, "outputs"),
        events: texts(walk, &section, "events"),
        start: texts(walk, &section, "start"),
        step: section.si("step"),
    }
}

/// A table of names and texts; numbers and truth values may stand without quotes.
fn texts(walk: &mut Walk, section: &Section<'_>, key: &'static str) -> BTreeMap<String, String> {
    let mut texts = BTreeMap::new();
    let Some(got) = section.got(key) else { return texts };
    let example = "{ cutting_speed = \"vc [m/min]\" }";
    let Value::Raw(DeValue::Table(table)) = &got.value else {
        if let Value::Raw(other) = &got.value {
            walk.wrong_type(key, other, "a table of names and texts", got.span.clone(), example.to_owned());
        }
        return texts;
    };
    for (name, value) in table {
        let text = match value.get_ref() {
            DeValue::String(text) => text.to_string(),
            DeValue::Integer(integer) => integer.as_str().to_owned(),
            DeValue::Float(float) => float.as_str().to_owned(),
            DeValue::Boolean(flag) => flag.to_string(),
            other => {
                walk.wrong_type(
                    name.get_ref(),
                    other,
                    "a text, a number or a truth value",
                    value.span(),
                    "\"…\"".to_owned(),
                );
                continue;
            }
        };
        texts.insert(name.get_ref().to_string(), text);
    }
    texts
}
