//! `toolroom report DIR`: the report of a finished run.

use crate::args::ReportArgs;
use crate::failure::Failure;
use crate::speak::Voice;
use std::path::Path;
use std::process::{Command, Stdio};
use toolroom_study::request::StudyRequest;
use toolroom_study::results::{FinishedRun, RunInfo, redraw};
use toolroom_study::study::StudyOptions;

pub fn run(args: &ReportArgs, voice: &Voice) -> Result<(), Failure> {
    let results = FinishedRun::read(&args.dir)?;
    let report = args.dir.join("report.html");
    if !report.is_file() {
        draw(&args.dir, &results)?;
    }
    if voice.json {
        voice.json(&results.summary)?;
    } else {
        voice.raw(report.display())?;
        let decision = results.summary["decision"]["line"].as_str().filter(|_| results.run["replications"] != 0);
        if let Some(line) = decision {
            voice.say(line);
        }
    }
    if let Some(reason) = results.run["stopped"]["reason"].as_str() {
        let replication = &results.run["stopped"]["replication"];
        voice.say(format_args!("replication {replication} stopped, the report holds those before it: {reason}"));
    } else if !results.complete() {
        voice.say("the run was interrupted: the report holds the replications that were complete");
    }
    if args.open {
        let opener = if cfg!(target_os = "macos") { "open" } else { "xdg-open" };
        let opened = Command::new(opener).arg(&report).stdin(Stdio::null()).stdout(Stdio::null()).spawn();
        opened.map_err(|error| Failure::work(format_args!("{opener} does not start: {error}")))?;
    }
    Ok(())
}

/// Draws the report of a study of a shop again from what is in its directory.
fn draw(dir: &Path, results: &FinishedRun) -> Result<(), Failure> {
    let help = "run the study again";
    let Some(requested) = StudyRequest::read(&results.run) else {
        let message = format!("{} holds no report.html, nor what is needed to draw it", dir.display());
        return Err(Failure::argument(message, help));
    };
    requested.refuse_version(dir, env!("CARGO_PKG_VERSION"))?;
    let file = requested.scenario()?;
    let (policies, tuning, warm_up) = (requested.policies(&file)?, requested.tuning(), requested.warm_up());
    let options = StudyOptions { policies, tuning, warm_up, ..StudyOptions::of(&file.scenario) };
    let command = results.run["command"].as_str().unwrap_or_default().to_owned();
    let stopped = results.run["stopped"]["reason"].as_str().map(str::to_owned);
    let information = RunInfo { stopped, ..requested.information(command).map_err(Failure::Json)? };
    redraw(dir, &file.scenario, &options, &information).map_err(|error| match error.path() {
        Some(_) => Failure::work_error(&error),
        None => Failure::argument(error, help),
    })
}
