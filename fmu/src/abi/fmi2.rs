//! The 44 functions of FMI 2.0.

use super::pointer::{folder_of_uri, put, slice, slice_mut, target, text, texts};
use super::{Callback, call, handles, instantiate, read_reals};
use crate::component::{Component, Interface};
use crate::fault::{Fault, Outcome};
use crate::log::{Category, Log, Sink, Status};
use crate::variable::ValueType;
use std::ffi::{CString, c_char, c_int, c_uint, c_void};

type Logger = unsafe extern "C" fn(*mut c_void, *const c_char, c_int, *const c_char, *const c_char, ...);

/// `fmi2CallbackFunctions`.
#[repr(C)]
pub struct CallbackFunctions {
    logger: Option<Logger>,
    allocate_memory: Option<unsafe extern "C" fn(usize, usize) -> *mut c_void>,
    free_memory: Option<unsafe extern "C" fn(*mut c_void)>,
    step_finished: Option<unsafe extern "C" fn(*mut c_void, c_int)>,
    environment: *mut c_void,
}

/// `fmi2EventInfo`.
#[repr(C)]
pub struct EventInfo {
    new_discrete_states_needed: c_int,
    terminate_simulation: c_int,
    nominals_changed: c_int,
    values_changed: c_int,
    next_event_time_defined: c_int,
    next_event_time: f64,
}

impl Sink for Callback<Logger> {
    fn message(&self, status: Status, category: Category, text: &str) {
        // The message is a format for some importers and plain text for others.
        let text = CString::new(text.replace('%', "%%").replace('\0', " ")).unwrap_or_default();
        let category = CString::new(category.name()).unwrap_or_default();
        // SAFETY: the importer's logger takes these types; nothing is kept.
        unsafe {
            (self.function)(
                self.environment,
                self.instance.as_ptr(),
                status as c_int,
                category.as_ptr(),
                text.as_ptr(),
            );
        }
    }
}

#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetTypesPlatform() -> *const c_char {
    c"default".as_ptr()
}

#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetVersion() -> *const c_char {
    c"2.0".as_ptr()
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetDebugLogging(
    c: *mut c_void,
    on: c_int,
    count: usize,
    categories: *const *const c_char,
) -> Status {
    call(c, "fmi2SetDebugLogging", |unit| {
        // SAFETY: as the standard demands of the importer.
        let categories = unsafe { texts(categories, count) }?;
        let known = unit.log().choose(on != 0, &categories);
        known.then_some(Status::Ok).ok_or_else(|| Fault::NotOffered { feature: "an unknown log category" }.into())
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Instantiate(
    name: *const c_char,
    kind: c_int,
    guid: *const c_char,
    resources: *const c_char,
    functions: *const CallbackFunctions,
    _visible: c_int,
    logging: c_int,
) -> *mut c_void {
    // SAFETY: as the standard demands of the importer.
    let (name, guid, resources) = unsafe { (text(name), text(guid), text(resources)) };
    let Some(name) = name.filter(|name| !name.is_empty()) else { return std::ptr::null_mut() };
    // SAFETY: as the standard demands of the importer.
    let functions = unsafe { functions.as_ref() };
    let sink = functions.and_then(|functions| {
        let instance = CString::new(name).unwrap_or_default();
        let callback = Callback { function: functions.logger?, environment: functions.environment, instance };
        Some(Box::new(callback) as Box<dyn Sink>)
    });
    let log = Log::new(sink, logging != 0);
    let interface = match kind {
        0 => Interface::ModelExchange,
        1 => Interface::CoSimulation { event_mode: false, early_return: false },
        _ => return std::ptr::null_mut(),
    };
    instantiate(guid, interface, resources.and_then(folder_of_uri), log)
}

#[unsafe(no_mangle)]
pub extern "C" fn fmi2FreeInstance(c: *mut c_void) {
    handles::release(c);
}

#[unsafe(no_mangle)]
pub extern "C" fn fmi2SetupExperiment(
    c: *mut c_void,
    tolerance_defined: c_int,
    tolerance: f64,
    start: f64,
    stop_defined: c_int,
    stop: f64,
) -> Status {
    let (stop, tolerance) = ((stop_defined != 0).then_some(stop), (tolerance_defined != 0).then_some(tolerance));
    call(c, "fmi2SetupExperiment", |unit| unit.set_experiment(start, stop, tolerance))
}

#[unsafe(no_mangle)]
pub extern "C" fn fmi2EnterInitializationMode(c: *mut c_void) -> Status {
    call(c, "fmi2EnterInitializationMode", |unit| unit.enter_initialization())
}

#[unsafe(no_mangle)]
pub extern "C" fn fmi2ExitInitializationMode(c: *mut c_void) -> Status {
    call(c, "fmi2ExitInitializationMode", |unit| unit.exit_initialization())
}

#[unsafe(no_mangle)]
pub extern "C" fn fmi2Terminate(c: *mut c_void) -> Status {
    call(c, "fmi2Terminate", |unit| unit.terminate())
}

#[unsafe(no_mangle)]
pub extern "C" fn fmi2Reset(c: *mut c_void) -> Status {
    call(c, "fmi2Reset", |unit| unit.reset())
}

/// Reads numbers into an array of another type.
///
/// # Safety
/// As the standard demands of the importer.
unsafe fn read<T>(
    unit: &mut dyn Component,
    value_type: ValueType,
    references: *const c_uint,
    count: usize,
    values: *mut T,
    convert: impl Fn(f64) -> T,
) -> Outcome {
    // SAFETY: as the standard demands of the importer.
    let (references, values) = unsafe { (slice(references, count, "vr")?, slice_mut(values, count, "value")?) };
    for (reference, value) in references.iter().zip(values) {
        let mut number = [0.0];
        unit.read(value_type, std::slice::from_ref(reference), &mut number)?;
        *value = convert(number[0]);
    }
    Ok(Status::Ok)
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetReal(c: *mut c_void, vr: *const c_uint, count: usize, value: *mut f64) -> Status {
    // SAFETY: as the standard demands of the importer.
    unsafe { read_reals(c, "fmi2GetReal", (vr, count), (value, count)) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetInteger(c: *mut c_void, vr: *const c_uint, count: usize, value: *mut c_int) -> Status {
    // SAFETY: as the standard demands of the importer.
    call(c, "fmi2GetInteger", |unit| unsafe { read(unit, ValueType::Integer, vr, count, value, |x| x as c_int) })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetBoolean(c: *mut c_void, vr: *const c_uint, count: usize, value: *mut c_int) -> Status {
    // SAFETY: as the standard demands of the importer.
    call(c, "fmi2GetBoolean", |unit| unsafe {
        read(unit, ValueType::Boolean, vr, count, value, |x| c_int::from(x > 0.5))
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetString(
    c: *mut c_void,
    vr: *const c_uint,
    count: usize,
    value: *mut *const c_char,
) -> Status {
    call(c, "fmi2GetString", |unit| {
        // SAFETY: as the standard demands of the importer.
        let (vr, value) = unsafe { (slice(vr, count, "vr")?, slice_mut(value, count, "value")?) };
        for (reference, value) in vr.iter().zip(value) {
            *value = unit.read_text(*reference)?.as_ptr();
        }
        Ok(Status::Ok)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetReal(c: *mut c_void, vr: *const c_uint, count: usize, value: *const f64) -> Status {
    call(c, "fmi2SetReal", |unit| {
        // SAFETY: as the standard demands of the importer.
        let (vr, value) = unsafe { (slice(vr, count, "vr")?, slice(value, count, "value")?) };
        unit.write(ValueType::Real, vr, value)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetInteger(
    c: *mut c_void,
    vr: *const c_uint,
    count: usize,
    value: *const c_int,
) -> Status {
    call(c, "fmi2SetInteger", |unit| {
        // SAFETY: as the standard demands of the importer.
        let (vr, value) = unsafe { (slice(vr, count, "vr")?, slice(value, count, "value")?) };
        let value: Vec<f64> = value.iter().copied().map(f64::from).collect();
        unit.write(ValueType::Integer, vr, &value)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetBoolean(
    c: *mut c_void,
    vr: *const c_uint,
    count: usize,
    value: *const c_int,
) -> Status {
    call(c, "fmi2SetBoolean", |unit| {
        // SAFETY: as the standard demands of the importer.
        let (vr, value) = unsafe { (slice(vr, count, "vr")?, slice(value, count, "value")?) };
        let value: Vec<f64> = value.iter().map(|flag| f64::from(*flag != 0)).collect();
        unit.write(ValueType::Boolean, vr, &value)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetString(
    c: *mut c_void,
    vr: *const c_uint,
    count: usize,
    value: *const *const c_char,
) -> Status {
    call(c, "fmi2SetString", |unit| {
        // SAFETY: as the standard demands of the importer.
        let (vr, value) = unsafe { (slice(vr, count, "vr")?, slice(value, count, "value")?) };
        for (reference, value) in vr.iter().zip(value) {
            // SAFETY: as the standard demands of the importer.
            let value = unsafe { text(*value) }.ok_or(Fault::Null { argument: "value" })?;
            unit.write_text(*reference, value)?;
        }
        Ok(Status::Ok)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetFMUstate(c: *mut c_void, state: *mut *mut c_void) -> Status {
    // SAFETY: as the standard demands of the importer.
    call(c, "fmi2GetFMUstate", |unit| save(unit, unsafe { target(state, "FMUstate") }?))
}

/// Saves over the state that `state` holds, or anew.
pub(super) fn save(unit: &mut dyn Component, state: &mut *mut c_void) -> Outcome {
    *state = unit.save(*state as usize)? as *mut c_void;
    Ok(Status::Ok)
}

#[unsafe(no_mangle)]
pub extern "C" fn fmi2SetFMUstate(c: *mut c_void, state: *mut c_void) -> Status {
    call(c, "fmi2SetFMUstate", |unit| unit.restore(state as usize))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeFMUstate(c: *mut c_void, state: *mut *mut c_void) -> Status {
    // SAFETY: as the standard demands of the importer.
    call(c, "fmi2FreeFMUstate", |unit| unsafe { discard(unit, state) })
}

/// Frees a saved state and forgets its handle; NULL is nothing to be freed.
///
/// # Safety
/// As the standards demand of the importer.
pub(super) unsafe fn discard(unit: &mut dyn Component, state: *mut *mut c_void) -> Outcome {
    if state.is_null() {
        return Ok(Status::Ok);
    }
    // SAFETY: the caller's promise.
    let state = unsafe { target(state, "FMUState") }?;
    unit.discard(*state as usize)?;
    *state = std::ptr::null_mut();
    Ok(Status::Ok)
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializedFMUstateSize(c: *mut c_void, state: *mut c_void, size: *mut usize) -> Status {
    call(c, "fmi2SerializedFMUstateSize", |unit| {
        // SAFETY: as the standard demands of the importer.
        *unsafe { target(size, "size") }? = unit.serialise(state as usize)?.len();
        Ok(Status::Ok)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializeFMUstate(
    c: *mut c_void,
    state: *mut c_void,
    bytes: *mut u8,
    size: usize,
) -> Status {
    // SAFETY: as the standard demands of the importer.
    call(c, "fmi2SerializeFMUstate", |unit| unsafe { serialise(unit, state, bytes, size) })
}

/// Writes a saved state to the importer's bytes.
///
/// # Safety
/// As the standards demand of the importer.
pub(super) unsafe fn serialise(unit: &mut dyn Component, state: *mut c_void, bytes: *mut u8, size: usize) -> Outcome {
    let written = unit.serialise(state as usize)?;
    if size < written.len() {
        return Err(Fault::Length { values: size, expected: written.len() }.into());
    }
    // SAFETY: the caller's promise.
    unsafe { slice_mut(bytes, size, "serializedState") }?[..written.len()].copy_from_slice(&written);
    Ok(Status::Ok)
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DeSerializeFMUstate(
    c: *mut c_void,
    bytes: *const u8,
    size: usize,
    state: *mut *mut c_void,
) -> Status {
    // SAFETY: as the standard demands of the importer.
    call(c, "fmi2DeSerializeFMUstate", |unit| unsafe { deserialise(unit, bytes, size, state) })
}

/// Reads a saved state from the importer's bytes.
///
/// # Safety
/// As the standards demand of the importer.
pub(super) unsafe fn deserialise(
    unit: &mut dyn Component,
    bytes: *const u8,
    size: usize,
    state: *mut *mut c_void,
) -> Outcome {
    // SAFETY: the caller's promise.
    let (bytes, state) = unsafe { (slice(bytes, size, "serializedState")?, target(state, "FMUState")?) };
    *state = unit.deserialise(bytes)? as *mut c_void;
    Ok(Status::Ok)
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetDirectionalDerivative(
    c: *mut c_void,
    unknown: *const c_uint,
    unknowns: usize,
    known: *const c_uint,
    knowns: usize,
    seed: *const f64,
    sensitivity: *mut f64,
) -> Status {
    call(c, "fmi2GetDirectionalDerivative", |unit| {
        // SAFETY: as the standard demands of the importer.
        let (unknown, known) =
            unsafe { (slice(unknown, unknowns, "vUnknown_ref")?, slice(known, knowns, "vKnown_ref")?) };
        // SAFETY: as the standard demands of the importer.
        let (seed, out) = unsafe { (slice(seed, knowns, "dvKnown")?, slice_mut(sensitivity, unknowns, "dvUnknown")?) };
        unit.directional(unknown, known, seed, out)
    })
}

#[unsafe(no_mangle)]
pub extern "C" fn fmi2EnterEventMode(c: *mut c_void) -> Status {
    call(c, "fmi2EnterEventMode", |unit| unit.enter_event_mode())
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2NewDiscreteStates(c: *mut c_void, info: *mut EventInfo) -> Status {
    call(c, "fmi2NewDiscreteStates", |unit| {
        // SAFETY: as the standard demands of the importer.
        let info = unsafe { target(info, "eventInfo") }?;
        let update = unit.update_discrete()?;
        *info = EventInfo {
            new_discrete_states_needed: 0,
            terminate_simulation: 0,
            nominals_changed: 0,
            values_changed: c_int::from(update.states_changed),
            next_event_time_defined: c_int::from(update.next_event.is_some()),
            next_event_time: update.next_event.unwrap_or(0.0),
        };
        Ok(Status::Ok)
    })
}

#[unsafe(no_mangle)]
pub extern "C" fn fmi2EnterContinuousTimeMode(c: *mut c_void) -> Status {
    call(c, "fmi2EnterContinuousTimeMode", |unit| unit.enter_continuous_mode())
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2CompletedIntegratorStep(
    c: *mut c_void,
    _no_set_state: c_int,
    enter_event_mode: *mut c_int,
    terminate: *mut c_int,
) -> Status {
    call(c, "fmi2CompletedIntegratorStep", |unit| {
        let event = unit.completed_step()?;
        // SAFETY: as the standard demands of the importer.
        unsafe {
            put(enter_event_mode, c_int::from(event));
            put(terminate, 0);
        }
        Ok(Status::Ok)
    })
}

#[unsafe(no_mangle)]
pub extern "C" fn fmi2SetTime(c: *mut c_void, time: f64) -> Status {
    call(c, "fmi2SetTime", |unit| unit.set_time(time))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetContinuousStates(c: *mut c_void, states: *const f64, count: usize) -> Status {
    // SAFETY: as the standard demands of the importer.
    call(c, "fmi2SetContinuousStates", |unit| unit.set_states(unsafe { slice(states, count, "x") }?))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetDerivatives(c: *mut c_void, derivatives: *mut f64, count: usize) -> Status {
    // SAFETY: as the standard demands of the importer.
    call(c, "fmi2GetDerivatives", |unit| unit.derivatives(unsafe { slice_mut(derivatives, count, "derivatives") }?))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetEventIndicators(c: *mut c_void, indicators: *mut f64, count: usize) -> Status {
    // SAFETY: as the standard demands of the importer.
    call(c, "fmi2GetEventIndicators", |unit| {
        unit.indicators(unsafe { slice_mut(indicators, count, "eventIndicators") }?)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetContinuousStates(c: *mut c_void, states: *mut f64, count: usize) -> Status {
    // SAFETY: as the standard demands of the importer.
    call(c, "fmi2GetContinuousStates", |unit| unit.states(unsafe { slice_mut(states, count, "x") }?))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetNominalsOfContinuousStates(c: *mut c_void, nominals: *mut f64, count: usize) -> Status {
    // SAFETY: as the standard demands of the importer.
    call(c, "fmi2GetNominalsOfContinuousStates", |unit| {
        unit.nominals(unsafe { slice_mut(nominals, count, "x_nominal") }?)
    })
}

#[unsafe(no_mangle)]
pub extern "C" fn fmi2SetRealInputDerivatives(
    c: *mut c_void,
    _vr: *const c_uint,
    _count: usize,
    _order: *const c_int,
    _value: *const f64,
) -> Status {
    call(c, "fmi2SetRealInputDerivatives", |_| Err(Fault::NotOffered { feature: "interpolation of inputs" }.into()))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetRealOutputDerivatives(
    c: *mut c_void,
    vr: *const c_uint,
    count: usize,
    order: *const c_int,
    value: *mut f64,
) -> Status {
    // SAFETY: as the standard demands of the importer.
    call(c, "fmi2GetRealOutputDerivatives", |unit| unsafe { output_rates(unit, vr, count, order, value) })
}

/// First time derivatives of outputs.
///
/// # Safety
/// As the standards demand of the importer.
pub(super) unsafe fn output_rates(
    unit: &mut dyn Component,
    references: *const c_uint,
    count: usize,
    orders: *const c_int,
    values: *mut f64,
) -> Outcome {
    // SAFETY: the caller's promise.
    let (references, orders) = unsafe { (slice(references, count, "vr")?, slice(orders, count, "order")?) };
    // SAFETY: the caller's promise.
    let values = unsafe { slice_mut(values, count, "value") }?;
    if orders.iter().any(|order| *order != 1) {
        return Err(Fault::NotOffered { feature: "a derivative of another order than 1" }.into());
    }
    for (reference, value) in references.iter().zip(values) {
        *value = unit.output_rate(*reference)?;
    }
    Ok(Status::Ok)
}

#[unsafe(no_mangle)]
pub extern "C" fn fmi2DoStep(c: *mut c_void, time: f64, step: f64, _no_set_state: c_int) -> Status {
    call(c, "fmi2DoStep", |unit| unit.do_step(time, step).map(|_| Status::Ok))
}

#[unsafe(no_mangle)]
pub extern "C" fn fmi2CancelStep(c: *mut c_void) -> Status {
    call(c, "fmi2CancelStep", |_| Err(Fault::NotOffered { feature: "an asynchronous step" }.into()))
}

/// `fmi2LastSuccessfulTime`.
const LAST_SUCCESSFUL_TIME: c_int = 2;
/// `fmi2Terminated`.
const TERMINATED: c_int = 3;

#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetStatus(c: *mut c_void, _kind: c_int, _value: *mut c_int) -> Status {
    call(c, "fmi2GetStatus", |_| Err(Fault::NotOffered { feature: "the status of an asynchronous step" }.into()))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetRealStatus(c: *mut c_void, kind: c_int, value: *mut f64) -> Status {
    call(c, "fmi2GetRealStatus", |unit| {
        if kind != LAST_SUCCESSFUL_TIME {
            return Err(Fault::NotOffered { feature: "this status" }.into());
        }
        // SAFETY: as the standard demands of the importer.
        *unsafe { target(value, "value") }? = unit.time();
        Ok(Status::Ok)
    })
}

#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetIntegerStatus(c: *mut c_void, _kind: c_int, _value: *mut c_int) -> Status {
    call(c, "fmi2GetIntegerStatus", |_| Err(Fault::NotOffered { feature: "an integer status" }.into()))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetBooleanStatus(c: *mut c_void, kind: c_int, value: *mut c_int) -> Status {
    call(c, "fmi2GetBooleanStatus", |_| {
        if kind != TERMINATED {
            return Err(Fault::NotOffered { feature: "this status" }.into());
        }
        // SAFETY: as the standard demands of the importer.
        *unsafe { target(value, "value") }? = 0;
        Ok(Status::Ok)
    })
}

#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetStringStatus(c: *mut c_void, _kind: c_int, _value: *mut *const c_char) -> Status {
    call(c, "fmi2GetStringStatus", |_| Err(Fault::NotOffered { feature: "the status of an asynchronous step" }.into()))
}
