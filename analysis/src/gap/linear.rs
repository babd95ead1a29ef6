//! Predictions at a point and their derivatives.

use super::{Forward, Point, Transform};
use rayon::prelude::*;

/// Step of a difference, in prior standard deviations.
const STEP: f64 = 0.1;
/// Step of the size of an effect, in its ordinary size.
const EFFECT_STEP: f64 = 0.05;

/// A model linearised at a point: `residual(x) = residual − Σ columns · (x − point)`.
#[derive(Clone, Debug)]
pub struct Linear {
    /// Where.
    pub point: Point,
    /// Transformed measurement less prediction.
    pub residual: Vec<f64>,
    /// Raw predictions, SI, surfaces included.
    pub raw: Vec<f64>,
    /// Derivatives by parameters, then surfaces (prior standard deviations).
    pub nuisance: Vec<Vec<f64>>,
    /// Derivatives by the sizes of the candidates, per ordinary size; empty where nobody asked.
    pub effects: Vec<Vec<f64>>,
    /// Derivatives by the local factors, those of a kind in one column.
    pub locals: Vec<Vec<f64>>,
}

/// Transformed predictions and raw ones, SI.
pub fn predict(model: &dyn Forward, point: &Point) -> (Vec<f64>, Vec<f64>) {
    let mut raw = model.simulate(point);
    surfaces(model, point, &mut raw);
    (transformed(model, &raw), raw)
}

fn transformed(model: &dyn Forward, raw: &[f64]) -> Vec<f64> {
    let measured = &model.frame().measured;
    let each = |(raw, observation): (&f64, &super::Observation)| match measured.channels[observation.channel].transform
    {
        Transform::Linear => *raw,
        Transform::Log => raw.max(f64::MIN_POSITIVE).ln(),
    };
    raw.iter().zip(&measured.observations).map(each).collect()
}

fn surfaces(model: &dyn Forward, point: &Point, raw: &mut [f64]) {
    let measured = &model.frame().measured;
    let mut relative = vec![0.0; raw.len()];
    let mut absolute = vec![0.0; raw.len()];
    for (surface, x) in model.frame().surfaces.iter().zip(&point.surfaces) {
        if *x == 0.0 {
            continue;
        }
        let sum = if surface.absolute { &mut absolute } else { &mut relative };
        for (observation, sum) in measured.observations.iter().zip(sum) {
            if surface.channels.contains(&observation.channel) {
                *sum += surface.deviation * x * surface.feature[observation.row];
            }
        }
    }
    for ((raw, relative), absolute) in raw.iter_mut().zip(relative).zip(absolute) {
        *raw = *raw * relative.exp() + absolute;
    }
}

impl Linear {
    /// Residuals at `point` with the derivatives of `other`, which was taken not far away.
    pub fn moved(&self, model: &dyn Forward, point: Point) -> Self {
        let (prediction, raw) = predict(model, &point);
        let residual = residual(model, &prediction);
        Self { point, residual, raw, ..self.clone() }
    }

    /// Linearises `model` at `point` by forward differences, with all candidates.
    pub fn new(model: &dyn Forward, point: Point) -> Self {
        let all: Vec<usize> = (0..model.frame().candidates.len()).collect();
        Self::with(model, point, &all)
    }

    /// Linearises `model` at `point`; of the candidates only those `wanted`.
    pub fn with(model: &dyn Forward, point: Point, wanted: &[usize]) -> Self {
        let simulated = model.simulate(&point);
        let mut raw = simulated.clone();
        surfaces(model, &point, &mut raw);
        let prediction = transformed(model, &raw);
        let difference = |shifted: &Point, step: f64| -> Vec<f64> {
            let (there, _) = predict(model, shifted);
            there.iter().zip(&prediction).map(|(there, here)| (there - here) / step).collect()
        };
        let by_parameter = |i: usize| {
            let mut shifted = point.clone();
            shifted.parameters[i] += STEP;
            difference(&shifted, STEP)
        };
        let by_effect = |i: usize| {
            let mut shifted = point.clone();
            shifted.effects[i] += EFFECT_STEP * model.frame().candidates[i].typical;
            difference(&shifted, EFFECT_STEP)
        };
        let by_local = |i: usize| {
            let mut shifted = point.clone();
            shifted.locals[i].iter_mut().for_each(|x| *x += STEP);
            difference(&shifted, STEP)
        };
        let parameters = model.frame().parameters.len();
        let locals = model.frame().locals.len();
        let mut columns: Vec<Vec<f64>> = (0..parameters + wanted.len() + locals)
            .into_par_iter()
            .map(|i| match i {
                i if i < parameters => by_parameter(i),
                i if i < parameters + wanted.len() => by_effect(wanted[i - parameters]),
                i => by_local(i - parameters - wanted.len()),
            })
            .collect();
        let locals = columns.split_off(parameters + wanted.len());
        let mut effects = vec![Vec::new(); model.frame().candidates.len()];
        wanted.iter().zip(columns.split_off(parameters)).for_each(|(index, column)| effects[*index] = column);
        let mut nuisance = columns;
        nuisance.extend(surface_columns(model, &raw, &prediction));
        Self { residual: residual(model, &prediction), point, raw, nuisance, effects, locals }
    }
}

/// Transformed measurements less predictions.
fn residual(model: &dyn Forward, prediction: &[f64]) -> Vec<f64> {
    let observations = &model.frame().measured.observations;
    observations.iter().zip(prediction).map(|(observation, prediction)| observation.value - prediction).collect()
}

fn surface_columns(model: &dyn Forward, raw: &[f64], prediction: &[f64]) -> Vec<Vec<f64>> {
    let measured = &model.frame().measured;
    let column = |surface: &super::Surface| {
        let each = |(i, observation): (usize, &super::Observation)| {
            if !surface.channels.contains(&observation.channel) {
                return 0.0;
            }
            let slope = surface.deviation * surface.feature[observation.row];
            match (measured.channels[observation.channel].transform, surface.absolute) {
                (Transform::Log, false) | (Transform::Linear, true) => slope,
                (Transform::Log, true) => slope / raw[i],
                (Transform::Linear, false) => slope * prediction[i],
            }
        };
        measured.observations.iter().enumerate().map(each).collect()
    };
    model.frame().surfaces.iter().map(column).collect()
}
