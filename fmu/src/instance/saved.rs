//! Saved states: owned by the instance, called by handle.

use super::{Core, Instance};
use crate::fault::{Fault, Outcome};
use crate::log::Status;
use crate::unit::Unit;

/// One saved state.
pub(super) struct Saved<U: Unit> {
    /// Tells it apart from an earlier one in the same place.
    serial: u32,
    core: Box<Core<U>>,
}

/// Handles are no addresses: place and serial number, so that a freed or foreign one is found
/// out and never followed.
const PLACES: usize = 1 << 16;

impl<U: Unit> Instance<U> {
    fn saved_place(&self, handle: usize) -> Option<usize> {
        let place = handle % PLACES;
        let saved = self.saved.get(place)?.as_ref()?;
        (saved.serial as usize == handle / PLACES).then_some(place)
    }

    pub(super) fn saved(&self, handle: usize) -> Outcome<&Core<U>> {
        let place = self.saved_place(handle).ok_or(Fault::State)?;
        self.saved[place].as_ref().map(|saved| &*saved.core).ok_or_else(|| Fault::State.into())
    }

    /// Keeps `core` over the saved state `over`, or in a new place; 0 is no handle.
    fn keep(&mut self, core: Core<U>, over: usize) -> Outcome<usize> {
        if over != 0 {
            let place = self.saved_place(over).ok_or(Fault::State)?;
            if let Some(saved) = &mut self.saved[place] {
                *saved.core = core;
            }
            return Ok(over);
        }
        let free = self.saved.iter().position(Option::is_none);
        let place = free.unwrap_or(self.saved.len());
        if place == PLACES {
            return Err(Fault::NotOffered { feature: "more than 65536 saved states" }.into());
        }
        self.saves = self.saves.wrapping_add(1).max(1);
        let saved = Some(Saved { serial: self.saves, core: Box::new(core) });
        if free.is_some() {
            self.saved[place] = saved;
        } else {
            self.saved.push(saved);
        }
        Ok(self.saves as usize * PLACES + place)
    }

    pub(super) fn keep_state(&mut self, over: usize) -> Outcome<usize> {
        if over == 0 {
            return self.keep(self.core.clone(), 0);
        }
        // In place: the common case of an importer that tries steps.
        let place = self.saved_place(over).ok_or(Fault::State)?;
        if let Some(saved) = &mut self.saved[place] {
            (*saved.core).clone_from(&self.core);
        }
        Ok(over)
    }

    pub(super) fn go_back(&mut self, handle: usize) -> Outcome {
        self.core = self.saved(handle)?.clone();
        self.waiting.clear();
        self.process_changed();
        Ok(Status::Ok)
    }

    pub(super) fn forget(&mut self, handle: usize) -> Outcome {
        if handle != 0 {
            let place = self.saved_place(handle).ok_or(Fault::State)?;
            self.saved[place] = None;
        }
        Ok(Status::Ok)
    }

    pub(super) fn to_bytes(&self, handle: usize) -> Outcome<Vec<u8>> {
        Ok(super::serial::write(self.saved(handle)?))
    }

    pub(super) fn keep_bytes(&mut self, bytes: &[u8]) -> Outcome<usize> {
        let core = super::serial::read(bytes, self.resources.as_deref(), &self.core.model)?;
        self.keep(core, 0)
    }
}
