//! What the diagnosis asks of a nominal model.

use super::Frame;
use rayon::prelude::*;
use toolroom_effects::{Definition, Effect};
use toolroom_innovations::Chain;
use toolroom_process::{ModelError, watched};
use toolroom_scenario::Scope;

/// Where a model is evaluated.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// Calibration and simulated allowance, in prior standard deviations.
    pub parameters: Vec<f64>,
    /// Surfaces, in prior standard deviations.
    pub surfaces: Vec<f64>,
    /// Sizes of the candidates, SI.
    pub effects: Vec<f64>,
    /// Local factors by kind and group, in prior standard deviations.
    pub locals: Vec<Vec<f64>>,
}

impl Point {
    /// The nominal model.
    pub fn nominal(model: &dyn Forward) -> Self {
        Self {
            parameters: vec![0.0; model.frame().parameters.len()],
            surfaces: vec![0.0; model.frame().surfaces.len()],
            effects: vec![0.0; model.frame().candidates.len()],
            locals: vec![vec![0.0; model.frame().measured.groups.len()]; model.frame().locals.len()],
        }
    }
}

/// A number of a point by which a model is differentiated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// A parameter, per prior standard deviation.
    Parameter(usize),
    /// The size of a candidate, per ordinary size.
    Effect(usize),
    /// A kind of local factor, of all groups at once: none knows of another's.
    Local(usize),
}

/// Step of a difference, in prior standard deviations.
const STEP: f64 = 0.1;
/// Step of the size of an effect, in its ordinary size.
const EFFECT_STEP: f64 = 0.05;

impl Direction {
    /// `point` a small step further, and the step.
    pub fn ahead(self, frame: &Frame, point: &Point) -> (Point, f64) {
        let mut ahead = point.clone();
        match self {
            Self::Parameter(i) => ahead.parameters[i] += STEP,
            Self::Effect(i) => {
                let candidate = &frame.candidates[i];
                let step = if point.effects[i] == 0.0 { EFFECT_STEP.max(candidate.onset) } else { EFFECT_STEP };
                ahead.effects[i] += step * candidate.typical;
                return (ahead, step);
            }
            Self::Local(i) => ahead.locals[i].iter_mut().for_each(|x| *x += STEP),
        }
        (ahead, STEP)
    }
}

/// How a scenario says that a candidate is there.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WrittenEffect {
    /// Parameters beside the size: name, value in SI, SI unit, unit for people.
    pub shape: Vec<(&'static str, f64, &'static str, &'static str)>,
    /// Operations on which it acts.
    pub scope: Scope,
    /// Mean of what the records hold of it and the size multiplies: an override, the share of operations held.
    pub recorded: Option<f64>,
    /// What the user has written, where it is no effect of the catalogues.
    pub definition: Option<&'static Definition>,
}

impl WrittenEffect {
    /// Shape and scope of an effect of a process.
    pub fn from_effect(effect: &Effect, scope: &Scope) -> Self {
        let record = effect.parameters();
        let fields = record.fields().iter().enumerate().filter(|(_, field)| field.name != "size");
        let shape = fields.filter_map(|(i, field)| Some((field.name, record.value(i)?, field.unit, field.display)));
        Self { shape: shape.collect(), scope: scope.clone(), recorded: None, definition: effect.definition() }
    }
}

/// An effect of a user that gives no value in a recorded operation.
#[derive(Clone, Debug, PartialEq)]
pub struct EffectRefusal {
    /// Row of the records.
    pub row: usize,
    /// Effect, term, value and context.
    pub source: ModelError,
}

/// The first of what the rows of all groups refuse: `follow` follows the rows of a group in order, handing each row and the
/// work on it to its argument.
pub(super) fn first_refusal(groups: usize, follow: impl Fn(usize, &mut RowByRow<'_>) + Sync) -> Option<EffectRefusal> {
    let of_group = |group: usize| {
        let mut first = None;
        follow(group, &mut |row, work| {
            // Rows behind the first follow from it and say nothing of their own.
            if first.is_none()
                && let Err(source) = watched(work)
            {
                first = Some(EffectRefusal { row, source });
            }
        });
        first
    };
    let all: Vec<Option<EffectRefusal>> = (0..groups).into_par_iter().map(of_group).collect();
    all.into_iter().flatten().next()
}

/// Whoever is handed each row with the work on it.
pub(super) type RowByRow<'a> = dyn FnMut(usize, &mut dyn FnMut()) + 'a;

/// A nominal model over recorded conditions.
pub trait Forward: Sync {
    /// What the model knows and what may be moved.
    fn frame(&self) -> &Frame;
    /// Raw values (SI) of every observation, without surfaces.
    fn simulate(&self, point: &Point) -> Vec<f64>;
    /// How a scenario says the candidate; the default of a record is its id alone.
    fn written(&self, candidate: usize) -> WrittenEffect;
    /// Whether all that the values of a channel scatter by is known beforehand, from the scenario and its sensor sheet.
    fn scatter_is_known(&self, channel: usize) -> bool;
    /// The first row in which an effect of a user gives no value at `point`, so that no prediction there counts; `None` of a
    /// model that evaluates no such effects.
    fn refusal(&self, point: &Point) -> Option<EffectRefusal>;
    /// How the transformed values of each group scatter from row to row about a point, beside the errors of the
    /// sensors; empty where the model does not say.
    fn chains(&self, point: &Point) -> Vec<Chain>;
    /// Derivatives of the raw values by each of `along`; `raw` is [`Forward::simulate`] at the same point.
    fn slopes(&self, point: &Point, raw: &[f64], along: &[Direction]) -> Vec<Vec<f64>> {
        let slope = |direction: &Direction| {
            let (ahead, step) = direction.ahead(self.frame(), point);
            let mut there = self.simulate(&ahead);
            there.iter_mut().zip(raw).for_each(|(there, here)| *there = (*there - here) / step);
            there
        };
        along.par_iter().map(slope).collect()
    }
}
