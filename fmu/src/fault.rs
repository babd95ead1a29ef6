//! What a unit refuses.

use crate::log::Status;
use crate::mode::Mode;
use toolroom_process::ModelError;

/// Result of an action that may leave a remark, or be refused.
///
/// The fault is boxed, so that what every call hands through is a few bytes.
pub type Outcome<T = Status> = Result<T, Box<Fault>>;

/// Why a call did nothing. The text goes to the importer's log.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Fault {
    /// A pointer that may not be NULL.
    #[error("argument `{argument}` is NULL")]
    Null {
        /// Its name in the standard.
        argument: &'static str,
    },
    /// A function called in the wrong mode.
    #[error("{call} may not be called in {mode}")]
    Mode {
        /// What was requested.
        call: &'static str,
        /// Where the unit is.
        mode: Mode,
    },
    /// A value reference that the unit does not have, or not with this type.
    #[error("there is no variable of this type with value reference {reference}")]
    Reference {
        /// The reference.
        reference: u32,
    },
    /// A variable that cannot be set now.
    #[error("{variable} may not be set in {mode}")]
    NotSettable {
        /// Name.
        variable: String,
        /// Where the unit is.
        mode: Mode,
    },
    /// Arrays of lengths that do not fit.
    #[error("{values} values given, {expected} expected")]
    Length {
        /// What was given.
        values: usize,
        /// What was expected.
        expected: usize,
    },
    /// A step that cannot be taken.
    #[error("a step of {step} s from {time} s cannot be taken")]
    Step {
        /// Start of the step, s.
        time: f64,
        /// Length, s.
        step: f64,
    },
    /// A step beyond the end of the simulation.
    #[error("the step ends at {end} s, the simulation was said to end at {stop} s (stopTime)")]
    End {
        /// End of the step, s.
        end: f64,
        /// End of the simulation, s.
        stop: f64,
    },
    /// A tolerance that is none.
    #[error("a relative tolerance of {tolerance} cannot be kept: it has to be above 0")]
    Tolerance {
        /// The tolerance.
        tolerance: f64,
    },
    /// A step that would take too long to work out.
    #[error("a step of {step} s would not end within a second: take steps of at most {longest} s ({reason})")]
    LongStep {
        /// Length, s.
        step: f64,
        /// Longest step, s.
        longest: f64,
        /// What takes the time.
        reason: &'static str,
    },
    /// A step that does not start where the last one ended.
    #[error("the step starts at {given} s, the unit is at {own} s")]
    Time {
        /// Start of the step, s.
        given: f64,
        /// Time of the unit, s.
        own: f64,
    },
    /// A value that the model refuses.
    #[error("{variable}: {source}")]
    Value {
        /// Name.
        variable: String,
        /// Why.
        source: ModelError,
    },
    /// The model refuses to go on.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A parameter set that does not exist.
    #[error("no parameter set `{name}`; there are {known}")]
    UnknownSet {
        /// What was requested.
        name: String,
        /// What there is.
        known: String,
    },
    /// A parameter set that cannot be used.
    #[error("parameter set {name}: {reason}")]
    Set {
        /// Name.
        name: String,
        /// Why.
        reason: String,
    },
    /// A saved state that is not one of this instance.
    #[error("this state was not saved by this instance, or was freed")]
    State,
    /// A serialised state that cannot be read.
    #[error("the serialised state cannot be read: {reason}")]
    Corrupt {
        /// Why.
        reason: &'static str,
    },
    /// Something that this unit does not offer.
    #[error("{feature} is not offered")]
    NotOffered {
        /// What.
        feature: &'static str,
    },
    /// The unit stopped for good.
    #[error("the unit has stopped after an internal error and can only be freed")]
    Stopped,
}

impl From<ModelError> for Box<Fault> {
    fn from(error: ModelError) -> Self {
        Self::new(error.into())
    }
}
