//! Verdicts of turning: at constant speed by the characteristic roots, at varying speed by
//! collocation of a period of the variation.

use super::Turning;
use super::roots::TurningAtSpeed;
use crate::SpeedVariation;
use crate::error::{ChatterError, positive, within};
use crate::period::{MapStorage, Period, PeriodMap};
use crate::plan::{Cut, Frame, Motion, PlannedStretch, PlannedTerm, Resolution, assemble};
use crate::response::{Modal, Modes, SHORT_PARTS};
use crate::speed_variation::Started;
use crate::verdict::{ChatterKind, StabilityLimit, StabilityVerdict};
use std::borrow::Cow;
use std::f64::consts::TAU;
use toolroom_spectral::{Dominant, Krylov, brackets, root};

/// Nodes added to each part of a period for a verdict, and for a limit, which is found to three parts in a thousand.
const FINE: usize = 6;
const COARSE: usize = 1;

impl Cut for Turning {
    type Tooth = ();

    fn gain(&self, (): &(), _: f64) -> [f64; 4] {
        [self.force_slope(), 0.0, 0.0, 0.0]
    }

    fn damping(&self, (): &(), _: f64, speed: f64) -> Option<[f64; 4]> {
        (self.process_damping != 0.0).then(|| [self.damping_slope(speed), 0.0, 0.0, 0.0])
    }
}

impl TurningAtSpeed<'_> {
    /// Verdict at `width` (m), which must not exceed the width that the cut was prepared for.
    ///
    /// # Errors
    /// A width that is negative or not finite; a root that was not found.
    pub fn verdict(&self, width: f64) -> Result<StabilityVerdict, ChatterError> {
        within("width", width, 0.0, f64::MAX)?;
        let tau = TAU / self.spindle_speed;
        let root = self.rightmost_root(width)?;
        let mut verdict = StabilityVerdict::from_multiplier((root.rate * tau).exp(), tau, root.residual);
        verdict.stable = self.unstable_roots(width) == 0;
        verdict.kind = if verdict.stable { ChatterKind::Stable } else { ChatterKind::Hopf };
        verdict.chatter_frequency = root.rate.im / TAU;
        Ok(verdict)
    }
}

impl Turning {
    /// The modes that the cut moves: the force's share in, the chip's out.
    pub(crate) fn oriented(&self) -> impl Iterator<Item = Modal> {
        let (s, c) = self.force_angle.sin_cos();
        self.modes.iter().filter(|mode| self.orientation(mode) != 0.0).map(move |mode| {
            let [x, y] = mode.unit();
            mode.modal([x * c + y * s, 0.0], [x, 0.0])
        })
    }

    /// Factor on the frequencies of the structure by which the cut can quicken them at `width` (m).
    fn stiffening(&self, width: f64) -> f64 {
        (1.0 + width * self.force_slope() / self.softest()).sqrt()
    }

    /// Stiffness of the softest mode (N/m).
    fn softest(&self) -> f64 {
        self.modes.iter().map(|mode| mode.stiffness).fold(f64::INFINITY, f64::min)
    }

    /// One period of the speed's variation, fine enough for oscillations that the cut quickens by `stiffening`, with `extra`
    /// nodes in each part.
    fn period(&self, motion: Motion, revolutions: u32, (stiffening, extra): (f64, usize)) -> Period {
        let frame = Frame::resolved(Modes { modal: self.oriented().collect(), channels: 1 });
        let terms = vec![PlannedTerm { delay: TAU, teeth: vec![()] }];
        let stretch = PlannedStretch { from: 0.0, to: TAU * f64::from(revolutions), terms };
        assemble(self, &frame, motion, &[stretch], Resolution { extra, stiffening, most_cycles: SHORT_PARTS })
    }

    /// Verdict at `spindle_speed` (rad/s) and `width` of cut (m), with its margin; the spectral
    /// radius is that of one revolution, exact to rounding.
    ///
    /// # Errors
    /// A cut that is none; a speed that is not positive; a width that is negative or makes the cut more than a thousand
    /// times as stiff as the structure; an eigenvalue that did not converge.
    pub fn verdict(&self, spindle_speed: f64, width: f64) -> Result<StabilityVerdict, ChatterError> {
        let mut verdict = self.verdict_without_margin(spindle_speed, width)?;
        verdict.margin = match self.limit(spindle_speed) {
            Ok(limit) => Some(1.0 - width / limit.depth),
            Err(ChatterError::NoLimit { .. }) => None,
            Err(error) => return Err(error),
        };
        Ok(verdict)
    }

    /// [`Turning::verdict`] without the search for the limit.
    ///
    /// # Errors
    /// As [`Turning::verdict`].
    pub fn verdict_without_margin(&self, spindle_speed: f64, width: f64) -> Result<StabilityVerdict, ChatterError> {
        if self.along_path.is_some() {
            return self.worst_verdict(|cut| cut.verdict_without_margin(spindle_speed, width));
        }
        TurningAtSpeed::new(Cow::Borrowed(self), spindle_speed, width)?.verdict(width)
    }

    /// Number of unstable characteristic roots at `spindle_speed` (rad/s) and `width` (m), at the worst place of a path.
    ///
    /// # Errors
    /// As [`Turning::verdict`].
    pub fn unstable_multipliers(&self, spindle_speed: f64, width: f64) -> Result<usize, ChatterError> {
        if self.along_path.is_some() {
            let counts = self.places().into_iter().map(|(_, cut)| cut.unstable_multipliers(spindle_speed, width));
            return counts.collect::<Result<Vec<usize>, _>>().map(|counts| counts.into_iter().max().unwrap_or(0));
        }
        let roots = TurningAtSpeed::new(Cow::Borrowed(self), spindle_speed, width)?.unstable_roots(width);
        Ok(usize::try_from(roots).unwrap_or(0))
    }

    /// Whether the cut is stable at `spindle_speed` (rad/s) and `width` (m): the number of unstable roots alone, for
    /// less than a verdict costs.
    ///
    /// # Errors
    /// As [`Turning::verdict`].
    pub fn is_stable(&self, spindle_speed: f64, width: f64) -> Result<bool, ChatterError> {
        if self.along_path.is_some() {
            for (_, cut) in self.places() {
                if !cut.is_stable(spindle_speed, width)? {
                    return Ok(false);
                }
            }
            return Ok(true);
        }
        Ok(TurningAtSpeed::new(Cow::Borrowed(self), spindle_speed, width)?.unstable_roots(width) == 0)
    }

    /// Verdict at a speed that varies about `spindle_speed` (rad/s); the spectral radius is that of
    /// a mean revolution, `rho_T^RVF`.
    ///
    /// # Errors
    /// As [`Turning::verdict`]; a variation out of range.
    ///
    /// # Examples
    /// ```
    /// use std::f64::consts::TAU;
    /// use toolroom_chatter::{Mode, SpeedVariation, Turning};
    /// let mode = Mode { direction: [1.0, 0.0], natural_frequency: 540.9, damping_ratio: 0.038, stiffness: 6.48e6 };
    /// let cut = Turning::orthogonal(vec![mode], 1384e6, 0.035);
    /// let speed = 1500.0 / 60.0 * TAU;
    /// let width = 1.5 * cut.limit(speed).unwrap().depth;
    /// let variation = SpeedVariation { amplitude: 0.2, revolutions: 5, phase: None };
    /// assert!(!cut.verdict(speed, width).unwrap().stable);
    /// assert!(cut.verdict_at_varying_speed(speed, variation, width).unwrap().stable);
    /// ```
    pub fn verdict_at_varying_speed(
        &self,
        spindle_speed: f64,
        variation: SpeedVariation,
        width: f64,
    ) -> Result<StabilityVerdict, ChatterError> {
        if self.by_speed.is_some() {
            return self.at_spindle_speed(spindle_speed)?.verdict_at_varying_speed(spindle_speed, variation, width);
        }
        if self.along_path.is_some() {
            return self.worst_verdict(|cut| cut.verdict_at_varying_speed(spindle_speed, variation, width));
        }
        const RESIDUAL: f64 = 1e-8;
        self.check()?;
        positive("spindle_speed", spindle_speed)?;
        variation.check()?;
        variation.check_oscillations(&self.modes, spindle_speed, false)?;
        within("width", width, 0.0, f64::MAX)?;
        let revolutions = variation.revolutions;
        let length = TAU * f64::from(revolutions) / spindle_speed;
        let dominant = if width == 0.0 {
            // Without a cut the speed does not matter.
            let root = TurningAtSpeed::new(Cow::Borrowed(self), spindle_speed, width)?.rightmost_root(width)?;
            Dominant { value: (root.rate * length).exp(), residual: root.residual }
        } else {
            let motion = Motion::Varying(spindle_speed, Started::new(variation, 0.0));
            let period = self.period(motion, revolutions, (self.stiffening(width), FINE));
            let mut storage = MapStorage::default();
            Krylov::default().dominant(&mut PeriodMap::new(&period, width, &mut storage), RESIDUAL)?
        };
        let mut verdict = StabilityVerdict::from_multiplier(dominant.value, length, dominant.residual);
        verdict.name_frequency(&self.modes);
        verdict.spread_over(revolutions);
        Ok(verdict)
    }

    /// Least width (m) up to `greatest` that is unstable at a speed that varies about
    /// `spindle_speed` (rad/s), to three parts in a thousand of the step that it is found in.
    ///
    /// # Errors
    /// As [`Turning::verdict_at_varying_speed`]; [`ChatterError::NoLimit`] where none of `steps` even
    /// steps is unstable.
    pub fn limit_at_varying_speed(
        &self,
        spindle_speed: f64,
        variation: SpeedVariation,
        greatest: f64,
        steps: usize,
    ) -> Result<StabilityLimit, ChatterError> {
        if self.by_speed.is_some() {
            return self.at_spindle_speed(spindle_speed)?.limit_at_varying_speed(
                spindle_speed,
                variation,
                greatest,
                steps,
            );
        }
        if self.along_path.is_some() {
            return self.least_limit(|cut| cut.limit_at_varying_speed(spindle_speed, variation, greatest, steps));
        }
        let (depth, dominant) = self.varying(spindle_speed, variation, (greatest, steps), true)?;
        let length = TAU * f64::from(variation.revolutions) / spindle_speed;
        // Requested, and so worked out.
        let Some(dominant) = dominant else { return Err(ChatterError::NoLimit { searched: greatest }) };
        let mut verdict = StabilityVerdict::from_multiplier(dominant.value, length, dominant.residual);
        verdict.name_frequency(&self.modes);
        Ok(StabilityLimit { depth, kind: ChatterKind::Hopf, chatter_frequency: verdict.chatter_frequency })
    }

    /// The width (m) of [`Turning::limit_at_varying_speed`] alone, for whoever needs no frequency.
    ///
    /// # Errors
    /// As [`Turning::limit_at_varying_speed`].
    pub fn limit_width_at_varying_speed(
        &self,
        spindle_speed: f64,
        variation: SpeedVariation,
        greatest: f64,
        steps: usize,
    ) -> Result<f64, ChatterError> {
        if self.by_speed.is_some() {
            return self.at_spindle_speed(spindle_speed)?.limit_width_at_varying_speed(
                spindle_speed,
                variation,
                greatest,
                steps,
            );
        }
        if self.along_path.is_some() {
            return Ok(self.limit_at_varying_speed(spindle_speed, variation, greatest, steps)?.depth);
        }
        Ok(self.varying(spindle_speed, variation, (greatest, steps), false)?.0)
    }

    /// The width of the limit, with the multiplier there if it is `named`.
    fn varying(
        &self,
        spindle_speed: f64,
        variation: SpeedVariation,
        (greatest, steps): (f64, usize),
        named: bool,
    ) -> Result<(f64, Option<Dominant>), ChatterError> {
        positive("greatest width", greatest)?;
        self.check()?;
        positive("spindle_speed", spindle_speed)?;
        variation.check()?;
        variation.check_oscillations(&self.modes, spindle_speed, false)?;
        let motion = Motion::Varying(spindle_speed, Started::new(variation, 0.0));
        // A period serves all widths up to the one that quickens the oscillations by the next step.
        let mut prepared: Option<(f64, Period)> = None;
        let (mut storage, mut krylov) = (MapStorage::default(), Krylov::default());
        let mut dominant = |width: f64| -> Result<Dominant, ChatterError> {
            let (_, period) = match prepared.take().filter(|(most, _)| width <= *most) {
                Some(known) => prepared.insert(known),
                None => {
                    const STEP: f64 = 1.2;
                    let stiffening = STEP.powf((self.stiffening(width).ln() / STEP.ln()).floor() + 1.0);
                    let most = (stiffening * stiffening - 1.0) * self.softest() / self.force_slope();
                    prepared.insert((most.max(width), self.period(motion, variation.revolutions, (stiffening, COARSE))))
                }
            };
            Ok(krylov.dominant(&mut PeriodMap::new(period, width, &mut storage), 1e-3)?)
        };
        let mut excess = |width: f64| -> Result<f64, ChatterError> { Ok(dominant(width)?.value.norm().ln()) };
        let found = brackets(&mut excess, (0.0, -1.0), greatest, steps, true)?;
        let Some([before, after]) = found.first() else {
            return Err(ChatterError::NoLimit { searched: greatest });
        };
        let depth = root(&mut excess, *before, *after, 3e-3)?;
        let dominant = if named { Some(dominant(depth)?) } else { None };
        Ok((depth, dominant))
    }
}
