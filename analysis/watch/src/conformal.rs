//! Scores that are standard normal whatever the noise.

use statrs::distribution::{ContinuousCDF, Normal};

/// Normal score of the randomised rank of `value` among `values` and itself; `chance` (0 to 1, exclusive) decides
/// its place in its own step. Ranks in a growing set are independent and uniform under any exchangeable noise; those in a
/// sliding window, or against a fixed reference, are not.
///
/// # Examples
/// ```
/// use toolroom_watch::conformal_score;
/// assert_eq!(conformal_score(&[], 3.0, 0.5), 0.0);
/// assert!(conformal_score(&[1.0, 2.0, 2.5], 3.0, 0.5) > 1.0);
/// ```
pub fn conformal_score(values: &[f64], value: f64, chance: f64) -> f64 {
    let below = values.iter().filter(|other| **other < value).count() as f64;
    let same = values.iter().filter(|other| **other == value).count() as f64 + 1.0;
    let rank = (below + chance * same) / (values.len() as f64 + 1.0);
    Normal::standard().inverse_cdf(rank.clamp(1e-12, 1.0 - 1e-12))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    #[test]
    fn scores_of_heavy_tails_are_standard_normal_and_have_no_memory() {
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let (mut sum, mut squares, mut neighbours, mut count) = (0.0, 0.0, 0.0, 0.0);
        for _ in 0..40 {
            let (mut values, mut last) = (Vec::new(), 0.0);
            for _ in 0..150 {
                // Cauchy: no mean at all.
                let value = (std::f64::consts::PI * (random.random::<f64>() - 0.5)).tan();
                let z = conformal_score(&values, value, random.random());
                values.push(value);
                sum += z;
                squares += z * z;
                neighbours += z * last;
                last = z;
                count += 1.0;
            }
        }
        // Of 6000 scores: three standard errors are 0.039, and 0.055 of the variance.
        assert!((sum / count).abs() < 0.039, "{}", sum / count);
        assert!((squares / count - 1.0).abs() < 0.055, "{}", squares / count);
        assert!((neighbours / count).abs() < 0.039, "{}", neighbours / count);
    }
}
