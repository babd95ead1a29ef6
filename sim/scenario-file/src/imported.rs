//! Tools whose process is an imported unit.

use super::choices::{IsolationWord, ProcessKind};
use super::fault::ScenarioFault;
use toolroom_cutting::{MillingInput, MillingOutput, TurningInput, TurningOutput};
use toolroom_form::{Fault, Section, Walk};
use toolroom_process::{Field, Record, UnitIsolation, Wiring};
use toolroom_scenario::{ProcessModel, UnitRefusal, UnitRequest, import_unit};

/// The unit in `file` as the process of a tool; `None` where a problem was noted.
pub(super) fn process(walk: &mut Walk, tool: &Section<'_>, process: ProcessKind, file: &str) -> Option<ProcessModel> {
    for key in ["parameter_set", "parameters", "handbook", "effects", "structure", "structure_scatter"] {
        if tool.given(key) {
            let rule = "a unit brings its own parameters and effects; set them in wiring.start";
            walk.fault(tool.span_of(key), Fault::Beside { key, beside: "fmu", rule });
        }
    }
    let wiring = wiring(walk, tool);
    let (inputs, outputs): (&'static [Field], &'static [Field]) = match process {
        ProcessKind::Turning => (TurningInput::FIELDS, TurningOutput::FIELDS),
        ProcessKind::Milling => (MillingInput::FIELDS, MillingOutput::FIELDS),
        ProcessKind::Infeed => return None, // the key does not apply, which is noted
    };
    let process = process.word();
    let path = walk.folder.join(file);
    walk.files.push(path.clone());
    match import_unit(&UnitRequest { path: &path, process, inputs, outputs, wiring: &wiring }) {
        Ok(unit) => Some(ProcessModel::Other(unit)),
        Err(UnitRefusal { reason, fix }) => {
            walk.fault(tool.span_of("fmu"), ScenarioFault::Unit { file: file.to_owned(), reason, fix });
            None
        }
    }
}

/// A table of variables, for messages.
const EXAMPLE: &str = "{ cutting_speed = \"vc [m/min]\" }";

fn wiring(walk: &mut Walk, tool: &Section<'_>) -> Wiring {
    let Some(section) = walk.table(tool, "wiring") else { return Wiring::default() };
    Wiring {
        inputs: walk.texts(&section, "inputs", EXAMPLE),
        outputs: walk.texts(&section, "outputs", EXAMPLE),
        events: walk.texts(&section, "events", EXAMPLE),
        start: walk.texts(&section, "start", EXAMPLE),
        step: section.si("step"),
        isolation: match section.chosen("isolation", IsolationWord::from_word) {
            Some(IsolationWord::None) => UnitIsolation::None,
            Some(IsolationWord::Process) | None => UnitIsolation::Process,
        },
        call_limit: section.si("call_limit"),
    }
}
