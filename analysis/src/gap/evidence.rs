//! Evidence for models: how much better one explains everything within the priors, and how well it
//! predicts groups that its fit left out.
//!
//! What a form allowance has learnt from some groups it predicts on the others, so that groups left
//! out alone cannot tell an effect from a surface that went five prior standard deviations to mimic
//! it. The gain of a model is therefore that of the penalised likelihood, in which such a journey
//! is paid for; groups left out say whether all of them speak for it.

use super::Gram;
use super::fit::EFFECT_PRIOR;
use super::gram::{factor, log_determinant, part, part_column};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Groups left out at a time are as many as give at most this many folds.
const FOLDS: usize = 40;

/// Log predictive density of each fold, and the fold of each group of the Gram.
#[derive(Clone, Debug)]
pub struct Evidence {
    /// Greatest log posterior density, beside constants that all models share.
    pub profile: f64,
    /// One number a fold.
    pub folds: Vec<f64>,
    /// Whether the effects came out with their sign in the fit to everything.
    pub admissible: bool,
}

/// Folds of the fitted groups: indices into the Gram's groups.
pub fn folds(gram: &Gram, fitted: &[bool]) -> Vec<Vec<usize>> {
    let groups: Vec<usize> = (0..gram.groups.len()).filter(|i| fitted[gram.groups[*i]]).collect();
    let count = groups.len().clamp(1, FOLDS);
    let mut folds = vec![Vec::new(); count];
    groups.iter().enumerate().for_each(|(i, group)| folds[i % count].push(*group));
    folds
}

/// Solution and predictive densities of a model over the columns `at`, of which those not below
/// `nuisance` are free.
pub fn evidence(gram: &Gram, folds: &[Vec<usize>], at: &[usize], nuisance: usize, two_sided: bool) -> Evidence {
    let prior = |i: usize| if at[i] < nuisance { 1.0 } else { EFFECT_PRIOR.powi(-2) };
    let mut all = part(&gram.total, at, at);
    for i in 0..at.len() {
        all[(i, i)] += prior(i);
    }
    let right = part_column(&gram.total, at, gram.last());
    let whole = factor(all.clone());
    let log_whole = log_determinant(&whole);
    let solution = whole.solve(&right);
    let squares = gram.total[(gram.last(), gram.last())];
    let profile = -0.5 * (squares - right.dot(&solution));
    let admissible = two_sided || (0..at.len()).all(|i| at[i] < nuisance || solution[i] > 0.0);
    let fold = |groups: &Vec<usize>| -> f64 {
        let (held, held_right, squares, determinant) = held_out(gram, groups, at);
        let train = factor(&all - &held);
        let log_train = log_determinant(&train);
        let beta = train.solve(&(&right - &held_right));
        let gradient = &held_right - &held * &beta;
        let quadratic =
            squares - 2.0 * beta.dot(&held_right) + beta.dot(&(&held * &beta)) - gradient.dot(&whole.solve(&gradient));
        -0.5 * (quadratic + log_whole - log_train + determinant)
    };
    Evidence { profile, folds: folds.par_iter().map(fold).collect(), admissible }
}

/// Normal equations, right side, square of the residual and `ln det V` of the groups of a fold.
fn held_out(gram: &Gram, groups: &[usize], at: &[usize]) -> (DMatrix<f64>, DVector<f64>, f64, f64) {
    let mut held = DMatrix::zeros(at.len(), at.len());
    let mut right = DVector::zeros(at.len());
    let (mut squares, mut determinant) = (0.0, 0.0);
    for group in groups {
        let matrix = &gram.matrices[*group];
        held += part(matrix, at, at);
        right += part_column(matrix, at, gram.last());
        squares += matrix[(gram.last(), gram.last())];
        determinant += gram.log_determinants[*group];
    }
    (held, right, squares, determinant)
}

/// Solution of everything that was fitted.
pub fn solution(gram: &Gram, at: &[usize], nuisance: usize) -> DVector<f64> {
    let mut all = part(&gram.total, at, at);
    for i in 0..at.len() {
        all[(i, i)] += if at[i] < nuisance { 1.0 } else { EFFECT_PRIOR.powi(-2) };
    }
    factor(all).solve(&part_column(&gram.total, at, gram.last()))
}

/// Solutions with each fold left out.
pub fn left_out_solutions(gram: &Gram, folds: &[Vec<usize>], at: &[usize], nuisance: usize) -> Vec<DVector<f64>> {
    let mut all = part(&gram.total, at, at);
    for i in 0..at.len() {
        all[(i, i)] += if at[i] < nuisance { 1.0 } else { EFFECT_PRIOR.powi(-2) };
    }
    let right = part_column(&gram.total, at, gram.last());
    let solve = |groups: &Vec<usize>| {
        let (held, held_right, ..) = held_out(gram, groups, at);
        factor(&all - held).solve(&(&right - held_right))
    };
    folds.par_iter().map(solve).collect()
}

/// Log marginal likelihood of everything that was fitted, over the columns `at`.
pub fn marginal(gram: &Gram, fitted: &[bool], at: &[usize], nuisance: usize) -> f64 {
    let mut all = part(&gram.total, at, at);
    for i in 0..at.len() {
        all[(i, i)] += if at[i] < nuisance { 1.0 } else { 1.0 / 9.0 };
    }
    let right = part_column(&gram.total, at, gram.last());
    let whole = factor(all);
    let determinants: f64 =
        (0..gram.groups.len()).filter(|i| fitted[gram.groups[*i]]).map(|i| gram.log_determinants[i]).sum();
    let squares = gram.total[(gram.last(), gram.last())];
    -0.5 * (squares - right.dot(&whole.solve(&right)) + log_determinant(&whole) + determinants)
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
