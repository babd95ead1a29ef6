//! Profile intervals: how far a parameter can be moved while all others make the best of it.

use crate::fit::{Maximum, maximise};
use crate::model::Model;
use crate::parameter::Parameter;
use nalgebra::{DMatrix, DVector};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

/// Logarithms below the maximum at which a 90 % interval ends: half the 90 % point of χ² with one degree of freedom.
const DROP: f64 = 1.352_772;
/// Farthest end that is looked for, in standard deviations at the maximum.
const FARTHEST: f64 = 8.0;
/// Halvings of the bracket of an end: a hundredth of a standard deviation is left.
const HALVINGS: usize = 8;

/// A model with one parameter held.
struct ProfiledModel<'a> {
    model: &'a dyn Model,
    place: usize,
    value: f64,
    parameters: Vec<Parameter>,
}

impl ProfiledModel<'_> {
    fn whole(&self, u: &[f64]) -> Vec<f64> {
        let (before, after) = u.split_at(self.place);
        before.iter().chain(&[self.value]).chain(after).copied().collect()
    }
}

impl Model for ProfiledModel<'_> {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn edges(&self) -> usize {
        self.model.edges()
    }

    fn possible(&self, u: &[f64]) -> bool {
        self.model.possible(&self.whole(u))
    }

    fn ln_densities(&self, u: &[f64], edges: &[usize]) -> Vec<f64> {
        self.model.ln_densities(&self.whole(u), edges)
    }

    fn readings(&self, edge: usize) -> Vec<f64> {
        self.model.readings(edge)
    }

    fn replicate(&self, u: &[f64], edge: usize, random: &mut ChaCha8Rng) -> Vec<f64> {
        self.model.replicate(&self.whole(u), edge, random)
    }
}

/// Ends of the 90 % profile interval of every working coordinate; an end that is not found within eight standard deviations
/// is infinite.
pub fn profiles(model: &dyn Model, edges: &[usize], maximum: &Maximum) -> Vec<[f64; 2]> {
    let near = model.near(maximum.u.as_slice());
    let model = near.as_deref().unwrap_or(model);
    (0..maximum.u.len())
        .into_par_iter()
        .map(|place| [-1.0, 1.0].map(|way| end(model, edges, maximum, place, way)))
        .collect()
}

fn end(model: &dyn Model, edges: &[usize], at: &Maximum, place: usize, way: f64) -> f64 {
    let size = at.u.len();
    let others: Vec<usize> = (0..size).filter(|other| *other != place).collect();
    let deviation = at.covariance[(place, place)].sqrt();
    let mut parameters = model.parameters().to_vec();
    let moved = parameters.remove(place);
    let covariance = &at.covariance;
    // Covariance of the others given this one, and where they go with it.
    let conditional = DMatrix::from_fn(size - 1, size - 1, |i, j| {
        let (a, b) = (others[i], others[j]);
        covariance[(a, b)] - covariance[(a, place)] * covariance[(place, b)] / covariance[(place, place)]
    });
    let loss = |steps: f64| {
        let value = at.u[place] + way * steps * deviation;
        let held = ProfiledModel { model, place, value, parameters: parameters.clone() };
        let start = DVector::from_fn(size - 1, |i, _| {
            at.u[others[i]] + covariance[(others[i], place)] / covariance[(place, place)] * (value - at.u[place])
        });
        let found = if size == 1 {
            Some(held.ln_posterior(&[], edges))
        } else {
            maximise(&held, edges, &start, Some(&conditional)).map(|maximum| maximum.ln_density)
        };
        let prior = moved.prior.ln_density(value);
        found.map_or(f64::INFINITY, |density| at.ln_density - density - prior)
    };
    let (mut low, mut high) = (0.0, 2.0);
    while loss(high) < DROP {
        low = high;
        high *= 2.0;
        if high > FARTHEST {
            return way * f64::INFINITY;
        }
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if loss(middle) < DROP {
            low = middle;
        } else {
            high = middle;
        }
    }
    at.u[place] + way * 0.5 * (low + high) * deviation
}
