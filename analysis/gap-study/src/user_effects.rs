//! Effects that users define in files of their own.

use crate::GapStudyError;
use std::path::Path;
use toolroom_effects::{Definition, read_effects_file};
use toolroom_form::ReadError;
use toolroom_gap::{EffectRefusal, ProcessData};
use toolroom_records::Records;

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

/// That every effect of a user gives a value in every recorded operation, in the model as its file states it and at the
/// sizes that are tried.
///
/// # Errors
/// [`GapStudyError::EffectValue`] with the first operation in which one does not.
pub fn usable(asked: &ProcessData, records: &Records) -> Result<(), GapStudyError> {
    asked.refusal().map_or(Ok(()), |refusal| Err(refused_in(records, refusal)))
}

/// The refusal of an operation of the records.
pub(crate) fn refused_in(records: &Records, EffectRefusal { row, source }: EffectRefusal) -> GapStudyError {
    let ids = ["operation_id", "trial_id"].iter().find_map(|name| records.texts(name));
    let operation = ids.and_then(|ids| ids.get(row)).cloned().unwrap_or_else(|| format!("of row {}", row + 1));
    GapStudyError::EffectValue { operation, source }
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
