//! FMI 2.0.

#![allow(unsafe_code)] // calls into a C library

use super::exchange::{Equations, Update};
use super::{CallError, Calls, DISCARD, FATAL, Messages, Place, Port, ROUNDING, StepResult, owned};
use crate::description::ValueType;
use crate::unit::{Functions, Library};
use fmi::fmi2::binding::{
    Fmi2Binding, fmi2CallbackFunctions, fmi2Component, fmi2EventInfo, fmi2FMUstate, fmi2String,
    fmi2Type_fmi2CoSimulation, fmi2Type_fmi2ModelExchange,
};
use std::collections::BTreeMap;
use std::ffi::{CStr, c_char, c_void};
use std::sync::Arc;

pub(super) struct Two {
    library: Arc<Library>,
    component: fmi2Component,
    messages: Box<Messages>,
    /// The unit keeps the address for as long as it lives.
    _callbacks: Box<fmi2CallbackFunctions>,
    states: BTreeMap<Place, fmi2FMUstate>,
    /// The state that bytes were made of or for.
    exchanged: fmi2FMUstate,
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

unsafe extern "C" {
    /// In logger.c: puts the text together from its variable list of arguments.
    fn toolroom_fmi2_logger(
        environment: *mut c_void,
        instance: *const c_char,
        status: u32,
        category: *const c_char,
        message: *const c_char,
        ...
    );
}

/// A text of the unit, from logger.c.
#[unsafe(no_mangle)]
unsafe extern "C" fn toolroom_fmi2_message(environment: *mut c_void, message: *const c_char) {
    // SAFETY: the environment is the one that was handed to the unit.
    unsafe { Messages::take(environment, message) }
}

/// `fmi2LastSuccessfulTime` of `fmi2StatusKind`.
const LAST_SUCCESSFUL_TIME: u32 = 2;
/// `fmi2Terminated` of `fmi2StatusKind`.
const TERMINATED: u32 = 3;

unsafe extern "C" {
    fn calloc(count: usize, size: usize) -> *mut c_void;
    fn free(memory: *mut c_void);
}

impl Two {
    pub fn new(library: &Arc<Library>) -> Result<Self, CallError> {
        let messages = Box::<Messages>::default();
        let callbacks = Box::new(fmi2CallbackFunctions {
            logger: Some(toolroom_fmi2_logger),
            allocateMemory: Some(calloc),
            freeMemory: Some(free),
            stepFinished: None,
            componentEnvironment: messages.environment(),
        });
        let mut two = Self {
            library: Arc::clone(library),
            component: std::ptr::null_mut(),
            messages,
            _callbacks: callbacks,
            states: BTreeMap::new(),
            exchanged: std::ptr::null_mut(),
            dead: false,
        };
        // SAFETY: every pointer lives as long as the instance.
        two.component = unsafe {
            two.binding().fmi2Instantiate(
                library.name.as_ptr(),
                if library.equations.is_some() { fmi2Type_fmi2ModelExchange } else { fmi2Type_fmi2CoSimulation },
                library.token.as_ptr(),
                library.resources.as_ref().map_or(std::ptr::null(), |uri| uri.as_ptr()),
                std::ptr::from_ref(two._callbacks.as_ref()),
                0,
                1, // its words are wanted where it refuses
            )
        };
        if two.component.is_null() { Err(two.messages.error("fmi2Instantiate", "no instance")) } else { Ok(two) }
    }

    fn binding(&self) -> &Fmi2Binding {
        match &self.library.functions {
            Functions::Two(binding) => binding,
            Functions::Three(_) => unreachable!("an instance of FMI 2.0 comes from a library of FMI 2.0"),
        }
    }

    /// Saves the present state into `state`, which may hold an earlier one.
    fn take(&mut self, mut state: fmi2FMUstate) -> (fmi2FMUstate, Result<(), CallError>) {
        // SAFETY: the component is alive; the state is null or one of this component that was not freed.
        let status = unsafe { self.binding().fmi2GetFMUstate(self.component, &mut state) };
        (state, self.judge("fmi2GetFMUstate", status))
    }

    fn free_state(&mut self, mut state: fmi2FMUstate) -> Result<(), CallError> {
        if state.is_null() {
            return Ok(());
        }
        // SAFETY: the state is one of this component, which is alive, and was not freed.
        let status = unsafe { self.binding().fmi2FreeFMUstate(self.component, &mut state) };
        self.judge("fmi2FreeFMUstate", status)
    }

    /// What a unit says about a step that it discarded.
    fn discarded(&mut self, time: f64, duration: f64) -> Result<StepResult, CallError> {
        let (mut reached, mut ended) = (f64::NAN, 0);
        // SAFETY: the component is alive, the pointers hold for the call.
        let statuses = unsafe {
            let binding = self.binding();
            let statuses = binding.fmi2GetRealStatus(self.component, LAST_SUCCESSFUL_TIME, &mut reached);
            (statuses, binding.fmi2GetBooleanStatus(self.component, TERMINATED, &mut ended))
        };
        self.dead |= statuses.0 == FATAL || statuses.1 == FATAL;
        // A unit that does not tell how far it came has taken none of the step.
        let reached = if statuses.0 <= 1 { reached } else { time };
        // A unit adds up its own time, which differs from the importer's by rounding.
        let (end, rounding) = (time + duration, ROUNDING * time.abs().max((time + duration).abs()));
        if !(reached >= time - rounding && reached <= end + rounding) {
            return Err(self.messages.error("fmi2DoStep", format!("discard, and {reached} s as the time it reached")));
        }
        let reached = if reached - time <= rounding { time } else { reached.min(end) };
        Ok(if statuses.1 <= 1 && ended != 0 { StepResult::Ended(reached) } else { StepResult::Part(reached) })
    }

    fn judge(&mut self, function: &str, status: u32) -> Result<(), CallError> {
        self.dead |= status == FATAL;
        self.messages.judge(function, status)
    }
}

impl Calls for Two {
    fn enter_initialization(&mut self, start: f64) -> Result<(), CallError> {
        // SAFETY (here and below): the component is alive and the pointers hold for the call.
        let status = unsafe { self.binding().fmi2SetupExperiment(self.component, 0, 0.0, start, 0, 0.0) };
        self.judge("fmi2SetupExperiment", status)?;
        let status = unsafe { self.binding().fmi2EnterInitializationMode(self.component) };
        self.judge("fmi2EnterInitializationMode", status)
    }

    fn exit_initialization(&mut self) -> Result<(), CallError> {
        let status = unsafe { self.binding().fmi2ExitInitializationMode(self.component) };
        self.judge("fmi2ExitInitializationMode", status)
    }

    /// FMI 2.0 has no structural parameters.
    fn configure(&mut self, _begin: bool) -> Result<(), CallError> {
        Err(self.messages.error("fmi3EnterConfigurationMode", "nothing: it is of FMI 3.0"))
    }

    /// Arrays are of FMI 3.0: here a variable has one value.
    fn set(&mut self, port: Port, values: &[f64]) -> Result<(), CallError> {
        let &[value] = values else {
            return Err(self.messages.error("fmi2SetReal", "nothing: FMI 2.0 has no arrays"));
        };
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

    fn set_texts(&mut self, reference: u32, texts: &[&CStr]) -> Result<(), CallError> {
        let &[text] = texts else {
            return Err(self.messages.error("fmi2SetString", "nothing: FMI 2.0 has no arrays"));
        };
        let pointer: fmi2String = text.as_ptr();
        let status = unsafe { self.binding().fmi2SetString(self.component, &reference, 1, &pointer) };
        self.judge("fmi2SetString", status)
    }

    fn get_text(&mut self, port: Port, texts: &mut Vec<String>) -> Result<(), CallError> {
        let mut text: fmi2String = std::ptr::null();
        let status = unsafe { self.binding().fmi2GetString(self.component, &port.reference, 1, &mut text) };
        self.judge("fmi2GetString", status)?;
        // SAFETY: the text is the unit's until the next call, and is copied.
        texts.push(unsafe { owned(text) });
        Ok(())
    }

    fn get(&mut self, port: Port, values: &mut Vec<f64>) -> Result<(), CallError> {
        let (component, reference) = (self.component, port.reference);
        let (mut real, mut integer) = (0.0, 0);
        match port.value_type {
            ValueType::Float64 | ValueType::Float32 => {
                let status = unsafe { self.binding().fmi2GetReal(component, &reference, 1, &mut real) };
                self.judge("fmi2GetReal", status).map(|()| values.push(real))
            }
            ValueType::Boolean => {
                let status = unsafe { self.binding().fmi2GetBoolean(component, &reference, 1, &mut integer) };
                self.judge("fmi2GetBoolean", status).map(|()| values.push(f64::from(u8::from(integer != 0))))
            }
            ValueType::Integer(..) | ValueType::Enumeration => {
                let status = unsafe { self.binding().fmi2GetInteger(component, &reference, 1, &mut integer) };
                self.judge("fmi2GetInteger", status).map(|()| values.push(f64::from(integer)))
            }
            ValueType::String | ValueType::Binary | ValueType::Clock => {
                Err(self.messages.error("fmi2GetReal", format!("a {} is no number", port.value_type)))
            }
        }
    }

    fn step(&mut self, time: f64, duration: f64) -> Result<StepResult, CallError> {
        let status = unsafe { self.binding().fmi2DoStep(self.component, time, duration, 0) };
        if status == DISCARD {
            return self.discarded(time, duration);
        }
        self.judge("fmi2DoStep", status).map(|()| StepResult::Whole)
    }

    fn save(&mut self, place: Place) -> Result<(), CallError> {
        let (state, saved) = self.take(self.states.get(&place).copied().unwrap_or(std::ptr::null_mut()));
        self.states.insert(place, state);
        saved
    }

    fn restore(&mut self, place: Place) -> Result<(), CallError> {
        let Some(state) = self.states.get(&place).copied() else {
            return Err(self.messages.error("fmi2SetFMUstate", "no state, as none was saved"));
        };
        let status = unsafe { self.binding().fmi2SetFMUstate(self.component, state) };
        self.judge("fmi2SetFMUstate", status)
    }

    fn forget(&mut self, place: Place) -> Result<(), CallError> {
        self.states.remove(&place).map_or(Ok(()), |state| self.free_state(state))
    }

    fn serialize(&mut self, bytes: &mut Vec<u8>) -> Result<(), CallError> {
        let (state, saved) = self.take(self.exchanged);
        self.exchanged = state;
        saved?;
        let (component, mut size) = (self.component, 0);
        let status = unsafe { self.binding().fmi2SerializedFMUstateSize(component, state, &mut size) };
        self.judge("fmi2SerializedFMUstateSize", status)?;
        self.messages.make_room(bytes, "fmi2SerializedFMUstateSize", size)?;
        let status = unsafe { self.binding().fmi2SerializeFMUstate(component, state, bytes.as_mut_ptr().cast(), size) };
        self.judge("fmi2SerializeFMUstate", status)
    }

    /// A unit that makes a state of bytes makes a new one and does not look at what the pointer held before: the old
    /// one is freed first.
    fn deserialize(&mut self, bytes: &[u8]) -> Result<(), CallError> {
        let old = std::mem::replace(&mut self.exchanged, std::ptr::null_mut());
        self.free_state(old)?;
        let (component, mut state) = (self.component, std::ptr::null_mut());
        let (start, size) = (bytes.as_ptr().cast(), bytes.len());
        let status = unsafe { self.binding().fmi2DeSerializeFMUstate(component, start, size, &mut state) };
        self.judge("fmi2DeSerializeFMUstate", status)?;
        self.exchanged = state;
        let status = unsafe { self.binding().fmi2SetFMUstate(component, state) };
        self.judge("fmi2SetFMUstate", status)
    }

    fn terminate(&mut self) -> Result<(), CallError> {
        let status = unsafe { self.binding().fmi2Terminate(self.component) };
        self.judge("fmi2Terminate", status)
    }

    fn alive(&self) -> bool {
        !self.dead
    }
}

impl Equations for Two {
    fn sizes(&mut self) -> Result<(usize, usize), CallError> {
        Ok(self
            .library
            .equations
            .as_ref()
            .map_or((0, 0), |sizes| (sizes.states.unwrap_or_default() as usize, sizes.indicators as usize)))
    }

    fn enter_event_mode(&mut self) -> Result<(), CallError> {
        // SAFETY (here and below): the component is alive, slices hold as many numbers as is said, for the call.
        let status = unsafe { self.binding().fmi2EnterEventMode(self.component) };
        self.judge("fmi2EnterEventMode", status)
    }

    fn enter_continuous_time_mode(&mut self) -> Result<(), CallError> {
        let status = unsafe { self.binding().fmi2EnterContinuousTimeMode(self.component) };
        self.judge("fmi2EnterContinuousTimeMode", status)
    }

    fn update(&mut self) -> Result<Update, CallError> {
        let mut info = fmi2EventInfo {
            newDiscreteStatesNeeded: 0,
            terminateSimulation: 0,
            nominalsOfContinuousStatesChanged: 0,
            valuesOfContinuousStatesChanged: 0,
            nextEventTimeDefined: 0,
            nextEventTime: 0.0,
        };
        let status = unsafe { self.binding().fmi2NewDiscreteStates(self.component, &mut info) };
        self.judge("fmi2NewDiscreteStates", status)?;
        Ok(Update {
            again: info.newDiscreteStatesNeeded != 0,
            terminate: info.terminateSimulation != 0,
            next: (info.nextEventTimeDefined != 0).then_some(info.nextEventTime),
        })
    }

    fn set_point(&mut self, time: f64, states: &[f64]) -> Result<(), CallError> {
        let status = unsafe { self.binding().fmi2SetTime(self.component, time) };
        self.judge("fmi2SetTime", status)?;
        if states.is_empty() {
            return Ok(());
        }
        let (start, count) = (states.as_ptr(), states.len());
        let status = unsafe { self.binding().fmi2SetContinuousStates(self.component, start, count) };
        self.judge("fmi2SetContinuousStates", status)
    }

    fn states(&mut self, states: &mut [f64]) -> Result<(), CallError> {
        let (start, count) = (states.as_mut_ptr(), states.len());
        let status = unsafe { self.binding().fmi2GetContinuousStates(self.component, start, count) };
        self.judge("fmi2GetContinuousStates", status)
    }

    fn nominals(&mut self, nominals: &mut [f64]) -> Result<(), CallError> {
        let (start, count) = (nominals.as_mut_ptr(), nominals.len());
        let status = unsafe { self.binding().fmi2GetNominalsOfContinuousStates(self.component, start, count) };
        self.judge("fmi2GetNominalsOfContinuousStates", status)
    }

    fn derivatives(&mut self, derivatives: &mut [f64]) -> Result<(), CallError> {
        let (start, count) = (derivatives.as_mut_ptr(), derivatives.len());
        let status = unsafe { self.binding().fmi2GetDerivatives(self.component, start, count) };
        self.judge("fmi2GetDerivatives", status)
    }

    fn indicators(&mut self, indicators: &mut [f64]) -> Result<(), CallError> {
        if indicators.is_empty() {
            return Ok(());
        }
        let (start, count) = (indicators.as_mut_ptr(), indicators.len());
        let status = unsafe { self.binding().fmi2GetEventIndicators(self.component, start, count) };
        self.judge("fmi2GetEventIndicators", status)
    }

    fn completed(&mut self) -> Result<(bool, bool), CallError> {
        if !self.library.equations.as_ref().is_some_and(|equations| equations.completed) {
            return Ok((false, false));
        }
        let (mut event, mut end) = (0, 0);
        let status = unsafe { self.binding().fmi2CompletedIntegratorStep(self.component, 1, &mut event, &mut end) };
        self.judge("fmi2CompletedIntegratorStep", status)?;
        Ok((event != 0, end != 0))
    }

    fn stuck(&self, reason: String) -> CallError {
        self.messages.error("the integration", reason)
    }
}

impl Drop for Two {
    fn drop(&mut self) {
        // After a fatal status no function of the unit may be called any more.
        if self.component.is_null() || self.dead {
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
            unsafe { self.binding().fmi2FreeInstance(self.component) };
        }
    }
}
