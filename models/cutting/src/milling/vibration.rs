//! Verdicts of milling.

use super::{Milling, MillingInput, MillingState};
use crate::vibration::{ModeFactors, RoundedVerdict, Tooth, ToothCell, Vibration, variation};
use std::f64::consts::FRAC_1_SQRT_2;
use toolroom_effects::Terms;
use toolroom_process::Number;

impl<N: Number> Milling<N> {
    /// How the cut vibrates: the verdict of the structure, without derivatives.
    pub fn vibration(&self, x: &MillingState<N>, u: &MillingInput<N>) -> Vibration {
        if self.structure.is_none() {
            return Vibration::NONE;
        }
        self.judged(x, u, &self.effect_terms(x, u))
    }

    /// Depth (m) at which the cut becomes unstable, and the frequency (Hz) of that vibration; `None` without a structure. Limits
    /// are searched up to two to four times the depth of `u`: where none lies there, the depth is the last that was searched
    /// and the frequency 0. It is that of [`Milling::vibration`] at less cost: nothing beyond the limit is worked out.
    pub fn stability_limit(&self, x: &MillingState<N>, u: &MillingInput<N>) -> Option<(f64, f64)> {
        let structure = self.structure.as_ref()?;
        Some(structure.limit(&self.tooth(x, u, &self.effect_terms(x, u))))
    }

    /// The cut as the stability model sees it; `None` without a structure, and where it is none.
    pub fn regenerative(&self, x: &MillingState<N>, u: &MillingInput<N>) -> Option<toolroom_chatter::Milling> {
        let tooth = self.tooth(x, u, &self.effect_terms(x, u));
        self.structure.as_ref()?.regenerative(&tooth).ok()
    }

    /// The verdict under effects that are worked out.
    pub(super) fn judged(&self, x: &MillingState<N>, u: &MillingInput<N>, terms: &Terms<N>) -> Vibration {
        match &self.structure {
            Some(structure) if u.engaged.re() > 0.0 && u.cutting_speed.re() > 0.0 => {
                structure.vibration(&self.tooth(x, u, terms))
            }
            _ => Vibration::NONE,
        }
    }

    /// Whether the cut is unstable, and what this was rounded to.
    pub(super) fn judge(&self, x: &MillingState<N>, u: &MillingInput<N>) -> RoundedVerdict<ToothCell> {
        match &self.structure {
            Some(structure) if u.engaged.re() > 0.0 && u.cutting_speed.re() > 0.0 => {
                structure.judge(&self.tooth(x, u, &self.effect_terms(x, u)))
            }
            _ => RoundedVerdict::QUIET,
        }
    }

    /// Rate at which an unstable vibration grows (1/s).
    pub(super) fn growth_rate(&self, x: &MillingState<N>, u: &MillingInput<N>, terms: &Terms<N>) -> f64 {
        let rate = |structure: &crate::MillingStructure| structure.growth_rate(&self.tooth(x, u, terms));
        self.structure.as_deref().map_or(0.0, rate).max(0.0)
    }

    fn tooth(&self, x: &MillingState<N>, u: &MillingInput<N>, terms: &Terms<N>) -> Tooth {
        let force = &self.force;
        let chip = u.hardness_ratio.powd(force.hardness_exponent) * u.force_factor * terms.specific_cutting_force;
        Tooth {
            spindle_speed: 2.0 * u.cutting_speed.re() / self.cutter.diameter.re(),
            depth: u.depth_of_cut.re(),
            feed_per_tooth: u.feed_per_tooth.re(),
            diameter: self.cutter.diameter.re(),
            teeth: self.teeth(),
            width: self.width(u, terms).re(),
            down: u.down_milling.re() > 0.5,
            flank_wear: x.flank_wear.re(),
            wear_ratio: (x.flank_wear / self.life.wear_limit).re(),
            tangential: (force.tangential_cutting * chip).re(),
            radial: (force.radial_cutting * chip).re(),
            process_damping: terms.process_damping.re(),
            runout: terms.runout.re(),
            modes: ModeFactors::new(u.natural_frequency_factor, u.modal_damping_factor, terms),
            variation: variation(u.speed_variation.re(), u.variation_revolutions.re()),
        }
    }

    /// Mean of `of` the cutting speed where the speed varies: over its two Chebyshev nodes, exact
    /// up to cubes of the variation.
    pub(super) fn mean_over_variation(u: &MillingInput<N>, quantity: impl Fn(N) -> N) -> N {
        if u.speed_variation.re() <= 0.0 {
            return quantity(u.cutting_speed);
        }
        let extreme = |sign: f64| quantity(u.cutting_speed * (u.speed_variation * (sign * FRAC_1_SQRT_2) + 1.0));
        (extreme(-1.0) + extreme(1.0)) * 0.5
    }
}
