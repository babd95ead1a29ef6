//! Shiryaev–Roberts statistics.

use serde::{Deserialize, Serialize};

/// Shifts that are looked for, in standard deviations of a block (assumption).
const SHIFTS: [f64; 3] = [0.5, 1.0, 2.0];
/// Factors on the rate of rare events that are looked for (assumption).
const FACTORS: [f64; 3] = [0.5, 2.0, 3.0];

/// Statistic of scores, for shifts of half, one and two standard deviations to either side.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Detector {
    ratios: [f64; 2 * SHIFTS.len()],
}

impl Detector {
    /// Adds the score of a block and returns the statistic: the mean over the shifts. A score that is not finite counts
    /// as 0.
    ///
    /// # Examples
    /// ```
    /// let mut detector = toolroom_watch::Detector::default();
    /// assert!((detector.add(0.2) - 0.550_641).abs() < 1e-5);
    /// ```
    pub fn add(&mut self, score: f64) -> f64 {
        let score = if score.is_finite() { score } else { 0.0 };
        let shifts = SHIFTS.iter().flat_map(|shift| [*shift, -*shift]);
        for (ratio, shift) in self.ratios.iter_mut().zip(shifts) {
            *ratio = bounded((*ratio + 1.0) * (shift * score - 0.5 * shift * shift).exp());
        }
        self.statistic()
    }

    /// The statistic.
    pub fn statistic(&self) -> f64 {
        self.ratios.iter().sum::<f64>() / self.ratios.len() as f64
    }
}

/// Statistic of counts of rare events, for half, twice and three times their rate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RareDetector {
    ratios: [f64; FACTORS.len()],
}

impl RareDetector {
    /// Adds the `count` of a block in which `expected` events (0 or more) are expected, and returns the statistic.
    pub fn add(&mut self, count: u64, expected: f64) -> f64 {
        for (ratio, factor) in self.ratios.iter_mut().zip(FACTORS) {
            // Ratio of two Poisson probabilities.
            *ratio = bounded((*ratio + 1.0) * (count as f64 * factor.ln() - expected * (factor - 1.0)).exp());
        }
        self.statistic()
    }

    /// The statistic.
    pub fn statistic(&self) -> f64 {
        self.ratios.iter().sum::<f64>() / self.ratios.len() as f64
    }
}

/// A ratio that a file can hold; no threshold is as high.
fn bounded(ratio: f64) -> f64 {
    ratio.min(1e300)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    #[test]
    fn the_statistic_is_that_computed_independently() {
        let scores = [0.2, -1.1, 0.5, -0.3, 0.9, -0.6, 1.4, 0.8, 1.9, 0.7, 1.6, 1.2];
        let mut detector = Detector::default();
        let all: Vec<f64> = scores.iter().map(|score| detector.add(*score)).collect();
        for (block, reference) in [(1, 0.550_641), (6, 1.988_210), (9, 15.525_403), (12, 85.903_572)] {
            assert!((all[block - 1] / reference - 1.0).abs() < 1e-6, "{block}: {}", all[block - 1]);
        }
    }

    #[test]
    fn false_alarms_come_no_oftener_than_promised() {
        // Alarm within A/4 blocks with probability 1/4 at most, for scores and for counts.
        let threshold = 200.0;
        let mut random = ChaCha8Rng::seed_from_u64(5);
        let (mut alarms, mut rare) = (0, 0);
        for _ in 0..400 {
            let (mut detector, mut counts) = (Detector::default(), RareDetector::default());
            let (mut highest, mut highest_count) = (0.0_f64, 0.0_f64);
            for _ in 0..50 {
                let normal = (-2.0 * random.random::<f64>().max(1e-300).ln()).sqrt()
                    * (std::f64::consts::TAU * random.random::<f64>()).cos();
                highest = highest.max(detector.add(normal));
                // Poisson of mean 0.4 by inversion.
                let (mut u, mut probability, mut count) = (random.random::<f64>(), (-0.4_f64).exp(), 0);
                while u > probability && count < 20 {
                    u -= probability;
                    count += 1;
                    probability *= 0.4 / count as f64;
                }
                highest_count = highest_count.max(counts.add(count, 0.4));
            }
            alarms += u32::from(highest >= threshold);
            rare += u32::from(highest_count >= threshold);
        }
        // 100 of 400 are allowed.
        assert!(alarms <= 100 && rare <= 100 && alarms > 0, "{alarms} {rare}");
    }
}
