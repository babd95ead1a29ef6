//! What a process refuses.

/// A unit behind a number; nothing behind a ratio.
fn after(unit: &str) -> String {
    if unit == "1" { String::new() } else { format!(" {unit}") }
}

/// Why a process model did not answer.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// A number outside its field's range, or not finite. Value and bounds are in `unit`, which is not written after a ratio.
    #[error("{field} = {value}{unit} is outside {min} to {max}{unit}", unit = after(unit))]
    OutOfRange {
        /// Field name.
        field: &'static str,
        /// Offending value, display unit.
        value: f64,
        /// Least admissible value, display unit.
        min: f64,
        /// Greatest admissible value, display unit.
        max: f64,
        /// The display unit.
        unit: &'static str,
    },
    /// A time step that is negative, infinite or not a number.
    #[error("a time step of {seconds} s cannot be taken")]
    Step {
        /// The step, s.
        seconds: f64,
    },
    /// The integrator reached its least step without meeting its tolerance.
    #[error("integration stopped at {time} s: the step fell below {step} s")]
    StepTooSmall {
        /// Time since the start of the call, s.
        time: f64,
        /// Least admissible step, s.
        step: f64,
    },
    /// Two parameters, each admissible, contradict each other.
    #[error("{first} = {first_value} and {second} = {second_value} contradict each other: {rule}")]
    Contradiction {
        /// One parameter.
        first: &'static str,
        /// Its SI value.
        first_value: f64,
        /// The other parameter.
        second: &'static str,
        /// Its SI value.
        second_value: f64,
        /// The rule that they break.
        rule: &'static str,
    },
    /// A calculation that has no answer for these numbers.
    #[error("{quantity} has no solution: {reason}")]
    NoSolution {
        /// What was requested.
        quantity: &'static str,
        /// Why there is none.
        reason: &'static str,
    },
    /// An imported unit did not do what it was asked for.
    #[error("unit {unit}: {reason}")]
    Unit {
        /// File of the unit.
        unit: String,
        /// What failed, with what the unit says about it.
        reason: String,
    },
    /// An effect of a user that gives no number, or drives a term out of its range.
    #[error(transparent)]
    EffectValue(#[from] Box<EffectValue>),
}

impl ModelError {
    /// The code of what has an explanation of its own; `None` of the rest.
    pub fn code(&self) -> Option<&'static str> {
        match self {
            Self::EffectValue(_) => Some("effect-value"),
            Self::OutOfRange { .. }
            | Self::Step { .. }
            | Self::StepTooSmall { .. }
            | Self::Contradiction { .. }
            | Self::NoSolution { .. }
            | Self::Unit { .. } => None,
        }
    }
}

/// The value of an effect of a user with which no model may go on. Numbers are in `unit`.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "effect-value: effect `{effect}` makes {term} {}, its range is {} … {}; with {context}",
    shown(*value, unit), shown(*min, "1"), shown(*max, unit)
)]
pub struct EffectValue {
    /// Id of the effect.
    pub effect: &'static str,
    /// The term that it changes.
    pub term: &'static str,
    /// What the term would be; not a number, infinite, or out of range.
    pub value: f64,
    /// Least admissible value.
    pub min: f64,
    /// Greatest admissible value.
    pub max: f64,
    /// Unit for people, `1` of a ratio.
    pub unit: &'static str,
    /// Size, shape and quantities of the context that the formula names, with their values.
    pub context: String,
}

/// A number with its unit, as a message has it.
fn shown(value: f64, unit: &str) -> String {
    let number = match value {
        _ if value.is_nan() => "no number".to_owned(),
        _ if value.is_infinite() => "infinite".to_owned(),
        _ if value != 0.0 && !(1e-3..1e7).contains(&value.abs()) => format!("{value:e}"),
        _ => value.to_string(),
    };
    if unit == "1" || !value.is_finite() { number } else { format!("{number} {unit}") }
}
