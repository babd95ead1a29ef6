//! A cycle on the terminal.

use super::CycleDesign;
use std::fmt::Write;
use toolroom_infeed::Cycle;

const UM: f64 = 1e6;

/// Names of the phases of a cycle, in their order: an infeed of zero is spark-out, a single infeed
/// is rough.
pub(super) fn phase_names(cycle: &Cycle) -> Vec<&'static str> {
    let name = |(i, phase): (usize, &toolroom_infeed::CyclePhase)| match (i, phase.infeed_per_rev == 0.0) {
        (_, true) => "spark-out",
        (0, false) => "rough",
        (_, false) => "finish",
    };
    cycle.phases.iter().enumerate().map(name).collect()
}

impl CycleDesign {
    /// The cycle in a few lines.
    pub fn text(&self) -> String {
        let (cycle, limits) = (&self.cycle, &self.file.limits);
        let period = std::f64::consts::TAU / self.file.input.work_rotation_speed;
        let title = if self.file.title.is_empty() { &self.name } else { &self.file.title };
        let mut text = format!("{title}\n  {} revolutions, {:.3} s\n", cycle.revolutions, cycle.time);
        let wheel = if self.removed_volume > 0.0 {
            format!("a wheel that has removed {:.1} mm3/mm since dressing", self.removed_volume * UM)
        } else {
            "a dressed wheel".to_owned()
        };
        let _ = writeln!(text, "  designed for {wheel}");
        let _ = writeln!(text, "  {:10} {:>12} {:>12} {:>10} {:>12}", "phase", "infeed", "revolutions", "time", "feed");
        for (name, phase) in phase_names(cycle).into_iter().zip(&cycle.phases) {
            let _ = writeln!(
                text,
                "  {name:10} {:>12} {:>12} {:>10} {:>12}",
                format!("{:.4} um", phase.infeed_per_rev * UM),
                phase.revolutions,
                format!("{:.3} s", f64::from(phase.revolutions) * period),
                format!("{:.3} mm/min", phase.infeed_per_rev / period * 60e3),
            );
        }
        let mut row = |name: &str, value: f64, limit: f64, unit: &str, least: bool| {
            let words = if least { "at least" } else { "at most" };
            let _ = writeln!(text, "  {name:38} {value:>9.4} {unit:3} {words} {limit} {unit}");
        };
        row("size error", cycle.size_error * UM, rounded(limits.size_error * UM), "um", false);
        row("last depth", cycle.last_depth * UM, rounded(limits.last_depth * UM), "um", false);
        row("roundness error", cycle.roundness_error * UM, rounded(limits.roundness_error * UM), "um", false);
        row("stock after roughing", cycle.finish_stock * UM, rounded(limits.finish_stock * UM), "um", true);
        row("greatest temperature rise", cycle.peak_temperature_rise, limits.rough_temperature_rise, "K", false);
        let removal = rounded(limits.material_removal * UM);
        row("greatest removal rate, mm2/s", cycle.peak_removal_rate * UM, removal, "", false);
        let mut limited = |name: &str, value: String, limit: Option<String>| {
            let limit = limit.unwrap_or_else(|| "no limit".to_owned());
            let _ = writeln!(text, "  {name:38} {value:>9}     {limit}");
        };
        let most =
            |value: f64, none: f64, unit: &str| (value < none).then(|| format!("at most {} {unit}", rounded(value)));
        limited("greatest power, kW", format!("{:.4}", cycle.peak_power * 1e-3), most(limits.power * 1e-3, 1e3, "kW"));
        limited(
            "greatest normal force, N",
            format!("{:.2}", cycle.peak_normal_force),
            most(limits.normal_force, 1e6, "N"),
        );
        let margin = |value: f64| format!("{value:.4}");
        let least = (limits.burn_margin > -1e3).then(|| format!("at least {}", limits.burn_margin));
        limited("burn margin by temperature", margin(cycle.least_burn_margin), least.clone());
        if let Some(by_energy) = cycle.least_energy_margin {
            let binds = if self.binding_burn() == "specific_energy" { "; it binds" } else { "" };
            let least = least.map_or_else(|| format!("no limit{binds}"), |least| format!("{least}{binds}"));
            limited("burn margin by specific energy", margin(by_energy), Some(least));
        }
        if let Some(roughness) = cycle.roughness {
            limited("roughness Ra, um", format!("{:.4}", roughness * UM), most(limits.roughness * UM, 1e3, "um"));
        }
        if let Some([estimate, exact]) = &self.dressing {
            let edge = if exact.parts as usize == exact.course.len() { ", the most looked at" } else { "" };
            let _ = writeln!(
                text,
                "  dress after {} parts{edge}: {:.3} s a part with its share of the dressing ({} parts, {:.3} s by estimated cycles)",
                exact.parts, exact.time_per_part, estimate.parts, estimate.time_per_part
            );
        }
        if let Some((life, last)) = &self.wheel_life {
            let cycle = last.as_ref().map_or_else(
                || "no cycle keeps the limits then".to_owned(),
                |cycle| format!("the cycle then takes {} revolutions", cycle.revolutions),
            );
            let _ = writeln!(
                text,
                "  the wheel lasts {} dressings, {} parts: {:.1} um of radius each, down to {:.1} mm and {:.2} m/s; {cycle}",
                life.dressings,
                life.parts,
                life.lost * UM,
                life.diameter * 1e3,
                life.wheel_speed
            );
        }
        for warning in self.warnings() {
            let _ = writeln!(text, "  ! {warning}");
        }
        text.truncate(text.trim_end().len());
        text
    }
}

/// Without the rounding of a conversion.
fn rounded(value: f64) -> f64 {
    format!("{value:.9e}").parse().unwrap_or(value)
}
