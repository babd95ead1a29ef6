//! Evidence for models: how much better one explains everything within the priors, and how well it
//! predicts groups that its fit left out.
//!
//! What a form allowance has learnt from some groups it predicts on the others, so that groups left
//! out alone cannot tell an effect from a surface that went five prior standard deviations to mimic
//! it. The gain of a model is therefore that of the penalised likelihood, in which such a journey
//! is paid for; groups left out say whether all of them speak for it.

use crate::{Factor, Gram, factor, log_determinant, part, part_column};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use std::borrow::Cow;

/// Prior standard deviation of an effect, in ordinary sizes: all but flat.
pub const EFFECT_PRIOR: f64 = 20.0;
/// Standard deviations by which a size may lie beyond its range (1). Source: about 95 %, so that an effect at the end of
/// its range is not lost by its error.
const BEYOND: f64 = 2.0;

/// Log predictive density of each fold, and the fold of each group of the Gram.
#[derive(Clone, Debug)]
pub struct Evidence {
    /// Greatest log posterior density, beside constants that all models share.
    pub profile: f64,
    /// One number a fold.
    pub folds: Vec<f64>,
    /// Whether the effects came out with their sign, and within their range but for their error, in the fit to
    /// everything.
    pub admissible: bool,
}

/// Normal equations over the columns `at` with the priors, of which those not below `nuisance` are free.
fn with_priors(gram: &Gram, at: &[usize], nuisance: usize) -> (DMatrix<f64>, DVector<f64>) {
    let mut all = part(&gram.total, at, at);
    for i in 0..at.len() {
        all[(i, i)] += if at[i] < nuisance { 1.0 } else { EFFECT_PRIOR.powi(-2) };
    }
    (all, part_column(&gram.total, at, gram.last()))
}

/// Solution and predictive densities of a model over the columns `at`, of which those not below
/// `nuisance` are free and have to lie within the `range` of their column, where that begins at zero above it.
pub fn evidence(gram: &Gram, at: &[usize], nuisance: usize, range: &dyn Fn(usize) -> [f64; 2]) -> Evidence {
    Factored::new(gram, at, nuisance).with(&[], range)
}

/// The factors of a model's normal equations: a model with a few more columns needs no new ones.
pub struct Factored<'a> {
    gram: &'a Gram,
    at: Vec<usize>,
    nuisance: usize,
    whole: Factor,
    /// Without each fold.
    trains: Vec<Factor>,
}

impl<'a> Factored<'a> {
    /// Of a model over the columns `at`, of which those not below `nuisance` are free.
    pub fn new(gram: &'a Gram, at: &[usize], nuisance: usize) -> Self {
        let (all, _) = with_priors(gram, at, nuisance);
        let train = |held: &DMatrix<f64>| factor(&all - part(held, at, at));
        let trains = gram.folds.par_iter().map(train).collect();
        Self { gram, at: at.to_vec(), nuisance, whole: factor(all), trains }
    }

    /// Solution and predictive densities of the model with the columns `more`, of which those not below the nuisance have to
    /// lie within the `range` of their column, where that begins at zero above it.
    pub fn with(&self, more: &[usize], range: &dyn Fn(usize) -> [f64; 2]) -> Evidence {
        let (gram, nuisance) = (self.gram, self.nuisance);
        let at: Vec<usize> = self.at.iter().chain(more).copied().collect();
        let (all, right) = with_priors(gram, &at, nuisance);
        let whole = extended(&self.whole, &all);
        let log_whole = log_determinant(&whole);
        let solution = whole.solve(&right);
        let squares = gram.total[(gram.last(), gram.last())];
        let profile = -0.5 * (squares - right.dot(&solution));
        let admissible = (0..at.len()).filter(|i| at[*i] >= nuisance).all(|i| {
            let [least, greatest] = range(at[i]);
            let signed = least < 0.0 || solution[i] > 0.0;
            let beyond = (solution[i] - greatest).max(least - solution[i]);
            signed && (beyond <= 0.0 || beyond <= BEYOND * error(&whole, i))
        });
        let fold = |((matrix, determinant), train): ((&DMatrix<f64>, &f64), &Factor)| -> f64 {
            let (held, held_right) = (part(matrix, &at, &at), part_column(matrix, &at, gram.last()));
            let squares = matrix[(gram.last(), gram.last())];
            let train = extended(train, &(&all - &held));
            let log_train = log_determinant(&train);
            let beta = train.solve(&(&right - &held_right));
            let explained = &held * &beta;
            let gradient = &held_right - &explained;
            let quadratic =
                squares - 2.0 * beta.dot(&held_right) + beta.dot(&explained) - gradient.dot(&whole.solve(&gradient));
            -0.5 * (quadratic + log_whole - log_train + determinant)
        };
        let folds = gram.folds.par_iter().zip(&gram.log_determinants).zip(&self.trains).map(fold).collect();
        Evidence { profile, folds, admissible }
    }
}

/// The factor of `matrix`, of which `factored` is that of the first rows and columns.
fn extended<'a>(factored: &'a Factor, matrix: &DMatrix<f64>) -> Cow<'a, Factor> {
    let mut known = Cow::Borrowed(factored);
    for place in factored.l_dirty().nrows()..matrix.nrows() {
        let column: DVector<f64> = matrix.view((0, place), (place + 1, 1)).column(0).into_owned();
        let longer = known.insert_column(place, column);
        let pivot = longer.l_dirty()[(place, place)];
        // A diagonal that rounding has spoilt is lifted where all is factored anew.
        if !(pivot.is_finite() && pivot > 0.0) {
            return Cow::Owned(factor(matrix.clone()));
        }
        known = Cow::Owned(longer);
    }
    known
}

/// Standard deviation of unknown `i` of normal equations.
fn error(matrix: &Factor, i: usize) -> f64 {
    let mut unit = DVector::zeros(matrix.l_dirty().nrows());
    unit[i] = 1.0;
    matrix.solve(&unit)[i].sqrt()
}

/// Solution of everything that was fitted, column `i` of `at` within ± `reach[i]`; columns beyond the end of `reach` are
/// free.
pub fn solution(gram: &Gram, at: &[usize], nuisance: usize, reach: &[f64]) -> DVector<f64> {
    let (all, right) = with_priors(gram, at, nuisance);
    within(&all, &right, reach)
}

/// Solutions with each fold left out; `reach` as in [`solution`].
pub fn left_out_solutions(gram: &Gram, at: &[usize], nuisance: usize, reach: &[f64]) -> Vec<DVector<f64>> {
    let (all, right) = with_priors(gram, at, nuisance);
    let solve = |matrix: &DMatrix<f64>| {
        within(&(&all - part(matrix, at, at)), &(&right - part_column(matrix, at, gram.last())), reach)
    };
    gram.folds.par_iter().map(solve).collect()
}

/// Solution of the normal equations `matrix · x = right` with |xᵢ| at most `reach[i]`; unknowns beyond the end of
/// `reach` are free. An unknown that would leave its range is held at its end, the farthest first, until all keep theirs.
pub fn within(matrix: &DMatrix<f64>, right: &DVector<f64>, reach: &[f64]) -> DVector<f64> {
    let mut held: Vec<(usize, f64)> = Vec::new();
    loop {
        let free: Vec<usize> = (0..right.len()).filter(|i| held.iter().all(|(own, _)| own != i)).collect();
        let mut solution = if held.is_empty() {
            factor(matrix.clone()).solve(right)
        } else {
            let mut right = DVector::from_fn(free.len(), |i, _| right[free[i]]);
            for (column, value) in &held {
                right -= part_column(matrix, &free, *column) * *value;
            }
            let inside = factor(part(matrix, &free, &free)).solve(&right);
            let mut all = DVector::zeros(matrix.nrows());
            free.iter().zip(inside.iter()).for_each(|(i, x)| all[*i] = *x);
            all
        };
        held.iter().for_each(|(own, value)| solution[*own] = *value);
        let beyond = |i: &usize| solution[*i].abs() - reach.get(*i).copied().unwrap_or(f64::INFINITY);
        let farthest = free.into_iter().filter(|i| beyond(i) > 0.0).max_by(|a, b| beyond(a).total_cmp(&beyond(b)));
        let Some(farthest) = farthest else { return solution };
        held.push((farthest, reach[farthest].copysign(solution[farthest])));
    }
}

/// Log marginal likelihood of everything that was fitted, over all columns.
pub fn marginal(gram: &Gram, nuisance: usize) -> f64 {
    let columns: Vec<usize> = (0..gram.last()).collect();
    let mut all = part(&gram.total, &columns, &columns);
    for i in 0..columns.len() {
        all[(i, i)] += if i < nuisance { 1.0 } else { 1.0 / 9.0 };
    }
    let right = part_column(&gram.total, &columns, gram.last());
    let whole = factor(all);
    let squares = gram.total[(gram.last(), gram.last())];
    -0.5 * (squares - right.dot(&whole.solve(&right)) + log_determinant(&whole) + gram.log_determinant)
}

/// Gain of one model over another in log posterior density.
pub fn gain(model: &Evidence, base: &Evidence) -> f64 {
    model.profile - base.profile
}

/// Gain of log predictive density on groups left out, and its standard error over folds.
pub fn predictive_gain(model: &Evidence, base: &Evidence) -> (f64, f64) {
    let differences: Vec<f64> = model.folds.iter().zip(&base.folds).map(|(a, b)| a - b).collect();
    let count = differences.len() as f64;
    let mean = differences.iter().sum::<f64>() / count;
    let variance = differences.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / (count - 1.0).max(1.0);
    (mean * count, (variance * count).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_effect_that_would_have_to_lie_beyond_its_range_is_no_admissible_one_but_for_its_error() {
        // One reading a fold of an effect alone, its size 4 with an error of 1 and next to no prior.
        let columns = DMatrix::from_row_slice(2, 2, &[1.0, 4.0, 4.0, 16.0]);
        let gram = Gram {
            folds: vec![columns.clone()],
            log_determinants: vec![0.0],
            total: columns,
            log_determinant: 0.0,
            lengths: DVector::from_column_slice(&[1.0, 16.0]),
        };
        let admissible = |range: [f64; 2]| evidence(&gram, &[0], 0, &|_| range).admissible;
        for (range, kept) in [
            ([0.0, f64::INFINITY], true),
            ([0.0, 3.0], true),
            ([0.0, 1.5], false),
            ([-1.0, 1.5], false),
            ([-1.0, 5.0], true),
            ([7.0, 9.0], false),
            ([f64::NEG_INFINITY, f64::INFINITY], true),
        ] {
            assert_eq!(admissible(range), kept, "{range:?}");
        }
    }

    #[test]
    fn a_model_with_more_columns_is_that_of_all_of_them() {
        // Nine readings of four columns and a residual in three folds; the last two columns are effects.
        let x = DMatrix::from_fn(9, 5, |i, j| ((3 * i + 5 * j + i * j) % 7) as f64 - 3.0);
        let folds: Vec<DMatrix<f64>> = (0..3).map(|fold| x.rows(3 * fold, 3).tr_mul(&x.rows(3 * fold, 3))).collect();
        let gram = Gram {
            log_determinants: vec![0.0; 3],
            total: folds.iter().sum(),
            folds,
            log_determinant: 0.0,
            lengths: DVector::zeros(5),
        };
        let free = |_: usize| [f64::NEG_INFINITY, f64::INFINITY];
        let base = Factored::new(&gram, &[0, 1], 2);
        for more in [&[][..], &[2], &[3], &[3, 2]] {
            let at = [&[0, 1], more].concat();
            let (one, other) = (base.with(more, &free), evidence(&gram, &at, 2, &free));
            assert!((one.profile - other.profile).abs() < 1e-10, "{more:?}: {one:?} {other:?}");
            let folds = one.folds.iter().zip(&other.folds);
            assert!(folds.clone().all(|(a, b)| (a - b).abs() < 1e-10) && folds.count() == 3, "{one:?} {other:?}");
        }
    }

    #[test]
    fn what_is_held_at_the_end_of_its_range_leaves_its_part_to_the_others() {
        let matrix = DMatrix::from_row_slice(2, 2, &[2.0, 1.0, 1.0, 3.0]);
        let right = DVector::from_column_slice(&[9.0, 7.0]);
        // Free: 2x + y = 9, x + 3y = 7.
        let free = within(&matrix, &right, &[]);
        assert!((free[0] - 4.0).abs() < 1e-12 && (free[1] - 1.0).abs() < 1e-12, "{free}");
        assert_eq!(within(&matrix, &right, &[4.5, 1.5]), free);
        // With x at 1 the second equation gives y = 2; an end on the other side is as good.
        let held = within(&matrix, &right, &[1.0]);
        assert!((held[0] - 1.0).abs() < 1e-12 && (held[1] - 2.0).abs() < 1e-12, "{held}");
        let other = within(&matrix, &-right.clone(), &[1.0]);
        assert!((other + held).amax() < 1e-12);
        // With y held as well nothing is left to solve.
        let both = within(&matrix, &right, &[1.0, 0.5]);
        assert_eq!(both.as_slice(), [1.0, 0.5]);
    }
}
