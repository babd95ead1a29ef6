//! Why a file is no nominal model.

use toolroom_form::ReadError;
use toolroom_location::{Located, Location};

/// Why a nominal model cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ModelFileError {
    /// The file is at fault.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// No tool of the process.
    #[error("{file}: no [[tool]] with process = \"{process}\"")]
    NoTool {
        /// The file.
        file: String,
        /// What was looked for.
        process: String,
    },
    /// Two definitions of one effect.
    #[error("{file}: [[effect]] `{id}` is defined otherwise in a file of --effects")]
    Defined {
        /// The model file.
        file: String,
        /// The effect.
        id: String,
    },
    /// A sensor whose quantity does not fit its channel.
    #[error("{file}: [[gap.sensor]] {channel}: {reason}")]
    Sensor {
        /// The file.
        file: String,
        /// The channel.
        channel: String,
        /// What is wrong.
        reason: String,
    },
}

impl Located for ModelFileError {
    fn location(&self) -> Option<Location> {
        match self {
            Self::Read(error) => error.location(),
            Self::NoTool { file, .. } | Self::Defined { file, .. } | Self::Sensor { file, .. } => {
                Some(Location::of(file))
            }
        }
    }
}
