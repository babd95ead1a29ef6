//! Charts: verdicts over a grid, in parallel, and the boundary alone.

use crate::error::ChatterError;
use crate::paper::{FiveDegrees, Reduced};
use crate::turning::TurningAtSpeed;
use crate::verdict::{ChatterKind, StabilityVerdict};
use crate::{Milling, SpeedVariation, Turning};
use rayon::prelude::*;
use std::borrow::Cow;

/// A point of a chart without verdict.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Hole {
    /// Its place on the first axis.
    pub speed: f64,
    /// Its place on the second axis.
    pub depth: f64,
    /// Why no verdict was found.
    pub reason: String,
}

/// A stability chart as plain data.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Lobes {
    /// Spindle speeds (rad/s), or speed ratios in the chart of a chuck.
    pub speed: Vec<f64>,
    /// Depths or widths of cut (m), or modulations in the chart of a chuck.
    pub depth: Vec<f64>,
    /// One verdict a point, all depths of the first speed first; none where the search for it failed.
    pub verdicts: Vec<Option<StabilityVerdict>>,
    /// The points without verdict, in the order of the verdicts.
    pub holes: Vec<Hole>,
}

impl Lobes {
    /// The verdict at speed number `i` and depth number `j`, where there is one.
    pub fn at(&self, i: usize, j: usize) -> Option<&StabilityVerdict> {
        if j < self.depth.len() { self.verdicts.get(i * self.depth.len() + j)?.as_ref() } else { None }
    }

    /// Fills a chart column by column in parallel. A verdict depends on its point alone, neither on
    /// the threads nor on the columns beside it, so that a chart can be filled in parts. A point at which the
    /// search for a verdict fails is a hole and costs no other point.
    fn fill<F, C>(speed: &[f64], depth: &[f64], column: F) -> Result<Self, ChatterError>
    where
        F: Fn(f64) -> Result<C, ChatterError> + Sync,
        C: FnMut(f64) -> Result<StabilityVerdict, ChatterError>,
    {
        type Outcome = Result<StabilityVerdict, ChatterError>;
        // A question that is refused is refused for the whole chart.
        let point = |outcome: Outcome| match outcome {
            Err(error) if !error.is_failed_search() => Err(error),
            outcome => Ok(outcome),
        };
        let columns: Result<Vec<Vec<Outcome>>, ChatterError> = speed
            .par_iter()
            .map(|speed| match column(*speed) {
                Ok(mut verdict) => depth.iter().map(|depth| point(verdict(*depth))).collect(),
                Err(error) => depth.iter().map(|_| point(Err(error))).collect(),
            })
            .collect();
        let mut lobes = Self { speed: speed.to_vec(), depth: depth.to_vec(), verdicts: Vec::new(), holes: Vec::new() };
        for (speed, column) in speed.iter().zip(columns?) {
            for (depth, outcome) in depth.iter().zip(column) {
                if let Err(error) = &outcome {
                    lobes.holes.push(Hole { speed: *speed, depth: *depth, reason: error.to_string() });
                }
                lobes.verdicts.push(outcome.ok());
            }
        }
        Ok(lobes)
    }
}

impl Milling {
    /// Verdicts over spindle speeds (rad/s) and depths (m), in parallel.
    ///
    /// # Errors
    /// As [`Milling::verdict`].
    pub fn lobes(&self, speed: &[f64], depth: &[f64]) -> Result<Lobes, ChatterError> {
        let greatest = depth.iter().copied().fold(0.0, f64::max);
        Lobes::fill(speed, depth, |speed| {
            let mut at_speed = self.at_speed(speed)?.up_to(greatest);
            Ok(move |depth| at_speed.screen(depth))
        })
    }

    /// [`Milling::lobes`] at speeds that vary about `speed`.
    ///
    /// # Errors
    /// As [`Milling::verdict`]; a variation out of range.
    pub fn lobes_at_varying_speed(
        &self,
        speed: &[f64],
        variation: SpeedVariation,
        depth: &[f64],
    ) -> Result<Lobes, ChatterError> {
        let greatest = depth.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        Lobes::fill(speed, depth, |speed| {
            let mut at_speed = self.at_varying_speed(speed, variation)?.at_worst_limit(greatest)?;
            Ok(move |depth| at_speed.screen(depth))
        })
    }
}

impl Turning {
    /// Verdicts over spindle speeds (rad/s) and widths (m), in parallel.
    ///
    /// # Errors
    /// As [`Turning::verdict`].
    pub fn lobe_chart(&self, speed: &[f64], width: &[f64]) -> Result<Lobes, ChatterError> {
        let greatest = width.iter().copied().fold(0.0, f64::max);
        Lobes::fill(speed, width, |speed| {
            let places: Result<Vec<_>, ChatterError> = self
                .places()
                .into_iter()
                .map(|(_, cut)| TurningAtSpeed::new(Cow::Owned(cut), speed, greatest))
                .collect();
            let places = places?;
            Ok(move |width| {
                let verdicts = places.iter().map(|place| place.verdict(width)).collect::<Result<Vec<_>, _>>()?;
                crate::path::worst(verdicts).ok_or(ChatterError::NoModes)
            })
        })
    }

    /// [`Turning::lobe_chart`] at speeds that vary about `speed`.
    ///
    /// # Errors
    /// As [`Turning::verdict_at_varying_speed`].
    pub fn lobe_chart_at_varying_speed(
        &self,
        speed: &[f64],
        variation: SpeedVariation,
        width: &[f64],
    ) -> Result<Lobes, ChatterError> {
        Lobes::fill(speed, width, |speed| Ok(move |width| self.verdict_at_varying_speed(speed, variation, width)))
    }
}

impl Reduced {
    /// Verdicts over speed ratios `eta` and modulations `mu` (the paper's Fig. 3), in parallel.
    ///
    /// # Errors
    /// As [`Reduced::verdict`].
    pub fn lobes(&self, speed_ratio: &[f64], modulation: &[f64]) -> Result<Lobes, ChatterError> {
        Lobes::fill(speed_ratio, modulation, |eta| Ok(move |mu| self.verdict(mu, eta)))
    }

    /// Verdicts without modulation over lags (s) and cutting stiffnesses (N/m) (the paper's
    /// Fig. 2), in parallel, each over a natural period; the boundary is
    /// [`Reduced::cutting_stiffness_limit`].
    ///
    /// # Errors
    /// As [`Reduced::verdict`].
    pub fn stability_region(&self, lag: &[f64], cutting_stiffness: &[f64]) -> Result<Lobes, ChatterError> {
        Lobes::fill(lag, cutting_stiffness, |lag| {
            Ok(move |cutting_stiffness| Self { lag, cutting_stiffness, ..*self }.verdict(0.0, 1.0))
        })
    }
}

impl FiveDegrees {
    /// Verdicts over spindle speeds in units of [`FiveDegrees::reference_frequency`] and
    /// modulations of the chuck (the paper's Fig. 4), in parallel.
    ///
    /// # Errors
    /// As [`FiveDegrees::verdict`].
    pub fn lobes(&self, speed_ratio: &[f64], mu_chuck: &[f64]) -> Result<Lobes, ChatterError> {
        let reference = self.reference_frequency();
        Lobes::fill(speed_ratio, mu_chuck, |ratio| {
            Ok(move |mu_chuck| Self { mu_chuck, ..self.clone() }.verdict(ratio * reference))
        })
    }
}

impl Lobes {
    /// Share of the points with a verdict that are stable; not a number where none has one.
    pub fn stable_share(&self) -> f64 {
        let stable = self.verdicts.iter().flatten().filter(|v| v.kind == ChatterKind::Stable).count();
        stable as f64 / self.verdicts.iter().flatten().count() as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Complex;

    #[test]
    fn a_failed_point_is_a_hole_and_a_refused_question_is_none() {
        let verdict = StabilityVerdict::from_multiplier(Complex::new(0.5, 0.0), 1.0, 0.0);
        let judge = |speed: f64, depth: f64| match (speed, depth) {
            (2.0, 0.2) => Err(ChatterError::NotConverged { residual: 0.25 }),
            _ => Ok(verdict),
        };
        let lobes = Lobes::fill(&[1.0, 2.0, 3.0], &[0.1, 0.2], |speed| match speed {
            3.0 => Err(ChatterError::NotConverged { residual: 0.5 }),
            speed => Ok(move |depth| judge(speed, depth)),
        })
        .unwrap();
        assert_eq!(
            lobes.verdicts.iter().map(Option::is_some).collect::<Vec<_>>(),
            [true, true, true, false, false, false]
        );
        let places: Vec<(f64, f64)> = lobes.holes.iter().map(|hole| (hole.speed, hole.depth)).collect();
        assert_eq!(places, [(2.0, 0.2), (3.0, 0.1), (3.0, 0.2)]);
        assert!(
            lobes.holes[0].reason.contains("residual 0.25") && lobes.at(1, 1).is_none() && lobes.at(1, 0).is_some()
        );
        assert_eq!(lobes.stable_share(), 1.0);
        let refused = Lobes::fill(&[1.0], &[0.1], |_| Ok(|_| Err(ChatterError::NoModes)));
        assert_eq!(refused, Err(ChatterError::NoModes));
    }
}
