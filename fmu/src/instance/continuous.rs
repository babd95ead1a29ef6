//! Model Exchange: time, states, derivatives and indicators.

use super::Instance;
use crate::component::Interface;
use crate::fault::{Fault, Outcome};
use crate::log::Status;
use crate::mode::Mode;
use crate::unit::Unit;
use toolroom_process::{Record, unit};

impl<U: Unit> Instance<U> {
    /// That the unit serves Model Exchange and `length` is that of its states.
    fn expect_states(&self, length: usize) -> Outcome<()> {
        if self.interface != Interface::ModelExchange {
            return Err(Fault::NotOffered { feature: "access to continuous states in Co-Simulation" }.into());
        }
        expect_length(length, U::State::LEN)
    }

    pub(super) fn move_time(&mut self, time: f64) -> Outcome {
        self.expect("SetTime", &[Mode::Event, Mode::Continuous])?;
        if !time.is_finite() || self.interface != Interface::ModelExchange {
            return Err(Fault::Step { time, step: 0.0 }.into());
        }
        self.core.time = time;
        Ok(Status::Ok)
    }

    pub(super) fn move_states(&mut self, states: &[f64]) -> Outcome {
        self.expect("SetContinuousStates", &[Mode::Event, Mode::Continuous])?;
        self.expect_states(states.len())?;
        if states.iter().any(|value| !value.is_finite()) {
            return Err(Fault::Step { time: self.core.time, step: f64::NAN }.into());
        }
        self.core.state = U::State::from_slice(states);
        self.changed();
        Ok(Status::Ok)
    }

    pub(super) fn read_states(&self, states: &mut [f64]) -> Outcome {
        self.expect_states(states.len())?;
        self.core.state.write_to(states);
        Ok(Status::Ok)
    }

    pub(super) fn read_nominals(&self, nominals: &mut [f64]) -> Outcome {
        self.expect_states(nominals.len())?;
        let elements = U::State::FIELDS.iter().flat_map(|field| std::iter::repeat_n(field, field.len));
        for (nominal, field) in nominals.iter_mut().zip(elements) {
            *nominal = nominal_of(field.display, field.unit);
        }
        Ok(Status::Ok)
    }

    /// Rates of the state at the present state and input.
    pub(super) fn rates(&self) -> Outcome<U::State> {
        let input = self.effective_input();
        let rates = self.core.model.process.derivative(&self.core.state, &input);
        rates.ok_or_else(|| Fault::NotOffered { feature: "Model Exchange" }.into())
    }

    pub(super) fn read_derivatives(&self, derivatives: &mut [f64]) -> Outcome {
        self.expect_states(derivatives.len())?;
        self.rates()?.write_to(derivatives);
        Ok(Status::Ok)
    }

    pub(super) fn read_indicators(&self, indicators: &mut [f64]) -> Outcome {
        expect_length(indicators.len(), U::EVENTS.len())?;
        let input = self.effective_input();
        self.core.model.process.event_indicators(&self.core.state, &input, indicators);
        Ok(Status::Ok)
    }
}

/// That an array has the right length.
pub(super) fn expect_length(values: usize, expected: usize) -> Outcome<()> {
    if values == expected { Ok(()) } else { Err(Fault::Length { values, expected }.into()) }
}

/// One display unit in SI: the size that people think of as one.
pub(crate) fn nominal_of(display: &'static str, si: &'static str) -> f64 {
    unit::parse(display).map_or(1.0, |one| {
        let target = unit::parse(si).map_or(1.0, |target| target.factor);
        one.factor / target
    })
}
