//! Changes of inputs, states and parameters as text, the advance, and every value read.

use super::{Point, PointError, PointOptions};
use crate::change::{ChangeError, assign, parts};
use serde_json::{Value, json};
use toolroom_process::{AnyRecord, Process, Record, unit};

/// Applies every change to input, state or parameters, advances, and reads everything.
pub fn evaluate<P: Process>(
    process: &mut P,
    mut input: P::Input,
    options: &PointOptions,
) -> Result<(Point, P::Input, P::State), PointError> {
    let changes = options.changes.iter().map(|text| parts(text)).collect::<Result<Vec<_>, _>>()?;
    // Parameters first: the initial state may depend on them.
    for (key, value) in &changes {
        if let Some((group, name)) = key.split_once('.') {
            let mut groups = process.parameters_mut();
            let known = groups.iter().map(|(name, _)| *name).collect();
            let Some((_, record)) = groups.iter_mut().find(|(each, _)| *each == group) else {
                return Err(PointError::NoGroup { group: group.to_owned(), known });
            };
            if !assigned(*record, name, value)? {
                let known = record.fields().iter().map(|field| field.name).collect();
                return Err(PointError::NoParameter { group: group.to_owned(), name: name.to_owned(), known });
            }
        }
    }
    let mut state = process.initial();
    for (key, value) in changes.iter().filter(|(key, _)| !key.contains('.')) {
        if !assigned(&mut input, key, value)? && !assigned(&mut state, key, value)? {
            let known = P::Input::FIELDS.iter().chain(P::State::FIELDS).map(|field| field.name).collect();
            return Err(PointError::NoValue { process: P::NAME, key: (*key).to_owned(), known });
        }
    }
    let mut event = None;
    if let Some(time) = &options.advance {
        let time = unit::quantity(time, "s").map_err(PointError::AdvanceTime)?;
        let advance = process.advance(&mut state, &input, time).map_err(PointError::Advance)?;
        input = process.input_after(&input, advance.elapsed);
        event = advance.event;
    }
    let output = process.output(&state, &input);
    let point =
        Point { process: P::NAME, inputs: values(&input), state: values(&state), outputs: values(&output), event };
    Ok((point, input, state))
}

/// Sets `name` of a record from text; false where the record has no such scalar.
fn assigned(record: &mut dyn AnyRecord, name: &str, text: &str) -> Result<bool, ChangeError> {
    match assign(record, name, text) {
        Ok(()) => Ok(true),
        Err(ChangeError::NoField { .. }) => Ok(false),
        Err(error) => Err(error),
    }
}

/// Values of a record by header, in the units of display.
pub fn values(record: &dyn AnyRecord) -> Vec<(String, Value)> {
    let mut values = Vec::new();
    let mut index = 0;
    for field in record.fields() {
        let elements: Vec<Value> = (index..index + field.len)
            .filter_map(|i| record.value(i))
            .map(|value| json!(field.to_display(value)))
            .collect();
        index += field.len;
        let value = if field.len == 1 { elements.into_iter().next().unwrap_or(Value::Null) } else { json!(elements) };
        values.push((field.header(), value));
    }
    values
}
