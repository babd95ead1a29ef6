//! Instances by handle.
//!
//! What an importer holds is a place in a table and the number of the instance that was put
//! there, never an address: NULL, freed and foreign pointers are found out without being
//! followed. The same word of the table is the lock of the instance, so that two threads, or a
//! logger that calls back, get an error and no data race; and it says whether the instance has
//! stopped, so that one comparison answers for all of it.

use crate::component::Component;
use crate::log::Status;
use std::cell::UnsafeCell;
use std::ffi::c_void;
use std::ops::{Deref, DerefMut};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

/// Most instances at one time.
const PLACES: usize = 1 << 16;

#[cfg(not(target_pointer_width = "64"))]
compile_error!("a handle needs 64 bits");

/// Bit of a key: the instance is in use.
const IN_USE: u64 = 1;

/// Bit of a key: the instance has stopped for good.
const STOPPED: u64 = 2;

/// The key of an instance that can be called.
fn key_of(number: u64) -> u64 {
    number << 2
}

struct Place {
    /// Number of the instance, four times, with [`IN_USE`] and [`STOPPED`]; 0 where the place is free.
    key: AtomicU64,
    component: UnsafeCell<Option<Box<dyn Component>>>,
}

// SAFETY: `component` is touched only by whoever has set `IN_USE` in `key`.
unsafe impl Sync for Place {}

static TABLE: [Place; PLACES] = [const { Place { key: AtomicU64::new(0), component: UnsafeCell::new(None) } }; PLACES];

/// Places that were used and are free again, the first that was never used, and the number of
/// the next instance.
static FREE: Mutex<(Vec<usize>, usize, u64)> = Mutex::new((Vec::new(), 0, 1));

/// An instance in use.
pub(super) struct Held {
    place: &'static Place,
    /// What the key is when it is no longer in use.
    key: u64,
    component: *mut dyn Component,
}

/// The instance of a handle for a call; [`Status::Error`] where it is NULL, freed, foreign or in
/// use, [`Status::Fatal`] where it has stopped.
#[inline]
pub(super) fn hold(handle: *mut c_void) -> Result<Held, Status> {
    let (place, number) = place_of(handle);
    let key = key_of(number);
    match Held::take(place, key) {
        Ok(held) => Ok(held),
        Err(found) if found == key | STOPPED && number != 0 => Err(Status::Fatal),
        Err(_) => Err(Status::Error),
    }
}

/// Place and number in a handle.
#[inline]
fn place_of(handle: *mut c_void) -> (&'static Place, u64) {
    let handle = handle as usize;
    (&TABLE[handle % PLACES], (handle / PLACES) as u64)
}

impl Held {
    /// The instance in `place` where that has this `key`, or the key that it has.
    #[inline]
    fn take(place: &'static Place, key: u64) -> Result<Self, u64> {
        place.key.compare_exchange(key, key | IN_USE, Ordering::Acquire, Ordering::Relaxed)?;
        // SAFETY: `IN_USE` is ours until `Held` is dropped.
        match unsafe { &mut *place.component.get() } {
            Some(component) => Ok(Self { place, key, component: std::ptr::from_mut(&mut **component) }),
            // A free place: its key is that of NULL.
            None => {
                place.key.store(key, Ordering::Release);
                Err(key)
            }
        }
    }

    /// Lets no call in any more.
    pub fn stop(&mut self) {
        self.key |= STOPPED;
    }
}

impl Deref for Held {
    type Target = dyn Component;
    fn deref(&self) -> &Self::Target {
        // SAFETY: as in `take`; the box lives as long as its place is held.
        unsafe { &*self.component }
    }
}

impl DerefMut for Held {
    fn deref_mut(&mut self) -> &mut Self::Target {
        // SAFETY: as in `take`, and `self` is borrowed exclusively.
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
    place.key.store(key_of(number), Ordering::Release);
    Some((number as usize * PLACES + index) as *mut c_void)
}

/// Takes an instance out of the table and drops it; false where there is none.
pub(super) fn release(handle: *mut c_void) -> bool {
    let (place, number) = place_of(handle);
    let key = key_of(number);
    let Ok(held) = Held::take(place, key).or_else(|_| Held::take(place, key | STOPPED)) else { return false };
    // SAFETY: as in `take`.
    let component = unsafe { (*place.component.get()).take() };
    place.key.store(0, Ordering::Release);
    std::mem::forget(held);
    FREE.lock().unwrap_or_else(PoisonError::into_inner).0.push(handle as usize % PLACES);
    drop(component);
    true
}
