//! The parts of a plan: computed, and removed.

use crate::draft::{atomically, writing};
use crate::sidecar::{SIDECAR, is_sidecar, part, read_sidecar, sealed, wrong};
use crate::{Plan, ShardError, Sidecar, at, hash_of, read_plan};
use serde::{Serialize, de::DeserializeOwned};
use std::fs;
use std::path::Path;

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
        // A file that is no sidecar is somebody's; one that was changed or cut is written anew.
        Err(ShardError::Altered { path }) if !is_sidecar(&path) => return Err(ShardError::NoPart { path }),
        Ok(_) | Err(_) => {}
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

/// Whether the part of a shard is there, whole and of this plan.
pub fn is_done<C: DeserializeOwned>(plan: &Plan, shard: u64, directory: &Path) -> bool {
    let Ok(sidecar) = read_sidecar::<C>(&part(directory, shard, "json")) else { return false };
    wrong(plan, &sidecar).is_none()
        && sidecar.shard == shard
        && (sidecar.file_hash.is_empty()
            || hash_of(&part(directory, shard, "parquet")).is_ok_and(|hash| hash == sidecar.file_hash))
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
