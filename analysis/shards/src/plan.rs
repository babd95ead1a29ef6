//! What is to be run, cut into shards, and its file.

use crate::draft::atomically;
use crate::{FNV_OFFSET, ShardError, at, fnv, hash_of};
use serde::{Deserialize, Serialize};
use std::fs;
use std::path::{Path, PathBuf};

/// Kind of work that a plan cuts into shards.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Work {
    /// A study of tool lives.
    Life,
    /// A comparison of policies.
    Compare,
    /// A stability chart.
    Lobes,
}

impl Work {
    /// Its word, which is the verb that makes the plan.
    pub fn word(self) -> &'static str {
        match self {
            Self::Life => "life",
            Self::Compare => "compare",
            Self::Lobes => "lobes",
        }
    }
}

/// What a comparison compares.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Axis {
    /// Policies of the shop as it is.
    Policy,
    /// Variants of the shop under the first policy.
    Variant,
    /// Variants under every policy.
    Both,
}

impl Axis {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Policy, Self::Variant, Self::Both];

    /// Its word.
    pub fn word(self) -> &'static str {
        match self {
            Self::Policy => "policy",
            Self::Variant => "variant",
            Self::Both => "both",
        }
    }

    /// What it is, for help.
    pub fn meaning(self) -> &'static str {
        match self {
            Self::Policy => "Policies of the shop as it is",
            Self::Variant => "Variants of the shop under the first policy",
            Self::Both => "Variants under every policy",
        }
    }
}

/// Version of the format of plans.
pub const PLAN: u32 = 1;

/// What is to be run, cut into shards.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Plan {
    /// Version of the format, 1.
    pub schema: u32,
    /// Kind of work.
    pub kind: Work,
    /// Version of the program.
    pub version: String,
    /// Name of the study or scenario.
    pub name: String,
    /// Name of its file.
    pub file: String,
    /// Folder of the file, against which its paths are read.
    pub directory: String,
    /// Text of the file.
    pub text: String,
    /// Files that the text names, each with the fingerprint of its content.
    pub files: Vec<(String, String)>,
    /// Changes to it, `path=value`.
    pub overrides: Vec<String>,
    /// Seed.
    pub seed: u64,
    /// Names of the policies of a comparison, none for all of them.
    pub policies: Vec<String>,
    /// What a comparison compares; all that the scenario has where it is left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub axis: Option<Axis>,
    /// Pieces of work: lives of each cell, replications of each policy, columns of a chart.
    pub pieces: u64,
    /// Number of shards.
    pub shards: u64,
}

impl Plan {
    /// Hash of everything in the plan but its place: parts of other plans are told by it.
    pub fn hash(&self) -> String {
        let Self {
            schema,
            kind,
            version,
            name,
            file: _,
            directory: _,
            text,
            files,
            overrides,
            policies,
            axis,
            seed,
            pieces,
            shards,
        } = self;
        let contents: Vec<&str> = files.iter().map(|(_, fingerprint)| fingerprint.as_str()).collect();
        let (contents, overrides, policies) = (contents.join("\n"), overrides.join("\n"), policies.join("\n"));
        let words = [kind.word(), version, name, text, &contents, &overrides, &policies];
        let words = words.into_iter().chain(axis.map(Axis::word));
        let hash = words.fold(FNV_OFFSET, |hash, word| fnv(fnv(hash, word.as_bytes()), &[0]));
        let numbers = [u64::from(*schema), *seed, *pieces, *shards];
        let hash = numbers.iter().fold(hash, |hash, number| fnv(hash, &number.to_le_bytes()));
        format!("{hash:016x}")
    }

    /// Files for [`Plan::files`].
    ///
    /// # Errors
    /// [`ShardError`] for a file that cannot be read.
    pub fn fingerprints(paths: &[PathBuf]) -> Result<Vec<(String, String)>, ShardError> {
        paths.iter().map(|path| Ok((path.display().to_string(), hash_of(path)?))).collect()
    }

    /// Whether a program of this version can run the plan, and the files that it names are still those for which it
    /// was made.
    ///
    /// # Errors
    /// [`ShardError`] for another format or version, a plan of nothing, and the first file that has changed or cannot be
    /// read.
    pub fn check(&self, version: &str) -> Result<(), ShardError> {
        if self.schema != PLAN {
            return Err(ShardError::OtherFormat { found: self.schema, expected: PLAN });
        }
        if self.version != version {
            return Err(ShardError::OtherVersion { found: self.version.clone(), expected: version.to_owned() });
        }
        if !(1..=self.pieces).contains(&self.shards) {
            return Err(ShardError::NoPieces { pieces: self.pieces, shards: self.shards });
        }
        self.files.iter().try_for_each(|(file, fingerprint)| {
            let path = PathBuf::from(file);
            if hash_of(&path)? == *fingerprint { Ok(()) } else { Err(ShardError::OtherFile { path }) }
        })
    }

    /// Numbers of the pieces of a shard, from and to.
    pub fn range(&self, shard: u64) -> (u64, u64) {
        let bound = |k: u64| (u128::from(k) * u128::from(self.pieces) / u128::from(self.shards)) as u64;
        (bound(shard), bound(shard + 1))
    }
}
/// Writes the plan; another one in its place is replaced. What is no file, such as `/dev/stdout`, is
/// written into and stays what it is.
///
/// # Errors
/// [`ShardError`], [`ShardError::NoPlan`] where a file that is no plan has the name: it stays as it is.
pub fn write_plan(path: &Path, plan: &Plan) -> Result<(), ShardError> {
    let text =
        serde_json::to_string_pretty(plan).map_err(|source| ShardError::Damaged { path: path.to_owned(), source })?;
    let Ok(there) = fs::metadata(path) else { return atomically(path, text.as_bytes()) };
    if !there.is_file() {
        return fs::write(path, text).map_err(at(path));
    }
    let there = fs::read(path).map_err(at(path))?;
    if there == text.as_bytes() {
        return Ok(());
    }
    if !there.is_empty() && serde_json::from_slice::<Plan>(&there).is_err() {
        return Err(ShardError::NoPlan { path: path.to_owned() });
    }
    atomically(path, text.as_bytes())
}

/// Reads a plan.
///
/// # Errors
/// [`ShardError`].
pub fn read_plan(path: &Path) -> Result<Plan, ShardError> {
    let bytes = fs::read(path).map_err(|source| ShardError::UnreadablePlan { path: path.to_owned(), source })?;
    serde_json::from_slice(&bytes).map_err(|source| ShardError::Damaged { path: path.to_owned(), source })
}
