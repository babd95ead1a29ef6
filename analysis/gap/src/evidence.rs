//! Groups that are left out together, and the evidence over them.

use super::Measured;
pub(crate) use toolroom_evidence::{
    EFFECT_PRIOR, Evidence, Factored, evidence, gain, left_out_solutions, marginal, predictive_gain, solution, within,
};

/// Groups left out at a time are as many as give at most this many folds.
const FOLDS: usize = 40;

/// Folds of the fitted groups.
pub fn folds(measured: &Measured) -> Vec<Vec<usize>> {
    let groups: Vec<usize> = measured.fitted_groups().collect();
    let count = groups.len().clamp(1, FOLDS);
    let mut folds = vec![Vec::new(); count];
    groups.iter().enumerate().for_each(|(i, group)| folds[i % count].push(*group));
    folds
}
