use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use serde::{Deserialize, Serialize};

/// A stream of random numbers: use it with the distributions of `rand_distr`.
///
/// It is plain data: a clone goes on with the same numbers.
pub type Stream = ChaCha8Rng;

/// Source of all random numbers of one replication.
///
/// A stream is ChaCha with 8 rounds. Who draws is written into the 256-bit key as it is, four
/// little-endian words, so two streams never share a key:
///
/// | key word | holds |
/// |---|---|
/// | 0 | seed |
/// | 1 | replication |
/// | 2 | entity |
/// | 3 | purpose, plus 2^63 for draws that are numbered by [`Streams::at`] |
///
/// The 64-bit stream number of ChaCha is the index of a numbered draw, else zero.
/// Hence the numbers depend on nothing but (seed, replication, entity, purpose, index): not on
/// the policy, the order of draws by others or the number of threads (common random numbers).
///
/// # Source
/// D. J. Bernstein, "ChaCha, a variant of Salsa20" (2008); key layout: assumption.
///
/// # Examples
/// ```
/// use rand::RngExt;
/// use toolroom_kernel::{Entity, Purpose, Streams};
/// let streams = Streams::new(42, 0);
/// let mut repairs = streams.open(Entity::named("lathe 1"), Purpose::Repair);
/// let u: f64 = repairs.random();
/// assert_eq!(u, 0.514_678_928_876_138_6);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Streams {
    seed: u64,
    replication: u64,
}

/// Who draws: a stable 64-bit name of a machine, part type, tool type, job, …
///
/// # Source
/// Names: FNV-1a 64 bit (Fowler, Noll, Vo) followed by the finaliser of SplitMix64 (Steele, Lea,
/// Flood 2014). Parts: one step of SplitMix64 per index.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Entity(u64);

impl Entity {
    /// The entity of a name that a person gave: it survives reordering of a scenario.
    #[must_use]
    pub fn named(name: &str) -> Self {
        let fnv = name
            .bytes()
            .fold(0xCBF2_9CE4_8422_2325, |hash: u64, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01B3));
        Self(finalise(fnv))
    }

    /// Number `index` of this entity: job 17 of a part type, spindle 2 of a machine.
    #[must_use]
    #[inline]
    pub fn part(self, index: u64) -> Self {
        Self(finalise(self.0.wrapping_add(index.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15))))
    }
}

/// What a draw decides. Each purpose of an entity has its own stream.
///
/// The numbers are part of the output format: never change one, only add.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[repr(u16)]
pub enum Purpose {
    /// Time between arrivals.
    Arrival = 1,
    /// Which part type, order size or due date.
    Order = 2,
    /// Which way through the shop.
    Routing = 3,
    /// Duration of an operation.
    Processing = 4,
    /// Duration of a setup or tool change.
    Setup = 5,
    /// Time to the next failure of a machine.
    Failure = 6,
    /// Duration of a repair.
    Repair = 7,
    /// Duration of a move.
    Transport = 8,
    /// Scatter from tool to tool.
    Tool = 9,
    /// Scatter from workpiece to workpiece: material, stock, geometry.
    Workpiece = 10,
    /// Noise of a sensor or gauge.
    Measurement = 11,
    /// Quality: scrap, rework.
    Quality = 12,
    /// Choices of a policy that explores.
    Policy = 13,
    /// Which draw of a posterior stands for the parameters of a tool.
    Parameters = 14,
}

impl Streams {
    /// The source for one replication of one seed.
    #[must_use]
    pub fn new(seed: u64, replication: u64) -> Self {
        Self { seed, replication }
    }

    /// The stream from which `entity` draws one after the other for `purpose`.
    #[must_use]
    pub fn open(&self, entity: Entity, purpose: Purpose) -> Stream {
        self.keyed(entity, purpose as u64)
    }

    /// The stream of draw number `index`, whichever draws were made before.
    ///
    /// Tool 17 of a type is as good or bad under every policy, in whatever order tools are used.
    #[must_use]
    pub fn at(&self, entity: Entity, purpose: Purpose, index: u64) -> Stream {
        let mut stream = self.keyed(entity, purpose as u64 | 1 << 63);
        stream.set_stream(index);
        stream
    }

    fn keyed(&self, entity: Entity, purpose: u64) -> Stream {
        let mut key = [0; 32];
        for (bytes, word) in key.chunks_exact_mut(8).zip([self.seed, self.replication, entity.0, purpose]) {
            bytes.copy_from_slice(&word.to_le_bytes());
        }
        Stream::from_seed(key)
    }
}

/// The finaliser of SplitMix64: one-to-one, every input bit reaches every output bit.
#[inline]
pub(super) fn finalise(word: u64) -> u64 {
    let word = (word ^ word >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let word = (word ^ word >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
    word ^ word >> 31
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, RngExt};
    use std::collections::HashSet;

    fn first(mut stream: Stream) -> u64 {
        stream.next_u64()
    }

    #[test]
    fn numbers_are_pinned() {
        let streams = Streams::new(42, 7);
        let lathe = Entity::named("lathe 1");
        let mut repairs = streams.open(lathe, Purpose::Repair);
        assert_eq!([repairs.next_u64(), repairs.next_u64()], [0x1237_8FEB_7D1A_45B1, 0x71BB_FA72_88D9_E803]);
        assert_eq!(first(streams.at(lathe, Purpose::Tool, 17)), 0xDAFF_C193_E92F_5CCF);
        assert_eq!([lathe.0, lathe.part(3).0], [0x5A8D_4E7C_4667_B397, 0xBB9E_2FEB_A0A5_EA20]);
        // The sampling algorithm of a distribution may change with its crate: then this line tells.
        let exponential: f64 = repairs.sample(rand_distr::Exp1);
        assert_eq!(exponential, 0.572_188_121_216_735_8);
    }

    /// Key and nonce zero, 8 rounds: first words of the published test vector.
    #[test]
    fn generator_is_chacha_with_8_rounds() {
        let mut stream = Stream::from_seed([0; 32]);
        let expected: [u8; 16] =
            [0x3e, 0x00, 0xef, 0x2f, 0x89, 0x5f, 0x40, 0xd6, 0x7f, 0x5b, 0xb8, 0xe8, 0x1f, 0x09, 0xa5, 0xa1];
        let mut bytes = [0; 16];
        stream.fill_bytes(&mut bytes);
        assert_eq!(bytes, expected);
    }

    #[test]
    fn every_coordinate_opens_another_stream() {
        let lathe = Entity::named("lathe");
        let mut seen = HashSet::new();
        let mut distinct = |stream: Stream| assert!(seen.insert(first(stream)));
        for word in 0..100 {
            distinct(Streams::new(word, 1000).open(lathe, Purpose::Arrival));
            distinct(Streams::new(1000, word).open(lathe, Purpose::Arrival));
            distinct(Streams::new(1000, 1000).open(lathe.part(word), Purpose::Arrival));
            distinct(Streams::new(1000, 1000).at(lathe, Purpose::Arrival, word));
            distinct(Streams::new(1000, 1000).at(lathe, Purpose::Failure, word));
        }
        distinct(Streams::new(1000, 1000).open(lathe, Purpose::Arrival));
    }

    #[test]
    fn names_and_parts_do_not_collide() {
        let mut seen = HashSet::new();
        for machine in 0..300u64 {
            let entity = Entity::named(&format!("machine {machine}"));
            assert!(seen.insert(entity));
            assert!((0..300).all(|index| seen.insert(entity.part(index))));
        }
    }

    #[test]
    fn a_clone_goes_on_with_the_same_numbers() {
        let mut stream = Streams::new(1, 2).open(Entity::named("mill"), Purpose::Failure);
        let _: f64 = stream.random();
        let mut copy = stream.clone();
        assert!((0..100).all(|_| stream.next_u64() == copy.next_u64()));
    }

    #[test]
    fn neighbouring_streams_are_uncorrelated() {
        let streams = Streams::new(3, 0);
        let tools = Entity::named("T2");
        let n = 20_000;
        let uniform = |index| -> f64 { streams.at(tools, Purpose::Tool, index).random::<f64>() - 0.5 };
        let covariance: f64 = (0..n).map(|i| uniform(i) * uniform(i + 1)).sum::<f64>() / n as f64;
        let standard_error = 1.0 / 12.0 / (n as f64).sqrt();
        assert!(covariance.abs() < 4.0 * standard_error, "{covariance}");
    }
}
