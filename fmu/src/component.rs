//! An instance as the C interfaces see it, whatever its process.

use crate::fault::Outcome;
use crate::log::Log;
use crate::variable::ValueType;

/// Which interface an instance serves, and what its importer promises.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interface {
    /// Model Exchange.
    ModelExchange,
    /// Co-Simulation.
    CoSimulation {
        /// The importer enters Event Mode when it is told to.
        event_mode: bool,
        /// A step may end before its time.
        early_return: bool,
    },
}

/// What an update of the discrete states changed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Update {
    /// Continuous states have new values.
    pub states_changed: bool,
    /// Time of the next event that is known beforehand, s.
    pub next_event: Option<f64>,
}

/// How a step of co-simulation ended.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepResult {
    /// Time reached, s.
    pub time: f64,
    /// An event wants Event Mode.
    pub event: bool,
    /// The step ended before its time.
    pub early: bool,
}

/// One instance of a unit. Every action is refused, without any change, where it is out of
/// place; numbers are SI.
pub trait Component: Send {
    /// The importer's log.
    fn log(&mut self) -> &mut Log;
    /// Start and end of the simulation, s; 0 and open where it is not called. No step goes beyond the end. A
    /// tolerance is looked at, and not needed: the integrators of the processes keep their own.
    fn set_experiment(&mut self, start: f64, stop: Option<f64>, tolerance: Option<f64>) -> Outcome;
    /// Enters Initialization Mode.
    fn enter_initialization(&mut self) -> Outcome;
    /// Leaves Initialization Mode.
    fn exit_initialization(&mut self) -> Outcome;
    /// Enters Event Mode.
    fn enter_event_mode(&mut self) -> Outcome;
    /// Settles events in Event Mode.
    fn update_discrete(&mut self) -> Outcome<Update>;
    /// Enters Continuous-Time Mode.
    fn enter_continuous_mode(&mut self) -> Outcome;
    /// Enters Step Mode from Event Mode.
    fn enter_step_mode(&mut self) -> Outcome;
    /// Whether the integrator has to enter Event Mode after the step that it completed.
    fn completed_step(&mut self) -> Outcome<bool>;
    /// Sets the time in Model Exchange.
    fn set_time(&mut self, time: f64) -> Outcome;
    /// Number of continuous states.
    fn state_count(&self) -> usize;
    /// Number of event indicators.
    fn indicator_count(&self) -> usize;
    /// Sets the continuous states.
    fn set_states(&mut self, states: &[f64]) -> Outcome;
    /// Reads the continuous states.
    fn states(&self, states: &mut [f64]) -> Outcome;
    /// Nominal values of the continuous states.
    fn nominals(&self, nominals: &mut [f64]) -> Outcome;
    /// Derivatives of the continuous states.
    fn derivatives(&mut self, derivatives: &mut [f64]) -> Outcome;
    /// Event indicators.
    fn indicators(&mut self, indicators: &mut [f64]) -> Outcome;
    /// A step of co-simulation from `time` over `step` seconds.
    fn do_step(&mut self, time: f64, step: f64) -> Outcome<StepResult>;
    /// Time that the unit has reached, s.
    fn time(&self) -> f64;
    /// Ends the simulation.
    fn terminate(&mut self) -> Outcome;
    /// Back to where instantiation left it.
    fn reset(&mut self) -> Outcome;
    /// A real output that is worked out already. What this does cannot panic.
    fn peek(&self, _reference: u32) -> Option<f64> {
        None
    }
    /// Reads variables of one type; arrays take several values.
    fn read(&mut self, value_type: ValueType, references: &[u32], values: &mut [f64]) -> Outcome;
    /// Sets variables of one type, all or none.
    fn write(&mut self, value_type: ValueType, references: &[u32], values: &[f64]) -> Outcome;
    /// Whether a variable is an enumeration, which is read and set as an integer.
    fn is_enumeration(&self, _reference: u32) -> bool {
        false
    }
    /// Reads a string; it stays valid until the next one is read.
    fn read_text(&mut self, reference: u32) -> Outcome<&std::ffi::CStr>;
    /// Sets a string.
    fn write_text(&mut self, reference: u32, text: &str) -> Outcome;
    /// Saves the state, over an earlier one where a handle is given.
    fn save(&mut self, over: usize) -> Outcome<usize>;
    /// Goes back to a saved state.
    fn restore(&mut self, handle: usize) -> Outcome;
    /// Forgets a saved state.
    fn discard(&mut self, handle: usize) -> Outcome;
    /// Bytes of a saved state.
    fn serialise(&self, handle: usize) -> Outcome<Vec<u8>>;
    /// A saved state of bytes.
    fn deserialise(&mut self, bytes: &[u8]) -> Outcome<usize>;
    /// Derivatives of `unknowns` along `seed` in the `knowns`.
    fn directional(&mut self, unknowns: &[u32], knowns: &[u32], seed: &[f64], out: &mut [f64]) -> Outcome;
    /// Derivatives of the weighted sum of `unknowns` by each of the `knowns`.
    fn adjoint(&mut self, unknowns: &[u32], knowns: &[u32], seed: &[f64], out: &mut [f64]) -> Outcome;
    /// First time derivative of an output, per second.
    fn output_rate(&mut self, reference: u32) -> Outcome<f64>;
}
