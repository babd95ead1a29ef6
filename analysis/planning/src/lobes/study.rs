//! A chart worked out: boundaries, verdicts over the grid and at operating points, and what is missing of them.

use super::cut::with_unit;
use super::{Best, ChartMap, Curve, Judged, Limited, LobesFile, MeasuredCurve, Point, boundaries};
use toolroom_chatter::{ChatterError, Hole, Lobes, RobustSpeed};

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
    /// Speeds at which the limits of the file are worked out.
    pub speeds: Vec<f64>,
    /// Depths up to which each limit of the file is kept, at these speeds; infinite where it is kept on the whole chart.
    pub limits: Vec<(Limited, Vec<f64>)>,
    /// Quantities over the chart that were requested.
    pub maps: Vec<ChartMap>,
    /// The point of greatest removal rate, where it was asked for.
    pub best: Option<Best>,
    /// Speeds of the chart with the probability that a depth is stable there, where they were requested.
    pub robust: Vec<RobustSpeed>,
    /// Limits straight from a measured response, where it was given.
    pub measured: Option<MeasuredCurve>,
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
        let speeds = chart.speed.values("speed")?;
        let limits = file.limit_depths(&speeds)?;
        Ok(Self {
            file,
            curves,
            grid,
            judgements,
            speeds,
            limits,
            maps: Vec::new(),
            best: None,
            robust: Vec::new(),
            measured: None,
        })
    }

    /// The first limit of stability at other speeds between those where it was worked out, on a straight line; not a number
    /// where the chart has none.
    pub fn limits_at(&self, speeds: &[f64]) -> Vec<f64> {
        let Some(curve) = self.curves.first() else { return vec![f64::NAN; speeds.len()] };
        let at = |speed: &f64| {
            let right = curve.limit.partition_point(|(known, _)| *known < speed * (1.0 - 1e-12));
            let (Some(after), before) = (curve.limit.get(right), right.checked_sub(1).map(|i| curve.limit[i])) else {
                return f64::NAN;
            };
            match before {
                Some(before) if after.0 > speed * (1.0 + 1e-12) => {
                    before.1 + (speed - before.0) / (after.0 - before.0) * (after.1 - before.1)
                }
                Some(_) | None => after.1,
            }
        };
        speeds.iter().map(at).collect()
    }

    /// `values`, all depths of the first speed first, where the cut is stable; elsewhere not a number.
    pub(super) fn where_stable(&self, speeds: &[f64], depths: &[f64], mut values: Vec<f64>) -> Vec<f64> {
        let limits = self.limits_at(speeds);
        for (i, column) in values.chunks_mut(depths.len()).enumerate() {
            for (j, value) in column.iter_mut().enumerate() {
                let stable = match &self.grid {
                    Some(grid) => grid.at(i, j).is_some_and(|verdict| verdict.stable),
                    // Without the grid up to the first limit, which is all that the chart knows for certain.
                    None => limits[i].is_nan() || depths[j] < limits[i],
                };
                if !stable {
                    *value = f64::NAN;
                }
            }
        }
        values
    }

    /// How far the limits of a measured response are from those of the modes, in words.
    pub fn beside_measured(&self) -> Option<String> {
        let measured = self.measured.as_ref()?;
        let axes = self.file.cut.axes();
        Some(match (measured.greatest, measured.median) {
            (Some((speed, difference)), Some(median)) => format!(
                "limits of the modes differ from those of the measured response by {:.1} % in the median and by {:+.1} % at most, at {}",
                median * 100.0,
                difference * 100.0,
                with_unit(&axes.speed, speed)
            ),
            _ => "the measured response has no limit on the chart that could be compared".to_owned(),
        })
    }

    /// What the chart lacks, a sentence each: points, limits and operating points for which the search failed.
    pub fn holes(&self) -> Vec<String> {
        let file = self.file;
        let axes = file.cut.axes();
        let mut lines = Vec::new();
        if let Some(grid) = &self.grid
            && let Some(Hole { speed, depth, reason }) = grid.holes.first()
        {
            let (count, all) = (grid.holes.len(), grid.verdicts.len());
            let (speed, depth) = (with_unit(&axes.speed, *speed), with_unit(&axes.depth, *depth));
            lines.push(format!(
                "{count} of {all} points have no verdict and are holes in the chart, first {speed}, {depth}: {reason}"
            ));
        }
        for curve in &self.curves {
            if let Some((speed, reason)) = curve.holes.first() {
                let (count, all, label) = (curve.holes.len(), curve.limit.len(), &curve.label);
                let speed = with_unit(&axes.speed, *speed);
                lines.push(format!("{label}: not found at {count} of {all} speeds, first {speed}: {reason}"));
            }
        }
        for (point, judged) in file.points.iter().zip(&self.judgements) {
            if let Err(error) = judged {
                lines.push(format!("operating point \"{}\" has no verdict: {error}", point.name));
            }
        }
        lines
    }
}
