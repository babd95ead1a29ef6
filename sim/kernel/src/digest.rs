use super::SimTime;
use super::streams::finalise;
use std::fmt;

/// Rolling 64-bit hash of everything that happened: equal digests, equal runs.
///
/// Per 64-bit word, starting from `state = 0xCBF29CE484222325`:
///
/// ```text
/// state = (state ^ word) * 0x9E3779B97F4A7C15      modulo 2^64
/// state = state ^ (state >> 32)
/// ```
///
/// [`Digest::record`] feeds the bits of the time, the number of payload words, then the words.
/// The value is the state after the finaliser of SplitMix64. Both steps are one-to-one in the
/// state, so a difference in one word cannot be lost before the next word. It guards against
/// mistakes, not against an adversary. The algorithm is part of the output format: it does not
/// change within a major version.
///
/// # Source
/// Constants: FNV-1a 64-bit offset basis, golden ratio; finaliser: Steele, Lea and Flood, "Fast
/// splittable pseudorandom number generators", OOPSLA 2014. The combination is an assumption, its
/// quality is tested.
///
/// # Examples
/// ```
/// use toolroom_kernel::{Digest, SimTime};
/// let mut digest = Digest::new();
/// digest.record(SimTime::from_seconds(1.5)?, &[1, 2]);
/// assert_eq!(digest.to_string(), "d749f8b3335b3adf");
/// # Ok::<(), toolroom_kernel::KernelError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Digest(u64);

impl Default for Digest {
    fn default() -> Self {
        Self::new()
    }
}

impl Digest {
    /// The digest of a run in which nothing happened.
    #[must_use]
    pub const fn new() -> Self {
        Self(0xCBF2_9CE4_8422_2325)
    }

    /// Adds one event: its time and its content as words.
    #[inline]
    pub fn record(&mut self, time: SimTime, words: &[u64]) {
        self.word(time.to_bits());
        self.word(words.len() as u64);
        for &word in words {
            self.word(word);
        }
    }

    /// The hash of all that was recorded so far.
    #[must_use]
    pub fn value(&self) -> u64 {
        finalise(self.0)
    }

    #[inline]
    fn word(&mut self, word: u64) {
        self.0 = (self.0 ^ word).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        self.0 ^= self.0 >> 32;
    }
}

/// Sixteen hexadecimal digits.
impl fmt::Display for Digest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:016x}", self.value())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(events: &[(f64, &[u64])]) -> u64 {
        let mut digest = Digest::new();
        for &(seconds, words) in events {
            digest.record(SimTime::from_seconds(seconds).unwrap(), words);
        }
        digest.value()
    }

    #[test]
    fn order_grouping_and_time_count() {
        let reference = of(&[(1.0, &[1, 2]), (2.0, &[3])]);
        assert_eq!(reference, of(&[(1.0, &[1, 2]), (2.0, &[3])]));
        assert_ne!(reference, of(&[(1.0, &[2, 1]), (2.0, &[3])]));
        assert_ne!(reference, of(&[(1.0, &[1]), (2.0, &[2, 3])]));
        assert_ne!(reference, of(&[(1.0, &[1, 2]), (2.0 + 4.0 * f64::EPSILON, &[3])]));
        assert_ne!(reference, of(&[(1.0, &[1, 2])]));
    }

    #[test]
    fn every_input_bit_flips_about_half_of_the_output() {
        let reference = of(&[(1.0, &[0x1234_5678_9ABC_DEF0]), (2.0, &[7])]);
        for bit in 0..64 {
            let flipped = of(&[(1.0, &[0x1234_5678_9ABC_DEF0 ^ 1 << bit]), (2.0, &[7])]);
            let changed = (reference ^ flipped).count_ones();
            assert!((12..=52).contains(&changed), "bit {bit}: {changed}"); // 32 ± 5 standard deviations of 4
        }
    }
}
