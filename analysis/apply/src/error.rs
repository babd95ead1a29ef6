//! What an application of a diagnosis refuses.

/// Why a diagnosis could not be applied.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ApplyError {
    /// Another model than the diagnosed one.
    #[error("apply-model: the diagnosis was made of another model (hash {diagnosed}; this one has {found})")]
    Model {
        /// Hash in the diagnosis.
        diagnosed: String,
        /// Hash of the model that was given.
        found: String,
    },
    /// A diagnosis of another form.
    #[error("apply-schema: the diagnosis has schema {found}; schema 2 is due")]
    Schema {
        /// What was read.
        found: String,
    },
    /// An effect that no simulated shop can have.
    #[error("apply-effect: a simulated shop cannot have `{id}`: {reason}")]
    Effect {
        /// The effect.
        id: String,
        /// Why.
        reason: String,
    },
    /// A tool that the scenario does not have.
    #[error("apply-target: the model has no {target}")]
    Target {
        /// What was looked for.
        target: String,
    },
    /// Something that was chosen by name and that the diagnosis has not found.
    #[error("--only {name}: the diagnosis has found no `{name}`; it has {found}")]
    Only {
        /// What was chosen.
        name: String,
        /// What there is.
        found: String,
    },
    /// A finding that names what the model does not have.
    #[error("apply-target: with what was found nothing could read the model: {message}")]
    Names {
        /// What its reader says.
        message: String,
    },
    /// Nothing to write.
    #[error("the diagnosis has neither an effect nor a calibration that is to be written")]
    Nothing,
    /// A value of the diagnosis that cannot be read.
    #[error("apply-schema: {what} of the diagnosis cannot be read")]
    Value {
        /// Which.
        what: String,
    },
    /// The model is no TOML.
    #[error("{message}")]
    Text {
        /// What its reader says.
        message: String,
    },
}

impl ApplyError {
    /// What to do about it.
    pub fn fix(&self) -> &'static str {
        match self {
            Self::Model { .. } => "give the diagnosed file with the same --set, or diagnose again",
            Self::Schema { .. } | Self::Value { .. } => "diagnose again",
            Self::Effect { .. } => "choose others by --only ID",
            Self::Only { .. } => "give the id of an effect of the diagnosis, or leave --only out",
            Self::Target { .. } => "give the model whose rows were diagnosed",
            Self::Names { .. } => {
                "name machines, parts and shifts in records and model alike, or choose findings by --only ID"
            }
            Self::Nothing => "there is nothing to switch on",
            Self::Text { .. } => "mend the file",
        }
    }
}
