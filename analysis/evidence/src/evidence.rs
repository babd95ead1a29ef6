//! Evidence for models: how much better one explains everything within the priors, and how well it
//! predicts groups that its fit left out.
//!
//! What a form allowance has learnt from some groups it predicts on the others, so that groups left
//! out alone cannot tell an effect from a surface that went five prior standard deviations to mimic
//! it. The gain of a model is therefore that of the penalised likelihood, in which such a journey
//! is paid for; groups left out say whether all of them speak for it.

use crate::{Factor, Fold, Gram, factor, part, part_column};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

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

/// Prior precision of a column.
fn precision(column: usize, nuisance: usize) -> f64 {
    if column < nuisance { 1.0 } else { EFFECT_PRIOR.powi(-2) }
}

/// Normal equations over the columns `at` with the priors, of which those not below `nuisance` are free.
fn with_priors(gram: &Gram, at: &[usize], nuisance: usize) -> (DMatrix<f64>, DVector<f64>) {
    let mut all = part(&gram.total, at, at);
    for i in 0..at.len() {
        all[(i, i)] += precision(at[i], nuisance);
    }
    (all, part_column(&gram.total, at, gram.last()))
}

/// The part of a fold in normal equations over some columns: its rows there, and theirs in the fold.
struct Held<'a> {
    fold: &'a Fold,
    rows: Vec<(usize, usize)>,
    /// The row of the residual in the fold, where it is not zero there.
    residual: Option<usize>,
}

impl<'a> Held<'a> {
    fn new(gram: &Gram, fold: &'a Fold, at: &[usize]) -> Self {
        let mut places = vec![None; gram.total.ncols()];
        for (place, column) in at.iter().enumerate() {
            debug_assert!(places[*column].is_none(), "a column that is twice in a model");
            places[*column] = Some(place);
        }
        let row = |(own, column): (usize, &usize)| Some((places[*column]?, own));
        let rows = fold.at.iter().enumerate().filter_map(row).collect();
        Self { fold, rows, residual: fold.at.binary_search(&gram.last()).ok() }
    }

    /// Products with the residual.
    fn right(&self, count: usize) -> DVector<f64> {
        let mut right = DVector::zeros(count);
        if let Some(residual) = self.residual {
            self.rows.iter().for_each(|(place, own)| right[*place] = self.fold.matrix[(*own, residual)]);
        }
        right
    }

    /// Squared length of the residual.
    fn square(&self) -> f64 {
        self.residual.map_or(0.0, |residual| self.fold.matrix[(residual, residual)])
    }

    /// Takes the fold out of `matrix`.
    fn taken_out_of(&self, matrix: &mut DMatrix<f64>) {
        for (i, row) in &self.rows {
            self.rows.iter().for_each(|(j, column)| matrix[(*i, *j)] -= self.fold.matrix[(*row, *column)]);
        }
    }

    /// The fold times `x`.
    fn times(&self, x: &DVector<f64>) -> DVector<f64> {
        let mut product = DVector::zeros(x.len());
        for (j, column) in &self.rows {
            let value = x[*j];
            self.rows.iter().for_each(|(i, row)| product[*i] += self.fold.matrix[(*row, *column)] * value);
        }
        product
    }
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
        let train = |fold: &Fold| {
            let mut train = all.clone();
            Held::new(gram, fold, at).taken_out_of(&mut train);
            factor(train)
        };
        let trains = gram.folds.par_iter().map(train).collect();
        Self { gram, at: at.to_vec(), nuisance, whole: factor(all), trains }
    }

    /// Solution and predictive densities of the model with the columns `more`, of which those not below the nuisance have to
    /// lie within the `range` of their column, where that begins at zero above it.
    pub fn with(&self, more: &[usize], range: &dyn Fn(usize) -> [f64; 2]) -> Evidence {
        let (gram, nuisance) = (self.gram, self.nuisance);
        let at: Vec<usize> = self.at.iter().chain(more).copied().collect();
        let right = part_column(&gram.total, &at, gram.last());
        let whole = self.extended(&self.whole, &at, None);
        let log_whole = whole.log_determinant();
        let solution = whole.solve(&right);
        let squares = gram.total[(gram.last(), gram.last())];
        let profile = -0.5 * (squares - right.dot(&solution));
        let admissible = (0..at.len()).filter(|i| at[*i] >= nuisance).all(|i| {
            let [least, greatest] = range(at[i]);
            let signed = least < 0.0 || solution[i] > 0.0;
            let beyond = (solution[i] - greatest).max(least - solution[i]);
            signed && (beyond <= 0.0 || beyond <= BEYOND * error(&whole, i))
        });
        let fold = |(fold, train): (&Fold, &Factor)| -> f64 {
            let held = Held::new(gram, fold, &at);
            let held_right = held.right(at.len());
            let train = self.extended(train, &at, Some(&held));
            let beta = train.solve(&(&right - &held_right));
            let explained = held.times(&beta);
            let gradient = &held_right - &explained;
            let quadratic =
                held.square() - 2.0 * beta.dot(&held_right) + beta.dot(&explained) - whole.square_by_inverse(&gradient);
            -0.5 * (quadratic + log_whole - train.log_determinant() + fold.log_determinant)
        };
        let folds = gram.folds.par_iter().zip(&self.trains).map(fold).collect();
        Evidence { profile, folds, admissible }
    }

    /// The factor over the columns `at`, of which `factored` is that of the first, without what is `held` out.
    fn extended(&self, factored: &Factor, at: &[usize], held: Option<&Held<'_>>) -> Factor {
        let mut known = factored.clone();
        for place in factored.size()..at.len() {
            let mut row: Vec<f64> = at[..=place].iter().map(|i| self.gram.total[(*i, at[place])]).collect();
            row[place] += precision(at[place], self.nuisance);
            if let Some(held) = held
                && let Some((_, own)) = held.rows.iter().find(|(own, _)| *own == place)
            {
                let inside = held.rows.iter().filter(|(i, _)| *i <= place);
                inside.for_each(|(i, other)| row[*i] -= held.fold.matrix[(*other, *own)]);
            }
            let Some(longer) = known.bordered(&row) else {
                // A diagonal that rounding has spoilt is lifted where all is factored anew.
                let (mut all, _) = with_priors(self.gram, at, self.nuisance);
                if let Some(held) = held {
                    held.taken_out_of(&mut all);
                }
                return factor(all);
            };
            known = longer;
        }
        known
    }
}

/// Standard deviation of unknown `i` of normal equations.
fn error(matrix: &Factor, i: usize) -> f64 {
    let mut unit = DVector::zeros(matrix.size());
    unit[i] = 1.0;
    matrix.square_by_inverse(&unit).sqrt()
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
    let solve = |fold: &Fold| {
        let held = Held::new(gram, fold, at);
        let mut train = all.clone();
        held.taken_out_of(&mut train);
        within(&train, &(&right - held.right(at.len())), reach)
    };
    gram.folds.par_iter().map(solve).collect()
}

/// Solution of the normal equations `matrix · x = right` with |xᵢ| at most `reach[i]`; unknowns beyond the end of
/// `reach` are free. An unknown that would leave its range is held at its end, the farthest first, until all keep theirs.
pub fn within(matrix: &DMatrix<f64>, right: &DVector<f64>, reach: &[f64]) -> DVector<f64> {
    let whole = factor(matrix.clone());
    let free = whole.solve(right);
    // What is held, at which value, and how a force on it moves everything.
    let mut held: Vec<(usize, f64, DVector<f64>)> = Vec::new();
    loop {
        let mut solution = free.clone();
        if !held.is_empty() {
            let moved = DMatrix::from_fn(held.len(), held.len(), |i, j| held[j].2[held[i].0]);
            let too_far = DVector::from_iterator(held.len(), held.iter().map(|(own, value, _)| free[*own] - value));
            let forces = factor(moved).solve(&too_far);
            held.iter().zip(forces.iter()).for_each(|((_, _, moves), force)| solution.axpy(-force, moves, 1.0));
            held.iter().for_each(|(own, value, _)| solution[*own] = *value);
        }
        let beyond = |i: &usize| solution[*i].abs() - reach.get(*i).copied().unwrap_or(f64::INFINITY);
        let leaves = |i: &usize| beyond(i) > 0.0 && held.iter().all(|(own, ..)| own != i);
        let farthest = (0..right.len()).filter(leaves).max_by(|a, b| beyond(a).total_cmp(&beyond(b)));
        let Some(farthest) = farthest else { return solution };
        let mut force = DVector::zeros(right.len());
        force[farthest] = 1.0;
        held.push((farthest, reach[farthest].copysign(solution[farthest]), whole.solve(&force)));
    }
}

/// Log marginal likelihood of everything that was fitted, over all columns with these prior precisions, beside constants.
pub fn marginal(gram: &Gram, precision: &[f64]) -> f64 {
    let columns: Vec<usize> = (0..gram.last()).collect();
    let mut all = part(&gram.total, &columns, &columns);
    columns.iter().for_each(|i| all[(*i, *i)] += precision[*i]);
    let right = part_column(&gram.total, &columns, gram.last());
    let whole = factor(all);
    let squares = gram.total[(gram.last(), gram.last())];
    -0.5 * (squares - whole.square_by_inverse(&right) + whole.log_determinant() + gram.log_determinant)
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
            folds: vec![Fold { at: vec![0, 1], matrix: columns.clone(), log_determinant: 0.0 }],
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
        // The first fold knows nothing of the second and the last column but one.
        let at = |fold: usize| if fold == 0 { vec![0, 2, 4] } else { (0..5).collect() };
        let fold = |fold: usize| {
            let rows = DMatrix::from_fn(3, at(fold).len(), |i, j| x[(3 * fold + i, at(fold)[j])]);
            Fold { at: at(fold), matrix: rows.tr_mul(&rows), log_determinant: 0.0 }
        };
        let folds: Vec<Fold> = (0..3).map(fold).collect();
        let mut total = DMatrix::zeros(5, 5);
        for Fold { at, matrix, .. } in &folds {
            let entries = (0..at.len()).flat_map(|i| (0..at.len()).map(move |j| (i, j)));
            entries.for_each(|(i, j)| total[(at[i], at[j])] += matrix[(i, j)]);
        }
        let gram = Gram { total, folds, log_determinant: 0.0, lengths: DVector::zeros(5) };
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
