//! Noise on the rate of wear during the life of an edge.

use rand_distr::{Distribution, StandardNormal};
use toolroom_kernel::Stream;
use toolroom_wear::Scatter;

/// The wear noise is held for this share of its correlation time.
const HELD: f64 = 0.1;

/// Noise on the rate of wear, held for a share of its correlation time.
pub(super) struct Noise {
    scatter: Scatter,
    /// Time for which a value is held, s.
    pub held: f64,
    decay: f64,
    spread: f64,
    value: f64,
    /// Factor of the present value on the rate of wear.
    pub factor: f64,
}

impl Noise {
    pub fn new(scatter: &Scatter, stream: &mut Stream) -> Self {
        let held = if scatter.life_noise > 0.0 { HELD * scatter.life_noise_time } else { f64::INFINITY };
        let (decay, spread) = scatter.noise_transition(held);
        let value = scatter.sample_noise(stream);
        Self { scatter: *scatter, held, decay, spread, value, factor: scatter.noise_factor(value) }
    }

    pub fn next(&mut self, stream: &mut Stream) {
        let z: f64 = StandardNormal.sample(stream);
        self.value = self.value * self.decay + self.spread * z;
        self.factor = self.scatter.noise_factor(self.value);
    }
}

/// Time in cut against the time that wear without noise would take.
pub(super) struct Clock {
    noise: Noise,
    /// How long the noise still holds, s.
    left: f64,
    time: f64,
}

impl Clock {
    pub fn new(scatter: &Scatter, stream: &mut Stream) -> Self {
        let noise = Noise::new(scatter, stream);
        Self { left: noise.held, noise, time: 0.0 }
    }

    /// Lets time pass until wear has advanced by what would take `operational` seconds without
    /// noise; the time then. `part` is handed the ends of the parts between which the noise does not
    /// change: how far wear has advanced, in the same seconds, and the time.
    pub fn advance(&mut self, operational: f64, stream: &mut Stream, mut part: impl FnMut(f64, f64)) -> f64 {
        let mut rest = operational;
        while rest > self.left * self.noise.factor {
            rest -= self.left * self.noise.factor;
            self.time += self.left;
            part(operational - rest, self.time);
            self.noise.next(stream);
            self.left = self.noise.held;
        }
        self.time += rest / self.noise.factor;
        self.left -= rest / self.noise.factor;
        part(operational, self.time);
        self.time
    }
}
