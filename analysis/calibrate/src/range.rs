//! Where the coordinates of a model end.

use nalgebra::DVector;

/// Farthest from a start that an end is looked for, in prior standard deviations: beyond, the prior alone leaves nothing (assumption).
const FARTHEST: f64 = 40.0;
/// Halvings of an interval of that length, to less than a thousandth of the step of a second difference.
const HALVINGS: usize = 25;

/// An interval in which a coordinate has to stay; infinite where no end is near.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Range {
    low: f64,
    high: f64,
}

impl Range {
    /// The interval around `x[place]` in which `possible` holds; `x` itself is possible, else nothing is an end.
    pub fn from_possible(possible: &dyn Fn(&DVector<f64>) -> bool, x: &DVector<f64>, place: usize) -> Self {
        let mut point = x.clone();
        let mut holds = |at: f64| {
            point[place] = at;
            possible(&point)
        };
        let here = x[place];
        if !holds(here) {
            return Self { low: f64::NEG_INFINITY, high: f64::INFINITY };
        }
        let [low, high] = [-1.0, 1.0].map(|way: f64| {
            let (mut inside, mut outside) = (here, way.mul_add(FARTHEST, here));
            if holds(outside) {
                return way * f64::INFINITY;
            }
            for _ in 0..HALVINGS {
                let middle = 0.5 * (inside + outside);
                if holds(middle) {
                    inside = middle;
                } else {
                    outside = middle;
                }
            }
            inside
        });
        Self { low, high }
    }

    /// The interval with so much less at either end; its middle where nothing would be left.
    pub fn within(self, margin: f64) -> Self {
        let (low, high) = (self.low + margin, self.high - margin);
        if low <= high { Self { low, high } } else { Self { low: 0.5 * (low + high), high: 0.5 * (low + high) } }
    }

    /// The value inside nearest to one.
    pub fn nearest(self, x: f64) -> f64 {
        x.clamp(self.low, self.high)
    }

    /// Whether the way up leads out at `x`.
    pub fn stops(self, x: f64, gradient: f64) -> bool {
        x <= self.low && gradient < 0.0 || x >= self.high && gradient > 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ensemble;
    use crate::fit::maximise;
    use crate::model::Model;
    use crate::parameter::{Parameter, Prior, Scale};
    use crate::sample::sample;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use statrs::distribution::{Continuous, ContinuousCDF, Normal};

    /// Two parameters with standard normal priors, the first of which is not below 0, and a likelihood far below it.
    struct Cornered {
        parameters: Vec<Parameter>,
    }

    /// Means, precisions and joint precision of the likelihood.
    const LIKELIHOOD: ([f64; 2], [f64; 2], f64) = ([-1.5, 0.5], [6.0, 5.0], -3.0);

    impl Cornered {
        fn new() -> Self {
            let one = |name: &str| Parameter::new(name, "1", Scale::Plain, Prior::new(0.0, 1.0), "");
            Self { parameters: vec![one("a"), one("b")] }
        }

        /// Mean and covariance without the end.
        fn whole() -> ([f64; 2], [[f64; 2]; 2]) {
            let (mean, [p, q], r) = LIKELIHOOD;
            let (a, b, c) = (p + 1.0, q + 1.0, r);
            let determinant = a * b - c * c;
            let covariance = [[b / determinant, -c / determinant], [-c / determinant, a / determinant]];
            let pull = [p * mean[0] + r * mean[1], r * mean[0] + q * mean[1]];
            let of = |row: [f64; 2]| row[0] * pull[0] + row[1] * pull[1];
            ([of(covariance[0]), of(covariance[1])], covariance)
        }
    }

    impl Model for Cornered {
        fn parameters(&self) -> &[Parameter] {
            &self.parameters
        }

        fn edges(&self) -> usize {
            1
        }

        fn possible(&self, u: &[f64]) -> bool {
            u[0] >= 0.0
        }

        fn ln_densities(&self, u: &[f64], _: &[usize]) -> Vec<f64> {
            if !self.possible(u) {
                return vec![f64::NEG_INFINITY];
            }
            let (mean, [p, q], r) = LIKELIHOOD;
            let (a, b) = (u[0] - mean[0], u[1] - mean[1]);
            vec![-0.5 * (p * a * a + 2.0 * r * a * b + q * b * b)]
        }

        fn readings(&self, _: usize) -> Vec<f64> {
            Vec::new()
        }

        fn replicate(&self, _: &[f64], _: usize, _: &mut ChaCha8Rng) -> Vec<f64> {
            Vec::new()
        }
    }

    #[test]
    fn a_range_is_found_from_inside_and_none_from_outside() {
        let possible = |x: &DVector<f64>| x[0] >= -0.25 && x[0] <= 3.0;
        let range = Range::from_possible(&possible, &DVector::from_vec(vec![1.0, 7.0]), 0);
        assert!((range.low + 0.25).abs() < 1e-5 && (range.high - 3.0).abs() < 1e-5, "{range:?}");
        assert_eq!(range.within(5.0).nearest(9.0), 0.5 * (range.low + range.high));
        let other = Range::from_possible(&possible, &DVector::from_vec(vec![1.0, 7.0]), 1);
        assert_eq!((other.low, other.high), (f64::NEG_INFINITY, f64::INFINITY));
    }

    /// The density is greatest at the end of the range. The draws are those of the normal distribution that is cut off there (N. L.
    /// Johnson, S. Kotz, N. Balakrishnan, Continuous Univariate Distributions 1, 1994, section 13.10), by weights and by walkers.
    #[test]
    fn a_parameter_that_the_data_push_out_of_its_range_keeps_its_uncertainty() {
        let (model, edges) = (Cornered::new(), [0]);
        let (mean, covariance) = Cornered::whole();
        let deviation = covariance[0][0].sqrt();
        let (normal, alpha) = (Normal::standard(), -mean[0] / deviation);
        assert!(alpha > 1.5, "the end is beyond the middle");
        let lambda = normal.pdf(alpha) / normal.sf(alpha);
        let first = deviation.mul_add(lambda, mean[0]);
        let slope = covariance[0][1] / covariance[0][0];
        let variance = covariance[0][0] * (1.0 + alpha * lambda - lambda * lambda);
        let second = slope.mul_add(first - mean[0], mean[1]);

        let map = maximise(&model, &edges, &DVector::from_vec(vec![0.8, -0.4]), None).unwrap();
        assert!((0.0..0.02).contains(&map.u[0]), "{}", map.u);
        assert!((map.u[1] - slope.mul_add(map.u[0] - mean[0], mean[1])).abs() < 1e-6, "{}", map.u);

        let by_weights = sample(&model, &edges, 4000, 1).unwrap();
        let mut random = ChaCha8Rng::seed_from_u64(2);
        let by_walkers = ensemble::run(&model, &edges, &[&map], 4000, &mut random);
        assert!(by_walkers.split_r < 1.02, "{}", by_walkers.split_r);
        for draws in [&by_weights.draws, &by_walkers.draws] {
            let average = |of: &dyn Fn(&DVector<f64>) -> f64| draws.iter().map(of).sum::<f64>() / draws.len() as f64;
            let (a, b) = (average(&|u| u[0]), average(&|u| u[1]));
            assert!((a - first).abs() < 0.06 * variance.sqrt(), "{a} instead of {first}");
            assert!((b - second).abs() < 0.06 * covariance[1][1].sqrt(), "{b} instead of {second}");
            let spread = average(&|u| (u[0] - a).powi(2));
            assert!((spread / variance).ln().abs() < 0.12, "{spread} instead of {variance}");
        }
    }

    #[test]
    fn walkers_that_stand_still_have_not_converged() {
        let model = Cornered::new();
        let place = crate::fit::Maximum {
            u: DVector::from_vec(vec![0.0, 0.0]),
            ln_density: 0.0,
            covariance: nalgebra::DMatrix::from_diagonal(&DVector::from_vec(vec![f64::NAN, f64::NAN])),
        };
        let chain = ensemble::run(&model, &[0], &[&place], 100, &mut ChaCha8Rng::seed_from_u64(3));
        assert!(chain.split_r.is_infinite() && chain.effective == 0.0);
    }
}
