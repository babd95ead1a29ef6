//! Scores of groups that a linear model predicts from the other groups.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use rayon::prelude::*;
use std::ops::Range;

/// A group of readings, in units of their noise.
#[derive(Clone, Debug)]
pub struct Group {
    /// Derivatives by what all groups share, a row a reading, per prior standard deviation.
    pub shared: DMatrix<f64>,
    /// Derivatives by what the group has of its own, per prior standard deviation.
    pub covariance: DMatrix<f64>,
    /// The fold with which it is left out.
    pub fold: usize,
}

/// A linear model of groups: readings are `shared·x + own·u + ε` with standard normal x, u and ε.
pub struct Design {
    parts: Vec<Part>,
    /// Factors of the precision of x without each fold.
    without: Vec<Cholesky<f64, Dyn>>,
    shared: usize,
    readings: usize,
}

/// What is known of a group before any reading.
struct Part {
    group: Group,
    rows: Range<usize>,
    /// `V⁻¹ shared` for the covariance V of the group with x known.
    weighted: DMatrix<f64>,
    /// The readings in sequence, a stretch at a time.
    stretches: Vec<Stretch>,
}

/// Readings that follow each other, predicted from those of the group before them.
struct Stretch {
    rows: Range<usize>,
    /// Derivatives by what is not known of the group.
    by: DMatrix<f64>,
    /// Inverse of the lower factor of the covariance of the readings, given all before.
    root: DMatrix<f64>,
    /// What the scores say of what is not known.
    gain: DMatrix<f64>,
}

/// Readings of a stretch at most: products of matrices of this size are fast, and no group needs a matrix of its readings
/// by its readings.
const LONGEST: usize = 128;

impl Design {
    /// The design of `groups`, whose folds are 0 … `folds` − 1.
    ///
    /// # Panics
    /// Where a fold is not below `folds`, or groups differ in the number of their columns.
    pub fn new(groups: Vec<Group>, folds: usize) -> Self {
        let shared = groups.first().map_or(0, |group| group.shared.ncols());
        let weighted: Vec<DMatrix<f64>> = groups.par_iter().map(weighted).collect();
        let products: Vec<DMatrix<f64>> =
            groups.par_iter().zip(&weighted).map(|(group, weighted)| group.shared.tr_mul(weighted)).collect();
        let mut by_fold = vec![DMatrix::<f64>::zeros(shared, shared); folds];
        let mut total = DMatrix::<f64>::identity(shared, shared);
        for (group, product) in groups.iter().zip(&products) {
            by_fold[group.fold] += product;
            total += product;
        }
        let without: Vec<Cholesky<f64, Dyn>> = by_fold.par_iter().map(|own| factor(&total - own)).collect();
        let mut first = 0;
        let rows: Vec<Range<usize>> = groups
            .iter()
            .map(|group| {
                let rows = first..first + group.shared.nrows();
                first = rows.end;
                rows
            })
            .collect();
        let part_of = |((group, rows), weighted): ((Group, Range<usize>), DMatrix<f64>)| {
            let stretches = sequence(&group, &without[group.fold]);
            Part { group, rows, weighted, stretches }
        };
        let parts = groups.into_par_iter().zip(rows).zip(weighted).map(part_of).collect();
        Self { parts, without, shared, readings: first }
    }

    /// Number of readings.
    pub fn len(&self) -> usize {
        self.readings
    }

    /// Whether there is no reading.
    pub fn is_empty(&self) -> bool {
        self.readings == 0
    }

    /// Readings of each group.
    pub fn rows(&self) -> impl Iterator<Item = Range<usize>> + '_ {
        self.parts.iter().map(|part| part.rows.clone())
    }

    /// Scores of columns of residuals, a column a data set: every reading predicted from the other folds and from the
    /// readings of its group before it, in units of the predicted standard deviation. Where the model is right they are
    /// independent and standard normal, also where a reading decides whether others follow it: an edge that is changed on a
    /// reading of its wear ends with a high one, and a score that knew the readings after its own would tell so.
    pub fn scores(&self, residuals: &DMatrix<f64>) -> DMatrix<f64> {
        let sets = residuals.ncols();
        let mut by_fold = vec![DMatrix::<f64>::zeros(self.shared, sets); self.without.len()];
        let mut total = DMatrix::<f64>::zeros(self.shared, sets);
        for part in &self.parts {
            let local = part.weighted.tr_mul(&residuals.rows_range(part.rows.clone()));
            by_fold[part.group.fold] += &local;
            total += local;
        }
        let found: Vec<DMatrix<f64>> =
            self.without.iter().zip(by_fold).map(|(factor, own)| factor.solve(&(&total - own))).collect();
        let mut scores = residuals.clone();
        for part in &self.parts {
            let mut left = residuals.rows_range(part.rows.clone()) - &part.group.shared * &found[part.group.fold];
            let mut known: Option<DMatrix<f64>> = None;
            for Stretch { rows, by, root, gain } in &part.stretches {
                let mut own = left.rows_range_mut(rows.clone());
                if let Some(known) = &known {
                    own -= by * known;
                }
                let innovations = root * &own;
                own.copy_from(&innovations);
                if rows.end < part.rows.len() {
                    let learnt = gain * innovations;
                    known = Some(match known {
                        Some(known) => known + learnt,
                        None => learnt,
                    });
                }
            }
            scores.rows_range_mut(part.rows.clone()).copy_from(&left);
        }
        scores
    }

    /// Adds to each of `columns` what the numbers of its draw do: what all groups share, then what each has of its own.
    /// Draws of the model need it. Group by group, so that the derivatives of a group are fetched once for all draws.
    ///
    /// # Panics
    /// Where there are fewer numbers than columns of derivatives.
    pub fn add(&self, numbers: &[(DVector<f64>, Vec<DVector<f64>>)], columns: &mut [DVector<f64>]) {
        for (index, part) in self.parts.iter().enumerate() {
            for ((shared, locals), column) in numbers.iter().zip(columns.iter_mut()) {
                let moved = &part.group.shared * shared + &part.group.covariance * &locals[index];
                let mut rows = column.rows_range_mut(part.rows.clone());
                rows += moved;
            }
        }
    }

    /// Number of shared columns, and of those that each group has of its own.
    pub fn columns(&self) -> [usize; 2] {
        [self.shared, self.parts.first().map_or(0, |part| part.group.covariance.ncols())]
    }

    /// For each of `signatures` the weights whose product with a column of residuals is its score after projection:
    /// standard normal where the model is right, and as large as possible where the signature is hidden in the
    /// residuals. A signature that the model takes up wholly has weights of zero.
    pub fn projected(&self, signatures: &DMatrix<f64>) -> DMatrix<f64> {
        // V⁻¹ of the whole: that of each group with x known, less what x explains.
        let weigh = |columns: &DMatrix<f64>| {
            let mut to = columns.clone();
            for part in &self.parts {
                let local = solved(&part.group.covariance, &columns.rows_range(part.rows.clone()).into_owned());
                to.rows_range_mut(part.rows.clone()).copy_from(&local);
            }
            to
        };
        let mut precision = DMatrix::<f64>::identity(self.shared, self.shared);
        let mut cross = DMatrix::<f64>::zeros(self.shared, signatures.ncols());
        for part in &self.parts {
            precision += part.group.shared.tr_mul(&part.weighted);
            cross += part.weighted.tr_mul(&signatures.rows_range(part.rows.clone()));
        }
        let taken = factor(precision).solve(&cross);
        let mut weights = weigh(signatures);
        for part in &self.parts {
            let mut rows = weights.rows_range_mut(part.rows.clone());
            rows -= &part.weighted * &taken;
        }
        for (mut weight, signature) in weights.column_iter_mut().zip(signatures.column_iter()) {
            let square = weight.dot(&signature);
            let whole = signature.norm_squared();
            weight *= if square > 1e-9 * whole && whole > 0.0 { square.sqrt().recip() } else { 0.0 };
        }
        weights
    }
}

/// `V⁻¹ shared`.
fn weighted(group: &Group) -> DMatrix<f64> {
    solved(&group.covariance, &group.shared)
}

/// `(1 + own·own')⁻¹ columns`.
fn solved(local: &DMatrix<f64>, columns: &DMatrix<f64>) -> DMatrix<f64> {
    let inner = local.tr_mul(local) + DMatrix::identity(local.ncols(), local.ncols());
    columns - local * factor(inner).solve(&local.tr_mul(columns))
}

/// Cholesky factor of a matrix that is positive definite but for rounding.
fn factor(mut matrix: DMatrix<f64>) -> Cholesky<f64, Dyn> {
    let size = matrix.nrows();
    let scale = matrix.diagonal().amax().max(1.0);
    let mut lift = 1e-12 * scale;
    loop {
        if let Some(factor) = Cholesky::new(matrix.clone()) {
            return factor;
        }
        if !lift.is_finite() || lift > scale {
            return Cholesky::pack_dirty(DMatrix::identity(size, size));
        }
        (0..size).for_each(|i| matrix[(i, i)] += lift);
        lift *= 10.0;
    }
}

/// The readings of a group in sequence: every stretch predicted from the other folds and from the readings before it.
fn sequence(group: &Group, without: &Cholesky<f64, Dyn>) -> Vec<Stretch> {
    let shared = without.l().solve_lower_triangular(&group.shared.transpose());
    let shared = shared.unwrap_or_else(|| DMatrix::zeros(group.shared.ncols(), group.shared.nrows()));
    let (readings, counts, all) =
        (group.shared.nrows(), group.covariance.ncols(), group.covariance.ncols() + shared.nrows());
    let mut scatter = DMatrix::zeros(readings, all);
    scatter.columns_range_mut(..counts).copy_from(&group.covariance);
    scatter.columns_range_mut(counts..).tr_copy_from(&shared);
    let mut unknown = DMatrix::<f64>::identity(all, all);
    let mut stretches = Vec::with_capacity(readings.div_ceil(LONGEST));
    let mut first = 0;
    while first < readings {
        let rows = first..readings.min(first + LONGEST);
        first = rows.end;
        let by = scatter.rows_range(rows.clone()).into_owned();
        let spread = &by * &unknown;
        let covariance = DMatrix::identity(rows.len(), rows.len()) + &spread * by.transpose();
        let lower = factor(covariance).l();
        let root = lower
            .solve_lower_triangular(&DMatrix::identity(rows.len(), rows.len()))
            .unwrap_or_else(|| DMatrix::identity(rows.len(), rows.len()));
        let gain = (&root * spread).transpose();
        if first < readings {
            unknown -= &gain * gain.transpose();
        }
        stretches.push(Stretch { rows, by, root, gain });
    }
    stretches
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    fn groups() -> Vec<Group> {
        let value = |i: usize, j: usize| ((i * 7 + j * 13) % 11) as f64 / 4.0 - 1.2;
        [(6, 0), (1, 1), (8, 0), (5, 2)]
            .into_iter()
            .enumerate()
            .map(|(g, (rows, fold))| Group {
                shared: DMatrix::from_fn(rows, 3, |i, j| value(i + g, j)),
                covariance: DMatrix::from_fn(rows, 2, |i, j| value(j + 2 * g, i)),
                fold,
            })
            .collect()
    }

    /// Covariance of all readings, written out.
    fn covariance(groups: &[Group]) -> DMatrix<f64> {
        let rows: usize = groups.iter().map(|group| group.shared.nrows()).sum();
        let mut columns = DMatrix::zeros(rows, 3 + 2 * groups.len());
        let mut first = 0;
        for (g, group) in groups.iter().enumerate() {
            let n = group.shared.nrows();
            columns.view_mut((first, 0), (n, 3)).copy_from(&group.shared);
            columns.view_mut((first, 3 + 2 * g), (n, 2)).copy_from(&group.covariance);
            first += n;
        }
        DMatrix::identity(rows, rows) + &columns * columns.transpose()
    }

    #[test]
    fn scores_of_a_group_left_out_are_those_of_the_covariance_written_out() {
        let groups = groups();
        let whole = covariance(&groups);
        let design = Design::new(groups.clone(), 3);
        let residual = DVector::from_fn(design.len(), |i, _| (i as f64).cos());
        let scores = design.scores(&DMatrix::from_columns(std::slice::from_ref(&residual)));
        // The last group is a fold by itself: predicted from the fourteen readings of all others.
        let (train, test): (Vec<usize>, Vec<usize>) = ((0..15).collect(), (15..20).collect());
        let cut = |rows: &[usize], columns: &[usize]| whole.select_rows(rows).select_columns(columns);
        let gain = cut(&test, &train) * cut(&train, &train).try_inverse().unwrap();
        let left = residual.select_rows(&test) - &gain * residual.select_rows(&train);
        let predicted = cut(&test, &test) - &gain * cut(&train, &test);
        let golden = Cholesky::new(predicted).unwrap().l().solve_lower_triangular(&left).unwrap();
        for (i, golden) in golden.iter().enumerate() {
            assert!((scores[(15 + i, 0)] - golden).abs() < 1e-9, "{} instead of {golden}", scores[(15 + i, 0)]);
        }
    }

    /// Edges wear by a rate of their own and are changed at the first reading above a limit.
    #[test]
    fn readings_that_end_a_group_leave_scores_that_follow_nothing() {
        let mut random = ChaCha8Rng::seed_from_u64(7);
        let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
        let (mut groups, mut readings) = (Vec::new(), Vec::new());
        for fold in (0..600).map(|edge| edge % 4) {
            let own = normal();
            let mut count = 0;
            while readings.last().is_none_or(|last| count == 0 || *last < 2.0) && count < 12 {
                count += 1;
                readings.push(0.4 * f64::from(count) * (1.0 + 0.3 * own) - 0.4 * f64::from(count) + normal());
            }
            let by_own = DMatrix::from_fn(count as usize, 1, |i, _| 0.12 * (i + 1) as f64);
            groups.push(Group {
                shared: DMatrix::from_fn(count as usize, 1, |i, _| 0.1 * (i + 1) as f64),
                covariance: by_own,
                fold,
            });
        }
        let design = Design::new(groups, 4);
        let scores = design.scores(&DMatrix::from_column_slice(readings.len(), 1, &readings));
        let lasts: Vec<usize> = design.rows().map(|rows| rows.end - 1).collect();
        let of = |places: &dyn Fn(usize) -> bool| {
            let chosen: Vec<f64> =
                (0..readings.len()).filter(|place| places(*place)).map(|place| scores[(place, 0)]).collect();
            (chosen.iter().sum::<f64>() / chosen.len() as f64, (chosen.len() as f64).sqrt().recip())
        };
        // What is asked of all readings is asked at four standard errors; a last reading is high because it is the last.
        let (mean, error) = of(&|_| true);
        assert!(mean.abs() < 4.0 * error, "{mean} ± {error}");
        assert!(of(&|place| lasts.contains(&place)).0 > 0.5);
        let age: Vec<f64> = design.rows().flat_map(|rows| (0..rows.len()).map(|i| i as f64)).collect();
        let middle = age.iter().sum::<f64>() / age.len() as f64;
        let (follows, square) = age.iter().zip(scores.iter()).fold((0.0, 0.0), |(sum, square), (age, score)| {
            (sum + (age - middle) * score, square + (age - middle).powi(2))
        });
        assert!(follows.abs() < 4.0 * f64::sqrt(square), "{follows}");
    }

    #[test]
    fn a_projected_score_is_that_of_generalised_least_squares() {
        let groups = groups();
        let inverse = covariance(&groups).try_inverse().unwrap();
        let design = Design::new(groups, 3);
        let signature = DMatrix::from_fn(design.len(), 1, |i, _| (0.3 * i as f64).sin());
        let residual = DMatrix::from_fn(design.len(), 1, |i, _| (i as f64).cos());
        let score = design.projected(&signature).tr_mul(&residual)[0];
        let length = (signature.transpose() * &inverse * &signature)[0].sqrt();
        let golden = (signature.transpose() * inverse * residual)[0] / length;
        assert!((score - golden).abs() < 1e-9, "{score} instead of {golden}");
    }
}
