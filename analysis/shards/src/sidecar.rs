//! What stands beside a part and proves it.

use crate::{Plan, ShardError, at, fingerprint};
use serde::{Deserialize, Serialize, de::DeserializeOwned};
use std::fmt::Display;
use std::fs;
use std::path::{Path, PathBuf};

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
pub(crate) const SIDECAR: u32 = 2;
pub(crate) fn part(directory: &Path, shard: u64, extension: &str) -> PathBuf {
    directory.join(format!("part-{shard:06}.{extension}"))
}
/// What stands between the content of a sidecar and the 16 digits of its hash, and after them.
pub(crate) const TAIL: [&str; 2] = [",\"hash\":\"", "\"}"];

/// A sidecar as text. Its hash is that of every byte before it, so that no byte can change unseen.
pub(crate) fn sealed<C: Serialize>(sidecar: &Sidecar<C>) -> Result<String, serde_json::Error> {
    let mut text = serde_json::to_string(sidecar)?;
    text.pop(); // the last brace comes after the hash
    let hash = fingerprint(text.as_bytes());
    Ok(text + TAIL[0] + &hash + TAIL[1])
}

/// How every sidecar begins.
const HEAD: &str = "{\"schema\":";

/// Whether a file is a sidecar, though it may be cut or changed further on; one that cannot be read may be one.
pub(crate) fn is_sidecar(path: &Path) -> bool {
    fs::read(path).is_ok_and(|bytes| bytes.iter().zip(HEAD.as_bytes()).all(|(own, due)| own == due))
}

/// The text of a sidecar without its hash; `None` where that is not its own.
fn unsealed(bytes: &[u8]) -> Option<String> {
    let text = std::str::from_utf8(bytes).ok()?.strip_suffix(TAIL[1])?;
    let (text, hash) = text.split_at_checked(text.len().checked_sub(16)?)?;
    let text = text.strip_suffix(TAIL[0])?;
    (fingerprint(text.as_bytes()) == hash).then(|| text.to_owned() + "}")
}

pub(crate) fn read_sidecar<C: DeserializeOwned>(path: &Path) -> Result<Sidecar<C>, ShardError> {
    let bytes = fs::read(path).map_err(at(path))?;
    let altered = || ShardError::Altered { path: path.to_owned() };
    let text = unsealed(&bytes).ok_or_else(altered)?;
    let malformed = |error: serde_json::Error| ShardError::Malformed { path: path.to_owned(), why: error.to_string() };
    serde_json::from_str(&text).map_err(malformed)
}

/// What a sidecar says of itself that its plan does not, where anything.
pub(crate) fn wrong<C>(plan: &Plan, sidecar: &Sidecar<C>) -> Option<String> {
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
