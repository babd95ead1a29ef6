//! Why a shard was not run or parts were not merged.

use std::io;
use std::path::{Path, PathBuf};
use toolroom_location::{Located, Location};

/// Why a shard was not run or parts were not merged.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ShardError {
    /// The file system refused.
    #[error("{path}: {source}")]
    File {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A plan that cannot be read.
    #[error("{path} cannot be read: {source}")]
    UnreadablePlan {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The rows of a part cannot be written.
    #[error("cannot write {path}: {source}")]
    Rows {
        /// The file.
        path: PathBuf,
        /// What the format of the table said.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    /// A plan that is no JSON of this kind, or a plan or sidecar that has no form as JSON.
    #[error("{path} is no plan that can be read: {source}; make it again with --plan")]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What serde said.
        source: serde_json::Error,
    },
    /// A sidecar that is not what was written.
    #[error("{path} was changed, cut or not written by this version; remove it and run its shard again")]
    Altered {
        /// The file.
        path: PathBuf,
    },
    /// A sidecar that is whole, but whose content is not that of its shard.
    #[error("{path} is no part of this plan: {why}; remove it and run its shard again")]
    Malformed {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        why: String,
    },
    /// A file in the place of a part that is none.
    #[error("{path} is there and is no part of a study: nothing was changed")]
    NoPart {
        /// The file.
        path: PathBuf,
    },
    /// A file in the place of a plan that is none.
    #[error("{path} is there and is no plan: nothing was changed")]
    NoPlan {
        /// The file.
        path: PathBuf,
    },
    /// A plan of another format.
    #[error("the plan has the format {found}, this is {expected}")]
    OtherFormat {
        /// Its format.
        found: u32,
        /// The format of this program.
        expected: u32,
    },
    /// A plan made by another version of the program.
    #[error("the plan was made by version {found}, this is {expected}")]
    OtherVersion {
        /// Its version.
        found: String,
        /// That of the program.
        expected: String,
    },
    /// A plan of which some shard would be empty.
    #[error("the plan cuts {pieces} pieces of work into {shards} shards, of which each needs a piece")]
    NoPieces {
        /// Pieces of work.
        pieces: u64,
        /// Shards.
        shards: u64,
    },
    /// A shard that the plan does not have.
    #[error("shard {shard} does not exist: the plan has {shards}, numbered from 0")]
    NoSuchShard {
        /// What was requested.
        shard: u64,
        /// How many there are.
        shards: u64,
    },
    /// A part of another plan.
    #[error("{path} belongs to another plan ({found}, not {expected}): parts of two studies are not merged")]
    OtherPlan {
        /// The sidecar.
        path: PathBuf,
        /// Hash of its plan.
        found: String,
        /// Hash of this plan.
        expected: String,
    },
    /// A file that the plan names, with another content than then.
    #[error("{path} has changed since the plan was made: parts of two studies are not merged")]
    OtherFile {
        /// The file.
        path: PathBuf,
    },
    /// Parts that are not there.
    #[error("{missing} of {shards} shards are missing: {}", list(.first, *.missing))]
    Missing {
        /// How many.
        missing: u64,
        /// Numbers of the first of them.
        first: Vec<u64>,
        /// How many there should be.
        shards: u64,
    },
    /// Two parts of one shard.
    #[error("shard {shard} is there twice: {first} and {second}")]
    Duplicate {
        /// The shard.
        shard: u64,
        /// One sidecar.
        first: PathBuf,
        /// The other.
        second: PathBuf,
    },
    /// A Parquet file that is not the one that was written.
    #[error("{path} is not the file that its sidecar describes; run shard {shard} again")]
    Changed {
        /// The file.
        path: PathBuf,
        /// The shard.
        shard: u64,
    },
    /// A journal of other work.
    #[error("{path} is the journal of other work: its file, changes, seed, policies or version differ")]
    OtherWork {
        /// The journal.
        path: PathBuf,
    },
    /// No sidecar at all.
    #[error("{path} holds no part of a study")]
    NoParts {
        /// The directory.
        path: PathBuf,
    },
}

impl Located for ShardError {
    fn location(&self) -> Option<Location> {
        match self {
            Self::Duplicate { second, .. } => Some(Location::of(second.display())),
            Self::Damaged { path, source } if source.line() > 0 => {
                Some(Location::column(path.display(), source.line(), source.column()))
            }
            Self::Damaged { path, .. } => Some(Location::of(path.display())),
            Self::File { path, .. }
            | Self::UnreadablePlan { path, .. }
            | Self::Rows { path, .. }
            | Self::Altered { path, .. }
            | Self::Malformed { path, .. }
            | Self::NoPart { path, .. }
            | Self::NoPlan { path, .. }
            | Self::OtherPlan { path, .. }
            | Self::OtherFile { path, .. }
            | Self::Changed { path, .. }
            | Self::OtherWork { path, .. }
            | Self::NoParts { path, .. } => Some(Location::of(path.display())),
            Self::OtherFormat { .. }
            | Self::OtherVersion { .. }
            | Self::NoPieces { .. }
            | Self::NoSuchShard { .. }
            | Self::Missing { .. } => None,
        }
    }
}

impl ShardError {
    /// The likely way out.
    pub fn fix(&self) -> &'static str {
        match self {
            Self::File { .. } | Self::Rows { .. } => "choose another place, or make room",
            Self::UnreadablePlan { .. } => "check the path; --plan of compare, life and lobes writes plans",
            Self::OtherFormat { .. } | Self::OtherVersion { .. } => "use one version for plan, shards and merge",
            Self::OtherFile { .. } => "restore the file, or make a new plan and run all of its shards",
            Self::NoPlan { .. } => "give the plan another name",
            Self::NoPart { .. } => "run the shard into another directory, or move the file",
            Self::OtherWork { .. } => {
                "go on with the same command, choose another --out, or start anew without --resume"
            }
            Self::Damaged { .. } | Self::NoPieces { .. } => {
                "make a plan with toolroom life, compare or lobes FILE --plan plan.json"
            }
            Self::Altered { .. }
            | Self::Malformed { .. }
            | Self::NoSuchShard { .. }
            | Self::OtherPlan { .. }
            | Self::Missing { .. }
            | Self::Duplicate { .. }
            | Self::Changed { .. }
            | Self::NoParts { .. } => "run the missing shards, or merge the parts of one plan only",
        }
    }

    /// The field of the plan that is at fault, where it is one.
    pub fn field(&self) -> &'static str {
        match self {
            Self::OtherFormat { .. } => "schema",
            Self::OtherVersion { .. } => "version",
            Self::NoPieces { .. } => "shards",
            Self::OtherFile { .. } | Self::File { .. } => "files",
            Self::Rows { .. }
            | Self::UnreadablePlan { .. }
            | Self::NoPlan { .. }
            | Self::NoPart { .. }
            | Self::Damaged { .. }
            | Self::Altered { .. }
            | Self::Malformed { .. }
            | Self::NoSuchShard { .. }
            | Self::OtherPlan { .. }
            | Self::Missing { .. }
            | Self::Duplicate { .. }
            | Self::Changed { .. }
            | Self::OtherWork { .. }
            | Self::NoParts { .. } => "kind",
        }
    }
}

/// Missing shards that are listed.
pub(crate) const LISTED: usize = 10;

fn list(first: &[u64], count: u64) -> String {
    let shown = first.iter().map(u64::to_string).collect::<Vec<_>>().join(", ");
    if count > first.len() as u64 { shown + ", …" } else { shown }
}

/// The failure of the file system at a path, for `map_err`.
pub fn at(path: &Path) -> impl FnOnce(io::Error) -> ShardError {
    let path = path.to_owned();
    move |source| ShardError::File { path, source }
}
