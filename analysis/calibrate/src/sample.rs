//! Draws of a posterior: importance-resampled Laplace approximation, an ensemble where that fails.

use crate::ensemble;
use crate::fit::{Maximum, climbed, maximise};
use crate::model::Model;
use crate::normal::ln_sum;
use crate::pareto::Weights;
use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{ChiSquared, Distribution, StandardNormal};
use rayon::prelude::*;
use statrs::function::gamma::ln_gamma;
use toolroom_numerics::order_quantile;

/// Degrees of freedom of the proposal, whose tails are then heavier than the posterior's (assumption).
const FREEDOM: f64 = 7.0;
/// Greatest tail shape at which weights are relied on (Vehtari et al.).
pub(crate) const TAIL: f64 = 0.7;
/// Least number of effective draws: 20 lie beyond either end of a 90 % interval (assumption).
const EFFECTIVE: f64 = 400.0;
/// Share of effective draws below which a second proposal, of the moments of the first weighted draws, is tried although
/// the first could be relied on (assumption): scatter that is barely known has a skewed posterior, of which the Laplace
/// proposal reaches the far side seldom.
const EFFICIENT: f64 = 0.3;
/// Further times that a proposal takes over the moments of the draws before it while none could be relied on (assumption: each
/// costs a thirtieth of an ensemble).
const MATCHINGS: usize = 3;
/// Least share of the proposals around each of several maxima (assumption: a maximum whose width is judged wrongly is still met).
const LEAST_SHARE: f64 = 0.1;
/// Starts besides the prior mean (assumption).
const STARTS: usize = 4;
/// Edges that show which maxima there are (assumption).
const MANY: usize = 12;
/// A second maximum within so many logarithms of the best is a mode of its own; one further down has less than a
/// hundredth of the best one's density (assumption).
const MODE: f64 = 5.0;
/// Distance of two maxima in posterior standard deviations that makes them two (assumption).
const APART: f64 = 1.0;

/// How the draws were made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Importance-resampled Laplace approximation.
    ResampledLaplace,
    /// The same after the proposal took over mean and covariance of the first weighted draws.
    MomentMatched,
    /// Affine-invariant ensemble.
    Ensemble,
}

impl Method {
    /// Word in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::ResampledLaplace => "resampled_laplace",
            Self::MomentMatched => "moment_matched",
            Self::Ensemble => "ensemble",
        }
    }
}

/// Equally weighted draws of a posterior.
#[derive(Clone, Debug, PartialEq)]
pub struct Posterior {
    /// The greatest maximum found.
    pub map: Maximum,
    /// Other maxima within five logarithms of density.
    pub modes: Vec<Maximum>,
    /// Draws in working coordinates.
    pub draws: Vec<DVector<f64>>,
    /// How they were made.
    pub method: Method,
    /// Effective number of the draws before resampling.
    pub effective: f64,
    /// Tail shape of the weights; NaN for an ensemble.
    pub pareto_k: f64,
    /// Greatest split R-hat of an ensemble; NaN otherwise.
    pub split_r: f64,
    /// Weighted mean.
    pub mean: DVector<f64>,
    /// Weighted covariance.
    pub covariance: DMatrix<f64>,
}

impl Posterior {
    /// The value of one working coordinate below which a `share` (0 to 1) of the draws lies.
    pub fn quantile(&self, parameter: usize, share: f64) -> f64 {
        let mut values: Vec<f64> = self.draws.iter().map(|draw| draw[parameter]).collect();
        values.sort_by(f64::total_cmp);
        order_quantile(&values, share)
    }

    /// Standard deviation of one working coordinate.
    pub fn deviation(&self, parameter: usize) -> f64 {
        self.covariance[(parameter, parameter)].sqrt()
    }
}

/// The maximum from the prior mean and jittered starts, with other maxima nearby.
pub fn maxima(model: &dyn Model, edges: &[usize], seed: u64) -> Option<(Maximum, Vec<Maximum>)> {
    let parameters = model.parameters();
    let mean = DVector::from_iterator(parameters.len(), parameters.iter().map(|parameter| parameter.prior.mean));
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let jittered = |random: &mut ChaCha8Rng| {
        DVector::from_fn(mean.len(), |i, _| {
            let z: f64 = StandardNormal.sample(&mut *random);
            mean[i] + z * parameters[i].prior.deviation
        })
    };
    let starts: Vec<DVector<f64>> = (0..STARTS).map(|_| jittered(&mut random)).collect();
    // Which maxima there are shows in a part of many edges; all of them then say where each one lies.
    let some: Vec<usize> = edges.iter().copied().step_by(edges.len().div_ceil(MANY).max(1)).collect();
    let few = if edges.len() > 2 * MANY { some.as_slice() } else { edges };
    let first = maximise(model, few, &mean, None);
    let others: Vec<Option<Maximum>> =
        starts.par_iter().map(|start| maximise_apart(model, few, start, first.as_ref())).collect();
    let mut found: Vec<Maximum> = first.iter().cloned().chain(others.into_iter().flatten()).collect();
    if few.len() < edges.len() {
        let share = few.len() as f64 / edges.len() as f64;
        let whole = |maximum: Maximum| {
            let near = model.near(maximum.u.as_slice());
            let model = near.as_deref().unwrap_or(model);
            maximise(model, edges, &maximum.u, Some(&(share * maximum.covariance)))
        };
        found = distinct(found).into_par_iter().filter_map(whole).collect();
    }
    let mut distinct = distinct(found).into_iter();
    let best = distinct.next()?;
    let modes = distinct.filter(|mode| mode.ln_density > best.ln_density - MODE).collect();
    Some((best, modes))
}

/// Maxima that are apart from each other, the greatest first.
fn distinct(mut found: Vec<Maximum>) -> Vec<Maximum> {
    found.sort_by(|a, b| b.ln_density.total_cmp(&a.ln_density));
    let mut distinct: Vec<Maximum> = Vec::new();
    for maximum in found {
        if distinct.iter().all(|other| apart(&maximum.u, other)) {
            distinct.push(maximum);
        }
    }
    distinct
}

/// Whether a place is another maximum than a known one.
fn apart(u: &DVector<f64>, maximum: &Maximum) -> bool {
    let scale = maximum.covariance.diagonal();
    (0..u.len()).any(|i| (u[i] - maximum.u[i]).abs() > APART * scale[i].sqrt())
}

/// The maximum nearest to a start, unless it is the known one.
fn maximise_apart(
    model: &dyn Model,
    edges: &[usize],
    start: &DVector<f64>,
    known: Option<&Maximum>,
) -> Option<Maximum> {
    let Some(known) = known else { return maximise(model, edges, start, None) };
    let shape = Some(&known.covariance);
    let rough = climbed(model, edges, start, shape)?;
    if apart(&rough, known) { maximise(model, edges, &rough, shape) } else { None }
}

/// Draws of the posterior of some edges, `count` of them; the same seed gives the same draws. `None` where no density is
/// found.
pub fn sample(model: &dyn Model, edges: &[usize], count: usize, seed: u64) -> Option<Posterior> {
    Some(sample_around(model, edges, maxima(model, edges, seed)?, count, seed))
}

/// The same where the maxima are known.
pub(crate) fn sample_around(
    model: &dyn Model,
    edges: &[usize],
    (map, modes): (Maximum, Vec<Maximum>),
    count: usize,
    seed: u64,
) -> Posterior {
    let mut random = ChaCha8Rng::seed_from_u64(seed ^ 0x05ee_df0d_2a3a);
    let near = model.near(map.u.as_slice());
    let model = near.as_deref().unwrap_or(model);
    // Of many edges the proposal is a good one, and more draws than are wanted tell little more.
    let proposals = if edges.len() > 2 * MANY { count.max(1000) } else { (2 * count).max(1000) };
    let maxima: Vec<&Maximum> = std::iter::once(&map).chain(&modes).collect();
    let (method, found) = matched(model, edges, &maxima, proposals, &mut random);
    if found.reliable() {
        let (mean, covariance) = found.moments();
        return Posterior {
            draws: found.resampled(count, &mut random),
            map,
            modes,
            method,
            effective: found.weights.effective(),
            pareto_k: found.weights.shape,
            split_r: f64::NAN,
            mean,
            covariance,
        };
    }
    let chain = ensemble::run(model, edges, &maxima, count, &mut random);
    let equal = vec![1.0 / chain.draws.len() as f64; chain.draws.len()];
    let (mean, covariance) = moments(&chain.draws, &equal);
    Posterior {
        map: map.clone(),
        modes: modes.clone(),
        draws: chain.draws,
        method: Method::Ensemble,
        effective: chain.effective,
        pareto_k: f64::NAN,
        split_r: chain.split_r,
        mean,
        covariance,
    }
}

/// Weighted draws around the maxima, or by the moments of those where they cannot be relied on or are few.
fn matched(
    model: &dyn Model,
    edges: &[usize],
    maxima: &[&Maximum],
    proposals: usize,
    random: &mut ChaCha8Rng,
) -> (Method, Weighted) {
    let mut method = Method::ResampledLaplace;
    let (mut best, few) = if let [map] = maxima {
        let first = Weighted::draw(model, edges, &map.u, &map.covariance, proposals, random);
        let few = first.weights.effective() < EFFICIENT * proposals as f64;
        (first, few)
    } else {
        (Weighted::around(model, edges, maxima, 2 * proposals, random), false)
    };
    let mut wanted = if few || !best.reliable() { proposals } else { 0 };
    for _ in 0..=MATCHINGS {
        if wanted == 0 {
            break;
        }
        let (mean, covariance) = best.moments();
        let next = Weighted::draw(model, edges, &mean, &covariance, wanted, random);
        let better = next.weights.effective() > best.weights.effective();
        if (better || !best.reliable()) && next.reliable() || better && !best.reliable() {
            (method, best) = (Method::MomentMatched, next);
        }
        wanted = if best.reliable() { 0 } else { 2 * proposals };
    }
    (method, best)
}

/// Draws from a mixture of t distributions around maxima, each with its log density. A maximum has the share of the density that
/// lies around it by its height and width, and [`LEAST_SHARE`] at least.
fn proposed_around(maxima: &[&Maximum], count: usize, random: &mut ChaCha8Rng) -> (Vec<DVector<f64>>, Vec<f64>) {
    let parts: Vec<Part> = maxima.iter().map(|maximum| Part::new(&maximum.u, &maximum.covariance)).collect();
    let around = |(maximum, part): (&&Maximum, &Part)| maximum.ln_density + part.root.diagonal().map(f64::ln).sum();
    let heights: Vec<f64> = maxima.iter().zip(&parts).map(around).collect();
    let all = ln_sum(&heights);
    let shares: Vec<f64> = heights.iter().map(|height| (height - all).exp().max(LEAST_SHARE)).collect();
    let whole: f64 = shares.iter().sum();
    let chi = ChiSquared::new(FREEDOM).expect("a positive number of degrees");
    let draw = |_: usize| {
        let mut place = random.random::<f64>() * whole;
        let index = shares.iter().position(|share| {
            place -= share;
            place < 0.0
        });
        let part = &parts[index.unwrap_or(parts.len() - 1)];
        let z = DVector::from_fn(part.mean.len(), |_, _| StandardNormal.sample(&mut *random));
        let stretch: f64 = FREEDOM / chi.sample(random);
        let draw = &part.mean + &part.root * z * stretch.sqrt();
        let terms: Vec<f64> =
            parts.iter().zip(&shares).map(|(part, share)| part.ln_density(&draw) + (share / whole).ln()).collect();
        (draw, ln_sum(&terms))
    };
    (0..count).map(draw).unzip()
}

/// One t distribution of a mixture.
struct Part {
    mean: DVector<f64>,
    /// Lower triangular root of its shape matrix.
    root: DMatrix<f64>,
    constant: f64,
}

impl Part {
    fn new(mean: &DVector<f64>, covariance: &DMatrix<f64>) -> Self {
        let (root, constant) = rooted(covariance);
        Self { mean: mean.clone(), root, constant }
    }

    fn ln_density(&self, u: &DVector<f64>) -> f64 {
        let square = self.root.solve_lower_triangular(&(u - &self.mean)).map_or(f64::INFINITY, |z| z.norm_squared());
        self.constant - 0.5 * (FREEDOM + u.len() as f64) * (square / FREEDOM).ln_1p()
    }
}

/// The lower triangular root of a shape matrix, and the logarithm of the constant of its t distribution.
fn rooted(covariance: &DMatrix<f64>) -> (DMatrix<f64>, f64) {
    let size = covariance.nrows() as f64;
    let root = match covariance.clone().cholesky() {
        Some(factor) => factor.l(),
        None => DMatrix::from_diagonal(&covariance.diagonal().map(|variance| variance.max(1e-12).sqrt())),
    };
    let constant = ln_gamma(0.5 * (FREEDOM + size))
        - ln_gamma(0.5 * FREEDOM)
        - 0.5 * size * (FREEDOM * std::f64::consts::PI).ln()
        - root.diagonal().map(f64::ln).sum();
    (root, constant)
}

/// Draws from the t distribution around a mean, each with its log density.
pub(crate) fn proposed(
    mean: &DVector<f64>,
    covariance: &DMatrix<f64>,
    count: usize,
    random: &mut ChaCha8Rng,
) -> (Vec<DVector<f64>>, Vec<f64>) {
    let size = mean.len();
    let (root, constant) = rooted(covariance);
    let chi = ChiSquared::new(FREEDOM).expect("a positive number of degrees");
    let mut draws = Vec::with_capacity(count);
    let mut densities = Vec::with_capacity(count);
    for _ in 0..count {
        let z = DVector::from_fn(size, |_, _| StandardNormal.sample(&mut *random));
        let stretch: f64 = FREEDOM / chi.sample(random);
        let square: f64 = stretch * z.norm_squared();
        densities.push(constant - 0.5 * (FREEDOM + size as f64) * (square / FREEDOM).ln_1p());
        draws.push(mean + &root * z * stretch.sqrt());
    }
    (draws, densities)
}

/// Draws with importance weights.
pub(crate) struct Weighted {
    /// Draws.
    pub draws: Vec<DVector<f64>>,
    /// Their smoothed weights.
    pub weights: Weights,
}

impl Weighted {
    /// Draws from a t distribution, weighted by the posterior of some edges.
    pub fn draw(
        model: &dyn Model,
        edges: &[usize],
        mean: &DVector<f64>,
        covariance: &DMatrix<f64>,
        count: usize,
        random: &mut ChaCha8Rng,
    ) -> Self {
        Self::weighed(model, edges, proposed(mean, covariance, count, random))
    }

    /// Draws from t distributions around several maxima, weighted by the posterior of some edges.
    fn around(model: &dyn Model, edges: &[usize], maxima: &[&Maximum], count: usize, random: &mut ChaCha8Rng) -> Self {
        Self::weighed(model, edges, proposed_around(maxima, count, random))
    }

    /// Draws with the log densities of their proposals, weighted by the posterior of some edges.
    fn weighed(model: &dyn Model, edges: &[usize], (draws, proposals): (Vec<DVector<f64>>, Vec<f64>)) -> Self {
        let ratio = |(draw, proposal): (&DVector<f64>, &f64)| model.ln_posterior(draw.as_slice(), edges) - proposal;
        let ratios: Vec<f64> = draws.par_iter().zip(&proposals).map(ratio).collect();
        Self { draws, weights: Weights::smoothed(&ratios) }
    }

    /// Whether the tail of the weights and their effective number let the draws be relied on.
    fn reliable(&self) -> bool {
        self.weights.shape <= TAIL && self.weights.effective() >= EFFECTIVE
    }

    /// Weighted mean and covariance.
    pub fn moments(&self) -> (DVector<f64>, DMatrix<f64>) {
        moments(&self.draws, &self.weights.weights)
    }

    /// Systematic resampling to equal weights, shuffled so that any first part of the draws is a sample.
    pub fn resampled(&self, count: usize, random: &mut ChaCha8Rng) -> Vec<DVector<f64>> {
        let offset: f64 = random.random();
        let mut chosen = Vec::with_capacity(count);
        let mut sum = 0.0;
        for (draw, weight) in self.draws.iter().zip(&self.weights.weights) {
            sum += weight * count as f64;
            while chosen.len() < count && chosen.len() as f64 + offset < sum {
                chosen.push(draw.clone());
            }
        }
        while chosen.len() < count {
            chosen.push(self.draws[self.draws.len() - 1].clone());
        }
        for i in (1..count).rev() {
            chosen.swap(i, random.random_range(0..=i));
        }
        chosen
    }
}

/// Weighted mean and covariance.
fn moments(draws: &[DVector<f64>], weights: &[f64]) -> (DVector<f64>, DMatrix<f64>) {
    let size = draws[0].len();
    let mut mean = DVector::zeros(size);
    draws.iter().zip(weights).for_each(|(draw, weight)| mean.axpy(*weight, draw, 1.0));
    let mut covariance = DMatrix::zeros(size, size);
    for (draw, weight) in draws.iter().zip(weights) {
        let off = draw - &mean;
        covariance.ger(*weight, &off, &off, 1.0);
    }
    (mean, covariance)
}
