//! Amplitudes of groups of columns by marginal likelihood.

use crate::{Gram, factor, part, part_column};
use std::ops::Range;

/// Amplitudes that are tried, in units of the scale of their half-normal prior.
const GRID: [f64; 6] = [0.0, 0.25, 0.5, 1.0, 2.0, 4.0];
/// Rounds through all groups of columns: each amplitude is chosen beside those of the others.
const ROUNDS: usize = 3;

/// Amplitudes of `classes` of columns and the log posterior density over that without them.
///
/// `precision` holds the prior precisions of the columns before the first class; the columns of a class have prior
/// standard deviation 1 at amplitude 1. The prior of an amplitude is half-normal with scale 1.
pub fn amplitudes(gram: &Gram, precision: &[f64], classes: &[Range<usize>]) -> (Vec<f64>, f64) {
    let mut chosen = vec![0.0; classes.len()];
    let none = posterior(gram, precision, classes, &chosen);
    let mut best = none;
    for _ in 0..ROUNDS {
        let before = chosen.clone();
        for class in 0..classes.len() {
            for value in GRID {
                let mut tried = chosen.clone();
                tried[class] = value;
                let density = posterior(gram, precision, classes, &tried);
                if density > best {
                    (chosen, best) = (tried, density);
                }
            }
        }
        if chosen == before {
            break;
        }
    }
    (chosen, best - none)
}

/// Log marginal likelihood with the prior of the amplitudes, beside constants.
fn posterior(gram: &Gram, precision: &[f64], classes: &[Range<usize>], amplitudes: &[f64]) -> f64 {
    let mut free: Vec<usize> = (0..precision.len()).collect();
    let mut prior = precision.to_vec();
    for (class, amplitude) in classes.iter().zip(amplitudes).filter(|(_, amplitude)| **amplitude > 0.0) {
        free.extend(class.clone());
        prior.resize(free.len(), amplitude.powi(-2));
    }
    let mut matrix = part(&gram.total, &free, &free);
    (0..free.len()).for_each(|i| matrix[(i, i)] += prior[i]);
    let right = part_column(&gram.total, &free, gram.last());
    let whole = factor(matrix);
    let explained = whole.square_by_inverse(&right);
    let logarithms: f64 = prior.iter().map(|precision| precision.ln()).sum();
    let scale: f64 = amplitudes.iter().map(|amplitude| amplitude * amplitude).sum();
    0.5 * (explained - whole.log_determinant() + logarithms - scale)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DMatrix;

    /// Orthonormal columns of which the residual holds `size` of the last ones: one calibration, a class of four.
    fn gram(size: f64) -> Gram {
        let residual = [0.7, size, -size, size, -size];
        let total = DMatrix::from_fn(6, 6, |i, j| match (i, j) {
            (5, 5) => residual.iter().map(|x| x * x).sum(),
            (5, i) | (i, 5) => residual[i],
            (i, j) => f64::from(u8::from(i == j)),
        });
        let lengths = total.diagonal();
        Gram { folds: Vec::new(), total, log_determinant: 0.0, lengths }
    }

    #[test]
    fn an_amplitude_is_that_of_what_the_columns_explain_and_zero_for_noise() {
        let classes = 1..5;
        let amplitudes_of = |size: f64| amplitudes(&gram(size), &[1.0], std::slice::from_ref(&classes));
        assert_eq!(amplitudes_of(0.9).0, [0.0]);
        // Of four values of 3, of which noise of 1 is a part, the amplitude is about √8; its prior draws to zero.
        let (chosen, gain) = amplitudes_of(3.0);
        assert_eq!(chosen, [2.0]);
        // ½ Σ (x² τ²/(1 + τ²) − ln(1 + τ²)) − ½ τ² with four columns.
        let exact = 0.5 * 4.0 * (9.0 * 4.0 / 5.0 - 5.0_f64.ln()) - 2.0;
        assert!((gain - exact).abs() < 1e-9, "{gain} {exact}");
    }
}
