//! A shop in the middle of its run, as a file from which it goes on.
//!
//! A snapshot does not hold the shop itself. It says which scenario was run to which instant, under which policies and for how
//! many replications, and what the digest of each of these runs was then. Who goes on from it simulates up to that instant
//! again, and the digests prove that this is the same shop, event by event. What follows is then the uninterrupted run bit for
//! bit, and a branch of it where something is changed from that instant on.
//!
//! | file | |
//! |---|---|
//! | `format` | 1; another one is refused |
//! | `version` | of the program that made it; another one is refused, since its shop may run otherwise |
//! | `file`, `inputs` | the scenario and the files that it names, with fingerprints |
//! | `changes` | what `--set`, `--seed` and `--replications` changed of it |
//! | `at` | the instant, s since the start |
//! | `policies`, `digests` | names; for every policy the digests of the replications |
//!
//! # What is not modelled
//! The state of the shop in the file, by which a long run up to the instant need not be repeated.

#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use toolroom_form::ReadError;
use toolroom_kernel::SimTime;
use toolroom_location::{Located, Location};
use toolroom_process::unit;
use toolroom_scenario::policies::ResolvedPolicy;
use toolroom_scenario::{Scenario, date};
use toolroom_scenario_file::{ScenarioFile, read};
use toolroom_shards::{Plan, ShardError};
use toolroom_shop::{Shop, ShopError, Silent};

/// Number of the format.
const FORMAT: u32 = 1;

/// Codes of errors of this crate for `toolroom explain`, each with a longer text.
pub const CODES: &[(&str, &str)] = &[
    (
        "snapshot-version",
        "A snapshot says how far a shop had run, and its digests prove that it is the same shop when it goes on. Another version of the program, or a scenario that was changed since, runs otherwise: take the snapshot again.",
    ),
    (
        "branch-not-possible",
        "A shop that runs can take other rules, other calendars, more machines and people, other priorities, weights and due dates, and orders that are released later. What is in the shop stays what it is; everything else needs a run from the start.",
    ),
];

/// A shop in the middle of its run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Snapshot {
    format: u32,
    version: String,
    /// The scenario.
    pub file: PathBuf,
    inputs: Vec<(String, String)>,
    /// What was changed of it, `path=value`.
    pub changes: Vec<String>,
    /// The instant, s since the start.
    pub at: f64,
    /// Names of the policies.
    pub policies: Vec<String>,
    digests: Vec<Vec<String>>,
}

/// Why there is no snapshot, or no shop goes on from one.
#[derive(Debug, thiserror::Error)]
pub enum SnapshotError {
    /// The scenario cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The snapshot cannot be read.
    #[error("{path} is no snapshot: {reason}")]
    NoSnapshot {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// Another format or another version of the program made it.
    #[error(
        "{path} was made by version {made_by} in format {format}, and this is version {version} with format {FORMAT}"
    )]
    Version {
        /// The file.
        path: PathBuf,
        /// The version that made it.
        made_by: String,
        /// Its format.
        format: u32,
        /// This version.
        version: String,
    },
    /// A file that is another one since.
    #[error("{file} has changed since the snapshot was taken")]
    Changed {
        /// The file.
        file: String,
    },
    /// No instant of the run.
    #[error("{text} is no instant of the run: {reason}")]
    Instant {
        /// What was read.
        text: String,
        /// Why.
        reason: String,
    },
    /// The shop that goes on is another one.
    #[error("replication {replication} under policy \"{policy}\" is not the run of the snapshot")]
    Digest {
        /// The policy.
        policy: String,
        /// The replication, from 0.
        replication: u32,
    },
    /// A policy of which the snapshot has no runs.
    #[error("the snapshot has no policy \"{name}\"; it has {known}")]
    NoPolicy {
        /// Its name.
        name: String,
        /// Those that there are.
        known: String,
    },
    /// The shop stopped before the instant.
    #[error(transparent)]
    Shop(#[from] ShopError),
    /// A file cannot be read to tell whether it has changed.
    #[error(transparent)]
    Input(#[from] ShardError),
}

impl Located for SnapshotError {
    fn location(&self) -> Option<Location> {
        match self {
            Self::Read(error) => error.location(),
            Self::Input(error) => error.location(),
            Self::Changed { file } => Some(Location::of(file)),
            Self::NoSnapshot { path, .. } | Self::Version { path, .. } => Some(Location::of(path.display())),
            Self::Instant { .. } | Self::Digest { .. } | Self::NoPolicy { .. } | Self::Shop(..) => None,
        }
    }
}

impl SnapshotError {
    /// The way out.
    pub fn fix(&self) -> &'static str {
        match self {
            Self::Read(_) | Self::NoSnapshot { .. } | Self::Input(_) => {
                "check the path; `run FILE --snapshot-at TIME --snapshot FILE` writes one"
            }
            Self::Version { .. } | Self::Changed { .. } | Self::Digest { .. } => "take the snapshot again",
            Self::Instant { .. } => {
                "a date such as \"2026-04-01 06:00\" where the scenario has a start, or a time such as \"40 h\""
            }
            Self::NoPolicy { .. } => "choose one of them, or take the snapshot again",
            Self::Shop(_) => "take the snapshot earlier",
        }
    }
}

/// An instant of a run: a date or a time since the start, s.
///
/// # Errors
/// [`SnapshotError::Instant`].
pub fn instant(scenario: &Scenario, text: &str) -> Result<f64, SnapshotError> {
    let refuse = |reason: String| Err(SnapshotError::Instant { text: text.to_owned(), reason });
    let time = if date::is_date(text) {
        match (date::parse(text), scenario.start) {
            (Some(time), Some(start)) => time - start,
            (Some(_), None) => return refuse("the scenario has no start".to_owned()),
            (None, _) => return refuse("there is no such date".to_owned()),
        }
    } else {
        match unit::quantity(text, "s") {
            Ok(time) => time,
            Err(error) => return refuse(error.to_string()),
        }
    };
    match time.is_finite() && (0.0..scenario.horizon).contains(&time) {
        true => Ok(time),
        false => refuse("it is before the start or not before the horizon".to_owned()),
    }
}

impl Snapshot {
    /// Runs a shop to an instant under the policies given by index. `path` is the file of the scenario and `changes` what was
    /// changed of it.
    ///
    /// # Errors
    /// [`SnapshotError`]: the shop stops before, a file cannot be read.
    pub fn take(
        version: &str,
        path: &Path,
        file: &ScenarioFile,
        changes: Vec<String>,
        policies: &[usize],
        at: f64,
    ) -> Result<Self, SnapshotError> {
        let scenario = &file.scenario;
        let digests = digests(scenario, policies, at)?;
        let absolute = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        let file_path = if toolroom_form::is_shipped(path) { path.to_owned() } else { absolute(path) };
        let named: Vec<PathBuf> =
            file.files.iter().filter(|path| !toolroom_form::is_shipped(path)).map(|path| absolute(path)).collect();
        let mut inputs = Plan::fingerprints(&named)?;
        inputs.push((String::new(), toolroom_shards::fingerprint(file.text.as_bytes())));
        let policies = policies.iter().map(|policy| scenario.policies[*policy].name.clone()).collect();
        let version = version.to_owned();
        Ok(Self { format: FORMAT, version, file: file_path, inputs, changes, at, policies, digests })
    }

    /// The text of its file.
    ///
    /// # Errors
    /// None that a user can cause: numbers and texts have a JSON form.
    pub fn text(&self) -> Result<String, serde_json::Error> {
        serde_json::to_string_pretty(self).map(|text| text + "\n")
    }

    /// Reads a file.
    ///
    /// # Errors
    /// [`SnapshotError`]: it cannot be read, or another version made it.
    pub fn read(path: &Path, version: &str) -> Result<Self, SnapshotError> {
        let no_snapshot = |reason: String| SnapshotError::NoSnapshot { path: path.to_owned(), reason };
        let text = std::fs::read_to_string(path).map_err(|error| no_snapshot(error.kind().to_string()))?;
        let value: serde_json::Value = serde_json::from_str(&text).map_err(|error| no_snapshot(error.to_string()))?;
        let format = value["format"].as_u64().and_then(|format| u32::try_from(format).ok());
        let made_by = value["version"].as_str().unwrap_or("unknown").to_owned();
        let Some(format) = format else { return Err(no_snapshot("it has no `format`".to_owned())) };
        if format != FORMAT || made_by != version {
            let (path, version) = (path.to_owned(), version.to_owned());
            return Err(SnapshotError::Version { path, made_by, format, version });
        }
        serde_json::from_value(value).map_err(|error| no_snapshot(error.to_string()))
    }

    /// The scenario of the snapshot with `more` changes of it.
    ///
    /// # Errors
    /// [`SnapshotError`]: it cannot be read, or it is another one since.
    pub fn scenario(&self, more: &[String]) -> Result<ScenarioFile, SnapshotError> {
        let changes: Vec<String> = self.changes.iter().chain(more).cloned().collect();
        let file = read(&self.file, &changes)?;
        for (name, known) in &self.inputs {
            let (shown, found) = if name.is_empty() {
                (self.file.display().to_string(), toolroom_shards::fingerprint(file.text.as_bytes()))
            } else {
                (name.clone(), Plan::fingerprints(&[PathBuf::from(name)])?.remove(0).1)
            };
            if found != *known {
                return Err(SnapshotError::Changed { file: shown });
            }
        }
        Ok(file)
    }

    /// The change of the scenario that gives the run another end: a date, where the scenario has a start, or a time since the start.
    /// None where nothing is given.
    ///
    /// # Errors
    /// [`SnapshotError::Instant`] for a date that is none, or has no start to count from.
    pub fn horizon(&self, text: Option<&str>) -> Result<Vec<String>, SnapshotError> {
        let Some(text) = text else { return Ok(Vec::new()) };
        if !date::is_date(text) {
            return Ok(vec![format!("shop.horizon=\"{text}\"")]);
        }
        let refuse = |reason: &str| Err(SnapshotError::Instant { text: text.to_owned(), reason: reason.to_owned() });
        match (date::parse(text), self.scenario(&[])?.scenario.start) {
            (Some(end), Some(start)) if end > start => Ok(vec![format!("shop.horizon=\"{} s\"", end - start)]),
            (Some(_), Some(_)) => refuse("it is not after the start"),
            (Some(_), None) => refuse("the scenario has no start"),
            (None, _) => refuse("there is no such date"),
        }
    }

    /// Runs a shop up to the instant, and compares what happened with the snapshot: event by event the same, or not at all.
    ///
    /// # Errors
    /// [`SnapshotError::Digest`] of the first run that is another one.
    pub fn verify(&self, scenario: &Scenario, policies: &[usize]) -> Result<(), SnapshotError> {
        let found = digests(scenario, policies, self.at)?;
        for (policy, found) in policies.iter().zip(found) {
            let name = &scenario.policies[*policy].name;
            let Some(place) = self.policies.iter().position(|known| known == name) else {
                return Err(SnapshotError::NoPolicy { name: name.clone(), known: self.policies.join(", ") });
            };
            let known = &self.digests[place];
            let other = (0..found.len()).find(|index| known.get(*index) != found.get(*index));
            if let Some(replication) = other {
                let replication = u32::try_from(replication).unwrap_or(u32::MAX);
                return Err(SnapshotError::Digest { policy: name.clone(), replication });
            }
        }
        Ok(())
    }
}

/// Digests of every replication under the policies at an instant.
fn digests(scenario: &Scenario, policies: &[usize], at: f64) -> Result<Vec<Vec<String>>, SnapshotError> {
    let time = SimTime::from_seconds(at).map_err(ShopError::from)?;
    let of_policy = |policy: &usize| {
        let resolved = Arc::new(ResolvedPolicy::from_scenario(scenario, *policy).map_err(ShopError::from)?);
        let one = |replication: u32| -> Result<String, SnapshotError> {
            let world = scenario.drawn(replication).map_err(ShopError::from)?;
            let mut shop = Shop::with_recorder(&world, Arc::clone(&resolved), replication, Silent)?;
            shop.run_until(time)?;
            Ok(format!("{:016x}", shop.digest().value()))
        };
        (0..scenario.replications).into_par_iter().map(one).collect()
    };
    policies.iter().map(of_policy).collect()
}
