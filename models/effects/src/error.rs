//! What an effect refuses.

use toolroom_process::{ModelError, unit::UnitError};

/// Why an effect could not be read or used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EffectError {
    /// An id that is not in the catalogue.
    #[error("unknown effect `{id}`; nearest: `{nearest}`")]
    Unknown {
        /// What was read.
        id: String,
        /// The most similar id.
        nearest: &'static str,
    },
    /// An id with a dot that no `[[effect]]` defines.
    #[error("no [[effect]] defines `{id}`{}", listed(.known))]
    Undefined {
        /// What was read.
        id: String,
        /// Ids that are defined; may be empty.
        known: String,
    },
    /// A parameter that the effect does not have.
    #[error("effect `{id}` has no parameter `{name}`; it has {known}")]
    UnknownParameter {
        /// The effect.
        id: &'static str,
        /// What was read.
        name: String,
        /// The names that exist.
        known: String,
    },
    /// No size.
    #[error("effect `{id}` has no size; write for example `{example}`")]
    MissingSize {
        /// The effect.
        id: &'static str,
        /// A complete entry.
        example: String,
    },
    /// A value that cannot be read as this parameter.
    #[error("effect `{id}`, {name}: {reason}")]
    Unit {
        /// The effect.
        id: &'static str,
        /// Parameter.
        name: &'static str,
        /// What is wrong.
        reason: UnitError,
    },
    /// A value outside the parameter's range.
    #[error("effect `{id}`: {reason}")]
    Range {
        /// The effect.
        id: &'static str,
        /// What is wrong.
        reason: ModelError,
    },
    /// A size among the parameters of the shape.
    #[error("effect `{id}`: the size stands beside the shape, not in it")]
    SizeInShape {
        /// The effect.
        id: &'static str,
    },
    /// The same effect twice in a list.
    #[error("effect `{id}` is listed twice with one shape")]
    Twice {
        /// The effect.
        id: &'static str,
    },
    /// An effect that does not act on this process.
    #[error("effect `{id}` does not act on {process}; effects of {process}: {known}")]
    NotOfProcess {
        /// The effect.
        id: &'static str,
        /// The process.
        process: &'static str,
        /// Effects that do.
        known: String,
    },
}

fn listed(known: &str) -> String {
    if known.is_empty() {
        ", and no other; ids with a dot are those of users".to_owned()
    } else {
        format!("; there are {known}")
    }
}
