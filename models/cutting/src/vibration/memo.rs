//! Results that are kept.

use std::collections::HashMap;
use std::fmt;
use std::hash::{BuildHasherDefault, Hash, Hasher};
use std::sync::{Mutex, PoisonError};

/// Entries after which everything is forgotten; a shop needs some thousands.
const MOST: usize = 1 << 17;

/// A function's results by its arguments. It is invisible: equal to any other, empty when cloned.
pub(super) struct Memo<K, V>(Mutex<HashMap<K, V, BuildHasherDefault<Mixed>>>);

/// A hash of a few numbers, each mixed in by a multiplication. Keys are asked for at every stage of an integration, where
/// the standard hash, which withstands chosen keys, was seen in profiles; nobody chooses these.
#[derive(Default)]
pub(super) struct Mixed(u64);

/// An odd number of which no short pattern of bits is known: 2⁶⁴ over the golden ratio (Knuth, The Art of Computer
/// Programming 3, section 6.4).
const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;

impl Hasher for Mixed {
    fn write(&mut self, bytes: &[u8]) {
        for part in bytes.chunks(8) {
            let mut word = [0; 8];
            word[..part.len()].copy_from_slice(part);
            self.write_u64(u64::from_le_bytes(word));
        }
    }

    fn write_u64(&mut self, word: u64) {
        self.0 = (self.0.rotate_left(5) ^ word).wrapping_mul(GOLDEN);
    }

    fn write_u8(&mut self, number: u8) {
        self.write_u64(u64::from(number));
    }

    fn write_u32(&mut self, number: u32) {
        self.write_u64(u64::from(number));
    }

    fn write_usize(&mut self, number: usize) {
        self.write_u64(number as u64);
    }

    fn write_i32(&mut self, number: i32) {
        self.write_u64(number as u64);
    }

    fn write_i64(&mut self, number: i64) {
        self.write_u64(number as u64);
    }

    /// High bits, which the multiplication mixes best, are brought to where the table looks.
    fn finish(&self) -> u64 {
        self.0.rotate_left(26)
    }
}

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
        Self(Mutex::default())
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
