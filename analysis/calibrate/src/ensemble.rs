//! The affine-invariant ensemble sampler, for posteriors that no single normal distribution resembles.

use crate::fit::Maximum;
use crate::model::Model;
use nalgebra::DVector;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Walkers per dimension (assumption).
const WALKERS: usize = 4;
/// Scale of the stretch move, as Goodman and Weare have it.
const STRETCH: f64 = 2.0;
/// Steps of every walker between two looks at convergence (assumption).
const ROUND: usize = 400;
/// Times that a walker looks for a start with density around its maximum: in a corner of ten ranges one of 1000 has it (assumption).
const STARTS: usize = 10_000;
/// Greatest split R-hat of a converged ensemble (Vehtari et al., Bayesian Analysis 16 (2021) 667).
const CONVERGED: f64 = 1.01;
/// Rounds after which the ensemble is taken as it is; the result then says how far it came.
const ROUNDS: usize = 12;

/// What an ensemble has drawn.
pub struct Chain {
    /// Draws.
    pub draws: Vec<DVector<f64>>,
    /// Greatest split R-hat of the coordinates.
    pub split_r: f64,
    /// Effective number of draws by the spread of the walkers' means.
    pub effective: f64,
}

/// Runs walkers from around the maxima until the second half of their ways agrees.
///
/// # Source
/// J. Goodman, J. Weare, Communications in Applied Mathematics and Computational Science 5 (2010) 65.
pub fn run(model: &dyn Model, edges: &[usize], maxima: &[&Maximum], count: usize, random: &mut ChaCha8Rng) -> Chain {
    let size = maxima[0].u.len();
    let walkers = (WALKERS * size).max(8);
    let density = |u: &DVector<f64>| model.ln_posterior(u.as_slice(), edges);
    let mut places: Vec<(DVector<f64>, f64)> = (0..walkers)
        .map(|walker| {
            let maximum = maxima[walker % maxima.len()];
            let scale = maximum.covariance.diagonal().map(|variance| 0.5 * variance.max(0.0).sqrt());
            // Walkers in one place never leave it: each draws until it stands where there is density.
            for _ in 0..STARTS {
                let start = DVector::from_fn(size, |i, _| {
                    let z: f64 = StandardNormal.sample(&mut *random);
                    scale[i].mul_add(z, maximum.u[i])
                });
                let there = density(&start);
                if there.is_finite() {
                    return (start, there);
                }
            }
            (maximum.u.clone(), maximum.ln_density)
        })
        .collect();
    let mut ways: Vec<Vec<DVector<f64>>> = vec![Vec::new(); walkers];
    let mut reached = f64::INFINITY;
    for _ in 0..ROUNDS {
        for _ in 0..ROUND {
            for half in [0, 1] {
                for walker in (half..walkers).step_by(2) {
                    let partner = 2 * random.random_range(0..walkers / 2) + 1 - half;
                    let root: f64 =
                        random.random::<f64>() * (STRETCH.sqrt() - STRETCH.sqrt().recip()) + STRETCH.sqrt().recip();
                    let z = root * root;
                    let other = &places[partner].0;
                    let next = other + (&places[walker].0 - other) * z;
                    let there = density(&next);
                    let accept = (size as f64 - 1.0) * z.ln() + there - places[walker].1;
                    if random.random::<f64>().ln() < accept {
                        places[walker] = (next, there);
                    }
                }
            }
            ways.iter_mut().zip(&places).for_each(|(way, place)| way.push(place.0.clone()));
        }
        reached = (0..size).map(|i| split_r(&ways, i)).fold(1.0, f64::max);
        if reached < CONVERGED {
            break;
        }
    }
    let half = ways[0].len() / 2;
    let kept: Vec<DVector<f64>> =
        (half..2 * half).flat_map(|step| ways.iter().map(move |way| way[step].clone())).collect();
    let effective = (0..size).map(|i| effective(&ways, i)).fold(f64::INFINITY, f64::min);
    let draws = (0..count).map(|_| kept[random.random_range(0..kept.len())].clone()).collect();
    Chain { draws, split_r: reached, effective }
}

/// Between and within variance of the second halves of the ways, each cut in two, and the length of a part.
fn variances(ways: &[Vec<DVector<f64>>], coordinate: usize) -> (f64, f64, f64) {
    let (from, to) = (ways[0].len() / 2, ways[0].len());
    let middle = (from + to) / 2;
    let part = |way: &Vec<DVector<f64>>, from: usize, to: usize| {
        let length = (to - from) as f64;
        let mean = way[from..to].iter().map(|u| u[coordinate]).sum::<f64>() / length;
        let variance = way[from..to].iter().map(|u| (u[coordinate] - mean).powi(2)).sum::<f64>() / (length - 1.0);
        (mean, variance)
    };
    let parts: Vec<(f64, f64)> = ways.iter().flat_map(|way| [part(way, from, middle), part(way, middle, to)]).collect();
    let count = parts.len() as f64;
    let mean = parts.iter().map(|part| part.0).sum::<f64>() / count;
    let length = (middle - from) as f64;
    let between = length * parts.iter().map(|part| (part.0 - mean).powi(2)).sum::<f64>() / (count - 1.0);
    (between, parts.iter().map(|part| part.1).sum::<f64>() / count, length)
}

fn split_r(ways: &[Vec<DVector<f64>>], coordinate: usize) -> f64 {
    let (between, within, length) = variances(ways, coordinate);
    let ratio = (((length - 1.0) / length * within + between / length) / within).sqrt();
    // Walkers that stand still have converged to nothing.
    if ratio.is_nan() { f64::INFINITY } else { ratio }
}

fn effective(ways: &[Vec<DVector<f64>>], coordinate: usize) -> f64 {
    let (between, within, length) = variances(ways, coordinate);
    if within > 0.0 { 2.0 * ways.len() as f64 * length * (within / between).min(1.0) } else { 0.0 }
}
