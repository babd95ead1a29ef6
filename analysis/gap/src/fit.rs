//! Maximum a posteriori fit of calibration, allowance, local factors and chosen effects.

use super::evidence::{EFFECT_PRIOR, within};
use super::gram::{factor, part, part_column};
use super::linear::{predict, residual};
use super::{Forward, Gram, Linear, Noise, Point};
use nalgebra::DVector;

/// Rounds of Gauss and Newton after which a fit is taken as it is.
const ROUNDS: usize = 14;
/// Change in prior standard deviations below which a fit stands still.
const STILL: f64 = 0.02;
/// Gain below which a fit stands still.
const LITTLE: f64 = 0.05;
/// Move beyond which derivatives are taken anew.
const FAR: f64 = 0.5;
/// Damping of shared numbers that is tried, in prior precisions: none first, more where a model far
/// from linear makes the full step worse.
const DAMPING: [f64; 5] = [0.0, 1.0, 10.0, 100.0, 1000.0];
/// Shares of the undamped step that are tried where no damping helps: the direction still leads down.
const SHORTER: [f64; 3] = [0.5, 0.2, 0.05];
/// Greatest move of a group's own factor in a round, in prior standard deviations: an edge whose
/// model runs away has no slope that could bring it back.
const FARTHEST: f64 = 1.5;

/// A fitted model, linearised where it was fitted.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The model at its fit.
    pub linear: Linear,
    /// Candidates that take part.
    pub active: Vec<usize>,
    /// Half the sum of squares of noise and priors.
    pub cost: f64,
    /// Whether the derivatives are still those of another point: many a fit is compared by its cost only.
    stale: bool,
}

impl Fit {
    /// A model as it was linearised.
    pub(crate) fn at(linear: Linear, cost: f64) -> Self {
        Self { linear, active: Vec::new(), cost, stale: false }
    }

    /// The same with the derivatives of its own point by all that is active.
    pub(crate) fn settled(self, model: &dyn Forward) -> Self {
        if !self.stale {
            return self;
        }
        Self { linear: Linear::with(model, self.linear.point, &self.active), stale: false, ..self }
    }

    /// The same with the derivatives of groups whose own factors are usual. Those at the fitted factors follow the readings:
    /// an edge that wears fast has great slopes, and all that is unexplained of it counts by them. What a reading leaves is
    /// that of the fit.
    pub(crate) fn with_slopes_of_usual_groups(self, model: &dyn Forward) -> Self {
        let mut usual = self.linear.point.clone();
        usual.locals.iter_mut().flatten().for_each(|x| *x = 0.0);
        let Linear { nuisance, effects, locals, .. } = Linear::new(model, usual);
        Self { linear: Linear { nuisance, effects, locals, ..self.linear }, ..self }
    }

    /// The same with derivatives by all candidates.
    pub(crate) fn complete(self, model: &dyn Forward) -> Self {
        if !self.stale && self.linear.effects.iter().all(|column| !column.is_empty()) {
            return self;
        }
        Self { linear: Linear::new(model, self.linear.point), stale: false, ..self }
    }
}

/// Residual of the linearised model at the origin: what `columns · x` has to explain.
pub(crate) fn offset_residual(model: &dyn Forward, linear: &Linear, active: &[usize]) -> Vec<f64> {
    let mut residual = linear.residual.clone();
    let point = &linear.point;
    let mut add = |column: &[f64], x: f64| {
        if x != 0.0 {
            residual.iter_mut().zip(column).for_each(|(residual, slope)| *residual += slope * x);
        }
    };
    for (column, x) in linear.nuisance.iter().zip(point.parameters.iter().chain(&point.surfaces)) {
        add(column, *x);
    }
    for index in active {
        add(&linear.effects[*index], point.effects[*index] / model.frame().candidates[*index].typical);
    }
    for (column, x) in linear.locals.iter().zip(&point.locals) {
        for (span, x) in model.frame().measured.spans.iter().zip(x) {
            span.clone().for_each(|i| residual[i] += column[i] * x);
        }
    }
    residual
}

/// Fits nuisance and the `active` candidates from `start`; `local_scale` as in
/// [`normal_equations`](crate::normal_equations). Its derivatives are those of its point once it is `settled`, by what is
/// active, or `complete`.
pub fn fit(model: &dyn Forward, noise: &Noise, start: Linear, active: &[usize], local_scale: &[f64]) -> Fit {
    fit_within(model, noise, start, active, local_scale, &[])
}

/// [`fit`] with calibration and allowance no farther from nominal than `reach`, in prior standard deviations:
/// parameters, then surfaces; those beyond its end are free.
pub(super) fn fit_within(
    model: &dyn Forward,
    noise: &Noise,
    start: Linear,
    active: &[usize],
    local_scale: &[f64],
    reach: &[f64],
) -> Fit {
    let mut linear = start;
    if active.iter().any(|index| linear.effects[*index].is_empty()) {
        linear = Linear::with(model, linear.point, active);
    }
    let mut cost = objective(model, noise, &linear.point, &linear.residual, local_scale);
    // Whether the derivatives are those of the present point.
    let mut fresh = true;
    for _ in 0..ROUNDS {
        let accepted = {
            let normal = Normal::new(model, noise, &linear, active, local_scale);
            // Old derivatives are taken anew before a step is shortened.
            let shorter: &[f64] = if fresh { &SHORTER } else { &[] };
            let damped = DAMPING.iter().map(|damping| normal.step(*damping, reach));
            let shortened = shorter.iter().map(|share| towards(&linear.point, &normal.step(0.0, reach), *share));
            damped.chain(shortened).find_map(|target| {
                let moved = distance(model, &linear.point, &target);
                let (prediction, raw) = predict(model, &target);
                let residual = residual(model, &prediction);
                let trial_cost = objective(model, noise, &target, &residual, local_scale);
                (trial_cost <= cost + 1e-9 * cost.abs()).then_some((target, residual, raw, trial_cost, moved))
            })
        };
        let Some((target, residual, raw, trial_cost, moved)) = accepted else {
            if fresh {
                break;
            }
            linear = Linear::with(model, linear.point, active);
            fresh = true;
            continue;
        };
        let gained = cost - trial_cost;
        // Derivatives are those of a point not far away.
        linear = Linear { point: target, residual, raw, ..linear };
        cost = trial_cost;
        let had_fresh = std::mem::replace(&mut fresh, false);
        // Near moves do with the old derivatives; far ones need new ones.
        if moved < STILL || gained < LITTLE {
            if had_fresh {
                // The derivatives of a point as near as that are those of the fit.
                fresh = moved < STILL;
                break;
            }
            linear = Linear::with(model, linear.point, active);
            fresh = true;
        } else if moved > FAR {
            linear = Linear::with(model, linear.point, active);
            fresh = true;
        }
    }
    Fit { linear, active: active.to_vec(), cost, stale: !fresh }
}

/// The point at a share of the way from one to another.
fn towards(start: &Point, target: &Point, share: f64) -> Point {
    let part = |start: &[f64], target: &[f64]| {
        start.iter().zip(target).map(|(start, target)| start + share * (target - start)).collect()
    };
    Point {
        parameters: part(&start.parameters, &target.parameters),
        surfaces: part(&start.surfaces, &target.surfaces),
        effects: part(&start.effects, &target.effects),
        locals: start.locals.iter().zip(&target.locals).map(|(start, target)| part(start, target)).collect(),
    }
}

/// Half the sum of squares of noise and priors.
fn objective(model: &dyn Forward, noise: &Noise, point: &Point, residual: &[f64], local_scale: &[f64]) -> f64 {
    let measured = &model.frame().measured;
    let white = noise.whiten(measured, residual);
    let inside = measured.fitted_groups().flat_map(|group| &white[measured.spans[group].clone()]);
    let data: f64 = inside.map(|w| w * w).sum();
    let shared: f64 = point.parameters.iter().chain(&point.surfaces).map(|x| x * x).sum();
    let local: f64 =
        point.locals.iter().zip(local_scale).map(|(x, scale)| x.iter().map(|x| (x / scale).powi(2)).sum::<f64>()).sum();
    0.5 * (data + shared + local)
}

/// Normal equations of a linearised model over nuisance and active candidates.
struct Normal<'a> {
    model: &'a dyn Forward,
    noise: &'a Noise,
    linear: &'a Linear,
    active: &'a [usize],
    local_scale: &'a [f64],
    columns: Vec<&'a [f64]>,
    residual: Vec<f64>,
    gram: Gram,
}

impl<'a> Normal<'a> {
    fn new(
        model: &'a dyn Forward,
        noise: &'a Noise,
        linear: &'a Linear,
        active: &'a [usize],
        local_scale: &'a [f64],
    ) -> Self {
        let effects = active.iter().map(|index| linear.effects[*index].as_slice());
        let columns: Vec<&[f64]> = linear.nuisance.iter().map(Vec::as_slice).chain(effects).collect();
        let residual = offset_residual(model, linear, active);
        let gram = super::gram::normal_equations(
            &model.frame().measured,
            noise,
            linear,
            &columns,
            &residual,
            local_scale,
            &[],
        );
        Self { model, noise, linear, active, local_scale, columns, residual, gram }
    }

    /// The point that minimises the linearised objective, shared numbers held back by `damping`;
    /// sizes stay within their range, nuisance within its `reach`.
    fn step(&self, damping: f64, reach: &[f64]) -> Point {
        let candidates = &self.model.frame().candidates;
        let nuisance = self.linear.nuisance.len();
        let mut point = self.linear.point.clone();
        let sizes = self.active.iter().map(|index| point.effects[*index] / candidates[*index].typical);
        let here: Vec<f64> = point.parameters.iter().chain(&point.surfaces).copied().chain(sizes).collect();
        let mut free: Vec<usize> = (0..self.columns.len()).collect();
        let solution = loop {
            let mut matrix = part(&self.gram.total, &free, &free);
            let mut right = part_column(&self.gram.total, &free, self.gram.last());
            for (i, column) in free.iter().enumerate() {
                let prior = if *column < nuisance { 1.0 } else { EFFECT_PRIOR.powi(-2) };
                matrix[(i, i)] += prior + damping;
                right[i] += damping * here[*column];
            }
            let solution = within(&matrix, &right, reach);
            let two_sided = |i: usize| candidates[self.active[free[i] - nuisance]].two_sided();
            match (nuisance..free.len()).find(|i| solution[*i] < 0.0 && !two_sided(*i)) {
                Some(negative) => free.remove(negative),
                None => break solution,
            };
        };
        let parameters = point.parameters.len();
        point.parameters.copy_from_slice(&solution.as_slice()[..parameters]);
        point.surfaces.copy_from_slice(&solution.as_slice()[parameters..nuisance]);
        self.active.iter().for_each(|index| point.effects[*index] = 0.0);
        for (column, x) in free.iter().zip(solution.iter()).skip(nuisance) {
            let index = self.active[column - nuisance];
            let candidate = &candidates[index];
            point.effects[index] = (x * candidate.typical).min(candidate.greatest).max(candidate.least);
        }
        let columns: Vec<&[f64]> = free.iter().map(|column| self.columns[*column]).collect();
        let found = locals(self.model, self.noise, self.linear, &columns, &self.residual, &solution, self.local_scale);
        for (here, there) in point.locals.iter_mut().zip(found) {
            let near = |here: f64, there: f64| there.max(here - FARTHEST).min(here + FARTHEST);
            here.iter_mut().zip(there).for_each(|(here, there)| *here = near(*here, there));
        }
        point
    }
}

/// Local factors that each group's own readings ask for, given what everything else leaves of them.
pub(crate) fn own_factors(
    model: &dyn Forward,
    noise: &Noise,
    linear: &Linear,
    left: &[f64],
    local_scale: &[f64],
) -> Vec<Vec<f64>> {
    locals(model, noise, linear, &[], left, &DVector::zeros(0), local_scale)
}

/// Local factors given everything else, also of groups that were not fitted.
fn locals(
    model: &dyn Forward,
    noise: &Noise,
    linear: &Linear,
    columns: &[&[f64]],
    residual: &[f64],
    solution: &DVector<f64>,
    local_scale: &[f64],
) -> Vec<Vec<f64>> {
    let measured = &model.frame().measured;
    let mut left = residual.to_vec();
    for (column, x) in columns.iter().zip(solution.iter()) {
        left.iter_mut().zip(*column).for_each(|(left, slope)| *left -= slope * x);
    }
    let left = noise.whiten(measured, &left);
    let white: Vec<Vec<f64>> = linear.locals.iter().map(|column| noise.whiten(measured, column)).collect();
    let mut values = vec![vec![0.0; measured.groups.len()]; white.len()];
    if white.is_empty() {
        return values;
    }
    for (group, span) in measured.spans.iter().enumerate() {
        let dot = |a: &[f64], b: &[f64]| span.clone().map(|i| a[i] * b[i]).sum::<f64>();
        let mut matrix = nalgebra::DMatrix::from_fn(white.len(), white.len(), |i, j| dot(&white[i], &white[j]));
        for i in 0..white.len() {
            matrix[(i, i)] += local_scale[i].powi(-2);
        }
        let solution = factor(matrix).solve(&DVector::from_fn(white.len(), |i, _| dot(&white[i], &left)));
        values.iter_mut().zip(solution.iter()).for_each(|(values, x)| values[group] = *x);
    }
    values
}

/// Greatest move of a shared number, in prior standard deviations or ordinary sizes.
fn distance(model: &dyn Forward, start: &Point, target: &Point) -> f64 {
    let greatest = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let effects = start.effects.iter().zip(&target.effects).zip(&model.frame().candidates);
    let effects = effects.map(|((a, b), candidate)| (a - b).abs() / candidate.typical).fold(0.0, f64::max);
    let locals = start.locals.iter().zip(&target.locals).map(|(a, b)| greatest(a, b)).fold(0.0, f64::max);
    greatest(&start.parameters, &target.parameters).max(effects).max(locals)
}
