//! One instance of a loaded unit: the calls of Co-Simulation that FMI 2.0 and 3.0 share.

#![allow(unsafe_code)] // text from a C library

mod three;
mod two;

use crate::description::{ValueType, Variable};
use crate::unit::{Library, Unit};
use std::ffi::{CStr, c_char, c_void};
use std::sync::{Arc, Mutex};

/// Address of a variable for the functions of a library.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Port {
    /// Family of functions.
    pub value_type: ValueType,
    /// Value reference.
    pub reference: u32,
}

impl Port {
    /// The port of a variable.
    pub fn of(variable: &Variable) -> Self {
        Self { value_type: variable.value_type, reference: variable.reference }
    }
}

/// A call that did not end well.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{function} answered {status}{}", said(.messages))]
pub struct CallError {
    /// The function.
    pub function: &'static str,
    /// Its status: `discard`, `error`, `fatal`, or what else was wrong.
    pub status: String,
    /// The last messages that the unit logged.
    pub messages: Vec<String>,
}

fn said(messages: &[String]) -> String {
    if messages.is_empty() { String::new() } else { format!(": {}", messages.join("; ")) }
}

/// An instance in step mode.
#[derive(Debug)]
pub struct Instance {
    // Freed before the library that it points into.
    calls: Box<dyn Calls>,
    unit: Arc<Unit>,
}

/// What both versions of FMI can do, each in its own words.
trait Calls: std::fmt::Debug + Send {
    fn initialize(&mut self, start: f64) -> Result<(), CallError>;
    fn set(&mut self, port: Port, value: f64) -> Result<(), CallError>;
    fn set_text(&mut self, reference: u32, text: &CStr) -> Result<(), CallError>;
    fn get(&mut self, port: Port) -> Result<f64, CallError>;
    fn step(&mut self, time: f64, duration: f64) -> Result<(), CallError>;
    fn serialize(&mut self, bytes: &mut Vec<u8>) -> Result<(), CallError>;
    fn deserialize(&mut self, bytes: &[u8]) -> Result<(), CallError>;
}

impl Instance {
    /// A new instance with these start values, initialised at time `start` (s).
    ///
    /// # Errors
    /// [`CallError`] of the first call that failed; `instantiate` where the unit gave none.
    pub fn new(unit: &Arc<Unit>, start_values: &[(Port, StartValue)], start: f64) -> Result<Self, CallError> {
        let calls: Box<dyn Calls> = match &unit.library {
            Library::Two(_) => Box::new(two::Two::new(unit)?),
            Library::Three(_) => Box::new(three::Three::new(unit)?),
        };
        let mut instance = Self { calls, unit: Arc::clone(unit) };
        for (port, value) in start_values {
            match value {
                StartValue::Number(number) => instance.set(*port, *number)?,
                StartValue::Text(text) => instance.calls.set_text(port.reference, text)?,
            }
        }
        instance.calls.initialize(start)?;
        Ok(instance)
    }

    /// The unit.
    pub fn unit(&self) -> &Arc<Unit> {
        &self.unit
    }

    /// Sets a variable; a Boolean is false at 0.
    ///
    /// # Errors
    /// [`CallError`].
    pub fn set(&mut self, port: Port, value: f64) -> Result<(), CallError> {
        self.calls.set(port, value)
    }

    /// Reads a variable.
    ///
    /// # Errors
    /// [`CallError`].
    pub fn get(&mut self, port: Port) -> Result<f64, CallError> {
        self.calls.get(port)
    }

    /// One communication step from `time` (s).
    ///
    /// # Errors
    /// [`CallError`]; the instance is of no further use then.
    pub fn step(&mut self, time: f64, duration: f64) -> Result<(), CallError> {
        self.calls.step(time, duration)
    }

    /// The whole state as bytes.
    ///
    /// # Errors
    /// [`CallError`].
    pub fn serialize(&mut self, bytes: &mut Vec<u8>) -> Result<(), CallError> {
        self.calls.serialize(bytes)
    }

    /// Goes back to a state written by [`Instance::serialize`] of any instance of the unit.
    ///
    /// # Errors
    /// [`CallError`].
    pub fn deserialize(&mut self, bytes: &[u8]) -> Result<(), CallError> {
        self.calls.deserialize(bytes)
    }
}

/// A value set before initialisation.
#[derive(Clone, Debug, PartialEq)]
pub enum StartValue {
    /// A number or a Boolean.
    Number(f64),
    /// A string.
    Text(std::ffi::CString),
}

/// What an instance logs; its address is the environment that is handed to the unit.
#[derive(Debug, Default)]
struct Messages(Mutex<Vec<String>>);

/// Messages kept of one call.
const KEPT: usize = 8;

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
            kept.push(text.to_string_lossy().trim().to_owned());
        }
    }

    fn error(&self, function: &'static str, status: impl Into<String>) -> CallError {
        let messages = self.0.lock().map(|mut kept| std::mem::take(&mut *kept)).unwrap_or_default();
        CallError { function, status: status.into(), messages }
    }

    /// Turns a status, the same number in both versions, into a result.
    fn judge(&self, function: &'static str, status: u32) -> Result<(), CallError> {
        match status {
            0 | 1 => {
                // What was said on the way is of no interest any more.
                if let Ok(mut kept) = self.0.lock() {
                    kept.clear();
                }
                Ok(())
            }
            2 => Err(self.error(function, "discard")),
            3 => Err(self.error(function, "error")),
            FATAL => Err(self.error(function, "fatal")),
            other => Err(self.error(function, format!("status {other}"))),
        }
    }
}

/// The status after which an instance may not even be freed.
const FATAL: u32 = 4;
