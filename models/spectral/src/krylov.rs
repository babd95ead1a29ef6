//! Dominant eigenvalue of a linear map by Arnoldi's method, gated on its residual.

use crate::hessenberg;
use nalgebra::{Complex, DMatrix, Schur};

/// An iteration that did not converge.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("the search for the eigenvalue of greatest modulus did not converge: its residual is {residual:e}")]
pub struct NotConverged {
    /// The least residual that was reached; infinite where a vector outgrew all numbers.
    pub residual: f64,
}

/// A real linear map of a space onto itself.
pub trait LinearMap {
    /// Dimension of the space.
    fn size(&self) -> usize;
    /// `y = map x`.
    fn apply(&mut self, x: &[f64], y: &mut [f64]);

    /// The whole matrix.
    fn dense(&mut self) -> DMatrix<f64> {
        let size = self.size();
        let mut matrix = DMatrix::zeros(size, size);
        let mut unit = vec![0.0; size];
        for k in 0..size {
            unit[k] = 1.0;
            self.apply(&unit, matrix.column_mut(k).as_mut_slice());
            unit[k] = 0.0;
        }
        matrix
    }
}

/// Greatest dimension of the Krylov space.
const MAX_STEPS: usize = 240;

/// Eigenvalue of greatest modulus.
#[derive(Clone, Copy, Debug)]
pub struct Dominant {
    /// The eigenvalue.
    pub value: Complex<f64>,
    /// `|M v − value v| / (|value| |v|)`.
    pub residual: f64,
}

/// All eigenvalues, the greatest modulus first. The iteration would not end on a matrix with entries beyond all
/// numbers, which a period map has where a vibration outgrows them within the period.
///
/// # Errors
/// [`NotConverged`] for such a matrix, and where the iteration does not end.
pub fn dense_eigenvalues(matrix: DMatrix<f64>) -> Result<Vec<Complex<f64>>, NotConverged> {
    const SWEEPS: usize = 100_000;
    let failed = NotConverged { residual: f64::INFINITY };
    if !matrix.norm().is_finite() {
        return Err(failed);
    }
    let Some(schur) = Schur::try_new(matrix, f64::EPSILON, SWEEPS) else { return Err(failed) };
    let mut values: Vec<_> = schur.complex_eigenvalues().iter().copied().collect();
    if values.is_empty() || values.iter().any(|value| !value.norm_sqr().is_finite()) {
        return Err(failed);
    }
    values.sort_by(|a, b| b.norm().total_cmp(&a.norm()));
    Ok(values)
}

/// Eigenvalue of greatest modulus among all, where the iteration found none. The residual is the
/// backward error of the Schur form.
///
/// # Errors
/// As [`dense_eigenvalues`].
pub fn dense_dominant(matrix: DMatrix<f64>) -> Result<Dominant, NotConverged> {
    let error = f64::EPSILON * matrix.norm() * matrix.nrows() as f64;
    let value = dense_eigenvalues(matrix)?[0];
    let modulus = value.norm();
    Ok(Dominant { value, residual: if modulus > 0.0 { error / modulus } else { 0.0 } })
}

/// Share of the eigenvector next in modulus in the next start, beside that of the dominant one.
const RIVAL_SHARE: f64 = 0.3;
/// Residual to which a map is iterated that has no start vector from a neighbour. The fixed one can lack a dominant vector:
/// what it holds of a real one changes its sign over depth and speed. A vector of this share in it comes to light before the
/// residual of another is as small.
const UNSEEN: f64 = 1e-8;
/// Dimension at which eigenvalues are first searched without an outlook.
const FIRST_SEARCH: usize = 4;

/// How the residual falls with the steps: as `scale` times the product of the subdiagonal of the
/// projected map over the `modulus` of its dominant eigenvalue.
#[derive(Clone, Copy)]
struct Outlook {
    modulus: f64,
    scale: f64,
}

/// Working storage, kept between calls.
#[derive(Default)]
pub struct Krylov {
    basis: Vec<Vec<f64>>,
    /// Columns of the projected map, column k with k + 2 entries.
    projected: Vec<Vec<f64>>,
    image: Vec<f64>,
    square: Vec<f64>,
    values: Vec<Complex<f64>>,
    ritz: Vec<Complex<f64>>,
    /// How the last map converged, the first guess for the next.
    outlook: Option<Outlook>,
    /// A vector of the last dominant eigenspace, the bulk of the next start; empty at first.
    warm: Vec<f64>,
    /// Whether the last map took a vector beyond all numbers.
    overflowed: bool,
}

impl Krylov {
    /// Eigenvalue of greatest modulus with a residual of at most `tolerance`.
    ///
    /// # Errors
    /// [`NotConverged`] after 240 steps, or as soon as a vector outgrows all numbers.
    pub fn dominant(&mut self, map: &mut impl LinearMap, tolerance: f64) -> Result<Dominant, NotConverged> {
        let size = map.size();
        let greatest = size.min(MAX_STEPS);
        self.overflowed = false;
        self.start(size);
        let warm = self.warm.len() == size;
        let tolerance = if warm { tolerance } else { tolerance.min(UNSEEN) };
        // A search for eigenvalues costs more than a step: the subdiagonal over the modulus tells
        // how the residual falls from step to step, and so when the next search is worth it.
        let mut best = f64::INFINITY;
        let mut latest = if self.outlook.is_some() { greatest } else { FIRST_SEARCH };
        let mut outlook = self.outlook.unwrap_or(Outlook { modulus: f64::INFINITY, scale: f64::INFINITY });
        let (mut fall, mut step) = (1.0, 0);
        loop {
            let next = self.step(map, step);
            if !next.is_finite() {
                self.overflowed = true;
                return Err(NotConverged { residual: f64::INFINITY });
            }
            step += 1;
            fall *= next / outlook.modulus;
            let exhausted = step == greatest || next == 0.0;
            let hopeful = outlook.scale * fall <= tolerance || step >= latest;
            if !hopeful && !exhausted {
                continue;
            }
            let remainder = if step == size { 0.0 } else { next };
            if let Some(found) = self.ritz_value(step, remainder, tolerance) {
                best = best.min(found.residual);
                let modulus = found.value.norm();
                fall = self.projected[..step].iter().map(|column| column[column.len() - 1] / modulus).product();
                outlook = Outlook { modulus, scale: found.residual / fall };
                if found.residual <= tolerance {
                    self.outlook = Some(outlook).filter(|outlook| outlook.scale.is_finite());
                    self.keep_warm(step, found.value);
                    return Ok(found);
                }
            }
            if exhausted {
                return Err(NotConverged { residual: best });
            }
            latest = 2 * step;
        }
    }

    /// Whether the last map took a vector beyond all numbers: what it stands for outgrows them within its period.
    pub fn overflowed(&self) -> bool {
        self.overflowed
    }

    /// A start vector: the last eigenvector if there is one, and a fixed irrational rotation that
    /// favours nothing, lest a new dominant vector go unseen.
    fn start(&mut self, size: usize) {
        self.image.resize(size, 0.0);
        if self.basis.is_empty() {
            self.basis.push(Vec::new());
        }
        let first = &mut self.basis[0];
        first.resize(size, 0.0);
        let mut phase: f64 = 0.137;
        for entry in first.iter_mut() {
            phase = (phase + 0.618_033_988_749_894_9).fract();
            *entry = phase + 0.2;
        }
        let norm = dot(first, first).sqrt();
        if self.warm.len() == size {
            for (entry, warm) in first.iter_mut().zip(&self.warm) {
                *entry = *entry * (0.3 / norm) + warm;
            }
        }
        let norm = dot(first, first).sqrt();
        first.iter_mut().for_each(|entry| *entry /= norm);
    }

    /// Keeps a real vector of the eigenspace of `value` for the next start, with some of that of the eigenvalue next in
    /// modulus: of a neighbouring map it may be the dominant one.
    fn keep_warm(&mut self, m: usize, value: Complex<f64>) {
        self.warm.clear();
        self.warm.resize(self.image.len(), 0.0);
        let mut weights = vec![0.0; m];
        let mut add = |krylov: &mut Self, value, share: f64| {
            krylov.last_component(m, value);
            let norm: f64 = krylov.ritz.iter().map(|entry| entry.norm_sqr()).sum::<f64>().sqrt();
            for (weight, y) in weights.iter_mut().zip(&krylov.ritz) {
                *weight += share / norm * (y.re + y.im);
            }
        };
        add(self, value, 1.0);
        if let Some(rival) = self.greatest_but(Some(value)) {
            add(self, rival, RIVAL_SHARE);
        }
        for (weight, vector) in weights.iter().zip(&self.basis) {
            subtract(&mut self.warm, -weight, vector);
        }
    }

    /// The Ritz value of greatest modulus but `skip`, one of each conjugate pair.
    fn greatest_but(&self, skip: Option<Complex<f64>>) -> Option<Complex<f64>> {
        let distinct = |v: &&Complex<f64>| v.im >= 0.0 && Some(**v) != skip;
        self.values.iter().filter(distinct).max_by(|a, b| a.norm_sqr().total_cmp(&b.norm_sqr())).copied()
    }

    /// Extends the space by one vector; returns its length before normalisation.
    fn step(&mut self, map: &mut impl LinearMap, k: usize) -> f64 {
        map.apply(&self.basis[k], &mut self.image);
        if self.projected.len() <= k {
            self.projected.push(Vec::new());
            self.basis.push(Vec::new());
        }
        let column = &mut self.projected[k];
        column.clear();
        let before = dot(&self.image, &self.image);
        for vector in &self.basis[..=k] {
            let coefficient = dot(vector, &self.image);
            subtract(&mut self.image, coefficient, vector);
            column.push(coefficient);
        }
        let mut after = dot(&self.image, &self.image);
        if after < 1e-10 * before {
            // Five digits were cancelled: orthogonalise again.
            for (vector, entry) in self.basis[..=k].iter().zip(column.iter_mut()) {
                let coefficient = dot(vector, &self.image);
                subtract(&mut self.image, coefficient, vector);
                *entry += coefficient;
            }
            after = dot(&self.image, &self.image);
        }
        let norm = if after <= 1e-30 * before { 0.0 } else { after.sqrt() };
        column.push(norm);
        let scale = if norm > 0.0 { 1.0 / norm } else { 0.0 };
        let next = &mut self.basis[k + 1];
        next.clear();
        next.extend(self.image.iter().map(|entry| entry * scale));
        norm
    }

    /// Dominant eigenvalue of the projected map of dimension `m` with its residual. A second
    /// eigenvalue of similar modulus must be known roughly as well, lest it overtake.
    fn ritz_value(&mut self, m: usize, remainder: f64, tolerance: f64) -> Option<Dominant> {
        self.square.clear();
        self.square.resize(m * m, 0.0);
        for (j, column) in self.projected[..m].iter().enumerate() {
            for (i, entry) in column.iter().enumerate().take(m) {
                self.square[i * m + j] = *entry;
            }
        }
        let mut values = std::mem::take(&mut self.values);
        let done = hessenberg::eigenvalues(&mut self.square, m, 1e-3 * tolerance, &mut values);
        self.values = values;
        done?;
        let value = self.greatest_but(None)?;
        let rival = self.greatest_but(Some(value));
        let modulus = value.norm_sqr().sqrt();
        if modulus == 0.0 {
            return Some(Dominant { value, residual: 0.0 });
        }
        let mut residual = remainder * self.last_component(m, value) / modulus;
        if let Some(rival) = rival.filter(|rival| residual <= tolerance && rival.norm_sqr().sqrt() > 0.6 * modulus) {
            let spread = remainder * self.last_component(m, rival) / modulus;
            if rival.norm_sqr().sqrt() + 10.0 * spread * modulus > modulus {
                residual = residual.max(spread);
            }
        }
        Some(Dominant { value, residual })
    }

    /// Last entry of the unit eigenvector of the projected map at `value`, by back recurrence.
    fn last_component(&mut self, m: usize, value: Complex<f64>) -> f64 {
        let ritz = &mut self.ritz;
        ritz.clear();
        ritz.resize(m, Complex::new(0.0, 0.0));
        ritz[m - 1] = Complex::new(1.0, 0.0);
        for i in (1..m).rev() {
            let mut sum = -value * ritz[i];
            for (entry, column) in ritz[i..].iter().zip(&self.projected[i..m]) {
                sum += entry * column[i];
            }
            ritz[i - 1] = -sum / self.projected[i - 1][i];
            let size = ritz[i - 1].norm_sqr();
            if size > 1e200 {
                ritz.iter_mut().for_each(|entry| *entry *= 1e-100);
            }
        }
        let norm: f64 = ritz.iter().map(|entry| entry.norm_sqr()).sum();
        ritz[m - 1].norm() / norm.sqrt()
    }
}

/// Scalar product with four sums, which the compiler can keep in vector registers.
#[inline]
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    let (quads_a, quads_b) = (a.chunks_exact(4), b.chunks_exact(4));
    let rest: f64 = quads_a.remainder().iter().zip(quads_b.remainder()).map(|(x, y)| x * y).sum();
    for (x, y) in quads_a.zip(quads_b) {
        for lane in 0..4 {
            sums[lane] += x[lane] * y[lane];
        }
    }
    (sums[0] + sums[2]) + (sums[1] + sums[3]) + rest
}

/// `y −= factor x`.
#[inline]
pub fn subtract(y: &mut [f64], factor: f64, x: &[f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y -= factor * x;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DVector;
    use proptest::prelude::*;

    struct Dense(DMatrix<f64>);

    impl LinearMap for Dense {
        fn size(&self) -> usize {
            self.0.nrows()
        }
        fn apply(&mut self, x: &[f64], y: &mut [f64]) {
            y.copy_from_slice((&self.0 * DVector::from_column_slice(x)).as_slice());
        }
    }

    proptest! {
        #[test]
        fn agrees_with_dense_eigenvalues(entries in prop::collection::vec(-1.0f64..1.0, 400), n in 2usize..=20) {
            let matrix = DMatrix::from_column_slice(n, n, &entries[..n * n]);
            let reference = matrix.complex_eigenvalues().iter().map(|v| v.norm()).fold(0.0, f64::max);
            let mut map = Dense(matrix);
            let dense = dense_dominant(map.dense()).unwrap();
            prop_assert!((dense.value.norm() - reference).abs() < 1e-12 * reference && dense.residual < 1e-10);
            let found = Krylov::default().dominant(&mut map, 1e-12).unwrap();
            prop_assert!((found.value.norm_sqr().sqrt() - reference).abs() < 1e-7 * reference);
        }
    }

    #[test]
    fn invariant_start_space_ends_early() {
        let found = Krylov::default().dominant(&mut Dense(DMatrix::identity(9, 9) * 3.0), 1e-12).unwrap();
        assert!((found.value.re - 3.0).abs() < 1e-12 && found.residual < 1e-12);
    }
}
