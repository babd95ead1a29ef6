//! Instances by handle.
//!
//! What an importer holds is a place in a table and the number of the instance that was put
//! there, never an address: NULL, freed and foreign pointers are found out without being
//! followed. The same word of the table is the lock of the instance, so that two threads, or a
//! logger that calls back, get an error and no data race.

use crate::component::Component;
use std::cell::UnsafeCell;
use std::ffi::c_void;
use std::ops::{Deref, DerefMut};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

/// Most instances at one time.
const PLACES: usize = 1 << 16;

#[cfg(not(target_pointer_width = "64"))]
compile_error!("a handle needs 64 bits");

struct Place {
    /// Number of the instance, doubled, plus 1 while it is in use; 0 where the place is free.
    key: AtomicU64,
    component: UnsafeCell<Option<Box<dyn Component>>>,
}

// SAFETY: `component` is touched only by whoever has set the lowest bit of `key`.
unsafe impl Sync for Place {}

static TABLE: [Place; PLACES] = [const { Place { key: AtomicU64::new(0), component: UnsafeCell::new(None) } }; PLACES];

/// Places that were used and are free again, the first that was never used, and the number of
/// the next instance.
static FREE: Mutex<(Vec<usize>, usize, u64)> = Mutex::new((Vec::new(), 0, 1));

/// An instance in use.
pub(super) struct Held {
    place: &'static Place,
    key: u64,
    component: *mut dyn Component,
}

/// The instance of a handle, unless it is NULL, freed, foreign or in use.
#[inline]
pub(super) fn hold(handle: *mut c_void) -> Option<Held> {
    let handle = handle as usize;
    let (place, number) = (&TABLE[handle % PLACES], (handle / PLACES) as u64);
    if number == 0 {
        return None;
    }
    let key = number << 1;
    place.key.compare_exchange(key, key | 1, Ordering::Acquire, Ordering::Relaxed).ok()?;
    // SAFETY: the lowest bit of the key is ours until `Held` is dropped.
    let component = unsafe { (*place.component.get()).as_mut() }.map(|component| std::ptr::from_mut(&mut **component));
    match component {
        Some(component) => Some(Held { place, key, component }),
        None => {
            place.key.store(key, Ordering::Release);
            None
        }
    }
}

impl Deref for Held {
    type Target = dyn Component;
    fn deref(&self) -> &Self::Target {
        // SAFETY: as in `hold`; the box lives as long as its place is held.
        unsafe { &*self.component }
    }
}

impl DerefMut for Held {
    fn deref_mut(&mut self) -> &mut Self::Target {
        // SAFETY: as in `hold`, and `self` is borrowed exclusively.
        unsafe { &mut *self.component }
    }
}

impl Drop for Held {
    #[inline]
    fn drop(&mut self) {
        self.place.key.store(self.key, Ordering::Release);
    }
}

/// Puts an instance into the table; `None` where it is full.
pub(super) fn keep(component: Box<dyn Component>) -> Option<*mut c_void> {
    let mut free = FREE.lock().unwrap_or_else(PoisonError::into_inner);
    let (places, unused, next) = &mut *free;
    let index = places.pop().or_else(|| {
        *unused += 1;
        (*unused <= PLACES).then_some(*unused - 1)
    })?;
    let number = *next;
    // 48 bits of the handle are left for the number: 2^48 instances in the life of a process.
    *next = (*next + 1) % (1 << 47);
    *next = (*next).max(1);
    let place = &TABLE[index];
    // SAFETY: a free place is in nobody's use, and its key is still 0.
    unsafe { *place.component.get() = Some(component) };
    place.key.store(number << 1, Ordering::Release);
    Some((number as usize * PLACES + index) as *mut c_void)
}

/// Takes an instance out of the table and drops it; false where there is none.
pub(super) fn release(handle: *mut c_void) -> bool {
    let Some(held) = hold(handle) else { return false };
    let index = handle as usize % PLACES;
    // SAFETY: as in `hold`.
    let component = unsafe { (*held.place.component.get()).take() };
    held.place.key.store(0, Ordering::Release);
    std::mem::forget(held);
    FREE.lock().unwrap_or_else(PoisonError::into_inner).0.push(index);
    drop(component);
    true
}
