//! Events of the machines: one row for every state that a machine enters.

use crate::visits::whole_states;
use crate::{Run, edge_name};
use std::collections::BTreeMap;
use toolroom_records::{RecordKind, Records};
use toolroom_shop::RunLog;
use toolroom_shop::runlog::{AttendanceRow, LogEvent, MachineState, StateRow};

/// State after which nothing is known.
const END: &str = "unavailable";
/// State while the feed is held.
const HELD: &str = "feed_hold";

/// The events, in time.
pub fn events(run: &Run<'_>) -> Records {
    let states = states(run.log);
    let machines = if states.is_empty() { 0 } else { run.scenario.machines.len() };
    let count = states.len() + machines;
    let mut records = Records::new(RecordKind::Shop, count);
    let mut time: Vec<f64> = states.iter().map(|(state, _)| state.start).collect();
    let mut machine: Vec<String> = states.iter().map(|(state, _)| run.machine(state.machine)).collect();
    let mut name: Vec<String> = states.iter().map(|(_, word)| (*word).to_owned()).collect();
    let mut program = vec![String::new(); count];
    let mut operation = vec![String::new(); count];
    let mut tool = vec![String::new(); count];
    let mut feed = vec![f64::NAN; count];
    for (row, (state, _)) in states.iter().enumerate() {
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
    let rows: Vec<StateRow> = states.iter().map(|(state, _)| *state).collect();
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
    orders(run, &rows, count, &mut records);
    if !run.scenario.operators.is_empty() {
        records.set_texts("operator", operators(run, &rows, count));
    }
    records
}

/// The order of the job in the machine and the pieces of it that are there, where there are orders.
fn orders(run: &Run<'_>, states: &[StateRow], count: usize, records: &mut Records) {
    if run.scenario.orders.is_empty() {
        return;
    }
    let (mut order, mut quantity) = (vec![String::new(); count], vec![f64::NAN; count]);
    for (row, state) in states.iter().enumerate() {
        let Some(job) = state.job.and_then(|job| run.log.jobs.get(job as usize)) else { continue };
        quantity[row] = f64::from(job.quantity);
        if let Some(own) = job.order.and_then(|index| run.scenario.orders.get(index as usize)) {
            order[row].clone_from(&own.id);
        }
    }
    records.set_texts("order", order);
    records.set_numbers("quantity", quantity);
}

/// Who attends to the machine when it enters a state, or comes to it first while it is in that state.
fn operators(run: &Run<'_>, states: &[StateRow], count: usize) -> Vec<String> {
    let mut by_machine: BTreeMap<u32, Vec<&AttendanceRow>> = BTreeMap::new();
    for row in &run.log.attendances {
        by_machine.entry(row.machine).or_default().push(row);
    }
    let mut names = vec![String::new(); count];
    for (row, state) in states.iter().enumerate() {
        let Some(own) = by_machine.get(&state.machine) else { continue };
        let first = own.partition_point(|attendance| attendance.end <= state.start);
        if let Some(attendance) = own.get(first).filter(|attendance| attendance.start < state.end) {
            names[row].clone_from(&run.scenario.operators[attendance.operator as usize].name);
        }
    }
    names
}

/// States with their words, in time. The log counts holds as time in cut and has them among its events:
/// here they are a state of their own.
fn states(log: &RunLog) -> Vec<(StateRow, &'static str)> {
    let mut holds: BTreeMap<u32, Vec<(f64, f64)>> = BTreeMap::new();
    for event in &log.events {
        let Some(machine) = event.machine else { continue };
        let stops = holds.entry(machine).or_default();
        if event.event == LogEvent::FeedHold {
            stops.push((event.time, log.horizon));
        } else if let (LogEvent::FeedRelease, Some(hold)) = (event.event, stops.last_mut()) {
            hold.1 = event.time;
        }
    }
    let mut states: Vec<(StateRow, &'static str)> = Vec::with_capacity(log.states.len());
    for state in &whole_states(log) {
        let stops = holds.get(&state.machine).map_or(&[][..], Vec::as_slice);
        let hold = stops.iter().find(|(from, to)| *from < state.end && state.start < *to);
        match hold.filter(|_| state.state == MachineState::Cutting) {
            Some((from, _)) if *from > state.start => {
                states.push((StateRow { end: *from, ..*state }, state.state.name()));
                states.push((StateRow { start: *from, ..*state }, HELD));
            }
            Some(_) => states.push((*state, HELD)),
            None => states.push((*state, state.state.name())),
        }
    }
    states.sort_by(|(a, _), (b, _)| a.start.total_cmp(&b.start).then(a.machine.cmp(&b.machine)));
    states
}
