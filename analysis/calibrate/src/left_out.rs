//! Predictions of edges by the other edges.

use crate::fit::{Maximum, maximise, maximise_near};
use crate::model::Model;
use crate::normal::ln_sum;
use crate::pareto::Weights;
use crate::sample::{TAIL, Weighted, proposed};
use nalgebra::DVector;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

/// Proposals for an edge left out: a third of them is effective usually, [`EFFECTIVE`] are wanted at least (assumption).
const PROPOSALS: usize = 256;
/// Draws that all groups of edges share where there are many (assumption: a third of them is effective usually).
const SHARED: usize = 512;
/// Edges beyond which several are left out at once (assumption), which makes each prediction that of a fit to a little less
/// than all others.
const FEW: usize = 24;
/// Fits to all but some of the edges where there are more.
const FITS: usize = 12;
/// Effective draws below which the proposal is made anew from the moments of the first (assumption).
const EFFECTIVE: f64 = 64.0;

/// What the other edges say of one.
#[derive(Clone, Debug, PartialEq)]
pub struct LeftOut {
    /// Log of the mean predictive density of all its data jointly.
    pub score: f64,
    /// Where each reading lies in its predictive distribution, from 0 to 1.
    pub ranks: Vec<f64>,
    /// 5 %, 50 % and 95 % points of the predictive distribution of each reading.
    pub bands: Vec<[f64; 3]>,
}

/// Every edge predicted by a fit to all others; `full` is the fit to all, from which each search starts. Edges stand for
/// what will be measured next, so that their own level is integrated out.
///
/// Single readings are not left out: readings of one edge share its level, and weights of the full fit would have to
/// bridge its whole level (their tail shape is high by construction). Of more than 24 edges several are left out at once. Draws
/// from one wide distribution are then weighted by the edges that stay, and a fit is made anew where these weights cannot
/// be relied on.
pub fn leave_edges_out(model: &dyn Model, full: &Maximum, seed: u64, done: &(dyn Fn() + Sync)) -> Vec<LeftOut> {
    let near = model.near(full.u.as_slice());
    let model = near.as_deref().unwrap_or(model);
    let fits = fits_without(model);
    let group = |fit: usize| (fit..model.edges()).step_by(fits.max(1)).collect::<Vec<usize>>();
    let drawn = (model.edges() > FEW).then(|| Drawn::around(model, full, fits, seed));
    let one = |fit: usize| {
        let group = group(fit);
        let shared = drawn.as_ref().and_then(|drawn| drawn.left_out(model, &group, fit, seed));
        let left_out = shared.unwrap_or_else(|| left_out(model, full, &group, fit, seed));
        done();
        left_out
    };
    let groups: Vec<Vec<LeftOut>> = (0..fits).into_par_iter().map(one).collect();
    let mut groups: Vec<_> = groups.into_iter().map(Vec::into_iter).collect();
    (0..model.edges()).filter_map(|edge| groups[edge % fits].next()).collect()
}

/// Fits without some of the edges of a model.
pub(crate) fn fits_without(model: &dyn Model) -> usize {
    if model.edges() > FEW { FITS } else { model.edges() }
}

/// Every edge but those of a group, in their order; in time that grows with the number of edges and not with its square.
fn without(edges: usize, group: &[usize]) -> Vec<usize> {
    let mut kept = vec![true; edges];
    group.iter().for_each(|edge| kept[*edge] = false);
    (0..edges).filter(|edge| kept[*edge]).collect()
}

/// The random numbers of a group of edges.
fn stream(group: usize, seed: u64) -> ChaCha8Rng {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    random.set_stream(group as u64 + 1);
    random
}

/// Draws that all groups share, with what each edge says of them.
struct Drawn {
    draws: Vec<DVector<f64>>,
    /// Log of prior over proposal.
    ratios: Vec<f64>,
    /// Log densities of the edges of each draw.
    densities: Vec<Vec<f64>>,
}

impl Drawn {
    /// Draws around the fit to all edges, as wide as fits to all but one of `fits` groups.
    fn around(model: &dyn Model, full: &Maximum, fits: usize, seed: u64) -> Self {
        let wider = fits as f64 / (fits as f64 - 1.0);
        let mut random = stream(model.edges(), seed);
        let (draws, proposals) = proposed(&full.u, &(wider * &full.covariance), SHARED, &mut random);
        let all: Vec<usize> = (0..model.edges()).collect();
        let densities = draws.par_iter().map(|draw| model.ln_densities(draw.as_slice(), &all)).collect();
        let ratios = draws.iter().zip(&proposals).map(|(draw, proposal)| model.ln_prior(draw.as_slice()) - proposal);
        Self { ratios: ratios.collect(), draws, densities }
    }

    /// The edges of a group predicted by all others; `None` where the draws cannot be relied on for that.
    fn left_out(&self, model: &dyn Model, group: &[usize], fit: usize, seed: u64) -> Option<Vec<LeftOut>> {
        let others = without(model.edges(), group);
        let ratio = |(ratio, densities): (&f64, &Vec<f64>)| {
            let density = ratio + others.iter().map(|edge| densities[*edge]).sum::<f64>();
            if density.is_nan() { f64::NEG_INFINITY } else { density }
        };
        let ratios: Vec<f64> = self.ratios.iter().zip(&self.densities).map(ratio).collect();
        let weights = Weights::smoothed(&ratios);
        if weights.shape > TAIL || weights.effective() < EFFECTIVE {
            return None;
        }
        let score = |edge: usize| {
            let terms = weights.weights.iter().zip(&self.densities);
            ln_sum(&terms.map(|(weight, densities)| weight.ln() + densities[edge]).collect::<Vec<f64>>())
        };
        let scores: Vec<f64> = group.iter().map(|edge| score(*edge)).collect();
        let mut random = stream(fit, seed);
        let found = Weighted { draws: self.draws.clone(), weights };
        let equal = found.resampled(PROPOSALS, &mut random);
        Some(predicted(model, scores, &equal, group, &mut random))
    }
}

/// The edges of a group predicted by all others.
pub(crate) fn left_out(model: &dyn Model, full: &Maximum, group: &[usize], fit: usize, seed: u64) -> Vec<LeftOut> {
    let others = without(model.edges(), group);
    let mut random = stream(fit, seed);
    let many = model.edges() > FEW;
    let fit = if many {
        let share = model.edges() as f64 / others.len() as f64;
        maximise_near(model, &others, full, share * &full.covariance)
    } else {
        maximise(model, &others, &full.u, Some(&full.covariance))
    };
    let fit = fit.as_ref().unwrap_or(full);
    let proposals = if many { PROPOSALS / 2 } else { PROPOSALS };
    let mut found = Weighted::draw(model, &others, &fit.u, &fit.covariance, proposals, &mut random);
    if found.weights.effective() < EFFECTIVE {
        let (mean, covariance) = found.moments();
        let again = Weighted::draw(model, &others, &mean, &covariance, 2 * PROPOSALS, &mut random);
        if again.weights.effective() > found.weights.effective() {
            found = again;
        }
    }
    // Equally weighted draws give quantiles by counting.
    let equal = found.resampled(if many { PROPOSALS } else { 4 * PROPOSALS }, &mut random);
    let densities: Vec<Vec<f64>> = found.draws.iter().map(|draw| model.ln_densities(draw.as_slice(), group)).collect();
    let score = |place: usize| {
        let terms = found.weights.weights.iter().zip(&densities);
        ln_sum(&terms.map(|(weight, densities)| weight.ln() + densities[place]).collect::<Vec<f64>>())
    };
    let scores = (0..group.len()).map(score).collect();
    predicted(model, scores, &equal, group, &mut random)
}

/// Where the readings of edges with known scores lie among those that equally weighted draws would make.
fn predicted(
    model: &dyn Model,
    scores: Vec<f64>,
    equal: &[DVector<f64>],
    group: &[usize],
    random: &mut ChaCha8Rng,
) -> Vec<LeftOut> {
    let simulated: Vec<Vec<Vec<f64>>> =
        equal.iter().map(|draw| model.replicate_each(draw.as_slice(), group, &mut *random)).collect();
    let one = |(place, score): (usize, f64)| {
        let mut ranks = Vec::new();
        let mut bands = Vec::new();
        for (index, read) in model.readings(group[place]).iter().enumerate() {
            let mut values: Vec<f64> = simulated.iter().map(|edges| edges[place][index]).collect();
            values.sort_by(f64::total_cmp);
            let below = values.partition_point(|value| value < read);
            ranks.push((below as f64 + 0.5) / (values.len() + 1) as f64);
            let at = |share: f64| values[(share * (values.len() - 1) as f64).round() as usize];
            bands.push([at(0.05), at(0.5), at(0.95)]);
        }
        LeftOut { score, ranks, bands }
    };
    scores.into_iter().enumerate().map(one).collect()
}

/// How often predictions of edges left out hold.
#[derive(Clone, Debug, PartialEq)]
pub struct Coverage {
    /// Edges with readings.
    pub edges: usize,
    /// Readings.
    pub readings: usize,
    /// Share of readings within the 50 % band.
    pub inside50: f64,
    /// Share of readings within the 90 % band.
    pub inside90: f64,
    /// Readings by tenths of their predictive distribution.
    pub histogram: [usize; 10],
    /// Index of the edge whose readings lie farthest out.
    pub worst: Option<usize>,
}

impl Coverage {
    /// The coverage of edges left out.
    pub fn from_left_outs(left_out: &[LeftOut]) -> Self {
        let ranks = || left_out.iter().flat_map(|edge| &edge.ranks);
        let readings = ranks().count();
        let within = |half: f64| ranks().filter(|rank| (**rank - 0.5).abs() <= half).count() as f64 / readings as f64;
        let mut histogram = [0; 10];
        ranks().for_each(|rank| histogram[((rank * 10.0) as usize).min(9)] += 1);
        let far =
            |edge: &LeftOut| edge.ranks.iter().map(|rank| (rank - 0.5).abs()).sum::<f64>() / edge.ranks.len() as f64;
        let read = left_out.iter().enumerate().filter(|(_, edge)| !edge.ranks.is_empty());
        let worst = read.clone().max_by(|a, b| far(a.1).total_cmp(&far(b.1))).map(|(index, _)| index);
        Self { edges: read.count(), readings, inside50: within(0.25), inside90: within(0.45), histogram, worst }
    }
}
