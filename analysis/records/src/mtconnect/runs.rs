//! Runs of programs.

use super::keys::Role;
use super::session::Session;
use super::state::{MachineState, UNAVAILABLE, states};

/// One run of a program, from its start to its end.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// Name: program and start.
    pub id: String,
    /// Machine.
    pub machine: String,
    /// Program, as the log or the user names it.
    pub program: String,
    /// When it started, s.
    pub start: f64,
    /// When it ended, s.
    pub end: f64,
    /// Whether the controller said that the program was completed.
    pub complete: bool,
    /// States from start to end; the first is that at the start.
    pub states: Vec<MachineState>,
    /// Reported feeds with their times, s, in the unit of the log.
    pub feeds: Vec<(f64, f64)>,
}

/// What an execution state means for a run.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Phase {
    Running,
    Paused,
    Completed,
    Ended,
}

/// Execution states of MTConnect part 2; controllers word PROGRAM_STOPPED for a pause within a program.
fn phase(execution: &str) -> Phase {
    match execution {
        "ACTIVE" => Phase::Running,
        "INTERRUPTED" | "FEED_HOLD" | "OPTIONAL_STOP" | "PROGRAM_STOPPED" | "PROGRAM_OPTIONAL_STOP" | "WAIT" => {
            Phase::Paused
        }
        "PROGRAM_COMPLETED" => Phase::Completed,
        _ => Phase::Ended,
    }
}

/// Share of the block at a pause below which a program that goes on was started anew.
const ANEW: f64 = 0.5;

/// Runs of a session. `program` names them where the log does not.
pub fn runs(session: &Session, program: Option<&str>) -> Vec<Run> {
    let mut list: Vec<Run> = Vec::new();
    let mut open: Option<Run> = None;
    // Block at which the program paused, until it is seen to go on.
    let mut paused: Option<f64> = None;
    let finish = |run: Option<Run>, at: f64, complete: bool, list: &mut Vec<Run>| {
        if let Some(run) = run {
            list.push(Run { end: at, complete, ..run });
        }
    };
    for state in states(session) {
        let now = phase(&state.execution);
        if let Some(block) = paused
            && now == Phase::Running
            && open.as_ref().is_some_and(|run| run.states.last().is_some_and(|last| last.block != state.block))
        {
            if state.block < ANEW * block {
                let end = open.as_ref().and_then(|run| run.states.last()).map_or(state.time, |last| last.time);
                finish(open.take(), end, false, &mut list);
            }
            paused = None;
        }
        match (now, open.as_mut()) {
            (Phase::Running | Phase::Paused, Some(run)) => {
                if now == Phase::Paused && paused.is_none() {
                    paused = Some(state.block).filter(|block| block.is_finite());
                }
                run.states.push(state);
            }
            (Phase::Running, None) => open = Some(begun(session, state, program)),
            (Phase::Paused, None) => {}
            (Phase::Completed | Phase::Ended, _) => {
                paused = None;
                // A log that ends within a run leaves it incomplete.
                finish(open.take(), state.time, now == Phase::Completed, &mut list);
            }
        }
    }
    let reported = feeds(session);
    for run in &mut list {
        let inside = |time: f64| reported.partition_point(|(at, _)| *at < time);
        run.feeds = reported[inside(run.start)..inside(run.end)].to_vec();
        let named = run.states.iter().map(|state| state.program.as_str()).find(|name| !name.is_empty());
        let name = program.or(named).unwrap_or(UNAVAILABLE).to_owned();
        run.id = format!("{name}@{:.0}", run.start);
        run.program = name;
    }
    list
}

/// Feeds that a session reports, in the order of time.
fn feeds(session: &Session) -> Vec<(f64, f64)> {
    let key = session.keys.get(&Role::Feed);
    let entries = session.entries.iter().filter(|entry| Some(&entry.key) == key);
    entries.filter_map(|entry| Some((entry.time, entry.value.as_deref()?.parse().ok()?))).collect()
}

fn begun(session: &Session, state: MachineState, program: Option<&str>) -> Run {
    Run {
        id: String::new(),
        machine: session.machine.clone(),
        program: program.unwrap_or_default().to_owned(),
        start: state.time,
        end: state.time,
        complete: false,
        states: vec![state],
        feeds: Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::{parse_shdr, sessions};
    use super::*;

    fn of(text: &str) -> Vec<(f64, f64, bool)> {
        let sessions = sessions("m", &parse_shdr(text), &[]);
        sessions.iter().flat_map(|own| runs(own, Some("P"))).map(|run| (run.start, run.end, run.complete)).collect()
    }

    #[test]
    fn a_run_goes_on_behind_a_hold_and_ends_with_the_program() {
        let text = "1|exec|READY|line|90\n2|exec|ACTIVE|line|1\n5|line|50\n6|exec|FEED_HOLD\n7|exec|PROGRAM_STOPPED\n\
            9|exec|ACTIVE\n10|line|51\n20|exec|PROGRAM_COMPLETED\n30|exec|ACTIVE|line|1\n31|exec|READY\n";
        assert_eq!(of(text), [(2.0, 20.0, true), (30.0, 31.0, false)]);
    }

    #[test]
    fn a_program_that_starts_anew_behind_a_stop_is_another_run() {
        let text = "1|exec|ACTIVE|line|1\n5|line|50\n7|exec|PROGRAM_STOPPED\n9|exec|ACTIVE\n10|line|2\n20|line|60\n\
            21|exec|PROGRAM_COMPLETED\n";
        assert_eq!(of(text), [(1.0, 9.0, false), (10.0, 21.0, true)]);
    }

    #[test]
    fn a_log_that_ends_within_a_run_leaves_it_incomplete() {
        assert_eq!(of("1|exec|ACTIVE|line|1\n5|line|50\n"), [(1.0, 5.0, false)]);
    }
}
