//! Errors of sensors and people.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Gamma, StandardNormal, StudentT};

/// A random source.
pub(crate) struct Chance(ChaCha8Rng);

impl Chance {
    pub fn new(seed: u64, stream: u64) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        random.set_stream(stream);
        Self(random)
    }

    pub fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }

    pub fn uniform(&mut self) -> f64 {
        self.0.random()
    }

    pub fn below(&mut self, count: usize) -> usize {
        self.0.random_range(0..count)
    }

    /// Gamma with a mean and shape 4.
    pub fn delay(&mut self, mean: f64) -> f64 {
        Gamma::new(4.0, mean / 4.0).map_or(mean, |gamma| gamma.sample(&mut self.0))
    }

    /// Student with two degrees of freedom, held in bounds.
    fn heavy(&mut self) -> f64 {
        let draw: f64 = StudentT::new(2.0).map_or(0.0, |student| student.sample(&mut self.0));
        draw.clamp(-12.0, 12.0)
    }
}

/// A relative error with memory and outliers.
pub(crate) struct Reading {
    deviation: f64,
    memory: f64,
    before: f64,
}

impl Reading {
    pub fn new(deviation: f64) -> Self {
        Self { deviation, memory: 0.5, before: 0.0 }
    }

    /// The next error.
    pub fn next(&mut self, chance: &mut Chance) -> f64 {
        let shock = if chance.uniform() < 0.03 { chance.heavy() } else { chance.normal() };
        self.before = self.memory * self.before + (1.0 - self.memory * self.memory).sqrt() * chance.normal();
        // Half of the variance has memory, half has not.
        self.deviation * (0.5_f64.sqrt() * self.before + 0.5_f64.sqrt() * shock)
    }
}
