//! What people do: their stays at machines, by the states of those.

use toolroom_scenario::Scenario;
use toolroom_shop::runlog::{MachineState, RunLog, StateRow};

/// A stretch of time in which a person does one thing at one machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attended {
    /// Person, by index into the operators of the scenario.
    pub operator: u32,
    /// What the machine does; [`MachineState::WaitingOperator`] while the person is on the way to it.
    pub state: MachineState,
    /// From, s.
    pub start: f64,
    /// To, s.
    pub end: f64,
    /// Job in the machine.
    pub job: u32,
    /// Share of the person that it takes, 0 to 1.
    pub share: f64,
}

/// What people do in a run, each in the order of time.
pub fn attended(log: &RunLog) -> Vec<Attended> {
    let machines = log.states.iter().map(|row| row.machine as usize + 1).max().unwrap_or(0);
    let mut states: Vec<Vec<&StateRow>> = vec![Vec::new(); machines];
    log.states.iter().for_each(|row| states[row.machine as usize].push(row));
    let mut all = Vec::new();
    for row in &log.attendances {
        let own = &states[row.machine as usize];
        let first = own.partition_point(|state| state.end <= row.start);
        for state in own[first..].iter().take_while(|state| state.start < row.end) {
            let (start, end) = (state.start.max(row.start), state.end.min(row.end));
            let (operator, job, share) = (row.operator, row.job, f64::from(row.share));
            all.push(Attended { operator, state: state.state, start, end, job, share });
        }
    }
    all.sort_by(|a, b| a.operator.cmp(&b.operator).then(a.start.total_cmp(&b.start)));
    all
}

/// Rows of a page for people: whose, and what is in them; a row has one thing at a time, so that somebody who tends several
/// machines at once has several rows.
pub(crate) fn lanes(log: &RunLog) -> Vec<(u32, Vec<Attended>)> {
    let mut lanes: Vec<(u32, Vec<Attended>)> = Vec::new();
    for stay in attended(log) {
        let free = |(operator, own): &&mut (u32, Vec<Attended>)| {
            *operator == stay.operator && own.last().is_none_or(|last| last.end <= stay.start)
        };
        match lanes.iter_mut().find(free) {
            Some((_, own)) => own.push(stay),
            None => lanes.push((stay.operator, vec![stay])),
        }
    }
    lanes
}

/// Stretches from time zero to `until`, s, in which a person is out of shift.
pub(crate) fn off_shift(scenario: &Scenario, operator: usize, until: f64) -> Vec<(f64, f64)> {
    let Some(calendar) = scenario.operators[operator].calendar.map(|index| &scenario.calendars[index]) else {
        return Vec::new();
    };
    let (mut off, mut now) = (Vec::new(), 0.0);
    while now < until {
        let next = calendar.next_boundary(now).map_or(until, |boundary| boundary.time.min(until));
        if !calendar.works_at(now) {
            off.push((now, next));
        }
        now = next;
    }
    off
}
