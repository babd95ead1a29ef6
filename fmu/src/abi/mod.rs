//! The C interfaces. The only module with `unsafe`: it reads and writes what importers point to.
//!
//! Every entry point goes through [`call`]: the handle is looked up and never followed, the
//! instance is locked against concurrent and nested calls, a panic becomes a fatal status.

#![allow(unsafe_code, non_snake_case)]

mod fmi2;
mod fmi3;
mod fmi3_values;
mod handles;
mod pointer;
mod sync;
mod table;
mod unload;

use crate::catalogue;
use crate::component::{Component, Interface};
use crate::fault::{Fault, Outcome};
use crate::log::{Category, Log, Sink, Status};
use crate::variable::ValueType;
use handles::Held;
use pointer::{slice, slice_mut};
use std::any::Any;
use std::ffi::c_void;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
pub(crate) use unload::at_unload;

/// Carries out one call on an instance.
#[inline]
fn call(handle: *mut c_void, name: &str, action: impl FnOnce(&mut dyn Component) -> Outcome) -> Status {
    match handles::hold(handle) {
        Ok(held) => carry_out(held, name, action),
        Err(status) => status,
    }
}

/// Carries out one call on an instance that is held for it.
#[inline]
fn carry_out(mut held: Held, name: &str, action: impl FnOnce(&mut dyn Component) -> Outcome) -> Status {
    match catch_unwind(AssertUnwindSafe(|| action(&mut *held))) {
        Ok(Ok(status)) => status,
        Ok(Err(fault)) => refuse(&mut held, name, &fault),
        Err(panic) => stop(&mut held, name, &*panic),
    }
}

/// Reads real variables. One output that is worked out already is handed over at once: importers ask for that most.
///
/// # Safety
/// Pointers that are not NULL point to `count` references and `length` values.
#[inline]
unsafe fn read_reals(
    handle: *mut c_void,
    name: &str,
    (references, count): (*const u32, usize),
    (values, length): (*mut f64, usize),
) -> Status {
    let held = match handles::hold(handle) {
        Ok(held) => held,
        Err(status) => return status,
    };
    // SAFETY: the caller's promise.
    let one = || unsafe { Some((references.as_ref()?, values.as_mut()?)) };
    if count == 1
        && length == 1
        && references.is_aligned()
        && values.is_aligned()
        && let Some((reference, value)) = one()
        && let Some(known) = held.peek(*reference)
    {
        *value = known;
        return Status::Ok;
    }
    carry_out(held, name, |unit| {
        // SAFETY: the caller's promise.
        let (references, values) =
            unsafe { (slice(references, count, "valueReferences")?, slice_mut(values, length, "values")?) };
        unit.read(ValueType::Real, references, values)
    })
}

/// Says why a call was refused.
#[cold]
fn refuse(held: &mut Held, name: &str, fault: &Fault) -> Status {
    held.log().say(Status::Error, Category::Error, &format!("{name}: {fault}"));
    Status::Error
}

/// Stops an instance after a panic.
#[cold]
fn stop(held: &mut Held, name: &str, panic: &(dyn Any + Send)) -> Status {
    held.stop();
    let text = format!("{name}: internal error: {}", words(panic));
    held.log().say(Status::Fatal, Category::Fatal, &text);
    Status::Fatal
}

/// What a panic says.
fn words(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<&str>().copied();
    text.or_else(|| panic.downcast_ref::<String>().map(String::as_str)).unwrap_or("without words")
}

/// Makes an instance; NULL where that is refused, with the reason in the log.
fn instantiate(token: Option<&str>, interface: Interface, resources: Option<PathBuf>, log: Log) -> *mut c_void {
    let refuse = |log: &Log, text: &str| {
        log.say(Status::Error, Category::Error, text);
        std::ptr::null_mut()
    };
    let Some(token) = token else { return refuse(&log, "no instantiation token is given") };
    let made = catch_unwind(AssertUnwindSafe(|| {
        let Some(unit) = catalogue::by_token(token) else {
            return refuse(&log, "the instantiation token is that of no unit in this library");
        };
        if interface == Interface::ModelExchange && !unit.continuous {
            return refuse(&log, "this unit offers no Model Exchange");
        }
        handles::keep(unit.instantiate(interface, resources, log)).unwrap_or(std::ptr::null_mut())
    }));
    made.unwrap_or(std::ptr::null_mut())
}

/// An importer's callback with what it has to be handed.
struct Callback<F> {
    function: F,
    /// The importer's own pointer; never followed here.
    environment: *mut c_void,
    /// Name of the instance, for FMI 2.0.
    instance: std::ffi::CString,
}

// SAFETY: the standards let every function of an instance be called from any thread, one at a
// time; the importer's callback and environment have to bear that.
unsafe impl<F: Copy> Send for Callback<F> where Callback<F>: Sink {}

/// The C functions on an instance that is no shipped unit.
#[cfg(test)]
pub(crate) mod breaking {
    use super::{Component, Status, c_void, fmi2, fmi3, handles};
    use std::ptr::null_mut;

    pub fn adopt(unit: Box<dyn Component>) -> *mut c_void {
        handles::keep(unit).expect("a free place")
    }

    pub fn initialise(unit: *mut c_void) -> Status {
        fmi2::fmi2EnterInitializationMode(unit).max(fmi2::fmi2ExitInitializationMode(unit))
    }

    pub fn step(unit: *mut c_void, time: f64, step: f64) -> Status {
        fmi2::fmi2DoStep(unit, time, step, 1)
    }

    pub fn step3(unit: *mut c_void, time: f64, step: f64) -> Status {
        // SAFETY: the importer of FMI 3.0 may leave out what it does not want to know.
        unsafe { fmi3::fmi3DoStep(unit, time, step, 1, null_mut(), null_mut(), null_mut(), null_mut()) }
    }

    pub fn free(unit: *mut c_void) {
        fmi2::fmi2FreeInstance(unit);
    }
}
