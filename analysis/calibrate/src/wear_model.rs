//! The model of wear readings and lives.

use crate::base::{Base, Condition};
use crate::curve::Curve;
use crate::edge::{Common, Edge, Life, Predicted, Stretch};
use crate::in_life::InLife;
use crate::law::{Law, with_values};
use crate::model::Model;
use crate::parameter::{Parameter, Prior, Scale};
use crate::shape::{Candidate, Shape};
use crate::slot::Slot;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use toolroom_wear::wear_stage;

/// Median of an edge's scatter beforehand, and the standard deviation of its logarithm. The prior keeps away from zero: a
/// half-normal one lets the maximum collapse there with few edges (Chung et al. 2013).
const SCATTER: (f64, f64) = (0.20, 0.6);
/// Median of the noise of a wear reading in mm (0.010 mm of reading and 0.005 mm of repeatability), and the standard
/// deviation of its logarithm.
const NOISE: (f64, f64) = (0.011, 0.5);
/// The tables reach this much beyond the greatest wear read, or the limit.
const BEYOND: f64 = 1.25;

/// Standard deviation of the logarithm of how much faster edges of another group wear (assumption: a factor of two, as of a
/// level from a handbook).
const GROUP: f64 = 0.7;

/// Median noise of the rate within a life, and the standard deviation of its logarithm (assumption, as of a shop).
const LIFE_NOISE: (f64, f64) = (0.10, 0.5);
/// Name of the noise of the rate within a life among the parameters.
pub const LIFE_NOISE_NAME: &str = "life_noise";

/// Standard deviation of the logarithm of a level in operations, of which no set knows anything (assumption: a factor of 4.5
/// around what the edges of the data lasted).
const OPERATIONS: f64 = 1.5;
/// Exponent of speed of lives in operations (assumption: anything between rising and falling steeply).
const PER_OPERATION: Prior = Prior { mean: 1.0, deviation: 2.0 };
/// Points along the life of an edge at which its wear is worked out for the hazard of chipping.
const FINE: usize = 64;

/// Edges from which on those with [`FOLLOWED`] readings are followed from the level that they have at the maximum, instead of
/// being looked for anew at every point (assumption: what it spares is then seconds).
const FEW: usize = 24;
/// Readings that give the level of an edge a single most probable value (assumption).
const FOLLOWED: usize = 4;
/// Edges that are worth more than one thread (assumption: a tenth of a millisecond of work).
const PARALLEL: usize = 48;

/// Speeds within this factor are one speed, of which no exponent follows (assumption).
pub(crate) const ONE_SPEED: f64 = 1.2;
/// The same of feeds, depths and widths (assumption: a shop does not call that another feed).
pub(crate) const ONE_VALUE: f64 = 1.05;

/// mm/min of a rate in m/s.
const MM_PER_MIN: f64 = 6e4;

/// Readings and lives of edges under a wear law.
#[derive(Clone, Debug)]
pub struct WearModel {
    /// The law.
    pub law: Law,
    /// The shape of its wear curve.
    pub shape: Shape,
    pub(crate) template: Base,
    pub(crate) parameters: Vec<Parameter>,
    pub(crate) slots: Vec<Slot>,
    /// Names of the parameters of groups of edges, from group 1 on.
    groups: Vec<String>,
    conditions: Vec<Condition>,
    edges: Vec<Edge>,
    limit: f64,
    in_life: Option<InLife>,
    greatest: f64,
    /// Whether the exponent of speed may be anything, since lives do not count time.
    pub(crate) any_speed: bool,
}

/// Name of the scatter of edges among the parameters.
pub const EDGE_SCATTER: &str = toolroom_wear::EDGE_SCATTER_NAME;
/// Name of the noise of wear readings among the parameters.
pub const READING_NOISE: &str = toolroom_wear::READING_NOISE_NAME;

/// What edges have beside the law: their scatter, and the error of a reading.
pub(crate) fn of_edges() -> [Parameter; 2] {
    let ln = |(median, deviation): (f64, f64)| Prior::new(f64::ln(median), deviation);
    [
        Parameter::new(EDGE_SCATTER, "1", Scale::Logarithm, ln(SCATTER), "measure more edges"),
        Parameter::new(READING_NOISE, "mm", Scale::Logarithm, ln(NOISE), "read the wear of an edge more than once"),
    ]
}

impl WearModel {
    /// The model of `edges`, which were cut at `conditions`. What the law does not say is taken from `base`; `limit` in
    /// mm is the flank wear at which lives end. The tilt of a wear curve is free for [`Shape::Tilted`] only: with the contrast
    /// free as well, few designs tell the two apart.
    pub fn new(
        candidate: impl Into<Candidate>,
        base: impl Into<Base>,
        conditions: impl IntoIterator<Item = impl Into<Condition>>,
        edges: Vec<Edge>,
        limit: f64,
    ) -> Self {
        let (Candidate { law, shape }, base) = (candidate.into(), base.into());
        let template = law.template(&base, limit);
        let mut parameters = law.parameters(&template);
        let slots = (0..parameters.len()).map(Slot::Free).collect();
        let [scatter, reading] = of_edges();
        parameters.push(scatter);
        let read = edges.iter().flat_map(|edge| edge.stretches.iter().filter_map(|stretch| stretch.wear));
        let greatest = read.clone().fold(limit, f64::max) * BEYOND;
        let curved = read.count() > 0;
        if curved {
            parameters.push(reading);
        }
        let conditions = conditions.into_iter().map(Into::into).collect();
        let (groups, in_life) = (Vec::new(), None);
        let mut model = Self {
            law,
            shape,
            template,
            parameters,
            slots,
            groups,
            conditions,
            edges,
            limit,
            in_life,
            greatest,
            any_speed: false,
        };
        if law.states_lives() {
            let fix = |model: &mut Self, key: &str| model.fix(&format!("{}.{key}", law.group()), 0.0);
            // Lives alone say nothing of the way to them.
            if shape != Shape::Tilted || !curved {
                fix(&mut model, "stage_tilt");
            }
            if shape == Shape::Straight || !curved {
                fix(&mut model, "stage_contrast");
            }
        }
        model
    }

    /// The same with groups of edges that wear faster than those of group 0 by factors to be found; `names` are those of the
    /// factors, from group 1 on.
    #[must_use]
    pub fn with_groups(mut self, names: &[String]) -> Self {
        for name in names {
            let lift = "measure edges of both groups under the same conditions";
            let prior = Prior::new(0.0, GROUP);
            self.parameters.push(Parameter::new(name.clone(), "1", Scale::Logarithm, prior, lift));
        }
        self.groups = names.to_vec();
        self
    }

    /// The law with the shape of its wear curve.
    pub fn candidate(&self) -> Candidate {
        Candidate { law: self.law, shape: self.shape }
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

    /// Lets lives count operations instead of minutes: their level is around `life` at `condition`, and they may rise or fall
    /// with speed, since a faster operation is a shorter one.
    #[must_use]
    pub(crate) fn by_operations(mut self, life: f64, condition: &Condition) -> Self {
        self.template.taylor_referred_to(condition);
        let group = self.law.group();
        for parameter in &mut self.parameters {
            if parameter.name == format!("{group}.reference_life") {
                (parameter.unit, parameter.prior) = ("operations", Prior::new(life.ln(), OPERATIONS));
            } else if parameter.name == format!("{group}.speed_exponent") {
                (parameter.scale, parameter.prior) = (Scale::Plain, PER_OPERATION);
                self.any_speed = true;
            }
        }
        self
    }

    /// Lets the wear rate wander within a life with this correlation time in min, by how much is to be found.
    #[must_use]
    pub fn with_life_noise(mut self, correlation: f64) -> Self {
        let prior = Prior::new(LIFE_NOISE.0.ln(), LIFE_NOISE.1);
        let lift = "read the wear of six edges four times or more each";
        self.parameters.push(Parameter::new(LIFE_NOISE_NAME, "1", Scale::Logarithm, prior, lift));
        self.in_life = Some(InLife { deviation: LIFE_NOISE.0, correlation });
        self
    }

    /// Sets the noise of the rate within a life.
    pub fn set_in_life(&mut self, noise: Option<InLife>) {
        self.in_life = noise;
    }

    /// The same with other edges under the same conditions.
    pub(crate) fn measuring(&self, edges: Vec<Edge>) -> Self {
        let read = edges.iter().flat_map(|edge| edge.stretches.iter().filter_map(|stretch| stretch.wear));
        let greatest = read.fold(self.greatest / BEYOND, f64::max) * BEYOND;
        Self { edges, greatest, ..self.clone() }
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
        let base = self.at(u);
        let mut curves: Vec<Curve> = Vec::with_capacity(needed.len());
        for (index, condition) in self.conditions.iter().enumerate() {
            if !needed[index] {
                curves.push(Curve::default());
                continue;
            }
            let known = (0..index).find(|other| {
                needed[*other] && (self.law.states_lives() || self.conditions[*other].same_cut(condition))
            });
            let known = known.map(|other| (&curves[other], &self.conditions[other]));
            let curve = self.curve(u, condition, &base, known);
            curves.push(curve);
        }
        curves
    }

    /// The curve of a condition; `known` is one whose table it may share, with its condition.
    fn curve(&self, u: &[f64], condition: &Condition, base: &Base, known: Option<(&Curve, &Condition)>) -> Curve {
        let group = |condition: &Condition| self.group(u, condition.group);
        if let Some((life, contrast, tilt)) = base.taylor(condition) {
            let pace = group(condition) / life;
            if let Some((curve, other)) = known
                && let Some((other_life, ..)) = base.taylor(other)
            {
                return curve.faster(pace / (group(other) / other_life));
            }
            // One table for a life of one minute: other lives only stretch it.
            let rate = |wear: f64| self.limit / wear_stage(wear / self.limit, contrast, tilt);
            let table = Curve::bent(self.greatest, self.limit, rate);
            return table.faster(pace);
        }
        match (base, known) {
            (_, Some((curve, other))) => curve.faster(group(condition) / group(other)),
            (Base::Turning { pair, .. }, None) => {
                let (cut, contact) = (&condition.cut, pair.contact(&condition.cut));
                let rate = |wear: f64| MM_PER_MIN * contact.steady_wear(wear * 1e-3).rate(cut.cutting_speed);
                Curve::new(self.greatest, rate).faster(group(condition))
            }
            (Base::Milling { .. }, None) => Curve::default(),
        }
    }

    /// How much faster than those of group 0 edges of a group wear.
    fn group(&self, u: &[f64], group: usize) -> f64 {
        let name = group.checked_sub(1).and_then(|place| self.groups.get(place));
        name.and_then(|name| self.index(name)).map_or(1.0, |index| u[index].exp())
    }

    /// The set with the law at some working coordinates.
    pub fn at(&self, u: &[f64]) -> Base {
        let mut values: Vec<f64> = Vec::with_capacity(self.slots.len());
        for slot in &self.slots {
            values.push(match slot {
                Slot::Free(index) => self.parameters[*index].scale.value(u[*index]),
                Slot::Fixed(value) => *value,
                // Counted in shares of what the contrast, which stands before it, leaves.
                Slot::Tilt(tilt) => tilt / (1.0 - values.last().expect("the contrast stands before the tilt")),
            });
        }
        with_values(&self.template, &values)
    }

    /// The wear of an edge along its cutting path, km and mm, at the level that fits it best.
    pub(crate) fn exposure(&self, u: &[f64], edge: &Edge) -> Vec<(f64, f64)> {
        let base = self.at(u);
        let (mut path, mut course, mut fine) = (0.0, vec![(0.0, 0.0)], Vec::new());
        let whole = edge.life.iter().map(|(condition, life)| {
            let (Life::Exact(time) | Life::Censored(time) | Life::Between(_, time)) = life;
            Stretch::unread(*condition, *time)
        });
        let stretches: Vec<Stretch> = if edge.stretches.is_empty() { whole.collect() } else { edge.stretches.clone() };
        for stretch in &stretches {
            let condition = &self.conditions[stretch.condition];
            let pieces = FINE.div_ceil(stretches.len()).max(1);
            let time = stretch.time / pieces as f64;
            for _ in 0..pieces {
                // m/s and min make 60 m.
                path += condition.cut.cutting_speed * base.share_in_cut(condition) * time * 0.06;
                course.push((path, f64::NAN));
                fine.push(Stretch::read(stretch.condition, time, 0.0));
            }
        }
        let read = Edge { stretches: fine, ..edge.clone() };
        let level = if edge.readings() > 0 { self.level(u, edge) } else { 1.0 };
        let wear = self.course(u, &read, level);
        course.iter_mut().skip(1).zip(wear).for_each(|(point, wear)| point.1 = wear);
        course
    }

    /// Whether every value of the law lies in its range, so that parameter files and shops take it.
    fn in_range(&self, u: &[f64]) -> bool {
        let mut base = self.at(u);
        let record = base.law_mut();
        let within = |(index, field): (usize, &toolroom_process::Field)| {
            let free = self.any_speed && field.name == "speed_exponent";
            free || record.value(index).is_some_and(|value| field.check(value).is_ok())
        };
        record.fields().iter().enumerate().all(within) && base.stages().is_ok()
    }

    /// Life in min of an edge of median level under a condition.
    pub fn life(&self, u: &[f64], condition: impl Into<Condition>) -> f64 {
        let condition = condition.into();
        let base = self.at(u);
        match base.taylor(&condition) {
            Some((life, ..)) => life / self.group(u, condition.group),
            None => self.curve(u, &condition, &base, None).time(self.limit),
        }
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
        self.common(u, &curves).predict(edge, edge.begun.unwrap_or(0.0), level, 1, &mut predicted);
        predicted.wear
    }

    /// Log densities of edges; `levels` are logarithms near which the levels of edges are, where they are known.
    fn ln_densities_near(&self, u: &[f64], edges: &[usize], levels: &[f64]) -> Vec<f64> {
        if !self.in_range(u) {
            return vec![f64::NEG_INFINITY; edges.len()];
        }
        let curves = self.curves(u, edges);
        let common = self.common(u, &curves);
        let near = |index: usize| levels.get(index).copied().filter(|level| level.is_finite());
        let one = |index: &usize| common.ln_density_near(&self.edges[*index], near(*index));
        if edges.len() < PARALLEL { edges.iter().map(one).collect() } else { edges.par_iter().map(one).collect() }
    }

    fn common<'a>(&self, u: &[f64], curves: &'a [Curve]) -> Common<'a> {
        Common {
            curves,
            scatter: self.index(EDGE_SCATTER).map_or(f64::NAN, |index| u[index].exp()),
            noise: self.index(READING_NOISE).map_or(f64::NAN, |index| u[index].exp()),
            in_life: self.in_life.map(|noise| InLife {
                deviation: self.index(LIFE_NOISE_NAME).map_or(noise.deviation, |index| u[index].exp()),
                ..noise
            }),
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

    fn possible(&self, u: &[f64]) -> bool {
        self.in_range(u)
    }

    fn untold(&self) -> Vec<usize> {
        let spread = |of: &dyn Fn(&Condition) -> f64| {
            let met = self.edges.iter().flat_map(|edge| {
                let of_life = edge.life.iter().map(|(condition, _)| *condition);
                edge.stretches.iter().map(|stretch| stretch.condition).chain(of_life)
            });
            let values = met.map(|condition| of(&self.conditions[condition]));
            let (least, greatest) = values.fold((f64::INFINITY, 0.0_f64), |(a, b), value| (a.min(value), b.max(value)));
            greatest / least
        };
        let same = [
            ("speed_exponent", spread(&|condition| condition.cut.cutting_speed) < ONE_SPEED),
            ("feed_exponent", spread(&|condition| condition.cut.feed_per_rev) < ONE_VALUE),
            ("depth_exponent", spread(&|condition| condition.cut.depth_of_cut) < ONE_VALUE),
            ("width_exponent", spread(&|condition| condition.width.unwrap_or(1.0)) < ONE_VALUE),
        ];
        let named = |name: &str| self.index(&format!("{}.{name}", self.law.group()));
        same.into_iter().filter(|(_, same)| *same).filter_map(|(name, _)| named(name)).collect()
    }

    fn readings(&self, edge: usize) -> Vec<f64> {
        self.edges[edge].stretches.iter().filter_map(|stretch| stretch.wear).collect()
    }

    fn replicate(&self, u: &[f64], edge: usize, random: &mut ChaCha8Rng) -> Vec<f64> {
        let curves = self.curves(u, &[edge]);
        self.common(u, &curves).replicate(&self.edges[edge], random)
    }

    fn replicate_each(&self, u: &[f64], edges: &[usize], random: &mut ChaCha8Rng) -> Vec<Vec<f64>> {
        let curves = self.curves(u, edges);
        let common = self.common(u, &curves);
        edges.iter().map(|edge| common.replicate(&self.edges[*edge], random)).collect()
    }

    fn ln_densities(&self, u: &[f64], edges: &[usize]) -> Vec<f64> {
        self.ln_densities_near(u, edges, &[])
    }

    fn near(&self, u: &[f64]) -> Option<Box<dyn Model + '_>> {
        let enough = self.edges.len() > FEW;
        let many = |edge: &Edge| edge.well_read() || enough && edge.readings() >= FOLLOWED;
        if !self.edges.iter().any(many) || !self.in_range(u) {
            return None;
        }
        let all: Vec<usize> = (0..self.edges.len()).collect();
        let curves = self.curves(u, &all);
        let common = self.common(u, &curves);
        let level = |edge: &Edge| if many(edge) { common.level(edge).ln() } else { f64::NAN };
        Some(Box::new(Near { model: self, levels: self.edges.iter().map(level).collect() }))
    }
}

/// A model of edges whose levels are known nearly, around a point of the parameters.
struct Near<'a> {
    model: &'a WearModel,
    /// Logarithms of the levels; NaN of edges whose level has to be looked for.
    levels: Vec<f64>,
}

impl Model for Near<'_> {
    fn parameters(&self) -> &[Parameter] {
        self.model.parameters()
    }

    fn possible(&self, u: &[f64]) -> bool {
        self.model.in_range(u)
    }

    fn edges(&self) -> usize {
        self.model.edges()
    }

    fn readings(&self, edge: usize) -> Vec<f64> {
        self.model.readings(edge)
    }

    fn replicate(&self, u: &[f64], edge: usize, random: &mut ChaCha8Rng) -> Vec<f64> {
        self.model.replicate(u, edge, random)
    }

    fn replicate_each(&self, u: &[f64], edges: &[usize], random: &mut ChaCha8Rng) -> Vec<Vec<f64>> {
        self.model.replicate_each(u, edges, random)
    }

    fn ln_densities(&self, u: &[f64], edges: &[usize]) -> Vec<f64> {
        self.model.ln_densities_near(u, edges, &self.levels)
    }
}
