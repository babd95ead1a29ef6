//! Normal equations by group, the groups' own factors eliminated.
//!
//! With whitened columns X and the local columns Z of a group,
//! `S = X'X − X'Z (Z'Z + 1)⁻¹ Z'X` is `X' V⁻¹ X` for the group's covariance `V = 1 + Z Z'`.
//! Everything else (fits, scores, evidence of groups left out) needs nothing but these matrices.

use super::{Linear, Measured, Noise};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use rayon::prelude::*;

/// Normal equations of the groups over chosen columns; the last column is the residual.
#[derive(Clone, Debug)]
pub struct Gram {
    /// Index of each group in what was measured.
    pub groups: Vec<usize>,
    /// `X' V⁻¹ X` of each group.
    pub matrices: Vec<DMatrix<f64>>,
    /// `ln det V` of each group, beside the noise.
    pub log_determinants: Vec<f64>,
    /// Sum over the groups that were fitted.
    pub total: DMatrix<f64>,
    /// Squared length of each column before the local factors were eliminated, fitted groups.
    pub lengths: DVector<f64>,
}

/// A positive definite factor.
pub(crate) type Factor = Cholesky<f64, Dyn>;

/// Cholesky factor; a diagonal that rounding has spoilt is lifted.
pub(crate) fn factor(mut matrix: DMatrix<f64>) -> Factor {
    let size = matrix.nrows();
    let scale = matrix.diagonal().amax().max(1.0);
    let mut lift = 1e-12 * scale;
    while lift < scale {
        if let Some(factor) = Cholesky::new(matrix.clone()) {
            return factor;
        }
        for i in 0..size {
            matrix[(i, i)] += lift;
        }
        lift *= 10.0;
    }
    // Numbers that are none: whatever is solved with this is zero.
    Cholesky::new(DMatrix::identity(size, size) * 1e300).unwrap_or_else(|| Cholesky::pack_dirty(matrix))
}

/// `ln det` of a factored matrix.
pub(crate) fn log_determinant(factor: &Factor) -> f64 {
    2.0 * factor.l_dirty().diagonal().iter().map(|value| value.ln()).sum::<f64>()
}

impl Gram {
    /// Normal equations of `columns` and the residual; `local_scale` multiplies the prior standard
    /// deviation of each kind of local factor.
    pub fn new(
        measured: &Measured,
        noise: &Noise,
        linear: &Linear,
        columns: &[&[f64]],
        residual: &[f64],
        local_scale: &[f64],
    ) -> Self {
        let white: Vec<Vec<f64>> = columns.par_iter().map(|column| noise.whiten(measured, column)).collect();
        let residual = noise.whiten(measured, residual);
        let locals: Vec<Vec<f64>> = linear.locals.iter().map(|column| noise.whiten(measured, column)).collect();
        let groups: Vec<usize> =
            (0..measured.groups.len()).filter(|group| !measured.spans[*group].is_empty()).collect();
        let of_group = |group: &usize| {
            let span = measured.spans[*group].clone();
            let rows = span.len();
            let x = DMatrix::from_fn(rows, white.len() + 1, |i, j| match white.get(j) {
                Some(column) => column[span.start + i],
                None => residual[span.start + i],
            });
            let z = DMatrix::from_fn(rows, locals.len(), |i, j| locals[j][span.start + i] * local_scale[j]);
            // Multiplied as a product of two matrices it runs through the blocked kernel.
            let mut gram = x.transpose() * &x;
            let lengths = gram.diagonal();
            let mut inner = z.tr_mul(&z);
            for i in 0..inner.nrows() {
                inner[(i, i)] += 1.0;
            }
            let mut log_determinant_of_group = 0.0;
            if !locals.is_empty() {
                let inner = factor(inner);
                log_determinant_of_group = log_determinant(&inner);
                let cross = z.tr_mul(&x);
                gram -= cross.tr_mul(&inner.solve(&cross));
            }
            (gram, lengths, log_determinant_of_group)
        };
        let parts: Vec<_> = groups.par_iter().map(of_group).collect();
        let size = white.len() + 1;
        let mut gram = Self {
            groups,
            matrices: Vec::new(),
            log_determinants: Vec::new(),
            total: DMatrix::zeros(size, size),
            lengths: DVector::zeros(size),
        };
        for (index, (matrix, lengths, determinant)) in parts.into_iter().enumerate() {
            if measured.fitted[gram.groups[index]] {
                gram.total += &matrix;
                gram.lengths += lengths;
            }
            gram.matrices.push(matrix);
            gram.log_determinants.push(determinant);
        }
        gram
    }

    /// Index of the residual's column.
    pub fn last(&self) -> usize {
        self.total.nrows() - 1
    }
}

/// Rows and columns of `matrix` named by `at`.
pub(crate) fn part(matrix: &DMatrix<f64>, at: &[usize], columns: &[usize]) -> DMatrix<f64> {
    DMatrix::from_fn(at.len(), columns.len(), |i, j| matrix[(at[i], columns[j])])
}

/// Column `column` of `matrix` in the rows `at`.
pub(crate) fn part_column(matrix: &DMatrix<f64>, at: &[usize], column: usize) -> DVector<f64> {
    DVector::from_fn(at.len(), |i, _| matrix[(at[i], column)])
}
