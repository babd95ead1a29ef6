//! Events of the machines: one row for every state that a machine enters.

use super::super::{RecordKind, Records};
use super::{Run, edge_name};

/// State after which nothing is known.
const END: &str = "unavailable";

/// The events, in time.
pub fn events(run: &Run<'_>) -> Records {
    let mut states: Vec<_> = run.log.states.iter().collect();
    states.sort_by(|a, b| a.start.total_cmp(&b.start).then(a.machine.cmp(&b.machine)));
    let machines = if states.is_empty() { 0 } else { run.scenario.machines.len() };
    let count = states.len() + machines;
    let mut records = Records::new(RecordKind::Shop, count);
    let mut time: Vec<f64> = states.iter().map(|state| state.start).collect();
    let mut machine: Vec<String> = states.iter().map(|state| run.machine(state.machine)).collect();
    let mut name: Vec<String> = states.iter().map(|state| state.state.name().to_owned()).collect();
    let mut program = vec![String::new(); count];
    let mut operation = vec![String::new(); count];
    let mut tool = vec![String::new(); count];
    let mut feed = vec![f64::NAN; count];
    for (row, state) in states.iter().enumerate() {
        let Some(visit) = run.visits.of_state(state).map(|index| &run.visits.list[index]) else { continue };
        program[row] = run.program(visit.part, visit.operation);
        operation[row] = run.operation_id(visit.job, visit.part, visit.operation);
        // The edge that cuts next, or cut last.
        let next = visit.passes.iter().find(|pass| run.log.passes[**pass].end > state.start + 1e-6);
        if let Some(pass) = next.or(visit.passes.last()) {
            tool[row] = edge_name(run.log.passes[*pass].edge);
        }
        feed[row] = 1.0;
    }
    time.extend(vec![run.log.horizon; machines]);
    machine.extend(run.scenario.machines.iter().take(machines).map(|machine| machine.name.clone()));
    name.extend(vec![END.to_owned(); machines]);
    records.set_numbers("time", time);
    records.set_texts("machine", machine);
    records.set_texts("state", name);
    records.set_texts("program", program);
    records.set_texts("operation_id", operation);
    records.set_texts("tool_id", tool);
    records.set_numbers("feed_override", feed);
    records
}
