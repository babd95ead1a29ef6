//! What a process refuses.

/// Why a process model did not answer.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// A number outside its field's range, or not finite. Value and bounds are in `unit`.
    #[error("{field} = {value} {unit} is outside {min} to {max} {unit}")]
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
}
