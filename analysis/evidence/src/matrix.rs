//! Products and parts of the matrices that normal equations are made of.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use std::ops::Range;

/// Columns of a block of a product with itself: fewer waste the kernel, more leave less to be saved and shared.
const BLOCK: usize = 72;

/// `X'X`: one side of the diagonal is worked out, blocks of columns side by side. Multiplied as a product of two
/// matrices each runs through the blocked kernel.
pub fn squared(x: &DMatrix<f64>) -> DMatrix<f64> {
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
pub fn crossed(z: &DMatrix<f64>, x: &DMatrix<f64>, inside: &Range<usize>) -> DMatrix<f64> {
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
pub fn part(matrix: &DMatrix<f64>, at: &[usize], columns: &[usize]) -> DMatrix<f64> {
    DMatrix::from_fn(at.len(), columns.len(), |i, j| matrix[(at[i], columns[j])])
}

/// Column `column` of `matrix` in the rows `at`.
pub fn part_column(matrix: &DMatrix<f64>, at: &[usize], column: usize) -> DVector<f64> {
    DVector::from_fn(at.len(), |i, _| matrix[(at[i], column)])
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
