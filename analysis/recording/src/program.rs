//! Runs of part programs, stretch by stretch, as the log of a machine would time them.

use crate::Run;
use toolroom_records::{RecordKind, Records};
use toolroom_scenario::{TimedStretch, Work};

/// One stretch of one run of a program.
struct Row<'a> {
    visit: usize,
    index: usize,
    stretch: &'a TimedStretch,
    start: f64,
    /// s.
    time: f64,
}

/// One row a stretch of every program that ran from its beginning to its end with the same edges.
///
/// The machine takes the times of the program; time that the shop adds beyond its passes, such as holds, is in the events of
/// the machine.
pub fn stretches(run: &Run<'_>) -> Records {
    let mut rows: Vec<Row<'_>> = Vec::new();
    for (visit, stay) in run.visits.list.iter().enumerate() {
        let operation = &run.scenario.parts[stay.part as usize].operations[stay.operation as usize];
        let Work::Program(work) = &operation.work else { continue };
        let passes = stay.passes.iter().map(|pass| &run.log.passes[*pass]);
        let cut: f64 = passes.clone().map(|pass| pass.cutting_time).sum();
        // A run that was broken off, or in which an edge was lost, is not complete.
        if stay.passes.len() != work.calls.len() || (cut / work.time() - 1.0).abs() > 1e-6 {
            continue;
        }
        let mut start = passes.map(|pass| pass.start).fold(f64::INFINITY, f64::min);
        for (index, stretch) in work.stretches.iter().enumerate() {
            rows.push(Row { visit, index, stretch, start, time: stretch.time });
            start += stretch.time;
        }
    }
    rows.sort_by(|a, b| a.start.total_cmp(&b.start));
    let mut records = Records::new(RecordKind::Program, rows.len());
    let visit = |row: &Row<'_>| &run.visits.list[row.visit];
    let first_pass = |row: &Row<'_>| &run.log.passes[visit(row).passes[0]];
    let mut texts =
        |name: &str, of: &dyn Fn(&Row<'_>) -> String| records.set_texts(name, rows.iter().map(of).collect());
    texts("operation_id", &|row| run.operation_id(visit(row).job, visit(row).part, visit(row).operation));
    texts("machine", &|row| run.machine(first_pass(row).machine));
    texts("program", &|row| run.program(visit(row).part, visit(row).operation));
    texts("tool_id", &|row| row.stretch.tool.map_or(String::new(), |tool| format!("T{tool}")));
    let section = |row: &Row<'_>| row.stretch.tool.map_or("no tool".to_owned(), |tool| format!("T{tool}"));
    texts("section", &|row| format!("{} {}", run.program(visit(row).part, visit(row).operation), section(row)));
    texts("override_source", &|_| "event".to_owned());
    let mut numbers =
        |name: &str, of: &dyn Fn(&Row<'_>) -> f64| records.set_numbers(name, rows.iter().map(of).collect());
    numbers("sequence", &|row| row.index as f64 + 1.0);
    numbers("first_block", &|row| row.stretch.lines.0 as f64);
    numbers("last_block", &|row| row.stretch.lines.1 as f64);
    numbers("start_time", &|row| row.start);
    numbers("feed_override", &|_| 1.0);
    numbers("tool_changes", &|row| row.stretch.changes as f64);
    numbers("hold_count", &|_| 0.0);
    numbers("hold_time", &|_| 0.0);
    let times: Vec<f64> = rows.iter().map(|row| row.time).collect();
    run.channel(&mut records, "cycle_time", &times);
    // However coarse a log is, a stretch ends no sooner than it begins.
    let read = records.numbers("cycle_time").map(|times| times.iter().map(|time| time.max(0.0)).collect());
    if let Some(times) = read {
        records.set_numbers("cycle_time", times);
    }
    records
}
