//! Cholesky factors whose rows begin where their matrix does.
//!
//! Most constants of a shop touch the rows of one program and have nothing to do with each other. Where such columns come
//! first and those that touch everything last, nearly all of a factor is zero: a row is kept from its first entry on, and
//! neither a product nor a solution goes through what is before it. Of a matrix without zeros this is the ordinary factor.
//!
//! # Source
//! Envelope method: George & Liu, Computer Solution of Large Sparse Positive Definite Systems, 1981, chapter 4.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// The lower factor of a positive definite matrix.
#[derive(Clone, Debug, Default)]
pub struct Factor {
    rows: Vec<Row>,
    entries: Vec<f64>,
}

/// A row of a factor: the column of its first entry, and where its entries lie, the diagonal last.
#[derive(Clone, Copy, Debug)]
struct Row {
    first: usize,
    start: usize,
}

/// Cholesky factor; a diagonal that rounding has spoilt is lifted.
pub fn factor(mut matrix: DMatrix<f64>) -> Factor {
    let size = matrix.nrows();
    let scale = matrix.diagonal().amax().max(1.0);
    let mut lift = 1e-12 * scale;
    while lift < scale {
        if let Some(factor) = Factor::of(&matrix) {
            return factor;
        }
        for i in 0..size {
            matrix[(i, i)] += lift;
        }
        lift *= 10.0;
    }
    // Numbers that are none: whatever is solved with this is zero.
    let mut nothing = Factor::default();
    for i in 0..size {
        nothing.rows.push(Row { first: i, start: i });
        nothing.entries.push(1e150);
    }
    nothing
}

impl Factor {
    /// The factor of a symmetric matrix, of which the upper half is read; `None` where that is not positive definite.
    fn of(matrix: &DMatrix<f64>) -> Option<Self> {
        let mut factor = Self::default();
        for i in 0..matrix.ncols() {
            factor.add_row(&matrix.as_slice()[i * matrix.nrows()..][..=i])?;
        }
        Some(factor)
    }

    /// The factor of the matrix with one more row, `row`, up to its diagonal; `None` where that is not positive definite.
    pub fn bordered(&self, row: &[f64]) -> Option<Self> {
        let mut longer = self.clone();
        longer.add_row(row)?;
        Some(longer)
    }

    fn add_row(&mut self, row: &[f64]) -> Option<()> {
        let i = self.rows.len();
        let first = row[..i].iter().position(|value| *value != 0.0).unwrap_or(i);
        let start = self.entries.len();
        self.entries.extend_from_slice(&row[first..]);
        let (before, own) = self.entries.split_at_mut(start);
        for j in first..i {
            let other = self.rows[j];
            let from = first.max(other.first);
            let known = &before[other.start + (from - other.first)..=other.start + (j - other.first)];
            let (diagonal, known) = (known[known.len() - 1], &known[..known.len() - 1]);
            own[j - first] = (own[j - first] - dot(&own[from - first..j - first], known)) / diagonal;
        }
        let last = i - first;
        let square = own[last] - dot(&own[..last], &own[..last]);
        if !(square > 0.0 && square.is_finite()) {
            return None;
        }
        own[last] = square.sqrt();
        self.rows.push(Row { first, start });
        Some(())
    }

    /// Number of rows.
    pub fn size(&self) -> usize {
        self.rows.len()
    }

    /// Entries of row `i` from its first to the diagonal, and the column of the first.
    fn row(&self, i: usize) -> (usize, &[f64]) {
        let Row { first, start } = self.rows[i];
        (first, &self.entries[start..=start + (i - first)])
    }

    /// `ln det` of the matrix.
    pub fn log_determinant(&self) -> f64 {
        2.0 * (0..self.size()).map(|i| self.row(i).1[i - self.rows[i].first].ln()).sum::<f64>()
    }

    /// `L⁻¹ x` in place; the entries of `x` before `from` are zero.
    fn forward(&self, x: &mut [f64], from: usize) {
        for i in from..self.size() {
            let (first, entries) = self.row(i);
            let begin = first.max(from);
            x[i] = (x[i] - dot(&entries[begin - first..i - first], &x[begin..i])) / entries[i - first];
        }
    }

    /// `L'⁻¹ x` in place.
    fn backward(&self, x: &mut [f64]) {
        for i in (0..self.size()).rev() {
            let (first, entries) = self.row(i);
            x[i] /= entries[i - first];
            let value = x[i];
            if value != 0.0 {
                x[first..i].iter_mut().zip(entries).for_each(|(x, l)| *x -= value * l);
            }
        }
    }

    /// Solution of the matrix for a right-hand side.
    pub fn solve(&self, right: &DVector<f64>) -> DVector<f64> {
        let mut x = right.clone();
        self.forward(x.as_mut_slice(), 0);
        self.backward(x.as_mut_slice());
        x
    }

    /// `L⁻¹` times some columns: their products with one another are those by the inverse of the matrix.
    pub fn half_solved(&self, columns: &DMatrix<f64>) -> DMatrix<f64> {
        let mut solved = columns.clone();
        let rows = columns.nrows().max(1);
        solved.as_mut_slice().par_chunks_exact_mut(rows).for_each(|column| {
            let from = column.iter().position(|value| *value != 0.0).unwrap_or(column.len());
            self.forward(column, from);
        });
        solved
    }

    /// `x' A⁻¹ x` for the matrix A.
    pub fn square_by_inverse(&self, x: &DVector<f64>) -> f64 {
        let mut half = x.clone();
        self.forward(half.as_mut_slice(), 0);
        half.norm_squared()
    }

    /// Diagonal of the inverse: `Σ (L⁻¹)²` by columns, each from its first row on.
    pub fn inverse_diagonal(&self) -> DVector<f64> {
        let size = self.size();
        let square = |first: usize| {
            let mut x = vec![0.0; size];
            x[first] = 1.0;
            self.forward(&mut x, first);
            dot(&x[first..], &x[first..])
        };
        DVector::from_vec((0..size).into_par_iter().map(square).collect())
    }

    /// `L x`.
    pub fn times(&self, x: &[f64]) -> Vec<f64> {
        let one = |i: usize| {
            let (first, entries) = self.row(i);
            dot(entries, &x[first..=i])
        };
        (0..self.size()).map(one).collect()
    }
}

/// Sums that do not wait for one another.
const LANES: usize = 8;

fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (whole_a, whole_b) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let rest: f64 = whole_a.remainder().iter().zip(whole_b.remainder()).map(|(a, b)| a * b).sum();
    let mut sums = [0.0; LANES];
    for (a, b) in whole_a.zip(whole_b) {
        for (sum, (a, b)) in sums.iter_mut().zip(a.iter().zip(b)) {
            *sum += a * b;
        }
    }
    sums.iter().sum::<f64>() + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Columns of which the first six touch two rows each, and the others all.
    fn matrix() -> DMatrix<f64> {
        let value = |i: usize, j: usize| ((3 * i + 5 * j + i * j) % 11) as f64 - 4.5;
        let column = |i: usize, j: usize| if j < 6 && i / 2 != j { 0.0 } else { value(i, j) };
        let x = DMatrix::from_fn(17, 9, column);
        x.tr_mul(&x) + DMatrix::identity(9, 9)
    }

    #[test]
    fn everything_that_a_factor_gives_is_what_the_inverse_gives() {
        let matrix = matrix();
        let (factor, inverse) = (factor(matrix.clone()), matrix.clone().try_inverse().unwrap());
        assert!(factor.entries.len() < 9 * 10 / 2, "{}", factor.entries.len());
        let right = DVector::from_fn(9, |i, _| (i % 4) as f64 - 1.0);
        assert!((factor.solve(&right) - &inverse * &right).amax() < 1e-12);
        assert!((factor.square_by_inverse(&right) - right.dot(&(&inverse * &right))).abs() < 1e-12);
        assert!((factor.inverse_diagonal() - inverse.diagonal()).amax() < 1e-12);
        assert!((factor.log_determinant() - matrix.determinant().ln()).abs() < 1e-12);
        let columns = DMatrix::from_fn(9, 3, |i, j| if i < 3 * j { 0.0 } else { (i + j) as f64 });
        let half = factor.half_solved(&columns);
        let plain = columns.tr_mul(&(&inverse * &columns));
        assert!((half.tr_mul(&half) - &plain).amax() < 1e-11 * plain.amax());
        let lower = matrix.clone().cholesky().unwrap().l();
        let times = DVector::from_vec(factor.times(right.as_slice()));
        assert!((times - lower * right).amax() < 1e-12);
    }

    #[test]
    fn a_row_more_is_a_border_of_the_matrix() {
        let whole = matrix();
        let known = factor(whole.view((0, 0), (8, 8)).into_owned());
        let row: Vec<f64> = whole.column(8).iter().copied().collect();
        let longer = known.bordered(&row).unwrap();
        assert_eq!(longer.entries, factor(whole).entries);
        // A row that says the same as another.
        let same: Vec<f64> = (0..8).map(|i| matrix()[(i, 3)]).chain([matrix()[(3, 3)]]).collect();
        assert!(known.bordered(&same).is_none_or(|factor| factor.entries.last().unwrap() < &1e-6));
    }

    #[test]
    fn numbers_that_are_none_give_zero() {
        let factor = factor(DMatrix::from_element(3, 3, f64::NAN));
        assert!(factor.solve(&DVector::from_element(3, 1.0)).amax() < 1e-200);
    }
}
