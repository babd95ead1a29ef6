//! Life of a new edge under constant conditions.

use super::{ACCURACY, STAGE, STATES, Turning, TurningInput, TurningState};
use toolroom_process::ode::{self, Tolerance};
use toolroom_process::{ModelError, ProcessEvent, Record};
use toolroom_wear::{Life, WEAR_EVENTS};

/// How the temperature of the tool body is treated in a life calculation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LifeModel {
    /// The body is always as warm as the cut makes it.
    QuasiSteady,
    /// The body starts cold and follows with its time constant.
    Ode,
}

impl LifeModel {
    /// Name in files: `quasi_steady`, `ode`.
    pub fn name(self) -> &'static str {
        match self {
            Self::QuasiSteady => "quasi_steady",
            Self::Ode => "ode",
        }
    }
}

/// Longest life that is looked for, s; a cut that lasts longer does not wear the edge out.
const LONGEST: f64 = 1e9;

impl Turning {
    /// What a new edge gives under `u`, held, until the first event that ends it; nothing where the event
    /// already holds, as in a cut too hot for the edge. The ramp of `u` does not count.
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`] for an input outside its range; [`ModelError::NoSolution`]
    /// where the edge is not in cut or does not wear out; [`ModelError::EffectValue`] where an effect of a user gives no
    /// value on the way.
    ///
    /// # Examples
    /// ```
    /// use toolroom_cutting::{LifeModel, Turning, TurningInput};
    /// let turning = Turning::named("ni_vk6om").unwrap();
    /// let (life, _) = turning.life(&TurningInput::default(), LifeModel::QuasiSteady).unwrap();
    /// assert!((life.cutting_time / 60.0 - 14.932164).abs() < 2e-5);
    /// ```
    pub fn life(&self, u: &TurningInput, model: LifeModel) -> Result<(Life, ProcessEvent), ModelError> {
        self.effects.watched(|| self.life_unwatched(u, model))
    }

    fn life_unwatched(&self, u: &TurningInput, model: LifeModel) -> Result<(Life, ProcessEvent), ModelError> {
        u.check()?;
        let endless = |reason| ModelError::NoSolution { quantity: "tool_life", reason };
        if u.engaged == 0.0 || u.cutting_speed == 0.0 {
            return Err(endless("the edge is not in cut"));
        }
        let turning_input = TurningInput { cutting_acceleration: 0.0, ..*u };
        let rhs = |_: f64, y: &[f64; STATES]| {
            let mut slope = [0.0; STATES];
            self.rates(&self.warm(y, &turning_input, model), &turning_input).write_to(&mut slope);
            slope
        };
        let events = |_: f64, y: &[f64; STATES]| {
            let x = self.warm(y, &turning_input, model);
            self.pair.event_indicators(
                &x.wear(),
                &self.cut(&turning_input, &self.terms(&x, &turning_input).0),
                turning_input.chipping_resistance,
            )
        };
        let tolerance = Tolerance { relative: ACCURACY, absolute: self.scales(ACCURACY) };
        let stage =
            |slope: &[f64; STATES]| STAGE * self.pair.limits.wear_limit / TurningState::from_slice(slope).flank_wear;
        let end = ode::integrate_staged(rhs, events, &[0.0; STATES], LONGEST, &tolerance, stage, |_| ())?;
        let Some(event) = end.event else { return Err(endless("the edge does not wear out")) };
        let state = TurningState::from_slice(&end.state);
        let life = Life {
            cutting_time: state.cutting_time,
            path: state.cutting_path,
            mechanical_wear: state.mechanical_wear,
            thermal_wear: state.thermal_wear,
        };
        Ok((life, WEAR_EVENTS[event]))
    }

    /// The state with the body as warm as `model` says.
    fn warm(&self, y: &[f64; STATES], u: &TurningInput, model: LifeModel) -> TurningState {
        let x = TurningState::from_slice(y);
        match model {
            LifeModel::Ode => x,
            LifeModel::QuasiSteady => {
                let cut = self.cut(u, &self.terms(&x, u).0);
                TurningState { tool_body_temperature_rise: self.pair.contact(&cut).rise(x.flank_wear), ..x }
            }
        }
    }
}
