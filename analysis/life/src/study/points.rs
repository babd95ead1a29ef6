//! Points of the unit cube at which inputs are drawn.

use rand::RngExt;
use toolroom_kernel::{Entity, Purpose, Streams};

/// How points are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sampling {
    /// Independent.
    Plain,
    /// Every second point mirrors the one before it.
    Antithetic,
    /// Latin hypercube over all lives: every coordinate falls once into each of as many classes.
    LatinHypercube,
    /// Sobol's sequence with Owen's scrambling.
    Sobol,
}

/// A source of points, any of them at once.
#[derive(Clone, Copy, Debug)]
pub struct Points {
    sampling: Sampling,
    streams: Streams,
    /// Number of points, for the classes of a Latin hypercube.
    count: u64,
    seed: u64,
}

/// Coordinates of which Sobol's sequence is made here; further ones are independent.
const SOBOL: usize = 21;

/// Degree, coefficients and initial direction numbers of the coordinates after the first.
///
/// # Source
/// S. Joe, F. Y. Kuo, SIAM J. Sci. Comput. 30 (2008) 2635 (new-joe-kuo-6.21201).
const JOE_KUO: [(u32, u32, [u32; 7]); SOBOL - 1] = [
    (1, 0, [1, 0, 0, 0, 0, 0, 0]),
    (2, 1, [1, 3, 0, 0, 0, 0, 0]),
    (3, 1, [1, 3, 1, 0, 0, 0, 0]),
    (3, 2, [1, 1, 1, 0, 0, 0, 0]),
    (4, 1, [1, 1, 3, 3, 0, 0, 0]),
    (4, 4, [1, 3, 5, 13, 0, 0, 0]),
    (5, 2, [1, 1, 5, 5, 17, 0, 0]),
    (5, 4, [1, 1, 5, 5, 5, 0, 0]),
    (5, 7, [1, 1, 7, 11, 19, 0, 0]),
    (5, 11, [1, 1, 5, 1, 1, 0, 0]),
    (5, 13, [1, 1, 1, 3, 11, 0, 0]),
    (5, 14, [1, 3, 5, 5, 31, 0, 0]),
    (6, 1, [1, 3, 3, 9, 7, 49, 0]),
    (6, 13, [1, 1, 1, 15, 21, 21, 0]),
    (6, 16, [1, 3, 1, 13, 27, 49, 0]),
    (6, 19, [1, 1, 1, 15, 7, 5, 0]),
    (6, 22, [1, 3, 1, 15, 13, 25, 0]),
    (6, 25, [1, 1, 5, 5, 19, 61, 0]),
    (7, 1, [1, 3, 7, 11, 23, 15, 103]),
    (7, 4, [1, 3, 7, 13, 13, 15, 69]),
];

/// Direction numbers, 32 bits of each coordinate.
const DIRECTIONS: [[u32; 32]; SOBOL] = directions();

const fn directions() -> [[u32; 32]; SOBOL] {
    let mut table = [[0; 32]; SOBOL];
    let mut k = 0;
    while k < 32 {
        table[0][k] = 1 << (31 - k);
        k += 1;
    }
    let mut j = 1;
    while j < SOBOL {
        let (degree, coefficients, initial) = JOE_KUO[j - 1];
        let s = degree as usize;
        let mut k = 0;
        while k < 32 {
            if k < s {
                table[j][k] = initial[k] << (31 - k);
            } else {
                let mut v = table[j][k - s] ^ (table[j][k - s] >> degree);
                let mut i = 1;
                while i < s {
                    if (coefficients >> (s - 1 - i)) & 1 == 1 {
                        v ^= table[j][k - i];
                    }
                    i += 1;
                }
                table[j][k] = v;
            }
            k += 1;
        }
        j += 1;
    }
    table
}

/// Coordinate `dimension` of point `index`, as 32 bits.
fn sobol(index: u32, dimension: usize) -> u32 {
    let mut value = 0;
    let mut rest = index;
    while rest != 0 {
        value ^= DIRECTIONS[dimension][rest.trailing_zeros() as usize];
        rest &= rest - 1;
    }
    value
}

/// Owen's nested scrambling by hashing.
///
/// # Source
/// B. Burley, Practical Hash-based Owen Scrambling, JCGT 9 (2020) 4, with the improved constants
/// of N. Vegdahl (2021, psychopath.io).
fn owen(value: u32, seed: u32) -> u32 {
    let mut x = value.reverse_bits();
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^= x.wrapping_mul(0x53a2_2864);
    x.reverse_bits()
}

/// One step of SplitMix64.
fn mix(word: u64) -> u64 {
    let z = word.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// A permutation of `0..count` by cycle walking over a Feistel network.
fn permuted(index: u64, count: u64, key: u64) -> u64 {
    let half = (64 - (count - 1).max(1).leading_zeros()).div_ceil(2).max(1);
    let mask = (1u64 << half) - 1;
    let mut scrambled = index;
    loop {
        let (mut left, mut right) = (scrambled >> half, scrambled & mask);
        for round in 0..4 {
            (left, right) = (right, left ^ (mix(right ^ key ^ (round << 56)) & mask));
        }
        scrambled = left << half | right;
        if scrambled < count {
            return scrambled;
        }
    }
}

impl Points {
    /// `count` points of a seed.
    pub fn new(sampling: Sampling, seed: u64, count: u64) -> Self {
        Self { sampling, streams: Streams::new(seed, 0), count: count.max(1), seed }
    }

    /// Fills `point` with the coordinates of point `index`, each within 0 and 1, ends excluded.
    ///
    /// # Examples
    /// ```
    /// use toolroom_life::study::points::{Points, Sampling};
    /// let points = Points::new(Sampling::Sobol, 1, 256);
    /// let mut x = [0.0; 3];
    /// let mean = (0..256).map(|i| { points.at(i, &mut x); x[1] }).sum::<f64>() / 256.0;
    /// assert!((mean - 0.5).abs() < 2e-3); // 256 independent points: 2e-2
    /// ```
    pub fn at(&self, index: u64, point: &mut [f64]) {
        let entity = Entity::named("life");
        let plain = |index: u64, point: &mut [f64]| {
            let mut stream = self.streams.at(entity, Purpose::Tool, index);
            point.iter_mut().for_each(|x| *x = open(stream.random()));
        };
        match self.sampling {
            Sampling::Plain => plain(index, point),
            Sampling::Antithetic => {
                plain(index / 2, point);
                if index % 2 == 1 {
                    point.iter_mut().for_each(|x| *x = 1.0 - *x);
                }
            }
            Sampling::LatinHypercube => {
                plain(index, point);
                for (j, x) in point.iter_mut().enumerate() {
                    let class = permuted(index % self.count, self.count, mix(self.seed ^ mix(j as u64)));
                    *x = open((class as f64 + *x) / self.count as f64);
                }
            }
            Sampling::Sobol => {
                if point.len() > SOBOL {
                    plain(index, &mut point[SOBOL..]);
                }
                let number = index as u32;
                for (j, x) in point.iter_mut().enumerate().take(SOBOL) {
                    let scrambled = owen(sobol(number, j), mix(self.seed ^ mix(j as u64 + 1)) as u32);
                    *x = (f64::from(scrambled) + 0.5) / 4_294_967_296.0;
                }
            }
        }
    }
}

/// A share strictly within 0 and 1.
fn open(u: f64) -> f64 {
    u.clamp(0.5f64.powi(54), 1.0 - 0.5f64.powi(53))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sequence_is_that_of_joe_and_kuo() {
        // scipy.stats.qmc.Sobol(21, scramble=False), points 5 and 100 in natural order: their
        // sequence is in Gray code order, position g(i) = i ^ (i >> 1).
        let gray = |i: u32| i ^ (i >> 1);
        let point = |i: u32| (0..SOBOL).map(|j| f64::from(sobol(gray(i), j)) / 4_294_967_296.0).collect::<Vec<_>>();
        for (i, expected) in SCIPY {
            assert_eq!(point(i), expected, "point {i}");
        }
    }

    const SCIPY: [(u32, [f64; SOBOL]); 3] = [
        (
            5,
            [
                0.875, 0.875, 0.125, 0.375, 0.875, 0.625, 0.875, 0.375, 0.375, 0.125, 0.375, 0.875, 0.875, 0.125,
                0.875, 0.375, 0.875, 0.375, 0.375, 0.625, 0.625,
            ],
        ),
        (
            100,
            [
                0.4140625, 0.2578125, 0.7734375, 0.7265625, 0.8828125, 0.7421875, 0.0234375, 0.4765625, 0.6328125,
                0.6953125, 0.4609375, 0.6796875, 0.4765625, 0.8515625, 0.3203125, 0.4921875, 0.6796875, 0.7421875,
                0.8359375, 0.3359375, 0.7578125,
            ],
        ),
        (
            127,
            [
                0.0078125, 0.6640625, 0.5546875, 0.6328125, 0.4765625, 0.3359375, 0.2421875, 0.0703125, 0.4140625,
                0.5390625, 0.6171875, 0.5859375, 0.8828125, 0.2578125, 0.6015625, 0.2734375, 0.9609375, 0.2109375,
                0.6796875, 0.8046875, 0.5390625,
            ],
        ),
    ];

    fn points(sampling: Sampling, n: u64, dimensions: usize) -> Vec<Vec<f64>> {
        let points = Points::new(sampling, 11, n);
        (0..n)
            .map(|i| {
                let mut point = vec![0.0; dimensions];
                points.at(i, &mut point);
                point
            })
            .collect()
    }

    #[test]
    fn every_class_of_a_latin_hypercube_is_hit_once() {
        for n in [1, 7, 100, 257] {
            let all = points(Sampling::LatinHypercube, n, 3);
            for j in 0..3 {
                let mut classes: Vec<u64> = all.iter().map(|point| (point[j] * n as f64) as u64).collect();
                classes.sort_unstable();
                assert_eq!(classes, (0..n).collect::<Vec<_>>());
            }
        }
    }

    #[test]
    fn scrambling_keeps_the_net() {
        // 256 points in 16 x 16 boxes of the first two coordinates: one in each.
        let mut boxes = [0; 256];
        for point in points(Sampling::Sobol, 256, 2) {
            boxes[(point[0] * 16.0) as usize * 16 + (point[1] * 16.0) as usize] += 1;
        }
        assert!(boxes.iter().all(|count| *count == 1), "{boxes:?}");
    }

    #[test]
    fn better_points_know_a_mean_better() {
        let value = |point: &[f64]| point.iter().map(|u| normal_score(*u).exp()).sum::<f64>();
        let exact = 4.0 * 0.5f64.exp();
        let error = |sampling| {
            let n = 4096;
            (points(sampling, n, 4).iter().map(|point| value(point)).sum::<f64>() / n as f64 - exact).abs()
        };
        let (plain, sobol) = (error(Sampling::Plain), error(Sampling::Sobol));
        assert!(plain < 0.3 && sobol < 0.02, "{plain} {sobol}");
        assert!(error(Sampling::LatinHypercube) < 0.05 && error(Sampling::Antithetic) < 0.3);
    }

    fn normal_score(u: f64) -> f64 {
        crate::normal::quantile(u)
    }
}
