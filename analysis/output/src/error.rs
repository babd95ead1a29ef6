//! Why something was not written.

use std::fmt::Display;
use std::io;
use std::path::{Path, PathBuf};
use toolroom_shards::ShardError;

/// Why a folder or a file was not written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OutputError {
    /// The place is not to be written: by another process, by this command, or ever.
    #[error("{message}")]
    Refused {
        /// What stands against it.
        message: String,
        /// The way out.
        help: String,
    },
    /// A path that cannot be written.
    #[error("{path} cannot be written: {source}")]
    Unwritable {
        /// The path.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The system refused something else.
    #[error("{message}")]
    Work {
        /// What.
        message: String,
    },
    /// A result that has no JSON form.
    #[error(transparent)]
    Json(#[from] serde_json::Error),
    /// Parts or a journal that cannot be used.
    #[error(transparent)]
    Shard(#[from] ShardError),
}

impl OutputError {
    pub(crate) fn refused(message: impl Display, help: impl Display) -> Self {
        Self::Refused { message: message.to_string(), help: help.to_string() }
    }

    /// The failure of the system at a path, for `map_err`.
    pub(crate) fn at(path: &Path) -> impl Fn(io::Error) -> Self {
        let path = path.to_owned();
        move |source| Self::Unwritable { path: path.clone(), source }
    }

    /// The same failure with something to know beside it.
    pub(crate) fn adding(self, more: &str) -> Self {
        match self {
            Self::Refused { message, help } => Self::Refused { message: message + more, help },
            Self::Work { message } => Self::Work { message: message + more },
            Self::Unwritable { path, source } => {
                Self::Unwritable { path, source: io::Error::new(source.kind(), format!("{source}{more}")) }
            }
            other @ (Self::Json(_) | Self::Shard(_)) => other,
        }
    }
}
