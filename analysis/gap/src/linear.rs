//! Predictions at a point and their derivatives.

use super::{Direction, Forward, Frame, Point, Transform};
use rayon::prelude::*;
use std::sync::Arc;
pub use toolroom_nominal::predict;
use toolroom_nominal::{correct, touches, transformed};

/// Columns of derivatives: many fits start from the same ones.
pub type Columns = Arc<Vec<Vec<f64>>>;

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
    pub nuisance: Columns,
    /// Derivatives by the sizes of the candidates, per ordinary size; empty where nobody asked.
    pub effects: Columns,
    /// Derivatives by the local factors, those of a kind in one column.
    pub locals: Columns,
}

impl Linear {
    /// Linearises `model` at `point`, with all candidates.
    pub fn new(model: &dyn Forward, point: Point) -> Self {
        let all: Vec<usize> = (0..model.frame().candidates.len()).collect();
        Self::with(model, point, &all)
    }

    /// Linearises `model` at `point`; of the candidates only those `wanted`.
    pub fn with(model: &dyn Forward, point: Point, wanted: &[usize]) -> Self {
        let simulated = model.simulate(&point);
        let mut raw = simulated.clone();
        let factor = correct(model, &point, &mut raw);
        let prediction = transformed(model, &raw);
        let (parameters, locals) = (model.frame().parameters.len(), model.frame().locals.len());
        let along: Vec<Direction> = (0..parameters)
            .map(Direction::Parameter)
            .chain(wanted.iter().map(|index| Direction::Effect(*index)))
            .chain((0..locals).map(Direction::Local))
            .collect();
        let mut columns = model.slopes(&point, &simulated, &along);
        let measured = &model.frame().measured;
        let scale: Vec<f64> = measured
            .observations
            .iter()
            .zip(&raw)
            .zip(factor)
            .map(|((observation, raw), factor)| match measured.channels[observation.channel].transform {
                Transform::Linear => factor,
                Transform::Log if *raw > f64::MIN_POSITIVE => factor / raw,
                Transform::Log => 0.0,
            })
            .collect();
        // Where wear runs away a slope may be beyond any number: it says nothing about a step, and one such number would
        // make all others unknown.
        columns.par_iter_mut().for_each(|column| {
            column.iter_mut().zip(&scale).for_each(|(slope, scale)| {
                let own = *slope * scale;
                *slope = if own.is_finite() { own } else { 0.0 };
            });
        });
        let locals = columns.split_off(parameters + wanted.len());
        let mut effects = vec![Vec::new(); model.frame().candidates.len()];
        wanted.iter().zip(columns.split_off(parameters)).for_each(|(index, column)| effects[*index] = column);
        let mut nuisance = columns;
        nuisance.extend(surface_columns(model, &raw));
        let [nuisance, effects, locals] = [nuisance, effects, locals].map(Arc::new);
        Self { residual: residual(model, &prediction), point, raw, nuisance, effects, locals }
    }
}

/// Transformed measurements less predictions.
pub(super) fn residual(model: &dyn Forward, prediction: &[f64]) -> Vec<f64> {
    let observations = &model.frame().measured.observations;
    observations.iter().zip(prediction).map(|(observation, prediction)| observation.value - prediction).collect()
}

fn surface_columns(model: &dyn Forward, raw: &[f64]) -> Vec<Vec<f64>> {
    let frame = model.frame();
    frame.surfaces.par_iter().map(|surface| surface_column(frame, surface, raw)).collect()
}

/// Derivative of the transformed predictions by a surface, per prior standard deviation; `raw` are the predictions.
pub(super) fn surface_column(frame: &Frame, surface: &super::Surface, raw: &[f64]) -> Vec<f64> {
    let measured = &frame.measured;
    let mut column = vec![0.0; raw.len()];
    for run in measured.runs.iter().filter(|run| touches(measured, surface, run)) {
        let transform = measured.channels[measured.observations[run.start].channel].transform;
        for i in run.clone() {
            let slope = surface.deviation * surface.feature[measured.observations[i].row];
            column[i] = match (transform, surface.absolute) {
                (Transform::Log, false) | (Transform::Linear, true) => slope,
                (Transform::Log, true) => slope / raw[i],
                (Transform::Linear, false) => slope * raw[i],
            };
        }
    }
    column
}
