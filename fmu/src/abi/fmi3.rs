//! FMI 3.0: life, steps, states. With the 40 functions of values and clocks beside it, 75.

use super::fmi2::{deserialise, discard, output_rates, save, serialise};
use super::pointer::{put, slice, slice_mut, target, text, texts};
use super::{Callback, call, handles, instantiate};
use crate::component::{Component, Interface};
use crate::fault::{Fault, Outcome};
use crate::log::{Category, Log, Sink, Status};
use std::ffi::{CString, c_char, c_void};
use std::path::PathBuf;

type Logger = unsafe extern "C" fn(*mut c_void, i32, *const c_char, *const c_char);

/// A callback that is never called: intermediate update, clocks, preemption.
type Unused = Option<unsafe extern "C" fn()>;

impl Sink for Callback<Logger> {
    fn message(&self, status: Status, category: Category, text: &str) {
        let text = CString::new(text.replace('\0', " ")).unwrap_or_default();
        let category = CString::new(category.name()).unwrap_or_default();
        // SAFETY: the importer's logger takes these types; nothing is kept.
        unsafe { (self.function)(self.environment, status as i32, category.as_ptr(), text.as_ptr()) }
    }
}

#[unsafe(no_mangle)]
pub extern "C" fn fmi3GetVersion() -> *const c_char {
    c"3.0".as_ptr()
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetDebugLogging(
    instance: *mut c_void,
    on: u8,
    count: usize,
    categories: *const *const c_char,
) -> Status {
    call(instance, "fmi3SetDebugLogging", |unit| {
        // SAFETY: as the standard demands of the importer.
        let categories = unsafe { texts(categories, count) }?;
        let known = unit.log().choose(on != 0, &categories);
        known.then_some(Status::Ok).ok_or_else(|| Fault::NotOffered { feature: "an unknown log category" }.into())
    })
}

/// Makes an instance for either interface.
///
/// # Safety
/// As the standard demands of the importer.
unsafe fn make(
    (name, token, resources): (*const c_char, *const c_char, *const c_char),
    interface: Interface,
    logging: u8,
    environment: *mut c_void,
    logger: Option<Logger>,
) -> *mut c_void {
    // SAFETY: the caller's promise.
    let (name, token, resources) = unsafe { (text(name), text(token), text(resources)) };
    let sink = logger
        .map(|function| Box::new(Callback { function, environment, instance: CString::default() }) as Box<dyn Sink>);
    let log = Log::new(sink, logging != 0);
    if name.is_none_or(str::is_empty) {
        log.say(Status::Error, Category::Error, "the instance has no name");
        return std::ptr::null_mut();
    }
    instantiate(token, interface, resources.map(PathBuf::from), log)
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateModelExchange(
    name: *const c_char,
    token: *const c_char,
    resources: *const c_char,
    _visible: u8,
    logging: u8,
    environment: *mut c_void,
    logger: Option<Logger>,
) -> *mut c_void {
    // SAFETY: as the standard demands of the importer.
    unsafe { make((name, token, resources), Interface::ModelExchange, logging, environment, logger) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateCoSimulation(
    name: *const c_char,
    token: *const c_char,
    resources: *const c_char,
    _visible: u8,
    logging: u8,
    event_mode: u8,
    early_return: u8,
    _intermediate: *const u32,
    _intermediates: usize,
    environment: *mut c_void,
    logger: Option<Logger>,
    _intermediate_update: Unused,
) -> *mut c_void {
    let interface = Interface::CoSimulation { event_mode: event_mode != 0, early_return: early_return != 0 };
    // SAFETY: as the standard demands of the importer.
    unsafe { make((name, token, resources), interface, logging, environment, logger) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateScheduledExecution(
    _name: *const c_char,
    _token: *const c_char,
    _resources: *const c_char,
    _visible: u8,
    logging: u8,
    environment: *mut c_void,
    logger: Option<Logger>,
    _clock_update: Unused,
    _lock: Unused,
    _unlock: Unused,
) -> *mut c_void {
    if let Some(function) = logger.filter(|_| logging != 0) {
        let sink = Callback { function, environment, instance: CString::default() };
        sink.message(Status::Error, Category::Error, "this unit offers no Scheduled Execution");
    }
    std::ptr::null_mut()
}

#[unsafe(no_mangle)]
pub extern "C" fn fmi3FreeInstance(instance: *mut c_void) {
    handles::release(instance);
}

#[unsafe(no_mangle)]
pub extern "C" fn fmi3EnterInitializationMode(
    instance: *mut c_void,
    tolerance_defined: u8,
    tolerance: f64,
    start: f64,
    stop_defined: u8,
    stop: f64,
) -> Status {
    call(instance, "fmi3EnterInitializationMode", |unit| {
        let (stop, tolerance) = ((stop_defined != 0).then_some(stop), (tolerance_defined != 0).then_some(tolerance));
        unit.set_experiment(start, stop, tolerance)?;
        unit.enter_initialization()
    })
}

/// Functions that take nothing but the instance.
macro_rules! plain {
    ($($name:ident = $action:expr;)+) => {$(
        #[unsafe(no_mangle)]
        pub extern "C" fn $name(instance: *mut c_void) -> Status {
            call(instance, stringify!($name), $action)
        }
    )+};
}

/// What is said where Configuration Mode is requested.
const CONFIGURATION: Fault = Fault::NotOffered { feature: "Configuration Mode: there are no structural parameters" };

plain! {
    fmi3ExitInitializationMode = |unit| unit.exit_initialization();
    fmi3EnterEventMode = |unit| unit.enter_event_mode();
    fmi3Terminate = |unit| unit.terminate();
    fmi3Reset = |unit| unit.reset();
    fmi3EnterContinuousTimeMode = |unit| unit.enter_continuous_mode();
    fmi3EnterStepMode = |unit| unit.enter_step_mode();
    fmi3EvaluateDiscreteStates = |_| Ok(Status::Ok);
    fmi3EnterConfigurationMode = |_| Err(CONFIGURATION.into());
    fmi3ExitConfigurationMode = |_| Err(CONFIGURATION.into());
}

#[unsafe(no_mangle)]
pub extern "C" fn fmi3GetNumberOfVariableDependencies(
    instance: *mut c_void,
    _reference: u32,
    _count: *mut usize,
) -> Status {
    call(instance, "fmi3GetNumberOfVariableDependencies", |_| Err(PER_ELEMENT.into()))
}

#[unsafe(no_mangle)]
pub extern "C" fn fmi3GetVariableDependencies(
    instance: *mut c_void,
    _dependent: u32,
    _elements: *mut usize,
    _independents: *mut u32,
    _independent_elements: *mut usize,
    _kinds: *mut i32,
    _count: usize,
) -> Status {
    call(instance, "fmi3GetVariableDependencies", |_| Err(PER_ELEMENT.into()))
}

/// What is said where dependencies of elements are requested.
const PER_ELEMENT: Fault = Fault::NotOffered { feature: "a dependency per element" };

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetFMUState(instance: *mut c_void, state: *mut *mut c_void) -> Status {
    // SAFETY: as the standard demands of the importer.
    call(instance, "fmi3GetFMUState", |unit| save(unit, unsafe { target(state, "FMUState") }?))
}

#[unsafe(no_mangle)]
pub extern "C" fn fmi3SetFMUState(instance: *mut c_void, state: *mut c_void) -> Status {
    call(instance, "fmi3SetFMUState", |unit| unit.restore(state as usize))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeFMUState(instance: *mut c_void, state: *mut *mut c_void) -> Status {
    // SAFETY: as the standard demands of the importer.
    call(instance, "fmi3FreeFMUState", |unit| unsafe { discard(unit, state) })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SerializedFMUStateSize(
    instance: *mut c_void,
    state: *mut c_void,
    size: *mut usize,
) -> Status {
    call(instance, "fmi3SerializedFMUStateSize", |unit| {
        // SAFETY: as the standard demands of the importer.
        *unsafe { target(size, "size") }? = unit.serialise(state as usize)?.len();
        Ok(Status::Ok)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SerializeFMUState(
    instance: *mut c_void,
    state: *mut c_void,
    bytes: *mut u8,
    size: usize,
) -> Status {
    // SAFETY: as the standard demands of the importer.
    call(instance, "fmi3SerializeFMUState", |unit| unsafe { serialise(unit, state, bytes, size) })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3DeserializeFMUState(
    instance: *mut c_void,
    bytes: *const u8,
    size: usize,
    state: *mut *mut c_void,
) -> Status {
    // SAFETY: as the standard demands of the importer.
    call(instance, "fmi3DeserializeFMUState", |unit| unsafe { deserialise(unit, bytes, size, state) })
}

/// A derivative of `unknowns` by `knowns` with the importer's arrays.
type Derivative = fn(&mut dyn Component, &[u32], &[u32], &[f64], &mut [f64]) -> Outcome;

/// The two kinds of derivatives; they differ in what the seed weighs.
macro_rules! derivatives {
    ($($name:ident = $derivative:expr;)+) => {$(
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(
            instance: *mut c_void,
            unknowns: *const u32,
            unknown_count: usize,
            knowns: *const u32,
            known_count: usize,
            seed: *const f64,
            seed_count: usize,
            sensitivity: *mut f64,
            sensitivity_count: usize,
        ) -> Status {
            let derivative: Derivative = $derivative;
            call(instance, stringify!($name), |unit| {
                // SAFETY: as the standard demands of the importer.
                let (unknowns, knowns) =
                    unsafe { (slice(unknowns, unknown_count, "unknowns")?, slice(knowns, known_count, "knowns")?) };
                // SAFETY: as the standard demands of the importer.
                let (seed, out) = unsafe {
                    (slice(seed, seed_count, "seed")?, slice_mut(sensitivity, sensitivity_count, "sensitivity")?)
                };
                derivative(unit, unknowns, knowns, seed, out)
            })
        }
    )+};
}

derivatives! {
    fmi3GetDirectionalDerivative = |unit, unknowns, knowns, seed, out| unit.directional(unknowns, knowns, seed, out);
    fmi3GetAdjointDerivative = |unit, unknowns, knowns, seed, out| unit.adjoint(unknowns, knowns, seed, out);
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3UpdateDiscreteStates(
    instance: *mut c_void,
    needs_update: *mut u8,
    terminate: *mut u8,
    nominals_changed: *mut u8,
    values_changed: *mut u8,
    next_event_defined: *mut u8,
    next_event: *mut f64,
) -> Status {
    call(instance, "fmi3UpdateDiscreteStates", |unit| {
        let update = unit.update_discrete()?;
        // SAFETY: as the standard demands of the importer.
        unsafe {
            put(needs_update, 0);
            put(terminate, 0);
            put(nominals_changed, 0);
            put(values_changed, u8::from(update.states_changed));
            put(next_event_defined, u8::from(update.next_event.is_some()));
            put(next_event, update.next_event.unwrap_or(0.0));
        }
        Ok(Status::Ok)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3CompletedIntegratorStep(
    instance: *mut c_void,
    _no_set_state: u8,
    enter_event_mode: *mut u8,
    terminate: *mut u8,
) -> Status {
    call(instance, "fmi3CompletedIntegratorStep", |unit| {
        let event = unit.completed_step()?;
        // SAFETY: as the standard demands of the importer.
        unsafe {
            put(enter_event_mode, u8::from(event));
            put(terminate, 0);
        }
        Ok(Status::Ok)
    })
}

#[unsafe(no_mangle)]
pub extern "C" fn fmi3SetTime(instance: *mut c_void, time: f64) -> Status {
    call(instance, "fmi3SetTime", |unit| unit.set_time(time))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetContinuousStates(instance: *mut c_void, states: *const f64, count: usize) -> Status {
    call(instance, "fmi3SetContinuousStates", |unit| {
        // SAFETY: as the standard demands of the importer.
        unit.set_states(unsafe { slice(states, count, "continuousStates") }?)
    })
}

/// Functions that fill an array.
macro_rules! filling {
    ($($name:ident = $action:expr;)+) => {$(
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(instance: *mut c_void, values: *mut f64, count: usize) -> Status {
            let action: fn(&mut dyn Component, &mut [f64]) -> Outcome = $action;
            // SAFETY: as the standard demands of the importer.
            call(instance, stringify!($name), |unit| action(unit, unsafe { slice_mut(values, count, "values") }?))
        }
    )+};
}

filling! {
    fmi3GetContinuousStateDerivatives = |unit, values| unit.derivatives(values);
    fmi3GetEventIndicators = |unit, values| unit.indicators(values);
    fmi3GetContinuousStates = |unit, values| unit.states(values);
    fmi3GetNominalsOfContinuousStates = |unit, values| unit.nominals(values);
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetNumberOfEventIndicators(instance: *mut c_void, count: *mut usize) -> Status {
    call(instance, "fmi3GetNumberOfEventIndicators", |unit| {
        // SAFETY: as the standard demands of the importer.
        *unsafe { target(count, "nEventIndicators") }? = unit.indicator_count();
        Ok(Status::Ok)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetNumberOfContinuousStates(instance: *mut c_void, count: *mut usize) -> Status {
    call(instance, "fmi3GetNumberOfContinuousStates", |unit| {
        // SAFETY: as the standard demands of the importer.
        *unsafe { target(count, "nContinuousStates") }? = unit.state_count();
        Ok(Status::Ok)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetOutputDerivatives(
    instance: *mut c_void,
    references: *const u32,
    count: usize,
    orders: *const i32,
    values: *mut f64,
    length: usize,
) -> Status {
    call(instance, "fmi3GetOutputDerivatives", |unit| {
        if length != count {
            return Err(Fault::Length { values: length, expected: count }.into());
        }
        // SAFETY: as the standard demands of the importer.
        unsafe { output_rates(unit, references, count, orders, values) }
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3DoStep(
    instance: *mut c_void,
    time: f64,
    step: f64,
    _no_set_state: u8,
    event: *mut u8,
    terminate: *mut u8,
    early: *mut u8,
    last: *mut f64,
) -> Status {
    call(instance, "fmi3DoStep", |unit| {
        let stepped = unit.do_step(time, step)?;
        // SAFETY: as the standard demands of the importer.
        unsafe {
            put(event, u8::from(stepped.event));
            put(terminate, 0);
            put(early, u8::from(stepped.early));
            put(last, stepped.time);
        }
        Ok(Status::Ok)
    })
}

#[unsafe(no_mangle)]
pub extern "C" fn fmi3ActivateModelPartition(instance: *mut c_void, _clock: u32, _time: f64) -> Status {
    call(instance, "fmi3ActivateModelPartition", |_| Err(Fault::NotOffered { feature: "Scheduled Execution" }.into()))
}
