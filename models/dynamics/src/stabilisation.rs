//! Poles of a common denominator over its order: the stabilisation diagram.
//!
//! # Source
//! Guillaume, Verboven, Vanlanduit, Van der Auweraer, Peeters: A poly-reference implementation of the least-squares
//! complex frequency-domain estimator, IMAC 21 (2003); here with one denominator for all functions. The lowest coefficient is
//! fixed at one, which puts poles of the noise outside the unit circle, where they are told from those of the structure.

use crate::frf::Measurement;
use nalgebra::{Complex, DMatrix};
use std::f64::consts::{PI, TAU};

/// Greatest order of the denominator.
const GREATEST_ORDER: usize = 60;
/// Least order of the denominator.
const LEAST_ORDER: usize = 4;
/// Shares by which frequency and damping ratio of a stable pole may change from order to order: usual limits of
/// stabilisation diagrams.
const STABLE: [f64; 2] = [0.01, 0.05];
/// Greatest damping ratio of a pole that counts as a mode (assumption).
const GREATEST_DAMPING: f64 = 0.3;
/// Greatest ratio of signal to noise with which a line counts (assumption): without a bound the resonances alone would count.
const GREATEST_WEIGHT: f64 = 1e3;

/// A pole of a denominator of some order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pole {
    /// Order of the denominator.
    pub order: usize,
    /// Undamped natural frequency (Hz).
    pub natural_frequency: f64,
    /// Share of critical damping.
    pub damping_ratio: f64,
    /// Whether a pole of the order before has the same frequency within 1 % and the same damping within 5 %.
    pub stable: bool,
}

/// The poles of denominators of even orders from 4 to 60, by order and frequency.
pub fn stabilisation(measured: &Measurement) -> Vec<Pole> {
    let Some(end) = measured.frequencies.last() else { return Vec::new() };
    let step = 1.0 / (2.0 * end);
    let phases: Vec<Complex<f64>> =
        measured.frequencies.iter().map(|frequency| Complex::from_polar(1.0, TAU * frequency * step)).collect();
    let size = GREATEST_ORDER + 1;
    let mut reduced = Vec::new();
    for function in &measured.functions {
        // Sums of |W|², |W|² H and |W H|² over powers of z, from −60 to 60.
        let (mut plain, mut cross, mut square) = (vec![0.0; size], vec![0.0; 2 * size - 1], vec![0.0; size]);
        for (i, (z, h)) in phases.iter().zip(&function.receptance).enumerate() {
            let ratio = function.coherence.as_ref().map_or(1.0, |coherence| {
                let coherence = coherence[i];
                if coherence < 0.5 { 0.0 } else { coherence / (1.0 - coherence).max(1.0 / GREATEST_WEIGHT) }
            });
            let size2 = h.norm_sqr();
            if size2 == 0.0 {
                continue;
            }
            let weight = ratio / size2;
            let mut power = Complex::new(1.0, 0.0);
            for k in 0..size {
                plain[k] += weight * power.re;
                square[k] += weight * size2 * power.re;
                cross[GREATEST_ORDER + k] -= weight * (h * power).re;
                if k > 0 {
                    cross[GREATEST_ORDER - k] -= weight * (h * power.conj()).re;
                }
                power *= z;
            }
        }
        reduced.push((plain, cross, square));
    }
    let mut poles: Vec<Pole> = Vec::new();
    let mut before: Vec<(f64, f64)> = Vec::new();
    for order in (LEAST_ORDER..=GREATEST_ORDER).step_by(2) {
        let found = denominator(&reduced, order).map_or_else(Vec::new, |denominator| roots(&denominator, step));
        let range = |(frequency, _): &&(f64, f64)| (measured.frequencies[0]..=*end).contains(frequency);
        for &(natural_frequency, damping_ratio) in found.iter().filter(range) {
            let near = |(frequency, damping): &(f64, f64)| {
                (frequency / natural_frequency - 1.0).abs() < STABLE[0]
                    && (damping / damping_ratio - 1.0).abs() < STABLE[1]
            };
            poles.push(Pole { order, natural_frequency, damping_ratio, stable: before.iter().any(near) });
        }
        before = found;
    }
    poles
}

/// Coefficients of the denominator, the lowest first.
fn denominator(sums: &[(Vec<f64>, Vec<f64>, Vec<f64>)], order: usize) -> Option<Vec<f64>> {
    let size = order + 1;
    let mut matrix = DMatrix::zeros(size, size);
    for (plain, cross, square) in sums {
        let r = DMatrix::from_fn(size, size, |i, j| plain[i.abs_diff(j)]);
        let s = DMatrix::from_fn(size, size, |i, j| cross[GREATEST_ORDER + j - i]);
        let t = DMatrix::from_fn(size, size, |i, j| square[i.abs_diff(j)]);
        matrix += t - s.transpose() * r.lu().solve(&s)?;
    }
    let rest = matrix.view((1, 1), (order, order)).into_owned();
    let side = -matrix.view((1, 0), (order, 1)).into_owned();
    let solved = rest.lu().solve(&side)?;
    Some(std::iter::once(1.0).chain(solved.iter().copied()).collect())
}

/// Natural frequency (Hz) and damping ratio of the decaying roots in the upper half plane.
fn roots(denominator: &[f64], step: f64) -> Vec<(f64, f64)> {
    let order = denominator.len() - 1;
    let last = denominator[order];
    if last == 0.0 || !denominator.iter().all(|coefficient| coefficient.is_finite()) {
        return Vec::new();
    }
    let companion = DMatrix::from_fn(order, order, |i, j| {
        if i + 1 == order { -denominator[j] / last } else { f64::from(u8::from(j == i + 1)) }
    });
    let eigenvalues =
        nalgebra::Schur::try_new(companion, f64::EPSILON, 10_000).map(|schur| schur.complex_eigenvalues());
    let mut found: Vec<(f64, f64)> = eigenvalues
        .iter()
        .flat_map(|values| values.iter())
        .filter(|z| z.norm_sqr() > 0.0 && z.arg() > 0.0 && z.arg() < PI)
        .map(|z| Complex::new(z.norm().ln(), z.arg()) / step)
        .map(|rate| (rate.norm() / TAU, -rate.re / rate.norm()))
        .filter(|(_, damping)| *damping > 0.0 && *damping < GREATEST_DAMPING)
        .collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found
}
