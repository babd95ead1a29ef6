//! Predictions at a point: what is simulated, corrected by the surfaces.

use super::{Forward, Measured, Observation, Point, Surface, Transform};
use std::ops::Range;

/// Transformed predictions and raw ones, SI.
pub fn predict(model: &dyn Forward, point: &Point) -> (Vec<f64>, Vec<f64>) {
    let mut raw = model.simulate(point);
    correct(model, point, &mut raw);
    (transformed(model, &raw), raw)
}

/// Raw values as they are compared.
pub fn transformed(model: &dyn Forward, raw: &[f64]) -> Vec<f64> {
    let measured = &model.frame().measured;
    let each = |(raw, observation): (&f64, &Observation)| match measured.channels[observation.channel].transform {
        Transform::Linear => *raw,
        Transform::Log => raw.max(f64::MIN_POSITIVE).ln(),
    };
    raw.iter().zip(&measured.observations).map(each).collect()
}

/// Applies the surfaces to what was simulated; the factor on each value.
pub fn correct(model: &dyn Forward, point: &Point, raw: &mut [f64]) -> Vec<f64> {
    let measured = &model.frame().measured;
    let mut relative = vec![0.0; raw.len()];
    let mut absolute = vec![0.0; raw.len()];
    for (surface, x) in model.frame().surfaces.iter().zip(&point.surfaces) {
        if *x == 0.0 {
            continue;
        }
        let sum = if surface.absolute { &mut absolute } else { &mut relative };
        for run in measured.runs.iter().filter(|run| touches(measured, surface, run)) {
            for (observation, sum) in measured.observations[run.clone()].iter().zip(&mut sum[run.clone()]) {
                *sum += surface.deviation * x * surface.feature[observation.row];
            }
        }
    }
    relative.iter_mut().for_each(|relative| *relative = relative.exp());
    for ((raw, factor), absolute) in raw.iter_mut().zip(&relative).zip(absolute) {
        *raw = *raw * factor + absolute;
    }
    relative
}

/// Whether a surface moves a run of one channel.
pub fn touches(measured: &Measured, surface: &Surface, run: &Range<usize>) -> bool {
    surface.channels.contains(&measured.observations[run.start].channel)
}
