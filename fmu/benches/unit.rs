//! Speed of a unit through its C interface (FMI 3.0 Co-Simulation).

use criterion::{Criterion, criterion_group, criterion_main};
use std::ffi::{CStr, CString, c_char, c_void};
use std::hint::black_box;
use std::ptr::null_mut;
use toolroom_fmu::{Variable, units};

unsafe extern "C" {
    fn fmi3InstantiateCoSimulation(
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
    ) -> *mut c_void;
    fn fmi3EnterInitializationMode(unit: *mut c_void, t: u8, tolerance: f64, start: f64, s: u8, stop: f64) -> i32;
    fn fmi3ExitInitializationMode(unit: *mut c_void) -> i32;
    fn fmi3DoStep(
        unit: *mut c_void,
        time: f64,
        step: f64,
        no_set: u8,
        event: *mut u8,
        terminate: *mut u8,
        early: *mut u8,
        last: *mut f64,
    ) -> i32;
    fn fmi3GetFloat64(unit: *mut c_void, vr: *const u32, n: usize, values: *mut f64, length: usize) -> i32;
    fn fmi3GetFMUState(unit: *mut c_void, state: *mut *mut c_void) -> i32;
    fn fmi3SetFMUState(unit: *mut c_void, state: *mut c_void) -> i32;
    fn fmi3FreeInstance(unit: *mut c_void);
}

/// A unit of `model` under way, with its variables.
fn running(model: &str) -> (*mut c_void, Vec<Variable>) {
    let entry = units().find(|unit| unit.name == model).expect("a shipped unit");
    (started(&CString::new(entry.token()).expect("a token")), entry.describe().variables)
}

/// A unit under way.
fn started(token: &CStr) -> *mut c_void {
    // SAFETY: the arguments are what FMI 3.0 asks for.
    let unit = unsafe {
        fmi3InstantiateCoSimulation(
            c"bench".as_ptr(),
            token.as_ptr(),
            std::ptr::null(),
            0,
            0,
            0,
            0,
            std::ptr::null(),
            0,
            null_mut(),
            std::ptr::null(),
            std::ptr::null(),
        )
    };
    // SAFETY: as above.
    unsafe {
        assert_eq!(fmi3EnterInitializationMode(unit, 0, 0.0, 0.0, 0, 0.0), 0);
        assert_eq!(fmi3ExitInitializationMode(unit), 0);
    }
    unit
}

/// One communication step; true where it was taken.
fn step(unit: *mut c_void, time: f64, step: f64) -> bool {
    let (mut event, mut terminate, mut early, mut last) = (0, 0, 0, 0.0);
    // SAFETY: the arguments are what FMI 3.0 asks for.
    unsafe { fmi3DoStep(unit, time, step, 0, &mut event, &mut terminate, &mut early, &mut last) == 0 }
}

fn steps(criterion: &mut Criterion) {
    for (model, length) in [("turning", 0.01), ("turning", 0.1), ("turning", 1.0), ("milling", 0.1), ("infeed", 0.01)] {
        let (unit, _) = running(model);
        let mut state = null_mut();
        // SAFETY: as above.
        unsafe { assert_eq!(fmi3GetFMUState(unit, &mut state), 0) };
        let mut count = 0u32;
        criterion.bench_function(&format!("{model}/do_step {length} s"), |bencher| {
            bencher.iter(|| {
                assert!(step(unit, f64::from(count) * length, length));
                count += 1;
                if count == 2000 {
                    // Back to the start, so that every step is one of a young edge.
                    // SAFETY: as above.
                    unsafe { assert_eq!(fmi3SetFMUState(unit, state), 0) };
                    count = 0;
                }
            });
        });
        // SAFETY: as above.
        unsafe { fmi3FreeInstance(unit) };
    }
}

fn values(criterion: &mut Criterion) {
    let (unit, variables) = running("turning");
    let reference = |name: &str| variables.iter().find(|each| each.name == name).map(|each| each.slot.reference());
    let one = [reference("process.flank_wear").expect("an output")];
    let eight: Vec<u32> = variables
        .iter()
        .filter(|each| each.name.starts_with("tool.") && each.name != "tool.set")
        .take(8)
        .map(|each| each.slot.reference())
        .collect();
    let mut into = [0.0; 8];
    step(unit, 0.0, 1.0);
    for (name, references) in [("get 1", &one[..]), ("get 8", &eight[..])] {
        criterion.bench_function(&format!("turning/{name}"), |bencher| {
            bencher.iter(|| {
                // SAFETY: as above.
                let status = unsafe {
                    fmi3GetFloat64(unit, references.as_ptr(), references.len(), into.as_mut_ptr(), references.len())
                };
                black_box(status);
            });
        });
    }
    let mut state = null_mut();
    // SAFETY: as above.
    unsafe { fmi3GetFMUState(unit, &mut state) };
    criterion.bench_function("turning/save state", |bencher| {
        // SAFETY: as above.
        bencher.iter(|| unsafe { fmi3GetFMUState(unit, &mut state) });
    });
    criterion.bench_function("turning/restore state", |bencher| {
        // SAFETY: as above.
        bencher.iter(|| unsafe { fmi3SetFMUState(unit, state) });
    });
    let token = units().find(|unit| unit.name == "turning").map(|unit| unit.token()).unwrap_or_default();
    let token = CString::new(token).expect("a token");
    criterion.bench_function("turning/instantiate, initialise, free", |bencher| {
        // SAFETY: as above.
        bencher.iter(|| unsafe { fmi3FreeInstance(started(&token)) });
    });
}

criterion_group!(benches, steps, values);
criterion_main!(benches);
