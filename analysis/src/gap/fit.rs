//! Maximum a posteriori fit of calibration, allowance, local factors and chosen effects.

use super::gram::{factor, part, part_column};
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
/// Prior standard deviation of an effect, in ordinary sizes: all but flat.
pub(crate) const EFFECT_PRIOR: f64 = 20.0;

/// A fitted model, linearised where it was fitted.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The model at its fit.
    pub linear: Linear,
    /// Candidates that take part.
    pub active: Vec<usize>,
    /// Half the sum of squares of noise and priors.
    pub cost: f64,
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
    let group_of = model.frame().measured.group_of();
    for (column, x) in linear.locals.iter().zip(&point.locals) {
        for ((residual, slope), group) in residual.iter_mut().zip(column).zip(&group_of) {
            *residual += slope * x[*group];
        }
    }
    residual
}

/// Fits nuisance and the `active` candidates from `start`; `local_scale` as in [`Gram::new`].
pub fn fit(model: &dyn Forward, noise: &Noise, start: Linear, active: &[usize], local_scale: &[f64]) -> Fit {
    let mut linear = start;
    let mut cost = objective(model, noise, &linear, local_scale);
    // Whether the derivatives are those of the present point.
    let mut fresh = true;
    for _ in 0..ROUNDS {
        let target = step(model, noise, &linear, active, local_scale);
        let moved = distance(model, &linear.point, &target);
        let mut share = 1.0;
        let mut accepted = None;
        while share > 0.05 {
            let trial = linear.moved(model, between(&linear.point, &target, share));
            let trial_cost = objective(model, noise, &trial, local_scale);
            if trial_cost <= cost + 1e-9 * cost.abs() {
                accepted = Some((trial, trial_cost));
                break;
            }
            share *= 0.4;
        }
        let Some((trial, trial_cost)) = accepted else {
            if fresh {
                break;
            }
            linear = Linear::new(model, linear.point);
            fresh = true;
            continue;
        };
        let gained = cost - trial_cost;
        linear = trial;
        cost = trial_cost;
        let had_fresh = std::mem::replace(&mut fresh, false);
        // Near moves do with the old derivatives; far ones need new ones.
        if moved < STILL || gained < LITTLE {
            if had_fresh {
                break;
            }
            linear = Linear::new(model, linear.point);
            fresh = true;
        } else if moved > FAR {
            linear = Linear::new(model, linear.point);
            fresh = true;
        }
    }
    let linear = if fresh { linear } else { Linear::new(model, linear.point) };
    Fit { linear, active: active.to_vec(), cost }
}

/// Half the sum of squares of noise and priors.
fn objective(model: &dyn Forward, noise: &Noise, linear: &Linear, local_scale: &[f64]) -> f64 {
    let measured = &model.frame().measured;
    let white = noise.whiten(measured, &linear.residual);
    let group_of = measured.group_of();
    let data: f64 = white.iter().zip(&group_of).filter(|(_, group)| measured.fitted[**group]).map(|(w, _)| w * w).sum();
    let point = &linear.point;
    let shared: f64 = point.parameters.iter().chain(&point.surfaces).map(|x| x * x).sum();
    let local: f64 =
        point.locals.iter().zip(local_scale).map(|(x, scale)| x.iter().map(|x| (x / scale).powi(2)).sum::<f64>()).sum();
    0.5 * (data + shared + local)
}

/// The point that minimises the linearised objective; sizes stay within their range.
fn step(model: &dyn Forward, noise: &Noise, linear: &Linear, active: &[usize], local_scale: &[f64]) -> Point {
    let measured = &model.frame().measured;
    let residual = offset_residual(model, linear, active);
    let mut free: Vec<usize> = active.to_vec();
    loop {
        let columns: Vec<&[f64]> = linear
            .nuisance
            .iter()
            .map(Vec::as_slice)
            .chain(free.iter().map(|index| linear.effects[*index].as_slice()))
            .collect();
        let gram = Gram::new(measured, noise, linear, &columns, &residual, local_scale);
        let nuisance = linear.nuisance.len();
        let solution = solve(&gram, nuisance, columns.len());
        if let Some(negative) = (0..free.len()).find(|i| solution[nuisance + i] < 0.0) {
            free.remove(negative);
            continue;
        }
        let mut point = linear.point.clone();
        let parameters = point.parameters.len();
        point.parameters.copy_from_slice(&solution.as_slice()[..parameters]);
        point.surfaces.copy_from_slice(&solution.as_slice()[parameters..nuisance]);
        active.iter().for_each(|index| point.effects[*index] = 0.0);
        for (i, index) in free.iter().enumerate() {
            let candidate = &model.frame().candidates[*index];
            point.effects[*index] = (solution[nuisance + i] * candidate.typical).min(candidate.greatest);
        }
        point.locals = locals(model, noise, linear, &columns, &residual, &solution, local_scale);
        return point;
    }
}

/// Solution of the normal equations with the priors of nuisance and effects.
fn solve(gram: &Gram, nuisance: usize, size: usize) -> DVector<f64> {
    let at: Vec<usize> = (0..size).collect();
    let mut matrix = part(&gram.total, &at, &at);
    for i in 0..size {
        matrix[(i, i)] += if i < nuisance { 1.0 } else { EFFECT_PRIOR.powi(-2) };
    }
    factor(matrix).solve(&part_column(&gram.total, &at, gram.last()))
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

fn between(from: &Point, to: &Point, share: f64) -> Point {
    let mix = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a + share * (b - a)).collect::<Vec<f64>>();
    Point {
        parameters: mix(&from.parameters, &to.parameters),
        surfaces: mix(&from.surfaces, &to.surfaces),
        effects: mix(&from.effects, &to.effects),
        locals: from.locals.iter().zip(&to.locals).map(|(a, b)| mix(a, b)).collect(),
    }
}

/// Greatest move of a shared number, in prior standard deviations or ordinary sizes.
fn distance(model: &dyn Forward, from: &Point, to: &Point) -> f64 {
    let greatest = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let effects = from.effects.iter().zip(&to.effects).zip(&model.frame().candidates);
    let effects = effects.map(|((a, b), candidate)| (a - b).abs() / candidate.typical).fold(0.0, f64::max);
    let locals = from.locals.iter().zip(&to.locals).map(|(a, b)| greatest(a, b)).fold(0.0, f64::max);
    greatest(&from.parameters, &to.parameters).max(effects).max(locals)
}
