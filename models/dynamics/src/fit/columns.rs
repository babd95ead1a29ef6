//! Whether the columns of a measurement are what their names say.

use super::{Fit, FitOptions, as_told};
use crate::error::DynamicsError;
use crate::frf::Measurement;
use crate::quality::{GREATEST_RESIDUAL, Refusal};
use nalgebra::Complex;
use std::f64::consts::TAU;

/// A mistake that turns every response into something that no structure answers.
struct Mistake {
    /// What was meant by what is written, of a frequency (rad/s).
    meant: fn(f64, Complex<f64>) -> Complex<f64>,
    /// With what the fit succeeds, and what that says of the file.
    words: [&'static str; 2],
    /// Refusals that it explains.
    explains: fn(&Refusal) -> bool,
}

static MISTAKES: [Mistake; 3] = [
    Mistake {
        meant: |_, value| Complex::new(value.im, value.re),
        words: ["real and imaginary part exchanged", "the columns are named the wrong way round"],
        explains: |refusal| matches!(refusal, Refusal::EdgeOfRange { .. } | Refusal::SensorSign { .. }),
    },
    Mistake {
        meant: |_, value| value.conj(),
        words: ["the imaginary part of the other sign", "the phase is counted the other way"],
        explains: |refusal| matches!(refusal, Refusal::EdgeOfRange { .. }),
    },
    Mistake {
        meant: |frequency, value| -value / (frequency * frequency),
        words: [
            "every value divided by −w²",
            "it is acceleration over force, and its unit says displacement; stiffnesses tell nothing until the unit is right",
        ],
        explains: |refusal| matches!(refusal, Refusal::EdgeOfRange { .. } | Refusal::SensorSign { .. }),
    },
];

/// Greatest residual over the response of any function.
fn worst(fit: &Fit) -> f64 {
    fit.quality.residuals.iter().map(|(_, residual)| *residual).fold(0.0, f64::max)
}

/// What a fit leaves: its greatest residual, and its misfit over degrees of freedom where the noise is known.
fn left(fit: &Fit) -> (f64, Option<f64>) {
    (worst(fit), fit.quality.reduced_chi2)
}

/// Misfit over that of another fit at which it explains far more (assumption: half of the residuals).
const FAR_BETTER: f64 = 0.25;

/// The usual mistake about columns with which undone the fit leaves less than half of what may be left, and far less than `before`.
fn mistake(
    measured: &Measurement,
    options: &FitOptions,
    before: (f64, Option<f64>),
) -> Option<(&'static Mistake, String)> {
    MISTAKES.iter().find_map(|mistake| {
        let mut meant = measured.clone();
        for function in &mut meant.functions {
            for (value, frequency) in function.receptance.iter_mut().zip(&measured.frequencies) {
                *value = (mistake.meant)(TAU * frequency, *value);
            }
        }
        let (other, chi2) = left(&as_told(&meant, options).ok()?);
        let [how, so] = mistake.words;
        let better = match (chi2, before.1) {
            (Some(chi2), Some(before)) => chi2 < FAR_BETTER * before,
            (None, _) | (_, None) => other < 0.5 * before.0,
        };
        let words = || (mistake, format!("with {how} the fit leaves {:.1} % of the response: {so}", 100.0 * other));
        (better && other < 0.5 * GREATEST_RESIDUAL).then(words)
    })
}

/// Tells of a fit that leaves too much, or whose sensor seems turned around, whether one of the usual mistakes about columns was
/// made. What follows from it is then no refusal of its own.
pub(super) fn tell(measured: &Measurement, options: &FitOptions, found: &mut Fit) {
    let turned = found.quality.refusals.iter().any(|refusal| matches!(refusal, Refusal::SensorSign { .. }));
    let before = left(found);
    if before.0 <= GREATEST_RESIDUAL && !turned {
        return;
    }
    if let Some((mistake, words)) = mistake(measured, options, before) {
        if before.0 > GREATEST_RESIDUAL {
            found.quality.refusals.retain(|refusal| !(mistake.explains)(refusal));
        }
        found.quality.mistaken = Some(words);
    }
}

/// The error of a fit that finds no mode, with the mistake about columns that explains it.
pub(super) fn explained(measured: &Measurement, options: &FitOptions, error: DynamicsError) -> DynamicsError {
    if !matches!(error, DynamicsError::NoModes { .. }) {
        return error;
    }
    match mistake(measured, options, (GREATEST_RESIDUAL, None)) {
        Some((_, mistake)) => DynamicsError::Mistaken { file: measured.source.clone(), mistake },
        None => error,
    }
}
