//! The equations of milling, once for `f64` and dual numbers.

use super::runout::{self, Contact};
use super::{Milling, MillingInput, MillingOutput, MillingState, least};
use crate::vibration::Vibration;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use toolroom_effects::{Context, Terms};
use toolroom_process::Number;

/// Least radial width of cut, m: the least of [`MillingInput::width_of_cut`] (a test compares them).
const LEAST_WIDTH: f64 = 1e-6;

/// Life at which a cut is said not to wear the cutter, s.
const LONGEST_LIFE: f64 = 1e9;

/// Forces on the cutter, mean over a rotation.
struct MeanForce<N> {
    tangential: N,
    feed: N,
    normal: N,
}

/// What sensors and gauges read of a cut.
pub(super) struct Sensed<N> {
    pub cutting_force: N,
    pub feed_force: N,
    pub normal_force: N,
    pub spindle_power: N,
    pub form_error: N,
    /// Roughness that a cutter without chatter leaves.
    pub roughness_ra: N,
}

/// What a rotation looks like: the engagement and its integrals.
#[derive(Clone, Copy, Debug)]
struct Arc<N> {
    angle: N,
    contact: Contact<N>,
    one_minus_cos: N,
    /// `sin²ψ/2`
    square: N,
    /// `ψ/2 − sin 2ψ/4`
    area: N,
}

/// Everything about a cut that does not depend on the state of the cutter but through effects.
#[derive(Clone, Copy, Debug)]
pub(super) struct Engagement<N: Copy = f64> {
    input: MillingInput<N>,
    terms: Terms<N>,
    arc: Arc<N>,
    sharp: Coefficients<N>,
    /// Radial width of cut.
    width: N,
    /// Thickest chip of the heaviest tooth.
    chip: N,
    damage_rate: N,
    chatters: bool,
}

/// Cutting and edge coefficients of the cutter as it is now.
#[derive(Clone, Copy, Debug)]
struct Coefficients<N> {
    tangential_cutting: N,
    tangential_edge: N,
    radial_cutting: N,
    radial_edge: N,
}

impl<N: Number> Milling<N> {
    /// What effects and chatter make of this instant, and whether the cut chatters.
    fn terms(&self, x: &MillingState<N>, u: &MillingInput<N>) -> (Terms<N>, bool) {
        let mut terms = self.effect_terms(x, u);
        if self.structure.is_none() {
            return (terms, false);
        }
        let verdict = self.judged(x, u, &terms);
        terms.mechanical_wear *= verdict.wear_factor;
        (terms, !verdict.stable())
    }

    /// What the effects make of this instant.
    pub(super) fn effect_terms(&self, x: &MillingState<N>, u: &MillingInput<N>) -> Terms<N> {
        self.effects.terms(&Context {
            flank_wear: x.flank_wear,
            cutting_time: x.cutting_time,
            lot_deviation: u.lot_deviation,
            cutting_speed: u.cutting_speed,
            sensor_time: u.sensor_time,
            feed_override: u.feed_override,
            feed_rate: self.feed_rate(u),
            path_curvature: u.path_curvature,
            helical_deviation: u.helical_deviation,
            feed: u.feed_per_tooth,
            depth_of_cut: u.depth_of_cut,
            width_of_cut: u.width_of_cut,
            ..Context::neutral()
        })
    }

    fn feed_rate(&self, u: &MillingInput<N>) -> N {
        let rotation = u.cutting_speed / self.cutter.diameter * 2.0;
        u.feed_per_tooth * self.cutter.teeth * rotation / TAU * u.engaged
    }

    /// Radial width of cut that the cutter meets: at most its diameter, and where there is less stock than planned no less
    /// than the least that an input can be.
    pub(super) fn width(&self, u: &MillingInput<N>, terms: &Terms<N>) -> N {
        let met = least(u.width_of_cut + terms.width_of_cut, self.cutter.diameter);
        if met.re() < LEAST_WIDTH { N::from(LEAST_WIDTH) } else { met }
    }

    /// Engagement angle `ψ = acos(1 − 2 a_e/D)`.
    pub fn engagement_angle(&self, width_of_cut: N) -> N {
        let cosine = -width_of_cut / self.cutter.diameter * 2.0 + 1.0;
        // A slot: the slope of the arc cosine is infinite there.
        if cosine.re() <= -1.0 { N::from(PI) } else { cosine.acos() }
    }

    /// Coefficients of the cutter without wear.
    fn sharp(&self, u: &MillingInput<N>, terms: &Terms<N>) -> Coefficients<N> {
        let f = &self.force;
        let chip = u.hardness_ratio.powd(f.hardness_exponent) * u.force_factor * terms.specific_cutting_force;
        Coefficients {
            tangential_cutting: f.tangential_cutting * chip,
            tangential_edge: f.tangential_edge * u.force_factor,
            radial_cutting: f.radial_cutting * chip,
            radial_edge: f.radial_edge * u.force_factor,
        }
    }

    /// Coefficients of the cutter with a land.
    fn worn(&self, sharp: &Coefficients<N>, flank_wear: N) -> Coefficients<N> {
        Coefficients {
            tangential_edge: sharp.tangential_edge + self.force.flank_shear_stress * flank_wear,
            radial_edge: sharp.radial_edge + self.force.flank_pressure * flank_wear,
            ..*sharp
        }
    }

    fn arc(&self, u: &MillingInput<N>, terms: &Terms<N>) -> Arc<N> {
        let psi = self.engagement_angle(self.width(u, terms));
        let (sin, cos) = (psi.sin(), psi.cos());
        Arc {
            angle: psi,
            contact: Contact::new(self.teeth(), terms.runout / u.feed_per_tooth, psi),
            one_minus_cos: -cos + 1.0,
            square: sin * sin * 0.5,
            area: psi * 0.5 - sin * cos * 0.5,
        }
    }

    /// The cut of this instant.
    pub(super) fn engagement(&self, x: &MillingState<N>, u: &MillingInput<N>) -> Engagement<N> {
        let (terms, chatters) = self.terms(x, u);
        self.engagement_under(u, terms, chatters)
    }

    /// The cut at this instant of a stretch in which it is `unstable` or not, whatever the verdict of this very instant:
    /// stages of a step that passes the end of the stretch see a smooth right-hand side.
    pub(super) fn engagement_while(&self, x: &MillingState<N>, u: &MillingInput<N>, unstable: bool) -> Engagement<N> {
        let terms = if unstable { self.terms(x, u).0 } else { self.effect_terms(x, u) };
        self.engagement_under(u, terms, unstable)
    }

    fn engagement_under(&self, u: &MillingInput<N>, terms: Terms<N>, chatters: bool) -> Engagement<N> {
        let (width, steepest) = (self.width(u, &terms), self.steepest(u, &terms));
        let chip = runout::heaviest(self.teeth(), terms.runout, u.feed_per_tooth * steepest);
        Engagement {
            chatters,
            input: *u,
            terms,
            arc: self.arc(u, &terms),
            sharp: self.sharp(u, &terms),
            width,
            chip,
            // The heaviest tooth decides; under runout its chip is that of a higher feed.
            damage_rate: self.damage_rate(u, &terms, chip / steepest),
        }
    }

    /// `a = a_p/2π`; with sign + in down milling and − in up milling:
    ///
    /// | force | equation |
    /// |---|---|
    /// | F_t | `a [K_tc f_z z (1 − cos ψ) + K_te ∫dφ]` |
    /// | F_n | `a [K_rc f_z z sin²ψ/2 + K_re ∫cos φ dφ ± (K_tc f_z z (ψ/2 − sin 2ψ/4) + K_te ∫sin φ dφ)]` |
    /// | F_f | `a [K_rc f_z z (ψ/2 − sin 2ψ/4) + K_re ∫sin φ dφ ∓ (K_tc f_z z sin²ψ/2 + K_te ∫cos φ dφ)]` |
    ///
    /// The integrals run over the contact of all teeth: `z ψ`, `z (1 − cos ψ)` and `z sin ψ`
    /// without runout, less where runout lifts teeth out of the cut.
    fn mean_force(&self, flank_wear: N, engagement: &Engagement<N>) -> MeanForce<N> {
        let Engagement { input: u, terms, arc, .. } = engagement;
        let Arc { contact, one_minus_cos, square, area, .. } = *arc;
        let k = self.worn(&engagement.sharp, flank_wear);
        let feed = u.feed_per_tooth * self.cutter.teeth;
        let (kt, kr) = (k.tangential_cutting * feed, k.radial_cutting * feed);
        let (et, er) = (k.tangential_edge, k.radial_edge);
        let side = u.down_milling * 2.0 - 1.0;
        let per_angle = u.depth_of_cut * u.engaged / TAU;
        let tangential = kt * one_minus_cos + et * contact.angle;
        let normal = kr * square + er * contact.cosine + side * (kt * area + et * contact.sine);
        let feed = kr * area + er * contact.sine - side * (kt * square + et * contact.cosine);
        MeanForce {
            tangential: per_angle * tangential * terms.cutting_force,
            feed: per_angle * feed * terms.feed_force,
            normal: per_angle * normal * terms.feed_force,
        }
    }

    /// Sine of the angle at which the chip is thickest.
    fn steepest(&self, u: &MillingInput<N>, terms: &Terms<N>) -> N {
        least(self.engagement_angle(self.width(u, terms)), N::from(FRAC_PI_2)).sin()
    }

    pub(super) fn teeth(&self) -> u32 {
        self.cutter.teeth.re() as u32
    }

    /// Share of the tool life used up per second in cut at mid wear, 1/T, at the `feed` per tooth
    /// of the tooth that decides.
    fn damage_rate(&self, u: &MillingInput<N>, terms: &Terms<N>, feed: N) -> N {
        let l = &self.life;
        let power = |speed: N| {
            if speed.re() > 0.0 { (speed / l.reference_speed).powd(l.speed_exponent) } else { N::from(0.0) }
        };
        let speed = Self::mean_over_variation(u, power);
        speed
            * (feed / l.reference_feed).powd(l.feed_exponent)
            * (u.depth_of_cut / l.reference_depth).powd(l.depth_exponent)
            * (self.width(u, terms) / l.reference_width).powd(l.width_exponent)
            * u.hardness_ratio.powd(l.hardness_exponent)
            * u.wear_rate_factor
            * terms.mechanical_wear
            / l.reference_life
    }

    /// Right-hand side: rates per second.
    pub fn rates(&self, x: &MillingState<N>, u: &MillingInput<N>) -> MillingState<N> {
        self.rates_in(&self.engagement(x, u), x)
    }

    /// Right-hand side in a cut that is known already.
    pub(super) fn rates_in(&self, engagement: &Engagement<N>, x: &MillingState<N>) -> MillingState<N> {
        let u = &engagement.input;
        let worn = x.flank_wear / self.life.wear_limit;
        let stage = toolroom_wear::wear_stage(worn, self.life.stage_contrast, self.life.stage_tilt);
        let flank_wear = self.life.wear_limit * engagement.damage_rate * engagement.terms.wear_rate / stage;
        let in_material = engagement.arc.angle / TAU;
        let path = u.cutting_speed * in_material * u.engaged;
        let hazard = self.chipping.hazard_per_path(
            u.chipping_rate + engagement.terms.chipping_rate,
            x.cutting_path,
            x.flank_wear,
        );
        MillingState {
            flank_wear: flank_wear * u.engaged,
            cutting_path: path,
            cutting_time: u.engaged,
            chipping_hazard: hazard * path,
            energy: self.mean_force(x.flank_wear, engagement).tangential * u.cutting_speed,
            chatter_time: if engagement.chatters { u.engaged } else { N::from(0.0) },
        }
    }

    /// Amplitude of the vibration that the teeth force. A structure answers to the cutting part of
    /// the force at the greatest `section` of the chip; edge, land and runout raise it with the peak. Without a
    /// structure one tooth at a time bends the cutter and lets it back (assumption).
    fn forced_amplitude(&self, shaken: &Vibration, peak: N, section: N, k: &Coefficients<N>) -> N {
        if shaken.forced <= 0.0 {
            return peak / self.cutter.static_stiffness * 0.5;
        }
        let (t, r) = (k.tangential_cutting, k.radial_cutting);
        peak / (section * (t * t + r * r).sqrt()) * shaken.forced
    }

    /// What sensors and gauges read.
    #[inline]
    pub(super) fn sensed(&self, engagement: &Engagement<N>, x: &MillingState<N>) -> Sensed<N> {
        let (u, terms, c) = (&engagement.input, &engagement.terms, &self.cutter);
        let force = self.mean_force(x.flank_wear, engagement);
        let scallop = |feed: N| feed * feed / c.diameter * 0.25;
        let marks = scallop(u.feed_per_tooth) + terms.runout * 2.0;
        Sensed {
            cutting_force: force.tangential * terms.force_reading + terms.force_offset,
            feed_force: force.feed * terms.force_reading,
            normal_force: force.normal,
            spindle_power: force.tangential * u.cutting_speed + terms.spindle_loss,
            form_error: force.normal / c.static_stiffness + terms.form_error,
            roughness_ra: least(marks, scallop(u.feed_per_tooth * c.teeth)) * 0.25,
        }
    }

    /// Everything that can be observed.
    ///
    /// | output | equation |
    /// |---|---|
    /// | peak_chip_thickness | `f_z sin φ + 2ρ sin(π/z)`, `φ = min(ψ, π/2)`, ρ the runout, at most what the teeth left |
    /// | peak_tooth_force | `a_p · √((K_tc h + K_te)² + (K_rc h + K_re)²)` at that thickness |
    /// | roughness_ra | `min(f_z²/(4D) + 2ρ, (z f_z)²/(4D))/4`: each tooth leaves its mark until runout lets only the highest one; and `2/π` of the amplitude of chatter, in quadrature (assumption) |
    /// | form_error | `F_n/static_stiffness` |
    /// | size_error | `VB·tan α + (F_n − F_n of the new cutter)/static_stiffness` |
    pub fn observe(&self, x: &MillingState<N>, u: &MillingInput<N>) -> MillingOutput<N> {
        let engagement = self.engagement(x, u);
        let settled = self.effects.is_empty() && self.structure.is_none();
        let unworn = if settled { engagement } else { self.engagement(&unworn(x), u) };
        self.observe_in(&engagement, &unworn, x)
    }

    /// The same in a cut that is known already, and that of the cutter without wear.
    pub(super) fn observe_in(
        &self,
        engagement: &Engagement<N>,
        unworn: &Engagement<N>,
        x: &MillingState<N>,
    ) -> MillingOutput<N> {
        let (u, terms, psi) = (&engagement.input, engagement.terms, engagement.arc.angle);
        let c = &self.cutter;
        let sensed = self.sensed(engagement, x);
        let new = self.mean_force(N::from(0.0), unworn);
        let width = engagement.width;
        let chip = engagement.chip * u.engaged;
        let k = self.worn(&engagement.sharp, x.flank_wear);
        let tangential = (k.tangential_cutting * chip + k.tangential_edge) * terms.cutting_force;
        let radial = (k.radial_cutting * chip + k.radial_edge) * terms.feed_force;
        let rotation = u.cutting_speed / c.diameter * 2.0;
        let feed_rate = self.feed_rate(u);
        let damage = engagement.damage_rate;
        let endless = damage.re() * LONGEST_LIFE <= 1.0;
        let ideal = sensed.roughness_ra;
        let shaken = self.judged(x, u, &terms);
        let peak = u.depth_of_cut * (tangential * tangential + radial * radial).sqrt() * u.engaged;
        let amplitude = self.forced_amplitude(&shaken, peak, u.depth_of_cut * chip, &k) + shaken.chatter;
        let frequency =
            if shaken.chatter > 0.0 { N::from(shaken.frequency) } else { rotation * c.teeth / TAU * u.engaged };
        MillingOutput {
            flank_wear: x.flank_wear,
            wear_ratio: x.flank_wear / self.life.wear_limit,
            tool_life: if endless { N::from(LONGEST_LIFE) } else { damage.recip() },
            cutting_force: sensed.cutting_force,
            feed_force: sensed.feed_force,
            normal_force: sensed.normal_force,
            peak_tooth_force: peak,
            spindle_power: sensed.spindle_power,
            spindle_speed: rotation,
            feed_rate,
            material_removal_rate: u.depth_of_cut * width * feed_rate,
            engagement_angle: psi,
            peak_chip_thickness: chip,
            roughness_ra: if shaken.chatter > 0.0 {
                (ideal * ideal + (2.0 / PI * shaken.chatter).powi(2)).sqrt()
            } else {
                ideal
            },
            form_error: sensed.form_error,
            size_error: x.flank_wear * c.clearance_angle.tan()
                + (sensed.normal_force - new.normal) / c.static_stiffness,
            stable: N::from(f64::from(u8::from(shaken.stable()))),
            stability_margin: N::from(shaken.margin),
            vibration_amplitude: amplitude,
            vibration_rms: amplitude * std::f64::consts::FRAC_1_SQRT_2,
            dominant_frequency: frequency,
            chatter_growth_rate: if shaken.stable() { N::from(0.0) } else { N::from(self.growth_rate(x, u, &terms)) },
            force_ripple: N::from(shaken.force_ripple),
        }
    }
}

/// The same cutter without wear.
pub(super) fn unworn<N: Number>(x: &MillingState<N>) -> MillingState<N> {
    MillingState { flank_wear: N::from(0.0), ..*x }
}

impl Engagement {
    /// The cut of the same input under `terms` that differ from its own in nothing that moves a tooth,
    /// and another `factor` on the rate of wear; `None` where they do.
    #[inline]
    pub(super) fn under(&self, terms: &Terms<f64>, factor: f64) -> Option<Self> {
        let held_terms = &self.terms;
        if terms.runout != held_terms.runout || terms.width_of_cut != held_terms.width_of_cut {
            return None;
        }
        let chip = terms.specific_cutting_force / held_terms.specific_cutting_force;
        Some(Self {
            terms: *terms,
            sharp: Coefficients {
                tangential_cutting: self.sharp.tangential_cutting * chip,
                radial_cutting: self.sharp.radial_cutting * chip,
                ..self.sharp
            },
            damage_rate: self.damage_rate * factor * (terms.mechanical_wear / held_terms.mechanical_wear),
            ..*self
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use toolroom_process::Record;

    #[test]
    fn the_least_width_is_that_of_an_input() {
        let fields = MillingInput::<f64>::FIELDS;
        let width = fields.iter().find(|field| field.name == "width_of_cut").expect("the width");
        assert_eq!(width.min, LEAST_WIDTH);
    }
}
