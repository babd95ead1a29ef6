//! Why there is no diagnosis of a data set.

use std::path::PathBuf;
use toolroom_apply::ApplyError;
use toolroom_gap::ModelFileError;
use toolroom_location::{Located, Location};
use toolroom_process::ModelError;
use toolroom_records::RecordError;
use toolroom_shop::{Refusal, ShopError};

/// Why there is no diagnosis of a data set.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GapStudyError {
    /// A nominal model.
    #[error(transparent)]
    Model(#[from] ModelFileError),
    /// Records.
    #[error(transparent)]
    Records(#[from] RecordError),
    /// A model that the diagnosis cannot be applied to.
    #[error(transparent)]
    Apply(#[from] ApplyError),
    /// A file.
    #[error("{path}: {source}")]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// A file or folder that cannot be written.
    #[error("{path}: {source}")]
    Unwritable {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// Several models, and one table for all.
    #[error("{data} is one table, but {models} models are given")]
    OneTable {
        /// The table.
        data: PathBuf,
        /// How many models.
        models: usize,
    },
    /// A table with two models.
    #[error("{one} and {other} both read the table `{table}`")]
    TwoModels {
        /// A model.
        one: PathBuf,
        /// Another one.
        other: PathBuf,
        /// Their table.
        table: &'static str,
    },
    /// A model without table.
    #[error("{model} is a model of {kind}, but {data} holds no {table}.csv or {table}.parquet; it holds {found}")]
    NoTable {
        /// The model.
        model: PathBuf,
        /// What it is a model of.
        kind: &'static str,
        /// The folder of tables.
        data: PathBuf,
        /// The table that it lacks.
        table: &'static str,
        /// What there is.
        found: String,
    },
    /// A table without model, where there are several models.
    #[error("{data} holds {left}, which no model reads")]
    NoModel {
        /// The folder of tables.
        data: PathBuf,
        /// Tables that nobody reads.
        left: String,
        /// The shipped model of the first of them.
        shipped: &'static str,
    },
    /// A group that is in both sets of records.
    #[error("{column} {name} stands in both sets; a group is either fitted or held out")]
    BothSets {
        /// What groups are.
        column: String,
        /// The group.
        name: String,
    },
    /// Groups by a column that is not there.
    #[error("--group {column}: the records have no such column{known}")]
    NoGroup {
        /// What was asked for.
        column: String,
        /// Those that there are.
        known: String,
    },
    /// Nothing of what the model predicts was measured.
    #[error("no channel that the model predicts is recorded{}", notes.iter().fold(String::new(), |all, note| format!("{all}; {note}")))]
    NothingMeasured {
        /// What was noted while reading.
        notes: Vec<String>,
    },
    /// An effect of a user that gives no value in a recorded operation.
    #[error("operation {operation}: {source}")]
    EffectValue {
        /// The operation, or the number of its row where it has no name.
        operation: String,
        /// Effect, term, value and context.
        source: ModelError,
    },
    /// A simulated shop in which a process refuses an operation.
    #[error("{0}")]
    Refused(#[source] Box<Refusal>),
    /// Key figures of a model that is no shop.
    #[error("key figures are those of a shop, but the model is none")]
    NoShop,
    /// Key figures without the events of the shop.
    #[error("key figures follow from the events of the machines: {source}")]
    NoEvents {
        /// Why they were not read.
        source: RecordError,
    },
    /// The work could not be done although the input is right.
    #[error("{0}")]
    Work(String),
}

impl Located for GapStudyError {
    fn location(&self) -> Option<Location> {
        match self {
            Self::Model(error) => error.location(),
            Self::Records(error) => error.location(),
            Self::OneTable { data, .. } | Self::NoModel { data, .. } => Some(Location::of(data.display())),
            Self::NoTable { model, .. } => Some(Location::of(model.display())),
            Self::NoEvents { source } => source.location(),
            Self::Unreadable { path, .. } | Self::Unwritable { path, .. } => Some(Location::of(path.display())),
            Self::Apply(..)
            | Self::TwoModels { .. }
            | Self::BothSets { .. }
            | Self::NoGroup { .. }
            | Self::NothingMeasured { .. }
            | Self::EffectValue { .. }
            | Self::Refused(..)
            | Self::NoShop
            | Self::Work(..) => None,
        }
    }
}

impl From<Box<Refusal>> for GapStudyError {
    fn from(refusal: Box<Refusal>) -> Self {
        Self::Refused(refusal)
    }
}

impl From<ShopError> for GapStudyError {
    fn from(error: ShopError) -> Self {
        if let ShopError::Model(refusal) = error { refusal.into() } else { Self::Work(error.to_string()) }
    }
}

impl GapStudyError {
    /// The likely fix; none where the work could not be done although the input is right.
    pub fn fix(&self) -> Option<String> {
        Some(match self {
            Self::Model(_) => "see scenarios/gap for nominal models that work".to_owned(),
            Self::Records(RecordError::Quote { .. }) => "mend that line; nothing was diagnosed".to_owned(),
            Self::Records(RecordError::Unreadable { .. }) | Self::Unreadable { .. } => "check the path".to_owned(),
            Self::Unwritable { .. } => "give a folder that can be written".to_owned(),
            Self::Records(_) => "`toolroom import csv` maps other tables to records".to_owned(),
            Self::Apply(error) => error.fix().to_owned(),
            Self::OneTable { .. } => "give the directory that holds a table for each, or one model".to_owned(),
            Self::TwoModels { .. } => "leave one of them out: a table has one model".to_owned(),
            Self::NoTable { model, .. } => {
                format!("leave {} out, or add the table; `toolroom import csv` maps others", model.display())
            }
            Self::NoModel { shipped, .. } => {
                format!("add a model (--model scenarios/gap/{shipped}.toml), or take the table away")
            }
            Self::BothSets { .. } => "give the groups of the second set other names".to_owned(),
            Self::NoGroup { .. } => "name a column whose levels belong together, or leave --group out".to_owned(),
            Self::NothingMeasured { .. } => {
                "`toolroom gap` compares forces, wear, power, temperature, stock, …".to_owned()
            }
            Self::NoShop => "leave --data out".to_owned(),
            Self::NoEvents { .. } => {
                "give the folder that holds events.csv, as `toolroom run --records` writes it, or leave --data out"
                    .to_owned()
            }
            Self::EffectValue { .. } | Self::Refused(_) | Self::Work(_) => return None,
        })
    }
}
