//! Normal equations by group, the groups' own factors eliminated.
//!
//! With whitened columns X and the local columns Z of a group,
//! `S = X'X − X'Z (Z'Z + 1)⁻¹ Z'X` is `X' V⁻¹ X` for the group's covariance `V = 1 + Z Z'`.
//! Everything else (fits, scores, evidence of groups left out) needs nothing but these matrices.

use crate::factor;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Normal equations of the fitted groups over chosen columns; the last column is the residual.
#[derive(Clone, Debug)]
pub struct Gram {
    /// Parts of it by folds of groups, where asked.
    pub folds: Vec<Fold>,
    /// `X' V⁻¹ X`: sum over the groups that were fitted.
    pub total: DMatrix<f64>,
    /// `ln det V` of the groups that were fitted, beside the noise.
    pub log_determinant: f64,
    /// Squared length of each column before the local factors were eliminated, fitted groups.
    pub lengths: DVector<f64>,
}

/// The part of the groups of a fold.
#[derive(Clone, Debug)]
pub struct Fold {
    /// Columns that these groups know, ascending: the others are zero in them.
    pub at: Vec<usize>,
    /// `X' V⁻¹ X` over those.
    pub matrix: DMatrix<f64>,
    /// `ln det V`, beside the noise.
    pub log_determinant: f64,
}

/// What groups that are kept together give before their local factors are eliminated.
pub struct Batch {
    /// Columns that these groups know, ascending: the others are zero in them.
    pub at: Vec<usize>,
    /// `X'X` over those.
    pub squares: DMatrix<f64>,
    /// `Z'X` over those and `Z'Z` of each group, at the scale 1 of its local factors.
    pub groups: Vec<(DMatrix<f64>, DMatrix<f64>)>,
}

impl Batch {
    /// `X' V⁻¹ X` and `ln det V` where each kind of local factor has its scale.
    fn eliminated(&self, local_scale: &[f64]) -> Fold {
        let (at, mut matrix, mut log_determinant) = (self.at.clone(), self.squares.clone(), 0.0);
        if local_scale.is_empty() {
            return Fold { at, matrix, log_determinant };
        }
        // D C' (D Z'Z D + 1)⁻¹ C D of each group is a product of two factors; those of all groups together
        // are one product.
        let kinds = local_scale.len();
        let mut stacked = DMatrix::zeros(kinds * self.groups.len(), matrix.ncols());
        for (index, (cross, inner)) in self.groups.iter().enumerate() {
            let inner = DMatrix::from_fn(kinds, kinds, |i, j| {
                inner[(i, j)] * local_scale[i] * local_scale[j] + if i == j { 1.0 } else { 0.0 }
            });
            let inner = factor(inner);
            log_determinant += inner.log_determinant();
            let scaled = DMatrix::from_fn(kinds, cross.ncols(), |i, j| cross[(i, j)] * local_scale[i]);
            stacked.rows_mut(kinds * index, kinds).copy_from(&inner.half_solved(&scaled));
        }
        matrix -= stacked.transpose() * &stacked;
        Fold { at, matrix, log_determinant }
    }
}

impl Gram {
    /// Sums over `batches` of `size` columns where each kind of local factor has its scale; the parts are kept as folds
    /// where asked.
    pub fn from_batches(size: usize, batches: &[Batch], local_scale: &[f64], keep: bool) -> Self {
        let (mut total, mut lengths) = (DMatrix::zeros(size, size), DVector::zeros(size));
        let mut log_determinant = 0.0;
        let folds: Vec<Fold> = batches.par_iter().map(|batch| batch.eliminated(local_scale)).collect();
        for (batch, fold) in batches.iter().zip(&folds) {
            log_determinant += fold.log_determinant;
            for (j, column) in fold.at.iter().enumerate() {
                fold.at.iter().enumerate().for_each(|(i, row)| total[(*row, *column)] += fold.matrix[(i, j)]);
                lengths[*column] += batch.squares[(j, j)];
            }
        }
        Self { folds: if keep { folds } else { Vec::new() }, total, log_determinant, lengths }
    }

    /// Index of the residual's column.
    pub fn last(&self) -> usize {
        self.total.nrows() - 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eliminated_local_factors_are_those_of_the_marginal_covariance() {
        let x = DMatrix::from_fn(6, 3, |i, j| ((i * i + 2 * j) % 5) as f64 - 1.5);
        let z = DMatrix::from_fn(6, 2, |i, j| 0.3 * (i as f64) - j as f64);
        let scale = [0.7, 1.9];
        let batch = Batch { at: vec![0, 1, 2], squares: x.tr_mul(&x), groups: vec![(z.tr_mul(&x), z.tr_mul(&z))] };
        let Fold { matrix: gram, log_determinant, .. } = batch.eliminated(&scale);
        let scaled = &z * DMatrix::from_diagonal(&DVector::from_column_slice(&scale));
        let covariance = DMatrix::identity(6, 6) + &scaled * scaled.transpose();
        let plain = x.tr_mul(&covariance.clone().try_inverse().unwrap()) * &x;
        assert!((&gram - &plain).amax() < 1e-12 * plain.amax(), "{gram} {plain}");
        assert!((log_determinant - covariance.determinant().ln()).abs() < 1e-12);
    }
}
