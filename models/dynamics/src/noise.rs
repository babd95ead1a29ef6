//! Noise from coherence that was estimated of a few hits, as analysers write it.
//!
//! Of n hits of noise alone it is not zero but 1/n in the mean, and it scatters from line to line by `(1 − γ²) sqrt(2 γ²/n)`, while the
//! coherence of the formulas changes as slowly as the response. What the hits differ by is then known on each line: the variance of
//! the real and of the imaginary part of their mean is `|H|² (1 − γ²)/(2 (n − 1) γ²)`, free of bias, with the measured modulus, and nine
//! lines together tell it well (Bendat and Piersol, Random Data, recalled).

use crate::frf::{Frf, Measurement};
use std::borrow::Cow;

/// Lines on each side over which the noise is averaged: known from a few hits alone it would scatter (assumption).
pub(crate) const SMOOTHED: usize = 4;
/// Coherences between which the scatter from line to line is looked at (assumption).
const BETWEEN: [f64; 2] = [0.05, 0.95];
/// Least number of pairs of neighbouring lines that tell it (assumption).
const LEAST_PAIRS: usize = 20;
/// Median change from line to line, in standard deviations of an estimate, from which on the coherence is an estimate (assumption:
/// of estimates it is 0.7 to 0.95, of coherence worked out without scatter below 0.1).
const SCATTERS: f64 = 0.3;
/// Least coherence from which a line tells its noise (assumption: files give it with three digits).
const TELLS: f64 = 1e-3;

/// A coherence of so many readings, free of its bias.
pub(crate) fn unbiased(agreement: f64, count: f64) -> f64 {
    ((count * agreement - 1.0) / (count - 1.0)).clamp(0.0, 1.0)
}

/// The measurement with the noise of its lines, and its coherence free of bias and scatter, where it was estimated of so many averages.
pub(crate) fn noise_of_hits(measured: &Measurement, averages: Option<u32>) -> Cow<'_, Measurement> {
    let Some(count) = averages.filter(|averages| *averages > 1).map(f64::from) else { return Cow::Borrowed(measured) };
    let scatters = |function: &Frf| {
        function.noise.is_none() && function.coherence.as_deref().is_some_and(|coherence| is_estimate(coherence, count))
    };
    if !measured.functions.iter().any(scatters) {
        return Cow::Borrowed(measured);
    }
    let mut told = measured.clone();
    for function in told.functions.iter_mut().filter(|function| scatters(function)) {
        let coherence = function.coherence.take().unwrap_or_default();
        let lines = function.receptance.iter().zip(&coherence);
        let variances: Vec<Option<f64>> = lines
            .map(|(value, coherence)| {
                let differs = (1.0 - coherence).max(measured.coherence_digit);
                (*coherence > TELLS).then(|| value.norm_sqr() * differs / (2.0 * (count - 1.0) * coherence))
            })
            .collect();
        let near = |i: usize| i.saturating_sub(SMOOTHED)..(i + SMOOTHED + 1).min(coherence.len());
        let sd = |i: usize| {
            let known: Vec<f64> = variances[near(i)].iter().flatten().copied().collect();
            // Lines without any coherence know nothing: what is read there is noise.
            let mean = known.iter().sum::<f64>() / known.len() as f64;
            if known.is_empty() { function.receptance[i].norm() } else { mean.sqrt() }
        };
        let median = |i: usize| {
            let mut around = coherence[near(i)].to_vec();
            around.sort_by(f64::total_cmp);
            unbiased(around[around.len() / 2], count)
        };
        function.noise = Some((0..coherence.len()).map(sd).collect());
        function.coherence = Some((0..coherence.len()).map(median).collect());
    }
    Cow::Owned(told)
}

/// Whether a coherence changes from line to line as the estimate of `count` averages does.
fn is_estimate(coherence: &[f64], count: f64) -> bool {
    let changes = coherence.windows(2).filter_map(|pair| {
        let mean = 0.5 * (pair[0] + pair[1]);
        let sd = (1.0 - mean) * (2.0 * mean / count).sqrt();
        (BETWEEN[0] < mean && mean < BETWEEN[1]).then(|| (pair[1] - pair[0]).abs() / sd)
    });
    let mut changes: Vec<f64> = changes.collect();
    changes.sort_by(f64::total_cmp);
    changes.len() >= LEAST_PAIRS && changes[changes.len() / 2] > SCATTERS
}
