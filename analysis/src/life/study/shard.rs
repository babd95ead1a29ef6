//! A study in parts: every part a Parquet file of lives with a sidecar, merged to one result.
//!
//! A part is written under another name and renamed when it is whole, its sidecar last: what has
//! a sidecar is complete. Running a shard again changes nothing.

use super::edge::Outcome;
use super::run::{Tally, lives};
use super::{End, Study};
use crate::study::{FNV_OFFSET, fnv};
use polars::prelude::IntoColumn;
use polars::prelude::{Column, DataFrame, DataType, Field, NamedFrom, ParquetWriter, PolarsError, Schema, Series};
use serde::{Deserialize, Serialize};
use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

/// Lives of a cell that are held in memory at once.
const CHUNK: u64 = 65_536;

/// What is to be run, cut into shards.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Plan {
    /// Version of the format, 1.
    pub schema: u32,
    /// Kind of work, `life`.
    pub kind: String,
    /// Version of the program.
    pub version: String,
    /// Name of the study.
    pub name: String,
    /// Name of the study file.
    pub file: String,
    /// Folder of the study file, against which its paths are read.
    pub directory: String,
    /// Text of the study file.
    pub text: String,
    /// Changes to it, `path=value`.
    pub overrides: Vec<String>,
    /// Seed.
    pub seed: u64,
    /// Lives a cell.
    pub lives: u64,
    /// Number of shards.
    pub shards: u64,
}

impl Plan {
    /// Hash of everything in the plan but its place: parts of other plans are told by it.
    pub fn hash(&self) -> String {
        let Self { schema, kind, version, name, file: _, directory: _, text, overrides, seed, lives, shards } = self;
        let words = [kind, version, name, text, &overrides.join("\n")];
        let hash = words.iter().fold(FNV_OFFSET, |hash, word| fnv(fnv(hash, word.as_bytes()), &[0]));
        let numbers = [u64::from(*schema), *seed, *lives, *shards];
        let hash = numbers.iter().fold(hash, |hash, number| fnv(hash, &number.to_le_bytes()));
        format!("{hash:016x}")
    }

    /// Numbers of the lives of a shard, from and to.
    pub fn range(&self, shard: u64) -> (u64, u64) {
        let bound = |k: u64| (u128::from(k) * u128::from(self.lives) / u128::from(self.shards)) as u64;
        (bound(shard), bound(shard + 1))
    }
}

/// What stands beside a part.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sidecar {
    /// Version of the format, 1.
    pub schema: u32,
    /// Hash of the plan.
    pub plan: String,
    /// Version of the program.
    pub version: String,
    /// Number of the shard, from 0.
    pub shard: u64,
    /// Number of shards of the plan.
    pub shards: u64,
    /// Numbers of its lives, from and to.
    pub range: (u64, u64),
    /// Seed.
    pub seed: u64,
    /// Hash of the Parquet file; empty where no lives are written.
    pub file_hash: String,
    /// Hash of the lives, whatever their order.
    pub digest: String,
    /// One a cell.
    pub cells: Vec<Tally>,
}

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
    /// The Parquet writer failed.
    #[error("cannot write {path}: {source}")]
    Parquet {
        /// The file.
        path: PathBuf,
        /// What polars said.
        source: PolarsError,
    },
    /// A sidecar or plan that is no JSON of this kind.
    #[error("{path} is not readable: {source}; remove it and run its shard again")]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What serde said.
        source: serde_json::Error,
    },
    /// A shard that the plan does not have.
    #[error("shard {shard} does not exist: the plan has {shards}, numbered from 0")]
    NoSuchShard {
        /// What was asked for.
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
    /// Parts that are not there.
    #[error("{} of {shards} shards are missing: {}", .missing.len(), list(.missing))]
    Missing {
        /// Their numbers.
        missing: Vec<u64>,
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
    /// No sidecar at all.
    #[error("{path} holds no part of a study")]
    NoParts {
        /// The directory.
        path: PathBuf,
    },
}

fn list(numbers: &[u64]) -> String {
    let shown: Vec<String> = numbers.iter().take(10).map(u64::to_string).collect();
    if numbers.len() > 10 { format!("{}, …", shown.join(", ")) } else { shown.join(", ") }
}

fn at(path: &Path) -> impl FnOnce(io::Error) -> ShardError {
    let path = path.to_owned();
    move |source| ShardError::File { path, source }
}

fn part(directory: &Path, shard: u64, extension: &str) -> PathBuf {
    directory.join(format!("part-{shard:06}.{extension}"))
}

/// Writes a file under another name and renames it when it is whole.
fn atomically(path: &Path, bytes: &[u8]) -> Result<(), ShardError> {
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

/// Writes the plan; an equal one may be there.
///
/// # Errors
/// [`ShardError`].
pub fn write_plan(path: &Path, plan: &Plan) -> Result<(), ShardError> {
    let text =
        serde_json::to_string_pretty(plan).map_err(|source| ShardError::Damaged { path: path.to_owned(), source })?;
    if fs::read_to_string(path).is_ok_and(|there| there == text) {
        return Ok(());
    }
    atomically(path, text.as_bytes())
}

/// Reads a plan.
///
/// # Errors
/// [`ShardError`].
pub fn read_plan(path: &Path) -> Result<Plan, ShardError> {
    let text = fs::read_to_string(path).map_err(at(path))?;
    serde_json::from_str(&text).map_err(|source| ShardError::Damaged { path: path.to_owned(), source })
}

/// Whether the part of a shard is there, whole and of this plan.
pub fn is_done(plan: &Plan, shard: u64, directory: &Path) -> bool {
    let path = part(directory, shard, "json");
    let Ok(sidecar) = read_sidecar(&path) else { return false };
    sidecar.plan == plan.hash()
        && (sidecar.file_hash.is_empty()
            || hash_of(&part(directory, shard, "parquet")).is_ok_and(|hash| hash == sidecar.file_hash))
}

fn read_sidecar(path: &Path) -> Result<Sidecar, ShardError> {
    let text = fs::read_to_string(path).map_err(at(path))?;
    serde_json::from_str(&text).map_err(|source| ShardError::Damaged { path: path.to_owned(), source })
}

/// Runs a shard into a directory; nothing happens where its part is there already. `rows` says
/// whether lives are written or only their statistics.
///
/// # Errors
/// [`ShardError`]; what was complete stays.
pub fn run(study: &Study, plan: &Plan, shard: u64, directory: &Path, rows: bool) -> Result<(), ShardError> {
    if shard >= plan.shards {
        return Err(ShardError::NoSuchShard { shard, shards: plan.shards });
    }
    fs::create_dir_all(directory).map_err(at(directory))?;
    let sidecar_path = part(directory, shard, "json");
    if let Ok(there) = read_sidecar(&sidecar_path)
        && there.plan != plan.hash()
    {
        return Err(ShardError::OtherPlan { path: sidecar_path, found: there.plan, expected: plan.hash() });
    }
    if is_done(plan, shard, directory) {
        return Ok(());
    }
    let (from, to) = plan.range(shard);
    let path = part(directory, shard, "parquet");
    let draft = path.with_extension(format!("partial-{}", std::process::id()));
    let cells = match write_lives(study, (from, to), rows.then_some(draft.as_path())) {
        Ok(cells) => cells,
        Err(error) => {
            let _ = fs::remove_file(&draft);
            return Err(error);
        }
    };
    let mut file_hash = String::new();
    if rows {
        file_hash = hash_of(&draft)?;
        fs::rename(&draft, &path).map_err(at(&path))?;
    }
    let digest = cells.iter().fold(0u64, |digest, cell| digest.wrapping_add(cell.digest.0));
    let sidecar = Sidecar {
        schema: 1,
        plan: plan.hash(),
        version: plan.version.clone(),
        shard,
        shards: plan.shards,
        range: (from, to),
        seed: plan.seed,
        file_hash,
        digest: format!("{digest:016x}"),
        cells,
    };
    let text =
        serde_json::to_string(&sidecar).map_err(|source| ShardError::Damaged { path: sidecar_path.clone(), source })?;
    atomically(&sidecar_path, text.as_bytes())
}

fn write_lives(study: &Study, (from, to): (u64, u64), path: Option<&Path>) -> Result<Vec<Tally>, ShardError> {
    let failed = |path: &Path| {
        let path = path.to_owned();
        move |source| ShardError::Parquet { path, source }
    };
    let fields = [
        ("condition", DataType::String),
        ("policy", DataType::String),
        ("edge", DataType::Float64),
        ("life [min]", DataType::Float64),
        ("path [m]", DataType::Float64),
        ("flank_wear [mm]", DataType::Float64),
        ("end", DataType::String),
        ("weight", DataType::Float64),
    ];
    let schema: Schema = fields.iter().map(|(name, kind)| Field::new((*name).into(), kind.clone())).collect();
    let mut writer = match path {
        Some(path) => {
            let file = File::create(path).map_err(at(path))?;
            Some(
                ParquetWriter::new(io::BufWriter::new(file))
                    .set_parallel(false)
                    .batched(&schema)
                    .map_err(failed(path))?,
            )
        }
        None => None,
    };
    let mut cells = Vec::with_capacity(study.cells.len());
    for cell in &study.cells {
        let mut tally = Tally::default();
        let mut start = from;
        while start < to {
            let end = to.min(start + CHUNK);
            let (part, outcomes) = lives(study, cell, start, end, writer.is_some());
            tally.merge(&part);
            if let (Some(writer), Some(path)) = (&mut writer, path) {
                let names = (cell.condition.as_str(), cell.policy.as_str());
                let frame = frame(names, start, &outcomes).map_err(failed(path))?;
                writer.write_batch(&frame).map_err(failed(path))?;
            }
            start = end;
        }
        cells.push(tally);
    }
    if let (Some(writer), Some(path)) = (writer, path) {
        writer.finish().map_err(failed(path))?;
        File::open(path).and_then(|file| file.sync_all()).map_err(at(path))?;
    }
    Ok(cells)
}

fn frame((condition, policy): (&str, &str), start: u64, outcomes: &[Outcome]) -> Result<DataFrame, PolarsError> {
    let n = outcomes.len();
    let real = |name: &str, of: &dyn Fn(usize, &Outcome) -> f64| -> Column {
        let values: Vec<f64> = outcomes.iter().enumerate().map(|(i, outcome)| of(i, outcome)).collect();
        Series::new(name.into(), values).into_column()
    };
    let text = |name: &str, values: Vec<&str>| Series::new(name.into(), values).into_column();
    let columns = vec![
        text("condition", vec![condition; n]),
        text("policy", vec![policy; n]),
        real("edge", &|i, _| (start + i as u64) as f64),
        real("life [min]", &|_, outcome| outcome.life / 60.0),
        real("path [m]", &|_, outcome| outcome.path),
        real("flank_wear [mm]", &|_, outcome| outcome.flank_wear * 1e3),
        text("end", outcomes.iter().map(|outcome| outcome.end.name()).collect()),
        real("weight", &|_, outcome| outcome.weight),
    ];
    DataFrame::new(n, columns)
}

/// FNV-1a of a file, read in pieces.
fn hash_of(path: &Path) -> Result<String, ShardError> {
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

/// All parts of a plan as one.
#[derive(Clone, Debug, PartialEq)]
pub struct Merged {
    /// One a cell.
    pub cells: Vec<Tally>,
    /// Hash of all lives, the same for every number of shards.
    pub digest: u64,
}

/// Merges the parts in a directory.
///
/// # Errors
/// [`ShardError`] for missing, doubled, foreign and changed parts.
pub fn merge(plan: &Plan, directory: &Path) -> Result<Merged, ShardError> {
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
    let mut seen: Vec<Option<PathBuf>> = vec![None; plan.shards as usize];
    let mut merged = Merged { cells: Vec::new(), digest: 0 };
    let mut files = Vec::new();
    for path in paths {
        let sidecar = read_sidecar(&path)?;
        if sidecar.plan != expected {
            return Err(ShardError::OtherPlan { path, found: sidecar.plan, expected });
        }
        let shard = sidecar.shard;
        match seen.get_mut(shard as usize) {
            None => return Err(ShardError::NoSuchShard { shard, shards: plan.shards }),
            Some(Some(first)) => {
                return Err(ShardError::Duplicate { shard, first: first.clone(), second: path });
            }
            Some(slot) => *slot = Some(path.clone()),
        }
        if !sidecar.file_hash.is_empty() {
            files.push((path.with_extension("parquet"), shard, sidecar.file_hash));
        }
        merged.cells.resize(sidecar.cells.len().max(merged.cells.len()), Tally::default());
        merged.cells.iter_mut().zip(&sidecar.cells).for_each(|(own, other)| own.merge(other));
    }
    for (path, shard, hash) in files {
        if hash_of(&path).ok() != Some(hash) {
            return Err(ShardError::Changed { path, shard });
        }
    }
    let missing: Vec<u64> = (0..plan.shards).filter(|shard| seen[*shard as usize].is_none()).collect();
    if !missing.is_empty() {
        return Err(ShardError::Missing { missing, shards: plan.shards });
    }
    merged.digest = merged.cells.iter().fold(0, |digest: u64, cell| digest.wrapping_add(cell.digest.0));
    Ok(merged)
}

/// Lives of a merged cell as a sample for fits, in minutes: classes of the sketch, edges that
/// were still good as censored.
pub fn sample(tally: &Tally) -> Result<crate::life::sample::Sample, crate::life::sample::SampleError> {
    use crate::life::sample::{Observation, Sample};
    let minutes = |observation| match observation {
        Observation::Between(low, high) => Observation::Between(low / 60.0, high / 60.0),
        other => other,
    };
    let lives = End::ALL.iter().zip(&tally.ends).flat_map(|(end, sketch)| {
        sketch.observations().map(move |(observation, weight)| {
            let observation = minutes(observation);
            (if end.censored() { Observation::Censored(observation.age()) } else { observation }, weight)
        })
    });
    Sample::weighted(lives)
}
