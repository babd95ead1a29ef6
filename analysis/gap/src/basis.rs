//! Noise and scatter that every model of a diagnosis is judged by.

use super::fit::{Fit, fit, offset_residual};
use super::gram::{factor, part, part_column};
use super::{ChannelId, Forward, Gram, Linear, Measured, Method, Noise, Point, evidence, generic};
use rayon::prelude::*;

/// Factors on the scale of an estimated local scatter that are tried.
const SCALES: [f64; 6] = [0.15, 0.3, 0.5, 0.75, 1.1, 1.6];
/// Prior standard deviation of generic signatures in the saturated model, relative (assumption).
const GENERIC_PRIOR: f64 = 0.03;

/// Prior precision of the size of a candidate where all of them take part at once: a standard deviation of three
/// ordinary sizes (assumption).
pub(super) const CANDIDATE_PRECISION: f64 = 1.0 / 9.0;

/// The common ground of a diagnosis.
#[derive(Clone, Debug)]
pub struct Basis {
    /// Noise of every channel.
    pub noise: Noise,
    /// Factor on the prior standard deviation of each local factor.
    pub local_scale: Vec<f64>,
    /// What the saturated model leaves.
    pub floor: Vec<f64>,
    /// Parts of the method that take part.
    pub method: Method,
    /// The model linearised where fits start: at its nominal point, but where anything was measured
    /// for the wear of each edge, which is brought near its readings: an edge whose model has run away has no slope.
    pub nominal: Linear,
}

impl Basis {
    /// Noise from what a saturated model leaves: nuisance, all candidates, all generic signatures.
    /// `at` is the fit around which it is built.
    pub fn new(model: &dyn Forward, at: &Fit, before: &Self) -> Self {
        let measured = &model.frame().measured;
        let linear = &at.linear;
        let dictionary = generic::dictionary(model, linear);
        let calibration = linear.nuisance.iter().map(|column| (1.0, column.as_slice()));
        let effects = linear.effects.iter().map(|column| (CANDIDATE_PRECISION, column.as_slice()));
        let generic = dictionary.iter().map(|own| (GENERIC_PRIOR.powi(-2), own.column.as_slice()));
        let (prior, columns) = by_end(calibration.chain(effects).chain(generic).collect());
        let residual = offset_residual(model, linear, &at.active);
        let local_scale = scatter(model, linear, &before.noise, &residual);
        let gram =
            super::gram::normal_equations(measured, &before.noise, linear, &columns, &residual, &local_scale, &[]);
        let all: Vec<usize> = (0..columns.len()).collect();
        let mut ridge = part(&gram.total, &all, &all);
        all.iter().for_each(|i| ridge[(*i, *i)] += prior[*i]);
        let ridge = factor(ridge);
        let solution = ridge.solve(&part_column(&gram.total, &all, gram.last()));
        // Degrees of freedom used: the trace of ridge⁻¹ (ridge − prior).
        let inverse = ridge.inverse_diagonal();
        let used: f64 = prior.iter().zip(inverse.iter()).map(|(prior, inverse)| 1.0 - prior * inverse).sum();
        let mut left = residual;
        for (column, x) in columns.iter().zip(solution.iter()) {
            left.iter_mut().zip(*column).for_each(|(left, slope)| *left -= slope * x);
        }
        remove_locals(model, linear, &before.noise, &local_scale, &mut left);
        let fitted: usize = measured.fitted_groups().map(|group| measured.spans[group].len()).sum();
        let locals = measured.fitted_groups().count() * linear.locals.len();
        let freedom = 1.0 - (used + locals as f64) / fitted as f64;
        let mut noise = Noise::estimate(measured, &left, freedom, &before.noise);
        if !before.method.memory {
            noise.memory.fill(0.0);
            noise.weight.fill(1.0);
        }
        Self { noise, local_scale, floor: left, method: before.method, nominal: before.nominal.clone() }
    }

    /// The sensor sheet and the priors as they stand, wear of each edge brought near its readings.
    pub fn of_sheet(model: &dyn Forward, method: Method) -> Self {
        Self::unmeasured(model, method, Linear::new(model, warm(model, Point::nominal(model))))
    }

    /// The same for a design that is only planned: about `nominal`, since there are no readings to start near.
    pub fn unmeasured(model: &dyn Forward, method: Method, nominal: Linear) -> Self {
        Self {
            method,
            noise: Noise::of_sheet(&model.frame().measured, model.chains(&nominal.point)),
            local_scale: vec![1.0; model.frame().locals.len()],
            floor: vec![0.0; model.frame().measured.len()],
            nominal,
        }
    }

    /// The same with these factors on the sensors, by channel.
    #[must_use]
    pub(super) fn scaled(mut self, measured: &Measured, scale: &[f64]) -> Self {
        self.noise = self.noise.scaled(measured, scale);
        self
    }

    /// Fits the nominal model from the nominal point.
    pub fn start(&self, model: &dyn Forward) -> Fit {
        fit(model, &self.noise, self.nominal.clone(), &[], &self.local_scale).complete(model)
    }
}

/// Rounds in which the wear of edges is brought near its readings.
const WARMING: usize = 5;

/// `point` with the wear factor of every edge near what its last reading says.
pub(super) fn warm(model: &dyn Forward, mut point: Point) -> Point {
    let measured = &model.frame().measured;
    let kind = model.frame().locals.iter().position(|local| local.estimated);
    let wear = measured.channels.iter().position(|channel| channel.id == ChannelId::FlankWear);
    let (Some(kind), Some(wear)) = (kind, wear) else { return point };
    let deviation = model.frame().locals[kind].deviation;
    for _ in 0..WARMING {
        let raw = model.simulate(&point);
        for run in measured.runs.iter().filter(|run| measured.observations[run.start].channel == wear) {
            let last = run.end - 1;
            let observation = &measured.observations[last];
            if observation.value > 0.0 && raw[last] > 0.0 {
                let x = &mut point.locals[kind][measured.group_of_row[observation.row]];
                *x = (*x + 0.6 * (observation.value / raw[last]).ln() / deviation).clamp(-6.0, 6.0);
            }
        }
    }
    // An edge that such a factor makes run away has no prediction: it starts from the nominal point.
    let raw = model.simulate(&point);
    for (observation, raw) in measured.observations.iter().zip(&raw) {
        if !raw.is_finite() {
            point.locals[kind][measured.group_of_row[observation.row]] = 0.0;
        }
    }
    point
}

/// Columns with their prior precisions, those that end together side by side: most of a factor of their normal equations is
/// zero then.
fn by_end(mut columns: Vec<(f64, &[f64])>) -> (Vec<f64>, Vec<&[f64]>) {
    columns.sort_by_cached_key(|(_, column)| column.iter().rposition(|value| *value != 0.0));
    columns.into_iter().unzip()
}

/// Scatter of the estimated local factors, by the evidence of a model with all candidates.
fn scatter(model: &dyn Forward, linear: &Linear, noise: &Noise, residual: &[f64]) -> Vec<f64> {
    let measured = &model.frame().measured;
    let mut scale = vec![1.0; model.frame().locals.len()];
    let calibration = linear.nuisance.iter().map(|column| (1.0, column.as_slice()));
    let effects = linear.effects.iter().map(|column| (CANDIDATE_PRECISION, column.as_slice()));
    let (prior, columns) = by_end(calibration.chain(effects).collect());
    for kind in (0..scale.len()).filter(|kind| model.frame().locals[*kind].estimated) {
        let trials: Vec<Vec<f64>> = SCALES
            .iter()
            .map(|factor| scale.iter().enumerate().map(|(i, own)| if i == kind { *factor } else { *own }).collect())
            .collect();
        let grams = super::gram::at_scales(measured, noise, linear, &columns, residual, &trials);
        let weight = |(gram, factor): (&Gram, &f64)| evidence::marginal(gram, &prior) - 0.5 * factor * factor;
        let weights: Vec<f64> = grams.par_iter().zip(&SCALES).map(weight).collect();
        let best = (0..SCALES.len()).max_by(|a, b| weights[*a].total_cmp(&weights[*b])).unwrap_or(0);
        scale[kind] = SCALES[best];
    }
    scale
}

/// Takes the local factors that fit best out of `left`.
fn remove_locals(model: &dyn Forward, linear: &Linear, noise: &Noise, local_scale: &[f64], left: &mut [f64]) {
    let measured = &model.frame().measured;
    if linear.locals.is_empty() {
        return;
    }
    let white_left = noise.whiten(measured, left);
    let white: Vec<Vec<f64>> = linear.locals.iter().map(|column| noise.whiten(measured, column)).collect();
    for span in measured.spans.iter().filter(|span| !span.is_empty()) {
        let dot = |a: &[f64], b: &[f64]| span.clone().map(|i| a[i] * b[i]).sum::<f64>();
        let count = white.len();
        let mut matrix = nalgebra::DMatrix::from_fn(count, count, |i, j| dot(&white[i], &white[j]));
        for i in 0..count {
            matrix[(i, i)] += local_scale[i].powi(-2);
        }
        let right = nalgebra::DVector::from_fn(count, |i, _| dot(&white[i], &white_left));
        let solution = factor(matrix).solve(&right);
        for (column, x) in linear.locals.iter().zip(solution.iter()) {
            span.clone().for_each(|i| left[i] -= column[i] * x);
        }
    }
}
