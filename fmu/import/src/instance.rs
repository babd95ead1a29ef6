//! One instance of a loaded unit: the calls of Co-Simulation that FMI 2.0 and 3.0 share.

#![allow(unsafe_code)] // text from a C library

mod exchange;
mod locate;
mod three;
mod two;

use crate::description::{ValueType, Variable};
use crate::unit::{Functions, Library, Unit};
use std::ffi::{CStr, c_char, c_void};
use std::sync::{Arc, Mutex};

/// Relative difference of two times that is rounding: 2048 steps of a sum that are rounded (assumption: no unit adds up more
/// between two communication points whose times it is given).
const ROUNDING: f64 = 2048.0 * f64::EPSILON;

/// Address of a variable for the functions of a library.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Port {
    /// Family of functions.
    pub value_type: ValueType,
    /// Value reference.
    pub reference: u32,
    /// Number of elements; 1 for a scalar.
    pub count: u32,
}

impl Port {
    /// The port of a scalar variable.
    pub fn from_variable(variable: &Variable) -> Self {
        Self { value_type: variable.value_type, reference: variable.reference, count: 1 }
    }
}

/// A call that did not end well.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{function} answered {status}{}", said(.messages))]
pub struct CallError {
    /// The function.
    pub function: String,
    /// Its status: `discard`, `error`, `fatal`, or what else was wrong.
    pub status: String,
    /// The last messages that the unit logged.
    pub messages: Vec<String>,
}

fn said(messages: &[String]) -> String {
    if messages.is_empty() { String::new() } else { format!(": {}", messages.join("; ")) }
}

/// How a communication step ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StepResult {
    /// At its end.
    Whole,
    /// Before its end, at this time (s): the unit discarded the rest (`fmi2Discard`), or all of it (`fmi3Discard`, after
    /// which it is where it was before the step).
    Part(f64),
    /// The unit ended the simulation at this time (s): `terminateSimulation`, or `fmi2Discard` with `fmi2Terminated`.
    Ended(f64),
}

/// Number of a place for a saved state of an instance, chosen by the caller.
pub type Place = u32;

/// One thing that an instance is to do. Several are handed over together, so that a unit in another process is
/// asked once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Action<'a> {
    /// Sets a variable; a Boolean is false at 0.
    Set(Port, f64),
    /// Sets every element of an array, the last index fastest: eight little-endian bytes each, as they go over to a
    /// worker ([`bytes_of`]), and each text with a zero byte behind it.
    SetArray(Port, &'a [u8]),
    /// Reads a variable: as many values as it has elements.
    Get(Port),
    /// Reads a string: as many texts as it has elements.
    GetText(Port),
    /// A communication step from `time` over `duration` (s). What follows is left out where it was not whole.
    Step {
        /// Start, s.
        time: f64,
        /// Length, s.
        duration: f64,
    },
    /// Takes a step that holds an event again, from the state saved in `place`, each time to the middle of what is left,
    /// until the event is located; the instance is left there. Of the actions behind, the first `inputs` are done before
    /// each try and the next `reads` after it.
    Locate {
        /// Where the state at the start of the step is saved.
        place: Place,
        /// Start, s.
        time: f64,
        /// Length of the step, s.
        length: f64,
        /// Flags of the events before the step, 0 or 1; the first `reads` read them after it.
        before: &'a [u8],
        /// Number of actions before each try.
        inputs: u32,
        /// Number of actions after each try.
        reads: u32,
    },
    /// Saves the state, over an earlier one of the same place.
    Save(Place),
    /// Goes back to a saved state.
    Restore(Place),
    /// Frees a saved state; nothing where there is none.
    Forget(Place),
    /// The state as bytes.
    Serialize,
    /// Goes back to a state written by [`Action::Serialize`] of any instance of the unit.
    Deserialize(&'a [u8]),
    /// Tells the unit that the simulation is over, after which values can only be read.
    Terminate,
}

/// Elements of an array as [`Action::SetArray`] takes them.
pub fn bytes_of(elements: &[f64]) -> Vec<u8> {
    elements.iter().flat_map(|element| element.to_le_bytes()).collect()
}

/// What came of some actions.
#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    /// Values read, in order.
    pub values: Vec<f64>,
    /// Texts read, in order.
    pub texts: Vec<String>,
    /// How the last step ended.
    pub stepped: StepResult,
    /// The last serialised state.
    pub bytes: Vec<u8>,
}

impl Default for Answer {
    fn default() -> Self {
        Self { values: Vec::new(), texts: Vec::new(), stepped: StepResult::Whole, bytes: Vec::new() }
    }
}

/// An instance between two steps, in this process or in a worker's.
#[derive(Debug)]
pub struct Instance {
    // Freed before the library that it points into.
    body: Box<dyn Body>,
    unit: Arc<Unit>,
}

/// Where an instance lives.
pub(crate) trait Body: std::fmt::Debug + Send {
    /// Does `actions` in order, up to the first that fails.
    fn act(&mut self, actions: &[Action<'_>], answer: &mut Answer) -> Result<(), CallError>;
    /// Whether it can still be called.
    fn alive(&self) -> bool;
}

/// What both versions of FMI can do, each in its own words.
trait Calls: std::fmt::Debug + Send {
    /// Begins the initialisation at time `start` (s).
    fn enter_initialization(&mut self, start: f64) -> Result<(), CallError>;
    /// Ends the initialisation.
    fn exit_initialization(&mut self) -> Result<(), CallError>;
    /// Begins or ends the setting of structural parameters.
    fn configure(&mut self, begin: bool) -> Result<(), CallError>;
    /// Sets as many elements as there are values.
    fn set(&mut self, port: Port, values: &[f64]) -> Result<(), CallError>;
    /// Sets as many elements as there are texts.
    fn set_texts(&mut self, reference: u32, texts: &[&CStr]) -> Result<(), CallError>;
    /// Appends the value of each element.
    fn get(&mut self, port: Port, values: &mut Vec<f64>) -> Result<(), CallError>;
    /// Appends the text of each element.
    fn get_text(&mut self, port: Port, texts: &mut Vec<String>) -> Result<(), CallError>;
    fn step(&mut self, time: f64, duration: f64) -> Result<StepResult, CallError>;
    fn save(&mut self, place: Place) -> Result<(), CallError>;
    fn restore(&mut self, place: Place) -> Result<(), CallError>;
    fn forget(&mut self, place: Place) -> Result<(), CallError>;
    fn serialize(&mut self, bytes: &mut Vec<u8>) -> Result<(), CallError>;
    fn deserialize(&mut self, bytes: &[u8]) -> Result<(), CallError>;
    /// Tells the unit that the simulation is over.
    fn terminate(&mut self) -> Result<(), CallError>;
    /// False after a fatal status.
    fn alive(&self) -> bool;
}

/// An instance in this process.
#[derive(Debug)]
pub(crate) struct Local(Box<dyn Calls>);

impl Local {
    /// A new instance, initialised; `begin` hears the number of each call: instantiation, start values, the
    /// begin and the end of the initialisation.
    pub fn new(
        library: &Arc<Library>,
        start_values: &[(Port, StartValue)],
        start: f64,
        begin: &dyn Fn(usize),
    ) -> Result<Self, CallError> {
        begin(0);
        let mut calls: Box<dyn Calls> = match (&library.functions, &library.equations) {
            (Functions::Two(_), None) => Box::new(two::Two::new(library)?),
            (Functions::Two(_), Some(of)) => Box::new(exchange::Exchange::new(two::Two::new(library)?, &of.names)),
            (Functions::Three(_), None) => Box::new(three::Three::new(library)?),
            (Functions::Three(_), Some(of)) => {
                Box::new(exchange::Exchange::new(three::Three::new(library)?, &of.names))
            }
        };
        let mut configuring = false;
        for (call, (port, value)) in (1..).zip(start_values) {
            begin(call);
            // Structural parameters come first.
            let structural = matches!(value, StartValue::Structure(_));
            if structural != configuring {
                calls.configure(structural)?;
                configuring = structural;
            }
            match value {
                StartValue::Structure(number) => calls.set(*port, &[*number])?,
                StartValue::Numbers(numbers) => calls.set(*port, numbers)?,
                StartValue::Text(text) => calls.set_texts(port.reference, &[text.as_c_str()])?,
            }
        }
        if configuring {
            calls.configure(false)?;
        }
        begin(start_values.len() + 1);
        calls.enter_initialization(start)?;
        begin(start_values.len() + 2);
        calls.exit_initialization()?;
        Ok(Self(calls))
    }

    /// [`Body::act`]; `begin` hears the number of each action.
    pub fn watched(
        &mut self,
        actions: &[Action<'_>],
        answer: &mut Answer,
        begin: &dyn Fn(usize),
    ) -> Result<(), CallError> {
        answer.values.clear();
        answer.texts.clear();
        answer.stepped = StepResult::Whole;
        let mut number = 0;
        while let Some(action) = actions.get(number) {
            begin(number);
            if let Action::Locate { .. } = action {
                let first = number;
                number += self.locate(&actions[first..], answer, &|behind| begin(first + behind))?;
            } else {
                self.one(action, answer)?;
                number += 1;
            }
            if answer.stepped != StepResult::Whole {
                break;
            }
        }
        Ok(())
    }

    /// One action that stands by itself.
    fn one(&mut self, action: &Action<'_>, answer: &mut Answer) -> Result<(), CallError> {
        match *action {
            Action::Set(port, value) => self.0.set(port, &[value]),
            Action::SetArray(Port { value_type: ValueType::String, reference, .. }, bytes) => {
                let texts = bytes.split_inclusive(|byte| *byte == 0);
                let texts: Result<Vec<&CStr>, _> = texts.map(CStr::from_bytes_with_nul).collect();
                self.0.set_texts(reference, &texts.unwrap_or_default())
            }
            Action::SetArray(port, bytes) => {
                let numbers = bytes.as_chunks().0.iter().map(|number| f64::from_le_bytes(*number));
                self.0.set(port, &numbers.collect::<Vec<_>>())
            }
            Action::Get(port) => self.0.get(port, &mut answer.values),
            Action::GetText(port) => self.0.get_text(port, &mut answer.texts),
            Action::Step { time, duration } => {
                answer.stepped = self.0.step(time, duration)?;
                Ok(())
            }
            Action::Locate { .. } => Ok(()), // stands with others
            Action::Save(place) => self.0.save(place),
            Action::Restore(place) => self.0.restore(place),
            Action::Forget(place) => self.0.forget(place),
            Action::Serialize => self.0.serialize(&mut answer.bytes),
            Action::Deserialize(bytes) => self.0.deserialize(bytes),
            Action::Terminate => self.0.terminate(),
        }
    }
}

impl Body for Local {
    fn act(&mut self, actions: &[Action<'_>], answer: &mut Answer) -> Result<(), CallError> {
        self.watched(actions, answer, &|_| {})
    }

    fn alive(&self) -> bool {
        self.0.alive()
    }
}

impl Instance {
    /// A new instance with these start values, initialised at time `start` (s).
    ///
    /// # Errors
    /// [`CallError`] of the first call that failed; `instantiate` where the unit gave none.
    pub fn new(unit: &Arc<Unit>, start_values: &[(Port, StartValue)], start: f64) -> Result<Self, CallError> {
        Ok(Self { body: unit.instantiate(start_values, start)?, unit: Arc::clone(unit) })
    }

    /// The unit.
    pub fn unit(&self) -> &Arc<Unit> {
        &self.unit
    }

    /// Does `actions` in order.
    ///
    /// # Errors
    /// [`CallError`] of the first that failed; those after it are left out. After a failed step the instance is of
    /// no further use.
    pub fn act(&mut self, actions: &[Action<'_>], answer: &mut Answer) -> Result<(), CallError> {
        self.body.act(actions, answer)
    }

    /// One communication step from `time` (s).
    ///
    /// # Errors
    /// As [`Instance::act`].
    pub fn step(&mut self, time: f64, duration: f64) -> Result<StepResult, CallError> {
        let mut answer = Answer::default();
        self.act(&[Action::Step { time, duration }], &mut answer)?;
        Ok(answer.stepped)
    }

    /// The whole state as bytes.
    ///
    /// # Errors
    /// [`CallError`].
    pub fn serialize(&mut self) -> Result<Vec<u8>, CallError> {
        let mut answer = Answer::default();
        self.act(&[Action::Serialize], &mut answer)?;
        Ok(answer.bytes)
    }

    /// Goes back to a state written by [`Instance::serialize`] of any instance of the unit.
    ///
    /// # Errors
    /// [`CallError`].
    pub fn deserialize(&mut self, bytes: &[u8]) -> Result<(), CallError> {
        self.act(&[Action::Deserialize(bytes)], &mut Answer::default())
    }

    /// Ends the simulation, so that a unit may write what it has; it is only freed after that.
    ///
    /// # Errors
    /// [`CallError`].
    pub fn terminate(&mut self) -> Result<(), CallError> {
        self.act(&[Action::Terminate], &mut Answer::default())
    }

    /// Whether the instance can still be called: not after a fatal status, nor where its process has ended.
    pub fn alive(&self) -> bool {
        self.body.alive()
    }
}

/// A value set before initialisation.
#[derive(Clone, Debug, PartialEq)]
pub enum StartValue {
    /// A structural parameter, set in Configuration Mode, before all others.
    Structure(f64),
    /// A number or Boolean, or those of an array.
    Numbers(Vec<f64>),
    /// A string.
    Text(std::ffi::CString),
}

/// What an instance logs; its address is the environment that is handed to the unit.
#[derive(Debug, Default)]
struct Messages(Mutex<Vec<String>>);

/// Messages kept of one call.
const KEPT: usize = 8;

/// Most bytes of a saved state (assumption: half of what goes over to a worker at once, and far above any unit that a study of
/// thousands of passes can use).
const LARGEST_STATE: usize = 1 << 27;

/// Letters kept of one message (assumption: what is wrong is said in them).
const LETTERS: usize = 1000;

impl Messages {
    fn environment(&self) -> *mut c_void {
        std::ptr::from_ref(self).cast_mut().cast()
    }

    /// Takes a message from a library, with nothing of it being trusted.
    ///
    /// # Safety
    /// `environment` is what [`Messages::environment`] gave, or null; `message` is null or ends
    /// with a zero byte.
    unsafe fn take(environment: *mut c_void, message: *const c_char) {
        if environment.is_null() || message.is_null() {
            return;
        }
        // SAFETY: both were just found not to be null; the caller vouches for the rest.
        let (messages, text) = unsafe { (&*environment.cast::<Self>(), CStr::from_ptr(message)) };
        if let Ok(mut kept) = messages.0.lock() {
            if kept.len() == KEPT {
                kept.remove(0);
            }
            kept.push(shown(&text.to_string_lossy()));
        }
    }

    fn error(&self, function: &str, status: impl Into<String>) -> CallError {
        let messages = self.0.lock().map(|mut kept| std::mem::take(&mut *kept)).unwrap_or_default();
        CallError { function: function.to_owned(), status: status.into(), messages }
    }

    /// Makes room for a state of `size` bytes, as `function` gave it: a unit may say anything.
    fn make_room(&self, bytes: &mut Vec<u8>, function: &str, size: usize) -> Result<(), CallError> {
        if size > LARGEST_STATE {
            return Err(self.error(function, format!("{size} bytes, and a state may have at most {LARGEST_STATE}")));
        }
        bytes.resize(size, 0);
        Ok(())
    }

    /// What was said on the way is of no interest any more.
    fn forget(&self) {
        if let Ok(mut kept) = self.0.lock() {
            kept.clear();
        }
    }

    /// Turns a status, the same number in both versions, into a result.
    fn judge(&self, function: &str, status: u32) -> Result<(), CallError> {
        match status {
            0 | 1 => {
                self.forget();
                Ok(())
            }
            DISCARD => Err(self.error(function, "discard")),
            3 => Err(self.error(function, "error")),
            FATAL => Err(self.error(function, "fatal")),
            other => Err(self.error(function, format!("status {other}"))),
        }
    }
}

/// A message as it can be shown: control characters, which could clear a terminal, are escaped, and the rest of a long one
/// is left out.
fn shown(message: &str) -> String {
    let message = message.trim();
    let mut shown = String::new();
    for letter in message.chars().take(LETTERS) {
        if letter.is_control() { shown.extend(letter.escape_default()) } else { shown.push(letter) }
    }
    if message.chars().nth(LETTERS).is_some() {
        shown.push_str(&format!(" … ({} bytes in all)", message.len()));
    }
    shown
}

/// A text of a unit, empty where it gave none.
///
/// # Safety
/// `text` is null or ends with a zero byte.
unsafe fn owned(text: *const c_char) -> String {
    if text.is_null() {
        return String::new();
    }
    // SAFETY: not null, and the caller vouches for the rest.
    unsafe { CStr::from_ptr(text) }.to_string_lossy().into_owned()
}

/// The status of a step that was not taken, or not to its end.
const DISCARD: u32 = 2;

/// The status after which an instance may not even be freed.
const FATAL: u32 = 4;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_is_cut_and_cannot_steer_a_terminal() {
        assert_eq!(shown(" the solver\u{1b}[31m gave up\n"), "the solver\\u{1b}[31m gave up");
        assert_eq!(shown("two\nlines of µ"), "two\\nlines of µ");
        let long = shown(&"y".repeat(5_000_000));
        assert!(long.len() < 1100 && long.ends_with("… (5000000 bytes in all)"), "{long}");
    }
}
