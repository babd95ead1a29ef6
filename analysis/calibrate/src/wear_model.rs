//! The model of wear readings and lives.

use crate::curve::Curve;
use crate::edge::{Common, Edge, InLife, Predicted};
use crate::law::{Law, ending_at, with_values};
use crate::model::Model;
use crate::parameter::{Parameter, Prior, Scale};
use rand_chacha::ChaCha8Rng;
use toolroom_wear::{Cut, Pair, WearLaw};

/// Median of an edge's scatter beforehand, and the standard deviation of its logarithm. The prior keeps away from zero: a
/// half-normal one lets the maximum collapse there with few edges (Chung et al. 2013).
const SCATTER: (f64, f64) = (0.20, 0.6);
/// Median of the noise of a wear reading in mm (0.010 mm of reading and 0.005 mm of repeatability), and the standard
/// deviation of its logarithm.
const NOISE: (f64, f64) = (0.011, 0.5);
/// The tables reach this much beyond the greatest wear read, or the limit.
const BEYOND: f64 = 1.25;

/// mm/min of a rate in m/s.
const MM_PER_MIN: f64 = 6e4;

/// Where the value of a parameter of the law comes from.
#[derive(Clone, Copy, Debug)]
enum Slot {
    /// The working coordinate of this index.
    Free(usize),
    /// A fixed value.
    Fixed(f64),
}

/// Readings and lives of edges under a wear law.
#[derive(Clone, Debug)]
pub struct WearModel {
    /// The law.
    pub law: Law,
    base: Pair,
    template: WearLaw,
    parameters: Vec<Parameter>,
    slots: Vec<Slot>,
    conditions: Vec<Cut>,
    edges: Vec<Edge>,
    limit: f64,
    in_life: Option<InLife>,
    greatest: f64,
}

/// Name of the scatter of edges among the parameters.
pub const EDGE_SCATTER: &str = toolroom_wear::EDGE_SCATTER_NAME;
/// Name of the noise of wear readings among the parameters.
pub const READING_NOISE: &str = toolroom_wear::READING_NOISE_NAME;

impl WearModel {
    /// The model of `edges`, which were cut at `conditions`. What the law does not say is taken from `base`; `limit` in
    /// mm is the flank wear at which lives end. The tilt of Taylor's wear curve is fixed at zero: with the contrast
    /// free as well, few designs tell the two apart.
    pub fn new(law: Law, base: &Pair, conditions: Vec<Cut>, edges: Vec<Edge>, limit: f64) -> Self {
        let template = ending_at(law.template(base), limit);
        let mut parameters = law.parameters(&template);
        let slots = (0..parameters.len()).map(Slot::Free).collect();
        let ln = |(median, deviation): (f64, f64)| Prior::new(f64::ln(median), deviation);
        let lift = "measure more edges";
        parameters.push(Parameter::new(EDGE_SCATTER, "1", Scale::Logarithm, ln(SCATTER), lift));
        let read = edges.iter().flat_map(|edge| edge.stretches.iter().filter_map(|stretch| stretch.wear));
        let greatest = read.clone().fold(limit, f64::max) * BEYOND;
        let curved = read.count() > 0;
        if curved {
            let lift = "read the wear of an edge more than once";
            parameters.push(Parameter::new(READING_NOISE, "mm", Scale::Logarithm, ln(NOISE), lift));
        }
        let base = base.clone();
        let mut model =
            Self { law, base, template, parameters, slots, conditions, edges, limit, in_life: None, greatest };
        if law == Law::ExtendedTaylor {
            model.fix("extended_taylor.stage_tilt", 0.0);
            if !curved {
                // Lives alone say nothing of the way to them.
                model.fix("extended_taylor.stage_contrast", 0.0);
            }
        }
        model
    }

    /// Fixes a parameter of the law at a value in its unit; `false` where none of this name is free.
    pub fn fix(&mut self, name: &str, value: f64) -> bool {
        let Some(index) = self.index(name) else { return false };
        let Some(slot) = self.slots.iter().position(|slot| matches!(slot, Slot::Free(free) if *free == index)) else {
            return false;
        };
        self.slots[slot] = Slot::Fixed(value);
        self.parameters.remove(index);
        for slot in &mut self.slots {
            match slot {
                Slot::Free(free) if *free > index => *free -= 1,
                Slot::Free(_) | Slot::Fixed(_) => {}
            }
        }
        true
    }

    /// Whether a parameter of the law of this name is fixed already.
    pub fn fixed(&self, name: &str) -> bool {
        let all = self.law.parameters(&self.template);
        let slot = all.iter().position(|parameter| parameter.name == name).map(|index| self.slots[index]);
        matches!(slot, Some(Slot::Fixed(_)))
    }

    fn index(&self, name: &str) -> Option<usize> {
        self.parameters.iter().position(|parameter| parameter.name == name)
    }

    /// Sets the prior of a free parameter; a mean of NaN keeps the present one. `false` where none of this name is free.
    pub fn set_prior(&mut self, name: &str, prior: Prior) -> bool {
        let found = self.parameters.iter_mut().find(|parameter| parameter.name == name);
        let set = |parameter: &mut Parameter| {
            let mean = if prior.mean.is_nan() { parameter.prior.mean } else { prior.mean };
            parameter.prior = Prior { mean, ..prior };
        };
        found.map(set).is_some()
    }

    /// Sets the noise of the rate within a life.
    pub fn set_in_life(&mut self, noise: Option<InLife>) {
        self.in_life = noise;
    }

    /// The edges.
    pub fn measured(&self) -> &[Edge] {
        &self.edges
    }

    /// The set from which everything comes that the law does not say.
    pub(crate) fn base(&self) -> &Pair {
        &self.base
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
        let pair = self.pair(u);
        let curve = |(cut, needed): (&Cut, bool)| if needed { self.curve(cut, &pair) } else { Curve::default() };
        self.conditions.iter().zip(needed).map(curve).collect()
    }

    fn curve(&self, cut: &Cut, pair: &Pair) -> Curve {
        let contact = pair.contact(cut);
        Curve::new(self.greatest, |wear| MM_PER_MIN * contact.steady_wear(wear * 1e-3).rate(cut.cutting_speed))
    }

    /// The base set with the law at some working coordinates.
    pub fn pair(&self, u: &[f64]) -> Pair {
        let all = self.law.parameters(&self.template);
        let value = |(slot, parameter): (&Slot, &Parameter)| match slot {
            Slot::Free(index) => parameter.scale.value(u[*index]),
            Slot::Fixed(value) => *value,
        };
        let values: Vec<f64> = self.slots.iter().zip(&all).map(value).collect();
        Pair { law: with_values(&self.template, &values), ..self.base.clone() }
    }

    /// Whether every value of the law lies in its range, so that parameter files and shops take it.
    fn possible(&self, u: &[f64]) -> bool {
        let mut pair = self.pair(u);
        let record = pair.law.record_mut();
        let within = |(index, field): (usize, &toolroom_process::Field)| {
            record.value(index).is_some_and(|value| field.check(value).is_ok())
        };
        record.fields().iter().enumerate().all(within)
    }

    /// Life in min of an edge of median level under a cut.
    pub fn life(&self, u: &[f64], cut: &Cut) -> f64 {
        self.curve(cut, &self.pair(u)).time(self.limit)
    }

    /// The level of an edge at which its readings are most probable together with the level itself.
    pub(crate) fn level(&self, u: &[f64], edge: &Edge) -> f64 {
        let all = self.edges.iter().position(|other| other.name == edge.name);
        let curves = self.curves(u, &all.into_iter().collect::<Vec<_>>());
        self.common(u, &curves).level(edge)
    }

    /// Wear at the readings of an edge at a level, mm.
    pub(crate) fn course(&self, u: &[f64], edge: &Edge, level: f64) -> Vec<f64> {
        let all = self.edges.iter().position(|other| other.name == edge.name);
        let curves = self.curves(u, &all.into_iter().collect::<Vec<_>>());
        let mut predicted = Predicted::default();
        self.common(u, &curves).predict(edge, level, 1, &mut predicted);
        predicted.wear
    }

    fn common<'a>(&self, u: &[f64], curves: &'a [Curve]) -> Common<'a> {
        Common {
            curves,
            scatter: self.index(EDGE_SCATTER).map_or(f64::NAN, |index| u[index].exp()),
            noise: self.index(READING_NOISE).map_or(f64::NAN, |index| u[index].exp()),
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

    fn readings(&self, edge: usize) -> Vec<f64> {
        self.edges[edge].stretches.iter().filter_map(|stretch| stretch.wear).collect()
    }

    fn replicate(&self, u: &[f64], edge: usize, random: &mut ChaCha8Rng) -> Vec<f64> {
        let curves = self.curves(u, &[edge]);
        self.common(u, &curves).replicate(&self.edges[edge], random)
    }

    fn ln_likelihood(&self, u: &[f64], edges: &[usize]) -> f64 {
        if !self.possible(u) {
            return f64::NEG_INFINITY;
        }
        let curves = self.curves(u, edges);
        let common = self.common(u, &curves);
        edges.iter().map(|index| common.ln_density(&self.edges[*index])).sum()
    }
}
