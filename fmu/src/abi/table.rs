//! Values that are called by handle, one call at a time.
//!
//! What the caller holds is a place in the table and the number of the value that was put there,
//! never an address: NULL, freed and foreign pointers are found out without being followed. The
//! word of a place is at once the lock of its value and says whether it has stopped, so that one
//! comparison answers for all of it.
//!
//! This file knows nothing of units, so that `fmu/loom` can try it in every order of threads.

use super::sync::{AtomicU64, Mutex, UnsafeCell};
use std::ops::{Deref, DerefMut};
use std::sync::PoisonError;
use std::sync::atomic::Ordering;

/// Number of the first value. It sets the top bit of every handle of a table of 2¹⁶ places, which no
/// address of a program has (x86-64 and ARM: at most 56 bits), so that a pointer is never taken for
/// a handle; and no number is 0, which is the key of a free place.
const FIRST: u64 = 1 << 47;

/// Bit of a key: the value is in use.
const IN_USE: u64 = 1;

/// Bit of a key: the value has stopped for good.
const STOPPED: u64 = 2;

/// A place for a value.
pub(super) struct Place<T: ?Sized> {
    /// Number of the value, four times, with [`IN_USE`] and [`STOPPED`]; 0 where the place is free.
    pub key: AtomicU64,
    pub value: UnsafeCell<Option<Box<T>>>,
}

// SAFETY: `value` is touched only by whoever has set `IN_USE` in `key`, and in a free place by whoever
// took it from the list of free ones. Each has what it holds to itself.
unsafe impl<T: ?Sized + Send> Sync for Place<T> {}

/// Which places are free.
pub(super) struct Free {
    /// Used before and free again.
    again: Vec<usize>,
    /// The first that was never used.
    unused: usize,
    /// Number of the next value.
    next: u64,
}

impl Free {
    /// All of them.
    pub const fn all() -> Self {
        Self { again: Vec::new(), unused: 0, next: FIRST }
    }
}

/// Values by handle, at most `PLACES` at one time.
pub(super) struct Table<T: ?Sized, const PLACES: usize> {
    pub places: [Place<T>; PLACES],
    pub free: Mutex<Free>,
}

/// Why a value cannot be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Refusal {
    /// There is none of this handle, or it is in use.
    Unusable,
    /// It has stopped.
    Stopped,
}

impl<T: ?Sized, const PLACES: usize> Table<T, PLACES> {
    /// Place of a handle and its key while nobody uses it. `None` where a handle cannot look like
    /// that: the key of a free place must never be compared with, because it would be found.
    #[inline]
    fn place_of(&self, handle: usize) -> Option<(&Place<T>, u64)> {
        let number = (handle / PLACES) as u64;
        (number >= FIRST).then(|| (&self.places[handle % PLACES], number << 2))
    }

    /// The value of a handle, for this call alone.
    #[inline]
    pub fn hold(&self, handle: usize) -> Result<Held<'_, T>, Refusal> {
        let (place, key) = self.place_of(handle).ok_or(Refusal::Unusable)?;
        Held::take(place, key).map_err(|found| match found == key | STOPPED {
            true => Refusal::Stopped,
            false => Refusal::Unusable,
        })
    }

    /// Puts a value into the table and gives its handle; `None` where the table is full.
    pub fn keep(&self, value: Box<T>) -> Option<usize> {
        let mut free = self.free.lock().unwrap_or_else(PoisonError::into_inner);
        let index = match free.again.pop() {
            Some(index) => index,
            None if free.unused < PLACES => {
                free.unused += 1;
                free.unused - 1
            }
            None => return None,
        };
        let number = free.next;
        // 47 bits are left for it: as many values in the life of a process.
        free.next = FIRST | ((number + 1) % FIRST);
        let place = &self.places[index];
        // SAFETY: the place is off the list, and no handle has the key 0.
        place.value.with_mut(|old| unsafe { *old = Some(value) });
        place.key.store(number << 2, Ordering::Release);
        Some(number as usize * PLACES + index)
    }

    /// Takes a value out of the table; `None` where there is none of this handle, or it is in use.
    pub fn release(&self, handle: usize) -> Option<Box<T>> {
        let (place, key) = self.place_of(handle)?;
        let held = Held::take(place, key).or_else(|_| Held::take(place, key | STOPPED)).ok()?;
        // SAFETY: as in `take`.
        let value = place.value.with_mut(|value| unsafe { (*value).take() });
        // The place is free from here on, and not to be unlocked any more.
        std::mem::forget(held);
        place.key.store(0, Ordering::Release);
        self.free.lock().unwrap_or_else(PoisonError::into_inner).again.push(handle % PLACES);
        value
    }
}

/// A value in use.
pub(super) struct Held<'a, T: ?Sized> {
    place: &'a Place<T>,
    /// What the key is when it is no longer in use.
    key: u64,
    value: *mut T,
}

impl<'a, T: ?Sized> Held<'a, T> {
    /// The value in `place` where that has this `key`, or the key that it has.
    #[inline]
    fn take(place: &'a Place<T>, key: u64) -> Result<Self, u64> {
        place.key.compare_exchange(key, key | IN_USE, Ordering::Acquire, Ordering::Relaxed)?;
        // SAFETY: `IN_USE` is ours until `Held` is dropped.
        let value = place.value.with_mut(|value| unsafe { &mut *value }.as_deref_mut().map(std::ptr::from_mut));
        // A place with the number of a value has a value: it is put there first and taken away last.
        value.map(|value| Self { place, key, value }).ok_or(0)
    }

    /// Lets no call in any more.
    pub fn stop(&mut self) {
        self.key |= STOPPED;
    }
}

impl<T: ?Sized> Deref for Held<'_, T> {
    type Target = T;
    fn deref(&self) -> &T {
        // SAFETY: as in `take`; the box lives as long as its place is held.
        unsafe { &*self.value }
    }
}

impl<T: ?Sized> DerefMut for Held<'_, T> {
    fn deref_mut(&mut self) -> &mut T {
        // SAFETY: as in `take`, and `self` is borrowed exclusively.
        unsafe { &mut *self.value }
    }
}

impl<T: ?Sized> Drop for Held<'_, T> {
    #[inline]
    fn drop(&mut self) {
        self.place.key.store(self.key, Ordering::Release);
    }
}
