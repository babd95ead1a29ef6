//! Instances by handle: two threads, or a logger that calls back, get an error and no data race.

use super::sync::{AtomicU64, Mutex, UnsafeCell};
use super::table::{Free, Place, Refusal, Table};
use crate::component::Component;
use crate::log::Status;
use std::ffi::c_void;

/// Most instances at one time.
const PLACES: usize = 1 << 16;

#[cfg(not(target_pointer_width = "64"))]
compile_error!("a handle needs 64 bits");

static TABLE: Table<dyn Component, PLACES> = Table {
    places: [const { Place { key: AtomicU64::new(0), value: UnsafeCell::new(None) } }; PLACES],
    free: Mutex::new(Free::all()),
};

/// An instance in use.
pub(super) type Held = super::table::Held<'static, dyn Component>;

/// The instance of a handle for a call; [`Status::Error`] where it is NULL, freed, foreign or in
/// use, [`Status::Fatal`] where it has stopped.
#[inline]
pub(super) fn hold(handle: *mut c_void) -> Result<Held, Status> {
    TABLE.hold(handle as usize).map_err(|refusal| match refusal {
        Refusal::Unusable => Status::Error,
        Refusal::Stopped => Status::Fatal,
    })
}

/// Puts an instance into the table; `None` where it is full.
pub(super) fn keep(component: Box<dyn Component>) -> Option<*mut c_void> {
    TABLE.keep(component).map(|handle| handle as *mut c_void)
}

/// Takes an instance out of the table and drops it; nothing where there is none, or it is in use.
pub(super) fn release(handle: *mut c_void) {
    drop(TABLE.release(handle as usize));
}
