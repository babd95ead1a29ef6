//! FMI 3.0, without Event Mode and early return: the unit handles its events itself.

#![allow(unsafe_code)] // calls into a C library

use super::{CallError, Calls, FATAL, Messages, Place, Port, Stepped};
use crate::description::ValueType;
use crate::unit::{Functions, Library};
use fmi::fmi3::binding::{Fmi3Binding, fmi3FMUState, fmi3Instance, fmi3InstanceEnvironment, fmi3Status, fmi3String};
use std::collections::BTreeMap;
use std::ffi::CStr;
use std::sync::Arc;

pub(super) struct Three {
    library: Arc<Library>,
    instance: fmi3Instance,
    messages: Box<Messages>,
    states: BTreeMap<Place, fmi3FMUState>,
    /// The state that bytes were made of or for.
    exchanged: fmi3FMUState,
    dead: bool,
}

// SAFETY: as for FMI 2.0.
unsafe impl Send for Three {}

impl std::fmt::Debug for Three {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Three").field("instance", &self.instance).finish_non_exhaustive()
    }
}

unsafe extern "C" fn log(
    environment: fmi3InstanceEnvironment,
    _status: fmi3Status,
    _category: fmi3String,
    message: fmi3String,
) {
    // SAFETY: the environment is the one that was handed to the unit, or null.
    unsafe { Messages::take(environment, message) }
}

/// Calls a setter with one value of its C type.
macro_rules! set {
    ($self:ident, $function:ident, $reference:expr, $value:expr) => {{
        let (reference, value) = ($reference, $value);
        // SAFETY: the instance is alive, both pointers hold one element for the call.
        let status = unsafe { $self.binding().$function($self.instance, &reference, 1, &value, 1) };
        $self.judge(stringify!($function), status)
    }};
}

/// Calls a getter for one value.
macro_rules! get {
    ($self:ident, $function:ident, $reference:expr, $type:ty) => {{
        let (reference, mut value) = ($reference, <$type>::default());
        // SAFETY: as for setting.
        let status = unsafe { $self.binding().$function($self.instance, &reference, 1, &mut value, 1) };
        $self.judge(stringify!($function), status).map(|()| value)
    }};
}

impl Three {
    pub fn new(library: &Arc<Library>) -> Result<Self, CallError> {
        let mut three = Self {
            library: Arc::clone(library),
            instance: std::ptr::null_mut(),
            messages: Box::default(),
            states: BTreeMap::new(),
            exchanged: std::ptr::null_mut(),
            dead: false,
        };
        // SAFETY: every pointer lives as long as the instance.
        three.instance = unsafe {
            three.binding().fmi3InstantiateCoSimulation(
                library.name.as_ptr(),
                library.token.as_ptr(),
                library.resources.as_ref().map_or(std::ptr::null(), |path| path.as_ptr()),
                false,
                true, // its words are wanted where it refuses
                false,
                false,
                std::ptr::null(),
                0,
                three.messages.environment(),
                Some(log),
                None,
            )
        };
        if three.instance.is_null() {
            return Err(three.messages.error("fmi3InstantiateCoSimulation", "no instance"));
        }
        Ok(three)
    }

    fn binding(&self) -> &Fmi3Binding {
        match &self.library.functions {
            Functions::Three(binding) => binding,
            Functions::Two(_) => unreachable!("an instance of FMI 3.0 comes from a library of FMI 3.0"),
        }
    }

    /// Saves the present state into `state`, which may hold an earlier one.
    fn take(&mut self, mut state: fmi3FMUState) -> (fmi3FMUState, Result<(), CallError>) {
        // SAFETY: the instance is alive; the state is null or one of this instance that was not freed.
        let status = unsafe { self.binding().fmi3GetFMUState(self.instance, &mut state) };
        (state, self.judge("fmi3GetFMUState", status))
    }

    fn free_state(&mut self, mut state: fmi3FMUState) -> Result<(), CallError> {
        if state.is_null() {
            return Ok(());
        }
        // SAFETY: the state is one of this instance, which is alive, and was not freed.
        let status = unsafe { self.binding().fmi3FreeFMUState(self.instance, &mut state) };
        self.judge("fmi3FreeFMUState", status)
    }

    fn judge(&mut self, function: &str, status: u32) -> Result<(), CallError> {
        self.dead |= status == FATAL;
        self.messages.judge(function, status)
    }
}

impl Calls for Three {
    fn initialize(&mut self, start: f64) -> Result<(), CallError> {
        // SAFETY (here and below): the instance is alive and the pointers hold for the call.
        let status =
            unsafe { self.binding().fmi3EnterInitializationMode(self.instance, false, 0.0, start, false, 0.0) };
        self.judge("fmi3EnterInitializationMode", status)?;
        let status = unsafe { self.binding().fmi3ExitInitializationMode(self.instance) };
        self.judge("fmi3ExitInitializationMode", status)
    }

    fn set(&mut self, port: Port, value: f64) -> Result<(), CallError> {
        let reference = port.reference;
        match port.value_type {
            ValueType::Float64 => set!(self, fmi3SetFloat64, reference, value),
            ValueType::Float32 => set!(self, fmi3SetFloat32, reference, value as f32),
            ValueType::Integer(8, true) => set!(self, fmi3SetInt8, reference, value as i8),
            ValueType::Integer(8, false) => set!(self, fmi3SetUInt8, reference, value as u8),
            ValueType::Integer(16, true) => set!(self, fmi3SetInt16, reference, value as i16),
            ValueType::Integer(16, false) => set!(self, fmi3SetUInt16, reference, value as u16),
            ValueType::Integer(32, true) => set!(self, fmi3SetInt32, reference, value as i32),
            ValueType::Integer(32, false) => set!(self, fmi3SetUInt32, reference, value as u32),
            ValueType::Integer(_, false) => set!(self, fmi3SetUInt64, reference, value as u64),
            ValueType::Integer(_, true) | ValueType::Enumeration => set!(self, fmi3SetInt64, reference, value as i64),
            ValueType::Boolean => set!(self, fmi3SetBoolean, reference, value != 0.0),
            ValueType::String | ValueType::Binary | ValueType::Clock => {
                Err(self.messages.error("fmi3SetFloat64", format!("a {} is no number", port.value_type)))
            }
        }
    }

    fn set_text(&mut self, reference: u32, text: &CStr) -> Result<(), CallError> {
        let pointer: fmi3String = text.as_ptr();
        set!(self, fmi3SetString, reference, pointer)
    }

    fn get(&mut self, port: Port) -> Result<f64, CallError> {
        let reference = port.reference;
        match port.value_type {
            ValueType::Float64 => get!(self, fmi3GetFloat64, reference, f64),
            ValueType::Float32 => get!(self, fmi3GetFloat32, reference, f32).map(f64::from),
            ValueType::Integer(8, true) => get!(self, fmi3GetInt8, reference, i8).map(f64::from),
            ValueType::Integer(8, false) => get!(self, fmi3GetUInt8, reference, u8).map(f64::from),
            ValueType::Integer(16, true) => get!(self, fmi3GetInt16, reference, i16).map(f64::from),
            ValueType::Integer(16, false) => get!(self, fmi3GetUInt16, reference, u16).map(f64::from),
            ValueType::Integer(32, true) => get!(self, fmi3GetInt32, reference, i32).map(f64::from),
            ValueType::Integer(32, false) => get!(self, fmi3GetUInt32, reference, u32).map(f64::from),
            ValueType::Integer(_, false) => get!(self, fmi3GetUInt64, reference, u64).map(|value| value as f64),
            ValueType::Integer(_, true) | ValueType::Enumeration => {
                get!(self, fmi3GetInt64, reference, i64).map(|value| value as f64)
            }
            ValueType::Boolean => get!(self, fmi3GetBoolean, reference, bool).map(|flag| f64::from(u8::from(flag))),
            ValueType::String | ValueType::Binary | ValueType::Clock => {
                Err(self.messages.error("fmi3GetFloat64", format!("a {} is no number", port.value_type)))
            }
        }
    }

    fn step(&mut self, time: f64, duration: f64) -> Result<Stepped, CallError> {
        let (mut event, mut terminate, mut early, mut reached) = (false, false, false, 0.0);
        let status = unsafe {
            self.binding().fmi3DoStep(
                self.instance,
                time,
                duration,
                false,
                &mut event,
                &mut terminate,
                &mut early,
                &mut reached,
            )
        };
        self.judge("fmi3DoStep", status)?;
        let ends = time..=time + duration;
        if terminate {
            // A unit that does not tell where it stopped did so at the end of the step.
            return Ok(Stepped::Ended(if ends.contains(&reached) { reached } else { time + duration }));
        }
        if early {
            return Err(self.messages.error("fmi3DoStep", "an early return, which was not allowed"));
        }
        Ok(Stepped::Whole)
    }

    fn save(&mut self, place: Place) -> Result<(), CallError> {
        let (state, saved) = self.take(self.states.get(&place).copied().unwrap_or(std::ptr::null_mut()));
        self.states.insert(place, state);
        saved
    }

    fn restore(&mut self, place: Place) -> Result<(), CallError> {
        let Some(state) = self.states.get(&place).copied() else {
            return Err(self.messages.error("fmi3SetFMUState", "no state, as none was saved"));
        };
        let status = unsafe { self.binding().fmi3SetFMUState(self.instance, state) };
        self.judge("fmi3SetFMUState", status)
    }

    fn forget(&mut self, place: Place) -> Result<(), CallError> {
        self.states.remove(&place).map_or(Ok(()), |state| self.free_state(state))
    }

    fn serialize(&mut self, bytes: &mut Vec<u8>) -> Result<(), CallError> {
        let (state, saved) = self.take(self.exchanged);
        self.exchanged = state;
        saved?;
        let (instance, mut size) = (self.instance, 0);
        let status = unsafe { self.binding().fmi3SerializedFMUStateSize(instance, state, &mut size) };
        self.judge("fmi3SerializedFMUStateSize", status)?;
        bytes.resize(size, 0);
        let status = unsafe { self.binding().fmi3SerializeFMUState(instance, state, bytes.as_mut_ptr(), size) };
        self.judge("fmi3SerializeFMUState", status)
    }

    fn deserialize(&mut self, bytes: &[u8]) -> Result<(), CallError> {
        let old = std::mem::replace(&mut self.exchanged, std::ptr::null_mut());
        self.free_state(old)?;
        let (instance, mut state) = (self.instance, std::ptr::null_mut());
        let (start, size) = (bytes.as_ptr(), bytes.len());
        let status = unsafe { self.binding().fmi3DeserializeFMUState(instance, start, size, &mut state) };
        self.judge("fmi3DeserializeFMUState", status)?;
        self.exchanged = state;
        let status = unsafe { self.binding().fmi3SetFMUState(instance, state) };
        self.judge("fmi3SetFMUState", status)
    }

    fn alive(&self) -> bool {
        !self.dead
    }
}

impl Drop for Three {
    fn drop(&mut self) {
        if self.instance.is_null() || self.dead {
            return;
        }
        // An instance whose state cannot be freed still can, unless that was fatal.
        let states = std::mem::take(&mut self.states).into_values().chain([self.exchanged]);
        for state in states.collect::<Vec<_>>() {
            if !self.dead {
                _ = self.free_state(state);
            }
        }
        if !self.dead {
            unsafe { self.binding().fmi3FreeInstance(self.instance) };
        }
    }
}
