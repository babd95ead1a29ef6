//! The model of wear readings and lives.

use crate::curve::Curve;
use crate::edge::{Common, Edge, InLife};
use crate::law::Law;
use crate::model::Model;
use crate::parameter::{Parameter, Prior, Scale};
use toolroom_wear::{Cut, Pair};

/// Median of an edge's scatter beforehand, and the standard deviation of its logarithm. The prior keeps away from zero: a
/// half-normal one lets the maximum collapse there with few edges (Chung et al. 2013).
const SCATTER: (f64, f64) = (0.20, 0.6);
/// Median of the noise of a wear reading in mm (0.010 mm of reading and 0.005 mm of repeatability), and the standard
/// deviation of its logarithm.
const NOISE: (f64, f64) = (0.011, 0.5);
/// The tables reach this much beyond the greatest wear read, or the limit.
const BEYOND: f64 = 1.25;

/// Readings and lives of edges under a wear law.
#[derive(Clone, Debug)]
pub struct WearModel {
    /// The law.
    pub law: Law,
    base: Pair,
    parameters: Vec<Parameter>,
    laws: usize,
    conditions: Vec<Cut>,
    edges: Vec<Edge>,
    limit: f64,
    in_life: Option<InLife>,
    greatest: f64,
    scatter: usize,
    noise: Option<usize>,
}

impl WearModel {
    /// The model of `edges`, which were cut at `conditions`. What the law does not say is taken from `base`; `limit` in
    /// mm is the flank wear at which lives end.
    pub fn new(law: Law, base: &Pair, conditions: Vec<Cut>, edges: Vec<Edge>, limit: f64) -> Self {
        let mut parameters = law.parameters(base);
        let laws = parameters.len();
        let ln = |(median, deviation): (f64, f64)| Prior::new(f64::ln(median), deviation);
        parameters.push(Parameter::new("edge_scatter", "1", Scale::Logarithm, ln(SCATTER), "measure more edges"));
        let read = edges.iter().flat_map(|edge| edge.stretches.iter().filter_map(|stretch| stretch.wear));
        let greatest = read.clone().fold(limit, f64::max) * BEYOND;
        let noise = (read.count() > 0).then_some(laws + 1);
        if noise.is_some() {
            let lift = "read the wear of an edge more than once";
            parameters.push(Parameter::new("reading_noise", "mm", Scale::Logarithm, ln(NOISE), lift));
        }
        let (scatter, base) = (laws, base.clone());
        Self { law, base, parameters, laws, conditions, edges, limit, in_life: None, greatest, scatter, noise }
    }

    /// Sets the prior of a parameter; `false` where there is none of this name.
    pub fn set_prior(&mut self, name: &str, prior: Prior) -> bool {
        let found = self.parameters.iter_mut().find(|parameter| parameter.name == name);
        found.map(|parameter| parameter.prior = prior).is_some()
    }

    /// Sets the noise of the rate within a life.
    pub fn set_in_life(&mut self, noise: Option<InLife>) {
        self.in_life = noise;
    }

    /// The edges.
    pub fn measured(&self) -> &[Edge] {
        &self.edges
    }

    /// Curves of all conditions that some edges met.
    fn curves(&self, u: &[f64], edges: &[usize]) -> Vec<Curve> {
        let mut needed = vec![false; self.conditions.len()];
        for edge in edges.iter().map(|index| &self.edges[*index]) {
            edge.stretches.iter().for_each(|stretch| needed[stretch.condition] = true);
            if let Some((condition, _)) = edge.life {
                needed[condition] = true;
            }
        }
        let values = self.values(u);
        let curve = |(cut, needed): (&Cut, bool)| if needed { self.curve(cut, &values) } else { Curve::default() };
        self.conditions.iter().zip(needed).map(curve).collect()
    }

    fn curve(&self, cut: &Cut, values: &[f64]) -> Curve {
        let rate = self.law.rate(&self.base, cut, self.limit, &values[..self.laws]);
        Curve::new(self.greatest, rate)
    }

    /// Values of the parameters in their units.
    fn values(&self, u: &[f64]) -> Vec<f64> {
        self.parameters.iter().zip(u).map(|(parameter, u)| parameter.scale.value(*u)).collect()
    }

    /// Life in min of an edge of median level under a cut.
    pub fn life(&self, u: &[f64], cut: &Cut) -> f64 {
        self.curve(cut, &self.values(u)).time(self.limit)
    }

    fn common<'a>(&self, u: &[f64], curves: &'a [Curve]) -> Common<'a> {
        Common {
            curves,
            scatter: u[self.scatter].exp(),
            noise: self.noise.map_or(f64::NAN, |index| u[index].exp()),
            in_life: self.in_life,
            limit: self.limit,
        }
    }
}

impl Model for WearModel {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn edges(&self) -> usize {
        self.edges.len()
    }

    fn ln_likelihood(&self, u: &[f64], edges: &[usize]) -> f64 {
        let curves = self.curves(u, edges);
        let common = self.common(u, &curves);
        edges.iter().map(|index| common.ln_density(&self.edges[*index])).sum()
    }
}
