//! The maximum of a posterior density and its curvature there.
//!
//! A parameter ends where its range does. The search keeps so far from such an end that differences stay inside, and where the
//! density still rises towards it, the parameter stays there while the others go on.

use crate::model::Model;
use crate::range::Range;
use nalgebra::{DMatrix, DVector};

/// Step of the central differences, in prior standard deviations: the error of the gradient is then below 1e-6 of it.
const STEP: f64 = 1e-4;
/// Step of the second differences, in prior standard deviations.
const WIDE: f64 = 3e-3;
/// Iterations after which the search gives up; it takes 10 to 40.
const ITERATIONS: usize = 200;
/// Logarithms of density: a step that gains less ends the search.
const ENOUGH: f64 = 1e-9;

/// The same where a proposal is all that is wanted.
const ROUGHLY: f64 = 0.05;
/// The same where it is asked which of the known maxima the way up leads to.
const NEARLY: f64 = 1e-3;

/// A maximum of the posterior density.
#[derive(Clone, Debug, PartialEq)]
pub struct Maximum {
    /// Working coordinates.
    pub u: DVector<f64>,
    /// Log density there.
    pub ln_density: f64,
    /// Covariance of the normal distribution with the same curvature.
    pub covariance: DMatrix<f64>,
}

/// The posterior in coordinates that count prior standard deviations from prior means.
struct Scaled<'a> {
    model: &'a dyn Model,
    edges: &'a [usize],
    /// Where every coordinate may go.
    ranges: Vec<Range>,
}

impl<'a> Scaled<'a> {
    /// Around a start that is possible; else without ends.
    fn around(model: &'a dyn Model, edges: &'a [usize], start: &DVector<f64>) -> Self {
        let mut scaled = Self { model, edges, ranges: Vec::new() };
        let x = scaled.x(start);
        let possible = |x: &DVector<f64>| model.possible(scaled.u(x).as_slice());
        let ranges = (0..x.len()).map(|i| Range::from_possible(&possible, &x, i).within(2.0 * WIDE)).collect();
        scaled.ranges = ranges;
        scaled
    }

    /// The point inside the ranges nearest to one.
    fn inside(&self, mut x: DVector<f64>) -> DVector<f64> {
        x.iter_mut().zip(&self.ranges).for_each(|(x, range)| *x = range.nearest(*x));
        x
    }

    /// The gradient without what would lead out of the ranges.
    fn free(&self, x: &DVector<f64>, gradient: &DVector<f64>) -> DVector<f64> {
        DVector::from_fn(x.len(), |i, _| if self.ranges[i].stops(x[i], gradient[i]) { 0.0 } else { gradient[i] })
    }

    fn u(&self, x: &DVector<f64>) -> DVector<f64> {
        let parameters = self.model.parameters();
        DVector::from_fn(x.len(), |i, _| parameters[i].prior.mean + parameters[i].prior.deviation * x[i])
    }

    fn x(&self, u: &DVector<f64>) -> DVector<f64> {
        let parameters = self.model.parameters();
        DVector::from_fn(u.len(), |i, _| (u[i] - parameters[i].prior.mean) / parameters[i].prior.deviation)
    }

    fn density(&self, x: &DVector<f64>) -> f64 {
        self.model.ln_posterior(self.u(x).as_slice(), self.edges)
    }

    fn gradient(&self, x: &DVector<f64>) -> DVector<f64> {
        let mut point = x.clone();
        DVector::from_fn(x.len(), |i, _| {
            point[i] = x[i] + STEP;
            let density = self.density(&point);
            point[i] = x[i] - STEP;
            let below = self.density(&point);
            point[i] = x[i];
            (density - below) / (2.0 * STEP)
        })
    }

    /// Minus the matrix of second derivatives; `here` is the density at `x`.
    fn curvature(&self, x: &DVector<f64>, here: f64) -> DMatrix<f64> {
        let size = x.len();
        let moved = |i: usize, a: f64, j: usize, b: f64| {
            let mut point = x.clone();
            point[i] += a * WIDE;
            point[j] += b * WIDE;
            self.density(&point)
        };
        let ends: Vec<[f64; 2]> = (0..size).map(|i| [moved(i, 1.0, i, 0.0), moved(i, -1.0, i, 0.0)]).collect();
        let mut curvature = DMatrix::zeros(size, size);
        for i in 0..size {
            curvature[(i, i)] = (2.0 * here - ends[i][0] - ends[i][1]) / (WIDE * WIDE);
            for j in 0..i {
                let both = moved(i, 1.0, j, 1.0) + moved(i, -1.0, j, -1.0);
                let mixed = both - ends[i][0] - ends[i][1] - ends[j][0] - ends[j][1] + 2.0 * here;
                curvature[(i, j)] = -mixed / (2.0 * WIDE * WIDE);
                curvature[(j, i)] = curvature[(i, j)];
            }
        }
        curvature
    }
}

/// A direction that leaves out the coordinates in which the gradient is held at zero.
fn held(mut direction: DVector<f64>, free: &DVector<f64>) -> DVector<f64> {
    direction.iter_mut().zip(free.iter()).filter(|(_, free)| **free == 0.0).for_each(|(along, _)| *along = 0.0);
    direction
}

/// The way up from a start, until a step gains less than `enough` logarithms.
fn climb(
    scaled: &Scaled<'_>,
    start: &DVector<f64>,
    shape: Option<&DMatrix<f64>>,
    enough: f64,
) -> Option<(DVector<f64>, f64, DVector<f64>)> {
    let size = start.len();
    let deviation: Vec<f64> = scaled.model.parameters().iter().map(|parameter| parameter.prior.deviation).collect();
    let mut x = scaled.inside(scaled.x(start));
    let mut density = scaled.density(&x);
    if !density.is_finite() {
        return None;
    }
    let mut inverse = match shape {
        Some(shape) => DMatrix::from_fn(size, size, |i, j| shape[(i, j)] / (deviation[i] * deviation[j])),
        None => DMatrix::identity(size, size) * 0.01,
    };
    let mut gradient = scaled.gradient(&x);
    for _ in 0..ITERATIONS {
        let free = scaled.free(&x, &gradient);
        let mut direction = held(&inverse * &free, &free);
        if direction.dot(&free) <= 0.0 {
            inverse = DMatrix::identity(size, size) * 0.01;
            direction = &inverse * &free;
        }
        // A step of more than two prior deviations is a guess of a poor model.
        let length = direction.amax();
        if length > 2.0 {
            direction *= 2.0 / length;
        }
        let mut share = 1.0;
        let found = loop {
            let next = scaled.inside(&x + &direction * share);
            let value = scaled.density(&next);
            let slope = free.dot(&(&next - &x));
            if value >= density + 1e-4 * slope {
                break Some((next, value));
            }
            share *= 0.4;
            if share < 1e-9 {
                break None;
            }
        };
        let Some((next, value)) = found else { break };
        let next_gradient = scaled.gradient(&next);
        let step = &next - &x;
        let change = &gradient - &next_gradient;
        let product = step.dot(&change);
        if product > 1e-12 * step.norm() * change.norm() {
            let rho = 1.0 / product;
            let left = DMatrix::identity(size, size) - rho * &step * change.transpose();
            inverse = &left * inverse * left.transpose() + rho * &step * step.transpose();
        }
        let gain = value - density;
        (x, density, gradient) = (next, value, next_gradient);
        if gain < enough {
            break;
        }
    }
    Some((x, density, gradient))
}

/// The maximum of the posterior of nearly all edges near that of all, roughly: where draws are weighted, the place of the
/// proposal need not be exact. `shape` is the covariance that the result is given.
pub(crate) fn maximise_near(
    model: &dyn Model,
    edges: &[usize],
    full: &Maximum,
    shape: DMatrix<f64>,
) -> Option<Maximum> {
    let scaled = Scaled::around(model, edges, &full.u);
    let (x, ln_density, _) = climb(&scaled, &full.u, Some(&shape), ROUGHLY)?;
    Some(Maximum { u: scaled.u(&x), ln_density, covariance: shape })
}

/// About where the way up from a start ends.
pub(crate) fn climbed(
    model: &dyn Model,
    edges: &[usize],
    start: &DVector<f64>,
    shape: Option<&DMatrix<f64>>,
) -> Option<DVector<f64>> {
    let scaled = Scaled::around(model, edges, start);
    climb(&scaled, start, shape, NEARLY).map(|(x, ..)| scaled.u(&x))
}

/// The maximum of the posterior of some edges nearest to a start, by the BFGS method (Nocedal and Wright, Numerical
/// Optimization, 2006, algorithm 6.1), polished by Newton steps. `shape` is a covariance to begin with. `None` where no
/// density is found.
pub fn maximise(
    model: &dyn Model,
    edges: &[usize],
    start: &DVector<f64>,
    shape: Option<&DMatrix<f64>>,
) -> Option<Maximum> {
    let scaled = Scaled::around(model, edges, start);
    let size = start.len();
    let deviation: Vec<f64> = model.parameters().iter().map(|parameter| parameter.prior.deviation).collect();
    let (mut x, mut density, mut gradient) = climb(&scaled, start, shape, ENOUGH)?;
    let mut curvature = scaled.curvature(&x, density);
    for _ in 0..3 {
        let free = scaled.free(&x, &gradient);
        let Some(factor) = among(&curvature, &free).cholesky() else { break };
        let step = factor.solve(&free);
        let next = scaled.inside(&x + &step);
        let value = scaled.density(&next);
        if !(value > density && step.amax() < 0.5) {
            break;
        }
        let far = step.amax() > 0.02;
        (x, density, gradient) = (next.clone(), value, scaled.gradient(&next));
        if far {
            curvature = scaled.curvature(&x, density);
        } else {
            break;
        }
    }
    let covariance = positive(curvature).try_inverse()?;
    let covariance = DMatrix::from_fn(size, size, |i, j| covariance[(i, j)] * deviation[i] * deviation[j]);
    Some(Maximum { u: scaled.u(&x), ln_density: density, covariance })
}

/// The curvature without what joins coordinates that are held at zero to the others.
fn among(curvature: &DMatrix<f64>, free: &DVector<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(free.len(), free.len(), |i, j| {
        if i == j || free[i] != 0.0 && free[j] != 0.0 { curvature[(i, j)] } else { 0.0 }
    })
}

/// Least curvature that is believed, half of the prior's own (assumption).
const FLATTEST: f64 = 0.5;

/// The matrix with its eigenvalues kept above [`FLATTEST`]: in these coordinates the prior alone has the curvature one,
/// and a direction that seems flatter is bent by the likelihood's tail.
fn positive(matrix: DMatrix<f64>) -> DMatrix<f64> {
    let mut eigen = matrix.symmetric_eigen();
    eigen.eigenvalues.apply(|value| *value = value.max(FLATTEST));
    eigen.recompose()
}
