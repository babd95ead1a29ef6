//! Tables of trials and of recorded forces.

use crate::table::{Cell, ColumnSpec, Row, read};
use crate::{ForceSample, TableError, TableFault, TableNote, TableReason, Trial};
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// Trials as read from a file.
#[derive(Clone, Debug, PartialEq)]
pub struct TrialTable {
    /// The trials in the order of the file.
    pub trials: Vec<Trial>,
    /// What the reader did on its own account.
    pub notes: Vec<TableNote>,
}

const fn number(name: &'static str, unit: &'static str, required: bool) -> ColumnSpec {
    ColumnSpec { name, unit: Some(unit), required }
}

const fn text(name: &'static str, required: bool) -> ColumnSpec {
    ColumnSpec { name, unit: None, required }
}

const TRIAL_COLUMNS: &[ColumnSpec] = &[
    text("trial_id", true),
    text("machine", false),
    number("infeed_per_rev", "m", true),
    number("revolutions", "1", true),
    number("spark_out_revolutions", "1", false),
    number("work_rotation_speed", "rad/s", false),
    number("stock_removed", "m", false),
    number("normal_force", "N", false),
    number("tangential_force", "N", false),
    number("rise_revolutions", "1", false),
    number("force_after_spark_out", "N", false),
    // Known to the records contract and without bearing on the lag.
    text("wheel_id", false),
    text("dressing_cycle", false),
    text("part_in_cycle", false),
    number("width", "m", false),
    text("coolant_id", false),
    number("wait_time", "s", false),
    number("finish_infeed_per_rev", "m", false),
    number("finish_revolutions", "1", false),
];

/// Reads a table of trials: a header `name [unit]` in any column order, one trial a line.
///
/// Required: `trial_id`, `infeed_per_rev [um]`, `revolutions`; and at least one of
/// `stock_removed [um]`, `rise_revolutions`, `force_after_spark_out [N]` or a recorded force, of
/// which `identify` says so. `finish_infeed_per_rev [um]` and `finish_revolutions` name a finish stage behind the first.
/// `normal_force [N]` gives the stiffnesses. Comma, semicolon or tab
/// separate; a decimal comma is found out; lines that start with `#` are comments.
/// `file` is the name for messages.
///
/// # Errors
/// [`TableError`] with every fault and its place.
///
/// ```
/// let csv = "revolutions;trial_id;stock_removed [um];infeed_per_rev [um]\n16;1;66;4,43\n";
/// let table = toolroom_infeed::read_trials("trials.csv", csv.as_bytes()).unwrap();
/// assert_eq!(table.trials[0].infeed_per_rev, 4.43e-6);
/// ```
pub fn read_trials(file: &str, bytes: &[u8]) -> Result<TrialTable, TableError> {
    let (rows, notes) = read(file, bytes, TRIAL_COLUMNS)?;
    let trials: Vec<Trial> = rows.iter().map(trial).collect();
    let mut first: BTreeMap<&str, usize> = BTreeMap::new();
    let mut faults = Vec::new();
    for (trial, row) in trials.iter().zip(&rows) {
        if let Some(first) = first.insert(&trial.trial_id, row.line) {
            let reason = TableReason::TwoRecords { record: trial.trial_id.clone(), first };
            faults.push(TableFault { line: row.line, column: 1, reason });
        }
    }
    if faults.is_empty() { Ok(TrialTable { trials, notes }) } else { Err(TableError { file: file.to_owned(), faults }) }
}

fn number_at(row: &Row, index: usize) -> Option<f64> {
    match row.cells[index] {
        Cell::Number(value) => Some(value),
        Cell::Missing | Cell::Text(_) => None,
    }
}

fn text_at(row: &Row, index: usize) -> Option<String> {
    match &row.cells[index] {
        Cell::Text(text) => Some(text.clone()),
        Cell::Missing | Cell::Number(_) => None,
    }
}

/// A row in the order of [`TRIAL_COLUMNS`].
fn trial(row: &Row) -> Trial {
    Trial {
        trial_id: text_at(row, 0).unwrap_or_default(),
        line: Some(row.line),
        machine: text_at(row, 1),
        infeed_per_rev: number_at(row, 2).unwrap_or(f64::NAN),
        revolutions: number_at(row, 3).unwrap_or(f64::NAN),
        spark_out_revolutions: number_at(row, 4).unwrap_or(0.0),
        finish_infeed_per_rev: number_at(row, 17).unwrap_or(0.0),
        finish_revolutions: number_at(row, 18).unwrap_or(0.0),
        work_rotation_speed: number_at(row, 5),
        stock_removed: number_at(row, 6),
        normal_force: number_at(row, 7),
        tangential_force: number_at(row, 8),
        rise_revolutions: number_at(row, 9),
        force_after_spark_out: number_at(row, 10),
        force_trace: Vec::new(),
    }
}

const TRACE_COLUMNS: &[ColumnSpec] = &[
    text("trial_id", true),
    number("normal_force", "N", false),
    number("tangential_force", "N", false),
    number("revolution", "1", false),
    number("time", "s", false),
];

/// Reads recorded forces and gives them to their trials: `trial_id`, `normal_force [N]` or
/// `tangential_force [N]`, and `revolution` or, where the trial has a `work_rotation_speed`,
/// `time [s]`, both counted from the commanded start. Other signals with a line each are skipped
/// where the force is missing.
///
/// # Errors
/// [`TableError`] with every fault and its place.
///
/// ```
/// use toolroom_infeed::{Trial, read_force_traces};
/// let mut trials = [Trial { trial_id: "1".into(), ..Trial::default() }];
/// let csv = "trial_id,revolution,normal_force [N]\n1,1,76\n1,2,118\n";
/// read_force_traces("force.csv", csv.as_bytes(), &mut trials).unwrap();
/// assert_eq!(trials[0].force_trace[1].force, 118.0);
/// ```
pub fn read_force_traces(file: &str, bytes: &[u8], trials: &mut [Trial]) -> Result<Vec<TableNote>, TableError> {
    let (rows, notes) = read(file, bytes, TRACE_COLUMNS)?;
    let mut faults = Vec::new();
    let mut traces: Vec<Vec<ForceSample>> = trials.iter().map(|_| Vec::new()).collect();
    for row in &rows {
        let mut fault = |reason| faults.push(TableFault { line: row.line, column: 1, reason });
        let record = text_at(row, 0).unwrap_or_default();
        let Some(index) = trials.iter().position(|trial| trial.trial_id == record) else {
            fault(TableReason::NoSuchTrial { record });
            continue;
        };
        let Some(force) = number_at(row, 1).or(number_at(row, 2)) else { continue };
        let turned = |seconds: f64| Some(seconds * trials[index].work_rotation_speed? / TAU);
        match number_at(row, 3).or(number_at(row, 4).and_then(turned)) {
            Some(revolution) => traces[index].push(ForceSample { revolution, force }),
            None => fault(TableReason::Empty { name: "revolution" }),
        }
    }
    if !faults.is_empty() {
        return Err(TableError { file: file.to_owned(), faults });
    }
    for (trial, trace) in trials.iter_mut().zip(traces) {
        trial.force_trace.extend(trace);
        trial.force_trace.sort_by(|a, b| a.revolution.total_cmp(&b.revolution));
    }
    Ok(notes)
}
