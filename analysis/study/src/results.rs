//! The files of a finished study.
//!
//! | file | what | same bytes for the same study |
//! |---|---|---|
//! | `summary.json` | the comparison | yes |
//! | `kpi.csv` | every figure of every replication | yes |
//! | `parts.csv`, `customers.csv`, `stations.csv` | figures by part type, by customer and by station, those that there are | yes |
//! | `orders.csv`, `load.csv`, `queues.csv`, `wip.csv` | of a scenario with orders: when each is finished, load by week, queues, work in process | yes |
//! | `schedule.csv`, `plan.csv` | the sequences of the first run, as `--schedule` reads them; where a schedule is followed, how far from it | yes |
//! | `operations`, `tools`, `jobs`, `states`, `events` | logs, Parquet or CSV | yes |
//! | `trace.json` | first replication for Perfetto | yes |
//! | `report.html` | the pictures | yes |
//! | `schedule.html` | the machines over the whole run, to zoom | yes |
//! | `study.json` | the figures to the last bit, to go on or draw the report again | yes |
//! | `run.json` | how it was made, wall time and threads included | no |
//!
//! `run.json` is written last: a directory with it is complete.

mod finished_run;

pub use crate::run_info::RunInfo;
pub use finished_run::{FinishedRun, FinishedRunError};

use crate::compare::Comparison;
use crate::groups;
use crate::logs::{Format, LogError, LogWriter};
use crate::planner;
use crate::report::report;
use crate::statistics_section::PicturedRun;
use crate::study::{
    Finished, FinishedError, Progress, StoppedShop, Study, StudyError, StudyOptions, run_study, run_study_as_far,
};
use crate::summary::summary;
use crate::trace;
use crate::variants;
use serde_json::{Value, json};
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};
use toolroom_process::table::CsvWriter;
use toolroom_scenario::Scenario;

/// The files of every study, beside its log tables.
pub const NAMES: [&str; 17] = [
    Finished::FILE,
    "kpi.csv",
    groups::FILES[0].0,
    groups::FILES[1].0,
    groups::FILES[2].0,
    planner::FILES[0],
    planner::FILES[1],
    planner::FILES[2],
    planner::FILES[3],
    planner::SEQUENCES,
    planner::PLAN,
    variants::FILE,
    "trace.json",
    "summary.json",
    "report.html",
    toolroom_schedule::FILE,
    "run.json",
];

/// What a study left behind.
#[derive(Clone, Debug)]
pub struct Recorded {
    /// The figures.
    pub study: Study,
    /// What they say.
    pub comparison: Comparison,
    /// The same for programs, as in `summary.json`.
    pub summary: String,
    /// Time taken by the simulation and the files.
    pub wall: Duration,
    /// The run whose shop stopped before its horizon, where one did: the study ends before it.
    pub stopped: Option<StoppedShop>,
}

/// Why results could not be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ResultError {
    /// The study failed.
    #[error(transparent)]
    Study(#[from] StudyError),
    /// A table cannot be written.
    #[error(transparent)]
    Log(#[from] LogError),
    /// Another file cannot be written.
    #[error("cannot write {path}: {source}")]
    Write {
        /// The file.
        path: PathBuf,
        /// What the file system said.
        source: io::Error,
    },
    /// The finished part of a study cannot be read.
    #[error(transparent)]
    Finished(#[from] FinishedError),
    /// The run that is pictured cannot be made again.
    #[error("the replication that is pictured: {source}")]
    Again {
        /// Why it stopped.
        source: toolroom_shop::ShopError,
    },
}

impl ResultError {
    /// The file that could not be written, if that was the reason.
    pub fn path(&self) -> Option<&Path> {
        match self {
            Self::Study(StudyError::Log(LogError::Earlier { .. })) | Self::Log(LogError::Earlier { .. }) => None,
            Self::Study(StudyError::Log(error)) | Self::Log(error) => Some(error.path()),
            Self::Write { path, .. } => Some(path),
            Self::Study(_) | Self::Finished(_) | Self::Again { .. } => None,
        }
    }

    /// The shop of which no run would begin, if that was the reason.
    pub fn unbegun(&self) -> Option<&StoppedShop> {
        match self {
            Self::Study(StudyError::Shop(stopped)) => {
                Some(stopped).filter(|stopped| stopped.source.is_of_the_scenario())
            }
            Self::Study(_) | Self::Log(_) | Self::Write { .. } | Self::Finished(_) | Self::Again { .. } => None,
        }
    }
}

/// Runs a study and writes everything that it yields into `directory`, which exists; no log tables
/// without a `format`.
///
/// After a stop the files hold the replications that were completed, and `run.json` says
/// `"complete": false`. A shop that stops ends the study likewise; why is reported by
/// [`Recorded::stopped`] and in `run.json`, and what happened in that run before is in tables of
/// their own in the folder `stopped`. With what was [`Finished`] in another directory in the options, the study
/// goes on from there and every file but `run.json` is as if it had never been stopped.
///
/// # Errors
/// See [`ResultError`]; `run.json` is then missing.
pub fn record(
    directory: &Path,
    scenario: &Scenario,
    options: &StudyOptions,
    format: Option<Format>,
    info: &RunInfo,
    progress: &(dyn Fn(Progress) + Sync),
    stop: &AtomicBool,
) -> Result<Recorded, ResultError> {
    let start = Instant::now();
    let mut logs = format.map(|format| LogWriter::create(directory, scenario, format)).transpose()?;
    if let (Some(logs), Some(earlier)) = (&mut logs, &options.earlier) {
        logs.take_over(&earlier.directory)?;
    }
    let (study, stopped) = run_study_as_far(scenario, options, logs.as_mut(), progress, stop)?;
    logs.map_or(Ok(()), LogWriter::finish)?;
    if let (Some(stopped), Some(format)) = (&stopped, format) {
        write_stopped(&directory.join(STOPPED), scenario, stopped, format)?;
    }
    let comparison = Comparison::new(scenario, &study);
    let info = &RunInfo { stopped: stopped.as_ref().map(|run| run.source.to_string()), ..info.clone() };
    let summary = write_files(directory, scenario, &study, &comparison, info)?;
    let wall = start.elapsed();
    let mut run = run_json(scenario, &study, info, options.threads, wall);
    if let Some(stopped) = &stopped {
        run["stopped"] = json!({
            "policy": stopped.name,
            "replication": stopped.replication,
            "reason": stopped.source.to_string(),
        });
    }
    in_file(directory, "run.json", |out| pretty(out, &run))?;
    Ok(Recorded { study, comparison, summary, wall, stopped })
}

/// Folder of the tables of a run that stopped.
pub const STOPPED: &str = "stopped";

/// Writes what happened in a run until its shop stopped. The run is made again for that, which
/// gives nothing where the shop could not even be opened.
fn write_stopped(
    directory: &Path,
    scenario: &Scenario,
    stopped: &StoppedShop,
    format: Format,
) -> Result<(), ResultError> {
    let Ok((log, _)) = stopped.again(scenario) else { return Ok(()) };
    let path = || directory.to_owned();
    fs::create_dir_all(directory).map_err(|source| ResultError::Write { path: path(), source })?;
    let mut logs = LogWriter::create(directory, scenario, format)?;
    logs.write(stopped.policy, stopped.replication, &log)?;
    Ok(logs.finish()?)
}

/// Draws the `report.html` of a finished study again from its `study.json`; `options` have the
/// policies and threads. Only the first replication is run again, for its logs.
///
/// # Errors
/// See [`ResultError`]; there is then no new report.
pub fn redraw(
    directory: &Path,
    scenario: &Scenario,
    options: &StudyOptions,
    info: &RunInfo,
) -> Result<(), ResultError> {
    let earlier = Finished::read(directory)?;
    let complete = earlier.complete;
    let options = StudyOptions { replications: earlier.replications, earlier: Some(earlier), ..options.clone() };
    let mut study = run_study(scenario, &options, None, &|_| {}, &AtomicBool::new(false))?;
    study.complete = complete;
    let comparison = Comparison::new(scenario, &study);
    let report = report(scenario, &study, &comparison, info);
    in_file(directory, DRAFT, |out| out.write_all(report.html().as_bytes()))?;
    let path = directory.join("report.html");
    fs::rename(directory.join(DRAFT), &path).map_err(|source| ResultError::Write { path, source })
}

/// Name of a report that is not whole yet.
const DRAFT: &str = "report.html.partial";

/// Writes `study.json`, `summary.json`, `kpi.csv`, `trace.json` and `report.html`; the text of `summary.json`.
pub(crate) fn write_files(
    directory: &Path,
    scenario: &Scenario,
    study: &Study,
    comparison: &Comparison,
    info: &RunInfo,
) -> Result<String, ResultError> {
    in_file(directory, Finished::FILE, |out| Finished::write(study, out))?;
    in_file(directory, "kpi.csv", |out| write_kpis(scenario, study, out))?;
    for (name, kind) in groups::files(scenario) {
        in_file(directory, name, |out| groups::write(scenario, study, kind, out))?;
    }
    if !scenario.orders.is_empty() {
        for name in planner::FILES {
            in_file(directory, name, |out| planner::write(name, scenario, study, out))?;
        }
    }
    let pictured = PicturedRun::from_scenario(scenario, study).map_err(|source| ResultError::Again { source })?;
    if let Some(pictured) = pictured.as_ref().filter(|_| !scenario.orders.is_empty()) {
        in_file(directory, planner::SEQUENCES, |out| planner::write_sequences(scenario, &pictured.log, out))?;
    }
    if scenario.control.schedule.is_some() {
        in_file(directory, planner::PLAN, |out| planner::write_plan(scenario, study, out))?;
    }
    if !study.variants.is_empty() {
        in_file(directory, variants::FILE, |out| variants::write(scenario, study, out))?;
    }
    in_file(directory, "trace.json", |out| trace::write(scenario, study, info.trace, out))?;
    if let (Some(pictured), Some(&policy)) = (&pictured, study.policies.first()) {
        let what = format!("{} under {}", pictured.words(study), scenario.policies[policy].name);
        in_file(directory, toolroom_schedule::FILE, |out| {
            toolroom_schedule::write(scenario, &what, &pictured.log, out)
        })?;
    }
    let text = format!("{:#}", summary(scenario, study, comparison));
    in_file(directory, "summary.json", |out| writeln!(out, "{text}"))?;
    in_file(directory, "report.html", |out| {
        out.write_all(report(scenario, study, comparison, info).html().as_bytes())
    })?;
    Ok(text)
}

fn in_file(
    directory: &Path,
    name: &str,
    write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<(), ResultError> {
    let path = directory.join(name);
    let written = File::create(&path).and_then(|file| {
        let mut out = BufWriter::new(file);
        write(&mut out)?;
        out.flush()
    });
    written.map_err(|source| ResultError::Write { path, source })
}

fn pretty(out: &mut impl Write, value: &Value) -> io::Result<()> {
    serde_json::to_writer_pretty(&mut *out, value)?;
    out.write_all(b"\n")
}

/// One row a policy, replication and figure; the value is in the unit beside it and empty where it
/// is not defined.
fn write_kpis(scenario: &Scenario, study: &Study, out: impl Write) -> io::Result<()> {
    let mut csv = CsvWriter::new(out, ["policy", "replication", "machine", "kpi", "unit", "value"])?;
    for (position, &policy) in study.policies.iter().enumerate() {
        for (replication, values) in (0..study.replications).zip(study.replications(position)) {
            for (kpi, value) in study.kpis.iter().zip(values) {
                let unit = kpi.definition.file_unit_in(scenario);
                csv.row([
                    (&scenario.policies[policy].name).into(),
                    replication.into(),
                    kpi.machine.map(|machine| &scenario.machines[machine].name).into(),
                    kpi.definition.id.into(),
                    unit.into(),
                    (value * kpi.definition.file_scale()).into(),
                ])?;
            }
        }
    }
    Ok(csv.flush()?)
}

fn run_json(scenario: &Scenario, study: &Study, info: &RunInfo, threads: usize, wall: Duration) -> Value {
    let threads = if threads == 0 { std::thread::available_parallelism().map_or(1, usize::from) } else { threads };
    let inputs: Vec<Value> = info.inputs.iter().map(|(name, hash)| json!({ "name": name, "hash": hash })).collect();
    let names: Vec<&str> = study.policies.iter().map(|&policy| scenario.policies[policy].name.as_str()).collect();
    json!({
        "schema": 1,
        "version": info.version,
        "command": info.command,
        "scenario": scenario.name,
        "inputs": inputs,
        "seed": scenario.seed,
        "streams": crate::difference::streams(scenario),
        "policies": names,
        "replications": study.replications,
        "complete": study.complete,
        "asked": info.asked,
        "digest": format!("{:016x}", study.digest),
        "threads": threads,
        "wall_time [s]": wall.as_secs_f64(),
    })
}

#[cfg(test)]
mod tests;
