//! Why a file was not accepted.

use toolroom_form::ReadError;
use toolroom_nominal::ModelFileError;

/// Why a file was not accepted.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum KindError {
    /// The file cannot be opened or decoded, or every fault found in it.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A file with no sign of any kind.
    #[error(
        "{file}: the kind of this file cannot be told; at the top of a file, each kind is told by one of its keys or \
         tables: {signs}"
    )]
    NoSign {
        /// The file.
        file: String,
        /// Signs of every kind.
        signs: String,
    },
    /// A policy under which no run begins.
    #[error("policy `{policy}`: {reason}")]
    Policy {
        /// The policy.
        policy: String,
        /// What the shop says.
        reason: String,
    },
    /// A file that is no nominal model.
    #[error(transparent)]
    Model(ModelFileError),
}

impl KindError {
    /// The likely fix.
    pub fn fix(&self) -> &'static str {
        match self {
            Self::Read(_) => "see what is wrong in the file",
            Self::NoSign { .. } => "name the kind with --kind, such as --kind scenario",
            Self::Policy { .. } => "no run would begin",
            Self::Model(_) => "see scenarios/gap for nominal models that work",
        }
    }
}

impl From<ModelFileError> for KindError {
    fn from(error: ModelFileError) -> Self {
        match error {
            ModelFileError::Read(error) => Self::Read(error),
            other => Self::Model(other),
        }
    }
}
