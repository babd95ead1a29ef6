//! Changes of inputs, states and parameters as text, the advance, and every value read.

use super::{Point, PointError, PointOptions};
use crate::change::{ChangeError, assign, parts};
use serde_json::{Value, json};
use toolroom_process::{AnyRecord, Process, ProcessEvent, Record, unit, watched};

/// Applies every change to input, state or parameters, advances, and reads everything.
pub fn evaluate<P: Process>(
    process: &mut P,
    input: P::Input,
    options: &PointOptions,
) -> Result<(Point, P::Input, P::State), PointError> {
    let changes = options.changes.iter().map(|text| parts(text)).collect::<Result<Vec<_>, _>>()?;
    set_parameters(process, &changes)?;
    let (mut input, mut state) = (input, process.initial());
    set_values::<P>(&mut input, &mut state, &changes)?;
    let event = advance(process, &mut input, &mut state, options)?;
    let output = watched(|| process.output(&state, &input)).map_err(PointError::Value)?;
    let point =
        Point { process: P::NAME, inputs: values(&input), state: values(&state), outputs: values(&output), event };
    Ok((point, input, state))
}

/// Applies changes `group.name` of parameters; they come first, since the initial state may depend on them.
pub fn set_parameters<P: Process>(process: &mut P, changes: &[(&str, &str)]) -> Result<(), PointError> {
    for (key, value) in changes {
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
    Ok(())
}

/// Applies changes of inputs and states.
pub fn set_values<P: Process>(
    input: &mut P::Input,
    state: &mut P::State,
    changes: &[(&str, &str)],
) -> Result<(), PointError> {
    for (key, value) in changes.iter().filter(|(key, _)| !key.contains('.')) {
        if !assigned(input, key, value)? && !assigned(state, key, value)? {
            return Err(no_value::<P>(key));
        }
    }
    Ok(())
}

/// A key that is neither an input nor a state of the process.
pub fn no_value<P: Process>(key: &str) -> PointError {
    let known = P::Input::FIELDS.iter().chain(P::State::FIELDS).map(|field| field.name).collect();
    PointError::NoValue { process: P::NAME, key: key.to_owned(), known }
}

/// Longest time of an advance, s: eleven days, beyond the life of any edge. Grinding goes on revolution by revolution, a
/// million of which take a tenth of a second.
const MOST_ADVANCED: f64 = 1e6;

/// Advances by the time of the options; what stopped the advance before its time.
pub fn advance<P: Process>(
    process: &P,
    input: &mut P::Input,
    state: &mut P::State,
    options: &PointOptions,
) -> Result<Option<ProcessEvent>, PointError> {
    let Some(time) = &options.advance else { return Ok(None) };
    let time = unit::quantity(time, "s").map_err(PointError::AdvanceTime)?;
    if time > MOST_ADVANCED {
        return Err(PointError::AdvanceTooLong { seconds: time, most: MOST_ADVANCED });
    }
    let advance = process.advance(state, input, time).map_err(PointError::of_advance)?;
    *input = process.input_after(input, advance.elapsed);
    Ok(advance.event)
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
