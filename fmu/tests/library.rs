//! The shared library as importers load it. Alone in its process, so that no other test takes memory.

#![cfg(target_os = "linux")]

use libloading::{Library, Symbol};
use std::ffi::{CString, c_char, c_void};
use std::path::PathBuf;
use std::ptr::{null, null_mut};
use toolroom_fmu::units;

/// The library that cargo built beside this test.
fn library() -> PathBuf {
    let test = std::env::current_exe().expect("a path");
    test.with_file_name("libtoolroom_fmu.so")
}

type Instantiate =
    unsafe extern "C" fn(*const c_char, i32, *const c_char, *const c_char, *const c_void, i32, i32) -> *mut c_void;
type Plain = unsafe extern "C" fn(*mut c_void) -> i32;
type Step = unsafe extern "C" fn(*mut c_void, f64, f64, i32) -> i32;
type Free = unsafe extern "C" fn(*mut c_void);

/// Loads the library, takes a step with a turning unit and unloads it.
fn cycle(path: &PathBuf, token: &CString) {
    // SAFETY: the library is this crate's, the types are those of FMI 2.0.
    unsafe {
        let library = Library::new(path).expect("a library");
        let make: Symbol<Instantiate> = library.get(b"fmi2Instantiate\0").expect("a function");
        let begin: Symbol<Plain> = library.get(b"fmi2EnterInitializationMode\0").expect("a function");
        let end: Symbol<Plain> = library.get(b"fmi2ExitInitializationMode\0").expect("a function");
        let step: Symbol<Step> = library.get(b"fmi2DoStep\0").expect("a function");
        let free: Symbol<Free> = library.get(b"fmi2FreeInstance\0").expect("a function");
        let unit = make(c"x".as_ptr(), 1, token.as_ptr(), null(), null_mut(), 0, 0);
        assert!(!unit.is_null());
        assert_eq!((begin(unit), end(unit), step(unit, 0.0, 0.1, 1)), (0, 0, 0));
        free(unit);
        library.close().expect("unloading");
    }
}

#[test]
fn loading_and_unloading_leaves_nothing_behind() {
    let (path, token) = (library(), units().next().map(|unit| unit.token()).unwrap_or_default());
    let token = CString::new(token).expect("a token");
    let resident = || {
        let pages = std::fs::read_to_string("/proc/self/statm").expect("statm");
        4096 * pages.split(' ').nth(1).and_then(|pages| pages.parse::<usize>().ok()).expect("a number of pages")
    };
    (0..50).for_each(|_| cycle(&path, &token));
    let before = resident();
    (0..3000).for_each(|_| cycle(&path, &token));
    let growth = resident().saturating_sub(before);
    assert!(growth < 1 << 20, "{growth} bytes more after 3000 loads");
}
