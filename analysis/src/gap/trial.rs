//! Models that are tried: none, one or two effects, or a generic signature.

use super::evidence::{Evidence, evidence};
use super::fit::{Fit, fit, offset_residual};
use super::generic::{self, Signature};
use super::score::{Scores, scores};
use super::{Basis, Forward, Gram};

/// A model with some effects, fitted, with its evidence on groups left out.
#[derive(Clone, Debug)]
pub struct Trial {
    /// The fit.
    pub fit: Fit,
    /// Normal equations there: nuisance, all candidates, residual.
    pub gram: Gram,
    /// Evidence.
    pub evidence: Evidence,
}

impl Trial {
    /// Fits the `active` candidates, starting where `from` was fitted and, since a model without
    /// them may have gone far astray, from the nominal point.
    pub fn new(model: &dyn Forward, basis: &Basis, folds: &[Vec<usize>], from: &Fit, active: &[usize]) -> Self {
        let near = fit(model, &basis.noise, from.linear.clone(), active, &basis.local_scale);
        let far = fit(model, &basis.noise, basis.nominal.clone(), active, &basis.local_scale);
        Self::of(model, basis, folds, if near.cost <= far.cost { near } else { far })
    }

    /// The same with derivatives by all candidates, as [`Trial::scores`] and [`Trial::with`] need.
    #[must_use]
    pub fn complete(self, model: &dyn Forward, basis: &Basis, folds: &[Vec<usize>]) -> Self {
        Self::of(model, basis, folds, self.fit.complete(model))
    }

    /// The evidence of a finished fit.
    pub fn of(model: &dyn Forward, basis: &Basis, folds: &[Vec<usize>], fit: Fit) -> Self {
        let gram = gram(model, basis, &fit, &[]);
        let at = columns(&fit, &fit.active);
        let evidence = evidence(&gram, folds, &at, fit.linear.nuisance.len(), false);
        Self { fit, gram, evidence }
    }

    /// Evidence of the same model with one more candidate, without a new fit.
    pub fn with(&self, folds: &[Vec<usize>], candidate: usize) -> Evidence {
        let mut active = self.fit.active.clone();
        active.push(candidate);
        evidence(&self.gram, folds, &columns(&self.fit, &active), self.fit.linear.nuisance.len(), false)
    }

    /// Scores of all candidates beside those that are active.
    pub fn scores(&self) -> Scores {
        let nuisance = self.fit.linear.nuisance.len();
        let count = self.fit.linear.effects.len();
        // Active candidates become nuisance: they move to the front.
        let order: Vec<usize> = (0..nuisance)
            .chain(self.fit.active.iter().map(|index| nuisance + index))
            .chain((0..count).map(|index| nuisance + index))
            .chain([self.gram.last()])
            .collect();
        let first = nuisance + self.fit.active.len();
        let free: Vec<usize> = (nuisance..first).collect();
        scores(&rearranged(&self.gram, &order), first, &free)
    }

    /// Standard error of each active size over groups left out, in ordinary sizes.
    pub fn jackknife(&self, folds: &[Vec<usize>]) -> Vec<f64> {
        let nuisance = self.fit.linear.nuisance.len();
        let at = columns(&self.fit, &self.fit.active);
        let solutions = super::evidence::left_out_solutions(&self.gram, folds, &at, nuisance);
        let count = solutions.len() as f64;
        let error = |i: usize| {
            let mean = solutions.iter().map(|solution| solution[i]).sum::<f64>() / count;
            let squares: f64 = solutions.iter().map(|solution| (solution[i] - mean).powi(2)).sum();
            ((count - 1.0) / count * squares).sqrt()
        };
        (nuisance..at.len()).map(error).collect()
    }

    /// Sizes of the active candidates, in ordinary sizes.
    pub fn sizes(&self, model: &dyn Forward) -> Vec<f64> {
        let size = |index: &usize| self.fit.linear.point.effects[*index] / model.frame().candidates[*index].typical;
        self.fit.active.iter().map(size).collect()
    }

    /// Posterior standard deviation of each active size, in ordinary sizes.
    pub fn deviations(&self) -> Vec<f64> {
        let nuisance = self.fit.linear.nuisance.len();
        let at = columns(&self.fit, &self.fit.active);
        let mut matrix = super::gram::part(&self.gram.total, &at, &at);
        for i in 0..at.len() {
            matrix[(i, i)] += if i < nuisance { 1.0 } else { super::fit::EFFECT_PRIOR.powi(-2) };
        }
        let inverse = super::gram::factor(matrix).inverse();
        (nuisance..at.len()).map(|i| inverse[(i, i)].sqrt()).collect()
    }
}

/// Columns of nuisance and of the candidates `active` in a Gram of [`gram`].
pub(crate) fn columns(fit: &Fit, active: &[usize]) -> Vec<usize> {
    let nuisance = fit.linear.nuisance.len();
    (0..nuisance).chain(active.iter().map(|index| nuisance + index)).collect()
}

/// Normal equations of nuisance, all candidates and `more` columns.
pub(crate) fn gram(model: &dyn Forward, basis: &Basis, fit: &Fit, more: &[&[f64]]) -> Gram {
    let linear = &fit.linear;
    // A candidate whose derivative nobody asked for is as one that cannot be seen.
    let none = vec![0.0; linear.raw.len()];
    let effects = linear.effects.iter().map(|column| if column.is_empty() { &none } else { column });
    let own = linear.nuisance.iter().chain(effects).map(Vec::as_slice);
    let columns: Vec<&[f64]> = own.chain(more.iter().copied()).collect();
    let residual = offset_residual(model, linear, &fit.active);
    Gram::new(&model.frame().measured, &basis.noise, linear, &columns, &residual, &basis.local_scale)
}

fn rearranged(gram: &Gram, order: &[usize]) -> Gram {
    Gram {
        groups: Vec::new(),
        matrices: Vec::new(),
        log_determinants: Vec::new(),
        total: super::gram::part(&gram.total, order, order),
        lengths: nalgebra::DVector::from_fn(order.len(), |i, _| gram.lengths[order[i]]),
    }
}

/// What the generic dictionary finds beside a fitted model.
pub struct Remainder {
    /// The signatures.
    pub dictionary: Vec<Signature>,
    /// Their scores.
    pub scores: Scores,
    /// Greatest score that chance gives in one of a hundred data sets.
    pub threshold: f64,
    /// The strongest signature and its evidence beside the model.
    pub strongest: usize,
    /// Evidence of the model with the strongest signature.
    pub evidence: Evidence,
}

/// Looks beside `trial` with the generic dictionary.
pub fn remainder(model: &dyn Forward, basis: &Basis, folds: &[Vec<usize>], trial: &Trial, seed: u64) -> Remainder {
    let fit = &trial.fit;
    let dictionary = generic::dictionary(model, &fit.linear);
    let more: Vec<&[f64]> = dictionary.iter().map(|signature| signature.column.as_slice()).collect();
    let active: Vec<&[f64]> = fit.active.iter().map(|index| fit.linear.effects[*index].as_slice()).collect();
    let nuisance = fit.linear.nuisance.len();
    let columns: Vec<&[f64]> =
        fit.linear.nuisance.iter().map(Vec::as_slice).chain(active.iter().copied()).chain(more).collect();
    let residual = offset_residual(model, &fit.linear, &fit.active);
    let wide = Gram::new(&model.frame().measured, &basis.noise, &fit.linear, &columns, &residual, &basis.local_scale);
    let first = nuisance + active.len();
    let free: Vec<usize> = (nuisance..first).collect();
    let scores = scores(&wide, first, &free);
    let threshold = super::score::max_null(&scores.cosine, false, seed);
    let strongest =
        (0..dictionary.len()).max_by(|a, b| scores.score[*a].abs().total_cmp(&scores.score[*b].abs())).unwrap_or(0);
    let at: Vec<usize> =
        if dictionary.is_empty() { (0..first).collect() } else { (0..first).chain([first + strongest]).collect() };
    let evidence = evidence(&wide, folds, &at, nuisance, true);
    Remainder { dictionary, scores, threshold, strongest, evidence }
}
