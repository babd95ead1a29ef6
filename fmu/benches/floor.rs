//! The least time of the turning unit's C functions, in the shared library that is packaged,
//! loaded as importers load it (FMI 3.0 Co-Simulation): `cargo bench -p toolroom-fmu --bench floor`.
//!
//! Each figure is the least of many runs of a few microseconds, which other work on the machine
//! disturbs least. A step begins with an edge of a hundred seconds and is held by one input.

#![allow(clippy::print_stdout)]

use libloading::Library;
use std::ffi::{CString, c_char, c_void};
use std::hint::black_box;
use std::ptr::{null, null_mut};
use std::time::Instant;
use toolroom_fmu::units;

type Handle = *mut c_void;
type Make = unsafe extern "C" fn(
    *const c_char,
    *const c_char,
    *const c_char,
    u8,
    u8,
    u8,
    u8,
    *const u32,
    usize,
    Handle,
    *const c_void,
    *const c_void,
) -> Handle;
type Begin = unsafe extern "C" fn(Handle, u8, f64, f64, u8, f64) -> i32;
type Plain = unsafe extern "C" fn(Handle) -> i32;
type Step = unsafe extern "C" fn(Handle, f64, f64, u8, *mut u8, *mut u8, *mut u8, *mut f64) -> i32;
type Get = unsafe extern "C" fn(Handle, *const u32, usize, *mut f64, usize) -> i32;
type Save = unsafe extern "C" fn(Handle, *mut Handle) -> i32;
type Restore = unsafe extern "C" fn(Handle, Handle) -> i32;

/// Least time of a call in runs of `count` calls, ns; `before` is not timed.
fn floor(count: u32, mut before: impl FnMut(), mut call: impl FnMut(u32)) -> f64 {
    let mut least = f64::INFINITY;
    for _ in 0..20_000 {
        before();
        let start = Instant::now();
        (0..count).for_each(&mut call);
        least = least.min(start.elapsed().as_secs_f64());
    }
    least / f64::from(count) * 1e9
}

fn main() {
    let here = std::env::current_exe().expect("a path");
    let unit = units().find(|unit| unit.name == "turning").expect("a shipped unit");
    let token = CString::new(unit.token()).expect("a token");
    let variables = unit.variables();
    let reference =
        |name: &str| variables.iter().find(|variable| variable.name == name).expect("a variable").slot.reference();
    // SAFETY: the library is this crate's, the types and arguments are those of FMI 3.0.
    unsafe {
        let library = Library::new(here.with_file_name("libtoolroom_fmu.so")).expect("the library beside this bench");
        let make = library.get::<Make>(b"fmi3InstantiateCoSimulation\0").expect("a function");
        let begin = library.get::<Begin>(b"fmi3EnterInitializationMode\0").expect("a function");
        let end = library.get::<Plain>(b"fmi3ExitInitializationMode\0").expect("a function");
        let step = library.get::<Step>(b"fmi3DoStep\0").expect("a function");
        let get = library.get::<Get>(b"fmi3GetFloat64\0").expect("a function");
        let save = library.get::<Save>(b"fmi3GetFMUState\0").expect("a function");
        let restore = library.get::<Restore>(b"fmi3SetFMUState\0").expect("a function");
        let name = c"turning".as_ptr();
        let unit = make(name, token.as_ptr(), null(), 0, 0, 0, 0, null(), 0, null_mut(), null(), null());
        assert_eq!((begin(unit, 0, 0.0, 0.0, 0, 0.0), end(unit)), (0, 0));
        let (mut event, mut terminate, mut early, mut last) = (0, 0, 0, 0.0);
        let mut go = |time: f64, length: f64| {
            assert_eq!(step(unit, time, length, 0, &mut event, &mut terminate, &mut early, &mut last), 0);
        };
        go(0.0, 100.0);
        let mut state = null_mut();
        assert_eq!(save(unit, &mut state), 0);
        for (length, count) in [(0.01, 50u32), (0.1, 50), (1.0, 20)] {
            let begin = || {
                assert_eq!(restore(unit, state), 0);
            };
            let least = floor(count, begin, |i| go(100.0 + f64::from(i) * length, length));
            println!("fmi3DoStep, {length} s: {least:.0} ns");
        }
        let output = [reference("process.flank_wear")];
        let states = ["tool.flank_wear", "tool.cutting_path", "tool.energy", "tool.cutting_time"].map(reference);
        let outputs = ["process.flank_wear", "process.temperature", "process.cutting_force", "process.spindle_power"];
        let eight: Vec<u32> = states.into_iter().chain(outputs.map(reference)).collect();
        let mut values = [0.0; 8];
        for (what, references) in [("1 value", &output[..]), ("8 values", &eight[..]), ("no value", &[][..])] {
            let least = floor(
                200,
                || (),
                |_| {
                    let length = references.len();
                    black_box(get(unit, references.as_ptr(), length, values.as_mut_ptr(), length));
                },
            );
            println!("fmi3GetFloat64, {what}: {least:.1} ns");
        }
        let least = floor(200, || (), |_| assert_eq!(save(unit, &mut state), 0));
        println!("fmi3GetFMUState over an earlier one: {least:.1} ns");
        let least = floor(200, || (), |_| assert_eq!(restore(unit, state), 0));
        println!("fmi3SetFMUState: {least:.1} ns");
    }
}
