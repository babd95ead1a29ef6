//! The files of a cycle design.

use super::Design;
use super::picture::report;
use super::text::phase_names;
use crate::args::GrindArgs;
use crate::failure::Failure;
use crate::output::{OutputDir, provenance};
use serde_json::{Value, json};
use std::time::Duration;
use toolroom_infeed::{CyclePoint, DressingInterval};
use toolroom_process::table::Cell;

const UM: f64 = 1e6;

/// The files of a cycle design; the second one where dressing was asked for.
pub const NAMES: &[&str] = &["cycle.csv", "dressing.csv", "grind.json", "report.html"];

/// Writes `cycle.csv`, `dressing.csv` where it was asked for, `grind.json`, `report.html` and,
/// last, `run.json`.
pub fn write(out: &OutputDir, args: &GrindArgs, design: &Design, wall: Duration) -> Result<(), Failure> {
    let inputs = [(args.file.display().to_string(), design.text.as_bytes())];
    let changes = args.set.iter().flat_map(|change| ["--set".to_owned(), change.clone()]);
    let provenance = provenance("grind", &inputs, changes, None);
    course(out, design)?;
    if let Some(intervals) = &design.dressing {
        dressing(out, intervals)?;
    }
    out.put_json("grind.json", &summary(design))?;
    out.put("report.html", &report(design, provenance.clone()).html())?;
    out.record(&provenance, wall)
}

/// The result for programs.
pub fn summary(design: &Design) -> Value {
    let cycle = &design.cycle;
    let phases: Vec<Value> = phase_names(cycle)
        .into_iter()
        .zip(&cycle.phases)
        .map(|(name, phase)| {
            json!({
                "phase": name,
                "infeed_per_rev [um]": phase.infeed_per_rev * UM,
                "revolutions": phase.revolutions,
            })
        })
        .collect();
    let interval = |interval: &DressingInterval| {
        json!({
            "parts": interval.parts,
            "time_per_part [s]": interval.time_per_part,
            "cycle_time_of_first [s]": interval.cycle_times.first(),
            "cycle_time_of_last [s]": interval.cycle_times.get(interval.parts as usize - 1),
        })
    };
    json!({
        "schema": 1,
        "name": design.name,
        "title": design.file.title,
        "cycle": {
            "revolutions": cycle.revolutions,
            "time [s]": cycle.time,
            "phases": phases,
            "size_error [um]": cycle.size_error * UM,
            "last_depth [um]": cycle.last_depth * UM,
            "roundness_error [um]": cycle.roundness_error * UM,
            "finish_stock [um]": cycle.finish_stock * UM,
            "peak_temperature_rise [K]": cycle.peak_temperature_rise,
            "rough_depth_limit [um]": cycle.rough_depth_limit * UM,
            "finish_depth_limit [um]": cycle.finish_depth_limit * UM,
        },
        "broken_limits": design.broken(),
        "dressing": design.dressing.as_ref().map(|[estimate, exact]| json!({
            "exact_cycles": interval(exact),
            "estimated_cycles": interval(estimate),
        })),
    })
}

/// The cycle at the end of every revolution.
fn course(out: &OutputDir, design: &Design) -> Result<(), Failure> {
    let columns = [
        "revolution",
        "time [s]",
        "commanded_infeed [um]",
        "stock_removed [um]",
        "depth_of_cut [um]",
        "size_error [um]",
        "normal_force [N]",
        "temperature_rise [K]",
    ];
    let row = |(revolution, point): (usize, &CyclePoint)| -> [Cell<'_>; 8] {
        [
            revolution.into(),
            point.time.into(),
            (point.commanded_infeed * UM).into(),
            (point.stock_removed * UM).into(),
            (point.depth_of_cut * UM).into(),
            (point.size_error * UM).into(),
            point.normal_force.into(),
            point.temperature_rise.into(),
        ]
    };
    out.put_table("cycle.csv", columns, design.cycle.course.iter().enumerate().map(row))
}

/// Mean time of a part by the number of parts between dressings.
fn dressing(out: &OutputDir, [estimate, exact]: &[DressingInterval; 2]) -> Result<(), Failure> {
    let columns =
        ["parts", "cycle_time [s]", "time_per_part [s]", "estimated_cycle_time [s]", "estimated_time_per_part [s]"];
    let cell = |values: &[f64], i: usize| values.get(i).copied().into();
    let row = |i: usize| -> [Cell<'_>; 5] {
        [
            (i + 1).into(),
            cell(&exact.cycle_times, i),
            cell(&exact.course, i),
            cell(&estimate.cycle_times, i),
            cell(&estimate.course, i),
        ]
    };
    out.put_table("dressing.csv", columns, (0..exact.course.len().max(estimate.course.len())).map(row))
}
