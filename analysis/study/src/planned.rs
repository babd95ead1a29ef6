//! A comparison in shards: the replications are cut into parts that any host computes.

use crate::request::{UnknownPolicy, policies_named};
use crate::study::{KnownRuns, StoredRun, StudyError, stored_digest, stored_runs};
use std::path::Path;
use toolroom_form::ReadError;
use toolroom_scenario_file::{ScenarioFile, parse};
use toolroom_shards::{Computed, PLAN, Plan, ShardError, Work};

/// Why a planned comparison was not computed.
#[derive(Debug, thiserror::Error)]
pub enum PlannedError {
    /// The scenario of the plan.
    #[error(transparent)]
    Scenario(#[from] ReadError),
    /// A policy of the plan.
    #[error(transparent)]
    Policy(#[from] UnknownPolicy),
    /// A run stopped.
    #[error(transparent)]
    Study(#[from] StudyError),
    /// The files of the parts.
    #[error(transparent)]
    Shard(#[from] ShardError),
}

/// The plan of a comparison of `policies`, by index, in at most `shards` parts; a replication each where it is `None`.
/// The scenario of `file` was read as `name` with `overrides`.
///
/// # Errors
/// A file that the scenario names cannot be read.
pub fn plan(
    version: &str,
    name: &str,
    file: &ScenarioFile,
    overrides: Vec<String>,
    policies: &[usize],
    shards: Option<u64>,
) -> Result<Plan, ShardError> {
    let scenario = &file.scenario;
    let replications = u64::from(scenario.replications);
    Ok(Plan {
        schema: PLAN,
        kind: Work::Compare,
        version: version.to_owned(),
        name: scenario.name.clone(),
        file: name.to_owned(),
        directory: String::new(),
        text: file.text.clone(),
        files: Plan::fingerprints(&file.files)?,
        overrides,
        policies: policies.iter().map(|policy| scenario.policies[*policy].name.clone()).collect(),
        seed: scenario.seed,
        pieces: replications,
        shards: shards.unwrap_or(replications).min(replications),
    })
}

/// The scenario of a plan, and its policies by index.
///
/// # Errors
/// [`PlannedError::Scenario`], [`PlannedError::Policy`]
pub fn scenario(plan: &Plan) -> Result<(ScenarioFile, Vec<usize>), PlannedError> {
    let file = parse(&plan.file, &plan.text, &plan.overrides)?;
    let policies = policies_named(&file.scenario, &plan.policies)?;
    Ok((file, policies))
}

/// Computes one shard into the directory `folder`.
///
/// # Errors
/// See [`PlannedError`].
pub fn shard(plan: &Plan, number: u64, folder: &Path) -> Result<(), PlannedError> {
    let (file, policies) = scenario(plan)?;
    let mut failed = None;
    let ran = toolroom_shards::run(plan, number, folder, |(from, to), _| {
        // Replications are 32-bit numbers by the form of the file.
        let runs = stored_runs(&file.scenario, &policies, from as u32, to as u32).map_err(|error| {
            failed = Some(error);
            let source = std::io::Error::other("the shop stopped");
            ShardError::File { path: folder.to_owned(), source }
        })?;
        let digest = stored_digest(&file.scenario, &policies, (from, to), &runs)
            .map_err(|why| ShardError::Malformed { path: folder.to_owned(), why })?;
        Ok(Computed { content: runs, digest, rows: false })
    });
    match failed {
        Some(error) => Err(error.into()),
        None => Ok(ran?),
    }
}

/// The runs in the parts of a plan.
///
/// # Errors
/// [`ShardError`]: parts that are missing, changed or of another plan.
pub fn known_runs(plan: &Plan, parts: &Path, file: &ScenarioFile, policies: &[usize]) -> Result<KnownRuns, ShardError> {
    let digest = |runs: &Vec<StoredRun>, range| stored_digest(&file.scenario, policies, range, runs);
    let runs = toolroom_shards::parts(plan, parts, digest)?.into_iter().flatten();
    Ok(runs.map(|run| ((run.replication, run.policy), run)).collect())
}
