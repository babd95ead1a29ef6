//! The phase of a varying speed at which a disturbance grows most.

use super::limits::VARYING_STEPS;
use super::{AtSpeed, Effort};
use crate::error::{ChatterError, positive};
use crate::plan::Motion;
use crate::speed_variation::{SpeedVariation, Started};
use std::f64::consts::TAU;

/// The phase of a varying speed at which a disturbance grows most.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct WorstPhase {
    /// Angle of tooth 0, from the normal of the feed, where the speed is greatest (rad).
    pub phase: f64,
    /// Spectral radius of a mean revolution there, to three digits or so.
    pub spectral_radius: f64,
    /// That radius less the one of the best phase.
    pub spread: f64,
}

impl AtSpeed<'_> {
    /// Lets tooth 0 stand at `phase` (rad) where a varying speed is greatest.
    pub(super) fn turn_to(&mut self, phase: f64) {
        if let Motion::Varying(speed, started) = self.motion {
            self.motion = Motion::Varying(speed, Started::new(started.variation, phase - self.geometry.origin));
            self.prepared = [None, None, None];
            self.phase = phase;
            self.others.iter_mut().for_each(|place| place.turn_to(phase));
        }
    }

    /// Whether the worst phase of a varying speed is requested.
    pub(super) fn phase_is_free(&self) -> bool {
        matches!(self.motion, Motion::Varying(_, started) if started.variation.phase.is_none())
    }

    /// The phase of a varying speed at which a disturbance at `depth` (m) grows most; none at constant speed.
    ///
    /// Sixteen phases over a pitch of the teeth, or a revolution of unequal ones, are tried, then the best is refined by
    /// golden sections to a thousandth of the range.
    ///
    /// # Errors
    /// As [`AtSpeed::verdict`].
    pub fn worst_phase(&mut self, depth: f64) -> Result<Option<WorstPhase>, ChatterError> {
        const TRIED: usize = 16;
        const SECTIONS: u32 = 10;
        positive("depth", depth)?;
        let Motion::Varying(_, Started { variation: SpeedVariation { revolutions, .. }, .. }) = self.motion else {
            return Ok(None);
        };
        let before = self.phase;
        let range = if self.cut.cutter.is_regular() { TAU / self.cut.cutter.teeth as f64 } else { TAU };
        let mut growth = |phase: f64| -> Result<f64, ChatterError> {
            self.turn_to(phase);
            Ok(self.dominant(depth, Effort::Screening)?.0.value.norm().ln())
        };
        let step = range / TRIED as f64;
        let values = (0..TRIED).map(|i| growth(step * i as f64)).collect::<Result<Vec<f64>, _>>()?;
        let most = (0..TRIED).max_by(|a, b| values[*a].total_cmp(&values[*b])).unwrap_or(0);
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        let golden = 0.5 * (5f64.sqrt() - 1.0);
        let (mut low, mut high) = (step * (most as f64 - 1.0), step * (most as f64 + 1.0));
        let (mut a, mut b) = (high - golden * (high - low), low + golden * (high - low));
        let (mut at_a, mut at_b) = (growth(a)?, growth(b)?);
        for _ in 0..SECTIONS {
            if at_a > at_b {
                (high, b, at_b) = (b, a, at_a);
                a = high - golden * (high - low);
                at_a = growth(a)?;
            } else {
                (low, a, at_a) = (a, b, at_b);
                b = low + golden * (high - low);
                at_b = growth(b)?;
            }
        }
        let candidates = [(step * most as f64, values[most]), (a, at_a), (b, at_b)];
        let (phase, greatest) = candidates
            .into_iter()
            .fold((0.0, f64::NEG_INFINITY), |best, next| if next.1 > best.1 { next } else { best });
        self.turn_to(before);
        let radius = |growth: f64| (growth / f64::from(revolutions)).exp();
        let spread = radius(greatest) - radius(least);
        Ok(Some(WorstPhase { phase: phase.rem_euclid(range), spectral_radius: radius(greatest), spread }))
    }

    /// Turns a varying speed without a phase to that of the least limit up to `greatest` (m): the worst phase at the limit
    /// of the worst phase before, twice.
    pub(crate) fn at_worst_limit(mut self, greatest: f64) -> Result<Self, ChatterError> {
        self.turn_to_worst_limit(greatest)?;
        Ok(self)
    }

    pub(super) fn turn_to_worst_limit(&mut self, greatest: f64) -> Result<(), ChatterError> {
        const ROUNDS: usize = 2;
        if !self.phase_is_free() {
            return Ok(());
        }
        let mut depth = greatest;
        for _ in 0..ROUNDS {
            depth = match self.fixed_rough_limit(depth, VARYING_STEPS) {
                Ok(limit) => limit.depth,
                Err(ChatterError::NoLimit { searched }) => searched,
                Err(error) => return Err(error),
            };
            if let Some(worst) = self.worst_phase(depth)? {
                self.turn_to(worst.phase);
            }
        }
        Ok(())
    }
}
