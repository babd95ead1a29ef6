//! `trace.json`: a run for the Perfetto viewer or Chrome's, in the trace event format: a process a
//! policy, a track a machine, the machine's states as slices, tool changes and failures as
//! instants, the number of jobs in the shop as a counter. One second of the shop is one second of
//! the trace.

use crate::logs::Names;
use crate::study::Study;
use serde_json::{Value, json};
use std::io::{self, Write};
use toolroom_process::ProcessEvent;
use toolroom_process::unit::quantity;
use toolroom_scenario::{Scenario, date};
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

/// What is shown where nothing else is asked for, s: a longer trace is slow to open.
const FIRST_WEEK: [f64; 2] = [0.0, 7.0 * 86400.0];
/// Most events of one policy (assumption: viewers in a browser become slow beyond).
const MOST_EVENTS: usize = 200_000;

/// A part of a run that cannot be shown.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum WindowError {
    /// A text that is no time since the start, and no date after it.
    #[error("--trace: {text:?} is no instant of the run")]
    NoInstant {
        /// The text.
        text: String,
    },
    /// An end that is not behind the start.
    #[error("--trace from {from} to {to} shows nothing")]
    Nothing {
        /// The start as it was written.
        from: String,
        /// The end as it was written.
        to: String,
    },
}

impl WindowError {
    /// The likely way out.
    pub fn fix(&self) -> &'static str {
        match self {
            Self::NoInstant { .. } => {
                "two dates where the scenario has a start, such as \"2026-04-01 06:00\", or times such as \"40 h\""
            }
            Self::Nothing { .. } => "write the earlier one first: --trace \"6 h\" \"30 h\"",
        }
    }
}

/// The part of a run between two dates or times, s from the start; `None` where there are not two.
///
/// # Errors
/// [`WindowError`].
pub fn window(scenario: &Scenario, ends: &[String]) -> Result<Option<[f64; 2]>, WindowError> {
    let [from, to] = ends else { return Ok(None) };
    let instant = |text: &String| {
        let time = if date::is_date(text) {
            date::parse(text).zip(scenario.start).map(|(time, start)| time - start)
        } else {
            quantity(text, "s").ok()
        };
        time.filter(|time| *time >= 0.0).ok_or_else(|| WindowError::NoInstant { text: text.clone() })
    };
    let (start, end) = (instant(from)?, instant(to)?);
    if start < end { Ok(Some([start, end])) } else { Err(WindowError::Nothing { from: from.clone(), to: to.clone() }) }
}

/// Writes the first replication of every policy, event by event: what happens in `window` (from and to, s from the start; its
/// first week where there is none), and no more than 200 000 events of a policy, the first ones. The end says under `shown`
/// what of every policy that is.
///
/// # Errors
/// What the writer says.
pub fn write(scenario: &Scenario, study: &Study, window: Option<[f64; 2]>, out: impl Write) -> io::Result<()> {
    let names = Names::of(scenario);
    let mut lines = Lines { out, first: true };
    let mut shown = Vec::new();
    // One event a line keeps the file readable and lets it be cut.
    lines.out.write_all(b"{\"displayTimeUnit\":\"ms\",\"traceEvents\":[\n")?;
    for (position, (&policy, log)) in study.policies.iter().zip(&study.first_logs).enumerate() {
        let process = position + 1;
        lines.put(&metadata("process_name", process, 0, names.policy(policy)))?;
        for (machine, named) in (1..).zip(&scenario.machines) {
            lines.put(&metadata("thread_name", process, machine, &named.name))?;
        }
        let [from, to] = window.unwrap_or(FIRST_WEEK);
        let end = last_shown(log, [from, to], MOST_EVENTS);
        add_log(&names, process, log, [from, end], &mut lines)?;
        shown.push(json!({
            "policy": names.policy(policy),
            "from [h]": from / 3600.0,
            "to [h]": end.min(log.horizon) / 3600.0,
            "cut at events": if end < to { json!(MOST_EVENTS) } else { Value::Null },
        }));
    }
    lines.out.write_all(b"\n],\"otherData\":")?;
    serde_json::to_writer(&mut lines.out, &json!({ "shown": shown }))?;
    lines.out.write_all(b"}\n")
}

/// Events of a file, one a line.
struct Lines<W> {
    out: W,
    first: bool,
}

impl<W: Write> Lines<W> {
    fn put(&mut self, event: &Value) -> io::Result<()> {
        if !std::mem::take(&mut self.first) {
            self.out.write_all(b",\n")?;
        }
        Ok(serde_json::to_writer(&mut self.out, event)?)
    }
}

/// The end of the window, or the instant from which on it would hold more than `most` events.
fn last_shown(log: &RunLog, [from, to]: [f64; 2], most: usize) -> f64 {
    let states = log.states.iter().filter(|row| row.state != MachineState::Idle && row.end > from).map(|row| row.start);
    let events = log.events.iter().filter(|row| row.time >= from).map(|row| row.time);
    let mut times: Vec<f64> = states.chain(events).filter(|time| *time < to).collect();
    if times.len() <= most {
        return to;
    }
    *times.select_nth_unstable_by(most, f64::total_cmp).1
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

fn add_log<W: Write>(
    names: &Names,
    process: usize,
    log: &RunLog,
    [from, to]: [f64; 2],
    lines: &mut Lines<W>,
) -> io::Result<()> {
    let inside = |start: f64, end: f64| start < to && end > from;
    let states = log.states.iter().filter(|row| row.state != MachineState::Idle && inside(row.start, row.end));
    for row in states {
        let (start, end) = (row.start.max(from), row.end.min(to));
        let mut slice = json!({
            "ph": "X",
            "name": row.state.name(),
            "cat": "state",
            "ts": micro(start),
            "dur": micro(end) - micro(start),
            "pid": process,
            "tid": row.machine + 1,
        });
        if let Some(job) = row.job {
            let part = log.jobs.get(job as usize).map_or("", |row| names.part(row.part));
            slice["args"] = json!({ "job": job, "part": part });
        }
        lines.put(&slice)?;
    }
    let last_machines = last_machines(log);
    let mut jobs = 0_i64;
    for row in &log.events {
        let shown = (from..to).contains(&row.time);
        if let Some(machine) = machine_of(row, &last_machines).filter(|_| shown && INSTANTS.contains(&row.event)) {
            lines.put(&json!({
                "ph": "i",
                "s": "t",
                "name": row.event.name(),
                "cat": "event",
                "ts": micro(row.time),
                "pid": process,
                "tid": machine + 1,
                "args": { "job": row.job, "edge": row.edge },
            }))?;
        }
        // Jobs that came before count.
        let step = if row.event == LogEvent::Arrival {
            1
        } else if [LogEvent::Finish, LogEvent::Scrap].contains(&row.event) {
            -1
        } else {
            continue;
        };
        jobs += step;
        if shown {
            let count = json!({ "jobs": jobs });
            lines.put(
                &json!({ "ph": "C", "name": "jobs in shop", "ts": micro(row.time), "pid": process, "args": count }),
            )?;
        }
    }
    Ok(())
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
        write(&scenario, &study, None, &mut bytes).expect("memory");
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

    #[test]
    fn a_window_shows_what_happens_in_it_and_counts_the_jobs_before() {
        let scenario = fixture::scenario();
        let options = StudyOptions { replications: 1, ..StudyOptions::of(&scenario) };
        let simulate = |_, _| Ok(fixture::log());
        let study =
            study_with(&scenario, &options, None, &|_| {}, &AtomicBool::new(false), &simulate).expect("a study");
        let log = fixture::log();
        let whole = events(&scenario, &study, Some([0.0, f64::MAX]));
        assert_eq!(whole, events(&scenario, &study, None));
        let middle = log.events[log.events.len() / 2].time;
        let (before, after) =
            (events(&scenario, &study, Some([0.0, middle])), events(&scenario, &study, Some([middle, f64::MAX])));
        let of_kind = |events: &[Value], kind: &str| {
            events.iter().filter(|event| event["ph"] == kind).cloned().collect::<Vec<_>>()
        };
        for kind in ["i", "C"] {
            assert_eq!([of_kind(&before, kind), of_kind(&after, kind)].concat(), {
                // By policy in the whole, by window here.
                let mut parts = of_kind(&whole, kind);
                parts.sort_by_key(|event| event["ts"].as_f64().is_some_and(|time| time >= micro(middle)));
                parts
            });
        }
        let lasting =
            |events: &[Value]| of_kind(events, "X").iter().filter_map(|event| event["dur"].as_f64()).sum::<f64>();
        assert!((lasting(&before) + lasting(&after) - lasting(&whole)).abs() < 10.0);
        // Too many events: the first ones, up to an instant.
        let all = log.events.len() + log.states.iter().filter(|row| row.state != MachineState::Idle).count();
        assert_eq!(last_shown(&log, [0.0, 1e9], all), 1e9);
        let cut = last_shown(&log, [0.0, 1e9], 3);
        assert!(cut < 1e9 && log.events.iter().filter(|row| row.time < cut).count() <= 3);
    }

    fn events(scenario: &Scenario, study: &Study, window: Option<[f64; 2]>) -> Vec<Value> {
        let mut bytes = Vec::new();
        write(scenario, study, window, &mut bytes).expect("memory");
        let json: Value = serde_json::from_slice(&bytes).expect("JSON");
        assert!(json["otherData"]["shown"].as_array().is_some_and(|shown| shown.len() == study.policies.len()));
        json["traceEvents"].as_array().expect("a list").clone()
    }
}
