//! What a scenario calls the numbers of a model.

use toolroom_scenario::{Scope, Target};

/// How a scenario says that a parameter or a surface of a frame has moved.
#[derive(Clone, Debug, PartialEq)]
pub struct Movable {
    /// `parameter` of its `[[calibration]]`.
    pub parameter: String,
    /// Its target.
    pub target: Target,
    /// Its scope.
    pub scope: Scope,
    /// Whether it is a summand, SI, instead of a factor.
    pub summand: bool,
    /// Whether the factor of the file is the inverse of that of the frame: a life against a rate.
    pub inverse: bool,
    /// Least and greatest factor of the file on the value of the parameter set, by the range of the constant (1).
    pub range: [f64; 2],
}

/// Relative distance to the end of a range at which a constant stays, so that rounding does not take it beyond (1).
const WITHIN: f64 = 1e-12;

impl Movable {
    /// A factor everywhere.
    pub fn factor(parameter: impl Into<String>, target: Target) -> Self {
        let (scope, range) = (Scope::default(), [0.0, f64::INFINITY]);
        Self { parameter: parameter.into(), target, scope, summand: false, inverse: false, range }
    }

    /// The same for a constant whose value in the parameter set is `value` and whose range is `least` to `greatest`.
    #[must_use]
    pub fn between(self, value: f64, least: f64, greatest: f64) -> Self {
        if !(value > 0.0 && least <= value && value <= greatest) {
            return self;
        }
        Self { range: [least / value * (1.0 + WITHIN), greatest / value * (1.0 - WITHIN)], ..self }
    }
}

/// Where fits start, and the words of a scenario for what they may move.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Words {
    /// Parameters and surfaces by name.
    pub movable: Vec<(String, Movable)>,
    /// Values of parameters that the file states, in prior standard deviations.
    pub parameters: Vec<(usize, f64)>,
    /// Of surfaces.
    pub surfaces: Vec<(usize, f64)>,
    /// Sizes of candidates, SI.
    pub effects: Vec<(usize, f64)>,
}

impl Words {
    /// How a scenario says the parameter or surface called `name`.
    pub fn of(&self, name: &str) -> Option<&Movable> {
        self.movable.iter().find(|(own, _)| own == name).map(|(_, movable)| movable)
    }
}
