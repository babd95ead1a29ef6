//! What the diagnosis asks of a nominal model.

use super::{Discrepancy, Measured, Untried, Words};
use rayon::prelude::*;
use toolroom_effects::{Definition, Effect};
use toolroom_innovations::Chain;
use toolroom_process::{ModelError, watched};
use toolroom_scenario::Scope;

/// A constant of the nominal model that calibration may move. Its value counts in prior standard
/// deviations from nominal.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Name.
    pub name: String,
    /// Prior standard deviation, mostly of the logarithm.
    pub deviation: f64,
    /// Whether it is part of the form allowance rather than of the calibration.
    pub allowance: bool,
}

/// A correction `deviation · x · feature` of one channel (of its logarithm, or relative), needing
/// no simulation; x counts in prior standard deviations.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// Name.
    pub name: String,
    /// Channels that it moves.
    pub channels: Vec<usize>,
    /// One number a row.
    pub feature: Vec<f64>,
    /// Prior standard deviation.
    pub deviation: f64,
    /// Whether it is part of the form allowance rather than of the calibration.
    pub allowance: bool,
    /// Whether the feature is in SI units of the channel instead of relative to its value.
    pub absolute: bool,
}

/// Constants of one kind, of which records with many of them show how well they are known.
#[derive(Clone, Debug, PartialEq)]
pub struct Family {
    /// What they are, in words.
    pub name: &'static str,
    /// Names of their surfaces.
    pub surfaces: Vec<String>,
}

/// A factor that differs from group to group, mean 1; counts in prior standard deviations.
#[derive(Clone, Debug, PartialEq)]
pub struct Local {
    /// Name.
    pub name: &'static str,
    /// Prior standard deviation of the logarithm, or scale of its half-normal prior.
    pub deviation: f64,
    /// Whether the standard deviation is estimated from the data.
    pub estimated: bool,
    /// Whether it is scatter and nothing else, which closes no gap; false where what differs from
    /// group to group (a coolant, a material) acts through it.
    pub scatter: bool,
}

/// An effect with a shape, which the data may ask for.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// Word of the catalogue.
    pub id: &'static str,
    /// What distinguishes this shape from others of the same id: a lot, a speed; may be empty.
    pub shape: String,
    /// An ordinary size, SI: scale of steps and priors.
    pub typical: f64,
    /// Greatest admissible size, SI.
    pub greatest: f64,
    /// Least admissible size, SI: zero for an effect of one sign.
    pub least: f64,
}

impl Candidate {
    /// Whether its size may have either sign.
    pub fn two_sided(&self) -> bool {
        self.least < 0.0
    }
}

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
                ahead.effects[i] += EFFECT_STEP * frame.candidates[i].typical;
                return (ahead, EFFECT_STEP);
            }
            Self::Local(i) => ahead.locals[i].iter_mut().for_each(|x| *x += STEP),
        }
        (ahead, STEP)
    }
}

/// A covariate by which the dictionary of generic signatures looks for structure.
#[derive(Clone, Debug, PartialEq)]
pub struct Covariate {
    /// What it is called in the localisation map.
    pub name: String,
    /// One number a row, about unit spread.
    pub values: Vec<f64>,
}

/// What a nominal model states beside its predictions.
#[derive(Clone, Debug)]
pub struct Frame {
    /// What was measured.
    pub measured: Measured,
    /// Constants that calibration may move by simulation.
    pub parameters: Vec<Parameter>,
    /// Corrections without simulation.
    pub surfaces: Vec<Surface>,
    /// Calibration that was stated alike: surfaces whose common spread the records may show to be smaller.
    pub families: Vec<Family>,
    /// Factors of the groups.
    pub locals: Vec<Local>,
    /// Effects that may be missing.
    pub candidates: Vec<Candidate>,
    /// Effects that a user has defined, whether or not they are among the candidates.
    pub defined: Vec<&'static Definition>,
    /// Effects of the process that are not among them, and why.
    pub untried: Vec<Untried>,
    /// Covariates of the generic dictionary.
    pub covariates: Vec<Covariate>,
    /// What had to be assumed because it was not recorded.
    pub notes: Vec<String>,
    /// Where fits start, and what a scenario calls what they move.
    pub words: Words,
    /// How its equations may be off beyond the form allowance; `None` where nothing is known of it.
    pub discrepancy: Option<Discrepancy>,
    /// Row of the records behind each row; empty where they are the same.
    pub order: Vec<usize>,
    /// Kind of each row, among whose readings one may stand apart; empty where all are of one kind.
    pub kinds: Vec<usize>,
    /// What each row times once more, such as a stretch of a program in another piece; empty where nothing is repeated.
    pub repeats: Vec<Option<usize>>,
}

impl Frame {
    /// A frame around what was measured, all else empty.
    pub fn new(measured: Measured) -> Self {
        Self {
            measured,
            parameters: Vec::new(),
            surfaces: Vec::new(),
            families: Vec::new(),
            locals: Vec::new(),
            candidates: Vec::new(),
            defined: Vec::new(),
            untried: Vec::new(),
            covariates: Vec::new(),
            notes: Vec::new(),
            words: Words::default(),
            discrepancy: None,
            order: Vec::new(),
            kinds: Vec::new(),
            repeats: Vec::new(),
        }
    }

    /// The row of the records behind `row`.
    pub fn record_of(&self, row: usize) -> usize {
        self.order.get(row).copied().unwrap_or(row)
    }

    /// The kind of `row`.
    pub fn kind_of(&self, row: usize) -> usize {
        self.kinds.get(row).copied().unwrap_or(0)
    }

    /// Whether each parameter, then each surface, is part of the form allowance rather than of the calibration.
    pub fn allowances(&self) -> Vec<bool> {
        let parameters = self.parameters.iter().map(|own| own.allowance);
        parameters.chain(self.surfaces.iter().map(|own| own.allowance)).collect()
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
    pub fn of(effect: &Effect, scope: &Scope) -> Self {
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
    fn simulate(&self, at: &Point) -> Vec<f64>;
    /// How a scenario says the candidate; the default of a record is its id alone.
    fn written(&self, candidate: usize) -> WrittenEffect;
    /// Whether all that the values of a channel scatter by is known beforehand, from the scenario and its sensor sheet.
    fn scatter_is_known(&self, channel: usize) -> bool;
    /// The first row in which an effect of a user gives no value at `at`, so that no prediction there counts; `None` of a
    /// model that evaluates no such effects.
    fn refusal(&self, at: &Point) -> Option<EffectRefusal>;
    /// How the transformed values of each group scatter from row to row about a point, beside the errors of the
    /// sensors; empty where the model does not say.
    fn chains(&self, at: &Point) -> Vec<Chain>;
    /// Derivatives of the raw values by each of `along`; `raw` is [`Forward::simulate`] at the same point.
    fn slopes(&self, at: &Point, raw: &[f64], along: &[Direction]) -> Vec<Vec<f64>> {
        let slope = |direction: &Direction| {
            let (ahead, step) = direction.ahead(self.frame(), at);
            let mut there = self.simulate(&ahead);
            there.iter_mut().zip(raw).for_each(|(there, here)| *there = (*there - here) / step);
            there
        };
        along.par_iter().map(slope).collect()
    }
}
