//! Work in parts: a plan is cut into shards, each leaves a part with a sidecar, parts are merged.
//!
//! ```text
//!  Plan ─► shard k of N ─► part-K.parquet (rows, where there are some)
//!                     └──► part-K.json: hash of the plan, range, hash of the rows, content, hash of all that ─► merge
//! ```
//!
//! A part is written under another name and renamed when it is whole, its sidecar last: what has
//! a sidecar is complete. Running a shard again changes nothing.

#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

mod fingerprint;
mod journal;

pub use fingerprint::{FNV_OFFSET, fingerprint, fnv};
pub use journal::Journal;

use serde::{Deserialize, Serialize, de::DeserializeOwned};
use std::collections::BTreeMap;
use std::fmt::Display;
use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::{PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard};

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
            seed,
            pieces,
            shards,
        } = self;
        let contents: Vec<&str> = files.iter().map(|(_, fingerprint)| fingerprint.as_str()).collect();
        let words =
            [kind.word(), version, name, text, &contents.join("\n"), &overrides.join("\n"), &policies.join("\n")];
        let hash = words.iter().fold(FNV_OFFSET, |hash, word| fnv(fnv(hash, word.as_bytes()), &[0]));
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
            return Err(ShardError::OtherFormat { found: self.schema });
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

/// What stands beside a part, followed in its file by the hash of its text.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sidecar<C> {
    /// Version of the format, 2.
    pub schema: u32,
    /// Hash of the plan.
    pub plan: String,
    /// Version of the program.
    pub version: String,
    /// Number of the shard, from 0.
    pub shard: u64,
    /// Number of shards of the plan.
    pub shards: u64,
    /// Numbers of its pieces, from and to.
    pub range: (u64, u64),
    /// Seed.
    pub seed: u64,
    /// Hash of the Parquet file; empty where no rows are written.
    pub file_hash: String,
    /// Digest of what was computed.
    pub digest: String,
    /// What was computed.
    pub content: C,
}

/// Version of the format of sidecars: from 2 on they end with the hash of their text.
const SIDECAR: u32 = 2;

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
    /// A file in the place of a plan that is none.
    #[error("{path} is there and is no plan: nothing was changed")]
    NoPlan {
        /// The file.
        path: PathBuf,
    },
    /// A plan of another format.
    #[error("the plan has the format {found}, this is {PLAN}")]
    OtherFormat {
        /// Its format.
        found: u32,
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

impl ShardError {
    /// The likely way out.
    pub fn fix(&self) -> &'static str {
        match self {
            Self::File { .. } | Self::Rows { .. } => "choose another place, or make room",
            Self::OtherFormat { .. } | Self::OtherVersion { .. } => "use one version for plan, shards and merge",
            Self::OtherFile { .. } => "restore the file, or make a new plan and run all of its shards",
            Self::NoPlan { .. } => "give the plan another name",
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
            | Self::NoPlan { .. }
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
const LISTED: usize = 10;

fn list(first: &[u64], count: u64) -> String {
    let shown = first.iter().map(u64::to_string).collect::<Vec<_>>().join(", ");
    if count > first.len() as u64 { shown + ", …" } else { shown }
}

/// The failure of the file system at a path, for `map_err`.
pub fn at(path: &Path) -> impl FnOnce(io::Error) -> ShardError {
    let path = path.to_owned();
    move |source| ShardError::File { path, source }
}

fn part(directory: &Path, shard: u64, extension: &str) -> PathBuf {
    directory.join(format!("part-{shard:06}.{extension}"))
}

/// Read while a part is written or a shard is begun, written by whoever ends the process.
static WRITING: RwLock<()> = RwLock::new(());

/// Waits until parts that are being written have their names, and keeps every thread from writing another part or
/// beginning another shard as long as the answer lives: what ends the process can then remove drafts for good.
pub fn nothing_more() -> RwLockWriteGuard<'static, ()> {
    WRITING.write().unwrap_or_else(PoisonError::into_inner)
}

fn writing() -> RwLockReadGuard<'static, ()> {
    WRITING.read().unwrap_or_else(PoisonError::into_inner)
}

/// Writes a file under another name and renames it when it is whole.
fn atomically(path: &Path, bytes: &[u8]) -> Result<(), ShardError> {
    let _writing = writing();
    let draft = path.with_extension(format!("partial-{}", std::process::id()));
    let written = File::create(&draft).and_then(|mut file| {
        file.write_all(bytes)?;
        file.sync_all()
    });
    written.and_then(|()| fs::rename(&draft, path)).map_err(|source| {
        // Why it failed matters more than whether the remains could be removed.
        let _ = fs::remove_file(&draft);
        ShardError::File { path: path.to_owned(), source }
    })
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
    let bytes = fs::read(path).map_err(at(path))?;
    serde_json::from_slice(&bytes).map_err(|source| ShardError::Damaged { path: path.to_owned(), source })
}

/// Whether the part of a shard is there, whole and of this plan.
pub fn is_done<C: DeserializeOwned>(plan: &Plan, shard: u64, directory: &Path) -> bool {
    let Ok(sidecar) = read_sidecar::<C>(&part(directory, shard, "json")) else { return false };
    wrong(plan, &sidecar).is_none()
        && sidecar.shard == shard
        && (sidecar.file_hash.is_empty()
            || hash_of(&part(directory, shard, "parquet")).is_ok_and(|hash| hash == sidecar.file_hash))
}

/// What stands between the content of a sidecar and the 16 digits of its hash, and after them.
const TAIL: [&str; 2] = [",\"hash\":\"", "\"}"];

/// A sidecar as text. Its hash is that of every byte before it, so that no byte can change unseen.
fn sealed<C: Serialize>(sidecar: &Sidecar<C>) -> Result<String, serde_json::Error> {
    let mut text = serde_json::to_string(sidecar)?;
    text.pop(); // the last brace comes after the hash
    let hash = fingerprint(text.as_bytes());
    Ok(text + TAIL[0] + &hash + TAIL[1])
}

/// The text of a sidecar without its hash; `None` where that is not its own.
fn unsealed(bytes: &[u8]) -> Option<String> {
    let text = std::str::from_utf8(bytes).ok()?.strip_suffix(TAIL[1])?;
    let (text, hash) = text.split_at_checked(text.len().checked_sub(16)?)?;
    let text = text.strip_suffix(TAIL[0])?;
    (fingerprint(text.as_bytes()) == hash).then(|| text.to_owned() + "}")
}

fn read_sidecar<C: DeserializeOwned>(path: &Path) -> Result<Sidecar<C>, ShardError> {
    let bytes = fs::read(path).map_err(at(path))?;
    let altered = || ShardError::Altered { path: path.to_owned() };
    let text = unsealed(&bytes).ok_or_else(altered)?;
    let malformed = |error: serde_json::Error| ShardError::Malformed { path: path.to_owned(), why: error.to_string() };
    serde_json::from_str(&text).map_err(malformed)
}

/// What a sidecar says of itself that its plan does not, where anything.
fn wrong<C>(plan: &Plan, sidecar: &Sidecar<C>) -> Option<String> {
    let Sidecar { schema, plan: hash, version, shard, shards, range, seed, file_hash: _, digest: _, content: _ } =
        sidecar;
    let differs =
        |what: &str, found: &dyn Display, due: &dyn Display| Some(format!("its {what} is {found}, not {due}"));
    if *schema != SIDECAR {
        return differs("schema", schema, &SIDECAR);
    }
    if *hash != plan.hash() {
        return differs("plan", hash, &plan.hash());
    }
    if *version != plan.version {
        return differs("version", version, &plan.version);
    }
    if *shards != plan.shards {
        return differs("number of shards", shards, &plan.shards);
    }
    if *seed != plan.seed {
        return differs("seed", seed, &plan.seed);
    }
    if *shard >= plan.shards {
        return Some(format!("it is shard {shard} of {shards}, numbered from 0"));
    }
    let due = plan.range(*shard);
    (*range != due).then(|| format!("it holds the pieces {} … {}, not {} … {}", range.0, range.1, due.0, due.1))
}

/// What a shard computes: its content, the digest of it, and whether it wrote rows to the file
/// that it was given.
#[derive(Clone, Debug, PartialEq)]
pub struct Computed<C> {
    /// For the sidecar.
    pub content: C,
    /// For people.
    pub digest: u64,
    /// Whether there is a Parquet file.
    pub rows: bool,
}

/// Runs a shard into a directory; nothing happens where its part is there already. `compute` gets
/// the range of its pieces and the draft of its Parquet file.
///
/// # Errors
/// [`ShardError`]; what was complete stays.
pub fn run<C: Serialize + DeserializeOwned>(
    plan: &Plan,
    shard: u64,
    directory: &Path,
    compute: impl FnOnce((u64, u64), &Path) -> Result<Computed<C>, ShardError>,
) -> Result<(), ShardError> {
    if shard >= plan.shards {
        return Err(ShardError::NoSuchShard { shard, shards: plan.shards });
    }
    fs::create_dir_all(directory).map_err(at(directory))?;
    let sidecar_path = part(directory, shard, "json");
    match read_sidecar::<C>(&sidecar_path) {
        Ok(there) if there.plan != plan.hash() => {
            return Err(ShardError::OtherPlan { path: sidecar_path, found: there.plan, expected: plan.hash() });
        }
        // A file that is no sidecar is somebody's.
        Err(error @ ShardError::Damaged { .. }) => return Err(error),
        _ => {}
    }
    if is_done::<C>(plan, shard, directory) {
        return Ok(());
    }
    let range = plan.range(shard);
    let path = part(directory, shard, "parquet");
    let draft = path.with_extension(format!("partial-{}", std::process::id()));
    drop(writing()); // no shard begins once the process ends
    let computed = compute(range, &draft).inspect_err(|_| {
        // Why it failed matters more than whether the remains could be removed.
        let _ = fs::remove_file(&draft);
    })?;
    let mut file_hash = String::new();
    if computed.rows {
        file_hash = hash_of(&draft)?;
        fs::rename(&draft, &path).map_err(at(&path))?;
    }
    let sidecar = Sidecar {
        schema: SIDECAR,
        plan: plan.hash(),
        version: plan.version.clone(),
        shard,
        shards: plan.shards,
        range,
        seed: plan.seed,
        file_hash,
        digest: format!("{:016x}", computed.digest),
        content: computed.content,
    };
    let text = sealed(&sidecar).map_err(|source| ShardError::Damaged { path: sidecar_path.clone(), source })?;
    atomically(&sidecar_path, text.as_bytes())
}

/// Removes a plan and the parts that belong to it, so that another plan can be run there; whatever else the directory
/// holds stays.
///
/// # Errors
/// [`ShardError::Changed`] where a part is not the one that was written; nothing is removed then. Not with `force`.
pub fn discard(directory: &Path, force: bool) -> Result<(), ShardError> {
    let plan_path = directory.join("plan.json");
    if !plan_path.exists() {
        return Ok(());
    }
    let plan = read_plan(&plan_path)?;
    let hash = plan.hash();
    let mut files = Vec::new();
    for shard in 0..plan.shards {
        let (sidecar, rows) = (part(directory, shard, "json"), part(directory, shard, "parquet"));
        // Rows without a sidecar are those of a process that died between the two.
        let Ok(there) = read_sidecar::<serde_json::Value>(&sidecar) else { continue };
        if there.plan != hash {
            continue;
        }
        if rows.exists() && !there.file_hash.is_empty() {
            if !force && hash_of(&rows)? != there.file_hash {
                return Err(ShardError::Changed { path: rows, shard });
            }
            files.push(rows);
        }
        files.push(sidecar);
    }
    files.push(plan_path);
    files.iter().try_for_each(|file| fs::remove_file(file).map_err(at(file)))
}

/// Reads the content of every part of a plan, in the order of the shards. `digest` says what is wrong with
/// the content of a range of pieces, and gives its digest where nothing is.
///
/// # Errors
/// [`ShardError`] for missing, doubled, foreign, changed and malformed parts.
pub fn parts<C: DeserializeOwned>(
    plan: &Plan,
    directory: &Path,
    digest: impl Fn(&C, (u64, u64)) -> Result<u64, String>,
) -> Result<Vec<C>, ShardError> {
    let mut paths: Vec<PathBuf> = fs::read_dir(directory)
        .map_err(at(directory))?
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| {
            let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
            name.starts_with("part-") && name.ends_with(".json")
        })
        .collect();
    paths.sort();
    if paths.is_empty() {
        return Err(ShardError::NoParts { path: directory.to_owned() });
    }
    let expected = plan.hash();
    let mut found: BTreeMap<u64, (PathBuf, C)> = BTreeMap::new();
    let mut files = Vec::new();
    for path in paths {
        let sidecar = read_sidecar::<C>(&path)?;
        if sidecar.plan != expected {
            return Err(ShardError::OtherPlan { path, found: sidecar.plan, expected });
        }
        let shard = sidecar.shard;
        if shard >= plan.shards {
            return Err(ShardError::NoSuchShard { shard, shards: plan.shards });
        }
        if let Some((first, _)) = found.get(&shard) {
            return Err(ShardError::Duplicate { shard, first: first.clone(), second: path });
        }
        let computed = match wrong(plan, &sidecar) {
            Some(why) => Err(why),
            None => digest(&sidecar.content, sidecar.range),
        };
        match computed {
            Ok(digest) if format!("{digest:016x}") == sidecar.digest => {}
            Ok(_) => {
                let why = "its digest is not that of its content".to_owned();
                return Err(ShardError::Malformed { path, why });
            }
            Err(why) => return Err(ShardError::Malformed { path, why }),
        }
        if !sidecar.file_hash.is_empty() {
            files.push((path.with_extension("parquet"), shard, sidecar.file_hash));
        }
        found.insert(shard, (path, sidecar.content));
    }
    for (path, shard, hash) in files {
        if hash_of(&path).ok() != Some(hash) {
            return Err(ShardError::Changed { path, shard });
        }
    }
    let missing = plan.shards - found.len() as u64;
    if missing > 0 {
        let first = (0..plan.shards).filter(|shard| !found.contains_key(shard)).take(LISTED).collect();
        return Err(ShardError::Missing { missing, first, shards: plan.shards });
    }
    Ok(found.into_values().map(|(_, content)| content).collect())
}

/// FNV-1a of a file as 16 hexadecimal digits, read in pieces.
///
/// # Errors
/// [`ShardError::File`] where it cannot be read.
pub fn hash_of(path: &Path) -> Result<String, ShardError> {
    let mut file = File::open(path).map_err(at(path))?;
    let (mut hash, mut buffer) = (FNV_OFFSET, vec![0; 1 << 16]);
    loop {
        let read = file.read(&mut buffer).map_err(at(path))?;
        if read == 0 {
            return Ok(format!("{hash:016x}"));
        }
        hash = fnv(hash, &buffer[..read]);
    }
}

#[cfg(test)]
mod tests;
