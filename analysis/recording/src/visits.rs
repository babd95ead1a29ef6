//! Operations of jobs on machines, put together from passes and states of a log.

use std::collections::BTreeMap;
use toolroom_scenario::{Scenario, Work};
use toolroom_shop::RunLog;
use toolroom_shop::runlog::{MachineState, StateRow};

/// Stays of the machines; one that the end of a shift divides is one again.
pub fn whole_states(log: &RunLog) -> Vec<StateRow> {
    let mut states: Vec<StateRow> = Vec::with_capacity(log.states.len());
    let mut last: BTreeMap<u32, usize> = BTreeMap::new();
    for row in &log.states {
        let before = last.get(&row.machine).map(|at| &mut states[*at]).filter(|before| {
            let same = before.state == row.state && before.job == row.job;
            same && before.end == row.start && before.in_shift != row.in_shift
        });
        match before {
            Some(before) => (before.end, before.in_shift) = (row.end, row.in_shift),
            None => {
                last.insert(row.machine, states.len());
                states.push(*row);
            }
        }
    }
    states
}

/// One operation of one job on one machine.
#[derive(Clone, Debug, Default)]
pub struct Visit {
    pub job: u32,
    pub part: u32,
    pub operation: u32,
    /// Indices of its passes in the log, in time; plain work has none.
    pub passes: Vec<usize>,
    /// Start of the operation, s.
    pub start: f64,
    /// Time from the first cut to the last, of plain work from beginning to end, s.
    cut: (f64, f64),
    /// Loading and unloading, s.
    pub handling: f64,
    /// In cut or in plain work as the control clocks it, with what was added to the program, s.
    pub machining: f64,
    /// Whether it began and ended within the run: of another one the control has clocked no cycle.
    pub whole: bool,
    /// Breakdowns in the middle of it.
    pub stops: u32,
    /// Their time, s.
    pub stop_time: f64,
}

/// All of them, and which one a state belongs to.
#[derive(Clone, Debug, Default)]
pub struct Visits {
    pub list: Vec<Visit>,
    /// Visits of a job on a machine.
    of: BTreeMap<(u32, u32), Vec<usize>>,
    /// Visit of each pass.
    pub of_pass: Vec<usize>,
}

impl Visits {
    pub fn of(scenario: &Scenario, log: &RunLog) -> Self {
        let mut visits = Self::default();
        let mut index: BTreeMap<(u32, u32, u32), usize> = BTreeMap::new();
        for (pass_index, pass) in log.passes.iter().enumerate() {
            let place = *index.entry((pass.machine, pass.job, pass.operation)).or_insert_with(|| {
                let (job, part, operation) = (pass.job, pass.part, pass.operation);
                let cut = (pass.start, pass.end);
                visits.of.entry((pass.machine, job)).or_default().push(visits.list.len());
                let start = pass.start;
                visits.list.push(Visit { job, part, operation, start, cut, ..Visit::default() });
                visits.list.len() - 1
            });
            visits.of_pass.push(place);
            let visit = &mut visits.list[place];
            visit.passes.push(pass_index);
            visit.cut = (visit.cut.0.min(pass.start), visit.cut.1.max(pass.end));
        }
        for row in &log.operations {
            let work = &scenario.parts[row.part as usize].operations[row.operation as usize].work;
            match index.get(&(row.machine, row.job, row.operation)) {
                Some(place) => {
                    let visit = &mut visits.list[*place];
                    (visit.start, visit.whole) = (row.start, row.end.is_finite() && row.time_before == 0.0);
                }
                None if matches!(work, Work::Plain(_)) => {
                    // What is still in process at the end of the run has no end of its own.
                    let end = if row.end.is_finite() { row.end } else { log.horizon };
                    visits.of.entry((row.machine, row.job)).or_default().push(visits.list.len());
                    let (job, part, operation) = (row.job, row.part, row.operation);
                    let (start, cut) = (row.start, (row.start, end));
                    visits.list.push(Visit { job, part, operation, start, cut, ..Visit::default() });
                }
                None => {}
            }
        }
        for state in &whole_states(log) {
            let Some(place) = visits.of_state(state) else { continue };
            let visit = &mut visits.list[place];
            match state.state {
                MachineState::Handling => visit.handling += state.end - state.start,
                MachineState::Down => {
                    visit.stops += 1;
                    visit.stop_time += state.end - state.start;
                }
                MachineState::Cutting | MachineState::Working => visit.machining += state.end - state.start,
                MachineState::Setup
                | MachineState::ToolChange
                | MachineState::Dressing
                | MachineState::Idle
                | MachineState::Starved
                | MachineState::Blocked
                | MachineState::WaitingOperator
                | MachineState::WaitingFixture
                | MachineState::WaitingTool
                | MachineState::Maintenance
                | MachineState::OffShift => {}
            }
        }
        visits
    }

    /// The visit nearest in time to a state of a machine with a job.
    pub fn of_state(&self, state: &StateRow) -> Option<usize> {
        let visits = self.of.get(&(state.machine, state.job?))?;
        let far = |index: usize| {
            let (start, end) = self.list[index].cut;
            (start - state.end).max(state.start - end).max(0.0)
        };
        visits.iter().copied().min_by(|a, b| far(*a).total_cmp(&far(*b)))
    }
}
