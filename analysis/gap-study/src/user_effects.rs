//! Effects that users define in files of their own.

use std::path::Path;
use toolroom_effects::{Definition, read_effects_file};
use toolroom_form::ReadError;

/// Why the effects of a user were not read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum UserEffectsError {
    /// A file that cannot be opened, or every fault found in it.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// One id with two meanings.
    #[error("{file}: `{id}` is defined otherwise in another file")]
    Twice {
        /// The file that was read later.
        file: String,
        /// Id of the effect.
        id: &'static str,
    },
}

impl UserEffectsError {
    /// The likely fix.
    pub fn fix(&self) -> &'static str {
        match self {
            Self::Read(_) => "see what is wrong in the file",
            Self::Twice { .. } => "give each effect an id of its own",
        }
    }
}

/// Effects that files of a user define, those of several files together.
///
/// # Errors
/// [`UserEffectsError`]: a file that cannot be read, or two effects of one id.
pub fn user_effects(files: &[impl AsRef<Path>]) -> Result<Vec<&'static Definition>, UserEffectsError> {
    let mut all: Vec<&'static Definition> = Vec::new();
    for file in files {
        let file: &Path = file.as_ref();
        for effect in read_effects_file(file)? {
            if all.iter().any(|known| known.entry().id == effect.entry().id && *known != effect) {
                return Err(UserEffectsError::Twice { file: file.display().to_string(), id: effect.entry().id });
            }
            all.push(effect);
        }
    }
    Ok(all)
}
