//! First-order approximations of the recursion, for drivers that want a differential equation.

use crate::infeed::positive;
use crate::law::{REFERENCE_DEPTH, depth_of_chip};
use crate::{Infeed, Input, Output, State};
use toolroom_process::ode::{Tolerance, integrate, unless_passed};
use toolroom_process::{Advance, AnyRecord, ModelError, Number, Process, ProcessEvent, Record, record};

/// Which property of the recursion the approximation keeps; none keeps both.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TimeConstant {
    /// The steady lag behind a ramp: `T c`, c = Cp/J = K/(1 − K).
    #[default]
    Lag,
    /// The decay in spark-out: `−T (1 + g)/ln(c/(1 + c + g))`, which is −T/ln K for a wheel that
    /// does not wear.
    Decay,
}

record! {
    /// What changes: position, part, wheel.
    pub struct FirstOrderState {
        /// Infeed commanded since the wheel touched the part, u.
        commanded_infeed: Real["m" => "um"] = 0.0, -1.0..=1.0;
        /// Radial stock removed, r.
        stock_removed: Real["m" => "um"] = 0.0, -1.0..=1.0;
        /// Radial wear of the wheel since dressing, w.
        wheel_wear: Real["m" => "um"] = 0.0, 0.0..=1.0;
        /// Volume removed per width since dressing, V'.
        removed_volume: Real["m2" => "mm3/mm"] = 0.0, 0.0..=1e4;
    }
}

/// Plunge grinding as a first-order lag, `τ dr/dt = max(0, u − w − F0/J − r)`, the form of the
/// literature; the depth of cut is `h = T dr/dt`, T being one work revolution.
///
/// Neither time constant gives the recursion of [`Infeed`] exactly: over the first 16 revolutions
/// at K = 0.553 and 4.43 um/rev the stock differs by up to 0.59 um with [`TimeConstant::Lag`]; with
/// [`TimeConstant::Decay`] it stays 2 um behind.
///
/// # Source
/// King & Hahn; Malkin (recalled): τ = k_c/(k_e n_w).
///
/// ```
/// use toolroom_infeed::{InfeedFirstOrder, Input};
/// use toolroom_process::Process;
/// let grinding = InfeedFirstOrder::default();
/// let mut part = grinding.initial();
/// grinding.advance(&mut part, &Input::default(), 16.0 * 60.0 / 292.0).unwrap();
/// assert!((part.stock_removed - 65.4e-6).abs() < 1e-8);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InfeedFirstOrder {
    /// Machine, wheel, work and effects.
    pub grinding: Infeed,
    /// What the approximation keeps.
    pub time_constant: TimeConstant,
}

/// The part as the recursion knows it, without depth of cut.
fn recursion_state<N: Number>(x: &FirstOrderState<N>) -> State<N> {
    State {
        commanded_infeed: x.commanded_infeed,
        stock_removed: x.stock_removed,
        wheel_wear: x.wheel_wear,
        removed_volume: x.removed_volume,
        ..State::<f64>::default().map(N::from)
    }
}

impl<N: Number> Infeed<N> {
    /// Depth of cut of the first-order form: stock removed in one revolution at this rate.
    pub fn first_order_depth(&self, x: &FirstOrderState<N>, u: &Input<N>, time_constant: TimeConstant) -> N {
        let [compliance, wear, threshold] = self.shares(&recursion_state(x), u);
        let revolutions = match time_constant {
            TimeConstant::Lag => compliance,
            TimeConstant::Decay => -(wear + 1.0) / (compliance / (compliance + wear + 1.0)).ln(),
        };
        let deflection = positive(x.commanded_infeed - x.wheel_wear - threshold - x.stock_removed);
        let exponent = self.parameters.force_exponent;
        if exponent.re() == 1.0 {
            return deflection / revolutions;
        }
        // The deflection tells the force, and the force the depth; the time constant scales as in the linear law.
        depth_of_chip(deflection / compliance, exponent, REFERENCE_DEPTH) * compliance / revolutions
    }

    /// Right-hand side of the first-order form.
    pub fn first_order_rate(
        &self,
        x: &FirstOrderState<N>,
        u: &Input<N>,
        time_constant: TimeConstant,
    ) -> FirstOrderState<N> {
        if u.engaged.re() <= 0.5 {
            return FirstOrderState::<f64>::default().map(N::from);
        }
        let p = &self.parameters;
        let [_, wear, _] = self.shares(&recursion_state(x), u);
        let per_second = u.work_rotation_speed / std::f64::consts::TAU;
        let removal = self.first_order_depth(x, u, time_constant) * per_second;
        FirstOrderState {
            commanded_infeed: u.infeed_per_rev * per_second,
            stock_removed: removal,
            wheel_wear: wear * removal,
            removed_volume: p.work_diameter * removal * std::f64::consts::PI,
        }
    }
}

impl InfeedFirstOrder {
    fn state_in_cut(&self, x: &FirstOrderState, u: &Input) -> State {
        State { depth_of_cut: self.grinding.first_order_depth(x, u, self.time_constant), ..recursion_state(x) }
    }

    fn indicators(&self, x: &FirstOrderState, u: &Input) -> [f64; 2] {
        let rise = self.grinding.observe(&self.state_in_cut(x, u), u).temperature_rise;
        self.grinding.indicators(rise, x.removed_volume)
    }
}

impl Process for InfeedFirstOrder {
    type Input = Input;
    type State = FirstOrderState;
    type Output = Output;

    const NAME: &'static str = "infeed_first_order";
    const EVENTS: &'static [ProcessEvent] = Infeed::EVENTS;

    fn initial(&self) -> FirstOrderState {
        FirstOrderState::default()
    }

    fn output(&self, x: &FirstOrderState, u: &Input) -> Output {
        self.grinding.observe(&self.state_in_cut(x, u), u)
    }

    fn advance(&self, x: &mut FirstOrderState, u: &Input, dt: f64) -> Result<Advance, ModelError> {
        u.check()?;
        let record = |values: &[f64; 4]| FirstOrderState::from_slice(values);
        let rhs = |_: f64, values: &[f64; 4]| {
            let mut rate = [0.0; 4];
            self.grinding.first_order_rate(&record(values), u, self.time_constant).write_to(&mut rate);
            rate
        };
        // A thousandth of a nanometre, a thousandth of a cubic millimetre per metre.
        let tolerance = Tolerance { relative: 1e-10, absolute: [1e-15, 1e-15, 1e-15, 1e-12] };
        let mut start = [0.0; 4];
        x.write_to(&mut start);
        // Grinding goes on past burn and past the dressing that is due; neither is met again.
        let passed = self.indicators(x, u).map(|value| value >= 0.0);
        let events = |_: f64, values: &[f64; 4]| unless_passed(passed, self.indicators(&record(values), u));
        let end = integrate(rhs, events, &start, dt, &tolerance)?;
        *x = record(&end.state);
        Ok(match end.event {
            Some(index) => Advance { elapsed: end.time, event: Some(Self::EVENTS[index]) },
            None => Advance { elapsed: dt, event: None },
        })
    }

    fn derivative(&self, x: &FirstOrderState, u: &Input) -> Option<FirstOrderState> {
        Some(self.grinding.first_order_rate(x, u, self.time_constant))
    }

    fn event_indicators(&self, x: &FirstOrderState, u: &Input, indicators: &mut [f64]) {
        indicators.copy_from_slice(&self.indicators(x, u));
    }

    fn parameters_mut(&mut self) -> Vec<(&'static str, &mut dyn AnyRecord)> {
        self.grinding.parameters_mut()
    }
}
