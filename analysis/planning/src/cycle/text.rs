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
        if let Some([estimate, exact]) = &self.dressing {
            let edge = if exact.parts as usize == exact.course.len() { ", the most looked at" } else { "" };
            let _ = writeln!(
                text,
                "  dress after {} parts{edge}: {:.3} s a part with its share of the dressing ({} parts, {:.3} s by estimated cycles)",
                exact.parts, exact.time_per_part, estimate.parts, estimate.time_per_part
            );
        }
        if let Some(warning) = self.warning() {
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
