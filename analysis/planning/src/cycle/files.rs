//! The files of a cycle design.

use super::CycleDesign;
use super::picture::report;
use super::text::phase_names;
use crate::tables::table;
use serde_json::{Value, json};
use toolroom_chart::ResultFiles;
use toolroom_chart::page::Provenance;
use toolroom_infeed::{CyclePoint, DressingInterval};
use toolroom_process::table::Cell;

const UM: f64 = 1e6;
const MM2: f64 = 1e6;

impl CycleDesign {
    /// `cycle.csv`, `dressing.csv` where the file describes dressing, `grind.json` and `report.html`.
    pub fn files(&self, provenance: Provenance) -> ResultFiles {
        let mut files = ResultFiles::default();
        files.push("cycle.csv", course(self));
        if let Some(intervals) = &self.dressing {
            files.push("dressing.csv", dressing(intervals));
        }
        files.push("grind.json", format!("{:#}\n", self.summary()));
        files.push("report.html", report(self, provenance).html());
        files
    }

    /// The result for programs.
    pub fn summary(&self) -> Value {
        let cycle = &self.cycle;
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
            "name": self.name,
            "title": self.file.title,
            "cycle": {
                "revolutions": cycle.revolutions,
                "time [s]": cycle.time,
                "phases": phases,
                "size_error [um]": cycle.size_error * UM,
                "last_depth [um]": cycle.last_depth * UM,
                "roundness_error [um]": cycle.roundness_error * UM,
                "finish_stock [um]": cycle.finish_stock * UM,
                "peak_temperature_rise [K]": cycle.peak_temperature_rise,
                "peak_power [W]": cycle.peak_power,
                "peak_normal_force [N]": cycle.peak_normal_force,
                "peak_removal_rate [mm2/s]": cycle.peak_removal_rate * MM2,
                "burn_margin_by_temperature": cycle.least_burn_margin,
                "burn_margin_by_specific_energy": cycle.least_energy_margin,
                "burn_margin_binding": self.binding_burn(),
                "roughness [um]": cycle.roughness.map(|roughness| roughness * UM),
                "wheel_removed_volume [mm3/mm]": self.removed_volume * MM2,
                "rough_depth_limit [um]": cycle.rough_depth_limit * UM,
                "finish_depth_limit [um]": cycle.finish_depth_limit * UM,
            },
            "broken_limits": self.broken(),
            "dressing": self.dressing.as_ref().map(|[estimate, exact]| json!({
                "exact_cycles": interval(exact),
                "estimated_cycles": interval(estimate),
                "overlap": self.file.dressing.map(|plan| plan.overlap()),
                "wheel": self.wheel_life.as_ref().map(|(life, last)| json!({
                    "radius_lost_per_dressing [um]": life.lost * UM,
                    "dressings": life.dressings,
                    "parts": life.parts,
                    "last_diameter [mm]": life.diameter * 1e3,
                    "last_wheel_speed [m/s]": life.wheel_speed,
                    "last_cycle_revolutions": last.as_ref().map(|cycle| cycle.revolutions),
                })),
            })),
            "roughness_constant": self.file.surface.map(|surface| {
                surface.constant(self.file.grinding.parameters.wheel_speed)
            }),
            "warnings": self.warnings(),
        })
    }
}

/// The cycle at the end of every revolution.
fn course(design: &CycleDesign) -> String {
    let columns = [
        "revolution",
        "time [s]",
        "commanded_infeed [um]",
        "stock_removed [um]",
        "depth_of_cut [um]",
        "size_error [um]",
        "normal_force [N]",
        "temperature_rise [K]",
        "tangential_force [N]",
        "power [W]",
        "removal_rate [mm2/s]",
        "specific_energy [J/mm3]",
        "burn_energy [J/mm3]",
        "equivalent_chip_thickness [um]",
        "contact_length [mm]",
        "wheel_removed_volume [mm3/mm]",
    ];
    let row = |(revolution, point): (usize, &CyclePoint)| -> [Cell<'_>; 16] {
        let load = &point.load;
        [
            revolution.into(),
            point.time.into(),
            (point.commanded_infeed * UM).into(),
            (point.stock_removed * UM).into(),
            (point.depth_of_cut * UM).into(),
            (point.size_error * UM).into(),
            load.normal_force.into(),
            load.temperature_rise.into(),
            load.tangential_force.into(),
            load.power.into(),
            (load.removal_rate * MM2).into(),
            (load.specific_energy * 1e-9).into(),
            load.burn_energy.map(|energy| energy * 1e-9).into(),
            (load.equivalent_chip_thickness * UM).into(),
            (load.contact_length * 1e3).into(),
            (point.removed_volume * MM2).into(),
        ]
    };
    table(columns, design.cycle.course.iter().enumerate().map(row))
}

/// Mean time of a part by the number of parts between dressings.
fn dressing([estimate, exact]: &[DressingInterval; 2]) -> String {
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
    table(columns, (0..exact.course.len().max(estimate.course.len())).map(row))
}
