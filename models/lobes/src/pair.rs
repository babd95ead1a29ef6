//! Pairs of numbers in lobes and structure files: a range, the direction of a mode.

use toolroom_form::{Fault, Section, Walk};

/// The direction of a mode, which has a length.
pub(super) fn direction(walk: &mut Walk, section: &Section<'_>) -> Option<[f64; 2]> {
    let direction = pair(walk, section, "direction", "two components")?;
    if direction == [0.0, 0.0] {
        let fault = Fault::OutOfRange {
            key: "direction".to_owned(),
            read: "[0, 0]".to_owned(),
            range: "all directions, which have a length".to_owned(),
            meant: Vec::new(),
        };
        walk.fault(section.span_of("direction"), fault);
    }
    Some(direction)
}

/// A list of two numbers; `None` with or after a fault.
pub(super) fn pair(walk: &mut Walk, section: &Section<'_>, key: &str, expected: &str) -> Option<[f64; 2]> {
    let values = section.numbers(key)?;
    let count = values.len();
    if let Ok(pair) = <[f64; 2]>::try_from(values) {
        return Some(pair);
    }
    let fault = Fault::WrongType {
        key: key.to_owned(),
        read: format!("a list of {count}"),
        expected: expected.to_owned(),
        example: "[…, …]".to_owned(),
    };
    walk.fault(section.span_of(key), fault);
    None
}
