//! Speeds of a chart by the probability that a depth is stable there.

use super::cut::{Cut, with_unit};
use super::{ChartStudy, LobesFile};
use std::fmt::Write;
use toolroom_chart::Table;
use toolroom_chatter::{ChatterError, RobustSpeed, Scatter};

/// Samples behind each probability: the standard error is 3.6 % at most.
const SAMPLES: u64 = 200;
/// Seed of these samples.
const SEED: u64 = 1;
/// Speeds that are reported.
const TOLD: usize = 5;

/// Scatter where neither file says one: 0.5 % in frequency, 10 % in damping, 15 % in coefficients and stiffness
/// (assumption, what is usual between two mountings and for coefficients of a table).
pub const ASSUMED_SCATTER: Scatter = Scatter { natural_frequency: 0.005, damping_ratio: 0.1, coefficients: 0.15 };

impl LobesFile {
    /// Speeds of the chart, the most probably stable at `depth` (m) first; empty of cuts other than milling and turning at
    /// constant speed.
    ///
    /// # Errors
    /// [`ChatterError`] where the model refuses a value, or finds no result.
    pub fn robust_speeds(&self, depth: f64) -> Result<Vec<RobustSpeed>, ChatterError> {
        let scatter = self.scatter.unwrap_or(ASSUMED_SCATTER);
        match &self.cut {
            Cut::Milling(cut, None) => cut.robust_speeds(&self.chart.speed, depth, &scatter, SAMPLES, SEED),
            Cut::Turning(cut, None) => cut.robust_speeds(&self.chart.speed, depth, &scatter, SAMPLES, SEED),
            Cut::Milling(..) | Cut::Turning(..) | Cut::Chuck(_) | Cut::ChipLag(_) | Cut::Lathe(_) => Ok(Vec::new()),
        }
    }
}

/// The first of the robust speeds as lines of a terminal.
pub(super) fn robust_text(study: &ChartStudy<'_>) -> String {
    let axes = study.file.cut.axes();
    let mut text = String::new();
    for (i, robust) in study.robust.iter().take(TOLD).enumerate() {
        let word = if i == 0 { "robust speeds" } else { "" };
        let speed = with_unit(&axes.speed, robust.spindle_speed);
        let (value, error) = (robust.probability.value, robust.probability.standard_error);
        let _ = writeln!(text, "  {word:20} {speed:>16}  P(stable) {value:.3} ± {error:.3}");
    }
    text
}

/// The robust speeds as a table of the report.
pub(super) fn robust_table(study: &ChartStudy<'_>) -> Table {
    let axes = study.file.cut.axes();
    let mut table = Table::new(["spindle speed [rpm]", "P(stable)", "standard error"]);
    for robust in study.robust.iter().take(TOLD) {
        table.push([
            axes.speed.shown(robust.spindle_speed).into(),
            robust.probability.value.into(),
            robust.probability.standard_error.into(),
        ]);
    }
    table
}
