//! Who writes down what happens.

use crate::runlog::{AttendanceRow, EdgeRow, EventRow, JobRow, OperationRow, PassRow, RunLog, StateRow};

/// Receives the facts of a run as they become final. A [`RunLog`] keeps them all, [`Silent`]
/// none.
pub trait Recorder: Clone {
    /// A pass, or the part of it that one edge cut, is over.
    fn pass(&mut self, row: PassRow);
    /// Edge `number` was mounted, or left the machine.
    fn edge(&mut self, number: u32, row: EdgeRow);
    /// Job `number` arrived.
    fn arrival(&mut self, number: u32, row: JobRow);
    /// Job `number` left the shop, or is in it at the end of the run.
    fn job(&mut self, number: u32, row: JobRow);
    /// An operation is completed, lost, or in process at the end of the run.
    fn operation(&mut self, row: OperationRow);
    /// A machine left a state.
    fn state(&mut self, row: StateRow);
    /// A person left a machine. Who does not ask for it is not told.
    fn attendance(&mut self, _row: AttendanceRow) {}
    /// Something worth a line. Events inside a pass come when the pass is over.
    fn event(&mut self, row: EventRow);
    /// The run is over.
    fn close(&mut self, closing: Closing);
}

/// What holds for a run as a whole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closing {
    /// Simulated time, s.
    pub horizon: f64,
    /// Time that no statistic counts, s.
    pub warm_up: f64,
    /// Replay proof.
    pub digest: u64,
    /// Calendar events handled.
    pub calendar_events: u64,
}

/// Two recorders that are told the same; the second may be left out.
impl<A: Recorder, B: Recorder> Recorder for (A, Option<B>) {
    fn pass(&mut self, row: PassRow) {
        self.0.pass(row);
        self.1.iter_mut().for_each(|other| other.pass(row));
    }

    fn edge(&mut self, number: u32, row: EdgeRow) {
        self.0.edge(number, row);
        self.1.iter_mut().for_each(|other| other.edge(number, row));
    }

    fn arrival(&mut self, number: u32, row: JobRow) {
        self.0.arrival(number, row);
        self.1.iter_mut().for_each(|other| other.arrival(number, row));
    }

    fn job(&mut self, number: u32, row: JobRow) {
        self.0.job(number, row);
        self.1.iter_mut().for_each(|other| other.job(number, row));
    }

    fn operation(&mut self, row: OperationRow) {
        self.0.operation(row);
        self.1.iter_mut().for_each(|other| other.operation(row));
    }

    fn state(&mut self, row: StateRow) {
        self.0.state(row);
        self.1.iter_mut().for_each(|other| other.state(row));
    }

    fn attendance(&mut self, row: AttendanceRow) {
        self.0.attendance(row);
        self.1.iter_mut().for_each(|other| other.attendance(row));
    }

    fn event(&mut self, row: EventRow) {
        self.0.event(row);
        self.1.iter_mut().for_each(|other| other.event(row));
    }

    fn close(&mut self, closing: Closing) {
        self.0.close(closing);
        self.1.iter_mut().for_each(|other| other.close(closing));
    }
}

/// Keeps nothing, costs nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Silent;

impl Recorder for Silent {
    fn pass(&mut self, _: PassRow) {}
    fn edge(&mut self, _: u32, _: EdgeRow) {}
    fn arrival(&mut self, _: u32, _: JobRow) {}
    fn job(&mut self, _: u32, _: JobRow) {}
    fn operation(&mut self, _: OperationRow) {}
    fn state(&mut self, _: StateRow) {}
    fn event(&mut self, _: EventRow) {}
    fn close(&mut self, _: Closing) {}
}

impl Recorder for RunLog {
    fn pass(&mut self, row: PassRow) {
        self.passes.push(row);
    }

    fn edge(&mut self, number: u32, row: EdgeRow) {
        put(&mut self.edges, number, row);
    }

    fn arrival(&mut self, number: u32, row: JobRow) {
        put(&mut self.jobs, number, row);
    }

    fn job(&mut self, number: u32, row: JobRow) {
        put(&mut self.jobs, number, row);
    }

    fn operation(&mut self, row: OperationRow) {
        self.operations.push(row);
    }

    fn state(&mut self, row: StateRow) {
        self.states.push(row);
    }

    fn attendance(&mut self, row: AttendanceRow) {
        self.attendances.push(row);
    }

    fn event(&mut self, row: EventRow) {
        self.events.push(row);
    }

    fn close(&mut self, closing: Closing) {
        self.events.sort_by(|a, b| a.time.total_cmp(&b.time)); // stable: one instant keeps its order
        self.horizon = closing.horizon;
        self.warm_up = closing.warm_up;
        self.digest = closing.digest;
        self.calendar_events = closing.calendar_events;
    }
}

/// Numbers are given in order: a row is new or the final version of an old one.
fn put<T>(rows: &mut Vec<T>, number: u32, row: T) {
    match rows.get_mut(number as usize) {
        Some(old) => *old = row,
        None => rows.push(row),
    }
}
