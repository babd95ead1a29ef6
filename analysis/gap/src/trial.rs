//! Models that are tried: none, one or two effects, or a generic signature.

use super::basis::warm;
use super::evidence::{Evidence, Factored, evidence};
use super::fit::{Fit, fit, offset_residual};
use super::generic::{self, Signature};
use super::gram::{factor, part, part_column};
use super::score::{Scores, scores};
use super::{Basis, Candidate, Forward, Gram, Linear, tolerance};

/// Move of the factor of an edge, in prior standard deviations, from which a fit starts at the
/// ordinary size of an effect too.
const FAR_EDGE: f64 = 0.3;

/// Models with a few candidates more than a trial has, which share its factors and are not fitted anew.
pub struct Alternatives<'a> {
    trial: &'a Trial,
    factored: Factored<'a>,
}

impl Alternatives<'_> {
    /// Evidence of the model with these candidates, too.
    pub fn with(&self, candidates: &[usize]) -> Evidence {
        let Trial { shared, two_sided, .. } = self.trial;
        // Far from a size that fits, an effect that is not linear asks for more than it will be: no range holds yet.
        let range = |column: usize| [if two_sided[column - shared] { f64::NEG_INFINITY } else { 0.0 }, f64::INFINITY];
        let more: Vec<usize> = candidates.iter().map(|index| shared + index).collect();
        let active: Vec<usize> = self.trial.fit.active.iter().chain(candidates).copied().collect();
        self.trial.shaped(self.factored.with(&more, &range), &active)
    }
}

/// A model with some effects, fitted, with its evidence on groups left out.
#[derive(Clone, Debug)]
pub struct Trial {
    /// The fit.
    pub fit: Fit,
    /// Normal equations there: nuisance, form tolerance of the active candidates, all candidates,
    /// residual.
    pub gram: Gram,
    /// Columns of nuisance and form tolerance.
    pub shared: usize,
    /// Evidence.
    pub evidence: Evidence,
    /// How far calibration may go where groups are predicted that the fit has not seen, in prior standard deviations:
    /// parameters, then surfaces; what is beyond its end is free.
    pub reach: Vec<f64>,
    /// Whether the size of each candidate may have either sign.
    two_sided: Vec<bool>,
    /// Log likelihood by which the shape of readings asks for each candidate, beyond their means.
    shape: Vec<f64>,
}

impl Trial {
    /// The fit of the `active` candidates with its evidence.
    pub fn new(model: &dyn Forward, basis: &Basis, folds: &[Vec<usize>], start_fit: &Fit, active: &[usize]) -> Self {
        Self::of(model, basis, folds, Self::fitted(model, basis, start_fit, active).settled(model))
    }

    /// Fits the `active` candidates, starting where `start_fit` was fitted and, since a model without
    /// them may have gone far astray, from the nominal point.
    pub(super) fn fitted(model: &dyn Forward, basis: &Basis, start_fit: &Fit, active: &[usize]) -> Fit {
        let start = |linear: &Linear| fit(model, &basis.noise, linear.clone(), active, &basis.local_scale);
        let from_there = Self::without_others(model, &start_fit.linear, active);
        let (near, (far, sized)) = rayon::join(
            || start(&from_there),
            || rayon::join(|| start(&basis.nominal), || Self::from_size(model, basis, active)),
        );
        let fitted = [Some(near), Some(far), sized];
        let best = fitted.into_iter().flatten().min_by(|a, b| a.cost.total_cmp(&b.cost));
        best.unwrap_or_else(|| start_fit.clone())
    }

    /// `linear` without the effects that are not `active`: a fit moves no others, and one that was there before would stay.
    fn without_others(model: &dyn Forward, linear: &Linear, active: &[usize]) -> Linear {
        let mut point = linear.point.clone();
        let others = (0..point.effects.len()).filter(|index| !active.contains(index));
        others.for_each(|index| point.effects[index] = 0.0);
        if point == linear.point { linear.clone() } else { Linear::with(model, point, active) }
    }

    /// A fit from the ordinary size of the effects, where they move the wear of edges by so much that
    /// no slope at size zero leads there.
    fn from_size(model: &dyn Forward, basis: &Basis, active: &[usize]) -> Option<Fit> {
        let nominal = &basis.nominal.point;
        let mut point = nominal.clone();
        active.iter().for_each(|index| point.effects[*index] = model.frame().candidates[*index].typical);
        let point = warm(model, point);
        let moved = |(a, b): (&Vec<f64>, &Vec<f64>)| a.iter().zip(b).any(|(a, b)| (a - b).abs() > FAR_EDGE);
        if !point.locals.iter().zip(&nominal.locals).any(moved) {
            return None;
        }
        let start = Linear::with(model, point, active);
        Some(fit(model, &basis.noise, start, active, &basis.local_scale))
    }

    /// The same with derivatives by all candidates, as [`Trial::scores`] and [`Trial::alternatives`] need.
    #[must_use]
    pub fn complete(self, model: &dyn Forward, basis: &Basis, folds: &[Vec<usize>]) -> Self {
        Self::of(model, basis, folds, self.fit.complete(model))
    }

    /// The evidence of a finished fit.
    pub fn of(model: &dyn Forward, basis: &Basis, folds: &[Vec<usize>], fit: Fit) -> Self {
        let tolerance = tolerance(model, basis, &fit);
        let gram = gram(model, basis, &fit, &tolerance, &[], folds);
        let shared = fit.linear.nuisance.len() + tolerance.len();
        let columns_used = columns(shared, &fit.active);
        let candidates = &model.frame().candidates;
        let two_sided: Vec<bool> = candidates.iter().map(Candidate::two_sided).collect();
        let evidence = evidence(&gram, &columns_used, shared, &|column| {
            let own = &candidates[column - shared];
            [own.least, own.greatest].map(|end| end / own.typical)
        });
        let shape = (0..candidates.len()).map(|index| shape_lead(model, index)).collect();
        let trial = Self { fit, gram, shared, evidence, reach: Vec::new(), two_sided, shape };
        let evidence = trial.shaped(trial.evidence.clone(), &trial.fit.active);
        Self { evidence, ..trial }
    }

    /// The evidence of a model with the candidates `active`, by the shape of readings as well as by their means.
    fn shaped(&self, evidence: Evidence, active: &[usize]) -> Evidence {
        let shape = active.iter().map(|index| self.shape[*index]).fold(0.0, f64::max);
        Evidence { profile: evidence.profile + shape, ..evidence }
    }

    /// The same with calibration no farther than `reach` where groups left out are predicted.
    #[must_use]
    pub fn within(self, reach: Vec<f64>) -> Self {
        Self { reach, ..self }
    }

    /// The models with more candidates, of which the evidence is asked for.
    pub fn alternatives(&self) -> Alternatives<'_> {
        let factored = Factored::new(&self.gram, &columns(self.shared, &self.fit.active), self.shared);
        Alternatives { trial: self, factored }
    }

    /// Scores of all candidates beside those that are active.
    pub fn scores(&self) -> Scores {
        let nuisance = self.shared;
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

    /// How strongly the data ask for each candidate in a sign that it may have, in standard deviations.
    pub fn strengths(&self) -> Vec<f64> {
        let sided = self.two_sided.iter().zip(self.scores().score);
        sided.map(|(two_sided, score)| if *two_sided { score.abs() } else { score }).collect()
    }

    /// Share of what calibration leaves of the signature of `candidate` that the form allowance takes.
    pub fn imitated(&self, model: &dyn Forward, candidate: usize) -> f64 {
        let allowance = model.frame().allowances();
        let calibration: Vec<usize> = (0..allowance.len()).filter(|i| !allowance[*i]).collect();
        let both: Vec<usize> = (0..allowance.len()).collect();
        let column = self.shared + candidate;
        let total = &self.gram.total;
        let left = |nuisance: &[usize]| {
            let mut matrix = part(total, nuisance, nuisance);
            (0..nuisance.len()).for_each(|i| matrix[(i, i)] += 1.0);
            let cross = part_column(total, nuisance, column);
            total[(column, column)] - factor(matrix).square_by_inverse(&cross)
        };
        let before = left(&calibration);
        if before > 0.0 { 1.0 - left(&both) / before } else { 1.0 }
    }

    /// Standard error of each active size over groups left out, in ordinary sizes.
    pub fn jackknife(&self) -> Vec<f64> {
        let nuisance = self.shared;
        let columns_used = columns(nuisance, &self.fit.active);
        let solutions = super::evidence::left_out_solutions(&self.gram, &columns_used, nuisance, &[]);
        let count = solutions.len() as f64;
        let error = |i: usize| {
            let mean = solutions.iter().map(|solution| solution[i]).sum::<f64>() / count;
            let squares: f64 = solutions.iter().map(|solution| (solution[i] - mean).powi(2)).sum();
            ((count - 1.0) / count * squares).sqrt()
        };
        (nuisance..columns_used.len()).map(error).collect()
    }

    /// Sizes of the active candidates, in ordinary sizes.
    pub fn sizes(&self, model: &dyn Forward) -> Vec<f64> {
        let size = |index: &usize| self.fit.linear.point.effects[*index] / model.frame().candidates[*index].typical;
        self.fit.active.iter().map(size).collect()
    }

    /// Posterior standard deviation of each active size, in ordinary sizes.
    pub fn deviations(&self) -> Vec<f64> {
        self.posterior().split_off(self.shared)
    }

    /// Posterior standard deviation of each parameter, then of each surface, in prior standard deviations.
    pub fn uncertainties(&self) -> Vec<f64> {
        let mut all = self.posterior();
        all.truncate(self.fit.linear.nuisance.len());
        all
    }

    /// Posterior standard deviations of nuisance, form tolerance and active sizes.
    fn posterior(&self) -> Vec<f64> {
        let nuisance = self.shared;
        let columns_used = columns(nuisance, &self.fit.active);
        let mut matrix = part(&self.gram.total, &columns_used, &columns_used);
        for i in 0..columns_used.len() {
            matrix[(i, i)] += if i < nuisance { 1.0 } else { super::evidence::EFFECT_PRIOR.powi(-2) };
        }
        factor(matrix).inverse_diagonal().iter().map(|variance| variance.sqrt()).collect()
    }
}

/// Log likelihood by which the shape of readings asks for a candidate, beyond their means.
pub(super) fn shape_lead(model: &dyn Forward, candidate: usize) -> f64 {
    model.frame().shape_leads.get(candidate).copied().unwrap_or(0.0)
}

/// Columns of nuisance and of the candidates `active` in a Gram of [`gram`].
pub(crate) fn columns(shared: usize, active: &[usize]) -> Vec<usize> {
    (0..shared).chain(active.iter().map(|index| shared + index)).collect()
}

/// How the active candidates of a fit may differ from their functions.
fn tolerance(model: &dyn Forward, basis: &Basis, fit: &Fit) -> Vec<Vec<f64>> {
    if !basis.method.tolerance {
        return Vec::new();
    }
    let size = |index: &usize| fit.linear.point.effects[*index] / model.frame().candidates[*index].typical;
    let sizes: Vec<f64> = fit.active.iter().map(size).collect();
    tolerance::columns(model, &fit.linear, &fit.active, &sizes)
}

/// Normal equations of nuisance, form tolerance, all candidates and `more` columns, also by `folds`.
pub(crate) fn gram(
    model: &dyn Forward,
    basis: &Basis,
    fit: &Fit,
    tolerance: &[Vec<f64>],
    more: &[&[f64]],
    folds: &[Vec<usize>],
) -> Gram {
    let linear = &fit.linear;
    // A candidate whose derivative nobody asked for is as one that cannot be seen.
    let none = vec![0.0; linear.raw.len()];
    let effects = linear.effects.iter().map(|column| if column.is_empty() { &none } else { column });
    let fitted = linear.nuisance.iter().chain(tolerance).chain(effects).map(Vec::as_slice);
    let columns: Vec<&[f64]> = fitted.chain(more.iter().copied()).collect();
    let residual = offset_residual(model, linear, &fit.active);
    super::gram::normal_equations(
        &model.frame().measured,
        &basis.noise,
        linear,
        &columns,
        &residual,
        &basis.local_scale,
        folds,
    )
}

fn rearranged(gram: &Gram, order: &[usize]) -> Gram {
    Gram {
        folds: Vec::new(),
        total: part(&gram.total, order, order),
        log_determinant: gram.log_determinant,
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
    let tolerance = tolerance(model, basis, fit);
    let nuisance = fit.linear.nuisance.len() + tolerance.len();
    let active = fit.active.iter().map(|index| &fit.linear.effects[*index]);
    let fitted = fit.linear.nuisance.iter().chain(&tolerance).chain(active);
    let mut columns: Vec<&[f64]> = fitted.map(Vec::as_slice).collect();
    let first = columns.len();
    columns.extend(dictionary.iter().map(|signature| signature.column.as_slice()));
    let residual = offset_residual(model, &fit.linear, &fit.active);
    let gram = |columns: &[&[f64]], folds: &[Vec<usize>]| {
        let measured = &model.frame().measured;
        super::gram::normal_equations(
            measured,
            &basis.noise,
            &fit.linear,
            columns,
            &residual,
            &basis.local_scale,
            folds,
        )
    };
    let free: Vec<usize> = (nuisance..first).collect();
    let scores = scores(&gram(&columns, &[]), first, &free);
    let threshold = super::score::max_null(&scores.cosine, false, basis.method.processes, seed);
    let strongest =
        (0..dictionary.len()).max_by(|a, b| scores.score[*a].abs().total_cmp(&scores.score[*b].abs())).unwrap_or(0);
    columns = columns[..first].iter().copied().chain(columns.get(first + strongest).copied()).collect();
    let all_columns: Vec<usize> = (0..columns.len()).collect();
    let evidence = evidence(&gram(&columns, folds), &all_columns, nuisance, &|_| [f64::NEG_INFINITY, f64::INFINITY]);
    Remainder { dictionary, scores, threshold, strongest, evidence }
}
