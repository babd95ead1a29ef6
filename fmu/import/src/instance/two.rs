//! FMI 2.0.

#![allow(unsafe_code)] // calls into a C library

use super::{CallError, Calls, FATAL, Messages, Port};
use crate::description::ValueType;
use crate::unit::{Library, Unit};
use fmi::fmi2::binding::{
    Fmi2Binding, fmi2CallbackFunctions, fmi2Component, fmi2FMUstate, fmi2String, fmi2Type_fmi2CoSimulation,
};
use std::ffi::{CStr, c_char, c_void};
use std::sync::Arc;

pub(super) struct Two {
    unit: Arc<Unit>,
    component: fmi2Component,
    messages: Box<Messages>,
    /// The unit keeps the address for as long as it lives.
    _callbacks: Box<fmi2CallbackFunctions>,
    state: fmi2FMUstate,
    dead: bool,
}

// SAFETY: FMI asks for instances that do not depend on the thread that calls them, one call at a
// time; `&mut self` gives the latter.
unsafe impl Send for Two {}

impl std::fmt::Debug for Two {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Two").field("component", &self.component).finish_non_exhaustive()
    }
}

/// The logger has a variable list of arguments in C. Only the named ones are read, which every
/// calling convention puts where a function without the list expects them; the text is shown
/// as it came, `%` and all.
unsafe extern "C" fn logger(
    environment: *mut c_void,
    _instance: *const c_char,
    _status: u32,
    _category: *const c_char,
    message: *const c_char,
) {
    // SAFETY: the environment is the one that was handed to the unit.
    unsafe { Messages::take(environment, message) }
}

unsafe extern "C" {
    fn calloc(count: usize, size: usize) -> *mut c_void;
    fn free(memory: *mut c_void);
}

type Logger = unsafe extern "C" fn(*mut c_void, *const c_char, u32, *const c_char, *const c_char);
type VariadicLogger = unsafe extern "C" fn(*mut c_void, *const c_char, u32, *const c_char, *const c_char, ...);

impl Two {
    pub fn new(unit: &Arc<Unit>) -> Result<Self, CallError> {
        let messages = Box::<Messages>::default();
        let callbacks = Box::new(fmi2CallbackFunctions {
            // SAFETY: see `logger`.
            logger: Some(unsafe { std::mem::transmute::<Logger, VariadicLogger>(logger) }),
            allocateMemory: Some(calloc),
            freeMemory: Some(free),
            stepFinished: None,
            componentEnvironment: messages.environment(),
        });
        let mut two = Self {
            unit: Arc::clone(unit),
            component: std::ptr::null_mut(),
            messages,
            _callbacks: callbacks,
            state: std::ptr::null_mut(),
            dead: false,
        };
        // SAFETY: every pointer lives as long as the instance.
        two.component = unsafe {
            two.binding().fmi2Instantiate(
                unit.name.as_ptr(),
                fmi2Type_fmi2CoSimulation,
                unit.token.as_ptr(),
                unit.resources.as_ref().map_or(std::ptr::null(), |uri| uri.as_ptr()),
                std::ptr::from_ref(two._callbacks.as_ref()),
                0,
                1, // its words are wanted where it refuses
            )
        };
        if two.component.is_null() { Err(two.messages.error("fmi2Instantiate", "no instance")) } else { Ok(two) }
    }

    fn binding(&self) -> &Fmi2Binding {
        match &self.unit.library {
            Library::Two(binding) => binding,
            Library::Three(_) => unreachable!("an instance of FMI 2.0 comes from a library of FMI 2.0"),
        }
    }

    /// Frees the saved state. A unit that makes one of bytes makes a new one and does not look at what
    /// the pointer held before, so that an old one would never be freed.
    fn free_state(&mut self) -> Result<(), CallError> {
        let mut state = std::mem::replace(&mut self.state, std::ptr::null_mut());
        if state.is_null() {
            return Ok(());
        }
        // SAFETY: the state is one of this component, which is alive, and was not freed.
        let status = unsafe { self.binding().fmi2FreeFMUstate(self.component, &mut state) };
        self.judge("fmi2FreeFMUstate", status)
    }

    fn judge(&mut self, function: &'static str, status: u32) -> Result<(), CallError> {
        self.dead |= status == FATAL;
        self.messages.judge(function, status)
    }
}

impl Calls for Two {
    fn initialize(&mut self, start: f64) -> Result<(), CallError> {
        // SAFETY (here and below): the component is alive and the pointers hold for the call.
        let status = unsafe { self.binding().fmi2SetupExperiment(self.component, 0, 0.0, start, 0, 0.0) };
        self.judge("fmi2SetupExperiment", status)?;
        let status = unsafe { self.binding().fmi2EnterInitializationMode(self.component) };
        self.judge("fmi2EnterInitializationMode", status)?;
        let status = unsafe { self.binding().fmi2ExitInitializationMode(self.component) };
        self.judge("fmi2ExitInitializationMode", status)
    }

    fn set(&mut self, port: Port, value: f64) -> Result<(), CallError> {
        let (component, reference) = (self.component, port.reference);
        let (integer, flag) = (value as i32, i32::from(value != 0.0));
        match port.value_type {
            ValueType::Float64 | ValueType::Float32 => {
                let status = unsafe { self.binding().fmi2SetReal(component, &reference, 1, &value) };
                self.judge("fmi2SetReal", status)
            }
            ValueType::Boolean => {
                let status = unsafe { self.binding().fmi2SetBoolean(component, &reference, 1, &flag) };
                self.judge("fmi2SetBoolean", status)
            }
            ValueType::Integer(..) | ValueType::Enumeration => {
                let status = unsafe { self.binding().fmi2SetInteger(component, &reference, 1, &integer) };
                self.judge("fmi2SetInteger", status)
            }
            ValueType::String | ValueType::Binary | ValueType::Clock => {
                Err(self.messages.error("fmi2SetReal", format!("a {} is no number", port.value_type)))
            }
        }
    }

    fn set_text(&mut self, reference: u32, text: &CStr) -> Result<(), CallError> {
        let pointer: fmi2String = text.as_ptr();
        let status = unsafe { self.binding().fmi2SetString(self.component, &reference, 1, &pointer) };
        self.judge("fmi2SetString", status)
    }

    fn get(&mut self, port: Port) -> Result<f64, CallError> {
        let (component, reference) = (self.component, port.reference);
        let (mut real, mut integer) = (0.0, 0);
        match port.value_type {
            ValueType::Float64 | ValueType::Float32 => {
                let status = unsafe { self.binding().fmi2GetReal(component, &reference, 1, &mut real) };
                self.judge("fmi2GetReal", status).map(|()| real)
            }
            ValueType::Boolean => {
                let status = unsafe { self.binding().fmi2GetBoolean(component, &reference, 1, &mut integer) };
                self.judge("fmi2GetBoolean", status).map(|()| f64::from(u8::from(integer != 0)))
            }
            ValueType::Integer(..) | ValueType::Enumeration => {
                let status = unsafe { self.binding().fmi2GetInteger(component, &reference, 1, &mut integer) };
                self.judge("fmi2GetInteger", status).map(|()| f64::from(integer))
            }
            ValueType::String | ValueType::Binary | ValueType::Clock => {
                Err(self.messages.error("fmi2GetReal", format!("a {} is no number", port.value_type)))
            }
        }
    }

    fn step(&mut self, time: f64, duration: f64) -> Result<(), CallError> {
        let status = unsafe { self.binding().fmi2DoStep(self.component, time, duration, 0) };
        self.judge("fmi2DoStep", status)
    }

    fn serialize(&mut self, bytes: &mut Vec<u8>) -> Result<(), CallError> {
        let (component, mut size, mut state) = (self.component, 0, self.state);
        let status = unsafe { self.binding().fmi2GetFMUstate(component, &mut state) };
        self.state = state;
        self.judge("fmi2GetFMUstate", status)?;
        let status = unsafe { self.binding().fmi2SerializedFMUstateSize(component, state, &mut size) };
        self.judge("fmi2SerializedFMUstateSize", status)?;
        bytes.resize(size, 0);
        let status = unsafe { self.binding().fmi2SerializeFMUstate(component, state, bytes.as_mut_ptr().cast(), size) };
        self.judge("fmi2SerializeFMUstate", status)
    }

    fn deserialize(&mut self, bytes: &[u8]) -> Result<(), CallError> {
        self.free_state()?;
        let (component, mut state) = (self.component, std::ptr::null_mut());
        let (start, size) = (bytes.as_ptr().cast(), bytes.len());
        let status = unsafe { self.binding().fmi2DeSerializeFMUstate(component, start, size, &mut state) };
        self.judge("fmi2DeSerializeFMUstate", status)?;
        self.state = state;
        let status = unsafe { self.binding().fmi2SetFMUstate(component, state) };
        self.judge("fmi2SetFMUstate", status)
    }
}

impl Drop for Two {
    fn drop(&mut self) {
        // After a fatal status no function of the unit may be called any more.
        if self.component.is_null() || self.dead {
            return;
        }
        // An instance whose state cannot be freed still can, unless that was fatal.
        _ = self.free_state();
        if !self.dead {
            unsafe { self.binding().fmi2FreeInstance(self.component) };
        }
    }
}
