//! The schedule of a run in the form in which another run follows it, and how far runs come off the schedule that they follow.

use super::{Figures, stamped};
use crate::study::Study;
use serde_json::{Value, json};
use std::io;
use toolroom_numerics::rank_quantile;
use toolroom_process::table::{Cell, CsvWriter};
use toolroom_scenario::{PlannedOperation, Scenario};
use toolroom_shop::runlog::RunLog;

/// The sequences of a run, which `--schedule` reads.
pub const SEQUENCES: &str = "schedule.csv";
/// Planned against simulated starts.
pub const PLAN: &str = "plan.csv";

/// Writes every operation of an order that a run has begun, by machine in the order of their starts; pieces of an order that
/// follow each other are one.
///
/// # Errors
/// What the writer says.
pub fn write_sequences(scenario: &Scenario, log: &RunLog, out: impl io::Write) -> io::Result<()> {
    let mut csv = CsvWriter::new(out, ["order", "operation", "machine", "position", "start", "end"])?;
    for (index, machine) in scenario.machines.iter().enumerate() {
        let of_machine = |row: &&toolroom_shop::runlog::OperationRow| row.machine as usize == index;
        let mut rows: Vec<_> = log.operations.iter().filter(of_machine).collect();
        rows.sort_by(|a, b| a.start.total_cmp(&b.start));
        let mut sequence: Vec<(u32, u32, u32, f64, f64)> = Vec::new();
        for row in rows {
            let Some(order) = log.jobs[row.job as usize].order else { continue };
            match sequence.iter_mut().find(|(known, operation, ..)| (*known, *operation) == (order, row.operation)) {
                Some((.., end)) => *end = row.end,
                None => sequence.push((order, row.operation, row.part, row.start, row.end)),
            }
        }
        for (position, &(order, operation, part, start, end)) in (1u64..).zip(&sequence) {
            csv.row([
                (&scenario.orders[order as usize].id).into(),
                (&scenario.parts[part as usize].operations[operation as usize].name).into(),
                (&machine.name).into(),
                position.into(),
                stamped(scenario, start).into(),
                stamped(scenario, end).into(),
            ])?;
        }
    }
    Ok(csv.flush()?)
}

/// A planned operation and when it began in the replications, in ascending order, s; those in which it did not begin are
/// left out.
struct Begun<'a> {
    machine: usize,
    position: usize,
    planned: &'a PlannedOperation,
    starts: Vec<f64>,
}

impl Begun<'_> {
    /// Deviations from the planned start, s; empty where the schedule says none.
    fn deviations(&self) -> Vec<f64> {
        let planned = self.planned.start.or(Some(self.planned.not_before).filter(|time| *time > 0.0));
        planned.map_or(Vec::new(), |planned| self.starts.iter().map(|start| start - planned).collect())
    }
}

fn begun<'a>(scenario: &'a Scenario, study: &Study, position: usize) -> Vec<Begun<'a>> {
    let Some(schedule) = &scenario.control.schedule else { return Vec::new() };
    let figures = Figures::of(scenario);
    let runs: Vec<Vec<f64>> = study.planner_figures(position).collect();
    let planned_row = |(number, (machine, position, planned)): (usize, (usize, usize, &'a PlannedOperation))| {
        let mut starts: Vec<f64> =
            runs.iter().map(|run| run[figures.start(number)]).filter(|own| !own.is_nan()).collect();
        starts.sort_by(f64::total_cmp);
        Begun { machine, position: position + 1, planned, starts }
    };
    schedule.operations().enumerate().map(planned_row).collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn minutes(seconds: f64) -> Cell<'static> {
    if seconds.is_finite() { (seconds / 60.0).into() } else { Cell::Empty }
}

/// Writes every operation of the schedule with its planned and its simulated start, under every policy.
///
/// # Errors
/// What the writer says.
pub fn write_plan(scenario: &Scenario, study: &Study, out: impl io::Write) -> io::Result<()> {
    let header = [
        "policy",
        "order",
        "operation",
        "machine",
        "position",
        "planned_start",
        "start_mean",
        "start_p10",
        "start_p90",
        "deviation_mean [min]",
        "deviation_p90 [min]",
        "not_begun",
    ];
    let mut csv = CsvWriter::new(out, header)?;
    for (place, &policy) in study.policies.iter().enumerate() {
        for running in begun(scenario, study, place) {
            let (order, starts) = (&scenario.orders[running.planned.order], &running.starts);
            let deviations = running.deviations();
            let planned = running.planned.start.unwrap_or(running.planned.not_before);
            csv.row([
                (&scenario.policies[policy].name).into(),
                (&order.id).into(),
                (&scenario.parts[order.part].operations[running.planned.operation].name).into(),
                (&scenario.machines[running.machine].name).into(),
                running.position.into(),
                if deviations.is_empty() { Cell::Empty } else { stamped(scenario, planned).into() },
                stamped(scenario, mean(starts)).into(),
                stamped(scenario, rank_quantile(starts, 0.1)).into(),
                stamped(scenario, rank_quantile(starts, 0.9)).into(),
                minutes(mean(&deviations)),
                minutes(rank_quantile(&deviations, 0.9)),
                (study.replications as usize - starts.len()).into(),
            ])?;
        }
    }
    Ok(csv.flush()?)
}

/// How far the starts of all operations come off the schedule, s: mean, and the quantile of 90 %; with their number.
fn robustness(scenario: &Scenario, study: &Study) -> Option<(usize, f64, f64)> {
    scenario.control.schedule.as_ref()?;
    let all = begun(scenario, study, 0);
    let mut deviations: Vec<f64> = all.iter().flat_map(Begun::deviations).collect();
    deviations.sort_by(f64::total_cmp);
    Some((all.len(), mean(&deviations), rank_quantile(&deviations, 0.9)))
}

/// The same for programs.
pub fn plan_json(scenario: &Scenario, study: &Study) -> Option<Value> {
    let (count, mean, high) = robustness(scenario, study)?;
    let number = |seconds: f64| seconds.is_finite().then_some(seconds / 60.0);
    let deviation = json!({ "mean [min]": number(mean), "p90 [min]": number(high) });
    Some(json!({ "operations": count, "deviation": deviation }))
}

/// The same for a terminal; empty where no schedule is followed.
pub fn plan_line(scenario: &Scenario, study: &Study) -> String {
    let Some((count, mean, high)) = robustness(scenario, study) else { return String::new() };
    if mean.is_nan() {
        return format!("\n{count} operations follow the schedule, which says no starts\n");
    }
    let (mean, high) = (mean / 60.0, high / 60.0);
    format!(
        "\n{count} operations follow the schedule; they begin {mean:.1} min after their planned start on average, 90 % of them within {high:.1} min: {PLAN}\n"
    )
}
