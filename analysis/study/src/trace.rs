//! `trace.json`: a run for the Perfetto viewer or Chrome's, in the trace event format: a process a
//! policy, a track a machine, the machine's states as slices, tool changes and failures as
//! instants, the number of jobs in the shop as a counter. One second of the shop is one second of
//! the trace.

use crate::logs::Names;
use crate::study::Study;
use serde_json::{Value, json};
use std::io::{self, Write};
use toolroom_process::ProcessEvent;
use toolroom_scenario::Scenario;
use toolroom_shop::runlog::{EventRow, LogEvent, MachineState, RunLog};

/// Events that are worth an instant.
const INSTANTS: [LogEvent; 10] = [
    LogEvent::ChatterOnset,
    LogEvent::ToolChange,
    LogEvent::Dressing,
    LogEvent::Failure,
    LogEvent::Scrap,
    LogEvent::Cut(ProcessEvent::WearLimit),
    LogEvent::Cut(ProcessEvent::Chipping),
    LogEvent::Cut(ProcessEvent::ThermalCollapse),
    LogEvent::Cut(ProcessEvent::DressingDue),
    LogEvent::Cut(ProcessEvent::Burn),
];

/// Writes the first replication of every policy.
///
/// # Errors
/// What the writer says.
pub fn write(scenario: &Scenario, study: &Study, mut out: impl Write) -> io::Result<()> {
    let names = Names::of(scenario);
    let mut events = Vec::new();
    for (position, (&policy, log)) in study.policies.iter().zip(&study.first_logs).enumerate() {
        let process = position + 1;
        events.push(metadata("process_name", process, 0, names.policy(policy)));
        for (machine, named) in (1..).zip(&scenario.machines) {
            events.push(metadata("thread_name", process, machine, &named.name));
        }
        add_log(&names, process, log, &mut events);
    }
    // One event a line keeps the file readable and lets it be cut.
    out.write_all(b"{\"displayTimeUnit\":\"ms\",\"traceEvents\":[\n")?;
    for (index, event) in events.iter().enumerate() {
        if index > 0 {
            out.write_all(b",\n")?;
        }
        serde_json::to_writer(&mut out, event)?;
    }
    out.write_all(b"\n]}\n")
}

fn metadata(kind: &str, process: usize, track: usize, name: &str) -> Value {
    json!({ "ph": "M", "name": kind, "pid": process, "tid": track, "args": { "name": name } })
}

/// The machine of the last pass of every job.
pub(crate) fn last_machines(log: &RunLog) -> Vec<Option<u32>> {
    let mut machines = vec![None; log.jobs.len()];
    for row in &log.passes {
        machines[row.job as usize] = Some(row.machine);
    }
    machines
}

/// Where an event happened: its machine, or the last one of the job that left the shop.
pub(crate) fn machine_of(row: &EventRow, last_machines: &[Option<u32>]) -> Option<u32> {
    row.machine.or_else(|| last_machines.get(row.job? as usize).copied().flatten())
}

fn micro(seconds: f64) -> f64 {
    (seconds * 1e6).round()
}

fn add_log(names: &Names, process: usize, log: &RunLog, events: &mut Vec<Value>) {
    for row in log.states.iter().filter(|row| row.state != MachineState::Idle) {
        let mut slice = json!({
            "ph": "X",
            "name": row.state.name(),
            "cat": "state",
            "ts": micro(row.start),
            "dur": micro(row.end) - micro(row.start),
            "pid": process,
            "tid": row.machine + 1,
        });
        if let Some(job) = row.job {
            let part = log.jobs.get(job as usize).map_or("", |row| names.part(row.part));
            slice["args"] = json!({ "job": job, "part": part });
        }
        events.push(slice);
    }
    let last_machines = last_machines(log);
    let mut jobs = 0_i64;
    for row in &log.events {
        if let Some(machine) = machine_of(row, &last_machines).filter(|_| INSTANTS.contains(&row.event)) {
            events.push(json!({
                "ph": "i",
                "s": "t",
                "name": row.event.name(),
                "cat": "event",
                "ts": micro(row.time),
                "pid": process,
                "tid": machine + 1,
                "args": { "job": row.job, "edge": row.edge },
            }));
        }
        let step = if row.event == LogEvent::Arrival {
            1
        } else if [LogEvent::Finish, LogEvent::Scrap].contains(&row.event) {
            -1
        } else {
            continue;
        };
        jobs += step;
        let count = json!({ "jobs": jobs });
        events.push(json!({ "ph": "C", "name": "jobs in shop", "ts": micro(row.time), "pid": process, "args": count }));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture;
    use crate::study::{StudyOptions, study_with};
    use std::sync::atomic::AtomicBool;

    #[test]
    fn machines_are_tracks_and_changes_are_instants() {
        let scenario = fixture::scenario();
        let options = StudyOptions { replications: 2, ..StudyOptions::of(&scenario) };
        let simulate = |_, _| Ok(fixture::log());
        let study =
            study_with(&scenario, &options, None, &|_| {}, &AtomicBool::new(false), &simulate).expect("a study");
        let mut bytes = Vec::new();
        write(&scenario, &study, &mut bytes).expect("memory");
        let json: Value = serde_json::from_slice(&bytes).expect("JSON");
        let events = json["traceEvents"].as_array().expect("a list");
        let of_kind = |kind: &str| events.iter().filter(|event| event["ph"] == kind).collect::<Vec<_>>();
        assert_eq!(of_kind("M").len(), 2 * (1 + 3));
        // All states but idle, of both policies.
        assert_eq!(of_kind("X").len(), 2 * (6 + 3));
        let cut = of_kind("X").into_iter().find(|event| event["name"] == "cutting").expect("a cut");
        assert_eq!((&cut["ts"], &cut["dur"], &cut["tid"]), (&json!(60e6), &json!(300e6), &json!(1)));
        let instants: Vec<&Value> = of_kind("i").iter().map(|event| &event["name"]).collect();
        assert_eq!(instants, ["tool_change", "scrap", "tool_change", "scrap"]);
        assert_eq!(of_kind("C").len(), 4);
    }
}
