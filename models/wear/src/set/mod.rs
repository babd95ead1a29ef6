//! Parameter sets: constants of one tool in one work material, each with its origin and source.
//!
//! ```text
//!  handbook constants ─convert─┐
//!  [parameters.*] ─────────────┼──► one value a parameter ──► Pair or Milling
//!  based_on ─► another set ────┘    with origin and source
//! ```
//! What a file states goes before what its handbook constants give, and both go before the set that
//! the file is based on. A set is called by the name of a shipped set or by the path of a file.

mod catalogue;
mod collapse;
mod diffusion;
mod fault;
mod first;
mod form;
mod handbook;
mod material;
mod of_tool;
mod one_life;
mod prior;
mod rate;
mod read;
mod scatter;
mod sources;
mod values;
mod write;

pub use catalogue::{Catalogue, Group};
pub use first::{FirstSet, KnownLife, KnownLifeError};
pub use form::{HANDBOOK, PARAMETER_SET};
pub use handbook::{
    ASSUMED_DEVIATIONS, ASSUMED_EXPONENTS, FittedLives, HandbookTaylor, Kienzle, ReferenceLife, TestedLife,
};
pub use material::{FORCE_DEVIATION, ISO_513, MATERIAL_GROUPS, MaterialGroup};
pub use one_life::{
    ABOUT, Band, EDGE_SCATTER, EDGE_SCATTER_DEVIATION, OneLife, SPEED_EXPONENT_DEVIATION, ToolMaterial,
};
pub use prior::{EDGE_SCATTER_NAME, READING_NOISE_NAME, read_priors};
pub use scatter::ScatterWord;

use crate::Scatter;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use toolroom_form::{Outline, Quantity, ReadError, display, nearest};
use toolroom_location::{Located, Location};
use toolroom_process::{AnyRecord, Field, ModelError};

/// Where a value of a set comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Origin {
    /// Stated in the file.
    Given,
    /// Converted from the constants of `[handbook]` or the material.
    Handbook,
    /// Taken over from the set of this name.
    Based(String),
    /// Left out; the default is assumed.
    Assumed,
}

impl std::fmt::Display for Origin {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Given => f.write_str("given"),
            Self::Handbook => f.write_str("handbook"),
            Self::Based(set) => write!(f, "based on {set}"),
            Self::Assumed => f.write_str("assumed"),
        }
    }
}

/// One value of a set.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterValue {
    /// Group.
    pub group: &'static str,
    /// Parameter: name, units, range, meaning.
    pub field: &'static Field,
    /// Value, SI.
    pub value: f64,
    /// Where it comes from.
    pub origin: Origin,
    /// Its source, as stated.
    pub source: String,
}

impl ParameterValue {
    /// `group.name`.
    pub fn key(&self) -> String {
        format!("{}.{}", self.group, self.field.name)
    }

    /// The value in its display unit.
    pub fn shown(&self) -> String {
        display(&Quantity::of(self.field), self.value)
    }
}

/// How well a parameter is known before a calibration, one standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Spread {
    /// Of a positive value: the factor to which a standard deviation of its logarithm amounts.
    Factor(f64),
    /// In the display unit of the parameter.
    Deviation(f64),
}

/// A parameter set as its file and the sets that it is based on give it.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterSet {
    /// Name.
    pub name: String,
    /// One line for people.
    pub title: String,
    /// Process, `turning` or `milling`.
    pub process: &'static str,
    /// Group of the wear law, where sets of the process choose one.
    pub law: Option<&'static str>,
    /// Every value, in the order of the catalogue.
    pub values: Vec<ParameterValue>,
    /// Values of wear laws that the set does not use, as its file or a set that it is based on gives them: whole groups only.
    pub unused: Vec<ParameterValue>,
    /// Standard deviations by `group.name`.
    pub prior: BTreeMap<String, Spread>,
    /// Scatter of tools of this set that state none.
    pub scatter: Option<Scatter>,
    /// What a user should know beside the values.
    pub notes: Vec<String>,
    /// Files that were read, the set's own first.
    pub files: Vec<PathBuf>,
}

/// Why a parameter set was not loaded.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SetError {
    /// The name is that of a shipped set of another process.
    #[error("`{name}` is a set of {process}, where one of {expected} is due; there are {known}")]
    OtherProcess {
        /// What was read.
        name: String,
        /// The process of that set.
        process: &'static str,
        /// The process that is wanted.
        expected: &'static str,
        /// Names of the sets of the process that is wanted.
        known: String,
    },
    /// No shipped set has this name.
    #[error(
        "no parameter set `{name}`{}; there are {known}; a path of a file of one's own has a / or ends in .toml{}",
        nearest.map(|name| format!("; did you mean `{name}`?")).unwrap_or_default(),
        if files.is_empty() { String::new() } else { format!("; beside the file there are {}", files.join(", ")) }
    )]
    Unknown {
        /// What was read.
        name: String,
        /// The most similar name.
        nearest: Option<&'static str>,
        /// All names.
        known: String,
        /// Files of the folder that may be meant.
        files: Vec<String>,
    },
    /// A file that cannot be read, or what is wrong in it, with places.
    #[error("{message}")]
    File {
        /// What is wrong.
        message: String,
        /// Where, or the first place of several.
        at: Option<Location>,
    },
    /// Values that contradict each other.
    #[error(transparent)]
    Model(#[from] ModelError),
}

impl SetError {
    /// The same, which tells the process of a name that is that of a set of another process than `expected`; `process_of` knows
    /// the sets of others.
    #[must_use]
    pub fn told_apart(self, expected: &'static str, process_of: fn(&str) -> Option<&'static str>) -> Self {
        match self {
            Self::Unknown { name, nearest, known, files } => match process_of(&name) {
                Some(process) => Self::OtherProcess { name, process, expected, known },
                None => Self::Unknown { name, nearest, known, files },
            },
            other @ (Self::OtherProcess { .. } | Self::File { .. } | Self::Model(_)) => other,
        }
    }
}

impl Located for SetError {
    fn location(&self) -> Option<Location> {
        match self {
            Self::File { at, .. } => at.clone(),
            Self::Unknown { .. } | Self::OtherProcess { .. } | Self::Model(_) => None,
        }
    }
}

/// Whether a set is called by a path; else it is a shipped name.
pub fn is_path(reference: &str) -> bool {
    reference.contains(['/', '\\']) || reference.ends_with(".toml")
}

/// What a file is that is no parameter set, where it can be told, with what would do.
fn other_file(path: &Path, reference: &str) -> Option<String> {
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("parquet")) {
        return Some(format!(
            "{reference} is a table of draws: `parameters_from` names it, and `parameter_set` the set beside it (.toml)"
        ));
    }
    let outline = Outline::read(path).ok()?;
    let kinds = [("shop", "a scenario"), ("condition", "a study of tool lives"), ("gap", "a diagnosis")];
    let (_, kind) = kinds.into_iter().find(|(key, _)| outline.has(key))?;
    Some(format!("{reference} is {kind}, no parameter set, which has `name`, `process` and [parameters] or `based_on`"))
}

/// Files of a folder that a wrong path or name may mean: its TOML files, at most eight, the one most like
/// `wanted` first.
fn neighbours(folder: &Path, wanted: &str) -> Vec<String> {
    let Ok(entries) = std::fs::read_dir(if folder.as_os_str().is_empty() { Path::new(".") } else { folder }) else {
        return Vec::new();
    };
    let names = entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
    let mut names: Vec<String> = names.filter(|name| name.ends_with(".toml")).collect();
    names.sort();
    let near = nearest(wanted, names.iter().map(String::as_str)).map(str::to_owned);
    names.sort_by_key(|name| near.as_ref() != Some(name));
    names.truncate(8);
    names
}

impl ParameterSet {
    /// A set without values.
    fn empty(process: &'static str) -> Self {
        let (name, title, law) = (String::new(), String::new(), None);
        let (values, unused, notes, files) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        Self { name, title, process, law, values, unused, prior: BTreeMap::new(), scatter: None, notes, files }
    }

    /// The set of a shipped name, or of a path that counts from `folder`.
    ///
    /// # Errors
    /// [`SetError`]: an unknown name with the nearest one, a file with every fault and its place.
    pub fn load(reference: &str, folder: &Path, catalogue: &'static Catalogue) -> Result<Self, SetError> {
        Self::load_after(reference, folder, catalogue, &[])
    }

    /// [`ParameterSet::load`] of a set on which the files of `chain` are based.
    fn load_after(
        reference: &str,
        folder: &Path,
        catalogue: &'static Catalogue,
        chain: &[PathBuf],
    ) -> Result<Self, SetError> {
        if is_path(reference) {
            let path = folder.join(reference);
            return read::file(&path, &[], &[catalogue], chain).map_err(|error| {
                if let Some(message) = other_file(&path, reference) {
                    return SetError::File { message, at: None };
                }
                let (message, at) = (error.to_string(), error.location());
                if !matches!(error, ReadError::Unreadable { .. }) {
                    return SetError::File { message, at };
                }
                let file = path.file_name().and_then(|name| name.to_str()).unwrap_or(reference);
                let files = neighbours(path.parent().unwrap_or(folder), file);
                let there = if files.is_empty() { "no TOML files".to_owned() } else { files.join(", ") };
                SetError::File { message: format!("{message}; its folder has {there}"), at }
            });
        }
        let names = || catalogue.sets.iter().map(|(name, _)| *name);
        match catalogue.sets.iter().find(|(known, _)| *known == reference) {
            Some((name, text)) => read::text(name, text, &[], &[catalogue], chain).map_err(SetError::from),
            None => Err(SetError::Unknown {
                name: reference.to_owned(),
                nearest: nearest(reference, names()),
                known: names().collect::<Vec<_>>().join(", "),
                files: neighbours(folder, reference),
            }),
        }
    }

    /// The set of a file, whose process is that of the catalogue to which its groups belong;
    /// `overrides` are `path=value` as after `--set`.
    ///
    /// # Errors
    /// [`ReadError`]: the file cannot be read, or every fault found in it.
    pub fn read(path: &Path, overrides: &[String], catalogues: &[&'static Catalogue]) -> Result<Self, ReadError> {
        read::file(path, overrides, catalogues, &[])
    }

    /// The set that a text holds; `file` is its name in messages.
    ///
    /// # Errors
    /// [`SetError::File`] with every fault and its place.
    pub fn parse(file: &str, text: &str, catalogue: &'static Catalogue) -> Result<Self, SetError> {
        read::text(file, text, &[], &[catalogue], &[]).map_err(SetError::from)
    }

    /// The value of `group.name`, SI.
    pub fn value(&self, group: &str, name: &str) -> Option<&ParameterValue> {
        self.values.iter().find(|value| value.group == group && value.field.name == name)
    }

    /// Sets the fields of `record` that the group gives.
    pub fn fill(&self, group: &str, record: &mut dyn AnyRecord) {
        fill_from(&self.values, group, record);
    }

    /// Sets the fields of `record` that a law has which the set does not use.
    pub fn fill_unused(&self, group: &str, record: &mut dyn AnyRecord) {
        fill_from(&self.unused, group, record);
    }
}

fn fill_from(values: &[ParameterValue], group: &str, record: &mut dyn AnyRecord) {
    for (i, field) in record.fields().iter().enumerate() {
        if let Some(value) = values.iter().find(|value| value.group == group && value.field.name == field.name) {
            record.set_value(i, value.value);
        }
    }
}

impl From<ReadError> for SetError {
    fn from(error: ReadError) -> Self {
        Self::File { message: error.to_string(), at: error.location() }
    }
}
