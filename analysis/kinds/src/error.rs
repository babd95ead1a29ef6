//! Why a file was not accepted.

use toolroom_form::ReadError;
use toolroom_location::{Located, Location};

/// Why a file was not accepted.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum KindError {
    /// The file cannot be opened or decoded, or every fault found in it with its place.
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
    /// A text without keys, such as a table of measurements or a part program.
    #[error("{file}: no file of keys, and no table of records")]
    NoKeys {
        /// The file.
        file: String,
        /// Which verb looks at such a file.
        reader: &'static str,
    },
    /// Values of `--set` for a file whose values belong together.
    #[error("no value of a {kind} can be changed alone")]
    Unchangeable {
        /// The kind of the file.
        kind: &'static str,
    },
}

impl Located for KindError {
    fn location(&self) -> Option<Location> {
        match self {
            Self::Read(error) => error.location(),
            Self::NoSign { file, .. } | Self::NoKeys { file, .. } => Some(Location::of(file)),
            Self::Unchangeable { .. } => None,
        }
    }
}

impl KindError {
    /// The likely fix.
    pub fn fix(&self) -> &'static str {
        match self {
            Self::Read(_) => "see what is wrong in the file",
            Self::NoSign { .. } => "name the kind with --kind, such as --kind scenario",
            Self::NoKeys { reader, .. } => reader,
            Self::Unchangeable { .. } => "leave --set out, and make the file again with other values",
        }
    }
}
