//! Shapes of blocks at the stops of a point, as far as they are kept.

use super::stops::{Shape, Stops};
use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// A program and the bits of the rates of stops in its pools.
pub(super) type Profile = (usize, Vec<u64>);

/// Shapes by class of a block, by the bits of its rate of stops.
pub(super) type ByRate = BTreeMap<u64, Vec<Shape>>;

/// Shapes of programs of which anything is stopped.
pub(super) type Shapes = BTreeMap<Profile, ByRate>;

/// Replications of stops, and what they gave.
#[derive(Default)]
pub(super) struct Stopped {
    pub(super) stops: Stops,
    known: Mutex<Shapes>,
}

impl Stopped {
    pub(super) fn known(&self) -> MutexGuard<'_, Shapes> {
        // What a thread that panicked left behind is whole: shapes are put in when they are there.
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
