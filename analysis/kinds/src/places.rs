//! Places of what only a model finds wrong in a file whose form is right.

use std::path::Path;
use toolroom_form::{FaultList, ReadError, Refusal, key_place};
use toolroom_nominal::ModelFileError;
use toolroom_process::ModelError;
use toolroom_wear::SetError;

/// A file that is refused at a line and column, from 1.
pub fn refused(path: &Path, text: &str, place: (usize, usize), refusal: Refusal) -> ReadError {
    ReadError::Faults(Box::new(FaultList::refused(&path.display().to_string(), text, [(place, refusal)])))
}

/// Line and column of a field of JSON, from 1.
pub fn key(text: &str, field: &str) -> (usize, usize) {
    let name = format!("\"{field}\"");
    let line = text.lines().position(|line| line.trim_start().starts_with(&name));
    line.map_or((1, 1), |line| (line + 1, 1))
}

/// The header of the table `name` with this index among those of its name; the start of the text where there is none.
pub fn header(text: &str, name: &str, index: usize) -> (usize, usize) {
    let header = format!("[[{name}]]");
    let mut lines = text.lines().enumerate().filter(|(_, line)| line.trim_start().starts_with(&header));
    lines.nth(index).map_or((1, 1), |(line, _)| (line + 1, 1))
}

/// The value of a parameter set that its model refuses: the later one of two that contradict each other.
pub fn parameter(text: &str, error: &SetError) -> (usize, usize) {
    let SetError::Model(ModelError::OutOfRange { field: name, .. } | ModelError::Contradiction { second: name, .. }) =
        error
    else {
        return (1, 1);
    };
    key_place(text, "parameters", name)
}

/// What a nominal model is refused for: a sensor at its channel, a process without tool at the first tool.
pub fn nominal(path: &Path, error: ModelFileError) -> ReadError {
    if let ModelFileError::Read(error) = error {
        return error;
    }
    // The file was read before.
    let text = toolroom_form::text(path).unwrap_or_default();
    let (place, code) = if let ModelFileError::Sensor { channel, .. } = &error {
        let line = text.lines().position(|line| line.contains("channel") && line.contains(channel.as_str()));
        (line.map_or((1, 1), |line| (line + 1, 1)), "quantity")
    } else {
        (header(&text, "tool", 0), "missing-key")
    };
    refused(path, &text, place, Refusal::new(code, error))
}
