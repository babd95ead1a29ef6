//! Results that are kept.

use std::collections::HashMap;
use std::fmt;
use std::hash::Hash;
use std::sync::{Mutex, PoisonError};

/// Entries after which everything is forgotten; a shop needs some thousands.
const MOST: usize = 1 << 17;

/// A function's results by its arguments. It is invisible: equal to any other, empty when cloned.
pub(super) struct Memo<K, V>(Mutex<HashMap<K, V>>);

impl<K: Hash + Eq + Copy, V: Copy> Memo<K, V> {
    /// The result for `key`, worked out where it is new.
    pub fn of(&self, key: K, work: impl FnOnce() -> V) -> V {
        if let Some(known) = self.0.lock().unwrap_or_else(PoisonError::into_inner).get(&key) {
            return *known;
        }
        // Outside the lock: two threads may work out the same, but none waits.
        let value = work();
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if known.len() >= MOST {
            known.clear();
        }
        known.insert(key, value);
        value
    }
}

impl<K, V> Default for Memo<K, V> {
    fn default() -> Self {
        Self(Mutex::new(HashMap::new()))
    }
}

impl<K, V> Clone for Memo<K, V> {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl<K, V> PartialEq for Memo<K, V> {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl<K, V> fmt::Debug for Memo<K, V> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Memo")
    }
}
