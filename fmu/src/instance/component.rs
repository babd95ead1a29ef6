//! The face of an instance to the C interfaces.

use super::Instance;
use crate::component::{Component, StepResult, Update};
use crate::fault::Outcome;
use crate::log::{Log, Status};
use crate::mode::Mode;
use crate::unit::Unit;
use crate::variable::{Slot, ValueType, items};
use std::ffi::CStr;
use toolroom_process::Record;

impl<U: Unit> Component for Instance<U> {
    fn log(&mut self) -> &mut Log {
        &mut self.log
    }
    fn set_experiment(&mut self, start: f64, stop: Option<f64>, tolerance: Option<f64>) -> Outcome {
        self.experiment(start, stop, tolerance)
    }
    fn enter_initialization(&mut self) -> Outcome {
        self.expect("EnterInitializationMode", &[Mode::Instantiated])?;
        self.core.mode = Mode::Initialization;
        Ok(Status::Ok)
    }
    fn exit_initialization(&mut self) -> Outcome {
        self.end_initialization()
    }
    fn enter_event_mode(&mut self) -> Outcome {
        self.begin_event()
    }
    fn update_discrete(&mut self) -> Outcome<Update> {
        self.update()
    }
    fn enter_continuous_mode(&mut self) -> Outcome {
        self.leave_event("EnterContinuousTimeMode", Mode::Continuous)
    }
    fn enter_step_mode(&mut self) -> Outcome {
        self.leave_event("EnterStepMode", Mode::Step)
    }
    fn completed_step(&mut self) -> Outcome<bool> {
        self.expect("CompletedIntegratorStep", &[Mode::Continuous])?;
        Ok(!self.waiting.is_empty())
    }
    fn set_time(&mut self, time: f64) -> Outcome {
        self.move_time(time)
    }
    fn state_count(&self) -> usize {
        if U::CONTINUOUS { U::State::LEN } else { 0 }
    }
    fn indicator_count(&self) -> usize {
        U::EVENTS.len()
    }
    fn set_states(&mut self, states: &[f64]) -> Outcome {
        self.move_states(states)
    }
    fn states(&self, states: &mut [f64]) -> Outcome {
        self.read_states(states)
    }
    fn nominals(&self, nominals: &mut [f64]) -> Outcome {
        self.read_nominals(nominals)
    }
    fn derivatives(&mut self, derivatives: &mut [f64]) -> Outcome {
        self.read_derivatives(derivatives)
    }
    fn indicators(&mut self, indicators: &mut [f64]) -> Outcome {
        self.read_indicators(indicators)
    }
    fn do_step(&mut self, time: f64, step: f64) -> Outcome<StepResult> {
        self.advance(time, step)
    }
    fn time(&self) -> f64 {
        self.core.time
    }
    fn terminate(&mut self) -> Outcome {
        self.end()
    }
    fn reset(&mut self) -> Outcome {
        self.begin_anew()
    }
    #[inline]
    fn peek(&self, reference: u32) -> Option<f64> {
        self.known_output(reference)
    }
    fn read(&mut self, value_type: ValueType, references: &[u32], values: &mut [f64]) -> Outcome {
        self.read_values(value_type, references, values)
    }
    fn write(&mut self, value_type: ValueType, references: &[u32], values: &[f64]) -> Outcome {
        self.write_values(value_type, references, values)
    }
    fn is_enumeration(&self, reference: u32) -> bool {
        match Slot::of(reference) {
            Some(Slot::Parameter(i)) => self.parameters.get(i).is_some_and(|(name, _)| !items::<U>(name).is_empty()),
            _ => false,
        }
    }
    fn read_text(&mut self, reference: u32) -> Outcome<&CStr> {
        self.read_set(reference)
    }
    fn write_text(&mut self, reference: u32, text: &str) -> Outcome {
        self.write_set(reference, text)
    }
    fn save(&mut self, over: usize) -> Outcome<usize> {
        self.keep_state(over)
    }
    fn restore(&mut self, handle: usize) -> Outcome {
        self.go_back(handle)
    }
    fn discard(&mut self, handle: usize) -> Outcome {
        self.forget(handle)
    }
    fn serialise(&self, handle: usize) -> Outcome<Vec<u8>> {
        self.to_bytes(handle)
    }
    fn deserialise(&mut self, bytes: &[u8]) -> Outcome<usize> {
        self.keep_bytes(bytes)
    }
    fn directional(&mut self, unknowns: &[u32], knowns: &[u32], seed: &[f64], out: &mut [f64]) -> Outcome {
        self.along(unknowns, knowns, seed, out)
    }
    fn adjoint(&mut self, unknowns: &[u32], knowns: &[u32], seed: &[f64], out: &mut [f64]) -> Outcome {
        self.back(unknowns, knowns, seed, out)
    }
    fn output_rate(&mut self, reference: u32) -> Outcome<f64> {
        self.rate_of(reference)
    }
}
