//! A small importer: the C functions as an importer sees them, of both versions.

#![allow(dead_code)] // each test and bench uses a part of it

use std::ffi::{CString, c_char, c_void};
use std::ptr::{null, null_mut};
use toolroom_fmu::units;

/// A handle as the importer holds it.
pub type Handle = *mut c_void;

/// `fmi2CallbackFunctions`.
#[repr(C)]
pub struct Callbacks {
    pub logger: *const c_void,
    pub allocate: *const c_void,
    pub free: *const c_void,
    pub finished: *const c_void,
    pub environment: *mut c_void,
}

/// `fmi2EventInfo`.
#[repr(C)]
#[derive(Default)]
pub struct EventInfo {
    pub flags: [i32; 5],
    pub next: f64,
}

macro_rules! functions {
    ($($name:ident($($type:ty),*);)+) => {
        unsafe extern "C" { $(pub fn $name(_: Handle, $(_: $type),*) -> i32;)+ }
    };
}

unsafe extern "C" {
    pub fn fmi2Instantiate(
        name: *const c_char,
        kind: i32,
        guid: *const c_char,
        resources: *const c_char,
        callbacks: *const Callbacks,
        visible: i32,
        logging: i32,
    ) -> Handle;
    pub fn fmi2FreeInstance(unit: Handle);
    pub fn fmi3InstantiateModelExchange(
        name: *const c_char,
        token: *const c_char,
        resources: *const c_char,
        visible: u8,
        logging: u8,
        environment: *mut c_void,
        logger: *const c_void,
    ) -> Handle;
    pub fn fmi3InstantiateCoSimulation(
        name: *const c_char,
        token: *const c_char,
        resources: *const c_char,
        visible: u8,
        logging: u8,
        event_mode: u8,
        early_return: u8,
        intermediate: *const u32,
        intermediates: usize,
        environment: *mut c_void,
        logger: *const c_void,
        update: *const c_void,
    ) -> Handle;
    pub fn fmi3InstantiateScheduledExecution(
        name: *const c_char,
        token: *const c_char,
        resources: *const c_char,
        visible: u8,
        logging: u8,
        environment: *mut c_void,
        logger: *const c_void,
        clock: *const c_void,
        lock: *const c_void,
        unlock: *const c_void,
    ) -> Handle;
    pub fn fmi3FreeInstance(unit: Handle);
}

functions! {
    fmi2SetDebugLogging(i32, usize, *const *const c_char);
    fmi2SetupExperiment(i32, f64, f64, i32, f64);
    fmi2EnterInitializationMode();
    fmi2ExitInitializationMode();
    fmi2Terminate();
    fmi2Reset();
    fmi2GetReal(*const u32, usize, *mut f64);
    fmi2SetReal(*const u32, usize, *const f64);
    fmi2GetBoolean(*const u32, usize, *mut i32);
    fmi2SetBoolean(*const u32, usize, *const i32);
    fmi2GetString(*const u32, usize, *mut *const c_char);
    fmi2SetString(*const u32, usize, *const *const c_char);
    fmi2GetFMUstate(*mut Handle);
    fmi2SetFMUstate(Handle);
    fmi2FreeFMUstate(*mut Handle);
    fmi2SerializedFMUstateSize(Handle, *mut usize);
    fmi2SerializeFMUstate(Handle, *mut u8, usize);
    fmi2DeSerializeFMUstate(*const u8, usize, *mut Handle);
    fmi2GetDirectionalDerivative(*const u32, usize, *const u32, usize, *const f64, *mut f64);
    fmi2EnterEventMode();
    fmi2NewDiscreteStates(*mut EventInfo);
    fmi2EnterContinuousTimeMode();
    fmi2SetTime(f64);
    fmi2SetContinuousStates(*const f64, usize);
    fmi2GetDerivatives(*mut f64, usize);
    fmi2GetContinuousStates(*mut f64, usize);
    fmi2GetEventIndicators(*mut f64, usize);
    fmi2GetRealOutputDerivatives(*const u32, usize, *const i32, *mut f64);
    fmi2DoStep(f64, f64, i32);
    fmi3EnterInitializationMode(u8, f64, f64, u8, f64);
    fmi3ExitInitializationMode();
    fmi3EnterEventMode();
    fmi3EnterStepMode();
    fmi3Terminate();
    fmi3Reset();
    fmi3GetFloat64(*const u32, usize, *mut f64, usize);
    fmi3SetFloat64(*const u32, usize, *const f64, usize);
    fmi3GetInt32(*const u32, usize, *mut i32, usize);
    fmi3GetInt64(*const u32, usize, *mut i64, usize);
    fmi3SetInt64(*const u32, usize, *const i64, usize);
    fmi2GetInteger(*const u32, usize, *mut i32);
    fmi3GetBoolean(*const u32, usize, *mut u8, usize);
    fmi3SetBoolean(*const u32, usize, *const u8, usize);
    fmi3GetString(*const u32, usize, *mut *const c_char, usize);
    fmi3SetString(*const u32, usize, *const *const c_char, usize);
    fmi3GetFMUState(*mut Handle);
    fmi3SetFMUState(Handle);
    fmi3FreeFMUState(*mut Handle);
    fmi3SerializedFMUStateSize(Handle, *mut usize);
    fmi3SerializeFMUState(Handle, *mut u8, usize);
    fmi3DeserializeFMUState(*const u8, usize, *mut Handle);
    fmi3GetDirectionalDerivative(*const u32, usize, *const u32, usize, *const f64, usize, *mut f64, usize);
    fmi3GetAdjointDerivative(*const u32, usize, *const u32, usize, *const f64, usize, *mut f64, usize);
    fmi3UpdateDiscreteStates(*mut u8, *mut u8, *mut u8, *mut u8, *mut u8, *mut f64);
    fmi3DoStep(f64, f64, u8, *mut u8, *mut u8, *mut u8, *mut f64);
}

/// Token of a shipped unit.
pub fn token(model: &str) -> CString {
    let unit = units().find(|unit| unit.name == model).expect("a shipped unit");
    CString::new(unit.token()).expect("a token")
}

/// Value reference of a variable.
pub fn reference(model: &str, name: &str) -> u32 {
    let unit = units().find(|unit| unit.name == model).expect("a shipped unit");
    let variables = unit.variables();
    variables.iter().find(|variable| variable.name == name).expect("a variable").slot.reference()
}

/// An instance of FMI 2.0 without callbacks; kind 0 for Model Exchange, 1 for Co-Simulation.
pub fn make2(model: &str, kind: i32) -> Handle {
    // SAFETY: the arguments are what the standard asks for.
    unsafe { fmi2Instantiate(c"test".as_ptr(), kind, token(model).as_ptr(), null(), null(), 0, 0) }
}

/// An instance of FMI 3.0 for Co-Simulation.
pub fn make3(token: &CString, event_mode: bool) -> Handle {
    let flag = u8::from(event_mode);
    // SAFETY: the arguments are what the standard asks for.
    unsafe {
        fmi3InstantiateCoSimulation(
            c"test".as_ptr(),
            token.as_ptr(),
            null(),
            0,
            0,
            flag,
            flag,
            null(),
            0,
            null_mut(),
            null(),
            null(),
        )
    }
}

/// A unit of FMI 2.0 for Co-Simulation, initialised.
pub fn ready2(model: &str) -> Handle {
    let unit = make2(model, 1);
    // SAFETY: the arguments are what the standard asks for.
    unsafe {
        assert_eq!(fmi2SetupExperiment(unit, 0, 0.0, 0.0, 0, 0.0), 0);
        assert_eq!(fmi2EnterInitializationMode(unit), 0);
        assert_eq!(fmi2ExitInitializationMode(unit), 0);
    }
    unit
}

/// A unit of FMI 3.0 for Co-Simulation without Event Mode, initialised.
pub fn ready3(token: &CString) -> Handle {
    let unit = make3(token, false);
    // SAFETY: the arguments are what the standard asks for.
    unsafe {
        assert_eq!(fmi3EnterInitializationMode(unit, 0, 0.0, 0.0, 0, 0.0), 0);
        assert_eq!(fmi3ExitInitializationMode(unit), 0);
    }
    unit
}

/// A step of FMI 3.0: status, event, early return, time reached.
pub fn step3(unit: Handle, time: f64, step: f64) -> (i32, bool, bool, f64) {
    let (mut event, mut terminate, mut early, mut last) = (0, 0, 0, 0.0);
    // SAFETY: the arguments are what the standard asks for.
    let status = unsafe { fmi3DoStep(unit, time, step, 0, &mut event, &mut terminate, &mut early, &mut last) };
    (status, event != 0, early != 0, last)
}

/// A number of FMI 3.0.
pub fn get3(unit: Handle, reference: u32) -> f64 {
    let mut value = f64::NAN;
    // SAFETY: the arguments are what the standard asks for.
    assert_eq!(unsafe { fmi3GetFloat64(unit, &reference, 1, &mut value, 1) }, 0);
    value
}
