//! Single values of a record, changed in words: `name=value` as after `--set`.

use toolroom_form::nearest;
use toolroom_process::unit::{self, UnitError};
use toolroom_process::{AnyRecord, Field, ModelError};

/// Why a change of a single value was refused.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ChangeError {
    /// A change without `=`.
    #[error("`{text}` is not of the form name=value")]
    NoEquals {
        /// The change.
        text: String,
    },
    /// A name that the record does not have.
    #[error("there is no value `{name}`")]
    NoField {
        /// The name.
        name: String,
        /// Names that there are.
        known: Vec<&'static str>,
    },
    /// A value that is no quantity of its field.
    #[error("{}: {source}", field.name)]
    Unit {
        /// The field.
        field: &'static Field,
        /// What is wrong with the text.
        source: UnitError,
    },
    /// A value out of the range of its field.
    #[error("{source}")]
    OutOfRange {
        /// The field.
        field: &'static Field,
        /// The range.
        source: ModelError,
    },
}

impl ChangeError {
    /// The likely way out.
    pub fn fix(&self) -> String {
        match self {
            Self::NoEquals { .. } => "write the name, `=` and the value with its unit".to_owned(),
            Self::NoField { name, known } => {
                let near = nearest(name, known.iter().copied());
                let near = near.map_or(String::new(), |near| format!("did you mean `{near}`? "));
                format!("{near}there are {}", known.join(", "))
            }
            Self::Unit { field, .. } | Self::OutOfRange { field, .. } => {
                let unit = if field.display == "1" { "a bare number" } else { field.display };
                format!("{} is in {unit}", field.name)
            }
        }
    }
}

/// Name and value of a change.
///
/// # Errors
/// [`ChangeError::NoEquals`]
pub(crate) fn parts(text: &str) -> Result<(&str, &str), ChangeError> {
    let (name, value) = text.split_once('=').ok_or_else(|| ChangeError::NoEquals { text: text.to_owned() })?;
    Ok((name.trim(), value.trim().trim_matches('"')))
}

/// Sets the scalar `name` of a record to a value in words.
///
/// # Errors
/// [`ChangeError`]: a name that the record does not have, a value without a fitting unit, or one out of range.
pub(crate) fn assign(record: &mut dyn AnyRecord, name: &str, text: &str) -> Result<(), ChangeError> {
    let mut index = 0;
    for field in record.fields() {
        if field.name == name && field.len == 1 {
            let value = unit::quantity(text, field.unit).map_err(|source| ChangeError::Unit { field, source })?;
            field.check(value).map_err(|source| ChangeError::OutOfRange { field, source })?;
            record.set_value(index, value);
            return Ok(());
        }
        index += field.len;
    }
    let known = record.fields().iter().filter(|field| field.len == 1).map(|field| field.name).collect();
    Err(ChangeError::NoField { name: name.to_owned(), known })
}
