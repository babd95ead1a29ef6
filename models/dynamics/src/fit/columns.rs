//! Whether the columns of a measurement are what their names say.

use super::{Fit, FitOptions, as_told};
use crate::frf::Measurement;
use crate::quality::{GREATEST_RESIDUAL, Refusal};
use nalgebra::Complex;

/// A mistake that turns every response into something that no structure answers.
struct Mistake {
    /// What was meant by what is written.
    meant: fn(Complex<f64>) -> Complex<f64>,
    /// With what the fit succeeds, and what that says of the file.
    words: [&'static str; 2],
    /// Refusals that it explains.
    explains: fn(&Refusal) -> bool,
}

const MISTAKES: [Mistake; 2] = [
    Mistake {
        meant: |value| Complex::new(value.im, value.re),
        words: ["real and imaginary part exchanged", "the columns are named the wrong way round"],
        explains: |refusal| matches!(refusal, Refusal::EdgeOfRange { .. } | Refusal::SensorSign { .. }),
    },
    Mistake {
        meant: |value| value.conj(),
        words: ["the imaginary part of the other sign", "the phase is counted the other way"],
        explains: |refusal| matches!(refusal, Refusal::EdgeOfRange { .. }),
    },
];

/// Tells of a fit that leaves too much whether one of the usual mistakes about columns was made: with it undone the fit leaves
/// less than half of what may be left. What follows from it is then no refusal of its own.
pub(super) fn tell(measured: &Measurement, options: &FitOptions, found: &mut Fit) {
    let worst = |fit: &Fit| fit.quality.residuals.iter().map(|(_, residual)| *residual).fold(0.0, f64::max);
    if worst(found) <= GREATEST_RESIDUAL {
        return;
    }
    for mistake in MISTAKES {
        let mut meant = measured.clone();
        for value in meant.functions.iter_mut().flat_map(|function| &mut function.receptance) {
            *value = (mistake.meant)(*value);
        }
        let Ok(other) = as_told(&meant, options) else { continue };
        if worst(&other) < 0.5 * GREATEST_RESIDUAL {
            let [how, so] = mistake.words;
            found.quality.refusals.retain(|refusal| !(mistake.explains)(refusal));
            found.quality.mistaken =
                Some(format!("with {how} the fit leaves {:.1} % of the response: {so}", 100.0 * worst(&other)));
            return;
        }
    }
}
