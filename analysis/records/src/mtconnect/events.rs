//! States of machines as records of events.

use super::runs::Run;
use super::session::Session;
use super::state::{MachineState, states};
use crate::{RecordKind, Records};

/// Events of all sessions in the order of time, one row a change; time counts from the first.
/// `runs` name the operations.
pub fn events(sessions: &[Session], runs: &[Run]) -> Records {
    let mut rows: Vec<(&str, MachineState)> = Vec::new();
    for session in sessions {
        rows.extend(states(session).into_iter().map(|state| (session.machine.as_str(), state)));
    }
    rows.sort_by(|a, b| a.1.time.total_cmp(&b.1.time));
    let origin = rows.first().map_or(0.0, |(_, state)| state.time);
    let mut records = Records::new(RecordKind::Shop, rows.len());
    type Text = fn(&MachineState) -> &str;
    type Number = fn(&MachineState) -> f64;
    let texts: [(&str, Text); 3] =
        [("state", |state| &state.execution), ("program", |state| &state.program), ("tool_id", |state| &state.tool)];
    let numbers: [(&str, Number); 5] = [
        ("block", |state| state.block),
        ("feed_override", |state| state.feed_override),
        ("rapid_override", |state| state.rapid_override),
        ("spindle_override", |state| state.spindle_override),
        ("part_count", |state| state.part_count),
    ];
    records.set_numbers("time", rows.iter().map(|(_, state)| state.time - origin).collect());
    records.set_texts("machine", rows.iter().map(|(machine, _)| (*machine).to_owned()).collect());
    let operation = |time: f64| runs.iter().find(|run| run.start <= time && time < run.end).map_or("", |run| &run.id);
    records.set_texts("operation_id", rows.iter().map(|(_, state)| operation(state.time).to_owned()).collect());
    for (name, value) in texts {
        records.set_texts(name, rows.iter().map(|(_, state)| value(state).to_owned()).collect());
    }
    for (name, value) in numbers {
        let values: Vec<f64> = rows.iter().map(|(_, state)| value(state)).collect();
        if values.iter().any(|value| !value.is_nan()) {
            records.set_numbers(name, values);
        }
    }
    records
}
