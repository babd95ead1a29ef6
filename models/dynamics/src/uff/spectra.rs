//! Frequency responses from the spectra of a universal file.
//!
//! # Source
//! Estimators H1, H2, Hv and the coherence: J. S. Bendat, A. G. Piersol, Random Data, 4th edition (2010), chapter 6 (recalled).
//! The cross spectrum is that of response times conjugate force.

use super::function::{AUTO_SPECTRUM, COHERENCE, CROSS_SPECTRUM, FORCE, RESPONSE, motion};
use super::sets::{Function, Sets};
use crate::error::{DynamicsError, UniversalProblem};
use crate::hammer::Estimator;
use nalgebra::Complex;

/// Puts responses and coherence in the place of auto and cross spectra of `sets`; what it did, in notes.
///
/// # Errors
/// [`DynamicsError`]: a spectrum that is not there or has other frequencies.
pub(super) fn to_responses(sets: &mut Sets, estimator: Estimator) -> Result<Vec<String>, DynamicsError> {
    let all = std::mem::take(&mut sets.functions);
    let (autos, others): (Vec<_>, Vec<_>) = all.into_iter().partition(|function| function.kind == AUTO_SPECTRUM);
    let (crosses, others): (Vec<_>, Vec<_>) = others.into_iter().partition(|function| function.kind == CROSS_SPECTRUM);
    sets.functions = others;
    let mut notes = Vec::new();
    for cross in crosses {
        let Some(cross) = over_force(cross) else { continue };
        let missing = |name: &str| sets.fault(cross.line, UniversalProblem::Spectrum(name.to_owned()));
        let force = one(sets, &cross, &autos, cross.force, |ordinate| ordinate == FORCE)?;
        let response = one(sets, &cross, &autos, cross.response, |ordinate| motion(ordinate).is_some())?;
        if force.is_none() && (response.is_none() || estimator != Estimator::H2) {
            return Err(missing("force"));
        }
        if response.is_none() && estimator != Estimator::H1 {
            return Err(missing("response"));
        }
        let at = |auto: Option<&Function>, line: usize| auto.map(|auto| auto.values[line].re.max(f64::MIN_POSITIVE));
        let mut coherence = Vec::new();
        let values = cross.values.iter().enumerate().map(|(line, shared)| {
            let (force, response) = (at(force, line), at(response, line));
            if let (Some(force), Some(response)) = (force, response) {
                coherence.push(Complex::from(shared.norm_sqr() / (force * response)));
            }
            let h1 = force.map(|force| shared / force);
            // H2 has the phase of the cross spectrum too.
            let h2 = response.map(|response| shared * (response / shared.norm_sqr().max(f64::MIN_POSITIVE)));
            match (estimator, h1, h2) {
                (Estimator::H1, Some(h1), _) => h1,
                (Estimator::H2, _, Some(h2)) => h2,
                (Estimator::Hv, Some(h1), Some(h2)) => h1 * (h2.norm() / h1.norm().max(f64::MIN_POSITIVE)).sqrt(),
                (Estimator::H1 | Estimator::H2 | Estimator::Hv, ..) => {
                    unreachable!("the spectra that the estimator needs were looked for above")
                }
            }
        });
        let values = values.collect();
        notes.push(format!("line {}: the response is made of spectra ({estimator})", cross.line));
        if coherence.len() == cross.values.len() {
            sets.functions.push(Function { kind: COHERENCE, values: coherence, ..cross.clone() });
        }
        sets.functions.push(Function { kind: RESPONSE, values, ..cross });
    }
    Ok(notes)
}

/// A cross spectrum as that of response times conjugate force; none where it is of two responses.
fn over_force(cross: Function) -> Option<Function> {
    let [numerator, denominator] = cross.types;
    if motion(numerator).is_some() && matches!(denominator, FORCE | 0) {
        Some(Function { types: [numerator, FORCE], ..cross })
    } else if numerator == FORCE && motion(denominator).is_some() {
        let [force, response] = cross.labels;
        Some(Function {
            types: [denominator, numerator],
            labels: [response, force],
            response: cross.force,
            force: cross.response,
            values: cross.values.iter().map(Complex::conj).collect(),
            ..cross
        })
    } else {
        None
    }
}

/// The one auto spectrum in a direction of which the ordinate is `of` some type; none where there is none.
fn one<'a>(
    sets: &Sets,
    cross: &Function,
    autos: &'a [Function],
    direction: i64,
    of: impl Fn(i64) -> bool,
) -> Result<Option<&'a Function>, DynamicsError> {
    let found: Vec<&Function> =
        autos.iter().filter(|auto| auto.response.abs() == direction.abs() && of(auto.types[0])).collect();
    match found[..] {
        [] => Ok(None),
        [auto] if auto.frequencies == cross.frequencies => Ok(Some(auto)),
        [auto] => {
            let function = format!("the spectrum of line {}", auto.line);
            Err(DynamicsError::OtherFrequencies { file: sets.file.clone(), function })
        }
        [_, second, ..] => Err(sets.fault(second.line, UniversalProblem::TwoSpectra)),
    }
}
