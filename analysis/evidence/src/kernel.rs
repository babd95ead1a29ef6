//! Low-rank columns of a Gaussian process with a Matérn-5/2 covariance.
//!
//! # Source
//! Random Fourier features: Rahimi & Recht 2007. The spectral density of a Matérn-5/2 covariance is a multivariate
//! Student distribution with five degrees of freedom (Rasmussen & Williams 2006, eq. 4.15). The columns are then
//! rotated to the principal ones of the given points, of which few carry nearly all of the variance.

use nalgebra::{DMatrix, SymmetricEigen};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{ChiSquared, Distribution, StandardNormal};

/// Frequencies that are drawn (count); each gives a sine and a cosine. Assumption: the mean error of the covariance,
/// 1/√48, is small beside what an amplitude is known to.
const FREQUENCIES: usize = 48;
/// Columns that are kept at most (count). Assumption: data do not tell finer structure from noise.
const MOST: usize = 24;
/// Least share of the variance that a kept column carries (1). Assumption: less is below every noise.
const LEAST: f64 = 1e-3;
/// Seed of the frequencies: the same points always give the same columns.
const SEED: u64 = 52;
/// Degrees of freedom of the spectral density: twice the smoothness 5/2.
const DEGREES: f64 = 5.0;

/// Columns Φ of one number a point, so that `ΦΦ'` is about the covariance of a process of unit variance at the
/// `points`, whose coordinates are standardised; `length` is the length scale in these units.
pub fn matern_columns(points: &[Vec<f64>], length: f64) -> Vec<Vec<f64>> {
    let (count, dimensions) = (points.len(), points.first().map_or(0, Vec::len));
    let Ok(chi_squared) = ChiSquared::new(DEGREES) else { return Vec::new() };
    if count == 0 || dimensions == 0 {
        return Vec::new();
    }
    let mut random = ChaCha8Rng::seed_from_u64(SEED);
    let scale = (FREQUENCIES as f64).sqrt().recip();
    let mut features = DMatrix::zeros(count, 2 * FREQUENCIES);
    for frequency in 0..FREQUENCIES {
        let spread: f64 = chi_squared.sample(&mut random);
        let stretch = (DEGREES / spread).sqrt() / length;
        let direction: Vec<f64> =
            (0..dimensions).map(|_| stretch * Distribution::<f64>::sample(&StandardNormal, &mut random)).collect();
        for (row, point) in points.iter().enumerate() {
            let phase: f64 = direction.iter().zip(point).map(|(omega, x)| omega * x).sum();
            let (sine, cosine) = phase.sin_cos();
            features[(row, 2 * frequency)] = scale * cosine;
            features[(row, 2 * frequency + 1)] = scale * sine;
        }
    }
    let principal = SymmetricEigen::new(features.tr_mul(&features));
    let total: f64 = principal.eigenvalues.iter().sum();
    let mut order: Vec<usize> = (0..2 * FREQUENCIES).collect();
    order.sort_by(|a, b| principal.eigenvalues[*b].total_cmp(&principal.eigenvalues[*a]));
    let kept = order.into_iter().take(MOST).take_while(|i| principal.eigenvalues[*i] > LEAST * total);
    kept.map(|i| (&features * principal.eigenvectors.column(i)).as_slice().to_vec()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Matérn-5/2 covariance at a distance.
    fn matern(distance: f64, length: f64) -> f64 {
        let r = 5.0_f64.sqrt() * distance / length;
        (1.0 + r + r * r / 3.0) * (-r).exp()
    }

    #[test]
    fn the_columns_have_the_covariance_of_the_process() {
        let points: Vec<Vec<f64>> = (0..60).map(|i| vec![f64::from(i % 10) / 3.0, f64::from(i / 10) / 2.0]).collect();
        for length in [1.5, 2.5] {
            let columns = matern_columns(&points, length);
            let mut squares = 0.0;
            for a in 0..points.len() {
                for b in 0..points.len() {
                    let covariance: f64 = columns.iter().map(|column| column[a] * column[b]).sum();
                    let distance = (points[a][0] - points[b][0]).hypot(points[a][1] - points[b][1]);
                    squares += (covariance - matern(distance, length)).powi(2);
                }
            }
            let error = squares.sqrt() / points.len() as f64;
            assert!(error < 0.15, "{length}: {error}");
        }
    }

    #[test]
    fn points_that_do_not_differ_have_one_column() {
        let columns = matern_columns(&vec![vec![0.3, -1.0]; 7], 1.5);
        assert_eq!(columns.len(), 1);
        assert!(columns[0].iter().all(|value| (value.abs() - 1.0).abs() < 1e-9), "{columns:?}");
        assert!(matern_columns(&[], 1.5).is_empty());
    }
}
