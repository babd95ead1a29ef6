//! Frequency responses of a universal file, with the coherence that belongs to them.

use super::function::{COHERENCE, FORCE, RESPONSE, direction, motion};
use super::sets::{Function, Sets};
use super::spectra;
use crate::coherence::CoherenceTable;
use crate::error::{DynamicsError, UniversalProblem};
use crate::frf::{Frf, Measurement};
use crate::hammer::Estimator;
use crate::unit;
/// How far rounding can put a coherence beyond 0 … 1: one and a half of the last digit in the shortest format.
const ROUNDING: f64 = 1.5e-5;
/// Half of the last digit of a coherence in the shortest format of data set 58, `E13.5`.
const DIGIT: f64 = 0.5e-5;
/// The same in the format of double precision, `E20.12`.
const DOUBLE_DIGIT: f64 = 0.5e-11;

/// The frequency responses of a file: its functions of type 4 with their coherence (6), or, where it has none, what its auto (2)
/// and cross spectra (3) make.
///
/// # Errors
/// [`DynamicsError`]: no response, other units or frequencies, impossible values.
pub(super) fn measurement(mut sets: Sets, estimator: Estimator) -> Result<Measurement, DynamicsError> {
    let mut notes = Vec::new();
    if !sets.functions.iter().any(|function| function.kind == RESPONSE) {
        notes = spectra::to_responses(&mut sets, estimator)?;
    }
    let mut found: Vec<(Function, Frf)> = Vec::new();
    let (mut coherence, mut coherence_digit) = (Vec::new(), 0.0f64);
    for function in std::mem::take(&mut sets.functions) {
        match function.kind {
            RESPONSE => {
                let Some(frf) = response(&sets, &function)? else {
                    notes.push(format!("line {}: a response out of the plane of x and y is left out", function.line));
                    continue;
                };
                found.push((function, frf));
            }
            COHERENCE => {
                coherence_digit = coherence_digit.max(if function.double { DOUBLE_DIGIT } else { DIGIT });
                coherence.push(function);
            }
            kind => notes.push(format!(
                "line {}: a function of type {kind} is left out beside frequency responses (4) and their coherence (6)",
                function.line
            )),
        }
    }
    let Some(frequencies) = found.first().map(|(function, _)| function.frequencies.clone()) else {
        let file = sets.file;
        return Err(if notes.is_empty() {
            DynamicsError::Empty { file }
        } else {
            DynamicsError::LeftOut { file, notes: notes.join("; ") }
        });
    };
    for function in coherence {
        let same = |other: &&mut (Function, Frf)| {
            other.0.response.abs() == function.response.abs() && other.0.force.abs() == function.force.abs()
        };
        if let Some((_, frf)) = found.iter_mut().find(same) {
            if function.frequencies != frequencies {
                let function = format!("the coherence of {}", frf.name());
                return Err(DynamicsError::OtherFrequencies { file: sets.file, function });
            }
            frf.coherence = Some(function.values.iter().map(|value| rounded(value.re)).collect());
        }
    }
    for (function, frf) in &found {
        if function.frequencies != frequencies {
            return Err(DynamicsError::OtherFrequencies { file: sets.file, function: frf.name() });
        }
    }
    Measurement {
        source: sets.file,
        frequencies,
        functions: found.into_iter().map(|(_, frf)| frf).collect(),
        averages: None,
        coherence_digit,
        window_decay: 0.0,
        notes,
    }
    .checked()
}

/// A coherence without what rounding puts it beyond 0 … 1; what is more than that is refused with the rest.
fn rounded(value: f64) -> f64 {
    let near = value.clamp(0.0, 1.0);
    if (value - near).abs() <= ROUNDING { near } else { value }
}

/// The coherence (6) that a file holds of each pair of directions in the plane, over its frequencies (Hz).
///
/// # Errors
/// [`DynamicsError`]: no coherence, functions over different frequencies.
pub(super) fn coherence(sets: Sets) -> Result<CoherenceTable, DynamicsError> {
    let mut table: Option<CoherenceTable> = None;
    for function in sets.functions.into_iter().filter(|function| function.kind == COHERENCE) {
        let (Some(response), Some(force)) = (direction(function.response), direction(function.force)) else { continue };
        let digit = if function.double { DOUBLE_DIGIT } else { DIGIT };
        let values = function.values.iter().map(|value| rounded(value.re)).collect();
        let found = table.get_or_insert_with(|| CoherenceTable {
            source: sets.file.clone(),
            frequencies: function.frequencies.clone(),
            functions: Vec::new(),
            digit,
        });
        if found.frequencies != function.frequencies {
            let function = format!("the coherence of {response}{force}");
            return Err(DynamicsError::OtherFrequencies { file: sets.file, function });
        }
        found.functions.push(([response, force], values));
    }
    table.ok_or(DynamicsError::NoCoherence { file: sets.file })
}

/// The response of a data set in SI; none where it leaves the plane.
fn response(sets: &Sets, function: &Function) -> Result<Option<Frf>, DynamicsError> {
    let [numerator, denominator] = function.types;
    let fault = |problem| sets.fault(function.line, problem);
    let motion = motion(numerator).filter(|_| denominator == FORCE);
    let motion = motion.ok_or_else(|| fault(UniversalProblem::Ordinate(numerator, denominator)))?;
    let [label, _] = &function.labels;
    let labelled = unit::motion(label).filter(|(_, other)| *other == motion);
    let factor = match (sets.units, labelled) {
        // Accelerations in multiples of gravity are written beside any units.
        (_, Some((factor, _))) if label == "g" => factor,
        (Some(units), _) => units.force / units.length,
        (None, Some((factor, _))) => factor,
        (None, None) => return Err(fault(UniversalProblem::Units(label.clone()))),
    };
    let (Some(response), Some(force)) = (direction(function.response), direction(function.force)) else {
        return Ok(None);
    };
    let sign = (function.response.signum() * function.force.signum()) as f64;
    let receptance = function.values.iter().map(|value| value * (factor * sign)).collect();
    Ok(Some(Frf { response, force, motion, receptance, coherence: None, noise: None }))
}
