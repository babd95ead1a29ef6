//! Plans of work in shards as files, and the threads that do it.

use crate::failure::Failure;
use std::path::Path;
use toolroom_output::Files;
use toolroom_shards::Plan;

/// Leaves a plan where `--plan` says.
pub fn leave(plan: &Plan, path: &Path, files: &Files) -> Result<(), Failure> {
    Ok(files.put(path, serde_json::to_string_pretty(plan).map_err(Failure::Json)?.as_bytes())?)
}

/// Threads, 0 for one per processor.
pub fn pool(threads: usize) -> Result<rayon::ThreadPool, Failure> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|error| Failure::work(format_args!("no threads: {error}")))
}
