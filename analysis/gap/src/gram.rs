//! Normal equations of recorded groups.

use super::{Linear, Measured, Noise};
use nalgebra::DMatrix;
use rayon::prelude::*;
use std::ops::Range;
use toolroom_evidence::{Batch, Gram, crossed, squared};
pub(crate) use toolroom_evidence::{factor, part, part_column};

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
    Gram::from_batches(columns.len() + 1, &batches, local_scale, !folds.is_empty())
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
    local_scales.iter().map(|scale| Gram::from_batches(columns.len() + 1, &batches, scale, false)).collect()
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
    let locals: Vec<&[f64]> = linear.locals.iter().map(Vec::as_slice).collect();
    let fitted: Vec<usize> = measured.fitted_groups().collect();
    let part_of = |groups: &[usize]| {
        let spans: Vec<_> = groups.iter().map(|group| measured.spans[*group].clone()).collect();
        let rows = spans.iter().map(Range::len).sum();
        // Most constants of a shop move few groups.
        let moves = |column: &[f64]| spans.iter().any(|span| column[span.clone()].iter().any(|value| *value != 0.0));
        let at: Vec<usize> = (0..all.len()).filter(|place| moves(all[*place])).collect();
        let (mut standard, mut white) = (vec![0.0; measured.len()], vec![0.0; measured.len()]);
        let mut gathered = |columns: &mut dyn ExactSizeIterator<Item = &[f64]>| {
            let mut matrix = DMatrix::zeros(rows, columns.len());
            for (to, column) in matrix.as_mut_slice().chunks_exact_mut(rows.max(1)).zip(columns) {
                let mut row = 0;
                for (group, span) in groups.iter().zip(&spans) {
                    noise.whiten_group(measured, *group, column, &mut standard, &mut white);
                    to[row..row + span.len()].copy_from_slice(&white[span.clone()]);
                    row += span.len();
                }
            }
            matrix
        };
        let x = gathered(&mut at.iter().map(|place| all[*place]));
        let z = gathered(&mut locals.iter().copied());
        let mut first = 0;
        let groups = spans.iter().map(|span| {
            let inside = first..first + span.len();
            first = inside.end;
            (crossed(&z, &x, &inside), crossed(&z, &z, &inside))
        });
        let groups = groups.collect();
        Batch { squares: squared(&x), at, groups }
    };
    match folds {
        [] if fitted.is_empty() => vec![part_of(&[])],
        [] => fitted.par_chunks(BATCH).map(part_of).collect(),
        folds => folds.par_iter().map(|groups| part_of(groups)).collect(),
    }
}
