//! Stability of milling at one spindle speed.

mod count;
mod limits;
mod phase;

pub use phase::WorstPhase;

use super::Milling;
use super::characteristic::Characteristic;
use super::engagement::Geometry;
use super::slow;
use crate::error::{ChatterError, positive, within};
use crate::period::{MapStorage, Period, PeriodMap};
use crate::plan::{Cut, Frame, Motion, PlannedStretch, PlannedTerm, Resolution, assemble};
use crate::response::{LONG_PARTS, SHORT_PARTS};
use crate::speed_variation::{SpeedVariation, Started};
use crate::structure::{Mode, last_to_decay};
use crate::verdict::StabilityVerdict;
use nalgebra::Complex;
use std::borrow::Cow;
use std::f64::consts::TAU;
use toolroom_spectral::{Dominant, Krylov, LinearMap, dense_dominant, dense_eigenvalues};

/// How much effort a spectral radius is worth.
#[derive(Clone, Copy)]
enum Effort {
    /// A point of a chart: three digits or so.
    Screening,
    /// A verdict that is requested: eight digits.
    Verdict,
    /// On the boundary, and to find it.
    Boundary,
}

/// Least logarithm of a spectral radius that is told apart: less decays in a period beyond rounding.
const LEAST_EXCESS: f64 = -50.0;

/// Greatest dimension whose eigenvalues are all worked out where the iteration stalls: a quarter of a
/// second.
const LARGEST_DENSE: usize = 200;

impl Effort {
    /// Nodes added to each stretch, residual of the eigenvalue, and the distance of the spectral
    /// radius from one below which the next effort is spent instead.
    fn settings(self) -> (usize, f64, f64) {
        match self {
            Self::Screening => (0, 1e-4, 2e-2),
            Self::Verdict => (5, 1e-9, 1e-4),
            Self::Boundary => (13, 1e-12, 0.0),
        }
    }
}

/// A milling cut at one speed, ready for verdicts at many depths.
///
/// Straight teeth are prepared once; with a helix the geometry depends on the depth and is
/// prepared for each verdict.
pub struct AtSpeed<'a> {
    /// With the modes of this speed.
    cut: Cow<'a, Milling>,
    motion: Motion,
    frame: Frame,
    /// Of straight teeth; with a helix the geometry of no depth.
    geometry: Geometry,
    /// The characteristic function where there is one, with the greatest depth that it resolves: for
    /// verdicts and on the boundary.
    characteristic: [Option<(Characteristic, f64)>; 2],
    /// Depth to which it is worked out at once (m).
    expected: f64,
    /// By effort.
    prepared: [Option<Prepared>; 3],
    storage: MapStorage,
    krylov: Krylov,
    /// Angle of tooth 0 where a varying speed is greatest (rad).
    phase: f64,
    /// Where this cut stands on its path (m), and the cuts at the other places of it.
    position: Option<f64>,
    others: Vec<AtSpeed<'a>>,
    /// Which of them, counted from one, was the worst at the last depth; this cut where it is zero.
    worst: usize,
}

/// A period ready for depths up to some depth.
struct Prepared {
    period: Period,
    /// Duration of the period (s).
    length: f64,
    /// Greatest depth that it resolves (m).
    greatest: f64,
}

/// The teeth of a milling cut over its geometry.
struct Teeth<'a> {
    cut: &'a Milling,
    geometry: &'a Geometry,
}

impl Cut for Teeth<'_> {
    type Tooth = (usize, usize, f64);

    fn gain(&self, tooth: &Self::Tooth, angle: f64) -> [f64; 4] {
        self.geometry.directional(self.cut, *tooth, angle)
    }

    fn damping(&self, tooth: &Self::Tooth, angle: f64, speed: f64) -> Option<[f64; 4]> {
        let coefficient = self.cut.force.process_damping;
        if coefficient == 0.0 {
            return None;
        }
        let scale = coefficient / (speed * self.cut.cutter.diameter / 2.0);
        Some(self.geometry.radial_dyad(*tooth, angle).map(|entry| entry * scale))
    }
}

impl Milling {
    /// The cut at `spindle_speed` (rad/s).
    ///
    /// # Errors
    /// A structure, cutter or engagement that is none; a speed that is not positive; no tooth in
    /// cut.
    pub fn at_speed(&self, spindle_speed: f64) -> Result<AtSpeed<'_>, ChatterError> {
        self.check()?;
        positive("spindle_speed", spindle_speed)?;
        AtSpeed::new(self.at_spindle_speed(spindle_speed)?, Motion::Constant(spindle_speed))
    }

    /// The cut at a speed that varies about `spindle_speed` (rad/s); its spectral radii are those of
    /// a mean revolution, `rho_T^RVF`. Without a phase of the variation every question is answered at its worst phase: a
    /// verdict at that of its depth, limits and intervals at that of the least limit. Modes that change with the speed are
    /// those of the mean speed (assumption: bearings and temperatures do not follow within some revolutions).
    ///
    /// # Errors
    /// As [`Milling::at_speed`]; a variation out of range.
    pub fn at_varying_speed(&self, spindle_speed: f64, variation: SpeedVariation) -> Result<AtSpeed<'_>, ChatterError> {
        self.check()?;
        positive("spindle_speed", spindle_speed)?;
        variation.check()?;
        let cut = self.at_spindle_speed(spindle_speed)?;
        for (_, place) in cut.places() {
            variation.check_oscillations(&place.modes, spindle_speed, true)?;
        }
        let mut at_speed = AtSpeed::new(cut, Motion::Varying(spindle_speed, Started::new(variation, 0.0)))?;
        at_speed.turn_to(variation.phase.unwrap_or(at_speed.geometry.origin));
        Ok(at_speed)
    }

    /// Verdict at `spindle_speed` (rad/s) and `depth` (m), without the margin, which costs a
    /// search for the limit.
    ///
    /// # Errors
    /// As [`Milling::at_speed`]; a depth that is negative or not finite; an eigenvalue that did
    /// not converge.
    pub fn verdict(&self, spindle_speed: f64, depth: f64) -> Result<StabilityVerdict, ChatterError> {
        self.at_speed(spindle_speed)?.verdict(depth)
    }
}

/// Nodes of a stretch that holds no oscillation.
const LEAST: usize = 3;

/// What cuts where over `repeats` turns of the geometry.
fn stretches(geometry: &Geometry, repeats: u32) -> Vec<PlannedStretch<(usize, usize, f64)>> {
    let mut stretches = Vec::new();
    for repeat in 0..repeats {
        let shift = f64::from(repeat) * geometry.span;
        for pair in geometry.breaks.windows(2) {
            let mut terms: Vec<PlannedTerm<_>> = Vec::new();
            for tooth in geometry.cutting(pair[0], pair[1]) {
                let delay = geometry.teeth[tooth.0].1[tooth.1].delay;
                let tooth = (tooth.0, tooth.1, tooth.2 - shift);
                match terms.iter_mut().find(|term| (term.delay - delay).abs() < 1e-12) {
                    Some(term) => term.teeth.push(tooth),
                    None => terms.push(PlannedTerm { delay, teeth: vec![tooth] }),
                }
            }
            stretches.push(PlannedStretch { from: pair[0] + shift, to: pair[1] + shift, terms });
        }
    }
    stretches
}

impl<'a> AtSpeed<'a> {
    /// The cut, or of one whose modes change along its path that of the first place with all others beside it.
    fn new(cut: Cow<'a, Milling>, motion: Motion) -> Result<Self, ChatterError> {
        if cut.along_path.is_none() {
            return Self::here(cut, motion);
        }
        let at = |(position, cut)| Ok(Self { position, ..Self::here(Cow::Owned(cut), motion)? });
        let mut places = cut.places().into_iter().map(at).collect::<Result<Vec<_>, ChatterError>>()?;
        let mut first = places.remove(0);
        first.others = places;
        Ok(first)
    }

    fn here(cut: Cow<'a, Milling>, motion: Motion) -> Result<Self, ChatterError> {
        let varying = matches!(motion, Motion::Varying(..));
        Ok(Self {
            motion,
            frame: Frame::new(&cut.modes),
            // Refuses an engagement without teeth now.
            geometry: Geometry::new(&cut, 0.0, varying)?,
            cut,
            characteristic: [None, None],
            expected: 0.0,
            prepared: [None, None, None],
            storage: MapStorage::default(),
            krylov: Krylov::default(),
            phase: 0.0,
            position: None,
            others: Vec::new(),
            worst: 0,
        })
    }

    /// The modes of the place that was the worst at the last depth.
    fn worst_modes(&self) -> &[Mode] {
        let place = self.worst.checked_sub(1).and_then(|i| self.others.get(i)).unwrap_or(self);
        &place.cut.modes
    }

    /// The place of the path (m) at which a disturbance at `depth` (m) grows most; none where the modes do not change along
    /// a path.
    ///
    /// # Errors
    /// As [`AtSpeed::verdict`].
    pub fn worst_position(&mut self, depth: f64) -> Result<Option<f64>, ChatterError> {
        self.verdict(depth)?;
        Ok(self.worst.checked_sub(1).and_then(|i| self.others.get(i)).map_or(self.position, |place| place.position))
    }

    /// For many depths up to `greatest` (m): what they share is worked out once.
    pub(crate) fn up_to(mut self, greatest: f64) -> Self {
        self.expected = greatest;
        self.others.iter_mut().for_each(|place| place.expected = greatest);
        self
    }

    /// Who cuts where at `depth`.
    fn geometry(&self, depth: f64) -> Result<Cow<'_, Geometry>, ChatterError> {
        if self.cut.cutter.is_straight() {
            return Ok(Cow::Borrowed(&self.geometry));
        }
        let varying = matches!(self.motion, Motion::Varying(..));
        Geometry::new(&self.cut, depth, varying).map(Cow::Owned)
    }

    /// Steps of `sqrt(1 + depth K/k)`, by which the cut can quicken the oscillations, and the depth
    /// at which the next step begins.
    fn stiffening(&self, depth: f64) -> (f64, f64) {
        const STEP: f64 = 1.2;
        let force = &self.cut.force;
        let pitch = TAU / self.cut.cutter.teeth as f64;
        let together = ((self.cut.engagement.exit - self.cut.engagement.entry) / pitch).max(1.0);
        // Greatest entry of the directional matrix, about (K_t + K_n)/2 for one tooth.
        let gain = 0.5 * (force.tangential + force.radial.abs() + force.axial.abs()) * together;
        let softest = self.cut.modes.iter().map(|mode| mode.stiffness).fold(f64::INFINITY, f64::min);
        let steps = ((1.0 + depth * gain / softest).sqrt().ln() / STEP.ln()).floor() + 1.0;
        let stiffening = STEP.powf(steps);
        (stiffening, (stiffening * stiffening - 1.0) * softest / gain)
    }

    /// The period at `depth`, with `extra` nodes in each part and `most_cycles` in one of a stretch that is split.
    fn assemble(&self, depth: f64, extra: usize, most_cycles: f64) -> Result<Prepared, ChatterError> {
        let geometry = self.geometry(depth)?;
        let (repeats, speed) = match self.motion {
            Motion::Constant(speed) => (1, speed),
            Motion::Varying(speed, started) => (started.variation.revolutions, speed),
        };
        let teeth = Teeth { cut: &self.cut, geometry: &geometry };
        let (stiffening, greatest) = self.stiffening(depth);
        let period = assemble(
            &teeth,
            &self.frame,
            self.motion,
            &stretches(&geometry, repeats),
            Resolution { extra, stiffening, most_cycles },
        );
        Ok(Prepared { period, length: f64::from(repeats) * geometry.span / speed, greatest })
    }

    /// Dominant multiplier at `depth` over one period, at the worst place, and the period (s).
    fn dominant(&mut self, depth: f64, effort: Effort) -> Result<(Dominant, f64), ChatterError> {
        let mut greatest = self.dominant_here(depth, effort)?;
        self.worst = 0;
        for (i, place) in self.others.iter_mut().enumerate() {
            let found = place.dominant_here(depth, effort)?;
            if found.0.value.norm() > greatest.0.value.norm() {
                (greatest, self.worst) = (found, i + 1);
            }
        }
        Ok(greatest)
    }

    /// Dominant multiplier at `depth` over one period, and the period (s).
    fn dominant_here(&mut self, depth: f64, effort: Effort) -> Result<(Dominant, f64), ChatterError> {
        if let Some(speed) = self.slow()? {
            let geometry = self.geometry(depth)?;
            return Ok((slow::dominant(&self.cut, &geometry, speed, depth), geometry.span / speed));
        }
        let (extra, residual, _) = effort.settings();
        if let Some(found) = self.characteristic_multiplier(depth, effort)? {
            return Ok(found);
        }
        let level = effort as usize;
        let fits = |prepared: &Prepared| self.cut.cutter.is_straight() && depth <= prepared.greatest;
        if !self.prepared[level].as_ref().is_some_and(fits) {
            self.prepared[level] = Some(self.assemble(depth, extra, SHORT_PARTS)?);
        }
        let Some(Prepared { period, length, .. }) = &self.prepared[level] else {
            return Err(ChatterError::NoTeethInCut);
        };
        let mut map = PeriodMap::new(period, depth, &mut self.storage);
        let found = self.krylov.dominant(&mut map, residual);
        if let Ok(found) = found {
            return Ok((found, *length));
        }
        // Slow but sure.
        let refined = self.assemble(depth, Effort::Boundary.settings().0, LONG_PARTS)?;
        let mut map = PeriodMap::new(&refined.period, depth, &mut self.storage);
        if map.size() > LARGEST_DENSE {
            return Ok((found?, refined.length));
        }
        Ok((dense_dominant(map.dense())?, refined.length))
    }

    /// The dominant multiplier by the characteristic function, where the cut has one that tells it
    /// well enough.
    fn characteristic_multiplier(
        &mut self,
        depth: f64,
        effort: Effort,
    ) -> Result<Option<(Dominant, f64)>, ChatterError> {
        let Some((function, period)) = self.characteristic(depth, effort)? else { return Ok(None) };
        Ok(function.dominant(depth, effort.settings().1).map(|found| (found, period)))
    }

    /// The spindle speed (rad/s), where it is so low that the envelope of the lobes answers.
    fn slow(&self) -> Result<Option<f64>, ChatterError> {
        let Motion::Constant(speed) = self.motion else { return Ok(None) };
        Ok(slow::is_slow(&self.cut, speed)?.then_some(speed))
    }

    /// The characteristic function and the tooth period (s), where the cut has one: one mode, regular
    /// teeth, constant speed, no damping by the cut.
    fn characteristic(
        &mut self,
        depth: f64,
        effort: Effort,
    ) -> Result<Option<(&mut Characteristic, f64)>, ChatterError> {
        let Motion::Constant(speed) = self.motion else { return Ok(None) };
        let [modal] = self.frame.modes.modal[..] else { return Ok(None) };
        if !self.cut.cutter.is_regular() || self.cut.force.process_damping > 0.0 {
            return Ok(None);
        }
        // A verdict's nodes serve charts too.
        let (level, extra) = if matches!(effort, Effort::Boundary) { (1, 4) } else { (0, 0) };
        let fits = |(_, greatest): &(_, f64)| self.cut.cutter.is_straight() && depth <= *greatest;
        if !self.characteristic[level].as_ref().is_some_and(fits) {
            let geometry = self.geometry(depth)?;
            let (stiffening, greatest) = self.stiffening(depth.max(self.expected));
            let gain = |matrix| modal.input[0] * modal.output[0] * self.frame.project(matrix)[0];
            let function = Characteristic::new(&self.cut, &geometry, &modal, gain, speed, stiffening, extra);
            self.characteristic[level] = Some((function, greatest));
        }
        let period = TAU / (self.cut.cutter.teeth as f64 * speed);
        Ok(self.characteristic[level].as_mut().map(|(function, _)| (function, period)))
    }

    /// Verdict at `depth` (m). Near the boundary it is refined before it is given.
    ///
    /// # Errors
    /// A depth that is negative or not finite; an eigenvalue that did not converge.
    pub fn verdict(&mut self, depth: f64) -> Result<StabilityVerdict, ChatterError> {
        if depth > 0.0
            && self.phase_is_free()
            && let Some(worst) = self.worst_phase(depth)?
        {
            self.turn_to(worst.phase);
        }
        self.judge(depth, Effort::Verdict)
    }

    /// Verdict as good as [`AtSpeed::verdict`]'s with a spectral radius of some three digits, for charts; of a varying speed
    /// without a phase at the phase that was found last.
    ///
    /// # Errors
    /// As [`AtSpeed::verdict`].
    pub fn screen(&mut self, depth: f64) -> Result<StabilityVerdict, ChatterError> {
        self.judge(depth, Effort::Screening)
    }

    /// The multiplier without a cut, and its period (s): the structure decays by itself.
    fn uncut(&self) -> (Dominant, f64) {
        let (repeats, speed) = match self.motion {
            Motion::Constant(speed) => (1, speed),
            Motion::Varying(speed, started) => (started.variation.revolutions, speed),
        };
        let period = f64::from(repeats) * self.geometry.span / speed;
        let modes = std::iter::once(self).chain(&self.others).flat_map(|place| &place.cut.modes);
        (Dominant { value: (last_to_decay(modes) * period).exp(), residual: 0.0 }, period)
    }

    /// The dominant multiplier at `depth` (m) and the period (s), with more effort the nearer it is to the unit circle.
    fn refined(&mut self, depth: f64, effort: Effort) -> Result<(Dominant, f64), ChatterError> {
        let mut found = self.dominant(depth, effort)?;
        let mut spent = effort;
        for next in [Effort::Verdict, Effort::Boundary] {
            let near = (found.0.value.norm() - 1.0).abs() < spent.settings().2;
            if near && next as usize > spent as usize {
                found = self.dominant(depth, next)?;
                spent = next;
            }
        }
        Ok(found)
    }

    fn judge(&mut self, depth: f64, effort: Effort) -> Result<StabilityVerdict, ChatterError> {
        within("depth", depth, 0.0, f64::MAX)?;
        let (dominant, period) = if depth == 0.0 { self.uncut() } else { self.refined(depth, effort)? };
        let mut verdict = StabilityVerdict::from_multiplier(dominant.value, period, dominant.residual);
        verdict.name_frequency(self.worst_modes());
        if let Motion::Varying(_, started) = self.motion {
            verdict.spread_over(started.variation.revolutions);
        }
        Ok(verdict)
    }

    /// All Floquet multipliers at `depth` (m), at the worst place of a path, the greatest first, by the dense eigenvalues of the
    /// period map with `extra` more nodes than on the boundary: slow, for cross-checks.
    ///
    /// # Errors
    /// As [`AtSpeed::verdict`].
    pub fn multipliers(&self, depth: f64, extra: usize) -> Result<Vec<Complex<f64>>, ChatterError> {
        within("depth", depth, 0.0, f64::MAX)?;
        let mut all = self.multipliers_here(depth, extra)?;
        for place in &self.others {
            let found = place.multipliers_here(depth, extra)?;
            if found.first().map(|value| value.norm()) > all.first().map(|value| value.norm()) {
                all = found;
            }
        }
        Ok(all)
    }

    fn multipliers_here(&self, depth: f64, extra: usize) -> Result<Vec<Complex<f64>>, ChatterError> {
        let period = self.assemble(depth, Effort::Boundary.settings().0 + extra, LONG_PARTS)?.period;
        let mut storage = MapStorage::default();
        let matrix = PeriodMap::new(&period, depth, &mut storage).dense();
        Ok(dense_eigenvalues(matrix)?)
    }

    /// Spectral radius at `depth` (m) with a geometry of its own.
    #[cfg(test)]
    pub(super) fn radius_in(&mut self, geometry: &Geometry, depth: f64) -> Result<f64, ChatterError> {
        let teeth = Teeth { cut: &self.cut, geometry };
        let resolution = Resolution {
            extra: Effort::Boundary.settings().0,
            stiffening: self.stiffening(depth).0,
            most_cycles: LONG_PARTS,
        };
        let period = assemble(&teeth, &self.frame, self.motion, &stretches(geometry, 1), resolution);
        let mut storage = MapStorage::default();
        Ok(Krylov::default().dominant(&mut PeriodMap::new(&period, depth, &mut storage), 1e-10)?.value.norm())
    }

    /// Spectral radius at `depth` (m) with just `nodes` nodes in each stretch in cut, however many
    /// oscillations it holds.
    pub(crate) fn collocated(&self, depth: f64, nodes: usize) -> Result<f64, ChatterError> {
        let geometry = Geometry::new(&self.cut, depth, false)?;
        // Without oscillations to resolve the rule gives LEAST nodes, and `extra` the rest.
        let resolution = Resolution { extra: nodes - LEAST, stiffening: 0.0, most_cycles: LONG_PARTS };
        let teeth = Teeth { cut: &self.cut, geometry: &geometry };
        let period = assemble(&teeth, &self.frame, self.motion, &stretches(&geometry, 1), resolution);
        let mut storage = MapStorage::default();
        let mut map = PeriodMap::new(&period, depth, &mut storage);
        Ok(Krylov::default().dominant(&mut map, 1e-12)?.value.norm())
    }
}
