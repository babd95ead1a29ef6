//! Residuals of groups that a fit left out, and how they move with the groups of the fit.

use super::evidence::{left_out_solutions, solution};
use super::fit::{offset_residual, own_factors};
use super::trial::{Trial, columns};
use super::{Basis, Forward, Linear};
use nalgebra::DVector;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;

/// Residuals of every observation predicted without its own group.
pub struct LeftOut {
    /// As the fit is.
    pub residual: Vec<f64>,
    /// What a standard deviation of each group's say in the fit changes; empty where nobody asked.
    moves: Vec<Vec<f64>>,
}

impl LeftOut {
    /// Residuals that were put together from several fits, of which no other fits are known.
    pub fn alone(residual: Vec<f64>) -> Self {
        Self { residual, moves: Vec::new() }
    }

    /// The fit that predicts a group has not seen it. Of the group's own factors, those that are mere
    /// scatter follow its readings, with or without an effect: no model of means predicts them, and
    /// beside them a gap of the means would drown. The others are unknown. The form allowance protects
    /// the attribution only: it is no part of the model that is scored.
    pub fn of(model: &dyn Forward, basis: &Basis, trial: &Trial, folds: &[Vec<usize>]) -> Self {
        Scored::new(model, basis, trial, folds).left_out()
    }

    /// The same with what other groups in the fit would have made of it: the jackknife of the whole
    /// solution, sizes of effects included.
    pub fn with_moves(model: &dyn Forward, basis: &Basis, trial: &Trial, folds: &[Vec<usize>]) -> Self {
        let scored = Scored::new(model, basis, trial, folds);
        Self { moves: scored.moves(), ..scored.left_out() }
    }

    /// Whether anything is known about other fits.
    pub fn moves(&self) -> bool {
        !self.moves.is_empty()
    }

    /// Residuals of a fit to other groups; models of one `seed` and `draw` have the same groups.
    pub fn drawn(&self, seed: u64, draw: usize) -> Vec<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        random.set_stream(1 + draw as u64);
        let mut left = self.residual.clone();
        for column in &self.moves {
            let weight: f64 = StandardNormal.sample(&mut random);
            left.iter_mut().zip(column).for_each(|(left, change)| *left += weight * change);
        }
        left
    }
}

/// Columns of the Gram of `trial` that predict groups left out: calibration and effects, no form allowance.
pub(super) fn scoring(model: &dyn Forward, trial: &Trial) -> Vec<usize> {
    let allowance = model.frame().allowances();
    let mut columns_used: Vec<usize> = columns(trial.shared, &trial.fit.active);
    columns_used.retain(|i| *i >= trial.shared || allowance.get(*i).is_some_and(|allowance| !allowance));
    columns_used
}

/// The part of a trial that is scored on groups left out.
struct Scored<'a> {
    model: &'a dyn Forward,
    basis: &'a Basis,
    trial: &'a Trial,
    folds: &'a [Vec<usize>],
    /// Columns of the Gram that predict: no form allowance.
    at: Vec<usize>,
    /// How far those may go that come first.
    reach: Vec<f64>,
    /// Solution without each fold.
    solutions: Vec<DVector<f64>>,
}

impl<'a> Scored<'a> {
    fn new(model: &'a dyn Forward, basis: &'a Basis, trial: &'a Trial, folds: &'a [Vec<usize>]) -> Self {
        let (shared, columns_used) = (trial.shared, scoring(model, trial));
        // No allowance has a reach.
        let reach: Vec<f64> = columns_used.iter().map_while(|i| trial.reach.get(*i).copied()).collect();
        let solutions = left_out_solutions(&trial.gram, &columns_used, shared, &reach);
        Self { model, basis, trial, folds, at: columns_used, reach, solutions }
    }

    fn linear(&self) -> &Linear {
        &self.trial.fit.linear
    }

    /// Column of the linearised model.
    fn column(&self, i: usize) -> &[f64] {
        let nuisance = self.linear().nuisance.len();
        if i < nuisance { &self.linear().nuisance[i] } else { &self.linear().effects[i - self.trial.shared] }
    }

    fn left_out(&self) -> LeftOut {
        let measured = &self.model.frame().measured;
        let mut left = offset_residual(self.model, self.linear(), &self.trial.fit.active);
        // Groups outside the fit are predicted by the fit to all that is inside.
        let whole = solution(&self.trial.gram, &self.at, self.trial.shared, &self.reach);
        let mut fold_of = vec![None; measured.groups.len()];
        for (index, fold) in self.folds.iter().enumerate() {
            fold.iter().for_each(|group| fold_of[*group] = Some(index));
        }
        for (span, fold) in measured.spans.iter().zip(fold_of) {
            let solution = fold.map_or(&whole, |fold| &self.solutions[fold]);
            for (i, x) in self.at.iter().zip(solution.iter()) {
                let slope = self.column(*i);
                span.clone().for_each(|row| left[row] -= slope[row] * x);
            }
        }
        self.without_scatter(&mut left);
        LeftOut { residual: left, moves: Vec::new() }
    }

    /// One standard deviation of the jackknife along each fold.
    fn moves(&self) -> Vec<Vec<f64>> {
        let count = self.solutions.len() as f64;
        if count < 2.0 {
            return Vec::new();
        }
        let mean = self.solutions.iter().fold(DVector::zeros(self.at.len()), |sum, own| sum + own) / count;
        let scale = ((count - 1.0) / count).sqrt();
        let along = |own: &DVector<f64>| {
            let mut moved = vec![0.0; self.linear().residual.len()];
            for (i, x) in self.at.iter().zip((own - &mean).iter()) {
                moved.iter_mut().zip(self.column(*i)).for_each(|(moved, slope)| *moved -= scale * slope * x);
            }
            self.without_scatter(&mut moved);
            moved
        };
        self.solutions.par_iter().map(along).collect()
    }

    /// Takes what groups scatter by out of `left`.
    fn without_scatter(&self, left: &mut [f64]) {
        let frame = self.model.frame();
        let linear = self.linear();
        let factors = own_factors(self.model, &self.basis.noise, linear, left, &self.basis.local_scale);
        for ((column, x), _) in linear.locals.iter().zip(&factors).zip(&frame.locals).filter(|(_, local)| local.scatter)
        {
            let by_row = frame.measured.spans.iter().zip(x).flat_map(|(span, x)| span.clone().map(move |row| (row, x)));
            by_row.for_each(|(row, x)| left[row] -= column[row] * x);
        }
    }
}
