//! What is kept of many lives: exact sums and counts, whatever the order in which they come.

use super::super::sample::Observation;
use serde::{Deserialize, Serialize};

/// Steps a unit of the fixed-point sums.
const STEPS: f64 = 4_294_967_296.0;

/// Sums of weights, values and squares as integers, so that merging parts in any order and
/// number gives the same bits.
///
/// A value is kept to 2^-32 of its unit; sums hold 10⁹ lives of up to 10⁵ units.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sums {
    count: u64,
    weight: i128,
    value: i128,
    square: i128,
}

impl Sums {
    /// Adds a value.
    pub fn push(&mut self, value: f64, weight: f64) {
        let (value, weight) = ((value * STEPS).round() / STEPS, (weight * STEPS).round() / STEPS);
        self.count += 1;
        self.weight += (weight * STEPS) as i128;
        self.value += (weight * value * STEPS) as i128;
        self.square += (weight * value * value * STEPS) as i128;
    }

    /// Adds the values of another part.
    pub fn merge(&mut self, other: &Self) {
        self.count += other.count;
        self.weight += other.weight;
        self.value += other.value;
        self.square += other.square;
    }

    /// Number of values.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Sum of the weights.
    pub fn weight(&self) -> f64 {
        self.weight as f64 / STEPS
    }

    /// Weighted mean; NaN without values.
    pub fn mean(&self) -> f64 {
        if self.weight == 0 { f64::NAN } else { self.value as f64 / self.weight as f64 }
    }

    /// Variance of the values, unbiased where all weights are 1.
    pub fn variance(&self) -> f64 {
        let n = self.count as f64;
        let mean = self.mean();
        let spread = self.square as f64 / self.weight as f64 - mean * mean;
        spread.max(0.0) * n / (n - 1.0)
    }

    /// Standard deviation over mean.
    pub fn variation(&self) -> f64 {
        self.variance().sqrt() / self.mean()
    }

    /// Standard error of the mean of independent values of weight 1.
    pub fn standard_error(&self) -> f64 {
        (self.variance() / self.count as f64).sqrt()
    }
}

// Integers of 128 bits are no JSON numbers: they travel as text.
impl Serialize for Sums {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        (self.count, self.weight.to_string(), self.value.to_string(), self.square.to_string()).serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Sums {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let (count, weight, value, square) = <(u64, String, String, String)>::deserialize(deserializer)?;
        let read = |text: String| text.parse::<i128>().map_err(serde::de::Error::custom);
        Ok(Self { count, weight: read(weight)?, value: read(value)?, square: read(square)? })
    }
}

/// Relative error of a quantile of the [`Sketch`].
pub const ERROR: f64 = 0.002;

/// Counts of positive values in classes of a fixed ratio: every quantile within [`ERROR`] of its
/// value, merged by adding counts.
///
/// # Source
/// C. Masson, J. E. Rim, H. K. Lee, DDSketch, Proc. VLDB Endowment 12 (2019) 2195.
///
/// # Examples
/// ```
/// use toolroom_life::study::tally::Sketch;
/// let mut sketch = Sketch::default();
/// (1..=1000).for_each(|i| sketch.push(f64::from(i), 1.0));
/// assert!((sketch.quantile(0.5) / 500.0 - 1.0).abs() < 0.003);
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Sketch {
    /// Class of the first count.
    first: i32,
    /// Weights in fixed point; all 1 in most studies.
    counts: Vec<u64>,
}

impl Sketch {
    /// `ln` of the ratio of neighbouring bounds, (1 + error)/(1 - error).
    fn width() -> f64 {
        2.0 * ERROR.atanh()
    }

    /// Adds a positive value.
    pub fn push(&mut self, value: f64, weight: f64) {
        let class = (value.max(f64::MIN_POSITIVE).ln() / Self::width()).floor() as i32;
        if self.counts.is_empty() {
            self.first = class;
        }
        if class < self.first {
            let missing = (self.first - class) as usize;
            self.counts.splice(0..0, std::iter::repeat_n(0, missing));
            self.first = class;
        }
        let index = (class - self.first) as usize;
        if index >= self.counts.len() {
            self.counts.resize(index + 1, 0);
        }
        self.counts[index] += (weight * STEPS).round() as u64;
    }

    /// Adds the values of another part.
    pub fn merge(&mut self, other: &Self) {
        if other.counts.is_empty() {
            return;
        }
        if self.counts.is_empty() {
            *self = other.clone();
            return;
        }
        let first = self.first.min(other.first);
        let end = |sketch: &Self| sketch.first + sketch.counts.len() as i32;
        let last = end(self).max(end(other));
        let mut counts = vec![0; (last - first) as usize];
        for sketch in [&*self, other] {
            for (i, count) in sketch.counts.iter().enumerate() {
                counts[(sketch.first - first) as usize + i] += count;
            }
        }
        *self = Self { first, counts };
    }

    /// Sum of the weights.
    pub fn weight(&self) -> f64 {
        self.counts.iter().map(|count| *count as f64 / STEPS).sum()
    }

    /// The value that a share of the weight does not reach; NaN without values.
    pub fn quantile(&self, share: f64) -> f64 {
        let total: f64 = self.counts.iter().map(|count| *count as f64).sum();
        let mut sum = 0.0;
        for (i, count) in self.counts.iter().enumerate() {
            sum += *count as f64;
            if *count > 0 && sum >= share * total {
                // As far from the lower bound of the class as from the upper one, in relative terms.
                return ((f64::from(self.first) + i as f64) * Self::width()).exp() * (1.0 + ERROR);
            }
        }
        f64::NAN
    }

    /// Weight of the values below `value`, a class that holds it counted in proportion.
    pub fn below(&self, value: f64) -> f64 {
        let position = value.ln() / Self::width();
        let share = |i: usize| (position - f64::from(self.first) - i as f64).clamp(0.0, 1.0);
        self.counts.iter().enumerate().map(|(i, count)| *count as f64 / STEPS * share(i)).sum()
    }

    /// The classes as observations between two bounds, with their weights; `joined` neighbours are one class.
    pub fn observations(&self, joined: i32) -> Vec<(Observation, f64)> {
        let bound = |class: i32| (f64::from(class) * f64::from(joined) * Self::width()).exp();
        let mut observations: Vec<(i32, u128)> = Vec::new();
        for (class, count) in self.classes() {
            // Classes are joined by their number, whatever the first one is.
            let class = class.div_euclid(joined);
            match observations.last_mut() {
                Some((last, sum)) if *last == class => *sum += u128::from(count),
                _ => observations.push((class, u128::from(count))),
            }
        }
        let weighed = |(class, count)| (Observation::Between(bound(class), bound(class + 1)), count as f64 / STEPS);
        observations.into_iter().map(weighed).collect()
    }

    /// Numbers and counts of the classes that hold something.
    pub fn classes(&self) -> impl Iterator<Item = (i32, u64)> + '_ {
        let number = |i: usize| self.first.saturating_add(i32::try_from(i).unwrap_or(i32::MAX));
        self.counts.iter().enumerate().filter(|(_, count)| **count > 0).map(move |(i, count)| (number(i), *count))
    }
}

/// A hash of lives that does not depend on their order: the sum of one hash a life.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Digest(pub u64);

impl Digest {
    /// Adds the words of one life.
    pub fn push(&mut self, words: &[u64]) {
        let hash = words.iter().fold(0xCBF2_9CE4_8422_2325, |state: u64, word| {
            let state = (state ^ word).wrapping_mul(0x9E37_79B9_7F4A_7C15);
            state ^ state >> 32
        });
        // The last multiplication spreads every bit before sums are taken.
        self.0 = self.0.wrapping_add((hash ^ hash >> 29).wrapping_mul(0xBF58_476D_1CE4_E5B9));
    }

    /// Adds another part.
    pub fn merge(&mut self, other: &Self) {
        self.0 = self.0.wrapping_add(other.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn parts_merge_to_the_same_bits_in_any_order(
            values in prop::collection::vec((1e-2..1e5f64, 0.0..3.0f64), 1..200),
            split in 0..200_usize,
        ) {
            let split = split.min(values.len());
            let tally = |values: &[(f64, f64)]| {
                let (mut sums, mut sketch) = (Sums::default(), Sketch::default());
                for (value, weight) in values {
                    sums.push(*value, *weight);
                    sketch.push(*value, *weight);
                }
                (sums, sketch)
            };
            let whole = tally(&values);
            let (first, second) = (tally(&values[..split]), tally(&values[split..]));
            let mut merged = second;
            merged.0.merge(&first.0);
            merged.1.merge(&first.1);
            prop_assert_eq!(&merged, &whole);
            let text = serde_json::to_string(&whole).unwrap();
            prop_assert_eq!(serde_json::from_str::<(Sums, Sketch)>(&text).unwrap(), whole);
        }

        #[test]
        fn quantiles_are_within_the_stated_error(mut values in prop::collection::vec(1e-3..1e6f64, 1..300), share in 0.0..1.0f64) {
            let mut sketch = Sketch::default();
            values.iter().for_each(|value| sketch.push(*value, 1.0));
            values.sort_by(f64::total_cmp);
            let rank = (share * values.len() as f64).ceil().max(1.0) as usize;
            let exact = values[rank - 1];
            prop_assert!((sketch.quantile(share) / exact - 1.0).abs() <= ERROR * 1.000_001, "{} {exact}", sketch.quantile(share));
        }
    }

    #[test]
    fn moments_are_those_of_the_values() {
        let mut sums = Sums::default();
        [2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0].into_iter().for_each(|value| sums.push(value, 1.0));
        assert!((sums.mean() - 5.0).abs() < 1e-12 && (sums.variance() - 32.0 / 7.0).abs() < 1e-9);
    }

    #[test]
    fn a_digest_feels_every_life_and_no_order() {
        let digest_of = |lives: &[[u64; 2]]| {
            let mut digest = Digest::default();
            lives.iter().for_each(|life| digest.push(life));
            digest
        };
        assert_eq!(digest_of(&[[1, 2], [3, 4]]), digest_of(&[[3, 4], [1, 2]]));
        assert_ne!(digest_of(&[[1, 2], [3, 4]]), digest_of(&[[1, 4], [3, 2]]));
        assert_ne!(digest_of(&[[1, 2], [3, 4]]), digest_of(&[[1, 2], [3, 5]]));
    }
}
