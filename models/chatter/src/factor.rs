//! Dense LU factors, column-major, in storage that is kept between uses.

use crate::krylov::subtract;

/// `P A = L U` of a small dense matrix.
#[derive(Clone, Debug, Default)]
pub(crate) struct Factors {
    size: usize,
    /// Columns one after another; the strict lower part holds L.
    columns: Vec<f64>,
    pivots: Vec<usize>,
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
            let (head, tail) = self.columns.split_at_mut((k + 1) * n);
            let column = &mut head[k * n..];
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
            for other in tail.chunks_exact_mut(n) {
                other.swap(k, pivot);
                let factor = other[k];
                subtract(&mut other[k + 1..], factor, &column[k + 1..]);
            }
            for other in head[..k * n].chunks_exact_mut(n) {
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
        for k in 0..n {
            let (head, tail) = b.split_at_mut(k + 1);
            subtract(tail, head[k], &self.columns[k * n + k + 1..(k + 1) * n]);
        }
        for k in (0..n).rev() {
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
}
