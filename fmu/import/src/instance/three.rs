//! FMI 3.0, without Event Mode and early return: the unit handles its events itself.

#![allow(unsafe_code)] // calls into a C library

use super::exchange::{Equations, Update};
use super::{CallError, Calls, DISCARD, FATAL, Messages, Place, Port, ROUNDING, StepResult, owned};
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

/// Calls a setter with the values as its C type.
macro_rules! set {
    ($self:ident, $function:ident, $port:expr, $values:expr, $type:ty, $convert:expr) => {{
        let (reference, convert): (_, fn(f64) -> $type) = ($port.reference, $convert);
        let (one, many): ([$type; 1], Vec<$type>);
        let buffer: &[$type] = match $values {
            &[value] => {
                one = [convert(value)];
                &one
            }
            values => {
                many = values.iter().map(|value| convert(*value)).collect();
                &many
            }
        };
        let (start, count) = (buffer.as_ptr(), buffer.len());
        // SAFETY: the instance is alive, the pointers hold as many elements as is said, for the call.
        let status = unsafe { $self.binding().$function($self.instance, &reference, 1, start, count) };
        $self.judge(stringify!($function), status)
    }};
}

/// Calls a getter for the elements of a variable.
macro_rules! get {
    ($self:ident, $function:ident, $port:expr, $values:expr, $type:ty, $convert:expr) => {{
        let (reference, convert): (_, fn($type) -> f64) = ($port.reference, $convert);
        let (mut one, mut many) = ([<$type>::default()], Vec::new());
        let buffer: &mut [$type] = if $port.count == 1 {
            &mut one
        } else {
            many.resize($port.count as usize, <$type>::default());
            &mut many
        };
        let (start, count) = (buffer.as_mut_ptr(), buffer.len());
        // SAFETY: as for setting.
        let status = unsafe { $self.binding().$function($self.instance, &reference, 1, start, count) };
        $self.judge(stringify!($function), status).map(|()| $values.extend(buffer.iter().map(|value| convert(*value))))
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
        if library.equations.is_some() {
            // SAFETY: every pointer lives as long as the instance.
            three.instance = unsafe {
                three.binding().fmi3InstantiateModelExchange(
                    library.name.as_ptr(),
                    library.token.as_ptr(),
                    library.resources.as_ref().map_or(std::ptr::null(), |path| path.as_ptr()),
                    false,
                    true,
                    three.messages.environment(),
                    Some(log),
                )
            };
            if three.instance.is_null() {
                return Err(three.messages.error("fmi3InstantiateModelExchange", "no instance"));
            }
            return Ok(three);
        }
        // SAFETY: as above.
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
    fn enter_initialization(&mut self, start: f64) -> Result<(), CallError> {
        // SAFETY (here and below): the instance is alive and the pointers hold for the call.
        let status =
            unsafe { self.binding().fmi3EnterInitializationMode(self.instance, false, 0.0, start, false, 0.0) };
        self.judge("fmi3EnterInitializationMode", status)
    }

    fn exit_initialization(&mut self) -> Result<(), CallError> {
        let status = unsafe { self.binding().fmi3ExitInitializationMode(self.instance) };
        self.judge("fmi3ExitInitializationMode", status)
    }

    fn configure(&mut self, begin: bool) -> Result<(), CallError> {
        if begin {
            let status = unsafe { self.binding().fmi3EnterConfigurationMode(self.instance) };
            return self.judge("fmi3EnterConfigurationMode", status);
        }
        let status = unsafe { self.binding().fmi3ExitConfigurationMode(self.instance) };
        self.judge("fmi3ExitConfigurationMode", status)
    }

    fn set(&mut self, port: Port, values: &[f64]) -> Result<(), CallError> {
        match port.value_type {
            ValueType::Float64 => set!(self, fmi3SetFloat64, port, values, f64, |value| value),
            ValueType::Float32 => set!(self, fmi3SetFloat32, port, values, f32, |value| value as f32),
            ValueType::Integer(8, true) => set!(self, fmi3SetInt8, port, values, i8, |value| value as i8),
            ValueType::Integer(8, false) => set!(self, fmi3SetUInt8, port, values, u8, |value| value as u8),
            ValueType::Integer(16, true) => set!(self, fmi3SetInt16, port, values, i16, |value| value as i16),
            ValueType::Integer(16, false) => set!(self, fmi3SetUInt16, port, values, u16, |value| value as u16),
            ValueType::Integer(32, true) => set!(self, fmi3SetInt32, port, values, i32, |value| value as i32),
            ValueType::Integer(32, false) => set!(self, fmi3SetUInt32, port, values, u32, |value| value as u32),
            ValueType::Integer(_, false) => set!(self, fmi3SetUInt64, port, values, u64, |value| value as u64),
            ValueType::Integer(_, true) | ValueType::Enumeration => {
                set!(self, fmi3SetInt64, port, values, i64, |value| value as i64)
            }
            ValueType::Boolean => set!(self, fmi3SetBoolean, port, values, bool, |value| value != 0.0),
            ValueType::String | ValueType::Binary | ValueType::Clock => {
                Err(self.messages.error("fmi3SetFloat64", format!("a {} is no number", port.value_type)))
            }
        }
    }

    fn set_texts(&mut self, reference: u32, texts: &[&CStr]) -> Result<(), CallError> {
        let pointers: Vec<fmi3String> = texts.iter().map(|text| text.as_ptr()).collect();
        let (start, count) = (pointers.as_ptr(), pointers.len());
        // SAFETY: as for numbers.
        let status = unsafe { self.binding().fmi3SetString(self.instance, &reference, 1, start, count) };
        self.judge("fmi3SetString", status)
    }

    fn get_text(&mut self, port: Port, texts: &mut Vec<String>) -> Result<(), CallError> {
        let mut pointers: Vec<fmi3String> = vec![std::ptr::null(); port.count as usize];
        let (start, count) = (pointers.as_mut_ptr(), pointers.len());
        let status = unsafe { self.binding().fmi3GetString(self.instance, &port.reference, 1, start, count) };
        self.judge("fmi3GetString", status)?;
        // SAFETY: the texts are the unit's until the next call, and are copied.
        texts.extend(pointers.into_iter().map(|text| unsafe { owned(text) }));
        Ok(())
    }

    fn get(&mut self, port: Port, values: &mut Vec<f64>) -> Result<(), CallError> {
        match port.value_type {
            ValueType::Float64 => get!(self, fmi3GetFloat64, port, values, f64, |value| value),
            ValueType::Float32 => get!(self, fmi3GetFloat32, port, values, f32, f64::from),
            ValueType::Integer(8, true) => get!(self, fmi3GetInt8, port, values, i8, f64::from),
            ValueType::Integer(8, false) => get!(self, fmi3GetUInt8, port, values, u8, f64::from),
            ValueType::Integer(16, true) => get!(self, fmi3GetInt16, port, values, i16, f64::from),
            ValueType::Integer(16, false) => get!(self, fmi3GetUInt16, port, values, u16, f64::from),
            ValueType::Integer(32, true) => get!(self, fmi3GetInt32, port, values, i32, f64::from),
            ValueType::Integer(32, false) => get!(self, fmi3GetUInt32, port, values, u32, f64::from),
            ValueType::Integer(_, false) => get!(self, fmi3GetUInt64, port, values, u64, |value| value as f64),
            ValueType::Integer(_, true) | ValueType::Enumeration => {
                get!(self, fmi3GetInt64, port, values, i64, |value| value as f64)
            }
            ValueType::Boolean => get!(self, fmi3GetBoolean, port, values, bool, |flag| f64::from(u8::from(flag))),
            ValueType::String | ValueType::Binary | ValueType::Clock => {
                Err(self.messages.error("fmi3GetFloat64", format!("a {} is no number", port.value_type)))
            }
        }
    }

    fn step(&mut self, time: f64, duration: f64) -> Result<StepResult, CallError> {
        // A unit that does not tell how far it came is taken at its word that it is at the end.
        let (mut event, mut terminate, mut early, mut reached) = (false, false, false, time + duration);
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
        if status == DISCARD && !terminate {
            // The standard has the unit in the state before the call: a shorter step may do.
            self.messages.forget();
            return Ok(StepResult::Part(time));
        }
        self.judge("fmi3DoStep", status)?;
        let ends = time..=time + duration;
        if terminate {
            // A unit that does not tell where it stopped did so at the end of the step.
            return Ok(StepResult::Ended(if ends.contains(&reached) { reached } else { time + duration }));
        }
        if early {
            return Err(self.messages.error("fmi3DoStep", "an early return, which was not allowed"));
        }
        // Units of fixed steps may be behind the importer's clock by one of theirs, and say so. None is ahead of it.
        let rounding = ROUNDING * time.abs().max((time + duration).abs());
        if !reached.is_finite() || reached > time + duration + rounding {
            return Err(self.messages.error("fmi3DoStep", format!("ok, and {reached} s as the time it reached")));
        }
        Ok(StepResult::Whole)
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
        self.messages.make_room(bytes, "fmi3SerializedFMUStateSize", size)?;
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

    fn terminate(&mut self) -> Result<(), CallError> {
        let status = unsafe { self.binding().fmi3Terminate(self.instance) };
        self.judge("fmi3Terminate", status)
    }

    fn alive(&self) -> bool {
        !self.dead
    }
}

impl Equations for Three {
    fn sizes(&mut self) -> Result<(usize, usize), CallError> {
        let (mut states, mut indicators) = (0, 0);
        // SAFETY (here and below): the instance is alive, slices hold as many numbers as is said, for the call.
        let status = unsafe { self.binding().fmi3GetNumberOfContinuousStates(self.instance, &mut states) };
        self.judge("fmi3GetNumberOfContinuousStates", status)?;
        let status = unsafe { self.binding().fmi3GetNumberOfEventIndicators(self.instance, &mut indicators) };
        self.judge("fmi3GetNumberOfEventIndicators", status)?;
        match self.library.equations.as_ref().and_then(|equations| equations.states) {
            Some(described) if described as usize != states => {
                let said = format!("{states}, and its description has {described}");
                Err(self.messages.error("fmi3GetNumberOfContinuousStates", said))
            }
            Some(_) | None => Ok((states, indicators)),
        }
    }

    fn enter_event_mode(&mut self) -> Result<(), CallError> {
        let status = unsafe { self.binding().fmi3EnterEventMode(self.instance) };
        self.judge("fmi3EnterEventMode", status)
    }

    fn enter_continuous_time_mode(&mut self) -> Result<(), CallError> {
        let status = unsafe { self.binding().fmi3EnterContinuousTimeMode(self.instance) };
        self.judge("fmi3EnterContinuousTimeMode", status)
    }

    fn update(&mut self) -> Result<Update, CallError> {
        let (mut again, mut terminate, mut nominals, mut values) = (false, false, false, false);
        let (mut defined, mut next) = (false, 0.0);
        let status = unsafe {
            self.binding().fmi3UpdateDiscreteStates(
                self.instance,
                &mut again,
                &mut terminate,
                &mut nominals,
                &mut values,
                &mut defined,
                &mut next,
            )
        };
        self.judge("fmi3UpdateDiscreteStates", status)?;
        Ok(Update { again, terminate, next: defined.then_some(next) })
    }

    fn set_point(&mut self, time: f64, states: &[f64]) -> Result<(), CallError> {
        let status = unsafe { self.binding().fmi3SetTime(self.instance, time) };
        self.judge("fmi3SetTime", status)?;
        if states.is_empty() {
            return Ok(());
        }
        let (start, count) = (states.as_ptr(), states.len());
        let status = unsafe { self.binding().fmi3SetContinuousStates(self.instance, start, count) };
        self.judge("fmi3SetContinuousStates", status)
    }

    fn states(&mut self, states: &mut [f64]) -> Result<(), CallError> {
        let (start, count) = (states.as_mut_ptr(), states.len());
        let status = unsafe { self.binding().fmi3GetContinuousStates(self.instance, start, count) };
        self.judge("fmi3GetContinuousStates", status)
    }

    fn nominals(&mut self, nominals: &mut [f64]) -> Result<(), CallError> {
        let (start, count) = (nominals.as_mut_ptr(), nominals.len());
        let status = unsafe { self.binding().fmi3GetNominalsOfContinuousStates(self.instance, start, count) };
        self.judge("fmi3GetNominalsOfContinuousStates", status)
    }

    fn derivatives(&mut self, derivatives: &mut [f64]) -> Result<(), CallError> {
        let (start, count) = (derivatives.as_mut_ptr(), derivatives.len());
        let status = unsafe { self.binding().fmi3GetContinuousStateDerivatives(self.instance, start, count) };
        self.judge("fmi3GetContinuousStateDerivatives", status)
    }

    fn indicators(&mut self, indicators: &mut [f64]) -> Result<(), CallError> {
        if indicators.is_empty() {
            return Ok(());
        }
        let (start, count) = (indicators.as_mut_ptr(), indicators.len());
        let status = unsafe { self.binding().fmi3GetEventIndicators(self.instance, start, count) };
        self.judge("fmi3GetEventIndicators", status)
    }

    fn completed(&mut self) -> Result<(bool, bool), CallError> {
        if !self.library.equations.as_ref().is_some_and(|equations| equations.completed) {
            return Ok((false, false));
        }
        let (mut event, mut end) = (false, false);
        let status = unsafe { self.binding().fmi3CompletedIntegratorStep(self.instance, true, &mut event, &mut end) };
        self.judge("fmi3CompletedIntegratorStep", status)?;
        Ok((event, end))
    }

    fn stuck(&self, reason: String) -> CallError {
        self.messages.error("the integration", reason)
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
