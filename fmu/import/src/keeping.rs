//! How the state of an edge is kept between two calls.
//!
//! A process of the shop is an immutable value and its state a list of numbers, so that the shop
//! may go back, branch and run replications side by side. A unit that can write its state to
//! bytes fits in: the bytes are the numbers, instances are interchangeable. One that cannot
//! keeps one instance for each edge, and that instance goes forward only.

use crate::Port;
use crate::instance::{CallError, Instance, StartValue};
use crate::unit::Unit;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

/// Bytes in one number: whole numbers up to 2⁴⁸ survive every copy of an `f64`.
const BYTES: usize = 6;

/// Where states live.
#[derive(Debug)]
pub(crate) enum Keeping {
    /// In the numbers: time, count of bytes, bytes.
    Numbers { capacity: usize, pool: Mutex<Vec<Idle>>, single: bool },
    /// In instances: time, number of the instance, number of its steps.
    Instances(Mutex<Instances>),
}

/// An instance that nobody uses, and the state that it is in.
#[derive(Debug)]
pub(crate) struct Idle {
    instance: Instance,
    at: Vec<f64>,
}

/// Instances of edges.
#[derive(Debug, Default)]
pub(crate) struct Instances {
    next: u64,
    alive: BTreeMap<u64, (Instance, u64)>,
}

/// Why a state could not be used.
#[derive(Debug, thiserror::Error)]
pub(crate) enum KeepingError {
    #[error(transparent)]
    Call(#[from] CallError),
    #[error("its state grew to {size} bytes, {capacity} were foreseen")]
    Grown { size: usize, capacity: usize },
    #[error("it offers no FMU state (canSerializeFMUState): it cannot go back to an earlier time")]
    Forward,
    #[error("no instance could be made for this edge")]
    NoInstance,
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

impl Keeping {
    /// Tries the unit out: whether its state can be written, and the state of a new edge.
    pub fn of(maker: &Maker<'_>) -> Result<(Self, Vec<f64>), CallError> {
        let interface = maker.unit.interface();
        let mut instance = maker.instance()?;
        if !(interface.saves_state() && interface.serializes_state()) {
            drop(instance);
            return Ok((Self::Instances(Mutex::default()), vec![0.0; 3]));
        }
        let mut bytes = Vec::new();
        instance.serialize(&mut bytes)?;
        // Twice the bytes of a new edge; units whose state grows beyond are refused then.
        let capacity = 2 * bytes.len() + 64;
        let mut x = vec![0.0; 2 + capacity.div_ceil(BYTES)];
        pack(0.0, &bytes, &mut x);
        let single = interface.can("canBeInstantiatedOnlyOncePerProcess");
        let pool = Mutex::new(vec![Idle { instance, at: x.clone() }]);
        Ok((Self::Numbers { capacity, pool, single }, x))
    }

    /// Length of a state.
    pub fn length(&self) -> usize {
        match self {
            Self::Numbers { capacity, .. } => 2 + capacity.div_ceil(BYTES),
            Self::Instances(_) => 3,
        }
    }

    /// State of a new edge, where it is not the same numbers for each.
    pub fn begin(&self, maker: &Maker<'_>) -> Option<Vec<f64>> {
        let Self::Instances(instances) = self else { return None };
        let instance = maker.instance().ok()?;
        let mut instances = instances.lock().unwrap_or_else(PoisonError::into_inner);
        instances.next += 1;
        let number = instances.next;
        instances.alive.insert(number, (instance, 0));
        Some(vec![0.0, number as f64, 0.0])
    }

    /// Runs `work` on an instance in the state `x`; `work` gets the time and gives the time
    /// that it left the instance at, or `None` where it took no step.
    pub fn with<T>(
        &self,
        maker: &Maker<'_>,
        x: &mut [f64],
        work: impl FnOnce(&mut Instance, f64) -> Result<(T, Option<f64>), CallError>,
    ) -> Result<T, KeepingError> {
        match self {
            Self::Numbers { capacity, pool, single } => {
                let mut shelf = pool.lock().unwrap_or_else(PoisonError::into_inner);
                // The last one put back is most likely in the state wanted.
                let idle = shelf.pop();
                let held = single.then_some(shelf); // the only instance: others wait for it
                let mut idle = match idle {
                    Some(idle) => idle,
                    None => Idle { instance: maker.instance()?, at: Vec::new() },
                };
                if idle.at != x {
                    let bytes = unpack(x);
                    idle.at.clear();
                    idle.instance.deserialize(&bytes)?;
                }
                let (result, end) = work(&mut idle.instance, x[0])?;
                if let Some(time) = end {
                    let mut bytes = Vec::new();
                    idle.instance.serialize(&mut bytes)?;
                    if bytes.len() > *capacity {
                        return Err(KeepingError::Grown { size: bytes.len(), capacity: *capacity });
                    }
                    pack(time, &bytes, x);
                    idle.at = x.to_vec();
                } else {
                    idle.at.clear(); // its inputs are others now
                }
                match held {
                    Some(mut shelf) => shelf.push(idle),
                    None => pool.lock().unwrap_or_else(PoisonError::into_inner).push(idle),
                }
                Ok(result)
            }
            Self::Instances(instances) => {
                let number = x[1] as u64;
                let lock = || instances.lock().unwrap_or_else(PoisonError::into_inner);
                let (mut instance, steps) = lock().alive.remove(&number).ok_or(KeepingError::NoInstance)?;
                if steps as f64 != x[2] {
                    lock().alive.insert(number, (instance, steps));
                    return Err(KeepingError::Forward);
                }
                let (result, end) = work(&mut instance, x[0])?;
                let steps = steps + u64::from(end.is_some());
                lock().alive.insert(number, (instance, steps));
                if let Some(time) = end {
                    (x[0], x[2]) = (time, steps as f64);
                }
                Ok(result)
            }
        }
    }

    /// Whether an earlier state can be used again.
    pub fn goes_back(&self) -> bool {
        matches!(self, Self::Numbers { .. })
    }
}

/// Bytes as numbers; what is left of `x` is zero.
fn pack(time: f64, bytes: &[u8], x: &mut [f64]) {
    (x[0], x[1]) = (time, bytes.len() as f64);
    let numbers =
        bytes.chunks(BYTES).map(|chunk| chunk.iter().rev().fold(0u64, |sum, byte| sum << 8 | u64::from(*byte)));
    for (slot, number) in x[2..].iter_mut().zip(numbers.chain(std::iter::repeat(0))) {
        *slot = number as f64;
    }
}

fn unpack(x: &[f64]) -> Vec<u8> {
    let mut bytes: Vec<u8> =
        x[2..].iter().flat_map(|number| (*number as u64).to_le_bytes().into_iter().take(BYTES)).collect();
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
