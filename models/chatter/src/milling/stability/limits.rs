//! Limits and stable intervals at one speed.

use super::super::slow;
use super::{AtSpeed, Effort, LEAST_EXCESS};
use crate::error::{ChatterError, positive};
use crate::intervals::Crossing;
use crate::intervals::{Certificate, StableIntervals};
use crate::plan::Motion;
use crate::verdict::{StabilityLimit, StabilityVerdict};
use toolroom_spectral::{STEPS, SignChanges, brackets, root};

/// Even steps in which depths are sampled at varying speed, where a verdict costs some milliseconds and the islands of lobes are
/// blurred (assumption).
pub(super) const VARYING_STEPS: usize = 16;

/// Logarithm that stands for the spectral radius of a cut whose vibration outgrows all numbers within a period, that of the
/// greatest of them.
const BEYOND_NUMBERS: f64 = 709.0;

/// Logarithm of the spectral radius that an end of a stable interval may have.
const NEUTRAL: f64 = 1e-6;

impl AtSpeed<'_> {
    /// Least depth (m) at which the cut becomes unstable, to a relative 1e-9, and how: the first end of
    /// [`AtSpeed::stable_intervals`].
    ///
    /// # Errors
    /// [`ChatterError::NoLimit`] if no depth up to `greatest` is unstable; otherwise as
    /// [`AtSpeed::verdict`].
    pub fn limit(&mut self, greatest: f64) -> Result<StabilityLimit, ChatterError> {
        self.turn_to_worst_limit(greatest)?;
        let ends = self.ends(greatest, Effort::Boundary, true)?;
        ends.first().map(|end| end.limit).ok_or(ChatterError::NoLimit { searched: greatest })
    }

    /// All depths up to `greatest` (m) at which the cut is stable, their ends to a relative 1e-9.
    ///
    /// The spectral radius is sampled in even steps, which are halved where the radius approaches one between two
    /// samples; the certificate states the step.
    ///
    /// # Errors
    /// As [`AtSpeed::verdict`]; a greatest depth that is not positive.
    pub fn stable_intervals(&mut self, greatest: f64) -> Result<StableIntervals, ChatterError> {
        self.turn_to_worst_limit(greatest)?;
        let ends = self.ends(greatest, Effort::Boundary, false)?;
        let mut certificate = Certificate::Resolution(greatest / self.steps()? as f64);
        for place in std::iter::once(&*self).chain(&self.others) {
            if place.slow()?.is_some() {
                certificate = Certificate::Envelope;
            }
        }
        Ok(StableIntervals { ends, greatest, certificate })
    }

    /// [`AtSpeed::stable_intervals`] for a chart: the same ends to a thousandth of a step.
    pub(crate) fn charted_intervals(&mut self, greatest: f64) -> Result<Vec<Crossing>, ChatterError> {
        self.ends(greatest, Effort::Screening, false)
    }

    /// The ends of the stable intervals up to `greatest` (m), or the first alone, as exact as `effort` allows.
    pub(super) fn ends(
        &mut self,
        greatest: f64,
        effort: Effort,
        first_only: bool,
    ) -> Result<Vec<Crossing>, ChatterError> {
        positive("greatest depth", greatest)?;
        let uncut = self.uncut_excess();
        let steps = self.steps()?;
        // On which side of one a radius lies is as sure as for a verdict; where it is one is worth more.
        let sampling = match effort {
            Effort::Screening => Effort::Screening,
            Effort::Verdict | Effort::Boundary => Effort::Verdict,
        };
        let mut brackets = Vec::new();
        for found in SignChanges::new(|depth| self.excess(depth, sampling), uncut, greatest, steps) {
            brackets.extend(found?);
            if first_only && !brackets.is_empty() {
                brackets.truncate(1);
                break;
            }
        }
        brackets.into_iter().map(|bracket| self.end(bracket, effort)).collect()
    }

    /// Logarithm of the spectral radius without a cut.
    pub(crate) fn uncut_excess(&self) -> f64 {
        self.uncut().0.value.norm().ln().max(LEAST_EXCESS)
    }

    /// Logarithm of the spectral radius at `depth` (m) to some three digits, of the right sign.
    pub(crate) fn screened_excess(&mut self, depth: f64) -> Result<f64, ChatterError> {
        self.excess(depth, Effort::Screening)
    }

    /// Even steps in which depths are sampled.
    fn steps(&self) -> Result<usize, ChatterError> {
        match self.motion {
            Motion::Constant(speed) => slow::steps(&self.cut, speed),
            Motion::Varying(..) => Ok(VARYING_STEPS),
        }
    }

    /// The end of a stable interval between two depths on different sides of the boundary.
    pub(super) fn end(&mut self, [before, after]: [(f64, f64); 2], effort: Effort) -> Result<Crossing, ChatterError> {
        let becomes_unstable = after.1 > 0.0;
        let tolerance = match effort {
            Effort::Screening => 1e-3 / STEPS as f64,
            Effort::Verdict | Effort::Boundary => 1e-10,
        };
        let depth = root(|depth| self.excess(depth, effort), before, after, tolerance)?;
        let (dominant, period) = self.dominant(depth, effort)?;
        let excess = dominant.value.norm().ln().abs();
        // Where rounding decides about the multiplier its modulus jumps, and no end is reported.
        if matches!(effort, Effort::Boundary) && excess > NEUTRAL {
            return Err(ChatterError::NotConverged { residual: excess });
        }
        Ok(Crossing { limit: StabilityLimit::new(depth, self.worst_modes(), dominant, period), becomes_unstable })
    }

    /// [`AtSpeed::limit`] for less effort: `steps` even depths are sampled and the first that ends
    /// unstable is narrowed down to a thousandth of a step.
    ///
    /// # Errors
    /// As [`AtSpeed::limit`].
    pub fn rough_limit(&mut self, greatest: f64, steps: usize) -> Result<StabilityLimit, ChatterError> {
        self.turn_to_worst_limit(greatest)?;
        self.fixed_rough_limit(greatest, steps)
    }

    /// Whether each of `depths` (m) lies beyond the limit that [`AtSpeed::rough_limit`] finds, for less work: no depth beyond
    /// them is judged, and the limit is narrowed down only where one of them lies in the step that holds it. Where no step
    /// up to them ends unstable, none lies beyond.
    ///
    /// # Errors
    /// As [`AtSpeed::limit`] but for a cut without limit.
    pub fn beyond_rough_limit(
        &mut self,
        depths: &[f64],
        greatest: f64,
        steps: usize,
    ) -> Result<Vec<bool>, ChatterError> {
        self.turn_to_worst_limit(greatest)?;
        positive("greatest depth", greatest)?;
        let deepest = depths.iter().copied().fold(0.0, f64::max);
        let mut excess = |depth: f64| -> Result<f64, ChatterError> {
            Ok(self.dominant(depth, Effort::Screening)?.0.value.norm().ln())
        };
        let mut last = (0.0, -1.0);
        for step in 1..=steps {
            if last.0 >= deepest {
                break;
            }
            let x = greatest * step as f64 / steps as f64;
            let here = (x, excess(x)?);
            if here.1 > 0.0 {
                let within = depths.iter().any(|depth| last.0 < *depth && *depth < x);
                let limit = if within { root(&mut excess, last, here, 1e-3 / steps as f64)? } else { last.0 };
                return Ok(depths.iter().map(|depth| *depth > limit).collect());
            }
            last = here;
        }
        Ok(vec![false; depths.len()])
    }

    pub(super) fn fixed_rough_limit(&mut self, greatest: f64, steps: usize) -> Result<StabilityLimit, ChatterError> {
        positive("greatest depth", greatest)?;
        let mut excess = |depth: f64| -> Result<f64, ChatterError> {
            Ok(self.dominant(depth, Effort::Screening)?.0.value.norm().ln())
        };
        let found = brackets(&mut excess, (0.0, -1.0), greatest, steps, true)?;
        let Some([before, after]) = found.first() else {
            return Err(ChatterError::NoLimit { searched: greatest });
        };
        let depth = root(&mut excess, *before, *after, 1e-3 / steps as f64)?;
        let (dominant, period) = self.dominant(depth, Effort::Screening)?;
        Ok(StabilityLimit::new(depth, self.worst_modes(), dominant, period))
    }

    /// Logarithm of the spectral radius at `depth` (m): for screening to some three digits, of the right sign.
    pub(super) fn excess(&mut self, depth: f64, effort: Effort) -> Result<f64, ChatterError> {
        let found = self.refined(depth, effort);
        let places = std::iter::once(&*self).chain(&self.others);
        if found.is_err() && places.into_iter().any(|place| place.krylov.overflowed()) {
            return Ok(BEYOND_NUMBERS);
        }
        Ok(found?.0.value.norm().ln().max(LEAST_EXCESS))
    }

    /// Verdict at `depth` (m) with its margin against the limit below `greatest` (m).
    ///
    /// # Errors
    /// As [`AtSpeed::verdict`]; a cut without limit has no margin but is no error.
    pub fn verdict_with_margin(&mut self, depth: f64, greatest: f64) -> Result<StabilityVerdict, ChatterError> {
        let mut verdict = self.verdict(depth)?;
        verdict.margin = match self.limit(greatest) {
            Ok(limit) => Some(1.0 - depth / limit.depth),
            Err(ChatterError::NoLimit { .. }) => None,
            Err(error) => return Err(error),
        };
        Ok(verdict)
    }
}
