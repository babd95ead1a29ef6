//! One probability for many statistics.

use toolroom_numerics::order_quantile;

/// What was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Judged {
    /// Probability of a greatest standardised statistic like the observed one, 1/(B + 1) … 1.
    pub p: f64,
    /// Probability of each statistic by itself.
    pub each: Vec<f64>,
    /// Each statistic standardised: 0 at the median, 1 at the 95 % point; −∞ where it does not vary.
    pub standardised: Vec<f64>,
    /// The greatest standardised statistic of each draw, ascending.
    pub greatest: Vec<f64>,
    /// Median and 95 % point of each statistic over the draws.
    pub scales: Vec<[f64; 2]>,
}

/// Holds `observed` statistics against those of data sets that the model drew, refitted each; `draws` has a row
/// for each of them. Statistics that do not vary over the draws have no part in the answer.
///
/// Each statistic counts by its distance from the median over that of the 95 % point, both over the draws and the
/// observed one together, so that nothing tells the observed data set from a drawn one; the greatest of all decides.
///
/// # Panics
/// Where a draw has fewer statistics than were observed.
pub fn judge(observed: &[f64], draws: &[Vec<f64>]) -> Judged {
    let count = draws.len() as f64;
    let mut p_values = Vec::with_capacity(observed.len());
    let mut scales = Vec::with_capacity(observed.len());
    for (index, value) in observed.iter().enumerate() {
        let mut drawn: Vec<f64> = draws.iter().map(|draw| draw[index]).collect();
        let above = drawn.iter().filter(|draw| *draw >= value).count() as f64;
        p_values.push((above + 1.0) / (count + 1.0));
        let varies = drawn.iter().any(|draw| *draw != drawn[0]);
        drawn.push(if varies { *value } else { drawn.first().copied().unwrap_or(*value) });
        drawn.sort_by(f64::total_cmp);
        scales.push([order_quantile(&drawn, 0.5), order_quantile(&drawn, 0.95)]);
    }
    let standardised: Vec<f64> = observed.iter().zip(&scales).map(|(value, scale)| distance(*value, *scale)).collect();
    let greatest_of = |values: &[f64]| {
        values.iter().zip(&scales).map(|(value, scale)| distance(*value, *scale)).fold(f64::NEG_INFINITY, f64::max)
    };
    let mut greatest: Vec<f64> = draws.iter().map(|draw| greatest_of(draw)).collect();
    greatest.sort_by(f64::total_cmp);
    let largest = standardised.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let above = greatest.iter().filter(|draw| **draw >= largest).count() as f64;
    Judged { p: (above + 1.0) / (count + 1.0), each: p_values, standardised, greatest, scales }
}

impl Judged {
    /// Standardised statistic above which the greatest one is at the level `level`.
    pub fn critical(&self, level: f64) -> f64 {
        order_quantile(&self.greatest, 1.0 - level)
    }
}

/// Distance from the median over that of the 95 % point; of what does not vary it is beyond all others.
fn distance(value: f64, [middle, high]: [f64; 2]) -> f64 {
    let spread = high - middle;
    if spread > 1e-12 * (1.0 + middle.abs()) { (value - middle) / spread } else { f64::NEG_INFINITY }
}

/// Size at which the power reaches `wanted`, between the neighbours of `points` (size and power, by rising size) in
/// proportion; `None` where none reaches it. Below the first point the power falls to nothing at size zero.
///
/// # Examples
/// ```
/// let points = [(1.0, 0.2), (2.0, 0.8), (3.0, 1.0)];
/// assert_eq!(toolroom_fit_test::interpolated(&points, 0.9), Some(2.5));
/// ```
pub fn interpolated(points: &[(f64, f64)], wanted: f64) -> Option<f64> {
    let mut below = (0.0, 0.0);
    for (size, power) in points {
        if *power >= wanted {
            let share = (wanted - below.1) / (power - below.1);
            return Some(below.0 + share * (size - below.0));
        }
        below = (*size, *power);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    fn draws(count: usize, random: &mut ChaCha8Rng) -> Vec<Vec<f64>> {
        let mut one = || -> Vec<f64> {
            let z: Vec<f64> = (0..4).map(|_| StandardNormal.sample(random)).collect();
            // Statistics of another scale and distribution each, two of them tied to one another.
            vec![z[0].abs(), 100.0 * z[1] * z[1], z[2].exp(), z[2] + 0.1 * z[3]]
        };
        (0..count).map(|_| one()).collect()
    }

    #[test]
    fn probabilities_are_uniform_where_nothing_is_hidden() {
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let trials = 1000;
        let p: Vec<f64> = (0..trials)
            .map(|_| {
                let reference = draws(99, &mut random);
                judge(&draws(1, &mut random)[0], &reference).p
            })
            .collect();
        // Three binomial standard deviations of a thousand.
        for (level, tolerance) in [(0.01, 0.0095), (0.05, 0.021), (0.5, 0.048)] {
            let rejected = p.iter().filter(|p| **p <= level).count() as f64 / f64::from(trials);
            assert!((rejected - level).abs() < tolerance, "{rejected} at {level}");
        }
    }

    #[test]
    fn one_statistic_far_out_is_enough() {
        let mut random = ChaCha8Rng::seed_from_u64(4);
        let reference = draws(999, &mut random);
        let judged = judge(&[0.5, 50.0, 1.0, 9.0], &reference);
        assert_eq!(judged.p, 0.001);
        assert_eq!(judged.each[3], 0.001);
        assert!(judged.each[0] > 0.1 && judged.standardised[3] > judged.critical(0.01));
    }

    #[test]
    fn a_statistic_that_never_varies_decides_nothing() {
        let reference = vec![vec![1.0, 0.1], vec![1.0, 0.2], vec![1.0, 0.3]];
        assert_eq!(judge(&[7.0, 0.15], &reference).p, 0.75);
    }

    #[test]
    fn power_is_interpolated_from_nothing() {
        assert_eq!(interpolated(&[(2.0, 0.9), (3.0, 1.0)], 0.9), Some(2.0));
        assert_eq!(interpolated(&[(2.0, 1.0)], 0.5), Some(1.0));
        assert_eq!(interpolated(&[(2.0, 0.3)], 0.9), None);
    }
}
