//! Verdicts of turning.

use super::equations::Engagement;
use super::{Turning, TurningInput, TurningState};
use crate::vibration::{Edge, EdgeCell, HeldChatter, ModeFactors, RoundedVerdict, Vibration, variation};
use std::f64::consts::{FRAC_1_SQRT_2, PI, TAU};
use toolroom_effects::Terms;
use toolroom_process::Number;

/// What vibration adds to the outputs.
pub(super) struct Shaken<N> {
    pub verdict: Vibration,
    /// Amplitude of everything that vibrates (m).
    pub amplitude: N,
    /// Of the strongest vibration (Hz).
    pub frequency: N,
    /// 1/s.
    pub growth_rate: f64,
    /// Marks on the surface, Ra (m).
    pub roughness: f64,
}

impl<N: Number> Turning<N> {
    /// How the cut vibrates by itself: the verdict of the structure, without derivatives.
    pub fn vibration(&self, x: &TurningState<N>, u: &TurningInput<N>) -> Vibration {
        if self.structure.is_none() {
            return Vibration::NONE;
        }
        self.judged(x, u, &self.effect_terms(x, u))
    }

    /// Depth (m) at which the cut becomes unstable, infinite where none does, and the frequency (Hz) of that vibration; `None`
    /// without a structure. It is that of [`Turning::vibration`] at less cost: nothing beyond the limit is worked out.
    pub fn stability_limit(&self, x: &TurningState<N>, u: &TurningInput<N>) -> Option<(f64, f64)> {
        let structure = self.structure.as_ref()?;
        Some(structure.limit(&self.edge(x, u, &self.effect_terms(x, u))))
    }

    /// The cut as the stability model sees it; `None` without a structure, and where it is none.
    pub fn regenerative(&self, x: &TurningState<N>, u: &TurningInput<N>) -> Option<toolroom_chatter::Turning> {
        let edge = self.edge(x, u, &self.effect_terms(x, u));
        self.structure.as_ref()?.regenerative(&edge).ok()
    }

    /// The verdict under effects that are worked out.
    pub(super) fn judged(&self, x: &TurningState<N>, u: &TurningInput<N>, terms: &Terms<N>) -> Vibration {
        match &self.structure {
            Some(structure) if u.engaged.re() > 0.0 && u.cutting_speed.re() > 0.0 => {
                structure.vibration(&self.edge(x, u, terms))
            }
            _ => Vibration::NONE,
        }
    }

    /// Whether the cut is unstable, and what this was rounded to.
    pub(super) fn judge(&self, x: &TurningState<N>, u: &TurningInput<N>) -> RoundedVerdict<EdgeCell> {
        match &self.structure {
            Some(structure) if u.engaged.re() > 0.0 && u.cutting_speed.re() > 0.0 => {
                structure.judge(&self.edge(x, u, &self.effect_terms(x, u)))
            }
            _ => RoundedVerdict::QUIET,
        }
    }

    /// How the cut chatters at this instant; `None` where it is stable.
    pub(super) fn chatter(&self, x: &TurningState<N>, u: &TurningInput<N>) -> Option<HeldChatter> {
        let structure = self.structure.as_ref().filter(|_| self.judge(x, u).unstable)?;
        Some(structure.chatter(&self.edge(x, u, &self.effect_terms(x, u))))
    }

    /// Factor on force-driven wear at this instant of a stretch whose chatter is held.
    pub(super) fn chatter_wear(
        &self,
        x: &TurningState<N>,
        u: &TurningInput<N>,
        terms: &Terms<N>,
        held: &HeldChatter,
    ) -> f64 {
        self.structure.as_ref().map_or(1.0, |structure| structure.wear_factor(&self.edge(x, u, terms), held))
    }

    fn edge(&self, x: &TurningState<N>, u: &TurningInput<N>, terms: &Terms<N>) -> Edge {
        let hardness = u.hardness_ratio.powd(self.pair.force.hardness_exponent);
        Edge {
            spindle_speed: 2.0 * u.cutting_speed.re() / u.workpiece_diameter.re(),
            depth: u.depth_of_cut.re(),
            feed: u.feed_per_rev.re(),
            diameter: u.workpiece_diameter.re(),
            flank_wear: x.flank_wear.re(),
            wear_ratio: (x.flank_wear / self.pair.limits.wear_limit).re(),
            coefficient: (hardness * u.force_factor * terms.specific_cutting_force).re(),
            process_damping: terms.process_damping.re(),
            modulation: terms.chuck_modulation.re(),
            position: u.position.re(),
            modes: ModeFactors::new(u.natural_frequency_factor, u.modal_damping_factor, terms),
            variation: variation(u.speed_variation.re(), u.variation_revolutions.re()),
        }
    }

    /// Chatter and forced vibration together. Chip formation, a blank that runs out and a modulated
    /// chuck move the tool by what they change of `passive_force` over the static stiffness, the
    /// latter two once and three times a revolution; amplitudes add up as if in phase.
    pub(super) fn shaken(
        &self,
        x: &TurningState<N>,
        u: &TurningInput<N>,
        terms: &Terms<N>,
        passive_force: N,
    ) -> Shaken<N> {
        let verdict = self.judged(x, u, terms);
        let deflection = passive_force / self.finish.static_stiffness;
        let eccentric = deflection * terms.runout / u.depth_of_cut;
        let lobed = deflection * terms.chuck_modulation;
        let rotation = u.cutting_speed / u.workpiece_diameter * (2.0 / TAU);
        let frequency = if verdict.chatter > 0.0 {
            N::from(verdict.frequency)
        } else if lobed.re() > eccentric.re() {
            rotation * 3.0
        } else if eccentric.re() > 0.0 {
            rotation
        } else {
            N::from(0.0)
        };
        let growth_rate = match &self.structure {
            Some(structure) if !verdict.stable() => structure.growth_rate(&self.edge(x, u, terms)).max(0.0),
            _ => 0.0,
        };
        Shaken {
            amplitude: deflection * self.finish.force_fluctuation + eccentric + lobed + verdict.chatter,
            frequency,
            growth_rate,
            roughness: 2.0 / PI * verdict.chatter,
            verdict,
        }
    }

    /// Rates at a speed that varies as the input says: the mean over the two Chebyshev nodes of a
    /// sinusoid, exact up to cubes of the variation.
    #[inline]
    pub(super) fn mean_rates(
        &self,
        engagement: &Engagement<'_, N>,
        x: &TurningState<N>,
        u: &TurningInput<N>,
    ) -> TurningState<N> {
        if u.speed_variation.re() <= 0.0 {
            return engagement.rates(x);
        }
        let node = |sign: f64| {
            let speed = engagement.cutting_speed() * (u.speed_variation * (sign * FRAC_1_SQRT_2) + 1.0);
            engagement.at_speed(&self.pair, speed).rates(x)
        };
        let (slow, fast) = (node(-1.0), node(1.0));
        let mean = |of: fn(&TurningState<N>) -> N| (of(&slow) + of(&fast)) * 0.5;
        TurningState {
            flank_wear: mean(|rates| rates.flank_wear),
            tool_body_temperature_rise: mean(|rates| rates.tool_body_temperature_rise),
            thermal_damage: mean(|rates| rates.thermal_damage),
            mechanical_wear: mean(|rates| rates.mechanical_wear),
            thermal_wear: mean(|rates| rates.thermal_wear),
            cutting_path: mean(|rates| rates.cutting_path),
            cutting_time: slow.cutting_time,
            chipping_hazard: mean(|rates| rates.chipping_hazard),
            energy: mean(|rates| rates.energy),
            chatter_time: slow.chatter_time,
        }
    }
}
