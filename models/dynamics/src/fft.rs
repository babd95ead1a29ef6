//! The discrete Fourier transform of real samples.

use nalgebra::Complex;
use std::f64::consts::TAU;

/// `X_k = Σ x_n e^(−2 pi i k n/N)` for k = 0 … N/2 of the samples, zeros added up to the next power of two N.
pub(crate) fn transform(samples: &[f64]) -> Vec<Complex<f64>> {
    let size = samples.len().next_power_of_two().max(2);
    let bits = size.trailing_zeros();
    let mut values = vec![Complex::new(0.0, 0.0); size];
    for (n, sample) in samples.iter().enumerate() {
        values[n.reverse_bits() >> (usize::BITS - bits)].re = *sample;
    }
    // Every turn from its own sine and cosine: a product of turns would gather rounding.
    let turns: Vec<Complex<f64>> =
        (0..size / 2).map(|k| Complex::from_polar(1.0, -TAU * k as f64 / size as f64)).collect();
    let mut half = 1;
    while half < size {
        let stride = size / (2 * half);
        for block in values.chunks_exact_mut(2 * half) {
            let (low, high) = block.split_at_mut(half);
            for (k, (a, b)) in low.iter_mut().zip(high).enumerate() {
                let turned = *b * turns[k * stride];
                (*a, *b) = (*a + turned, *a - turned);
            }
        }
        half *= 2;
    }
    values.truncate(size / 2 + 1);
    values
}

/// Hann's window over `count` samples, of mean one half.
pub(crate) fn hann(count: usize) -> impl Iterator<Item = f64> {
    (0..count).map(move |n| 0.5 - 0.5 * (TAU * (n as f64 + 0.5) / count as f64).cos())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_transform_is_its_defining_sum() {
        let samples: Vec<f64> = (0..29).map(|n| f64::from((n * n * 7) % 23) - 11.0).collect();
        for (k, found) in transform(&samples).iter().enumerate() {
            let turn = |n: usize| Complex::from_polar(1.0, -TAU * (k * n) as f64 / 32.0);
            let sum: Complex<f64> = samples.iter().enumerate().map(|(n, x)| turn(n) * *x).sum();
            assert!((found - sum).norm() < 1e-10, "{k}: {found} {sum}");
        }
        assert_eq!(transform(&[3.0]).len(), 2);
    }
}
