//! Which inputs a result depends on.

use super::points::{Points, Sampling};
use crate::bootstrap::quantiles;
use rand::RngExt;
use rayon::prelude::*;
use toolroom_kernel::{Entity, Purpose, Streams};

/// A share of variance with its bootstrap interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Index {
    /// Estimate.
    pub value: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// Sobol indices of one input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SobolIndex {
    /// Share of variance that this input explains alone.
    pub first: Index,
    /// Share that it has a part in.
    pub total: Index,
}

/// Morris screening of one input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effect {
    /// Mean size of the elementary effect, μ*.
    pub size: f64,
    /// Mean effect, μ.
    pub mean: f64,
    /// Scatter of the effect over the cube, σ: curvature or interaction.
    pub scatter: f64,
}

/// Refits behind an interval.
const REFITS: u64 = 300;

/// First and total indices of `f` on the unit cube from `samples` rows, with bootstrap intervals
/// over rows. It costs `samples · (dimensions + 2)` values. `f` gets a point and the number of the
/// row whose noise it may use: rows of the second matrix have numbers from `samples` on.
///
/// Both of Saltelli's matrices are halves of one scrambled Sobol sequence; the first index by Saltelli's estimator, the
/// total one by Jansen's. Values are centred, which takes most of the noise from small indices.
///
/// # Source
/// A. Saltelli et al., Computer Physics Communications 181 (2010) 259, table 2 (b) and (f).
pub fn sobol(
    f: impl Fn(&[f64], u64) -> f64 + Sync,
    dimensions: usize,
    samples: u64,
    confidence: f64,
    seed: u64,
) -> Vec<SobolIndex> {
    let points = Points::new(Sampling::Sobol, seed, samples);
    let rows: Vec<(f64, f64, Vec<f64>)> = (0..samples)
        .into_par_iter()
        .map(|row| {
            let mut both = vec![0.0; 2 * dimensions];
            points.at(row, &mut both);
            let (a, b) = both.split_at(dimensions);
            let (at_a, at_b) = (f(a, row), f(b, row + samples));
            let mixed = (0..dimensions)
                .map(|j| {
                    let mut point = a.to_vec();
                    point[j] = b[j];
                    f(&point, row)
                })
                .collect();
            (at_a, at_b, mixed)
        })
        .collect();
    let mean = rows.iter().map(|row| 0.5 * (row.0 + row.1)).sum::<f64>() / samples as f64;
    let indices = |pick: &dyn Fn(usize) -> usize| -> Vec<(f64, f64)> {
        let chosen = || (0..rows.len()).map(|i| &rows[pick(i)]);
        let n = rows.len() as f64;
        let variance = chosen().map(|(a, b, _)| 0.5 * ((a - mean).powi(2) + (b - mean).powi(2))).sum::<f64>() / n;
        (0..dimensions)
            .map(|j| {
                let first = chosen().map(|(a, b, mixed)| (b - mean) * (mixed[j] - a)).sum::<f64>() / n;
                let total = chosen().map(|(a, _, mixed)| (a - mixed[j]).powi(2)).sum::<f64>() / (2.0 * n);
                (first / variance, total / variance)
            })
            .collect()
    };
    let values = indices(&|i| i);
    let streams = Streams::new(seed, 0);
    let refits: Vec<Vec<(f64, f64)>> = (0..REFITS)
        .into_par_iter()
        .map(|k| {
            let mut stream = streams.at(Entity::named("sensitivity"), Purpose::Measurement, k);
            let drawn: Vec<usize> = rows.iter().map(|_| stream.random_range(0..rows.len())).collect();
            indices(&|i| drawn[i])
        })
        .collect();
    let index = |j: usize, part: fn(&(f64, f64)) -> f64| {
        let (low, high) = quantiles(refits.iter().map(|refit| part(&refit[j])).collect(), confidence);
        Index { value: part(&values[j]), low, high }
    };
    (0..dimensions).map(|j| SobolIndex { first: index(j, |pair| pair.0), total: index(j, |pair| pair.1) }).collect()
}

/// Elementary effects of `f` on the unit cube along `trajectories` paths over four levels.
///
/// # Source
/// M. D. Morris, Technometrics 33 (1991) 161; μ*: F. Campolongo, J. Cariboni, A. Saltelli,
/// Environmental Modelling & Software 22 (2007) 1509.
pub fn morris(f: impl Fn(&[f64], u64) -> f64 + Sync, dimensions: usize, trajectories: u64, seed: u64) -> Vec<Effect> {
    const STEP: f64 = 2.0 / 3.0;
    let streams = Streams::new(seed, 1);
    let paths: Vec<Vec<f64>> = (0..trajectories)
        .into_par_iter()
        .map(|k| {
            let mut stream = streams.at(Entity::named("sensitivity"), Purpose::Measurement, k);
            let mut order: Vec<usize> = (0..dimensions).collect();
            for i in (1..dimensions).rev() {
                order.swap(i, stream.random_range(0..=i));
            }
            // Levels 0, 1/3 step up to 2/3, 1, in the middle of four classes of equal probability.
            let class = |level: f64| 0.125 + 0.75 * level;
            let mut point: Vec<f64> = (0..dimensions).map(|_| f64::from(stream.random_range(0..4u8)) / 3.0).collect();
            let value = |point: &[f64]| f(&point.iter().map(|level| class(*level)).collect::<Vec<_>>(), k);
            let mut before = value(&point);
            let mut effects = vec![0.0; dimensions];
            for j in order {
                let up = point[j] < 0.5;
                point[j] += if up { STEP } else { -STEP };
                let after = value(&point);
                effects[j] = if up { after - before } else { before - after } / STEP;
                before = after;
            }
            effects
        })
        .collect();
    let n = trajectories as f64;
    (0..dimensions)
        .map(|j| {
            let mean_of = |g: &dyn Fn(f64) -> f64| paths.iter().map(|path| g(path[j])).sum::<f64>() / n;
            let mean = mean_of(&|effect| effect);
            Effect {
                size: mean_of(&f64::abs),
                mean,
                scatter: (mean_of(&|effect| (effect - mean).powi(2)) * n / (n - 1.0)).sqrt(),
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{PI, TAU};

    #[test]
    fn the_function_of_ishigami_has_its_exact_indices() {
        // a = 7, b = 0.1: first 0.3139, 0.4424, 0; total 0.5576, 0.4424, 0.2437 (Saltelli et al.
        // 2008, Global Sensitivity Analysis, §4.6, from the closed form).
        let f = |u: &[f64], _: u64| {
            let x: Vec<f64> = u.iter().map(|u| TAU * u - PI).collect();
            x[0].sin() + 7.0 * x[1].sin().powi(2) + 0.1 * x[2].powi(4) * x[0].sin()
        };
        let indices = sobol(f, 3, 8192, 0.9, 1);
        for (index, (first, total)) in indices.iter().zip([(0.3139, 0.5576), (0.4424, 0.4424), (0.0, 0.2437)]) {
            assert!((index.first.value - first).abs() < 0.015, "{index:?} {first}");
            assert!((index.total.value - total).abs() < 0.015, "{index:?} {total}");
            assert!(index.first.low <= index.first.value && index.first.value <= index.first.high);
        }
    }

    #[test]
    fn the_g_function_of_sobol_has_its_exact_indices() {
        let a = [0.0, 1.0, 4.5, 9.0, 99.0, 99.0];
        let f = |u: &[f64], _: u64| u.iter().zip(a).map(|(u, a)| ((4.0 * u - 2.0).abs() + a) / (1.0 + a)).product();
        // V_j = 1/(3 (1 + a_j)²); V = Π(1 + V_j) - 1; S_j = V_j/V; total V_j Π_{i≠j}(1 + V_i)/V.
        let parts = a.map(|a| 1.0 / (3.0 * (1.0 + a) * (1.0 + a)));
        let product: f64 = parts.iter().map(|v| 1.0 + v).product();
        let indices = sobol(f, 6, 8192, 0.9, 2);
        for (index, v) in indices.iter().zip(parts) {
            assert!((index.first.value - v / (product - 1.0)).abs() < 0.015, "{index:?}");
            assert!((index.total.value - v * product / (1.0 + v) / (product - 1.0)).abs() < 0.015, "{index:?}");
        }
    }

    #[test]
    fn intervals_hold_the_exact_index() {
        // A sum of squares of different weight: shares in proportion to the weights' squares.
        let weights = [1.0, 2.0, 3.0];
        let held = (0..40)
            .filter(|seed| {
                let f = |u: &[f64], _: u64| u.iter().zip(weights).map(|(u, w)| w * u).sum();
                let index = sobol(f, 3, 128, 0.9, *seed)[1].first;
                index.low <= 4.0 / 14.0 && 4.0 / 14.0 <= index.high
            })
            .count();
        assert!(held >= 32, "{held} of 40"); // quasi-random points are better than resampling thinks
    }

    #[test]
    fn morris_sees_slope_and_curvature() {
        let f = |u: &[f64], _: u64| 3.0 * u[0] + 10.0 * (u[1] - 0.5).powi(2);
        let effects = morris(f, 3, 50, 1);
        assert!((effects[0].size - 3.0 * 0.75).abs() < 1e-9 && effects[0].scatter < 1e-9, "{effects:?}");
        assert!(effects[1].scatter > 1.0 && effects[2].size == 0.0, "{effects:?}");
    }
}
