//! How much of the scores of a channel has an order.

use super::Channel;
use std::ops::Range;

/// A direction of which less than this share is new beside the others counts as one of them (1).
const NEW: f64 = 1e-6;

/// Mean square of what the scores of a channel follow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Structured {
    /// Beyond what noise of the scale of the rest makes; below zero by chance.
    pub mean_square: f64,
    /// Its standard error.
    pub error: f64,
}

impl Structured {
    /// The mean square of the part of `scores` that lies in the mean, in the means of groups and along covariates of
    /// `channel`, beyond what noise like the rest makes along so many directions. Noise of any scale and distribution has none
    /// on average, nor has one that remembers its last value (a process of first order, whose memory is read off what is
    /// left): a sensor that wanders follows nothing. `None` where the directions are more than half of the scores: noise
    /// cannot be told from them then.
    ///
    /// # Panics
    /// Where the channel is not one of as many scores.
    ///
    /// # Examples
    /// ```
    /// use toolroom_fit_test::{Channel, Structured};
    /// let ramp: Vec<f64> = (0..8).map(f64::from).collect();
    /// let channel = Channel::new(vec![0..8], vec![ramp]);
    /// let steep = Structured::from_scores(&[-3.5, -2.6, -1.4, -0.5, 0.4, 1.5, 2.6, 3.5], &channel).unwrap();
    /// assert!((steep.mean_square - 5.25).abs() < 0.1 && steep.error < 0.3);
    /// ```
    pub fn from_scores(scores: &[f64], channel: &Channel) -> Option<Self> {
        let count = scores.len();
        let directions = Directions::new(count, channel)?;
        let mut left = scores.to_vec();
        directions.take_out(&mut left);
        let total = dot(&left, &left);
        let along = (dot(scores, scores) - total).max(0.0);
        let memory = directions.memory(&left);
        let lengths = directions.remembered(memory);
        let length: f64 = lengths.iter().sum();
        let noise = total / (count as f64 - length).max(0.5 * count as f64);
        let beyond = along - length * noise;
        // Of a noncentral chi-square: twice the squares of its weights and four times its noncentrality.
        let squares: f64 = lengths.iter().map(|length| length * length).sum();
        let typical = squares / length.max(f64::MIN_POSITIVE);
        let variance = 2.0 * squares * noise * noise + 4.0 * typical * noise * beyond.max(0.0);
        Some(Self { mean_square: beyond / count as f64, error: variance.sqrt() / count as f64 })
    }
}

/// Greatest memory that is believed of noise (1). Assumption: what remembers longer is a drift.
const GREATEST_MEMORY: f64 = 0.7;

/// Orthonormal directions of the groups, the mean and the covariates. Those of groups, of which a shop has thousands, are one
/// number each.
struct Directions<'a> {
    /// Groups with scores, which share none.
    groups: Vec<&'a Range<usize>>,
    /// The others, one after the other.
    others: Vec<Vec<f64>>,
}

impl<'a> Directions<'a> {
    /// `None` where there are more than half as many as scores, or no scores.
    fn new(count: usize, channel: &'a Channel) -> Option<Self> {
        let groups: Vec<&Range<usize>> = channel.groups.iter().filter(|group| !group.is_empty()).collect();
        let mut directions = Self { groups, others: Vec::new() };
        if count == 0 || 2 * directions.groups.len() > count {
            return None;
        }
        for mut column in std::iter::once(vec![1.0; count]).chain(channel.covariates.iter().cloned()) {
            let whole = dot(&column, &column);
            // Twice, since rounding of the first pass is as large as what is left of a column that is nearly known.
            directions.take_out(&mut column);
            directions.take_out(&mut column);
            let left = dot(&column, &column);
            if left > NEW * whole && left.is_finite() {
                let length = left.sqrt();
                column.iter_mut().for_each(|x| *x /= length);
                directions.others.push(column);
            }
        }
        (2 * directions.len() <= count).then_some(directions)
    }

    fn len(&self) -> usize {
        self.groups.len() + self.others.len()
    }

    /// Takes the directions out of `column`.
    fn take_out(&self, column: &mut [f64]) {
        for group in &self.groups {
            let of_group = &mut column[(*group).clone()];
            let mean = of_group.iter().sum::<f64>() / of_group.len() as f64;
            of_group.iter_mut().for_each(|x| *x -= mean);
        }
        for own in &self.others {
            let share = dot(own, column);
            column.iter_mut().zip(own).for_each(|(x, own)| *x -= share * own);
        }
    }

    /// Correlation of neighbours in a group of what the directions leave, made up for what the directions themselves do to
    /// it; not below zero.
    fn memory(&self, left: &[f64]) -> f64 {
        let neighbours = |of: &[f64]| -> f64 {
            let of_group =
                |group: &&Range<usize>| of[(*group).clone()].windows(2).map(|pair| pair[0] * pair[1]).sum::<f64>();
            self.groups.iter().map(of_group).sum()
        };
        let pairs: usize = self.groups.iter().map(|group| group.len() - 1).sum();
        let noise = dot(left, left) / (left.len() - self.len()) as f64;
        if pairs == 0 || noise <= 0.0 {
            return 0.0;
        }
        let by_groups: f64 = self.groups.iter().map(|group| (group.len() - 1) as f64 / group.len() as f64).sum();
        let taken = by_groups + self.others.iter().map(|own| neighbours(own)).sum::<f64>();
        ((neighbours(left) / noise + taken) / pairs as f64).clamp(0.0, GREATEST_MEMORY)
    }

    /// Variance along each direction of noise of unit variance with this correlation of neighbours in a group.
    fn remembered(&self, memory: f64) -> Vec<f64> {
        let in_group = |values: &mut dyn Iterator<Item = f64>| {
            let (mut sum, mut before) = (0.0, 0.0);
            for x in values {
                sum += x * (x + 2.0 * before);
                before = memory * (before + x);
            }
            sum
        };
        let of_group = |group: &&Range<usize>| {
            let own = (group.len() as f64).sqrt().recip();
            in_group(&mut std::iter::repeat_n(own, group.len()))
        };
        let along = |own: &Vec<f64>| {
            self.groups.iter().map(|group| in_group(&mut own[(*group).clone()].iter().copied())).sum::<f64>()
        };
        self.groups.iter().map(of_group).chain(self.others.iter().map(along)).collect()
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    /// Twelve groups of fourteen scores with ten covariates.
    fn channel(random: &mut ChaCha8Rng) -> Channel {
        let covariate = |_| (0..168).map(|_| StandardNormal.sample(&mut *random)).collect();
        Channel::new((0..12).map(|group| 14 * group..14 * (group + 1)).collect(), (0..10).map(covariate).collect())
    }

    #[test]
    fn noise_of_any_scale_has_no_structure_and_its_error_is_that_of_many_draws() {
        let mut random = ChaCha8Rng::seed_from_u64(11);
        let channel = channel(&mut random);
        for scale in [0.5, 4.0] {
            let draw = |_| {
                let scores: Vec<f64> = (0..168)
                    .map(|_| {
                        let z: f64 = StandardNormal.sample(&mut random);
                        scale * z
                    })
                    .collect();
                Structured::from_scores(&scores, &channel).unwrap()
            };
            let draws: Vec<Structured> = (0..400).map(draw).collect();
            let count = draws.len() as f64;
            let mean = draws.iter().map(|own| own.mean_square).sum::<f64>() / count;
            let spread = (draws.iter().map(|own| own.mean_square.powi(2)).sum::<f64>() / count - mean * mean).sqrt();
            let error = draws.iter().map(|own| own.error).sum::<f64>() / count;
            // A hundredth of the noise: a memory below zero counts as none, so that a little more is taken off on average.
            assert!(mean.abs() < 0.01 * scale * scale, "{mean} of {spread}");
            assert!((error / spread - 1.0).abs() < 0.2, "{error} instead of {spread}");
        }
    }

    /// Half of the variance remembers its last value by half, half nothing: neighbours are correlated by a quarter.
    #[test]
    fn noise_with_a_memory_has_little_structure() {
        let mut random = ChaCha8Rng::seed_from_u64(13);
        let smooth = |k: usize| (0..168).map(|i| (0.05 * (k as f64 + 1.0) * f64::from(i % 14)).sin()).collect();
        let groups = (0..12).map(|group| 14 * group..14 * (group + 1)).collect();
        let channel = Channel::new(groups, (0..5).map(smooth).collect());
        let mut draw = || {
            let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
            let mut slow = normal();
            let scores: Vec<f64> = (0..168)
                .map(|_| {
                    slow = 0.5 * slow + 0.75_f64.sqrt() * normal();
                    0.5_f64.sqrt() * (slow + normal())
                })
                .collect();
            Structured::from_scores(&scores, &channel).unwrap()
        };
        let draws: Vec<Structured> = (0..200).map(|_| draw()).collect();
        let mean = draws.iter().map(|own| own.mean_square).sum::<f64>() / 200.0;
        // 0.05 by an independent calculation, and 0.09 where the memory is not counted: that of this noise lasts longer than that of a
        // process of first order with the same correlation of neighbours.
        assert!(mean.abs() < 0.065, "{mean}");
    }

    #[test]
    fn a_step_between_groups_and_a_slope_count_in_full() {
        let mut random = ChaCha8Rng::seed_from_u64(12);
        let channel = channel(&mut random);
        let step = |i: usize| if (i / 14).is_multiple_of(2) { 1.0 } else { -1.0 };
        // A covariate has unit length.
        let slope = |i: usize| 168.0_f64.sqrt() * channel.covariates[3][i];
        for hidden in [&step as &dyn Fn(usize) -> f64, &slope] {
            let mut draw = |_| {
                let noisy = |i: usize| -> f64 {
                    let z: f64 = StandardNormal.sample(&mut random);
                    z + hidden(i)
                };
                Structured::from_scores(&(0..168).map(noisy).collect::<Vec<f64>>(), &channel).unwrap().mean_square
            };
            let mean = (0..100).map(&mut draw).sum::<f64>() / 100.0;
            // Three standard errors: one draw scatters by 0.16 (an independent calculation).
            assert!((mean - 1.0).abs() < 0.048, "{mean}");
        }
    }

    #[test]
    fn too_few_scores_for_their_directions_say_nothing() {
        let pairs = Channel::new((0..6).map(|i| 2 * i..2 * i + 2).collect(), vec![(0..12).map(f64::from).collect()]);
        assert_eq!(Structured::from_scores(&[0.5; 12], &pairs), None);
        assert_eq!(Structured::from_scores(&[], &Channel::default()), None);
    }
}
