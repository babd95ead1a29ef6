//! What a study was asked to do, as `run.json` keeps it: a study goes on, and its report is drawn
//! again, from the same request only.

use crate::failure::Failure;
use crate::study::{Request, chosen};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::path::{Path, PathBuf};
use toolroom_scenario::file::{ScenarioFile, parse};
use toolroom_study::logs::Format;
use toolroom_study::results::RunInfo;
use toolroom_study::study::{Finished, StudyOptions};

/// Everything that the results depend on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Asked {
    version: String,
    /// As typed, without place and threads.
    command: String,
    /// Name of the scenario file, and what it said.
    file: String,
    text: String,
    /// That file and those that it names, with fingerprints.
    inputs: Vec<(String, String)>,
    /// Values changed by `--set`, `--seed` and `--replications`.
    changes: Vec<String>,
    seed: u64,
    policies: Vec<String>,
    replications: u32,
    until: Option<f64>,
    logged: u32,
    format: Option<String>,
    /// Where the command was typed: the name of the file is read from there. May differ.
    #[serde(rename = "directory")]
    typed_in: PathBuf,
}

impl Asked {
    pub fn of(
        request: &Request<'_>,
        options: &StudyOptions,
        format: Option<Format>,
        command: String,
        inputs: Vec<(String, String)>,
    ) -> Self {
        let scenario = &request.file.scenario;
        Self {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            command,
            file: request.input.clone(),
            text: request.file.text.clone(),
            inputs,
            changes: request.changes.overrides(),
            seed: scenario.seed,
            policies: options.policies.iter().map(|&policy| scenario.policies[policy].name.clone()).collect(),
            replications: options.replications,
            until: options.until.map(|precision| precision.relative_half_width),
            logged: options.logged,
            format: format.map(|format| format.extension().to_owned()),
            typed_in: std::env::current_dir().unwrap_or_default(),
        }
    }

    /// What the run of a directory was asked to do; `None` where it is no study of a shop.
    pub fn read(run: &Value) -> Option<Self> {
        Asked::deserialize(&run["asked"]).ok()
    }

    /// How the study came to be run, `command` being the line with place and threads.
    pub fn information(&self, command: String) -> Result<RunInfo, Failure> {
        Ok(RunInfo {
            version: self.version.clone(),
            command,
            reproduce: self.command.clone(),
            inputs: self.inputs.clone(),
            asked: serde_json::to_value(self).map_err(Failure::Json)?,
            stopped: None,
        })
    }

    /// The scenario, understood as it was then.
    pub fn scenario(&self) -> Result<ScenarioFile, Failure> {
        Ok(parse(&self.typed_in.join(&self.file).display().to_string(), &self.text, &self.changes)?)
    }

    /// Policies of that scenario.
    pub fn policies(&self, file: &ScenarioFile) -> Result<Vec<usize>, Failure> {
        chosen(&file.scenario, &self.policies)
    }

    /// What an interrupted run of the same study finished in `directory`.
    pub fn earlier(&self, directory: &Path, run: &Value) -> Result<Finished, Failure> {
        self.refuse_another(directory, run)?;
        Finished::read(directory).map_err(|error| Failure::argument(error, ANEW))
    }

    /// Refuses to take the results of another request for those of this one.
    pub fn refuse_another(&self, directory: &Path, run: &Value) -> Result<(), Failure> {
        let shown = directory.display();
        let Some(there) = Self::read(run) else {
            return Err(Failure::argument(format_args!("{shown} holds no study that can go on"), ANEW));
        };
        let differences = there.differences(self);
        if differences.is_empty() {
            return Ok(());
        }
        let message = format!("{shown} holds another study, which cannot go on: {}", differences.join("; "));
        Err(Failure::argument(message, ANEW))
    }

    /// Refuses to draw for another version, whose figures may be others.
    pub fn refuse_version(&self, directory: &Path) -> Result<(), Failure> {
        let version = env!("CARGO_PKG_VERSION");
        if self.version == version {
            return Ok(());
        }
        let message = format!("{} was made by version {}, this is {version}", directory.display(), self.version);
        Err(Failure::argument(message, "run the study again"))
    }

    /// What differs between this and what is asked now, in words.
    fn differences(&self, now: &Self) -> Vec<String> {
        let mut told = Vec::new();
        if self.text != now.text || self.file != now.file {
            told.push(format!("the scenario {} differs from {} as it was", now.file, self.file));
        }
        let changed = now.inputs.iter().filter(|input| input.0 != now.file && !self.inputs.contains(input));
        told.extend(changed.map(|(name, _)| format!("{name} differs from what it was")));
        let mut differ = |what: &str, there: Value, here: Value| {
            if there != here {
                told.push(format!("{what} was {there} and is {here}"));
            }
        };
        differ("version", self.version.as_str().into(), now.version.as_str().into());
        differ("seed", self.seed.into(), now.seed.into());
        differ("replications", self.replications.into(), now.replications.into());
        differ("policies", self.policies.clone().into(), now.policies.clone().into());
        differ("until", self.until.into(), now.until.into());
        differ("logged", self.logged.into(), now.logged.into());
        differ("format", self.format.clone().into(), now.format.clone().into());
        // The seed and the number of replications are told above; the command repeats the rest.
        let others = |asked: &Self| -> Vec<String> {
            let own = |change: &&String| !change.starts_with("shop.seed=") && !change.starts_with("shop.replications=");
            asked.changes.iter().filter(own).cloned().collect()
        };
        differ("changes", others(self).into(), others(now).into());
        if told.is_empty() && self != &(Self { typed_in: self.typed_in.clone(), ..now.clone() }) {
            told.push(format!("the command was `{}` and is `{}`", self.command, now.command));
        }
        told
    }
}

/// The way out where a study cannot go on.
const ANEW: &str = "go on with the same command, choose another --out, or start anew without --resume";
