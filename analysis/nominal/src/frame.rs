//! What a nominal model states beside its predictions: what was measured, what may be moved, what may be missing.

use super::{Discrepancy, EffectId, Measured, Role, Surface, Untried, Words};
use toolroom_effects::Definition;

/// A constant of the nominal model that calibration may move. Its value counts in prior standard
/// deviations from nominal.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Name.
    pub name: String,
    /// Prior standard deviation, mostly of the logarithm.
    pub deviation: f64,
    /// What it stands for.
    pub role: Role,
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
    /// The effect.
    pub id: EffectId,
    /// What distinguishes this shape from others of the same id: a lot, a speed; may be empty.
    pub shape: String,
    /// An ordinary size, SI: scale of steps and priors.
    pub typical: f64,
    /// Greatest admissible size, SI.
    pub greatest: f64,
    /// Least admissible size, SI: zero for an effect of one sign.
    pub least: f64,
    /// Size up to which it may do nothing at all, in ordinary sizes: from zero its derivative is taken that far. Zero of an effect
    /// that acts from the beginning.
    pub onset: f64,
}

impl Candidate {
    /// Whether its size may have either sign.
    pub fn two_sided(&self) -> bool {
        self.least < 0.0
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
    /// Log likelihood by which the shape of cycle times asks for each candidate, beyond what their means and the channel of the
    /// times in stops say as normal readings; none of the candidates behind its end.
    pub shape_leads: Vec<f64>,
    /// What each row times once more, such as a stretch of a program in another piece; empty where nothing is repeated.
    pub repeats: Vec<Option<usize>>,
    /// Number of single values that each observation stands for, of middles of times; 1 each where it is empty.
    pub stands_for: Vec<f64>,
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
            shape_leads: Vec::new(),
            repeats: Vec::new(),
            stands_for: Vec::new(),
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
        let parameters = self.parameters.iter().map(|own| own.role.is_allowance());
        parameters.chain(self.surfaces.iter().map(|own| own.role.is_allowance())).collect()
    }
}
