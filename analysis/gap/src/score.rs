//! Projected scores: what is left of a signature after calibration, allowance and local factors,
//! and how strongly the data ask for it.

use super::Gram;
use super::constants::NULL_LEVEL;
use super::gram::{factor, part};
use nalgebra::DMatrix;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Scores of columns after projection.
#[derive(Clone, Debug)]
pub struct Scores {
    /// Score of each column, standard normal where nothing is hidden.
    pub score: Vec<f64>,
    /// Length of each column after projection: its score per unit of size.
    pub length: Vec<f64>,
    /// Share of each column that the projection takes away.
    pub masking: Vec<f64>,
    /// Correlation of the scores: cosines of the projected columns.
    pub cosine: DMatrix<f64>,
    /// Estimate of each column's size alone.
    pub estimate: Vec<f64>,
}

/// Share of a column's squared length below which it counts as wholly masked.
const NOTHING_LEFT: f64 = 1e-9;

/// Scores of the columns from `first` to the residual; those before it are nuisance with unit
/// priors, `free` among them with next to none.
pub fn scores(gram: &Gram, first: usize, free: &[usize]) -> Scores {
    let nuisance: Vec<usize> = (0..first).collect();
    let columns: Vec<usize> = (first..=gram.last()).collect();
    let mut matrix = part(&gram.total, &nuisance, &nuisance);
    for i in 0..first {
        matrix[(i, i)] += if free.contains(&i) { super::evidence::EFFECT_PRIOR.powi(-2) } else { 1.0 };
    }
    let mut rest = part(&gram.total, &columns, &columns);
    if first > 0 {
        let cross = factor(matrix).half_solved(&part(&gram.total, &nuisance, &columns));
        rest -= cross.tr_mul(&cross);
    }
    let count = columns.len() - 1;
    let square = |i: usize| rest[(i, i)].max(0.0);
    let whole = |i: usize| gram.lengths[first + i];
    let seen = |i: usize| square(i) > NOTHING_LEFT * whole(i) && whole(i) > 0.0;
    let length: Vec<f64> = (0..count).map(|i| if seen(i) { square(i).sqrt() } else { 0.0 }).collect();
    let over = |i: usize| if length[i] > 0.0 { length[i].recip() } else { 0.0 };
    Scores {
        score: (0..count).map(|i| rest[(i, count)] * over(i)).collect(),
        masking: (0..count).map(|i| if whole(i) > 0.0 { 1.0 - square(i) / whole(i) } else { 1.0 }).collect(),
        cosine: DMatrix::from_fn(count, count, |i, j| if i == j { 1.0 } else { rest[(i, j)] * over(i) * over(j) }),
        estimate: (0..count).map(|i| rest[(i, count)] * over(i) * over(i)).collect(),
        length,
    }
}

/// Draws of the null distribution.
const DRAWS: usize = 600;

/// The score that the greatest of all scores exceeds with probability 1 % where nothing is hidden,
/// in any of `processes` that are asked together (each at its share of the level, Bonferroni).
/// `one_sided` scores count only upwards.
pub fn max_null(cosine: &DMatrix<f64>, one_sided: bool, processes: usize, seed: u64) -> f64 {
    let count = cosine.nrows();
    if count == 0 {
        return f64::INFINITY;
    }
    let mut matrix = cosine.clone();
    for i in 0..count {
        matrix[(i, i)] += 1e-6;
    }
    let root = factor(matrix);
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let count_of_draws = DRAWS * processes;
    let draws: Vec<f64> = (0..count * count_of_draws).map(|_| StandardNormal.sample(&mut random)).collect();
    let of_draw = |draws: &[f64]| {
        let size = |score: f64| if one_sided { score } else { score.abs() };
        root.times(draws).into_iter().map(size).fold(f64::NEG_INFINITY, f64::max)
    };
    let mut greatest: Vec<f64> = draws.chunks_exact(count).map(of_draw).collect();
    greatest.sort_by(f64::total_cmp);
    greatest[count_of_draws - (NULL_LEVEL * DRAWS as f64) as usize]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Normal equations of orthonormal readings: a calibration that shifts the first, an effect that
    /// shows in both to these shares, a residual.
    fn gram(effect: [f64; 2]) -> Gram {
        let columns = [[1e3, 0.0], effect, [0.0, 1.0]];
        let dot = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
        let total = DMatrix::from_fn(3, 3, |i, j| dot(columns[i], columns[j]));
        let lengths = total.diagonal();
        Gram { folds: Vec::new(), total, log_determinant: 0.0, lengths }
    }

    #[test]
    fn masking_is_the_share_of_the_squared_length_that_calibration_takes() {
        for (effect, masking, length) in [([0.0, 5.0], 0.0, 5.0), ([3.0, 4.0], 0.36, 4.0), ([7.0, 0.0], 1.0, 0.0)] {
            let scores = scores(&gram(effect), 1, &[]);
            assert!((scores.masking[0] - masking).abs() < 1e-4, "{effect:?}: {}", scores.masking[0]);
            assert!((scores.length[0] - length).abs() < 0.01, "{effect:?}: {}", scores.length[0]);
        }
    }
}
