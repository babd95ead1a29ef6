//! Records over time of a universal file: force and responses of a hammer test.

use super::function::{FORCE, TIME, direction, motion};
use super::sets::{Function, Sets};
use crate::error::{DynamicsError, RecordProblem, UniversalProblem};
use crate::frf::Direction;
use crate::record::{Channel, Record, Signal, even_rate};
use crate::unit;

/// Whether a file holds signals over time and nothing else that a response could be made of.
pub(super) fn only_time(sets: &Sets) -> bool {
    !sets.functions.is_empty() && sets.functions.iter().all(|function| function.kind == TIME)
}

/// The record that the functions of a file are together: every channel once, or, where every hit was stored by itself, as
/// often as there were hits, which then follow each other.
///
/// # Errors
/// [`DynamicsError`]: channels without units, out of the plane, of different lengths or rates, uneven time.
pub(super) fn record(sets: &Sets) -> Result<Record, DynamicsError> {
    let problem = |problem| DynamicsError::Record { file: sets.file.clone(), problem };
    let mut channels: Vec<(Channel, usize)> = Vec::new();
    let (mut rate, mut samples) = (None, None);
    for function in &sets.functions {
        let (signal, direction, factor) = meaning(sets, function)?;
        let found = even_rate(&function.frequencies).map_err(problem)?;
        let like = |known: f64| (known / found - 1.0).abs() < 1e-6;
        if rate.is_some_and(|rate| !like(rate)) || samples.is_some_and(|known| known != function.values.len()) {
            return Err(sets.fault(function.line, UniversalProblem::OtherTime));
        }
        (rate, samples) = (Some(rate.unwrap_or(found)), Some(function.values.len()));
        let values = function.values.iter().map(|value| value.re * factor);
        match channels.iter_mut().find(|(channel, _)| channel.signal == signal && channel.direction == direction) {
            Some((channel, hits)) => {
                channel.values.extend(values);
                *hits += 1;
            }
            None => channels.push((Channel { signal, direction, values: values.collect() }, 1)),
        }
    }
    let hits = channels.first().map_or(0, |(_, hits)| *hits);
    if let Some((_, other)) = channels.iter().find(|(_, other)| *other != hits) {
        return Err(problem(RecordProblem::Hits { one: hits, other: *other }));
    }
    let channels = channels.into_iter().map(|(channel, _)| channel).collect();
    Ok(Record { source: sets.file.clone(), rate: rate.unwrap_or(f64::NAN), channels })
}

/// Signal, direction and factor to SI, with its sign, of a function over time.
fn meaning(sets: &Sets, function: &Function) -> Result<(Signal, Direction, f64), DynamicsError> {
    let fault = |problem| sets.fault(function.line, problem);
    let ([ordinate, _], [label, _]) = (function.types, &function.labels);
    let direction = direction(function.response).ok_or_else(|| fault(UniversalProblem::OutOfPlane))?;
    let (signal, labelled, scale) = if ordinate == FORCE {
        (Signal::Force, unit::force(label), sets.units.map(|units| units.force))
    } else {
        let motion = motion(ordinate).ok_or_else(|| fault(UniversalProblem::Signal(ordinate)))?;
        let labelled = unit::motion(label).filter(|(_, other)| *other == motion).map(|(factor, _)| factor);
        (Signal::Response(motion), labelled, sets.units.map(|units| units.length))
    };
    let factor = match (labelled, scale) {
        // Accelerations in multiples of gravity are written beside any units.
        (Some(factor), _) if label == "g" => factor,
        (_, Some(scale)) => 1.0 / scale,
        (Some(factor), None) => factor,
        (None, None) => return Err(fault(UniversalProblem::Units(label.clone()))),
    };
    Ok((signal, direction, factor * function.response.signum() as f64))
}
