//! The state of an edge and how it changes.

use crate::{Contact, Cut, Pair};
use toolroom_process::ode::{self, Tolerance};
use toolroom_process::{ModelError, Number, ProcessEvent, Record, record};

record! {
    /// Everything that changes of one edge. A new edge starts from the defaults, or from the
    /// flank wear that its edge condition amounts to.
    ///
    /// `flank_wear - initial flank_wear = mechanical_wear + thermal_wear` at all times.
    pub struct WearState {
        /// Flank wear h, the width of the land.
        flank_wear: Real["m" => "mm"] = 0.0, 0.0..=1.0;
        /// Temperature rise of the tool body.
        body_temperature_rise: Real["K" => "K"] = 0.0, 0.0..=1e5;
        /// Thermal damage D of the near-surface layer, the inherited part of wear.
        thermal_damage: Real = 0.0, 0.0..=1.0;
        /// Functional of force and path, F_M.
        mechanical_wear: Real["m" => "mm"] = 0.0, 0.0..=1.0;
        /// Functional of temperature and time, F_T.
        thermal_wear: Real["m" => "mm"] = 0.0, 0.0..=1.0;
        /// Cutting path L.
        path: Real["m" => "m"] = 0.0, 0.0..=1e9;
        /// Time in cut.
        cutting_time: Real["s" => "min"] = 0.0, 0.0..=1e9;
        /// Accumulated chipping hazard.
        chipping_hazard: Real = 0.0, 0.0..=1e9;
    }
}

/// Number of components of [`WearState`].
const LEN: usize = <WearState as Record>::LEN;

impl WearState {
    /// An edge as mounted, with a land of `flank_wear`.
    pub fn mounted(flank_wear: f64) -> Self {
        Self { flank_wear, ..Self::default() }
    }
}

/// Where an edge stopped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeRun {
    /// Its state then.
    pub state: WearState,
    /// Time since the start, s.
    pub elapsed: f64,
    /// What stopped it; `None` where the time ran out.
    pub event: Option<ProcessEvent>,
    /// Calls of the right-hand side.
    pub evaluations: u32,
}

/// Events that end an edge, in the order of [`Pair::event_indicators`].
pub const WEAR_EVENTS: [ProcessEvent; 3] =
    [ProcessEvent::WearLimit, ProcessEvent::ThermalCollapse, ProcessEvent::Chipping];

impl<N: Number> Pair<N> {
    /// Right-hand side of the state of an edge under `cut`: rates per second.
    ///
    /// | state | rate (u = engaged) |
    /// |---|---|
    /// | flank_wear | `u·(v·A + B)` |
    /// | mechanical_wear, thermal_wear | `u·v·A`, `u·B` |
    /// | body_temperature_rise | `(u·(chip + flank) - body)/body_time_constant` |
    /// | thermal_damage | `u·(k_D·psi·(1 - D) - D·(d flank_wear/dt)/damage_wear_depth)`, where damage_gain > 0 |
    /// | path, cutting_time | `u·v`, `u` |
    /// | chipping_hazard | `u·v·hazard_per_path` |
    ///
    /// # Source
    /// Postnov & Shafikov, eqs. (6) and (10); the equations of body and damage are assumptions.
    pub fn derivative(&self, state: &WearState<N>, cut: &Cut<N>) -> WearState<N> {
        self.contact(cut).derivative(state)
    }

    /// Contact temperature at a state of the edge, K.
    pub fn contact_temperature(&self, state: &WearState<N>, cut: &Cut<N>) -> N {
        self.contact(cut).temperature_at(state)
    }

    /// Everything that can be observed at a state of the edge.
    pub fn output(&self, state: &WearState<N>, cut: &Cut<N>) -> crate::Point<N> {
        let load = self.force.load(cut);
        self.contact(cut).point(&load, state.flank_wear, state.body_temperature_rise, state.thermal_damage)
    }

    /// Event functions, negative before the event, in the order of [`WEAR_EVENTS`].
    /// `chipping_resistance` is the hazard that the edge bears, infinite where chipping is off.
    pub fn event_indicators(&self, state: &WearState<N>, cut: &Cut<N>, chipping_resistance: f64) -> [N; 3] {
        self.contact(cut).event_indicators(state, chipping_resistance)
    }
}

impl<N: Number> Contact<'_, N> {
    /// [`Pair::derivative`] under the cut of this contact.
    #[inline(always)]
    pub fn derivative(&self, state: &WearState<N>) -> WearState<N> {
        let (pair, cut) = (self.pair, self.cut());
        let rise = self.rise(state.flank_wear);
        let temperature = self.temperature(rise, state.body_temperature_rise);
        let wear = self.wear(state.flank_wear, temperature, state.thermal_damage);
        let speed = cut.engaged * cut.cutting_speed;
        let mechanical_wear = speed * wear.mechanical_per_path;
        let thermal_wear = cut.engaged * wear.thermal_rate;
        let flank_wear = mechanical_wear + thermal_wear;
        WearState {
            flank_wear,
            body_temperature_rise: (cut.engaged * rise - state.body_temperature_rise)
                / pair.temperature.body_time_constant,
            thermal_damage: self.damage_growth(state, temperature, flank_wear),
            mechanical_wear,
            thermal_wear,
            path: speed,
            cutting_time: cut.engaged,
            chipping_hazard: speed * pair.chipping.hazard_per_path(cut.chipping_rate, state.path, state.flank_wear),
        }
    }

    fn damage_growth(&self, state: &WearState<N>, temperature: N, wear_rate: N) -> N {
        let (rate, gain) = self.pair.damage_terms(self.cut());
        match &self.pair.law {
            crate::WearLaw::EnergyBalance(law) if gain.re() > 0.0 => {
                let damage = state.thermal_damage;
                self.cut().engaged * rate * law.activation(temperature) * (-damage + 1.0)
                    - damage * wear_rate / law.damage_wear_depth
            }
            crate::WearLaw::EnergyBalance(_)
            | crate::WearLaw::ExtendedTaylor(_)
            | crate::WearLaw::TakeyamaMurata(_)
            | crate::WearLaw::Usui(_) => N::from(0.0),
        }
    }

    /// [`Pair::contact_temperature`] under the cut of this contact, K.
    #[inline]
    pub fn temperature_at(&self, state: &WearState<N>) -> N {
        self.temperature(self.rise(state.flank_wear), state.body_temperature_rise)
    }

    /// [`Pair::event_indicators`] under the cut of this contact.
    #[inline]
    pub fn event_indicators(&self, state: &WearState<N>, chipping_resistance: f64) -> [N; 3] {
        let pair = self.pair;
        let hazard = state.chipping_hazard;
        [
            state.flank_wear / pair.limits.wear_limit - 1.0,
            self.temperature_at(state) / pair.temperature.collapse_temperature - 1.0,
            // An edge without any resistance has chipped: 0/0 would hide it.
            if chipping_resistance > 0.0 { hazard / chipping_resistance - 1.0 } else { hazard },
        ]
    }
}

impl Pair {
    /// Cuts from `start` for at most `longest` seconds, or until the edge is spent; one that is spent at the start
    /// ends there, without any time. `cut_at` gives the cut at a time since the start and a state.
    ///
    /// # Errors
    /// [`ModelError::Step`] for a `longest` that is negative or not finite,
    /// [`ModelError::StepTooSmall`] where the cut is outside the domain of the model.
    ///
    /// # Examples
    /// ```
    /// use toolroom_wear::{Pair, WearState};
    /// let pair = Pair::default();
    /// let run = pair.run(&WearState::default(), |_, _| pair.reference_cut(), 1e5, 1e-8).unwrap();
    /// assert!((run.elapsed / 60.0 - 14.77972).abs() < 1e-5); // quasi-steady 14.93
    /// ```
    pub fn run(
        &self,
        start: &WearState,
        cut_at: impl Fn(f64, &WearState) -> Cut,
        longest: f64,
        relative: f64,
    ) -> Result<EdgeRun, ModelError> {
        let mut y = [0.0; LEN];
        start.write_to(&mut y);
        let wear = relative * self.limits.wear_limit;
        let absolute = [
            wear,
            relative * self.temperature.chip_heating,
            relative,
            wear,
            wear,
            relative * self.limits.reference_speed * self.temperature.body_time_constant,
            relative * self.temperature.body_time_constant,
            relative,
        ];
        let rhs = |time: f64, y: &[f64; LEN]| {
            let state = WearState::from_slice(y);
            let mut slope = [0.0; LEN];
            self.derivative(&state, &cut_at(time, &state)).write_to(&mut slope);
            slope
        };
        let events = |time: f64, y: &[f64; LEN]| {
            let state = WearState::from_slice(y);
            self.event_indicators(&state, &cut_at(time, &state), f64::INFINITY)
        };
        let end = ode::integrate(rhs, events, &y, longest, &Tolerance { relative, absolute })?;
        Ok(EdgeRun {
            state: WearState::from_slice(&end.state),
            elapsed: end.time,
            event: end.event.map(|index| WEAR_EVENTS[index]),
            evaluations: end.evaluations,
        })
    }
}
