//! What turning and milling offer to a fit.

use crate::ChannelId;
use toolroom_cutting::{HeldMilling, HeldTurning, Milling, Turning};
use toolroom_effects::Effects;
use toolroom_process::Process;

/// A process whose constants and effects can be replaced.
pub trait Nominal: Process + Clone {
    /// Conditions that a row must give, by the name of column and input.
    const CONDITIONS: &'static [&'static str];
    /// Output, and component of the state, that lags with a time constant: the tool body.
    const LAGGED: Option<&'static str>;
    /// How much less than in turning the form of wear over the land is believed (assumption).
    const WEAR_CURVE: f64;
    /// How much less than in turning the form of the forces is believed (assumption).
    const FORCE_FORM: f64;
    /// Prior standard deviation of the logarithm of roughness over that of ideal edges (assumption).
    const ROUGHNESS: f64;
    /// Channels whose sign depends on the cut: climb milling pulls the table along.
    const SIGNED: &'static [ChannelId];
    /// Outputs that [`Nominal::readings`] gives.
    const READINGS: &'static [&'static str];
    /// The process under an input that stays.
    type Held<'a>
    where
        Self: 'a;
    /// The same process with other effects.
    #[must_use]
    fn with_effects(&self, effects: Effects) -> Self;
    /// Effects that are switched on.
    fn effects(&self) -> &Effects;
    /// Whether something vibrates around the cut, so that forces decide about wear.
    fn vibrates(&self) -> bool;
    /// Time constant of the lagged component, s.
    fn lag(&self) -> f64;
    /// The process under `u`.
    fn held(&self, u: &Self::Input) -> Self::Held<'_>;
    /// Rates per second at `x` where the edge wears by `factor` faster.
    fn rates(held: &Self::Held<'_>, x: &Self::State, factor: f64) -> Self::State;
    /// What can be observed at `x`.
    fn observe(held: &Self::Held<'_>, x: &Self::State) -> Self::Output;
    /// Those outputs at `x`, at less cost than all; the others may be anything.
    fn readings(held: &Self::Held<'_>, x: &Self::State) -> Self::Output;
}

impl Nominal for Turning {
    const CONDITIONS: &'static [&'static str] = &["cutting_speed", "feed_per_rev", "depth_of_cut"];
    const LAGGED: Option<&'static str> = Some("tool_body_temperature_rise");
    const WEAR_CURVE: f64 = 1.0;
    const FORCE_FORM: f64 = 1.0;
    const ROUGHNESS: f64 = 0.3;
    const SIGNED: &'static [ChannelId] = &[];
    const READINGS: &'static [&'static str] = HeldTurning::READINGS;
    type Held<'a> = HeldTurning<'a>;
    fn with_effects(&self, effects: Effects) -> Self {
        Self { effects, ..self.clone() }
    }
    fn effects(&self) -> &Effects {
        &self.effects
    }
    fn vibrates(&self) -> bool {
        self.structure.is_some()
    }
    fn lag(&self) -> f64 {
        self.pair.temperature.body_time_constant
    }
    fn held(&self, u: &Self::Input) -> HeldTurning<'_> {
        Self::held(self, u)
    }
    fn rates(held: &HeldTurning<'_>, x: &Self::State, factor: f64) -> Self::State {
        held.rates(x, factor)
    }
    fn observe(held: &HeldTurning<'_>, x: &Self::State) -> Self::Output {
        held.output(x)
    }
    fn readings(held: &HeldTurning<'_>, x: &Self::State) -> Self::Output {
        held.readings(x)
    }
}

impl Nominal for Milling {
    const CONDITIONS: &'static [&'static str] = &["cutting_speed", "feed_per_tooth", "depth_of_cut", "width_of_cut"];
    const LAGGED: Option<&'static str> = None;
    // The three stages of the wear curve are an assumption of the model.
    const WEAR_CURVE: f64 = 2.5;
    // A law linear in the chip stands for a power of it.
    const FORCE_FORM: f64 = 1.5;
    // A micrometre of runout makes a wall many times as rough as ideal teeth would.
    const ROUGHNESS: f64 = 1.0;
    const SIGNED: &'static [ChannelId] = &[ChannelId::FeedForce];
    const READINGS: &'static [&'static str] = HeldMilling::READINGS;
    type Held<'a> = HeldMilling<'a>;
    fn with_effects(&self, effects: Effects) -> Self {
        Self { effects, ..self.clone() }
    }
    fn effects(&self) -> &Effects {
        &self.effects
    }
    fn vibrates(&self) -> bool {
        self.structure.is_some()
    }
    fn lag(&self) -> f64 {
        f64::INFINITY
    }
    fn held(&self, u: &Self::Input) -> HeldMilling<'_> {
        Self::held(self, u)
    }
    fn rates(held: &HeldMilling<'_>, x: &Self::State, factor: f64) -> Self::State {
        held.rates(x, factor)
    }
    fn observe(held: &HeldMilling<'_>, x: &Self::State) -> Self::Output {
        held.output(x)
    }
    fn readings(held: &HeldMilling<'_>, x: &Self::State) -> Self::Output {
        held.readings(x)
    }
}
