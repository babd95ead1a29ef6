//! Dense LU factors, column-major, in storage that is kept between uses.
//!
//! Columns are subtracted four at a time. Every entry still sees the same operations in the same order as by one column
//! after another, so that results are the same to the last bit, for a third of the traffic with memory.

use crate::krylov::subtract;

/// `P A = L U` of a small dense matrix.
#[derive(Clone, Debug, Default)]
pub struct Factors {
    size: usize,
    /// Columns one after another; the strict lower part holds L.
    columns: Vec<f64>,
    pivots: Vec<usize>,
}

/// Columns that are subtracted at once.
const TOGETHER: usize = 4;

/// `y −= Σ factors[k] columns[k]`, one column after the other in every entry; `columns` is column-major with as many rows
/// as `y` has entries.
#[inline]
pub fn subtract_columns(y: &mut [f64], factors: &[f64], columns: &[f64]) {
    let rows = y.len();
    let (blocks, rest) = factors.as_chunks::<TOGETHER>();
    let mut columns = columns.chunks_exact(rows);
    for block in blocks {
        let x = [(); TOGETHER].map(|()| columns.next().unwrap_or_default());
        subtract_together(y, *block, x);
    }
    for (factor, column) in rest.iter().zip(columns) {
        subtract(y, *factor, column);
    }
}

/// `y −= f[0] x[0]`, then `y −= f[1] x[1]` and so on, in one pass.
#[inline]
fn subtract_together(y: &mut [f64], f: [f64; TOGETHER], x: [&[f64]; TOGETHER]) {
    // One length for all, so that the loop needs no checks.
    let n = y.len();
    let [x0, x1, x2, x3] = x.map(|x| &x[..n]);
    for i in 0..n {
        y[i] = y[i] - f[0] * x0[i] - f[1] * x1[i] - f[2] * x2[i] - f[3] * x3[i];
    }
}

/// Solves `L y = b` in place for the rows that the first `known` columns of L determine, and takes their share off the
/// rows below.
#[inline]
fn forward(columns: &[f64], n: usize, known: usize, b: &mut [f64]) {
    let blocks = known / TOGETHER * TOGETHER;
    for first in (0..blocks).step_by(TOGETHER) {
        let [x0, x1, x2, x3] = [0, 1, 2, 3].map(|i| &columns[(first + i) * n + first..(first + i + 1) * n]);
        let (top, below) = b[first..].split_at_mut(TOGETHER);
        let f0 = top[0];
        let f1 = top[1] - f0 * x0[1];
        let f2 = top[2] - f0 * x0[2] - f1 * x1[2];
        let f3 = top[3] - f0 * x0[3] - f1 * x1[3] - f2 * x2[3];
        top.copy_from_slice(&[f0, f1, f2, f3]);
        subtract_together(below, [f0, f1, f2, f3], [x0, x1, x2, x3].map(|x| &x[TOGETHER..]));
    }
    for k in blocks..known {
        let (head, tail) = b.split_at_mut(k + 1);
        subtract(tail, head[k], &columns[k * n + k + 1..(k + 1) * n]);
    }
}

impl Factors {
    /// Starts a `size` × `size` matrix; its columns are to be written before [`Factors::factorise`].
    pub fn begin(&mut self, size: usize) -> &mut [f64] {
        self.size = size;
        self.columns.resize(size * size, 0.0);
        &mut self.columns
    }

    /// Factorises in place with partial pivoting. A zero pivot is kept and makes solutions
    /// infinite, which callers see in their result.
    pub fn factorise(&mut self) {
        let n = self.size;
        self.pivots.clear();
        for k in 0..n {
            let (head, tail) = self.columns.split_at_mut(k * n);
            let column = &mut tail[..n];
            for (row, pivot) in self.pivots.iter().enumerate() {
                column.swap(row, *pivot);
            }
            forward(head, n, k, column);
            let mut pivot = k;
            for i in k + 1..n {
                if column[i].abs() > column[pivot].abs() {
                    pivot = i;
                }
            }
            self.pivots.push(pivot);
            column.swap(k, pivot);
            let inverse = 1.0 / column[k];
            for entry in &mut column[k + 1..] {
                *entry *= inverse;
            }
            for other in head.chunks_exact_mut(n) {
                other.swap(k, pivot);
            }
        }
    }

    /// Overwrites `b` with the solution of `A x = b`.
    pub fn solve(&self, b: &mut [f64]) {
        let n = self.size;
        for (k, pivot) in self.pivots.iter().enumerate() {
            b.swap(k, *pivot);
        }
        forward(&self.columns, n, n, b);
        let mut after = n;
        while after >= TOGETHER {
            let first = after - TOGETHER;
            for k in (first..after).rev() {
                b[k] /= self.columns[k * n + k];
                let (head, tail) = b.split_at_mut(k);
                subtract(&mut head[first..], tail[0], &self.columns[k * n + first..k * n + k]);
            }
            let (above, solved) = b.split_at_mut(first);
            let f = [3, 2, 1, 0].map(|i| solved[i]);
            let columns = [3, 2, 1, 0].map(|i| &self.columns[(first + i) * n..][..first]);
            subtract_together(above, f, columns);
            after = first;
        }
        for k in (0..after).rev() {
            b[k] /= self.columns[k * n + k];
            let (head, tail) = b.split_at_mut(k);
            subtract(head, tail[0], &self.columns[k * n..k * n + k]);
        }
    }

    /// Overwrites `b` with the solution of `Aᵀ x = b`.
    pub fn solve_transposed(&self, b: &mut [f64]) {
        let n = self.size;
        for k in 0..n {
            let column = &self.columns[k * n..(k + 1) * n];
            let sum = crate::krylov::dot(&column[..k], &b[..k]);
            b[k] = (b[k] - sum) / column[k];
        }
        for k in (0..n).rev() {
            let column = &self.columns[k * n..(k + 1) * n];
            b[k] -= crate::krylov::dot(&column[k + 1..], &b[k + 1..]);
        }
        for (k, pivot) in self.pivots.iter().enumerate().rev() {
            b.swap(k, *pivot);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn solves_what_it_factorised(entries in prop::collection::vec(-1.0f64..1.0, 49), n in 1usize..=7) {
            let matrix = nalgebra::DMatrix::from_column_slice(n, n, &entries[..n * n]);
            prop_assume!(matrix.determinant().abs() > 1e-4);
            let truth = nalgebra::DVector::from_fn(n, |i, _| i as f64 - 1.5);
            let mut factors = Factors::default();
            factors.begin(n).copy_from_slice(&entries[..n * n]);
            factors.factorise();
            let mut x = (&matrix * &truth).as_slice().to_vec();
            factors.solve(&mut x);
            let mut y = (matrix.transpose() * &truth).as_slice().to_vec();
            factors.solve_transposed(&mut y);
            for i in 0..n {
                prop_assert!((x[i] - truth[i]).abs() < 1e-8 && (y[i] - truth[i]).abs() < 1e-8);
            }
        }
    }

    /// Right-looking elimination and substitution, one column after the other.
    fn one_by_one(n: usize, matrix: &[f64], b: &[f64]) -> Vec<f64> {
        let (mut a, mut b) = (matrix.to_vec(), b.to_vec());
        for k in 0..n {
            let pivot = (k..n).fold(k, |best, i| if a[k * n + i].abs() > a[k * n + best].abs() { i } else { best });
            (0..n).for_each(|j| a.swap(j * n + k, j * n + pivot));
            b.swap(k, pivot);
            let inverse = 1.0 / a[k * n + k];
            (k + 1..n).for_each(|i| a[k * n + i] *= inverse);
            for j in k + 1..n {
                for i in k + 1..n {
                    a[j * n + i] -= a[j * n + k] * a[k * n + i];
                }
            }
        }
        for k in 0..n {
            (k + 1..n).for_each(|i| b[i] -= b[k] * a[k * n + i]);
        }
        for k in (0..n).rev() {
            b[k] /= a[k * n + k];
            (0..k).for_each(|i| b[i] -= b[k] * a[k * n + i]);
        }
        b
    }

    proptest! {
        #[test]
        fn four_columns_at_once_give_the_bits_of_one_by_one(
            entries in prop::collection::vec(-1.0f64..1.0, 21 * 21 + 21),
            n in 1usize..=21,
        ) {
            let (matrix, rest) = entries.split_at(n * n);
            let mut factors = Factors::default();
            factors.begin(n).copy_from_slice(matrix);
            factors.factorise();
            let mut x = rest[..n].to_vec();
            factors.solve(&mut x);
            let expected = one_by_one(n, matrix, &rest[..n]);
            prop_assert!(x.iter().zip(&expected).all(|(a, b)| a.to_bits() == b.to_bits()), "{x:?} {expected:?}");
            let mut y = rest[..n].to_vec();
            subtract_columns(&mut y, &x, matrix);
            let mut z = rest[..n].to_vec();
            for (factor, column) in x.iter().zip(matrix.chunks_exact(n)) {
                subtract(&mut z, *factor, column);
            }
            prop_assert!(y.iter().zip(&z).all(|(a, b)| a.to_bits() == b.to_bits()));
        }
    }
}
