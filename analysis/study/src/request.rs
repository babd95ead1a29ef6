//! What a study was asked to do, as `run.json` keeps it: a study goes on, and its report is drawn again, from the same
//! request only.

use crate::logs::Format;
use crate::run_info::RunInfo;
use crate::study::{Finished, FinishedError, StudyOptions};
use crate::tune::Tuning;
use crate::variants::VariantShop;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use toolroom_form::{ReadError, nearest};
use toolroom_scenario::Scenario;
use toolroom_scenario_file::{ScenarioFile, parse};
use toolroom_shards::fingerprint;
use toolroom_steady::WarmUp;

/// Everything that the results of a study depend on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StudyRequest {
    version: String,
    /// As typed, without place and threads.
    command: String,
    /// Name of the scenario file, and what it said.
    file: String,
    text: String,
    /// That file and those that it names, with fingerprints.
    inputs: Vec<(String, String)>,
    /// Values of the scenario that were changed, `path=value`.
    changes: Vec<String>,
    seed: u64,
    policies: Vec<String>,
    replications: u32,
    #[serde(default)]
    until: Vec<String>,
    logged: u32,
    format: Option<String>,
    /// Part of a run that its trace shows, s from the start.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    trace: Option<[f64; 2]>,
    /// How the settings of the policies were found; `changes` holds them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    tuning: Option<Tuning>,
    /// How the warm-up was found; `changes` holds it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    warm_up: Option<WarmUp>,
    /// Where the command was typed: the name of the file is read from there. May differ.
    directory: PathBuf,
}

/// Why a study cannot go on, or its report cannot be drawn again.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RequestError {
    /// The directory holds results of something else.
    #[error("{directory} holds no study that can go on")]
    NoStudy {
        /// The directory.
        directory: PathBuf,
    },
    /// The directory holds the study of another request.
    #[error("{directory} holds another study, which cannot go on: {}", differences.join("; "))]
    AnotherStudy {
        /// The directory.
        directory: PathBuf,
        /// What differs, in words.
        differences: Vec<String>,
    },
    /// The finished part cannot be read.
    #[error(transparent)]
    Finished(#[from] FinishedError),
    /// Another version made the study, whose figures may be others.
    #[error("{directory} was made by version {made_by}, this is {version}")]
    OtherVersion {
        /// The directory.
        directory: PathBuf,
        /// The version that made it.
        made_by: String,
        /// The version that runs.
        version: String,
    },
}

impl RequestError {
    /// The way out.
    pub fn fix(&self) -> &'static str {
        match self {
            Self::NoStudy { .. } | Self::AnotherStudy { .. } | Self::Finished(_) => {
                "go on with the same command, choose another --out, or start anew without --resume"
            }
            Self::OtherVersion { .. } => "run the study again",
        }
    }
}

/// A name that no policy of the scenario has.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no policy \"{name}\"")]
pub struct UnknownPolicy {
    /// The name.
    pub name: String,
    /// Names of the policies that there are.
    pub known: Vec<String>,
}

impl UnknownPolicy {
    /// The policy that may have been meant, and all of them.
    pub fn fix(&self) -> String {
        let near = nearest(&self.name, self.known.iter().map(String::as_str));
        let near = near.map_or(String::new(), |near| format!("did you mean \"{near}\"? "));
        format!("{near}policies: {}", self.known.join(", "))
    }
}

/// Indices of the policies called by name, each once; all of them where no name is given.
///
/// # Errors
/// [`UnknownPolicy`] for the first name that no policy has.
pub fn policies_named(scenario: &Scenario, names: &[String]) -> Result<Vec<usize>, UnknownPolicy> {
    if names.is_empty() {
        return Ok((0..scenario.policies.len()).collect());
    }
    let known = || scenario.policies.iter().map(|policy| policy.name.as_str());
    let mut indices = Vec::new();
    for name in names {
        let Some(index) = known().position(|each| each == name) else {
            return Err(UnknownPolicy { name: name.clone(), known: known().map(str::to_owned).collect() });
        };
        if !indices.contains(&index) {
            indices.push(index);
        }
    }
    Ok(indices)
}

/// The scenario file and the files that it and its variants name, with their fingerprints.
fn inputs(name: &str, file: &ScenarioFile, variants: &[VariantShop]) -> Vec<(String, String)> {
    let scenario = (name.to_owned(), fingerprint(file.text.as_bytes()));
    let own = variants.iter().flat_map(|variant| &variant.files).filter(|path| !file.files.contains(path));
    let named = file.files.iter().chain(own.collect::<BTreeSet<_>>()).map(|path| {
        // Gone since it was read: its name at least.
        let bytes = toolroom_form::bytes(path).unwrap_or_default();
        (path.display().to_string(), fingerprint(&bytes))
    });
    std::iter::once(scenario).chain(named).collect()
}

impl StudyRequest {
    /// The request to study the scenario of `file`, which was read as `name` with `changes`; `command` is the line
    /// without place and threads.
    pub fn new(
        version: &str,
        command: String,
        name: &str,
        file: &ScenarioFile,
        changes: Vec<String>,
        options: &StudyOptions,
        format: Option<Format>,
    ) -> Self {
        let scenario = &file.scenario;
        Self {
            version: version.to_owned(),
            command,
            file: name.to_owned(),
            text: file.text.clone(),
            inputs: inputs(name, file, &options.variants),
            changes,
            seed: scenario.seed,
            policies: options.policies.iter().map(|&policy| scenario.policies[policy].name.clone()).collect(),
            replications: options.replications,
            until: options.until.iter().map(ToString::to_string).collect(),
            logged: options.logged,
            format: format.map(|format| format.extension().to_owned()),
            trace: None,
            tuning: options.tuning.as_deref().cloned(),
            warm_up: options.warm_up.as_deref().cloned(),
            directory: std::env::current_dir().unwrap_or_default(),
        }
    }

    /// The same with a trace of another part of the run than its first week: from and to, s from the start.
    #[must_use]
    pub fn traced(self, trace: Option<[f64; 2]>) -> Self {
        Self { trace, ..self }
    }

    /// The request of a finished run, from its `run.json`; `None` where it is no study of a shop.
    pub fn read(run: &Value) -> Option<Self> {
        Self::deserialize(&run["asked"]).ok()
    }

    /// How the study came to be run, `command` being the line with place and threads.
    ///
    /// # Errors
    /// A request that has no JSON form.
    pub fn information(&self, command: String) -> Result<RunInfo, serde_json::Error> {
        Ok(RunInfo {
            version: self.version.clone(),
            command,
            reproduce: self.command.clone(),
            inputs: self.inputs.clone(),
            asked: serde_json::to_value(self)?,
            trace: self.trace,
            stopped: None,
        })
    }

    /// What a journal of this work begins with: everything but where the command was typed.
    ///
    /// # Errors
    /// A request that has no JSON form.
    pub fn head(&self) -> Result<Value, serde_json::Error> {
        serde_json::to_value(Self { directory: PathBuf::new(), ..self.clone() })
    }

    /// How the settings of its policies were found.
    pub fn tuning(&self) -> Option<Arc<Tuning>> {
        self.tuning.clone().map(Arc::new)
    }

    /// How its warm-up was found.
    pub fn warm_up(&self) -> Option<Arc<WarmUp>> {
        self.warm_up.clone().map(Arc::new)
    }

    /// The scenario, understood as it was then.
    ///
    /// # Errors
    /// Files that it names may have changed since.
    pub fn scenario(&self) -> Result<ScenarioFile, ReadError> {
        parse(&self.directory.join(&self.file).display().to_string(), &self.text, &self.changes)
    }

    /// Policies of that scenario.
    ///
    /// # Errors
    /// [`UnknownPolicy`]
    pub fn policies(&self, file: &ScenarioFile) -> Result<Vec<usize>, UnknownPolicy> {
        policies_named(&file.scenario, &self.policies)
    }

    /// What an interrupted run of the same study finished in `directory`; `run` is its `run.json`.
    ///
    /// # Errors
    /// See [`RequestError`].
    pub fn earlier(&self, directory: &Path, run: &Value) -> Result<Finished, RequestError> {
        self.refuse_another(directory, run)?;
        Ok(Finished::read(directory)?)
    }

    /// Refuses to take the results of another request for those of this one.
    ///
    /// # Errors
    /// [`RequestError::NoStudy`], [`RequestError::AnotherStudy`]
    pub fn refuse_another(&self, directory: &Path, run: &Value) -> Result<(), RequestError> {
        let directory = directory.to_owned();
        let Some(there) = Self::read(run) else {
            return Err(RequestError::NoStudy { directory });
        };
        let differences = there.differences(self);
        if differences.is_empty() { Ok(()) } else { Err(RequestError::AnotherStudy { directory, differences }) }
    }

    /// Refuses to draw with `version` what another version computed, whose figures may be others.
    ///
    /// # Errors
    /// [`RequestError::OtherVersion`]
    pub fn refuse_version(&self, directory: &Path, version: &str) -> Result<(), RequestError> {
        if self.version == version {
            return Ok(());
        }
        let (directory, made_by) = (directory.to_owned(), self.version.clone());
        Err(RequestError::OtherVersion { directory, made_by, version: version.to_owned() })
    }

    /// What differs between this request and another one, in words.
    fn differences(&self, now: &Self) -> Vec<String> {
        let mut changed = Vec::new();
        if self.text != now.text {
            changed.push(format!("the scenario {} differs from {} as it was", now.file, self.file));
        } else if self.file != now.file {
            changed.push(format!("the scenario was named {} and is named {}", self.file, now.file));
        }
        // The files that a scenario names lie beside it: under another name of that they have other names, too.
        let renamed = self.file != now.file;
        let known = |name: &String, content: &String| {
            self.inputs.iter().any(|(own, same)| same == content && (renamed || own == name))
        };
        let inputs = now.inputs.iter().filter(|(name, content)| *name != now.file && !known(name, content));
        changed.extend(inputs.map(|(name, _)| format!("{name} differs from what it was")));
        let mut differ = |what: &str, there: Value, here: Value| {
            if there != here {
                changed.push(format!("{what} was {there} and is {here}"));
            }
        };
        differ("version", self.version.as_str().into(), now.version.as_str().into());
        differ("seed", self.seed.into(), now.seed.into());
        differ("replications", self.replications.into(), now.replications.into());
        differ("policies", self.policies.clone().into(), now.policies.clone().into());
        differ("until", self.until.clone().into(), now.until.clone().into());
        differ("logged", self.logged.into(), now.logged.into());
        differ("format", self.format.clone().into(), now.format.clone().into());
        // The seed and the number of replications are compared above; the command repeats the rest.
        let others = |request: &Self| -> Vec<String> {
            let other =
                |change: &&String| !change.starts_with("shop.seed=") && !change.starts_with("shop.replications=");
            request.changes.iter().filter(other).cloned().collect()
        };
        differ("changes", others(self).into(), others(now).into());
        if changed.is_empty() && self != &(Self { directory: self.directory.clone(), ..now.clone() }) {
            changed.push(format!("the command was `{}` and is `{}`", self.command, now.command));
        }
        changed
    }
}
