//! Saved states: owned by the instance, called by handle.

use super::{Core, Instance};
use crate::fault::{Fault, Outcome};
use crate::log::Status;
use crate::unit::Unit;
use std::sync::atomic::{AtomicU64, Ordering};

/// Most saved states of an instance at one time.
const PLACES: usize = 1 << 16;

/// Number of the first saved state. It sets the top bit of every handle, which no address of a program
/// has, so that a pointer is never taken for a handle.
const FIRST: u64 = 1 << 47;

/// Saved states of all instances so far. No two have the same number, so that a state of another
/// instance is found out.
static SAVES: AtomicU64 = AtomicU64::new(0);

/// One saved state.
struct Kept<U: Unit> {
    /// Tells it apart from every other one.
    number: u64,
    core: Box<Core<U>>,
}

/// The saved states of an instance. Their handles are no addresses: place and number, so that a
/// freed or foreign one is found out and never followed.
pub(super) struct Saved<U: Unit> {
    places: Vec<Option<Kept<U>>>,
    /// Places that were used and are free again, so that none has to be looked for.
    free: Vec<usize>,
}

impl<U: Unit> Saved<U> {
    pub fn new() -> Self {
        Self { places: Vec::new(), free: Vec::new() }
    }

    fn get(&self, handle: usize) -> Outcome<&Core<U>> {
        let kept = self.places.get(handle % PLACES).and_then(Option::as_ref);
        let state = kept.filter(|kept| kept.number as usize == handle / PLACES);
        state.map(|kept| &*kept.core).ok_or_else(|| Fault::State.into())
    }

    fn get_mut(&mut self, handle: usize) -> Outcome<&mut Core<U>> {
        let kept = self.places.get_mut(handle % PLACES).and_then(Option::as_mut);
        let state = kept.filter(|kept| kept.number as usize == handle / PLACES);
        state.map(|kept| &mut *kept.core).ok_or_else(|| Fault::State.into())
    }

    fn remove(&mut self, handle: usize) -> Outcome<()> {
        self.get(handle)?;
        self.places[handle % PLACES] = None;
        self.free.push(handle % PLACES);
        Ok(())
    }

    /// Keeps `core` in a free place.
    fn keep(&mut self, core: Core<U>) -> Outcome<usize> {
        let place = match self.free.pop() {
            Some(place) => place,
            None if self.places.len() < PLACES => {
                self.places.push(None);
                self.places.len() - 1
            }
            None => return Err(Fault::NotOffered { feature: "more than 65536 saved states at one time" }.into()),
        };
        let number = FIRST | (SAVES.fetch_add(1, Ordering::Relaxed) % FIRST);
        self.places[place] = Some(Kept { number, core: Box::new(core) });
        Ok(number as usize * PLACES + place)
    }
}

impl<U: Unit> Instance<U> {
    /// Keeps the present state over the saved state `over`, or anew where that is 0.
    pub(super) fn keep_state(&mut self, over: usize) -> Outcome<usize> {
        if over == 0 {
            return self.saved.keep(self.core.clone());
        }
        // In place: the common case of an importer that tries steps.
        self.saved.get_mut(over)?.clone_from(&self.core);
        Ok(over)
    }

    pub(super) fn go_back(&mut self, handle: usize) -> Outcome {
        self.core = self.saved.get(handle)?.clone();
        self.waiting.clear();
        self.process_changed();
        Ok(Status::Ok)
    }

    pub(super) fn forget(&mut self, handle: usize) -> Outcome {
        if handle != 0 {
            self.saved.remove(handle)?;
        }
        Ok(Status::Ok)
    }

    pub(super) fn to_bytes(&self, handle: usize) -> Outcome<Vec<u8>> {
        Ok(super::serial::write(self.saved.get(handle)?))
    }

    pub(super) fn keep_bytes(&mut self, bytes: &[u8]) -> Outcome<usize> {
        let core = super::serial::read(bytes, self.resources.as_deref(), &self.core.model)?;
        self.saved.keep(core)
    }
}
