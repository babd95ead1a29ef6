//! Parameter sets of one's own in a package.

use crate::Entry;
use std::path::Path;
use toolroom_cutting::MILLING_CATALOGUE;
use toolroom_wear::{ParameterSet, SetError, TURNING_SETS};

/// A parameter set of one's own: the name under which an importer chooses it, and its text, which needs
/// no other file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OwnSet {
    /// Name.
    pub name: String,
    /// The file in the package.
    pub text: String,
}

/// Why a parameter set cannot stand in a package.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OwnSetError {
    /// It cannot be read.
    #[error(transparent)]
    Set(#[from] SetError),
    /// A unit without tools and work materials.
    #[error("the unit {0} takes no parameter set of one's own")]
    Unit(&'static str),
    /// A name that no importer could choose, or that a shipped set has.
    #[error("the name `{0}` can not be that of a set in a unit")]
    Name(String),
    /// A wear law that the unit does not have.
    #[error("the unit of turning wears by energy_balance, the set by {0}")]
    Law(&'static str),
}

impl OwnSetError {
    /// The likely fix.
    pub fn fix(&self) -> &'static str {
        match self {
            Self::Set(_) => "see `toolroom check` with this file",
            Self::Unit(_) => "set single parameters of the unit in the importer",
            Self::Name(_) => "letters, digits, _ and - make a name; names of shipped sets are taken",
            Self::Law(_) => "give a set with [parameters.energy_balance]",
        }
    }
}

/// Reads a parameter set for the package of a unit and resolves it.
///
/// # Errors
/// [`OwnSetError`].
pub fn own_set(unit: &Entry, path: &Path) -> Result<OwnSet, OwnSetError> {
    let catalogue = match unit.name {
        "turning" | "controller" => &TURNING_SETS,
        "milling" => &MILLING_CATALOGUE,
        _ => return Err(OwnSetError::Unit(unit.name)),
    };
    let set = ParameterSet::read(path, &[], &[catalogue]).map_err(SetError::from)?;
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    if !set.name.chars().all(plain) || catalogue.sets.iter().any(|(name, _)| *name == set.name) {
        return Err(OwnSetError::Name(set.name));
    }
    // The parameters of a unit are those of one law.
    match set.law.filter(|law| *law != "energy_balance") {
        Some(law) => Err(OwnSetError::Law(law)),
        None => Ok(OwnSet { text: set.to_toml(), name: set.name }),
    }
}
