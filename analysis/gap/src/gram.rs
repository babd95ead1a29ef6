//! Normal equations of recorded groups.

use super::{Linear, Measured, Noise};
use nalgebra::DMatrix;
use rayon::prelude::*;
use toolroom_evidence::{Batch, Gram, crossed, squared};
pub(crate) use toolroom_evidence::{factor, inverse_diagonal, part, part_column};

/// Groups that are multiplied at a time where no folds are requested: many rows at once are faster,
/// few columns of groups need less memory.
const BATCH: usize = 16;

/// Normal equations of `columns` and the residual, also by `folds`, which are lists of groups;
/// `local_scale` multiplies the prior standard deviation of each kind of local factor.
pub fn normal_equations(
    measured: &Measured,
    noise: &Noise,
    linear: &Linear,
    columns: &[&[f64]],
    residual: &[f64],
    local_scale: &[f64],
    folds: &[Vec<usize>],
) -> Gram {
    let batches = batches(measured, noise, linear, columns, residual, folds);
    Gram::from_batches(&batches, local_scale, !folds.is_empty())
}

/// The same for several scales of the local factors, without folds.
pub(super) fn at_scales(
    measured: &Measured,
    noise: &Noise,
    linear: &Linear,
    columns: &[&[f64]],
    residual: &[f64],
    local_scales: &[Vec<f64>],
) -> Vec<Gram> {
    let batches = batches(measured, noise, linear, columns, residual, &[]);
    local_scales.iter().map(|local_scale| Gram::from_batches(&batches, local_scale, false)).collect()
}

/// Products of whitened columns, by fold or by batches of the fitted groups; at least one.
fn batches(
    measured: &Measured,
    noise: &Noise,
    linear: &Linear,
    columns: &[&[f64]],
    residual: &[f64],
    folds: &[Vec<usize>],
) -> Vec<Batch> {
    let all: Vec<&[f64]> = columns.iter().copied().chain([residual]).collect();
    let white: Vec<Vec<f64>> = all.par_iter().map(|column| noise.whiten(measured, column)).collect();
    let locals: Vec<Vec<f64>> = linear.locals.iter().map(|column| noise.whiten(measured, column)).collect();
    let fitted: Vec<usize> = measured.fitted_groups().collect();
    let part_of = |groups: &[usize]| {
        let spans: Vec<_> = groups.iter().map(|group| measured.spans[*group].clone()).collect();
        let rows = spans.iter().map(|span| span.len()).sum();
        let gathered = |columns: &[Vec<f64>]| {
            let mut matrix = DMatrix::zeros(rows, columns.len());
            for (to, column) in matrix.as_mut_slice().chunks_exact_mut(rows.max(1)).zip(columns) {
                let mut row = 0;
                for span in &spans {
                    to[row..row + span.len()].copy_from_slice(&column[span.clone()]);
                    row += span.len();
                }
            }
            matrix
        };
        let (x, z) = (gathered(&white), gathered(&locals));
        let mut first = 0;
        let groups = spans.iter().map(|span| {
            let inside = first..first + span.len();
            first = inside.end;
            (crossed(&z, &x, &inside), crossed(&z, &z, &inside))
        });
        let groups = groups.collect();
        Batch { squares: squared(&x), groups }
    };
    match folds {
        [] if fitted.is_empty() => vec![part_of(&[])],
        [] => fitted.par_chunks(BATCH).map(part_of).collect(),
        folds => folds.par_iter().map(|groups| part_of(groups)).collect(),
    }
}
