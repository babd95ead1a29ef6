//! A chart worked out: boundaries, verdicts over the grid and at operating points, and what is missing of them.

use super::{Curve, Judged, LobesFile, Point, Quantity, boundaries};
use toolroom_chatter::{ChatterError, Hole, Lobes};
use toolroom_form::significant;

/// A chart worked out.
pub struct ChartStudy<'a> {
    /// What was asked.
    pub file: &'a LobesFile,
    /// The boundaries of stability.
    pub curves: Vec<Curve>,
    /// The grid of verdicts, unless only the boundary was wanted.
    pub grid: Option<Lobes>,
    /// One for each operating point of the file.
    pub judgements: Vec<Judged>,
}

impl<'a> ChartStudy<'a> {
    /// Works out boundaries and operating points beside `grid`, whose columns may come from shards.
    ///
    /// # Errors
    /// [`ChatterError`] where the model refuses a value; a search that fails is a hole of the chart instead.
    pub fn new(file: &'a LobesFile, grid: Option<Lobes>) -> Result<Self, ChatterError> {
        let LobesFile { cut, chart, points, .. } = file;
        let judge = |point: &Point| match cut.judge(point.speed, point.depth, chart) {
            Err(error) if !error.is_failed_search() => Err(error),
            judged => Ok(judged),
        };
        let judgements = points.iter().map(judge).collect::<Result<Vec<_>, _>>()?;
        let curves = boundaries(cut, chart)?;
        Ok(Self { file, curves, grid, judgements })
    }

    /// What the chart lacks, a sentence each: points, limits and operating points for which the search failed.
    pub fn holes(&self) -> Vec<String> {
        let file = self.file;
        let axes = file.cut.axes();
        let mut told = Vec::new();
        if let Some(grid) = &self.grid
            && let Some(Hole { speed, depth, reason }) = grid.holes.first()
        {
            let (count, all) = (grid.holes.len(), grid.verdicts.len());
            let (speed, depth) = (with_unit(&axes.speed, *speed), with_unit(&axes.depth, *depth));
            told.push(format!(
                "{count} of {all} points have no verdict and are holes in the chart, first {speed}, {depth}: {reason}"
            ));
        }
        for curve in &self.curves {
            if let Some((speed, reason)) = curve.holes.first() {
                let (count, all, label) = (curve.holes.len(), curve.limit.len(), &curve.label);
                let speed = with_unit(&axes.speed, *speed);
                told.push(format!("{label}: not found at {count} of {all} speeds, first {speed}: {reason}"));
            }
        }
        for (point, judged) in file.points.iter().zip(&self.judgements) {
            if let Err(error) = judged {
                told.push(format!("operating point \"{}\" has no verdict: {error}", point.name));
            }
        }
        told
    }
}

/// A quantity for people, to four decimals.
pub(super) fn with_unit(quantity: &Quantity, value: f64) -> String {
    let number = significant((quantity.shown(value) * 1e4).round() / 1e4);
    if quantity.unit == "1" { number } else { format!("{number} {}", quantity.unit) }
}
