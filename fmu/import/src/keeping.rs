//! How the state of an edge is kept between two calls.
//!
//! A process of the shop is an immutable value and its state a list of numbers, so that the shop
//! may go back, branch and run replications side by side. A unit that can write its state to
//! bytes fits in: the bytes are the numbers, instances are interchangeable. One that cannot
//! keeps one instance for each edge. Where that instance saves states in memory, it goes back to
//! any state since the last one that the shop settled on; else it goes forward only.

use crate::Port;
use crate::instance::{Action, Answer, CallError, Instance, Place, StartValue};
use crate::unit::Unit;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Bytes in one number: whole numbers up to 2⁴⁸ survive every copy of an `f64`.
const BYTES: usize = 6;

/// Where states live.
#[derive(Debug)]
pub(crate) enum Keeping {
    /// In the numbers: time, count of bytes, bytes.
    Numbers { capacity: usize, pool: Mutex<Vec<Idle>>, single: bool },
    /// In instances: time, number of the instance, number of the state.
    Instances { edges: Mutex<Edges>, goes_back: bool },
}

/// An instance that nobody uses, the state that it is in, and what was read there.
#[derive(Debug)]
pub(crate) struct Idle {
    instance: Instance,
    at: Vec<f64>,
    reading: Option<Reading>,
}

/// Outputs at the end of a step, under the inputs of that step.
#[derive(Debug)]
pub(crate) struct Reading {
    inputs: Vec<f64>,
    outputs: Vec<f64>,
}

impl Reading {
    /// A reading of `outputs` under `inputs`.
    pub fn of(inputs: &[f64], outputs: &[f64]) -> Self {
        Self { inputs: inputs.to_vec(), outputs: outputs.to_vec() }
    }

    /// The outputs, where the inputs are these to the bit.
    fn under(&self, inputs: &[f64]) -> Option<Vec<f64>> {
        let bits = |numbers: &[f64]| numbers.iter().map(|number| number.to_bits()).collect::<Vec<_>>();
        (bits(&self.inputs) == bits(inputs)).then(|| self.outputs.clone())
    }
}

/// Instances of edges.
#[derive(Debug, Default)]
pub(crate) struct Edges {
    next: u64,
    alive: BTreeMap<u64, Edge>,
}

#[derive(Debug)]
struct Edge {
    instance: Instance,
    /// State that the instance is in.
    at: Place,
    /// States so far.
    states: Place,
    /// States that are saved in memory.
    saved: BTreeSet<Place>,
    reading: Option<Reading>,
}

/// Why a state could not be used.
#[derive(Debug, thiserror::Error)]
pub(crate) enum KeepingError {
    #[error(transparent)]
    Call(#[from] CallError),
    #[error("its state grew to {size} bytes, {capacity} were foreseen")]
    Grown { size: usize, capacity: usize },
    #[error("it offers no FMU state (canGetAndSetFMUState): it cannot go back to an earlier time")]
    Forward,
    #[error("no instance could be made for this edge")]
    NoInstance,
    #[error("{0}")]
    Impossible(String),
}

/// What makes an instance.
pub(crate) struct Maker<'a> {
    pub unit: &'a Arc<Unit>,
    pub start_values: &'a [(Port, StartValue)],
}

impl Maker<'_> {
    fn instance(&self) -> Result<Instance, CallError> {
        Instance::new(self.unit, self.start_values, 0.0)
    }
}

/// An instance on its way to the state that is wanted, and from it to the next.
pub(crate) struct Turn<'a> {
    instance: &'a mut Instance,
    /// Time of the state, s.
    pub time: f64,
    entry: Option<Entry>,
    exit: Option<Action<'static>>,
    /// What was read of the outputs in the state that was kept last.
    pub reading: Option<Reading>,
}

enum Entry {
    Bytes(Vec<u8>),
    Place(Place),
}

impl Turn<'_> {
    /// Does `actions` from the state that is wanted, and keeps the state that they lead to with `keep`.
    pub fn act(&mut self, actions: &[Action<'_>], keep: bool, answer: &mut Answer) -> Result<(), CallError> {
        let entry = self.entry.take();
        self.reading = None;
        let first = entry.as_ref().map(|entry| match entry {
            Entry::Bytes(bytes) => Action::Deserialize(bytes),
            Entry::Place(place) => Action::Restore(*place),
        });
        let last = self.exit.filter(|_| keep);
        let all: Vec<Action<'_>> = first.into_iter().chain(actions.iter().copied()).chain(last).collect();
        self.instance.act(&all, answer)
    }
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Keeping {
    /// Tries the unit out: whether its state can be written, and the state of a new edge. `look` reads what is to be
    /// known of the new edge.
    pub fn from_maker(maker: &Maker<'_>, look: &[Action<'_>]) -> Result<(Self, Vec<f64>, Vec<f64>), CallError> {
        let interface = maker.unit.interface();
        let mut instance = maker.instance()?;
        let mut answer = Answer::default();
        if !(interface.saves_state() && interface.serializes_state()) {
            instance.act(look, &mut answer)?;
            let keeping = Self::Instances { edges: Mutex::default(), goes_back: interface.saves_state() };
            return Ok((keeping, vec![0.0; 3], answer.values));
        }
        let all: Vec<Action<'_>> = look.iter().copied().chain([Action::Serialize]).collect();
        instance.act(&all, &mut answer)?;
        // Twice the bytes of a new edge; units whose state grows beyond are refused then.
        let capacity = 2 * answer.bytes.len() + 64;
        let mut x = vec![0.0; 2 + capacity.div_ceil(BYTES)];
        pack(0.0, &answer.bytes, &mut x);
        let pool = Mutex::new(vec![Idle { instance, at: x.clone(), reading: None }]);
        Ok((Self::Numbers { capacity, pool, single: maker.unit.only_one() }, x, answer.values))
    }

    /// Length of a state.
    pub fn length(&self) -> usize {
        match self {
            Self::Numbers { capacity, .. } => 2 + capacity.div_ceil(BYTES),
            Self::Instances { .. } => 3,
        }
    }

    /// What tells the state `x` from others, in whichever instance it is.
    pub fn moment(&self, x: &[f64]) -> Vec<f64> {
        match self {
            Self::Numbers { .. } => x.to_vec(),
            Self::Instances { .. } => vec![x[0], x[2]],
        }
    }

    /// State of a new edge, where it is not the same numbers for each.
    pub fn begin(&self, maker: &Maker<'_>) -> Option<Vec<f64>> {
        let Self::Instances { edges, goes_back } = self else { return None };
        let mut instance = maker.instance().ok()?;
        let mut saved = BTreeSet::new();
        if *goes_back {
            instance.act(&[Action::Save(0)], &mut Answer::default()).ok()?;
            saved.insert(0);
        }
        let mut edges = locked(edges);
        edges.next += 1;
        let number = edges.next;
        edges.alive.insert(number, Edge { instance, at: 0, states: 0, saved, reading: None });
        Some(vec![0.0, number as f64, 0.0])
    }

    /// Forgets every state of the edge but `x`.
    pub fn settle(&self, x: &[f64]) {
        let Self::Instances { edges, goes_back: true } = self else { return };
        if let Some(edge) = locked(edges).alive.get_mut(&(x[1] as u64)) {
            let old: Vec<Place> = edge.saved.iter().copied().filter(|place| *place != x[2] as Place).collect();
            let forget: Vec<Action<'_>> = old.iter().map(|place| Action::Forget(*place)).collect();
            edge.saved.retain(|place| !old.contains(place));
            // An instance that cannot even do that says so at its next step.
            let _ = edge.instance.act(&forget, &mut Answer::default());
        }
    }

    /// Frees the instance of the edge.
    pub fn retire(&self, x: &[f64]) {
        if let Self::Instances { edges, .. } = self {
            let edge = locked(edges).alive.remove(&(x[1] as u64));
            drop(edge); // after the lock: a worker may take its time
        }
    }

    /// Runs `work` on an instance in the state `x`; `work` gives the time at which it kept a
    /// state ([`Turn::act`]), or `None` where it took no step.
    pub fn with<T>(
        &self,
        maker: &Maker<'_>,
        x: &mut [f64],
        answer: &mut Answer,
        work: impl FnOnce(&mut Turn<'_>, &mut Answer) -> Result<(T, Option<f64>), KeepingError>,
    ) -> Result<T, KeepingError> {
        match self {
            Self::Numbers { capacity, pool, single } => {
                let mut shelf = locked(pool);
                // The last one put back is most likely in the state wanted. One whose process has died is no use.
                let idle = std::iter::from_fn(|| shelf.pop()).find(|idle| idle.instance.alive());
                let held = single.then_some(shelf); // the only instance: others wait for it
                let mut idle = match idle {
                    Some(idle) => idle,
                    None => Idle { instance: maker.instance()?, at: Vec::new(), reading: None },
                };
                let entry = (idle.at != x).then(|| Entry::Bytes(unpack(x)));
                idle.at.clear(); // its inputs are others from now on
                let exit = Some(Action::Serialize);
                let mut turn = Turn { instance: &mut idle.instance, time: x[0], entry, exit, reading: None };
                let (result, end) = work(&mut turn, answer)?;
                idle.reading = turn.reading;
                if let Some(time) = end {
                    let bytes = &answer.bytes;
                    if bytes.len() > *capacity {
                        return Err(KeepingError::Grown { size: bytes.len(), capacity: *capacity });
                    }
                    pack(time, bytes, x);
                    idle.at = x.to_vec();
                }
                match held {
                    Some(mut shelf) => shelf.push(idle),
                    None => locked(pool).push(idle),
                }
                Ok(result)
            }
            Self::Instances { edges, goes_back } => {
                let (number, wanted) = (x[1] as u64, x[2] as Place);
                let mut edge = locked(edges).alive.remove(&number).ok_or(KeepingError::NoInstance)?;
                if edge.at != wanted && !edge.saved.contains(&wanted) {
                    locked(edges).alive.insert(number, edge);
                    return Err(KeepingError::Forward);
                }
                let entry = (edge.at != wanted).then_some(Entry::Place(wanted));
                let next = edge.states + 1;
                let exit = goes_back.then_some(Action::Save(next));
                let mut turn = Turn { instance: &mut edge.instance, time: x[0], entry, exit, reading: None };
                let (result, end) = work(&mut turn, answer)?;
                edge.reading = turn.reading;
                edge.at = wanted;
                if let Some(time) = end {
                    (edge.at, edge.states) = (next, next);
                    edge.saved.extend(goes_back.then_some(next));
                    (x[0], x[2]) = (time, f64::from(next));
                }
                locked(edges).alive.insert(number, edge);
                Ok(result)
            }
        }
    }

    /// Outputs in the state `x` under `inputs`, where an instance was read just so at the end of its last step.
    pub fn read_before(&self, x: &[f64], inputs: &[f64]) -> Option<Vec<f64>> {
        match self {
            Self::Numbers { pool, .. } => {
                let pool = locked(pool);
                // The last one put back is most likely the one.
                pool.iter().rev().filter(|idle| idle.at == x).find_map(|idle| idle.reading.as_ref()?.under(inputs))
            }
            Self::Instances { edges, .. } => {
                let edges = locked(edges);
                let edge = edges.alive.get(&(x[1] as u64)).filter(|edge| edge.at == x[2] as Place)?;
                edge.reading.as_ref()?.under(inputs)
            }
        }
    }

    /// Whether an earlier state can be used again.
    pub fn goes_back(&self) -> bool {
        match self {
            Self::Numbers { .. } => true,
            Self::Instances { goes_back, .. } => *goes_back,
        }
    }
}

/// Bytes as numbers; what is left of `x` is zero.
fn pack(time: f64, bytes: &[u8], x: &mut [f64]) {
    (x[0], x[1]) = (time, bytes.len() as f64);
    for (slot, chunk) in x[2..].iter_mut().zip(bytes.chunks(BYTES)) {
        let mut number = [0; 8];
        number[..chunk.len()].copy_from_slice(chunk);
        *slot = u64::from_le_bytes(number) as f64;
    }
    x[2 + bytes.len().div_ceil(BYTES)..].fill(0.0);
}

fn unpack(x: &[f64]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(BYTES * x.len());
    // Numbers beyond the bytes are zero: a state takes up half of its room.
    for number in x[2..].iter().take((x[1] as usize).div_ceil(BYTES)) {
        bytes.extend_from_slice(&(*number as u64).to_le_bytes()[..BYTES]);
    }
    bytes.truncate(x[1] as usize);
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn bytes_survive_as_numbers(bytes in prop::collection::vec(any::<u8>(), 0..200), time in 0.0..1e6f64) {
            let mut x = vec![7.0; 2 + bytes.len().div_ceil(BYTES) + 3];
            pack(time, &bytes, &mut x);
            prop_assert!(x.iter().all(|number| number.is_finite()));
            prop_assert_eq!(x[0], time);
            prop_assert_eq!(unpack(&x), bytes);
        }
    }
}
