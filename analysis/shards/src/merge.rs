//! Parts of a plan, read and held against it.

use crate::error::LISTED;
use crate::sidecar::{read_sidecar, wrong};
use crate::{Plan, ShardError, at, hash_of};
use serde::de::DeserializeOwned;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

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
