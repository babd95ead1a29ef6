//! The limit straight from a measured response beside that of the modes, over the speeds of a chart.

use super::{ChartStudy, Cut, MeasuredCurve};
use rayon::prelude::*;
use std::borrow::Cow;
use toolroom_dynamics::Measurement;
use toolroom_modes::{MeasuredError, SpeedStudy, measured_limit, measured_milling_limit};

/// Speeds of a chart at which the measured response is asked, at most, in turning and in milling (assumptions: a limit of
/// milling costs some two seconds).
const COLUMNS: [usize; 2] = [61, 17];

/// A measured response, at rest or at several spindle speeds.
#[derive(Debug)]
pub enum Measured {
    /// One for all speeds.
    AtRest(Measurement),
    /// At several speeds; between them the poles are followed.
    BySpeed(SpeedStudy),
}

impl Measured {
    /// The response at a spindle speed (rad/s).
    ///
    /// # Errors
    /// [`MeasuredError::Speeds`] outside the speeds of a table.
    pub fn at(&self, speed: f64) -> Result<Cow<'_, Measurement>, MeasuredError> {
        Ok(match self {
            Self::AtRest(measured) => Cow::Borrowed(measured),
            Self::BySpeed(study) => Cow::Owned(study.at(speed)?),
        })
    }
}

impl MeasuredCurve {
    /// Works out the limits beside those of `study`.
    ///
    /// # Errors
    /// [`MeasuredError`]: a cut that is none at constant speed, a missing function, no clear lines, a speed at which nobody
    /// measured.
    pub fn new(study: &ChartStudy<'_>, measured: &Measured) -> Result<Self, MeasuredError> {
        let depth = study.file.chart.depth.end;
        let columns = COLUMNS[usize::from(matches!(study.file.cut, Cut::Milling(..)))];
        let step = study.speeds.len().div_ceil(columns).max(1);
        let speeds: Vec<f64> = study.speeds.iter().copied().step_by(step).collect();
        let limit = |speed: &f64| {
            let response = measured.at(*speed)?;
            let found = match &study.file.cut {
                Cut::Turning(cut, None) => measured_limit(&response, cut, *speed)?,
                Cut::Milling(cut, None) => measured_milling_limit(&response, cut, *speed, depth)?,
                Cut::Milling(..) | Cut::Turning(..) | Cut::Chuck(_) | Cut::ChipLag(_) | Cut::Lathe(_) => {
                    return Err(MeasuredError::Process);
                }
            };
            Ok((*speed, found.map(|limit| limit.depth).filter(|limit| *limit <= depth).unwrap_or(f64::NAN)))
        };
        let limits: Vec<(f64, f64)> = speeds.par_iter().map(limit).collect::<Result<_, MeasuredError>>()?;
        let modal = study.limits_at(&speeds);
        let both = limits.iter().zip(&modal).map(|((speed, limit), modal)| (*speed, modal / limit - 1.0));
        let differences: Vec<(f64, f64)> = both.filter(|(_, difference)| difference.is_finite()).collect();
        let greatest = differences.iter().copied().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
        let mut sizes: Vec<f64> = differences.iter().map(|(_, difference)| difference.abs()).collect();
        sizes.sort_by(f64::total_cmp);
        let median = sizes.get(sizes.len() / 2).copied();
        Ok(Self { limits, greatest, median })
    }
}
