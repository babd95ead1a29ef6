//! The time that short stops take together: how it is distributed.
//!
//! Stops come as a Poisson process while an operation is cut and last for an exponential time. What those of one operation
//! take together has the density of a compound Poisson sum, `exp(−λ − t/μ) √(λ/(μt)) I₁(2 √(λt/μ))` beside `exp(−λ)` at zero:
//! gamma densities whose index is a Poisson number (W. Feller, An Introduction to Probability Theory and Its Applications
//! II, 1971, II.7).

/// Share of operations that something else lengthened or shortened (1). Assumption: one in fifty.
pub const FOREIGN: f64 = 0.02;
/// Places at which the density of stops is folded with the rest (count, odd), within [`REACH`] standard deviations.
const PLACES: usize = 25;
/// Standard deviations of the rest within which it is folded (1). Derivation: 1e-6 of a normal density lies beyond.
const REACH: f64 = 5.0;
/// Stops from which their sum counts as normally distributed (count). Derivation: the series of fewer stays within a number.
const MANY: f64 = 600.0;

/// Normal density of `x` about zero, in units of one over those of `x`.
pub fn normal(x: f64, deviation: f64) -> f64 {
    (-0.5 * (x / deviation).powi(2)).exp() / (deviation * std::f64::consts::TAU.sqrt())
}

/// An operation that took longer than its program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stopped {
    /// Density of the excess, 1/s.
    pub density: f64,
    /// Mean time of stops given the excess, s; zero where the excess is impossible.
    pub time: f64,
}

impl Stopped {
    /// An excess of `excess` s, of which stops of `length` s in the mean take a part, `count` of them in the mean, and a rest of
    /// this standard deviation `spread`, s, the other. All but the excess are positive.
    pub fn new(excess: f64, count: f64, length: f64, spread: f64) -> Self {
        let without = (-count).exp() * normal(excess, spread);
        let (from, to) = ((excess - REACH * spread).max(0.0), excess + REACH * spread);
        if to <= from {
            return Self { density: without, time: 0.0 };
        }
        // By Simpson's rule.
        let step = (to - from) / (PLACES - 1) as f64;
        let (mut density, mut first) = (0.0, 0.0);
        for place in 0..PLACES {
            let time = from + step * place as f64;
            let weight = if place == 0 || place == PLACES - 1 { 1.0 } else { 2.0 + 2.0 * (place % 2) as f64 };
            let folded = weight * compound(time, count, length) * normal(excess - time, spread);
            density += folded;
            first += time * folded;
        }
        let density = without + step / 3.0 * density;
        Self { density, time: if density > 0.0 { step / 3.0 * first / density } else { 0.0 } }
    }
}

/// Density of the time that at least one stop takes, 1/s.
pub(crate) fn compound(time: f64, count: f64, length: f64) -> f64 {
    if count + time / length > MANY {
        return normal(time - count * length, length * (2.0 * count).sqrt());
    }
    // The series of the Bessel function: a gamma density of n stops, weighted by the probability of n.
    let (z, mut term, mut sum, mut n) = (count * time / length, 1.0, 0.0, 1.0);
    while term > 1e-14 * sum {
        sum += term;
        term *= z / (n * (n + 1.0));
        n += 1.0;
    }
    count / length * (-count - time / length).exp() * sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_density_of_stops_is_one_and_has_their_mean_and_variance() {
        for (count, length) in [(0.1, 20.0), (1.0, 20.0), (6.0, 10.0)] {
            let step = 0.02;
            let moments = (0..60_000).fold([f64::exp(-count), 0.0, 0.0], |sums, i| {
                let time = step * (f64::from(i) + 0.5);
                let density = step * compound(time, count, length);
                [sums[0] + density, sums[1] + time * density, sums[2] + time * time * density]
            });
            assert!((moments[0] - 1.0).abs() < 1e-5, "{moments:?}");
            assert!((moments[1] / (count * length) - 1.0).abs() < 1e-4, "{moments:?}");
            let variance = moments[2] - moments[1] * moments[1];
            assert!((variance / (2.0 * count * length * length) - 1.0).abs() < 1e-4, "{moments:?}");
        }
    }

    #[test]
    fn folded_with_the_rest_it_is_one_as_well_and_the_expected_times_have_the_mean_of_the_stops() {
        let (mut whole, mut mean) = (0.0, 0.0);
        for place in 0..8000 {
            let stopped = Stopped::new(0.05 * f64::from(place) - 40.0, 0.8, 20.0, 3.0);
            whole += 0.05 * stopped.density;
            mean += 0.05 * stopped.density * stopped.time;
        }
        assert!((whole - 1.0).abs() < 1e-3, "{whole}");
        assert!((mean / 16.0 - 1.0).abs() < 2e-3, "{mean}");
    }
}
