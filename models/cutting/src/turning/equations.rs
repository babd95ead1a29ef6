//! The equations of turning, once for `f64` and dual numbers.

use super::{Turning, TurningInput, TurningOutput, TurningState};
use crate::vibration::HeldChatter;
use toolroom_effects::{Context, Terms};
use toolroom_process::Number;
use toolroom_wear::{Coefficients, Contact, Cut, Load, Pair, Wear, WearLaw};

/// The contact and the forces of one instant: everything that does not depend on the state of
/// the edge but through effects.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Engagement<'a, N: Copy = f64> {
    contact: Contact<'a, N>,
    load: Load<N>,
    terms: Terms<N>,
    ambient: N,
    chatters: bool,
}

/// Readings of force, power and temperature.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sensed<N> {
    pub cutting_force: N,
    pub feed_force: N,
    pub spindle_power: N,
    pub temperature: N,
}

/// What is kept of an [`Engagement`] without effects, that nothing changes but the edge's wear.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kept {
    contact: Coefficients,
    load: Load<f64>,
}

impl Engagement<'_> {
    /// What is kept of it where there are no effects.
    pub(super) fn keep(&self) -> Kept {
        debug_assert!(self.terms == Terms::neutral(), "without effects");
        Kept { contact: self.contact.coefficients(), load: self.load }
    }
}

impl Kept {
    /// The same at another speed, m/s.
    #[inline]
    pub fn change_speed(&mut self, pair: &Pair, cutting_speed: f64) {
        self.contact.change_speed(pair, cutting_speed);
        self.load = pair.force.at_speed(&self.load, cutting_speed);
    }
}

/// What the angles of the edge make of a cut, whatever its speed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Angles<N> {
    /// Uncut chip thickness, m.
    chip_thickness: N,
    /// Tangents of the cutting edge angle and of the clearance angle.
    cutting_edge: N,
    clearance: N,
}

/// Outputs that the motion decides by itself.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motion<N> {
    /// Of the spindle, rad/s.
    pub spindle_speed: N,
    /// m3/s.
    pub material_removal_rate: N,
    /// Roughness Ra of the ideal profile, m.
    pub marks: N,
}

/// Outputs of the force that presses tool and workpiece apart.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pressed<N> {
    /// N.
    pub passive_force: N,
    /// m.
    pub size_error: N,
}

impl Turning {
    /// The engagement of which something was kept.
    #[inline]
    pub(super) fn engagement_of(&self, kept: &Kept) -> Engagement<'_> {
        Engagement::settled(self.pair.contact_of(kept.contact), kept.load, Terms::neutral())
    }
}

impl<'a> Engagement<'a> {
    /// The engagement of a cut that does not chatter.
    #[inline]
    pub(super) fn settled(contact: Contact<'a>, load: Load<f64>, terms: Terms<f64>) -> Self {
        Self { ambient: contact.ambient(), contact, load, terms, chatters: false }
    }
}

impl<N: Number> Engagement<'_, N> {
    /// The same at another speed.
    #[inline]
    pub fn at_speed(&self, pair: &Pair<N>, cutting_speed: N) -> Self {
        Self {
            contact: self.contact.at_speed(cutting_speed),
            load: pair.force.at_speed(&self.load, cutting_speed),
            ..*self
        }
    }

    /// Cutting speed (m/s).
    #[inline]
    pub fn cutting_speed(&self) -> N {
        self.contact.cut().cutting_speed
    }

    /// What softening of the hot work material leaves of the specific cutting force at a contact
    /// temperature.
    #[inline]
    fn softened(&self, temperature: N) -> N {
        -(self.terms.thermal_softening * (temperature - self.ambient)) + 1.0
    }

    /// Cutting and feed force before the reading, where softening leaves the share `warm`, N.
    #[inline]
    fn forces(&self, flank_wear: N, warm: N) -> [N; 2] {
        let (load, engaged) = (self.load.times(warm), self.contact.cut().engaged);
        let cutting = load.cutting(flank_wear) * engaged * self.terms.cutting_force;
        [cutting, load.feed(flank_wear) * engaged * self.terms.feed_force]
    }

    /// Thermo-EMF (V).
    #[inline]
    pub(super) fn thermo_emf(&self, x: &TurningState<N>, angles: &Angles<N>) -> N {
        self.contact.thermo_emf_of_chip(x.flank_wear, self.contact.temperature_at(&x.wear()), angles.chip_thickness)
    }

    /// Wear per path.
    #[inline]
    pub(super) fn wear_intensity(&self, x: &TurningState<N>) -> N {
        self.contact.wear_intensity(self.wear(x))
    }

    /// Balance of mechanical and thermal wear.
    #[inline]
    pub(super) fn wear_balance(&self, x: &TurningState<N>) -> N {
        self.contact.wear_balance(x.flank_wear, self.contact.temperature_at(&x.wear()), self.wear(x))
    }

    /// Rates of wear at the present contact temperature.
    #[inline]
    pub(super) fn wear(&self, x: &TurningState<N>) -> Wear<N> {
        self.contact.wear(x.flank_wear, self.contact.temperature_at(&x.wear()), x.thermal_damage)
    }

    /// Readings at a contact temperature with the forces that it leaves.
    #[inline]
    fn readings(&self, temperature: N, [cutting_force, feed_force]: [N; 2], cutting_speed: N) -> Sensed<N> {
        let terms = &self.terms;
        Sensed {
            cutting_force: cutting_force * terms.force_reading + terms.force_offset,
            feed_force: feed_force * terms.force_reading,
            spindle_power: cutting_force * cutting_speed + terms.spindle_loss,
            temperature: temperature + terms.temperature_offset,
        }
    }

    /// Cutting and feed force before the reading, N.
    #[inline]
    pub(super) fn true_forces(&self, x: &TurningState<N>) -> [N; 2] {
        self.forces(x.flank_wear, self.softened(self.contact.temperature_at(&x.wear())))
    }

    /// What sensors of force, power and temperature show; the rest of [`Turning::observe`] costs more.
    #[inline]
    pub fn sensed(&self, x: &TurningState<N>, u: &TurningInput<N>) -> Sensed<N> {
        let temperature = self.contact.temperature_at(&x.wear());
        self.readings(temperature, self.forces(x.flank_wear, self.softened(temperature)), u.cutting_speed)
    }

    /// Right-hand side: rates per second.
    // Always inlined, and what it calls: the rates of one stage reach the next one in registers.
    #[inline(always)]
    pub fn rates(&self, x: &TurningState<N>) -> TurningState<N> {
        let wear = self.contact.derivative(&x.wear());
        let cut = self.contact.cut();
        let warm = self.softened(self.contact.temperature_at(&x.wear()));
        let force = self.load.times(warm).cutting(x.flank_wear) * self.terms.cutting_force;
        TurningState {
            flank_wear: wear.flank_wear,
            tool_body_temperature_rise: wear.body_temperature_rise,
            thermal_damage: wear.thermal_damage,
            mechanical_wear: wear.mechanical_wear,
            thermal_wear: wear.thermal_wear,
            cutting_path: wear.path,
            cutting_time: wear.cutting_time,
            chipping_hazard: wear.chipping_hazard,
            energy: force * cut.cutting_speed * cut.engaged,
            chatter_time: if self.chatters { cut.engaged } else { N::from(0.0) },
        }
    }

    /// Event functions in the order of [`WEAR_EVENTS`](toolroom_wear::WEAR_EVENTS).
    #[inline]
    pub fn event_indicators(&self, x: &TurningState<N>, chipping_resistance: f64) -> [N; 3] {
        self.contact.event_indicators(&x.wear(), chipping_resistance)
    }
}

impl<N: Number> Turning<N> {
    /// What effects and chatter make of this instant, and whether the cut chatters.
    pub(crate) fn terms(&self, x: &TurningState<N>, u: &TurningInput<N>) -> (Terms<N>, bool) {
        let mut terms = self.effect_terms(x, u);
        if self.structure.is_none() {
            return (terms, false);
        }
        let verdict = self.judged(x, u, &terms);
        terms.mechanical_wear *= verdict.wear_factor;
        (terms, !verdict.stable())
    }

    /// What the effects make of this instant.
    pub(super) fn effect_terms(&self, x: &TurningState<N>, u: &TurningInput<N>) -> Terms<N> {
        self.effects.terms(&Context {
            flank_wear: x.flank_wear,
            cutting_time: x.cutting_time,
            coolant_age: u.coolant_age,
            lot_deviation: u.lot_deviation,
            cutting_speed: u.cutting_speed,
            pass_time: u.pass_time,
            sensor_time: u.sensor_time,
            feed_override: u.feed_override,
            feed: u.feed_per_rev,
            depth_of_cut: u.depth_of_cut,
            workpiece_diameter: u.workpiece_diameter,
            ..Context::neutral()
        })
    }

    /// The cut that the edge meets: command, scatter and effects together.
    pub(crate) fn cut(&self, u: &TurningInput<N>, terms: &Terms<N>) -> Cut<N> {
        let own_damage_rate = match &self.pair.law {
            WearLaw::EnergyBalance(law) => law.damage_rate,
            WearLaw::ExtendedTaylor(_) | WearLaw::TakeyamaMurata(_) | WearLaw::Usui(_) => N::from(0.0),
        };
        Cut {
            cutting_speed: u.cutting_speed,
            feed_per_rev: u.feed_per_rev,
            depth_of_cut: u.depth_of_cut,
            engaged: u.engaged,
            hardness: u.hardness_ratio,
            mechanical_factor: u.mechanical_wear_factor * terms.mechanical_wear,
            thermal_factor: u.thermal_wear_factor,
            wear_factor: u.wear_rate_factor * terms.wear_rate,
            temperature_factor: terms.temperature_rise,
            force_factor: u.force_factor * terms.specific_cutting_force,
            flank_shear_factor: u.flank_shear_factor,
            flank_pressure_factor: u.flank_pressure_factor,
            damage_rate: if own_damage_rate.re() > 0.0 { N::from(0.0) } else { self.finish.thermal_damage_rate },
            damage_gain: terms.thermal_damage_coupling,
            chipping_rate: u.chipping_rate + terms.chipping_rate,
        }
    }

    /// The contact of the edge at this instant.
    pub(crate) fn engagement(&self, x: &TurningState<N>, u: &TurningInput<N>) -> Engagement<'_, N> {
        let (terms, chatters) = self.terms(x, u);
        self.engagement_under(u, terms, chatters)
    }

    /// The contact at this instant of a stretch in which the cut is stable or has `held` chatter, whatever the verdict of this very
    /// instant: stages of a step that passes the end of the stretch see a smooth right-hand side.
    pub(super) fn engagement_while(
        &self,
        x: &TurningState<N>,
        u: &TurningInput<N>,
        held: Option<&HeldChatter>,
    ) -> Engagement<'_, N> {
        let mut terms = self.effect_terms(x, u);
        if let Some(held) = held {
            terms.mechanical_wear *= self.chatter_wear(x, u, &terms, held);
        }
        self.engagement_under(u, terms, held.is_some())
    }

    fn engagement_under(&self, u: &TurningInput<N>, terms: Terms<N>, chatters: bool) -> Engagement<'_, N> {
        let cut = self.cut(u, &terms);
        Engagement {
            chatters,
            contact: self.pair.contact(&cut),
            load: self.pair.force.load(&cut),
            terms,
            ambient: self.pair.temperature.ambient_temperature,
        }
    }

    /// Right-hand side: rates per second.
    pub fn rates(&self, x: &TurningState<N>, u: &TurningInput<N>) -> TurningState<N> {
        self.mean_rates(&self.engagement(x, u), x, u)
    }

    /// Everything that can be observed, as the sensors read it: their effects act on forces,
    /// temperature and power.
    ///
    /// | output | equation |
    /// |---|---|
    /// | passive_force | `feed_force / tan κ` |
    /// | peak_cutting_force | cutting force at `depth_of_cut + runout` |
    /// | roughness_ra | `f²/(32 r_ε)`, the ideal profile (Rz = f²/(8 r_ε), Ra ≈ Rz/4), and `2/π` of the amplitude of chatter, in quadrature (assumption) |
    /// | size_error | `flank_wear·tan α_o + (F_p - F_p of the new edge)/static_stiffness` |
    pub fn observe(&self, x: &TurningState<N>, u: &TurningInput<N>) -> TurningOutput<N> {
        self.observe_in(&self.engagement(x, u), x, u)
    }

    /// The same in an engagement that is known already.
    pub(crate) fn observe_in(
        &self,
        engagement: &Engagement<'_, N>,
        x: &TurningState<N>,
        u: &TurningInput<N>,
    ) -> TurningOutput<N> {
        self.observe_at(engagement, &self.angles(engagement), x, u)
    }

    /// The angles of an engagement.
    pub(super) fn angles(&self, engagement: &Engagement<'_, N>) -> Angles<N> {
        Angles {
            chip_thickness: self.pair.force.chip_thickness(engagement.contact.cut()),
            cutting_edge: self.pair.force.cutting_edge_angle.tan(),
            clearance: self.finish.clearance_angle.tan(),
        }
    }

    /// The land against the wear limit.
    #[inline]
    pub(super) fn wear_ratio(&self, x: &TurningState<N>) -> N {
        x.flank_wear / self.pair.limits.wear_limit
    }

    /// What the motion decides.
    #[inline]
    pub(super) fn motion(&self, u: &TurningInput<N>) -> Motion<N> {
        Motion {
            spindle_speed: u.cutting_speed / u.workpiece_diameter * 2.0,
            material_removal_rate: u.cutting_speed * u.feed_per_rev * u.depth_of_cut * u.engaged,
            marks: u.feed_per_rev * u.feed_per_rev / self.finish.corner_radius / 32.0,
        }
    }

    /// What the feed force makes by the cutting edge angle.
    #[inline]
    pub(super) fn pressed(
        &self,
        engagement: &Engagement<'_, N>,
        angles: &Angles<N>,
        flank_wear: N,
        feed_force: N,
    ) -> Pressed<N> {
        let new_feed_force = engagement.load.feed(N::from(0.0)) * engagement.contact.cut().engaged;
        let deflection = (feed_force - new_feed_force) / angles.cutting_edge / self.finish.static_stiffness;
        Pressed {
            passive_force: feed_force / angles.cutting_edge,
            size_error: flank_wear * angles.clearance + deflection,
        }
    }

    /// The same with its angles, which are known as well.
    #[inline]
    pub(super) fn observe_at(
        &self,
        engagement: &Engagement<'_, N>,
        angles: &Angles<N>,
        x: &TurningState<N>,
        u: &TurningInput<N>,
    ) -> TurningOutput<N> {
        let Engagement { contact, load, terms, .. } = engagement;
        let cut = contact.cut();
        let (wear, body, damage) = (x.flank_wear, x.tool_body_temperature_rise, x.thermal_damage);
        let point = contact.point_of_chip(load, wear, body, damage, angles.chip_thickness);
        let warm = engagement.softened(point.temperature);
        let forces = engagement.forces(x.flank_wear, warm);
        let sensed = engagement.readings(point.temperature, forces, u.cutting_speed);
        let [_, feed_force] = forces;
        let Pressed { passive_force, size_error } = self.pressed(engagement, angles, x.flank_wear, feed_force);
        let runs_true = N::NDERIV == 0 && terms.runout.re() == 0.0;
        let eccentric = Cut { depth_of_cut: cut.depth_of_cut + terms.runout, ..*cut };
        let peak = if runs_true { *load } else { self.pair.force.load(&eccentric) };
        let shaken = self.shaken(x, u, terms, passive_force);
        let Motion { spindle_speed, material_removal_rate, marks } = self.motion(u);
        TurningOutput {
            flank_wear: x.flank_wear,
            wear_ratio: self.wear_ratio(x),
            temperature: sensed.temperature,
            mechanical_wear_per_path: point.mechanical_wear_per_path,
            thermal_wear_rate: point.thermal_wear_rate,
            wear_intensity: point.wear_intensity,
            wear_balance: point.wear_balance,
            cutting_force: sensed.cutting_force,
            feed_force: sensed.feed_force,
            passive_force,
            peak_cutting_force: peak.times(warm).cutting(x.flank_wear) * terms.cutting_force * cut.engaged,
            spindle_power: sensed.spindle_power,
            thermo_emf: point.thermo_emf,
            spindle_speed,
            material_removal_rate,
            roughness_ra: if shaken.roughness > 0.0 { hypotenuse(marks, shaken.roughness) } else { marks },
            size_error,
            stable: N::from(f64::from(u8::from(shaken.verdict.stable()))),
            stability_margin: N::from(shaken.verdict.margin),
            vibration_amplitude: shaken.amplitude,
            vibration_rms: shaken.amplitude * std::f64::consts::FRAC_1_SQRT_2,
            dominant_frequency: shaken.frequency,
            chatter_growth_rate: N::from(shaken.growth_rate),
            force_ripple: N::from(shaken.verdict.force_ripple),
        }
    }
}

/// Two contributions to the roughness together.
fn hypotenuse<N: Number>(marks: N, vibration: f64) -> N {
    (marks * marks + vibration * vibration).sqrt()
}
