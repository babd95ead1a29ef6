//! Normal equations by group, the groups' own factors eliminated.
//!
//! With whitened columns X and the local columns Z of a group,
//! `S = X'X − X'Z (Z'Z + 1)⁻¹ Z'X` is `X' V⁻¹ X` for the group's covariance `V = 1 + Z Z'`.
//! Everything else (fits, scores, evidence of groups left out) needs nothing but these matrices.

use super::{Linear, Measured, Noise};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use rayon::prelude::*;
use std::ops::Range;

/// Normal equations of the fitted groups over chosen columns; the last column is the residual.
#[derive(Clone, Debug)]
pub struct Gram {
    /// `X' V⁻¹ X` of the groups of each fold.
    pub folds: Vec<DMatrix<f64>>,
    /// `ln det V` of the groups of each fold, beside the noise.
    pub log_determinants: Vec<f64>,
    /// Sum over the groups that were fitted.
    pub total: DMatrix<f64>,
    /// `ln det V` of the groups that were fitted, beside the noise.
    pub log_determinant: f64,
    /// Squared length of each column before the local factors were eliminated, fitted groups.
    pub lengths: DVector<f64>,
}

/// Groups that are multiplied at a time where no folds are asked for: many rows at once are faster,
/// few columns of groups need less memory.
const BATCH: usize = 16;

/// What groups that are kept together give before their local factors are eliminated.
struct Batch {
    /// `X'X`.
    squares: DMatrix<f64>,
    /// `Z'X` and `Z'Z` of each group, at the scale 1 of its local factors.
    groups: Vec<(DMatrix<f64>, DMatrix<f64>)>,
}

impl Batch {
    /// `X' V⁻¹ X` and `ln det V` where each kind of local factor has its scale.
    fn eliminated(&self, local_scale: &[f64]) -> (DMatrix<f64>, f64) {
        let mut gram = self.squares.clone();
        let mut log_determinant_of_all = 0.0;
        if local_scale.is_empty() {
            return (gram, 0.0);
        }
        // D C' (D Z'Z D + 1)⁻¹ C D of each group is a product of two factors; those of all groups together
        // are one product.
        let kinds = local_scale.len();
        let mut stacked = DMatrix::zeros(kinds * self.groups.len(), gram.ncols());
        for (index, (cross, inner)) in self.groups.iter().enumerate() {
            let inner = DMatrix::from_fn(kinds, kinds, |i, j| {
                inner[(i, j)] * local_scale[i] * local_scale[j] + if i == j { 1.0 } else { 0.0 }
            });
            let inner = factor(inner);
            log_determinant_of_all += log_determinant(&inner);
            let scaled = DMatrix::from_fn(kinds, cross.ncols(), |i, j| cross[(i, j)] * local_scale[i]);
            if let Some(root) = inner.l().solve_lower_triangular(&scaled) {
                stacked.rows_mut(kinds * index, kinds).copy_from(&root);
            }
        }
        gram -= stacked.transpose() * &stacked;
        (gram, log_determinant_of_all)
    }
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

/// Diagonal of the inverse of a factored matrix: `Σ (L⁻¹)²` by columns, each from its first row on.
pub(crate) fn inverse_diagonal(factor: &Factor) -> DVector<f64> {
    let lower = factor.l_dirty();
    let size = lower.nrows();
    let square = |first: usize| {
        let mut x = vec![0.0; size - first];
        x[0] = 1.0;
        for i in first..size {
            let column = &lower.as_slice()[i * size..(i + 1) * size];
            let (solved, below) = x[i - first..].split_at_mut(1);
            solved[0] /= column[i];
            below.iter_mut().zip(&column[i + 1..]).for_each(|(x, l)| *x -= solved[0] * l);
        }
        x.iter().map(|x| x * x).sum::<f64>()
    };
    DVector::from_vec((0..size).into_par_iter().map(square).collect())
}

/// `ln det` of a factored matrix.
pub(crate) fn log_determinant(factor: &Factor) -> f64 {
    2.0 * factor.l_dirty().diagonal().iter().map(|value| value.ln()).sum::<f64>()
}

impl Gram {
    /// Normal equations of `columns` and the residual, also by `folds`, which are lists of groups;
    /// `local_scale` multiplies the prior standard deviation of each kind of local factor.
    pub fn new(
        measured: &Measured,
        noise: &Noise,
        linear: &Linear,
        columns: &[&[f64]],
        residual: &[f64],
        local_scale: &[f64],
        folds: &[Vec<usize>],
    ) -> Self {
        let batches = batches(measured, noise, linear, columns, residual, folds);
        Self::of(&batches, local_scale, !folds.is_empty())
    }

    /// The same for several scales of the local factors, without folds.
    pub(super) fn at_scales(
        measured: &Measured,
        noise: &Noise,
        linear: &Linear,
        columns: &[&[f64]],
        residual: &[f64],
        local_scales: &[Vec<f64>],
    ) -> Vec<Self> {
        let batches = batches(measured, noise, linear, columns, residual, &[]);
        local_scales.iter().map(|local_scale| Self::of(&batches, local_scale, false)).collect()
    }

    fn of(batches: &[Batch], local_scale: &[f64], keep: bool) -> Self {
        let size = batches.first().map_or(0, |batch| batch.squares.ncols());
        let mut gram = Self {
            folds: Vec::new(),
            log_determinants: Vec::new(),
            total: DMatrix::zeros(size, size),
            log_determinant: 0.0,
            lengths: DVector::zeros(size),
        };
        let parts: Vec<_> = batches.par_iter().map(|batch| batch.eliminated(local_scale)).collect();
        for (batch, (matrix, determinant)) in batches.iter().zip(parts) {
            gram.total += &matrix;
            gram.log_determinant += determinant;
            gram.lengths += batch.squares.diagonal();
            if keep {
                gram.folds.push(matrix);
                gram.log_determinants.push(determinant);
            }
        }
        gram
    }

    /// Index of the residual's column.
    pub fn last(&self) -> usize {
        self.total.nrows() - 1
    }
}

/// Products of whitened columns, by fold or by batches of the fitted groups; at least one.
fn batches(
    measured: &Measured,
    noise: &Noise,
    linear: &Linear,
    columns: &[&[f64]],
    residual: &[f64],
    folds: &[Vec<usize>],
) -> Vec<Batch> {
    let all: Vec<&[f64]> = columns.iter().copied().chain([residual]).collect();
    let white: Vec<Vec<f64>> = all.par_iter().map(|column| noise.whiten(measured, column)).collect();
    let locals: Vec<Vec<f64>> = linear.locals.iter().map(|column| noise.whiten(measured, column)).collect();
    let fitted: Vec<usize> = measured.fitted_groups().collect();
    let of = |groups: &[usize]| {
        let spans: Vec<_> = groups.iter().map(|group| measured.spans[*group].clone()).collect();
        let rows = spans.iter().map(|span| span.len()).sum();
        let gathered = |columns: &[Vec<f64>]| {
            let mut matrix = DMatrix::zeros(rows, columns.len());
            for (to, column) in matrix.as_mut_slice().chunks_exact_mut(rows.max(1)).zip(columns) {
                let mut at = 0;
                for span in &spans {
                    to[at..at + span.len()].copy_from_slice(&column[span.clone()]);
                    at += span.len();
                }
            }
            matrix
        };
        let (x, z) = (gathered(&white), gathered(&locals));
        let mut first = 0;
        let groups = spans.iter().map(|span| {
            let inside = first..first + span.len();
            first = inside.end;
            (crossed(&z, &x, &inside), crossed(&z, &z, &inside))
        });
        let groups = groups.collect();
        Batch { squares: squared(&x), groups }
    };
    match folds {
        [] if fitted.is_empty() => vec![of(&[])],
        [] => fitted.par_chunks(BATCH).map(of).collect(),
        folds => folds.par_iter().map(|groups| of(groups)).collect(),
    }
}

/// Columns of a block of a product with itself: fewer waste the kernel, more leave less to be saved and shared.
const BLOCK: usize = 72;

/// `X'X`: one side of the diagonal is worked out, blocks of columns side by side. Multiplied as a product of two
/// matrices each runs through the blocked kernel.
fn squared(x: &DMatrix<f64>) -> DMatrix<f64> {
    let count = x.ncols();
    let blocks = count.div_ceil(BLOCK).max(1);
    let range = |block: usize| block * count / blocks..(block + 1) * count / blocks;
    let across: Vec<DMatrix<f64>> =
        (0..blocks).into_par_iter().map(|block| x.columns_range(range(block)).transpose()).collect();
    let pairs: Vec<(usize, usize)> = (0..blocks).flat_map(|a| (a..blocks).map(move |b| (a, b))).collect();
    let product = |(a, b): &(usize, usize)| &across[*a] * x.columns_range(range(*b));
    let products: Vec<DMatrix<f64>> = pairs.par_iter().map(product).collect();
    let mut square = DMatrix::zeros(count, count);
    for ((a, b), product) in pairs.into_iter().zip(products) {
        let (a, b) = (range(a), range(b));
        square.view_range_mut(a.clone(), b.clone()).copy_from(&product);
        square.view_range_mut(b, a).tr_copy_from(&product);
    }
    square
}

/// Columns of X that are gone through together: their sums do not wait for one another.
const LANES: usize = 4;

/// `Z'X` over the rows `inside`; Z has too few columns for a kernel of matrix products.
fn crossed(z: &DMatrix<f64>, x: &DMatrix<f64>, inside: &Range<usize>) -> DMatrix<f64> {
    fn column<'a>(matrix: &'a DMatrix<f64>, j: usize, inside: &Range<usize>) -> &'a [f64] {
        let first = j * matrix.nrows();
        &matrix.as_slice()[first + inside.start..first + inside.end]
    }
    let mut product = DMatrix::zeros(z.ncols(), x.ncols());
    for i in 0..z.ncols() {
        let z = column(z, i, inside);
        for first in (0..x.ncols()).step_by(LANES) {
            // The last columns are done again rather than by themselves.
            let lanes: [usize; LANES] = std::array::from_fn(|lane| (first + lane).min(x.ncols() - 1));
            let [a, b, c, d] = lanes.map(|j| column(x, j, inside));
            let mut sums = [0.0; LANES];
            for ((((z, a), b), c), d) in z.iter().zip(a).zip(b).zip(c).zip(d) {
                for (sum, x) in sums.iter_mut().zip([a, b, c, d]) {
                    *sum += z * x;
                }
            }
            lanes.iter().zip(sums).for_each(|(j, sum)| product[(i, *j)] = sum);
        }
    }
    product
}

/// Rows and columns of `matrix` named by `at`.
pub(crate) fn part(matrix: &DMatrix<f64>, at: &[usize], columns: &[usize]) -> DMatrix<f64> {
    DMatrix::from_fn(at.len(), columns.len(), |i, j| matrix[(at[i], columns[j])])
}

/// Column `column` of `matrix` in the rows `at`.
pub(crate) fn part_column(matrix: &DMatrix<f64>, at: &[usize], column: usize) -> DVector<f64> {
    DVector::from_fn(at.len(), |i, _| matrix[(at[i], column)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_diagonal_of_the_inverse_is_that_of_the_inverse() {
        let x = DMatrix::from_fn(9, 7, |i, j| ((3 * i + 5 * j) % 11) as f64 + if i == j { 9.0 } else { 0.0 });
        let factor = factor(x.tr_mul(&x));
        let (fast, plain) = (inverse_diagonal(&factor), factor.inverse().diagonal());
        assert!((&fast - &plain).amax() < 1e-12 * plain.amax(), "{fast} {plain}");
    }

    #[test]
    fn blocks_of_a_square_are_the_whole_product() {
        // Of small whole numbers, so that no order of summation shows.
        for columns in [0, 1, BLOCK, 2 * BLOCK + 7] {
            let x = DMatrix::from_fn(41, columns, |i, j| ((7 * i + 11 * j) % 13) as f64 - 6.0);
            assert_eq!(squared(&x), x.transpose() * &x);
        }
    }

    #[test]
    fn crossed_columns_are_the_product_of_some_rows() {
        let value = |i: usize, j: usize| ((5 * i + 3 * j) % 7) as f64 - 2.5;
        for columns in [1, 2, 4, 6] {
            let (z, x) = (DMatrix::from_fn(9, 2, value), DMatrix::from_fn(9, columns, |i, j| value(i + 1, 2 * j)));
            let product = crossed(&z, &x, &(2..7));
            assert_eq!(product, z.rows(2, 5).transpose() * x.rows(2, 5));
        }
    }

    #[test]
    fn eliminated_local_factors_are_those_of_the_marginal_covariance() {
        let x = DMatrix::from_fn(6, 3, |i, j| ((i * i + 2 * j) % 5) as f64 - 1.5);
        let z = DMatrix::from_fn(6, 2, |i, j| 0.3 * (i as f64) - j as f64);
        let scale = [0.7, 1.9];
        let batch = Batch { squares: x.tr_mul(&x), groups: vec![(z.tr_mul(&x), z.tr_mul(&z))] };
        let (gram, log_determinant) = batch.eliminated(&scale);
        let scaled = &z * DMatrix::from_diagonal(&DVector::from_column_slice(&scale));
        let covariance = DMatrix::identity(6, 6) + &scaled * scaled.transpose();
        let plain = x.tr_mul(&covariance.clone().try_inverse().unwrap()) * &x;
        assert!((&gram - &plain).amax() < 1e-12 * plain.amax(), "{gram} {plain}");
        assert!((log_determinant - covariance.determinant().ln()).abs() < 1e-12);
    }
}
