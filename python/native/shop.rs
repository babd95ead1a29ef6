//! Scenarios of shops, compared and run: the files of the command line, in a folder of Python's choice.

use crate::failure::Failure;
use crate::work::gently;
use pyo3::prelude::*;
use std::path::PathBuf;
use std::sync::Arc;
use toolroom::kinds::FileKind;
use toolroom::scenario_file::{ScenarioFile, read};
use toolroom::study::logs::Format;
use toolroom::study::request::{StudyRequest, policies_named};
use toolroom::study::results::record;
use toolroom::study::study::{Precision, StudyOptions};
use toolroom::study::summary::summary;
use toolroom::study::terminal::{Style, table};
use toolroom::study::tune::{guardless, tune};

/// What a study is to do, by the names of the command line.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Options {
    /// `compare` or `run`.
    verb: String,
    file: PathBuf,
    /// `path=value`.
    set: Vec<String>,
    policy: Vec<String>,
    until: Option<String>,
    tune: bool,
    logged: Option<u32>,
    threads: usize,
    csv: bool,
    /// Folder of the files, which exists.
    out: PathBuf,
}

/// Runs a scenario into a folder; summary as JSON, text for people, and whether every replication was run.
#[pyfunction]
#[pyo3(signature = (options, progress=None))]
pub fn study(py: Python<'_>, options: Options, progress: Option<Py<PyAny>>) -> Result<(String, String, bool), Failure> {
    gently(py, progress, |pace| {
        let mut changes = options.set.clone();
        let mut file = read(&options.file, &changes)?;
        let mut policies =
            policies_named(&file.scenario, &options.policy).map_err(|error| Failure::argument(&error, error.fix()))?;
        let compares = options.verb == "compare";
        if compares && policies.len() == 1 && policies[0] != 0 {
            // One policy by name is compared with the baseline of the scenario.
            policies.insert(0, 0);
        }
        if compares && policies.len() < 2 {
            let message = "there is only one policy, nothing to compare";
            return Err(Failure::argument(message, "add a [[policy]] to the scenario, or use run()"));
        }
        let until = options.until.as_deref().map(str::parse::<Precision>).transpose();
        let until = until.map_err(|error| Failure::argument(error, "write for example until=\"half-width 2%\""))?;
        let mut tuning = None;
        let wanted = if options.tune { Some(file.tune.clone().unwrap_or_default()) } else { file.tune.clone() };
        if let Some(wanted) = wanted.filter(|_| compares) {
            let mut found = tune(&file.scenario, &policies, &wanted, options.threads, &|at| pace.at(at), &pace.stop)
                .map_err(|error| Failure::argument(&error, error.fix()))?;
            if let Some(freed) = found.freed_of_guard() {
                let changes: Vec<String> = changes.iter().cloned().chain(freed.changes()).collect();
                let scenario = read(&options.file, &changes)?.scenario;
                let verdict = guardless(&scenario, freed, &policies, options.threads, &|at| pace.at(at), &pace.stop);
                found.without_guard = verdict.map_err(|error| Failure::argument(&error, String::new()))?;
            }
            changes.extend(found.changes());
            file = read(&options.file, &changes)?;
            tuning = Some(Arc::new(found));
        }
        let scenario = &file.scenario;
        let of_verb = if compares { 1 } else { scenario.replications };
        let study_options = StudyOptions {
            policies,
            threads: options.threads,
            until: until.into_iter().collect(),
            logged: options.logged.unwrap_or(of_verb),
            tuning,
            ..StudyOptions::of(scenario)
        };
        let format = if options.csv || file.output.csv { Format::Csv } else { Format::Parquet };
        let format = (file.output.logs && options.logged != Some(0)).then_some(format);
        let name = options.file.display().to_string();
        let version = env!("CARGO_PKG_VERSION");
        let command = command(&options, study_options.tuning.is_some());
        let request = StudyRequest::new(version, command.clone(), &name, &file, changes, &study_options, format);
        let information = request.information(command).map_err(Failure::work)?;
        let at = |progress| pace.at(progress);
        let recorded = record(&options.out, scenario, &study_options, format, &information, &at, &pace.stop)
            .map_err(Failure::work)?;
        if let Some(stopped) = &recorded.stopped {
            return Err(Failure::work(stopped));
        }
        let text_of_summary = summary(scenario, &recorded.study, &recorded.comparison).to_string();
        let style = Style { colour: false, wall: None, width: None };
        let text = table(scenario, &recorded.study, &recorded.comparison, style);
        Ok((text_of_summary, text, recorded.study.complete))
    })
}

/// The command line that makes the same files.
fn command(options: &Options, tuned: bool) -> String {
    let mut words = vec!["toolroom".to_owned(), options.verb.clone(), options.file.display().to_string()];
    words.extend(options.set.iter().flat_map(|change| ["--set".to_owned(), quoted(change)]));
    if tuned {
        words.push("--tune".to_owned());
    }
    words.extend(options.policy.iter().flat_map(|name| ["--policy".to_owned(), quoted(name)]));
    if let Some(precision) = options.until.as_deref().and_then(|until| until.parse::<Precision>().ok()) {
        words.push(format!("--until \"{precision}\""));
    }
    words.join(" ")
}

/// An argument as it has to be typed.
pub fn quoted(argument: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./=:%+,".contains(c);
    if !argument.is_empty() && argument.chars().all(plain) { argument.to_owned() } else { format!("{argument:?}") }
}

/// Name, seed, replications, policies, and values by key.
type Understood = (String, u64, u32, Vec<String>, Vec<(String, String, Option<String>)>);

/// Name, seed, replications, policies and every value of a scenario: its key, how it was understood, and how the file
/// writes it where it does.
#[pyfunction]
pub fn echo(file: PathBuf, set: Vec<String>) -> Result<Understood, Failure> {
    let ScenarioFile { scenario, echo, .. } = read(&file, &set)?;
    let policies = scenario.policies.iter().map(|policy| policy.name.clone()).collect();
    // As `--set` writes it: the shop is one table, whatever its name; the others are called by theirs.
    let key = |section: &str, key: &str| match section.split_once(' ') {
        _ if section.is_empty() => key.to_owned(),
        Some(("shop", _)) => format!("shop.{key}"),
        Some((table, name)) => format!("{table}.{name}.{key}"),
        None => format!("{section}.{key}"),
    };
    let text = toolroom::form::text(&file)?;
    let values = echo
        .into_iter()
        .map(|value| {
            let written = text.get(value.span).filter(|_| !value.default).map(|own| own.trim_matches('"').to_owned());
            (key(&value.section, &value.key), value.value, written)
        })
        .collect();
    Ok((scenario.name, scenario.seed, scenario.replications, policies, values))
}

/// Reads a file of any kind: the kind, and what it is in a line.
#[pyfunction]
pub fn check(file: PathBuf, set: Vec<String>) -> Result<(String, String), Failure> {
    let kind = FileKind::from_path(&file)?;
    let Some(read) = kind.read else {
        let message = format!("files of the kind {} are written by toolroom, not read", kind.word);
        return Err(Failure::argument(message, "give another file"));
    };
    Ok((kind.word.to_owned(), read(&file, &set)?.summary))
}
